//! Shape of triangles.

use crate::geom::Vec3;

/// What an angle of 90 degrees counts as, when obtuse angles count: a smallest angle of 42 degrees, about what polishing aims
/// at.
const OBTUSE_BASE: f64 = 0.74;

/// The largest weight of obtuse angles, and the largest of all shapes with it.
pub(super) const MOST_OBTUSE: f64 = 0.5;
pub(super) const WORST: f64 = OBTUSE_BASE + MOST_OBTUSE;

/// Cosine of the largest angle of a triangle from which it has a flaw, 88.9 degrees: what is near 90 passes it by the next
/// move.
const FLAWED: f64 = 0.02;
/// The flaw of an angle just wide enough: one flaw a little larger is better than two. And that of a small angle against that
/// of a wide one, by their cosines: TetGen splits edges for wide ones only, but users look at small ones.
const ANY_FLAW: f64 = 0.025;
const SMALL_WEIGHT: f64 = 10.0;
/// The same where strain is lessened, 86 and 42.3 degrees: with room, as what is just acute is encroached upon by the next
/// vertex that TetGen puts there.
const STRAINED: f64 = 0.07;
const STRAINED_SMALL: f64 = 0.74;
/// Weight of a small angle against a wide one there: with ten as for flaws, one wide angle stayed on
/// cylinders_union_difference.
const STRAIN_OF_SMALL: f64 = 3.0;
/// Cosine of the angle up to which one is right, not obtuse: halves of rectangles are fine (90.06 degrees).
pub(super) const RIGHT: f64 = -1e-3;

/// Shape of a triangle as the cosine of its smallest angle: smaller is better, 0.5 is equilateral, 1 is degenerate.
///
/// With an `obtuse` weight, an angle over 90 degrees counts as a small one: then the larger of that cosine and
/// `OBTUSE_BASE - obtuse * cosine of the largest angle` is given.
/// Angles are compared by their cosines, so that no comparison needs trigonometry.
pub fn sharpest_cosine([a, b, c]: [&Vec3; 3], obtuse: f64) -> f64 {
    let [short, middle, long] = sorted_squares([a, b, c]);
    if short == 0.0 {
        // As bad as the worst needle.
        return 1f64.max(OBTUSE_BASE + obtuse);
    }
    let least = (middle + long - short) * 0.5 / (middle * long).sqrt();
    if obtuse == 0.0 {
        return least;
    }
    let greatest = (short + middle - long) * 0.5 / (short * middle).sqrt();
    least.max(OBTUSE_BASE - obtuse * greatest)
}

/// What [`sharpest_cosine`] gives for an angle just wide enough to be a flaw.
pub fn of_flawed(obtuse: f64) -> f64 {
    OBTUSE_BASE - obtuse * FLAWED
}

/// How far a triangle is from having no obtuse angle and none smaller than one whose cosine is given; 0 if it has neither.
pub fn flaw(corners: [&Vec3; 3], small: f64) -> f64 {
    let [smallest, widest] = extreme_cosines(corners);
    wide_flaw(widest) + SMALL_WEIGHT * (smallest - small).max(0.0)
}

/// The squares of the flaws of a triangle, from angles on that are less wide and less small, and without a step: vertices that
/// are moved one after the other to lessen their sum do not get stuck where each has one flaw or the other.
pub fn strain(corners: [&Vec3; 3]) -> f64 {
    let [smallest, widest] = extreme_cosines(corners);
    let small = STRAIN_OF_SMALL * (smallest - STRAINED_SMALL).max(0.0);
    small * small + wide_strain(widest)
}

/// The part of it that the widest angle has, by its cosine.
pub fn wide_strain(greatest: f64) -> f64 {
    let wide = (STRAINED - greatest).max(0.0);
    wide * wide
}

/// The part of the flaw that the widest angle has, by its cosine.
pub fn wide_flaw(greatest: f64) -> f64 {
    if greatest < FLAWED { ANY_FLAW + FLAWED - greatest } else { 0.0 }
}

