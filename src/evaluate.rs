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
//! Solids ─ cull ─▶ Solids ─ contact ─▶ Conforming ─ arrangement ─▶ Arrangement ─ classify ─▶ Classified ─ select ─▶ Selected ─
//! round ─▶ Complex
//! ```
//! | step | does | files |
//! |---|---|---|
//! | cull | sets aside what cannot reach the result, where many leaves lie over one place | `cull/` |
//! | contact | welds and imprints what touches within the tolerance; the only tolerance | `contact/` |
//! | arrangement | cuts triangles exactly over interned implicit points |
//! `arrangement/{broad_phase,intersect,graph,crossings,subdivide,coincide}.rs`, signs in `point.rs`, `exact.rs` |
//! | classify | sorts pieces around edges, spreads labels from one ray per component | `classify/{edges,labels,raycast}.rs` |
//! | select | folds the decision table, gives names, merges pieces to polygons | `select/{table,decide,markers,merge}.rs` |
//! | round | dissolves, rounds, triangulates, numbers regions, verifies, repairs |
//! `round/{dissolve,collapse,touching,facets,regions,repair,freedom}.rs` |
//!
//! # Departures from the thesis
//! All operands at once instead of pairs (2.2.4); exact signs, which the thesis gave up as too slow (6.1); labels on both sides
//! of a facet instead of classes of vertices and edges (Tables 2.2, 2.3), from which the classes follow; common facets exist
//! once from the start, so the rows of Table 2.4 that kill second copies are not needed; diagonals and vertices that only
//! killed facets needed are removed at the end instead of never made (4.1).
//!
//! # Tolerance
//! Where contacts cannot be resolved within the tolerance (a chain of them reaches further, a part is thinner), a thousandth
//! and a millionth of it are tried; what was wrong is then told as warnings. What none can resolve is refused by name.
//!
//! # Rounding
//! The last step is verified. A vertex that rounding put onto or through an edge of its own facet cuts that edge in all facets
//! (`round/touching.rs`), so that every facet is simple or split where it touches itself. Where rounding to `f64` breaks what
//! was decided, the rounded facets are cut against each other and rounded again (`round/repair.rs`); what is still broken after
//! a few rounds is refused by name, never written.

mod findings;
mod size;

use crate::arrangement::{self, Statistics};
use crate::brep::complex::Complex;
use crate::classify;
use crate::contact::{self, conforming::Conforming};
use crate::cull::{self, Culled, Piece};
use crate::diag::{Diagnostic, Outcome};
use crate::ids::{Id, LeafId};
use crate::primitive::solid::Solid;
use crate::report::timing::Timings;
use crate::round::{self, Exact, Repairs, Rounded};
use crate::scene::model::{Policy, Scene};
use crate::select;
use size::Extent;

/// A valid complex and how it came about.
#[derive(Debug)]
pub struct Evaluation {
    /// The complex.
    pub complex: Complex,
    /// Counts of the arrangement.
    pub statistics: Statistics,
    /// What rounding took.
    pub repairs: Repairs,
    /// What lay nearer touches; in the scene's unit.
    pub tolerance: f64,
    /// What may not be meant.
    pub warnings: Vec<Diagnostic>,
}

/// Parts of the scene's tolerance that are tried where contacts cannot be resolved with it: features of about its size are
/// clearly larger than a thousandth of it; the last is down to the rounding of the coordinates.
const FINER: [f64; 2] = [1e-3, 1e-6];

/// From leaf solids to the complex.
///
/// # Errors
/// Contacts that cannot be resolved, parts without volume, forbidden overlaps and gaps, a result that rounding breaks; all that
/// the failing step found.
pub fn evaluate(scene: &Scene, solids: &[Solid], timings: &mut Timings) -> Outcome<Evaluation> {
    let extent = size::of(scene, solids);
    let culled = timings.measure("cull", || cull::cull(scene, solids, scene.tolerance * extent.size));
    // What is wrong with the pieces may be right with the whole.
    if let Some(culled) = culled
        && let Ok(evaluation) = evaluate_pieces(scene, solids, Some(&culled), extent, timings)
    {
        return Ok(evaluation);
    }
    evaluate_pieces(scene, solids, None, extent, timings)
}

