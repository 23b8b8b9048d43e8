//! Exact signs for points with `f64` coordinates (adaptive arithmetic of Shewchuk 1997, crate `robust`).
//!
//! This is the only place where the sign of a determinant of explicit points is computed; implicit points have
//! `arrangement::point`. Coordinates must be finite and, as `scene` ensures, of a magnitude at which products of three
//! neither overflow nor underflow.

use super::Vec3;
use robust::{Coord, Coord3D};

/// A sign as -1, 0 or +1.
pub type Sign = i8;

/// The sign of a number; 0 for zero.
#[inline]
pub fn sign(x: f64) -> Sign {
    Sign::from(x > 0.0) - Sign::from(x < 0.0)
}

/// Largest rounding error of a 3 x 3 determinant of differences, as a part of its permanent (Shewchuk 1997): (7 + 56 e) e with
/// e half a unit in the last place of one.
const ORIENT3D_ERROR: f64 = (7.0 + 28.0 * f64::EPSILON) * (0.5 * f64::EPSILON);
/// Largest rounding error of a 2 x 2 determinant of differences, as a part of the sum of its products (Ozaki et al. 2016).
const ORIENT2D_ERROR: f64 = 3.330_669_062_177_372_2e-16;

/// +1 if `d` lies on the side of the plane (a, b, c) from which a, b, c are seen counter-clockwise, that is, on the side
/// of the normal (b - a) x (c - a); -1 on the other side, 0 if coplanar. Exact.
#[inline]
pub fn orient3d(a: &Vec3, b: &Vec3, c: &Vec3, d: &Vec3) -> Sign {
    match clear_side(a, b, c, d) {
        0 => orient3d_in_doubt(a, b, c, d),
        side => side,
    }
}

/// The same if rounding leaves no doubt, else 0.
#[inline]
pub fn clear_side(a: &Vec3, b: &Vec3, c: &Vec3, d: &Vec3) -> Sign {
    let (ad, bd, cd) = (a - d, b - d, c - d);
    let (bc, cb) = (bd.x * cd.y, cd.x * bd.y);
    let (ca, ac) = (cd.x * ad.y, ad.x * cd.y);
    let (ab, ba) = (ad.x * bd.y, bd.x * ad.y);
    let det = ad.z * (bc - cb) + bd.z * (ca - ac) + cd.z * (ab - ba);
    let permanent =
        (bc.abs() + cb.abs()) * ad.z.abs() + (ca.abs() + ac.abs()) * bd.z.abs() + (ab.abs() + ba.abs()) * cd.z.abs();
    // Positive when d lies below, so the sign is turned.
    if det.abs() > ORIENT3D_ERROR * permanent { -sign(det) } else { 0 }
}

// The filters stand here, where the compiler can put them into loops; what they leave open is rare and long.
#[cold]
#[inline(never)]
fn orient3d_in_doubt(a: &Vec3, b: &Vec3, c: &Vec3, d: &Vec3) -> Sign {
    if let Some(sign) = orient3d_of_prism([a, b, c, d]) {
        return sign;
    }
    let at = |p: &Vec3| Coord3D { x: p.x, y: p.y, z: p.z };
    -sign(robust::orient3d(at(a), at(b), at(c), at(d)))
}

/// [`orient3d`] where points of a body that is prismatic along an axis make it a matter of two dimensions: all lie at one
/// height, or one of them above another. Such points are often coplanar, and comparisons take a tenth of the time of long
/// numbers.
fn orient3d_of_prism(points: [&Vec3; 4]) -> Option<Sign> {
    let is_level = |k: usize| points.iter().all(|p| p[k] == points[0][k]);
    if (0..3).any(is_level) {
        return Some(0);
    }
    // The two that are above each other, and whether the order (lower, upper, the others) is an odd one.
    const PAIRS: [([usize; 4], bool); 6] = [
        ([0, 1, 2, 3], false),
        ([0, 2, 1, 3], true),
        ([0, 3, 1, 2], false),
        ([1, 2, 0, 3], false),
        ([1, 3, 0, 2], true),
        ([2, 3, 0, 1], false),
    ];
    for axis in 0..3 {
        let plane = Projection { u: (axis + 1) % 3, v: (axis + 2) % 3 };
        let flat = |k: usize| plane.apply(points[k]);
        for ([lower, upper, p, q], is_odd) in PAIRS {
            if flat(lower) == flat(upper) {
                let up = sign(points[upper][usize::from(axis)] - points[lower][usize::from(axis)]);
                let turn = up * orient2d(flat(lower), flat(p), flat(q));
                return Some(if is_odd { -turn } else { turn });
            }
        }
    }
    None
}

