//! The output of the contact step: welded points and planar cells with explicit vertices.

use super::candidates::FacetTrees;
use crate::cull::Fate;
use crate::geom::Vec3;
use crate::ids::LeafId;

/// All leaves over common vertices.
///
/// Invariants: each leaf is closed over its own cells (every directed edge is matched within the leaf); the triangles of a cell
/// tile it; cells that coincide are one cell with several owners. Cells of different leaves may still cross transversally, which
/// is the arrangement's business.
#[derive(Clone, Debug, Default)]
pub struct Conforming {
    /// Positions; cells refer to them by index.
    pub points: Vec<Vec3>,
    /// Triangles of all cells, counter-clockwise about the cell's orientation (that of its first owner).
    pub triangles: Vec<[u32; 3]>,
    /// For each triangle, its cell.
    pub cell_of_triangle: Vec<u32>,
    /// Cells.
    pub cells: Vec<Cell>,
    /// Tolerance used, in the scene's unit.
    pub tolerance: f64,
    /// Boxes of the facets as they came.
    pub trees: FacetTrees,
}

/// A planar polygon of one or several facets.
#[derive(Clone, Debug)]
pub struct Cell {
    /// The facets that it is a piece of, in leaf order.
    pub owners: Vec<Owner>,
    /// Its boundary: outer loop first, counter-clockwise about its orientation, then holes.
    pub loops: Vec<Vec<u32>>,
    /// Cells of one sheet are cells of one triangulation: they share vertices and edges and nothing else.
    pub sheet: u32,
    /// Whether a facet of another leaf comes near one of its facets: nothing can cut or touch other cells.
    pub is_near: bool,
    /// What is known to become of it.
    pub fate: Fate,
}

/// A facet that a cell is a piece of.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct Owner {
    /// The leaf.
    pub leaf: LeafId,
    /// Facet of the leaf's solid.
    pub facet: u32,
    /// Whether the facet's outward normal is opposite to the cell's orientation.
    pub is_flipped: bool,
}
