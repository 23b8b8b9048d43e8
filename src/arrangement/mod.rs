//! All leaves cut against each other, exactly: [`Conforming`] triangles to the [`Arrangement`]'s sub-cells.
//!
//! Reads the cells of `contact`, gives `classify` polygonal sub-cells that meet only in whole vertices and edges.
//!
//! # Goals
//! Right for every input: crossing, touching, coplanar, concurrent. Exact: signs come from explicit vertices, or from points
//! that remember how they were made. Polygons, not triangles: a triangle is cut into the faces of the planar graph that is
//! drawn on it, without diagonals.
//!
//! # Steps
//! 1. `broad_phase`: pairs of triangles whose boxes overlap, of the pairs of facets that contact found near; not those of which
//!    one `rests` on the sheet of the other.
//! 2. `intersect`: the common points of a pair, each with its place on both.
//! 3. `graph`: points are interned by exact equality (`point`); a point on an edge is entered in the edge, which all its
//!    triangles share; two points of a pair make a segment, which both triangles share, or a piece of an edge.
//! 4. `crossings`: on each triangle the strings (segments, pieces of edges) are cut where they meet. All cuts go to the shared
//!    segment or edge, so both its triangles see them.
//! 5. `subdivide`: the faces of each triangle's planar graph become sub-cells, holes and touching points included.
//! 6. `coincide`: sub-cells of coplanar triangles with the same loops are one sub-cell with several owners.
//!
//! # Departures from the thesis
//! The thesis (2.2.4.2) inserts intersection points pair by pair into the B-rep with floating-point coordinates and
//! re-triangulates. Here all leaves are intersected at once and nothing is rounded, so the result depends neither on order nor
//! on a tolerance, and no needle triangles are made.

mod broad_phase;
mod coincide;
mod crossings;
pub mod exact;
mod graph;
mod intersect;
pub mod point;
mod rests;
mod subdivide;

use crate::contact::conforming::{Conforming, Owner};
use crate::cull::Fate;
use crate::geom::embedding::projection_of;
use crate::geom::predicates::Projection;
use point::Points;

/// Sub-cells over exact points.
pub struct Arrangement<'a> {
    /// The cells that were cut.
    pub input: &'a Conforming,
    /// Explicit vertices and intersection points.
    pub points: Points<'a>,
    /// The pieces.
    pub cells: SubCells<'a>,
    /// What happened.
    pub statistics: Statistics,
}

/// Counts for the report.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Statistics {
    /// Pairs of triangles with overlapping boxes.
    pub candidate_pairs: u64,
    /// Pairs that meet.
    pub contacts: u64,
    /// Points made.
    pub intersection_points: u64,
    /// Signs and equalities of implicit points.
    pub signs: u64,
    /// Those that needed big integers.
    pub exact_signs: u64,
}

/// Polygonal pieces of triangles, stored flat.
///
/// Loops are walked with the piece to the left, seen against the orientation of its triangle; the first is the outer one.
/// A loop may have one vertex (a point of another leaf touches inside), or walk an edge back and forth (an edge does).
#[derive(Clone, Debug)]
pub struct SubCells<'a> {
    input: &'a Conforming,
    vertices: Vec<u32>,
    loop_ends: Vec<u32>,
    cell_ends: Vec<u32>,
    /// Triangle of the input that each piece lies on.
    pub triangle: Vec<u32>,
    /// For each piece, its list of owners: first those of the input's cells, then those of coinciding pieces.
    pub owners: Vec<u32>,
    coinciding: Vec<Vec<Owner>>,
    /// Whether the fate of any piece is known.
    has_fates: bool,
}