fn evaluate_pieces(
    scene: &Scene,
    solids: &[Solid],
    culled: Option<&Culled>,
    extent: Extent,
    timings: &mut Timings,
) -> Outcome<Evaluation> {
    let single = |d: Diagnostic| vec![d];
    let (cut, pieces) = culled.map_or((solids, &[][..]), |c| (&c.solids, &c.pieces));
    let (mut conforming, mut warnings) = timings.measure("contact", || conform(scene, cut, pieces, extent))?;
    let tolerance = conforming.tolerance;
    // A gap that is forbidden must not hide an overlap that is.
    let (found, errors) = match timings.measure("gaps", || findings::gaps(scene, cut, &conforming)) {
        Ok(found) => (found, Vec::new()),
        Err(errors) if scene.overlap == Policy::Allow => return Err(errors),
        Err(errors) => (Vec::new(), errors),
    };
    warnings.extend(found);
    // A tenth of the memory of a large model, and nobody needs it any more.
    conforming.trees = Default::default();
    for owner in &mut conforming.owners {
        owner.facet = pieces.get(owner.leaf.index()).map_or(owner.facet, |p| p[owner.facet as usize].facet);
    }
    let (exact, statistics) = choose(scene, solids, conforming, &mut warnings, errors, timings)?;
    let rounded = timings.measure("round", || round::round(exact, solids, tolerance, extent.size)).map_err(single)?;
    match rounded {
        Rounded::Valid { complex, repairs } => Ok(Evaluation { complex, statistics, repairs, tolerance, warnings }),
        Rounded::Broken { complex, faults } => Err(findings::broken(scene, &complex, &faults)),
    }
}

/// Cuts the cells against each other and selects, which alone is left: a quarter of a large model's memory goes. `errors` are
/// told with those found here.
fn choose(
    scene: &Scene,
    solids: &[Solid],
    conforming: Conforming,
    warnings: &mut Vec<Diagnostic>,
    mut errors: Vec<Diagnostic>,
    timings: &mut Timings,
) -> Outcome<(Exact, Statistics)> {
    let arrangement = timings.measure("arrangement", || arrangement::arrange(&conforming));
    let classified = timings.measure("classify", || classify::classify(&arrangement)).map_err(|d| vec![d])?;
    let selected = timings.measure("select", || select::select(scene, solids, &arrangement, &classified));
    errors.extend(findings::overlaps(scene, &arrangement, &classified, &selected));
    errors.extend(findings::empty_parts(scene, &selected));
    if !errors.is_empty() {
        return Err(errors);
    }
    warnings.extend(findings::boundaries(scene, &arrangement, &selected));
    warnings.extend(findings::interfaces(scene, &selected));
    drop(classified);
    Ok((timings.measure("round", || Exact::new(selected, &arrangement, solids)), arrangement.statistics))
}

/// Welds and imprints with the tolerance of the scene, or where features come near it with a smaller one.
fn conform(scene: &Scene, solids: &[Solid], pieces: &[Vec<Piece>], extent: Extent) -> Outcome<(Conforming, Vec<Diagnostic>)> {
    let name = |leaf: LeafId| findings::leaf_name(scene, leaf);
    let asked = scene.tolerance * extent.size;
    let attempt = |share: f64| {
        let own: Vec<Option<f64>> = scene.leaves.iter().map(|l| l.tolerance.map(|t| share * t * extent.size)).collect();
        contact::conform(solids, pieces, share * asked, &own, &extent.bounds, &name)
    };
    let faults = match attempt(1.0) {
        Ok(conforming) => return Ok((conforming, Vec::new())),
        // A part with features that the scene says to ignore is wrong, whatever else touches.
        Err(faults) if faults.iter().any(|f| f.code == "feature-below-tolerance") => return Err(faults),
        Err(faults) => faults,
    };
    match FINER.iter().find_map(|&share| attempt(share).ok()) {
        Some(conforming) => {
            let warnings = findings::finer(faults, asked, conforming.tolerance);
            Ok((conforming, warnings))
        }
        None => Err(faults),
    }
}

#[cfg(test)]
mod tests;