/// Cosines of the smallest and the widest angle of a triangle.
fn extreme_cosines(corners: [&Vec3; 3]) -> [f64; 2] {
    let [short, middle, long] = sorted_squares(corners);
    if short == 0.0 {
        return [1.0, -1.0];
    }
    [(middle + long - short) * 0.5 / (middle * long).sqrt(), (short + middle - long) * 0.5 / (short * middle).sqrt()]
}

/// Whether an angle of a triangle is smaller than one whose cosine is given.
pub fn is_small(corners: [&Vec3; 3], small: f64) -> bool {
    extreme_cosines(corners)[0] > small
}

/// Whether an angle of a triangle is obtuse.
pub fn is_obtuse([a, b, c]: &[Vec3; 3]) -> bool {
    let [short, middle, long] = sorted_squares([a, b, c]);
    (short + middle - long) * 0.5 < RIGHT * (short * middle).sqrt()
}

/// Whether the smallest angle of a triangle has a smaller sine, for sines near zero.
#[inline]
pub fn is_needle([a, b, c]: [&Vec3; 3], sine: f64) -> bool {
    (b - a).cross(&(c - a)).norm() <= sine * sorted_squares([a, b, c])[2]
}

/// Whether [`sharpest_cosine`] is above a limit of at least 0.5, up to rounding; without roots and divisions.
#[inline]
pub fn is_sharper(corners: [&Vec3; 3], obtuse: f64, limit: f64) -> bool {
    let [short, middle, long] = sorted_squares(corners);
    let least = (middle + long - short) * 0.5;
    if short == 0.0 || least * least > limit * limit * middle * long {
        return true;
    }
    // Largest angle: its cosine times `obtuse` against OBTUSE_BASE - limit, both with their signs.
    let greatest = (short + middle - long) * 0.5 * obtuse;
    let needed = OBTUSE_BASE - limit;
    obtuse > 0.0 && greatest * greatest.abs() < needed * needed.abs() * short * middle
}

/// Squares of a triangle's edges, shortest first. The smallest angle is opposite to the shortest, the largest to the longest.
#[inline]
fn sorted_squares([a, b, c]: [&Vec3; 3]) -> [f64; 3] {
    let (p, q, r) = ((b - a).norm_squared(), (c - b).norm_squared(), (a - c).norm_squared());
    let (low, high) = (p.min(q), p.max(q));
    [low.min(r), low.max(high.min(r)), high.max(r)]
}

/// Cosine of an angle given in degrees.
pub fn cosine_of_degrees(degrees: f64) -> f64 {
    libm::cos(degrees.to_radians())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_triangles() {
        let (o, x, y) = (Vec3::zeros(), Vec3::x(), Vec3::y());
        assert!((sharpest_cosine([&o, &x, &y], 0.0) - 0.5f64.sqrt()).abs() < 1e-15);
        let top = Vec3::new(0.5, 0.75f64.sqrt(), 0.0);
        assert!((sharpest_cosine([&o, &x, &top], 0.0) - 0.5).abs() < 1e-15);
        assert_eq!(sharpest_cosine([&o, &o, &x], 0.0), 1.0);
        let needle = Vec3::new(0.5, 1e-9, 0.0);
        assert!(sharpest_cosine([&o, &o, &x], 0.5) >= sharpest_cosine([&o, &needle, &x], 0.5));
        for (apex, obtuse) in [(top, 0.0), (top, 0.25), (Vec3::new(0.5, 0.1, 0.0), 0.0), (Vec3::new(0.5, 0.1, 0.0), 0.25)] {
            let cosine = sharpest_cosine([&o, &x, &apex], obtuse);
            assert!(is_sharper([&o, &x, &apex], obtuse, cosine - 1e-9) && !is_sharper([&o, &x, &apex], obtuse, cosine + 1e-9));
        }
        assert!((cosine_of_degrees(60.0) - 0.5).abs() < 1e-15);
    }
}
