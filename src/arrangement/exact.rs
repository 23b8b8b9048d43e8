//! The last stage of every sign: homogeneous integer coordinates of any size (crate `dashu-int`).
//!
//! Explicit points are scaled by one power of two so that all their coordinates are integers; every construction is then a
//! polynomial in integers, and a point is (x, y, z, w) with w > 0.

use super::point::Source;
use crate::geom::Vec3;
use dashu_int::IBig;
use std::cmp::Ordering;

/// A point in homogeneous integer coordinates; `w` is positive.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct ExactPoint {
    /// x w, y w, z w.
    pub xyz: [IBig; 3],
    /// Common denominator.
    pub w: IBig,
}

type V3 = [IBig; 3];

/// Mantissa and exponent of a finite double: `m * 2^e`.
fn decompose(x: f64) -> (i64, i32) {
    let bits = x.to_bits();
    let exponent = ((bits >> 52) & 0x7ff) as i32;
    let fraction = (bits & ((1 << 52) - 1)) as i64;
    let (m, e) = if exponent == 0 { (fraction, -1074) } else { (fraction | 1 << 52, exponent - 1075) };
    if m == 0 {
        return (0, 0);
    }
    let shift = m.trailing_zeros();
    (if x < 0.0 { -(m >> shift) } else { m >> shift }, e + shift as i32)
}

/// The exponent by which all `points` become integers.
pub fn common_exponent<'a>(points: impl IntoIterator<Item = &'a Vec3>) -> i32 {
    let lowest = |e: i32, x: &f64| {
        let (m, f) = decompose(*x);
        if m == 0 { e } else { e.min(f) }
    };
    points.into_iter().fold(0, |e, p| p.iter().fold(e, lowest))
}

fn integer(x: f64, exponent: i32) -> IBig {
    let (m, e) = decompose(x);
    if m == 0 { IBig::ZERO } else { IBig::from(m) << (e - exponent).max(0) as usize }
}

fn sub(a: &V3, b: &V3) -> V3 {
    [&a[0] - &b[0], &a[1] - &b[1], &a[2] - &b[2]]
}

fn cross(a: &V3, b: &V3) -> V3 {
    [&a[1] * &b[2] - &a[2] * &b[1], &a[2] * &b[0] - &a[0] * &b[2], &a[0] * &b[1] - &a[1] * &b[0]]
}

fn dot(a: &V3, b: &V3) -> IBig {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

/// Integer coordinates of explicit points, on demand.
pub struct Integers<'a> {
    /// Explicit points.
    pub points: &'a [Vec3],
    /// From [`common_exponent`].
    pub exponent: i32,
}

impl Integers<'_> {
    fn at(&self, v: u32) -> V3 {
        let p = &self.points[v as usize];
        [integer(p.x, self.exponent), integer(p.y, self.exponent), integer(p.z, self.exponent)]
    }

    fn plane(&self, t: &[u32; 3]) -> (V3, IBig) {
        let [a, b, c] = t.map(|v| self.at(v));
        let n = cross(&sub(&b, &a), &sub(&c, &a));
        let d = dot(&n, &a);
        (n, d)
    }

    /// The exact place of a point.
    pub fn place(&self, source: &Source) -> ExactPoint {
        let along = |p: V3, q: V3, num: IBig, den: IBig| {
            let step = sub(&q, &p);
            let xyz = [0, 1, 2].map(|k| &p[k] * &den + &step[k] * &num);
            (xyz, den)
        };
        let (xyz, w) = match source {
            Source::Explicit(v) => (self.at(*v), IBig::ONE),
            Source::LinePlane { line, plane } => {
                let [p, q] = line.map(|v| self.at(v));
                let (n, d) = self.plane(plane);
                let num = d - dot(&n, &p);
                let den = dot(&n, &sub(&q, &p));
                along(p, q, num, den)
            }
            Source::LineLine { line, other, projection } => {
                let [p, q] = line.map(|v| self.at(v));
                let [r, s] = other.map(|v| self.at(v));
                let (u, v) = (projection.u as usize, projection.v as usize);
                let flat = |a: &V3, b: &V3| &a[u] * &b[v] - &a[v] * &b[u];
                let (pr, rs, pq) = (sub(&r, &p), sub(&s, &r), sub(&q, &p));
                let (num, den) = (flat(&pr, &rs), flat(&pq, &rs));
                along(p, q, num, den)
            }
            Source::ThreePlanes(planes) => {
                let [(n1, d1), (n2, d2), (n3, d3)] = planes.map(|t| self.plane(&t));
                let (c23, c31, c12) = (cross(&n2, &n3), cross(&n3, &n1), cross(&n1, &n2));
                let w = dot(&n1, &c23);
                ([0, 1, 2].map(|k| &d1 * &c23[k] + &d2 * &c31[k] + &d3 * &c12[k]), w)
            }
            Source::Middle(corners) => {
                let [a, b, c] = corners.each_ref().map(|s| self.place(s));
                let (ab, bc, ca) = (&a.w * &b.w, &b.w * &c.w, &c.w * &a.w);
                let xyz = [0, 1, 2].map(|k| &a.xyz[k] * &bc + &b.xyz[k] * &ca + &c.xyz[k] * &ab);
                (xyz, ab * &c.w * IBig::from(3))
            }
        };
        if w < IBig::ZERO { ExactPoint { xyz: xyz.map(|x| -x), w: -w } } else { ExactPoint { xyz, w } }
    }
}

