//! The output of the contact step: welded points and planar cells with explicit vertices.

use super::candidates::FacetTrees;
use crate::cull::Fate;
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use crate::ids::LeafId;

/// All leaves over common vertices.
///
/// Invariants: each leaf is closed over its own cells (every directed edge is matched within the leaf); the triangles of a cell
/// tile it, or merely span it where it is set aside; cells that coincide are one cell with several owners. Cells of different
/// leaves may still cross transversally, which is the arrangement's business.
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
    /// The facets that the cells are pieces of, one cell after the other; see [`Self::owners_of`].
    pub owners: Vec<Owner>,
    /// For each cell, the end of its facets in `owners`.
    pub owner_ends: Vec<u32>,
    /// Tolerance used, in the scene's unit.
    pub tolerance: f64,
    /// The box of what parts can claim: what is outside of it decides nothing. Empty if that is not known.
    pub bounds: Aabb,
    /// Boxes of the facets as they came.
    pub trees: FacetTrees,
    /// Pairs of facets of different leaves, by their numbers among all, that may have more in common than cells: their boxes,
    /// with all that contact may have moved, overlap.
    pub pairs: Vec<[u32; 2]>,
}

impl Conforming {
    /// Adds a cell with its owners in leaf order, the first of them not flipped, and its triangles.
    pub fn push(&mut self, cell: Cell, owners: &[Owner], triangles: &[[u32; 3]]) {
        self.cell_of_triangle.resize(self.triangles.len() + triangles.len(), self.cells.len() as u32);
        self.triangles.extend_from_slice(triangles);
        self.owners.extend_from_slice(owners);
        self.owner_ends.push(self.owners.len() as u32);
        self.cells.push(cell);
    }
    /// Makes room for more cells, most of which have one owner and one triangle or two.
    pub(super) fn reserve(&mut self, cells: usize) {
        self.cells.reserve(cells);
        self.owners.reserve(cells);
        self.owner_ends.reserve(cells);
        self.triangles.reserve(cells);
        self.cell_of_triangle.reserve(cells);
    }
    /// The facets that a cell is a piece of, in leaf order.
    pub fn owners_of(&self, cell: u32) -> &[Owner] {
        let first = if cell == 0 { 0 } else { self.owner_ends[cell as usize - 1] };
        &self.owners[first as usize..self.owner_ends[cell as usize] as usize]
    }
    /// The facets that a triangle is a piece of.
    pub fn owners_of_triangle(&self, triangle: u32) -> &[Owner] {
        self.owners_of(self.cell_of_triangle[triangle as usize])
    }
}

/// A planar polygon of one or several facets.
#[derive(Clone, Copy, Debug)]
pub struct Cell {
    /// Number of the facet of its first owner among all.
    pub facet: u32,
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
