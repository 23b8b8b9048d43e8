//! Labels: which leaves contain the space on either side of every sub-cell.
//!
//! Reads the [`Arrangement`], gives `patch` and `select` a [`Classified`] one.
//!
//! # Steps
//! 1. `edges`: the sub-cells around each edge are sorted by angle, exactly, so that the sides that face each other are known.
//! 2. `shells`: sides that face each other bound the same volume; connected sides are a shell.
//! 3. `raycast`: one exact ray per connected component tells which leaves contain one of its shells.
//! 4. `labels`: crossing a sub-cell changes the label by its owners; so every shell gets its label, and a contradiction is a
//!    broken invariant.
//!
//! The thesis (2.2.4.3) casts a ray per vertex and derives edges and facets from Tables 2.2 and 2.3. The labels say the same,
//! as tests prove, without casting from points that may lie *on* something.

mod edges;
mod labels;
mod raycast;

pub use edges::EdgeUses;

use crate::arrangement::Arrangement;
use crate::diag::Diagnostic;
use crate::geom::parallel::both;
use raycast::Rays;

/// Sub-cells from which on more than one thread works.
const PARALLEL_FROM: usize = 4096;

/// Labels of both sides of every sub-cell.
pub struct Classified {
    /// Shell on the front (where the normal points) and on the back of every sub-cell.
    pub shells: Vec<[u32; 2]>,
    /// Label of every shell: index into `labels`; no index for the sides of sub-cells whose [`crate::cull::Fate`] is known,
    /// which are shells of their own.
    pub label_of_shell: Vec<u32>,
    /// Distinct labels: the leaves that contain a place, sorted.
    pub labels: Vec<Vec<u32>>,
    /// Directed edges of the sub-cells, by undirected edge and angle.
    pub edges: EdgeUses,
}

/// Class of a sub-facet against a solid (thesis 2.2.4.3), from whether the solid is inside in front and behind.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Class {
    /// Both sides outside.
    Out,
    /// Inside behind only: the solid's boundary, same orientation.
    OnShared,
    /// Inside in front only: the solid's boundary, opposite orientation.
    OnAntiShared,
    /// Both sides inside.
    In,
}

impl Class {
    /// From the two bits.
    pub fn new(is_inside_in_front: bool, is_inside_behind: bool) -> Self {
        match (is_inside_in_front, is_inside_behind) {
            (false, false) => Class::Out,
            (false, true) => Class::OnShared,
            (true, false) => Class::OnAntiShared,
            (true, true) => Class::In,
        }
    }
    /// The two bits: inside in front, inside behind.
    pub fn sides(self) -> [bool; 2] {
        [matches!(self, Class::In | Class::OnAntiShared), matches!(self, Class::In | Class::OnShared)]
    }
}

/// Labels every side of every sub-cell. Cost: n log n, plus one ray per component.
///
/// # Errors
/// An internal error if an edge is open, two pieces coincide, or labels contradict each other.
pub fn classify(arrangement: &Arrangement) -> Result<Classified, Diagnostic> {
    let around_edges = || {
        let edges = EdgeUses::new(arrangement)?;
        let (shells, count) = edges.shells(&arrangement.cells);
        Ok((edges, shells, count))
    };
    let (edges, rays) = both(arrangement.cells.len() >= PARALLEL_FROM, around_edges, || Rays::new(arrangement));
    let (edges, shells, count) = edges?;
    let (label_of_shell, labels) = labels::spread(arrangement, &rays, &shells, count)?;
    Ok(Classified { shells, label_of_shell, labels, edges })
}
