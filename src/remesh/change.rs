//! Volumes that remeshing changed by more than a user expects.

use crate::diag::{Diagnostic, Tally, short};
use crate::ids::{IdVec, PartId};
use crate::scene::model::Scene;

/// Share of a part's volume. 24 chords for a circle leave 4 % out of a sphere: that remeshing gives these back is no warning.
const MUCH: f64 = 0.05;
/// What to do, whether the facets came off the true surface or were too far from it before.
const HINT: &str = "compare `max_deviation` with the sizes of the part, by so much may facets lie off the true surface; \
                    a finer `discretization` begins closer to it; `remesh: Off` leaves the facets as they are";

/// A warning for each part of which remeshing changed the volume much; one for all copies of a part.
pub fn warnings(before: &IdVec<PartId, f64>, after: &IdVec<PartId, f64>, scene: &Scene) -> Vec<Diagnostic> {
    let mut tally = Tally::default();
    for (id, part) in scene.parts.enumerate() {
        let (before, after) = (before[id], after[id]);
        if (after - before).abs() > MUCH * before.abs() {
            tally.add(part.span, || {
                let percent = 100.0 * (after / before - 1.0);
                let unit = &scene.unit;
                let numbers = format!("from {} to {} {unit}^3, by {percent:+.1} %", short(before), short(after));
                let message = format!("remeshing changed the volume of `{}` {numbers}", part.name);
                Diagnostic::warning("changed-volume", message).at(part.span).hint(HINT)
            });
        }
    }
    tally.finish()
}