impl<'a> SubCells<'a> {
    fn new(input: &'a Conforming) -> Self {
        // Most triangles stay whole.
        let count = input.triangles.len();
        let one_each = || Vec::with_capacity(count);
        Self {
            input,
            vertices: Vec::with_capacity(3 * count),
            loop_ends: one_each(),
            cell_ends: one_each(),
            triangle: one_each(),
            owners: one_each(),
            coinciding: Vec::new(),
            has_fates: input.cells.iter().any(|c| c.fate != Fate::Live),
        }
    }
    /// Number of pieces.
    pub fn len(&self) -> usize {
        self.cell_ends.len()
    }
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.cell_ends.is_empty()
    }
    /// Loops of a piece, outer one first.
    pub fn loops(&self, cell: usize) -> impl Iterator<Item = &[u32]> {
        let first = if cell == 0 { 0 } else { self.cell_ends[cell - 1] as usize };
        (first..self.cell_ends[cell] as usize).map(|l| {
            let start = if l == 0 { 0 } else { self.loop_ends[l - 1] as usize };
            &self.vertices[start..self.loop_ends[l] as usize]
        })
    }
    /// Facets that a piece belongs to.
    pub fn owners_of(&self, cell: usize) -> &[Owner] {
        let list = self.owners[cell] as usize;
        match list.checked_sub(self.input.cells.len()) {
            None => self.input.owners_of(list as u32),
            Some(k) => &self.coinciding[k],
        }
    }
    /// What is known to become of a piece.
    pub fn fate_of(&self, cell: usize) -> Fate {
        if !self.has_fates {
            return Fate::Live;
        }
        self.input.cells[self.input.cell_of_triangle[self.triangle[cell] as usize] as usize].fate
    }
    /// Whether the fate of any piece is known.
    pub fn has_fates(&self) -> bool {
        self.has_fates
    }
    /// All loops' vertices, one after the other; position k is a corner, the start of one directed edge.
    pub fn corners(&self) -> &[u32] {
        &self.vertices
    }
    /// For each loop in order, its range of corners and its piece.
    pub fn loop_ranges(&self) -> impl Iterator<Item = (std::ops::Range<usize>, usize)> {
        let starts = std::iter::once(0).chain(self.loop_ends.iter().map(|e| *e as usize));
        let mut cell = 0;
        starts.zip(self.loop_ends.iter().map(|e| *e as usize)).enumerate().map(move |(l, (start, end))| {
            while l >= self.cell_ends[cell] as usize {
                cell += 1;
            }
            (start..end, cell)
        })
    }
    fn push<'b>(&mut self, triangle: u32, owners: u32, loops: impl IntoIterator<Item = &'b [u32]>) {
        for walk in loops {
            self.vertices.extend_from_slice(walk);
            self.loop_ends.push(self.vertices.len() as u32);
        }
        self.cell_ends.push(self.loop_ends.len() as u32);
        self.triangle.push(triangle);
        self.owners.push(owners);
    }
}

/// The projection in which a triangle of the input turns counter-clockwise; contact leaves no triangle without area.
pub fn projection_of_triangle(input: &Conforming, triangle: [u32; 3]) -> Projection {
    projection_of(triangle.map(|v| input.points[v as usize])).unwrap_or(Projection { u: 0, v: 1 })
}

/// Cuts all cells against each other. Cost: n log n in the number of triangles, plus the output; quadratic in the number of
/// strings on one triangle at worst.
pub fn arrange(input: &Conforming) -> Arrangement<'_> {
    let mut mesh = graph::Mesh::new(input);
    let contacts = broad_phase::contacts(&mesh);
    if contacts.found.is_empty() {
        // Contact has found everything, as it does where parts only touch.
        mesh.near.clear();
    }
    mesh.number_edges();
    let mut points = Points::new(&input.points, &input.bounds);
    let mut graph = graph::Graph::new(&mesh, &contacts.found, &mut points);
    crossings::cut(&mesh, &mut graph, &mut points);
    graph.sort_curves(&mesh, &points);
    let mut cells = subdivide::subdivide(&mesh, &graph, &points);
    coincide::merge(&mut cells, &graph.is_coplanar);
    let statistics = Statistics {
        candidate_pairs: contacts.candidates,
        contacts: contacts.found.len() as u64,
        intersection_points: (points.len() - points.explicit_len()) as u64,
        signs: points.counts.all.load(std::sync::atomic::Ordering::Relaxed),
        exact_signs: points.counts.exact.load(std::sync::atomic::Ordering::Relaxed),
    };
    Arrangement { input, points, cells, statistics }
}

#[cfg(test)]
mod tests;
