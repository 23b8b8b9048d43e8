//! The nearest point of a segment.

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
}
