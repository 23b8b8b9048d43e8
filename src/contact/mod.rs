//! What is meant to touch shares vertices: leaf solids to one [`conforming::Conforming`] set of cells.
//!
//! The only stage with a tolerance. After it, facets that overlap within the tolerance consist of the same cells, points
//! within the tolerance of an edge or facet of another leaf are points of it, and edges that meet do so in common points; all
//! by identity of point numbers. What crosses transversally is left to the exact arrangement.
//!
//! 1. [`weld`]: vertices of different leaves within the tolerance become one; the earlier represents.
//! 2. [`candidates`]: pairs of facets of different leaves that come near, by their boxes and, of facets of many corners, by
//!    their figures. What is in no pair is done.
//! 3. [`crossings`]: edges that come near each other get common points: an end on the other edge, or a new point where they
//!    cross; repeated until nothing changes. [`edges`] holds them: what is put into an edge enters every facet at it.
//! 4. [`sheets`]: facets in one plane that overlap form a sheet; edges and points of other facets may lie on it besides.
//! 5. [`chords`]: facets that cross along a line with common points on it get its pieces as common edges; so do [`walls`] of
//!    several facets in one plane.
//! 6. [`cells`]: each sheet is one constrained triangulation, cut along its edges into cells, each with the facets that cover
//!    it; [`cuts`] does the simplest ones.
//! 7. [`assemble`]: the same cell from two sheets is one cell ([`drafts`]). [`verify`]: every leaf is still what it was.
//!
//! [`nearly_touching`] finds the gaps that are left and were hardly meant.
//!
//! Sheets, and not pairs of facets, keep the cost at that of the result: where the caps of 200 turned cubes coincide, their
//! 159200 crossings are found, triangulated and walked once, not once for every cap.
//!
//! Known limits: facets of many leaves through one oblique line or point near which none has a vertex or edge; their needles
//! are the rounding stage's.

mod assemble;
mod body;
mod candidates;
mod cells;
mod chords;
pub mod conforming;
mod crossings;
mod cuts;
mod drafts;
mod edges;
mod figure;
mod gaps;
mod outline;
mod sheets;
#[cfg(test)]
mod tests;
mod verify;
mod walls;
mod weld;

pub use gaps::{GAP, Gap, nearly_touching};

use crate::cull::Piece;
use crate::diag::{Name, Outcome};
use crate::geom::aabb::Aabb;
use crate::ids::LeafId;
use crate::primitive::solid::Solid;
use candidates::FacetTrees;
use conforming::Conforming;

/// Distance of facets in tolerances up to which they are looked at: the cells of each may leave its box by a tolerance, and by
/// nearly two along an axis to which the facet is oblique.
const NEAR: f64 = 4.0; // Twice "nearly two".

/// All leaves over common points.
///
/// `pieces` tells what is known to become of the facets, if anything is: those that are set aside are compared with none.
///
/// `tolerance` is absolute, `leaf_tolerance` that of leaves with their own (imports); between two leaves the coarser holds, and
/// none falls below the rounding of the coordinates in `bounds`, the box of what parts can claim. `names` says how messages
/// call a leaf. Points keep scene order: vertices of leaves first, then crossings.
///
/// # Errors
/// `feature-below-tolerance`: two vertices of one leaf within its tolerance. `contact-chain`: contacts that hang together but
/// reach further than the tolerance. `contact-unresolved`: what touches a facet crosses itself, since features are about as
/// small as the tolerance. `contact-changes-leaf`: a volume changed by more than area times tolerance.
///
/// O(n log n) in facets, candidates and crossings, plus the owners of all cells.
pub fn conform(
    solids: &[Solid],
    pieces: &[Vec<Piece>],
    tolerance: f64,
    leaf_tolerance: &[Option<f64>],
    bounds: &Aabb,
    names: &dyn Fn(LeafId) -> Name,
) -> Outcome<Conforming> {
    let mut body = body::Body::new(solids, pieces, tolerance, leaf_tolerance, bounds, names)?;
    let widest = body.tolerances.iter().fold(0.0, |m: f64, &t| m.max(t));
    let trees = FacetTrees::new(&body, (NEAR * widest).max(GAP * tolerance));
    let pairs = trees.facet_pairs(&body, |_, _| NEAR * widest);
    let mut edges = edges::EdgeSet::new(&body, &pairs);
    crossings::connect(&mut body, &mut edges, &pairs, names)?;
    chords::join_walls(&mut body, &mut edges);
    let sheets = sheets::gather(&body, &mut edges, &pairs, names)?;
    // Its memory serves what follows: fresh memory costs time.
    drop(edges);
    let conforming = assemble::assemble(&body, sheets, tolerance, names)?;
    verify::verify(&body, &conforming, names)?;
    Ok(Conforming { trees, pairs, bounds: *bounds, ..conforming })
}
