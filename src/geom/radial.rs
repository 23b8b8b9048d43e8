//! The order of facets around an edge, from exact signs.

use super::Vec3;
use super::predicates::{Projection, Sign, orient2d, orient3d};
use std::cmp::Ordering;

/// The directed edge around which half-planes are ordered.
#[derive(Clone, Copy)]
pub struct Axis<'a> {
    /// Its start.
    pub from: &'a Vec3,
    /// Its end.
    pub to: &'a Vec3,
}

/// Where a half-plane lies, turning counter-clockwise from the reference: on it, before the straight angle, at it, past it.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Turn {
    None,
    Less,
    Straight,
    More,
}

impl Axis<'_> {
    /// Sign of the turn from the half-plane of `a` to that of `b`, in the sense of the right hand about the axis.
    fn turn(self, a: &Vec3, b: &Vec3) -> Sign {
        orient3d(self.from, self.to, a, b)
    }

    /// Which side of the axis `p` is on, in the projection along coordinate `axis`.
    fn side(self, axis: usize, p: &Vec3) -> Sign {
        let mut along = Vec3::zeros();
        along[axis] = 1.0;
        let flat = Projection::along(&along);
        orient2d(flat.apply(self.from), flat.apply(self.to), flat.apply(p))
    }

    /// Whether two points in one plane with the axis lie on the same side of it.
    fn is_same_side(self, a: &Vec3, b: &Vec3) -> bool {
        (0..3).map(|axis| (self.side(axis, a), self.side(axis, b))).find(|s| s.0 != 0).is_some_and(|s| s.0 == s.1)
    }

    fn place(self, reference: &Vec3, p: &Vec3) -> Turn {
        match self.turn(reference, p) {
            1 => Turn::Less,
            -1 => Turn::More,
            _ if self.is_same_side(reference, p) => Turn::None,
            _ => Turn::Straight,
        }
    }

    /// Orders half-planes by the angle, counter-clockwise seen against the axis, from that through `reference`. Exact; equal if
    /// two coincide. The points must not lie on the axis.
    pub fn compare(self, reference: &Vec3, a: &Vec3, b: &Vec3) -> Ordering {
        let (at, bt) = (self.place(reference, a), self.place(reference, b));
        at.cmp(&bt).then_with(|| match at {
            Turn::Less | Turn::More => self.turn(a, b).cmp(&0).reverse(),
            Turn::None | Turn::Straight => Ordering::Equal,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn order_is_the_angle() {
        let (from, to) = (Vec3::new(1.0, 2.0, 3.0), Vec3::new(1.0, 2.0, 5.0));
        let at = |degrees: f64| {
            let (s, c) = libm::sincos(degrees.to_radians());
            from + Vec3::new(c, s, 0.25)
        };
        for start in [0.0, 10.0, 133.0, 250.0] {
            let mut angles = [170.0, 5.0, 359.0, 181.0, 90.0, 270.0, 0.0];
            let axis = Axis { from: &from, to: &to };
            angles.sort_by(|a, b| axis.compare(&at(start), &at(start + a), &at(start + b)));
            assert_eq!(angles, [0.0, 5.0, 90.0, 170.0, 181.0, 270.0, 359.0]);
        }
    }

    #[test]
    fn straight_angle_and_coincidence_are_exact() {
        let axis = Axis { from: &Vec3::zeros(), to: &Vec3::new(1.0, 1.0, 1.0) };
        let (r, same, straight) = (Vec3::new(2.0, 1.0, 1.0), Vec3::new(5.0, 3.0, 3.0), Vec3::new(-1.0, 1.0, 1.0));
        assert_eq!(axis.compare(&r, &r, &same), Ordering::Equal);
        assert_eq!(axis.compare(&r, &same, &straight), Ordering::Less);
    }
}