fn sign(x: &IBig) -> i8 {
    match x.cmp(&IBig::ZERO) {
        Ordering::Less => -1,
        Ordering::Equal => 0,
        Ordering::Greater => 1,
    }
}

/// Sign of the turn a, b, c in the projection onto axes u, v.
pub fn orient2d(a: &ExactPoint, b: &ExactPoint, c: &ExactPoint, u: usize, v: usize) -> i8 {
    let minor = |p: &ExactPoint, q: &ExactPoint| &p.xyz[u] * &q.xyz[v] - &p.xyz[v] * &q.xyz[u];
    sign(&(&a.w * minor(b, c) + &b.w * minor(c, a) + &c.w * minor(a, b)))
}

/// Sign of the volume a, b, c, d: +1 if d lies where the normal of a, b, c points.
pub fn orient3d(a: &ExactPoint, b: &ExactPoint, c: &ExactPoint, d: &ExactPoint) -> i8 {
    let edge = |p: &ExactPoint| [0, 1, 2].map(|k| &p.xyz[k] * &a.w - &a.xyz[k] * &p.w);
    sign(&dot(&cross(&edge(b), &edge(c)), &edge(d)))
}

/// Order of one coordinate.
pub fn compare(a: &ExactPoint, b: &ExactPoint, axis: usize) -> Ordering {
    (&a.xyz[axis] * &b.w).cmp(&(&b.xyz[axis] * &a.w))
}

/// Nearest double of a coordinate (within one unit in the last place).
pub fn to_f64(p: &ExactPoint, axis: usize, exponent: i32) -> f64 {
    // Scale so that the quotient has at least 64 significant bits, divide, round, scale back.
    let bits = |x: &IBig| {
        use dashu_int::ops::BitTest;
        x.bit_len() as i64
    };
    let x = &p.xyz[axis];
    if *x == IBig::ZERO {
        return 0.0;
    }
    let shift = (64 - (bits(x) - bits(&p.w))).max(0) as usize;
    let quotient = (x << shift) / &p.w;
    scale(quotient.to_f64().value(), exponent as i64 - shift as i64)
}

fn scale(mut x: f64, mut e: i64) -> f64 {
    while e < -900 {
        x *= 2f64.powi(-900);
        e += 900;
    }
    while e > 900 {
        x *= 2f64.powi(900);
        e -= 900;
    }
    x * 2f64.powi(e as i32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn line_meets_plane_at_a_third() {
        let points =
            [Vec3::zeros(), Vec3::new(1., 1., 1.), Vec3::new(1., 0., 0.), Vec3::new(0., 1., 0.), Vec3::new(0., 0., 1.)];
        let integers = Integers { points: &points, exponent: common_exponent(&points) };
        let p = integers.place(&Source::LinePlane { line: [0, 1], plane: [2, 3, 4] });
        for axis in 0..3 {
            assert_eq!(to_f64(&p, axis, integers.exponent), 1.0 / 3.0);
        }
        assert_eq!(
            orient3d(
                &integers.place(&Source::Explicit(2)),
                &integers.place(&Source::Explicit(3)),
                &integers.place(&Source::Explicit(4)),
                &p
            ),
            0
        );
    }

    #[test]
    fn fractions_scale_to_integers() {
        let points = [Vec3::new(0.1, -3.5, 1e-20), Vec3::new(7.0, 0.0, 1e9)];
        let e = common_exponent(&points);
        let integers = Integers { points: &points, exponent: e };
        for (v, p) in points.iter().enumerate() {
            let exact = integers.place(&Source::Explicit(v as u32));
            for k in 0..3 {
                assert_eq!(to_f64(&exact, k, e), p[k]);
            }
        }
    }
}
