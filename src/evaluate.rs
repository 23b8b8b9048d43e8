//! The boundary evaluator (thesis 2.2.4): leaf solids and CSG trees to one valid complex.
//!
//! # Goals
//! 1. Never wrong: topology is decided exactly; what was decided is verified again after rounding.
//! 2. Contact is the normal case: parts that touch share their common surface, by identity of vertices.
//! 3. Polygons in, polygons out.
//! 4. One arrangement for the whole scene, whatever the number of operands.
//!
//! # Steps
//! ```text
//! Solids ─ contact ─▶ Conforming ─ arrangement ─▶ Arrangement ─ classify ─▶ Classified ─ select ─▶ Selected ─ round ─▶ Complex
//! ```
//! | step | does | files |
//! |---|---|---|
//! | contact | welds and imprints what touches within the tolerance; the only tolerance | `contact/` |
//! | arrangement | cuts triangles exactly over interned implicit points | `arrangement/{broad_phase,intersect,graph,crossings,subdivide,coincide}.rs`, signs in `point.rs`, `exact.rs` |
//! | classify | sorts pieces around edges, spreads labels from one ray per component | `classify/{edges,labels,raycast}.rs` |
//! | select | folds the decision table, gives names, merges pieces to polygons | `select/{table,decide,markers,merge}.rs` |
//! | round | dissolves, rounds, triangulates, verifies, numbers regions | `round/{dissolve,collapse,facets,regions,freedom}.rs` |
//!
//! # Departures from the thesis
//! All operands at once instead of pairs (2.2.4); exact signs, which the thesis gave up as too slow (6.1); labels on both sides
//! of a facet instead of classes of vertices and edges (Tables 2.2, 2.3), from which the classes follow; common facets exist once
//! from the start, so the rows of Table 2.4 that kill second copies are not needed; diagonals and vertices that only killed
//! facets needed are removed at the end instead of never made (4.1).
//!
//! # Repair
//! Rounding to `f64` may let facets meet that were apart by less than a few units in the last place. Then the rounded regions are
//! evaluated again as leaves of their own, with a contact tolerance of some units in the last place ([`REPAIR_TOLERANCES`]), until
//! the result is clean; this is iterative snap rounding (Valque and Loriot 2025) with the contact step as the snap.

use crate::arrangement::{self, Statistics};
use crate::brep::complex::Complex;
use crate::classify;
use crate::contact::{self, conforming::Conforming};
use crate::diag::{Diagnostic, Outcome};
use crate::geom::aabb::Aabb;
use crate::ids::LeafId;
use crate::primitive::solid::Solid;
use crate::round::{self, Rounded};
use crate::scene::model::{Node, Scene};
use crate::select;

/// A valid complex and how it came about.
pub struct Evaluation {
    /// The complex.
    pub complex: Complex,
    /// Counts of the arrangement.
    pub statistics: Statistics,
    /// Rounds of repair that rounding needed.
    pub repairs: u32,
}

/// From leaf solids to the complex.
pub fn evaluate(scene: &Scene, solids: &[Solid]) -> Outcome<Evaluation> {
    let size = size_of(solids);
    let tolerance = scene.tolerance * size;
    let own: Vec<Option<f64>> = scene.leaves.iter().map(|l| l.tolerance.map(|t| t * size)).collect();
    let name = |leaf: LeafId| leaf_name(scene, leaf);
    let conforming = contact::conform(solids, tolerance, &own, &name)?;
    evaluate_conforming(scene, solids, &conforming, size)
}

/// How messages call a leaf.
fn leaf_name(scene: &Scene, leaf: LeafId) -> String {
    let part = scene.parts.iter().find(|p| uses(&p.solid, leaf)).map(|p| p.name.as_str());
    match (&scene.leaves[leaf].name, part) {
        (Some(name), Some(part)) => format!("`{name}` of part `{part}`"),
        (Some(name), None) => format!("`{name}`"),
        (None, Some(part)) => format!("a solid of part `{part}`"),
        (None, None) => format!("solid {}", leaf.0 + 1),
    }
}

fn uses(node: &Node, leaf: LeafId) -> bool {
    match node {
        Node::Leaf(l) => *l == leaf,
        Node::Boolean(_, operands) => operands.iter().any(|o| uses(o, leaf)),
    }
}

/// From conforming cells to the complex.
pub fn evaluate_conforming(scene: &Scene, solids: &[Solid], conforming: &Conforming, size: f64) -> Outcome<Evaluation> {
    let single = |d: Diagnostic| vec![d];
    let arrangement = arrangement::arrange(conforming);
    let classified = classify::classify(&arrangement).map_err(single)?;
    let selected = select::select(scene, solids, &arrangement, &classified);
    match round::round(&selected, &arrangement, solids, conforming.tolerance, size).map_err(single)? {
        Rounded::Valid(complex) => Ok(Evaluation { complex, statistics: arrangement.statistics, repairs: 0 }),
        Rounded::Broken { violations, .. } => {
            let text =
                format!("rounding breaks the complex in at least {} places ({:?})", violations.len(), violations[0].kind);
            Err(vec![Diagnostic::internal("rounding", text).near(violations[0].point)])
        }
    }
}

/// The model's size: the diagonal of all leaves.
pub fn size_of(solids: &[Solid]) -> f64 {
    solids.iter().flat_map(|s| &s.vertices).fold(Aabb::EMPTY, |b, v| b.with(&v.point)).diagonal()
}

#[cfg(test)]
mod tests;
