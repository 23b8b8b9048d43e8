//! How finely circles are divided, and the limits of what one leaf may ask for.

use crate::diag::Diagnostic;
use crate::scene::model::Division;
use std::f64::consts::{PI, TAU};

/// Chords per circle if a scene gives no rule: 0.86 % of the radius.
const DEFAULT_SEGMENTS: u32 = 24;
/// A closed polygon needs three.
const MIN_SEGMENTS: u32 = 3;
/// Finer circles (chord error 1e-10 of the radius) run into the contact tolerance.
pub(crate) const MAX_SEGMENTS: u32 = 100_000;
/// Facets of one leaf: fine scans have no more, and a few such leaves are what `scene::Limits::memory` allows for all together.
pub(crate) const MAX_FACETS: usize = 10_000_000;

/// Number of chords per full circle of `radius` (in the scene's unit): the finest of the given rules, at least 3.
///
/// # Errors
/// If that is more than `MAX_SEGMENTS`.
pub(crate) fn segments(division: &Division, radius: f64) -> Result<u32, Diagnostic> {
    let by_angle = division.max_angle.map(|a| TAU / a);
    // A chord of angle 2a is r (1 - cos a) = 2 r sin(a/2)^2 off its arc.
    let by_error = division.max_chord_error.map(|e| {
        let half_sine = (e / (2.0 * radius)).sqrt();
        if half_sine >= 1.0 { 1.0 } else { PI / (2.0 * libm::asin(half_sine)) }
    });
    let given = division.segments.map(f64::from);
    let wanted =
        [given, by_angle, by_error].into_iter().flatten().fold(None, |a: Option<f64>, b| Some(a.map_or(b, |a| a.max(b))));
    let wanted = wanted.unwrap_or(f64::from(DEFAULT_SEGMENTS));
    // A rule that means a whole number (max_angle: 15) must not give one more by rounding.
    let whole = (wanted * (1.0 - 1e-12)).ceil();
    if whole.is_nan() || whole > f64::from(MAX_SEGMENTS) {
        let message = format!("a circle of radius {radius} would be divided into {whole} segments, more than {MAX_SEGMENTS}");
        return Err(Diagnostic::error("too-many-segments", message).hint("allow a larger chord error or angle"));
    }
    Ok((whole as u32).max(MIN_SEGMENTS))
}

/// Refuses a leaf whose facets would not fit in memory, before anything is allocated.
pub(crate) fn check_count(facets: f64) -> Result<(), Diagnostic> {
    if facets <= MAX_FACETS as f64 {
        return Ok(());
    }
    let message = format!("the solid would have {facets:.0} facets, more than the limit of {MAX_FACETS}");
    Err(Diagnostic::error("too-many-facets", message).hint("use fewer segments for its circles"))
}

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: Division = Division { segments: None, max_angle: None, max_chord_error: None };

    #[test]
    fn the_finest_rule_counts() {
        let by_angle = Division { max_angle: Some(15f64.to_radians()), ..NONE };
        assert_eq!(segments(&by_angle, 1.0).unwrap(), 24);
        assert_eq!(segments(&Division { segments: Some(36), ..by_angle }, 1.0).unwrap(), 36);
        // 1 - cos(15 degrees / 2) = 0.008555
        let by_error = Division { max_chord_error: Some(0.8556), ..NONE };
        assert_eq!(segments(&by_error, 100.0).unwrap(), 24);
        assert_eq!(segments(&Division { max_chord_error: Some(1e9), ..NONE }, 1.0).unwrap(), 3);
        assert!(segments(&Division { segments: Some(4_000_000_000), ..NONE }, 1.0).is_err());
        assert!(segments(&Division { max_chord_error: Some(1e-300), ..NONE }, 1.0).is_err());
    }
}
