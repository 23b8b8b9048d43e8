//! The nearest points of segments.

use super::Vec3;

/// Where on the segment from `a` to `b` the point nearest to `point` lies: 0 at `a`, 1 at `b`; 0 if the ends are equal.
pub fn share_nearest(point: &Vec3, [a, b]: [&Vec3; 2]) -> f64 {
    let along = b - a;
    let square = along.norm_squared();
    if square > 0.0 { (along.dot(&(point - a)) / square).clamp(0.0, 1.0) } else { 0.0 }
}

/// The point of a segment that is nearest to `point`.
pub fn nearest_on(point: &Vec3, [a, b]: [&Vec3; 2]) -> Vec3 {
    a + (b - a) * share_nearest(point, [a, b])
}

/// The distance of a point from a segment.
pub fn distance_to(point: &Vec3, ends: [&Vec3; 2]) -> f64 {
    (nearest_on(point, ends) - point).norm()
}

/// Distance of two segments and a place of it on the first (Ericson 2005, 5.1.9). Neither may have length zero.
pub fn between(p: &[Vec3; 2], q: &[Vec3; 2]) -> (f64, Vec3) {
    let (d, e, r) = (p[1] - p[0], q[1] - q[0], p[0] - q[0]);
    let (a, b, c, f) = (d.norm_squared(), d.dot(&e), e.norm_squared(), e.dot(&r));
    let area = d.cross(&e).norm_squared();
    let s = if area > 0.0 { ((b * f - d.dot(&r) * c) / area).clamp(0.0, 1.0) } else { 0.0 };
    let t = ((b * s + f) / c).clamp(0.0, 1.0);
    let s = ((b * t - d.dot(&r)) / a).clamp(0.0, 1.0);
    let place = p[0] + d * s;
    ((place - (q[0] + e * t)).norm(), place)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inside_beyond_and_without_length() {
        let [a, b] = [Vec3::new(1.0, 0.0, 0.0), Vec3::new(3.0, 0.0, 0.0)];
        assert_eq!(share_nearest(&Vec3::new(1.5, 7.0, 0.0), [&a, &b]), 0.25);
        assert_eq!(nearest_on(&Vec3::new(1.5, 7.0, 0.0), [&a, &b]), Vec3::new(1.5, 0.0, 0.0));
        assert_eq!(nearest_on(&Vec3::new(9.0, 1.0, 1.0), [&a, &b]), b);
        assert_eq!(distance_to(&Vec3::new(1.5, 7.0, 0.0), [&a, &b]), 7.0);
        assert_eq!(nearest_on(&Vec3::new(9.0, 1.0, 1.0), [&a, &a]), a);
    }

    #[test]
    fn segments_that_pass_lie_beyond_or_are_parallel() {
        let x = [Vec3::zeros(), Vec3::new(4.0, 0.0, 0.0)];
        let at = |a: [f64; 3], b: [f64; 3]| between(&x, &[Vec3::from(a), Vec3::from(b)]);
        assert_eq!(at([1.0, -1.0, 2.0], [1.0, 1.0, 2.0]), (2.0, Vec3::new(1.0, 0.0, 0.0)));
        assert_eq!(at([7.0, 4.0, 0.0], [7.0, 9.0, 0.0]), (5.0, x[1]));
        assert_eq!(at([0.0, 3.0, 0.0], [4.0, 3.0, 0.0]).0, 3.0);
    }
}
