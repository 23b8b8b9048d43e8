//! Angles in degrees, because people write degrees: multiples of 15 are then exact numbers, and symmetric angles get sines
//! and cosines of symmetric bits.

use std::f64::consts::PI;

/// Degrees written by people are multiples of this.
const WRITTEN_STEPS_PER_DEGREE: f64 = 1000.0;
/// What conversions between radians, coordinates and degrees lose stays below this (2e-13 rad, far under any contact
/// tolerance).
const CONVERSION_LOSS: f64 = 1e-11;

/// The angle that was meant: the nearest thousandth of a degree if it lies within what conversions lose.
pub(crate) fn tidy(degrees: f64) -> f64 {
    let written = (degrees * WRITTEN_STEPS_PER_DEGREE).round() / WRITTEN_STEPS_PER_DEGREE;
    if (written - degrees).abs() < CONVERSION_LOSS { written } else { degrees }
}

/// Radians to tidy degrees.
pub(crate) fn from_radians(radians: f64) -> f64 {
    tidy(radians * (180.0 / PI))
}

/// Tidy angle of a direction, in (-180, 180].
pub(crate) fn of_direction(x: f64, y: f64) -> f64 {
    from_radians(libm::atan2(y, x))
}

/// The same direction in [0, 360).
pub(crate) fn canonical(degrees: f64) -> f64 {
    let d = degrees.rem_euclid(360.0);
    if d >= 360.0 { 0.0 } else { d + 0.0 }
}

/// Cosine and sine. Exact at multiples of 30 degrees where they are rational, and of equal bits at mirror images about the
/// coordinate axes and diagonals.
pub(crate) fn cos_sin(degrees: f64) -> (f64, f64) {
    let d = canonical(degrees);
    let quadrant = (d / 90.0) as u8;
    let r = d - 90.0 * f64::from(quadrant);
    let (c, s) = if r <= 45.0 {
        first_octant(r)
    } else {
        let (s, c) = first_octant(90.0 - r);
        (c, s)
    };
    match quadrant {
        0 => (c, s),
        1 => (-s, c),
        2 => (-c, -s),
        _ => (s, -c),
    }
}

fn first_octant(degrees: f64) -> (f64, f64) {
    if degrees == 30.0 {
        (0.75f64.sqrt(), 0.5)
    } else if degrees == 45.0 {
        (0.5f64.sqrt(), 0.5f64.sqrt())
    } else {
        let radians = degrees * (PI / 180.0);
        (libm::cos(radians), libm::sin(radians))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn special_angles_are_exact() {
        assert_eq!(cos_sin(60.0).0, 0.5);
        assert_eq!(cos_sin(-30.0).1, -0.5);
        assert_eq!(cos_sin(270.0), (-0.0, -1.0));
        assert_eq!(cos_sin(75.0).0, cos_sin(15.0).1);
        assert_eq!(cos_sin(195.0).0, -cos_sin(345.0).0);
        assert_eq!(cos_sin(45.0 + 720.0), (0.5f64.sqrt(), 0.5f64.sqrt()));
    }

    #[test]
    fn conversions_find_back_what_was_written() {
        for k in 0..3600 {
            let written = f64::from(k) / 10.0;
            assert_eq!(from_radians(written * PI / 180.0), written);
        }
        assert_eq!(tidy(360.0 / 7.0), 360.0 / 7.0);
    }
}