/// +1 if a, b, c turn counter-clockwise in the plane, -1 if clockwise, 0 if collinear. Exact.
#[inline]
pub fn orient2d(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> Sign {
    let left = (a[0] - c[0]) * (b[1] - c[1]);
    let right = (a[1] - c[1]) * (b[0] - c[0]);
    let det = left - right;
    if det.abs() >= ORIENT2D_ERROR * (left + right).abs() { sign(det) } else { orient2d_in_doubt(a, b, c) }
}

#[cold]
#[inline(never)]
fn orient2d_in_doubt(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> Sign {
    let at = |p: [f64; 2]| Coord { x: p[0], y: p[1] };
    sign(robust::orient2d(at(a), at(b), at(c)))
}

/// A projection along a coordinate axis that keeps orientation: counter-clockwise about a normal becomes counter-clockwise
/// in the plane. Dropping a coordinate is exact.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Projection {
    /// Axis that becomes the first coordinate.
    pub u: u8,
    /// Axis that becomes the second coordinate.
    pub v: u8,
}

impl Projection {
    /// Along the dominant axis of `normal`.
    pub fn along(normal: &Vec3) -> Self {
        let axis = normal.iamax();
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        if normal[axis] >= 0.0 { Self { u: u as u8, v: v as u8 } } else { Self { u: v as u8, v: u as u8 } }
    }
    /// The projected point.
    pub fn apply(self, p: &Vec3) -> [f64; 2] {
        [p[self.u as usize], p[self.v as usize]]
    }
    /// Whether two projections drop the same axis.
    pub fn is_same_axis(self, other: Self) -> bool {
        self.u + self.v == other.u + other.v
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orientation_follows_the_right_hand_rule() {
        let (o, x, y, z) = (Vec3::zeros(), Vec3::x(), Vec3::y(), Vec3::z());
        assert_eq!(orient3d(&o, &x, &y, &z), 1);
        assert_eq!(orient3d(&o, &x, &y, &(-z)), -1);
        assert_eq!(orient3d(&o, &x, &y, &(x + y)), 0);
        assert_eq!([clear_side(&o, &x, &y, &z), clear_side(&o, &x, &y, &(x + y))], [1, 0]);
    }

    #[test]
    fn points_above_each_other_turn_as_long_numbers_tell() {
        let long = |p: [&Vec3; 4]| {
            let at = |p: &Vec3| Coord3D { x: p.x, y: p.y, z: p.z };
            -sign(robust::orient3d(at(p[0]), at(p[1]), at(p[2]), at(p[3])))
        };
        // Corners of two boxes of thirds and tenths: many are above others, and many are coplanar.
        let place = |k: usize, n: usize| [1.0 / 3.0, 0.1, -0.7, 0.3][(k / n) % 4];
        let corners: Vec<Vec3> = (0..24).map(|k| Vec3::new(place(k, 1), place(k, 4), place(7 * k, 3))).collect();
        let (mut settled, mut seen) = (0, [0; 3]);
        for k in 0..corners.len().pow(4) {
            let p = [0, 1, 2, 3].map(|place| &corners[k / 24usize.pow(place) % 24]);
            if let Some(sign) = orient3d_of_prism(p) {
                assert_eq!(sign, long(p), "{p:?}");
                settled += 1;
                seen[(sign + 1) as usize] += 1;
            }
        }
        assert!(settled > 100_000 && seen.iter().all(|&n| n > 10_000), "{settled} {seen:?}");
    }

    #[test]
    fn projection_keeps_orientation_for_every_axis() {
        for axis in 0..3 {
            for turn in [1.0, -1.0] {
                let mut n = Vec3::zeros();
                n[axis] = turn;
                let a = Vec3::new(n.y, n.z, n.x);
                let b = n.cross(&a);
                let q = Projection::along(&n);
                assert_eq!(orient2d([0.0, 0.0], q.apply(&a), q.apply(&b)), 1, "axis {axis} {turn}");
            }
        }
    }
}
