//! Volumes that remeshing changed by more than a user expects.

use crate::diag::{Diagnostic, Tally, short};
use crate::ids::{IdVec, PartId};
use crate::scene::model::Scene;

/// Share of a part's volume: nearly three times what 24 chords for a circle leave out of a cylinder, so that it is the deviation
/// that was asked for, or a coarse discretization, and not what remeshing does to every curved part.
const MUCH: f64 = 0.03;

/// A warning for each part of which remeshing changed the volume much; one for all copies of a part.
pub fn warnings(before: &IdVec<PartId, f64>, after: &IdVec<PartId, f64>, scene: &Scene) -> Vec<Diagnostic> {
    let hint = match scene.remesh.max_deviation {
        Some(_) => "lower `max_deviation`, or leave the facets as they are by `remesh: Off`",
        None => "use a finer `discretization`, or leave the facets as they are by `remesh: Off`",
    };
    let mut tally = Tally::default();
    for (id, part) in scene.parts.enumerate() {
        let (before, after) = (before[id], after[id]);
        if (after - before).abs() > MUCH * before.abs() {
            tally.add(part.span, || {
                let percent = 100.0 * (after / before - 1.0);
                let unit = &scene.unit;
                let numbers = format!("from {} to {} {unit}^3, by {percent:+.1} %", short(before), short(after));
                let message = format!("remeshing changed the volume of `{}` {numbers}", part.name);
                Diagnostic::warning("changed-volume", message).at(part.span).hint(hint)
            });
        }
    }
    tally.finish()
}
