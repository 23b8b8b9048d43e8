//! Quality of tetrahedra (thesis 2.4.2).

use super::distribution::Distribution;
use crate::geom::Vec3;
use serde::Serialize;

/// A ratio counts as above the bound only beyond rounding.
pub(super) const ROUNDING: f64 = 1e-9;

/// Statistics of tetrahedra; angles in degrees.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct TetQuality {
    /// Their number.
    pub tets: u64,
    /// Sum of their volumes.
    pub volume: f64,
    /// The wanted radius-edge ratio.
    pub ratio_bound: f64,
    /// How many are above it.
    pub above_bound: u64,
    /// Circumradius over shortest edge: 0.612 is regular.
    pub radius_edge: Distribution,
    /// Circumradius over inradius: 3 is regular.
    pub aspect: Distribution,
    /// Smallest dihedral angle of each: 70.5 is regular.
    pub min_dihedral: Distribution,
    /// Largest dihedral angle of each.
    pub max_dihedral: Distribution,
}

/// The measures of one tetrahedron.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct TetShape {
    /// Volume, positive.
    pub volume: f64,
    /// Circumradius over shortest edge; infinite if flat.
    pub radius_edge: f64,
    /// Circumradius over inradius; infinite if flat.
    pub aspect: f64,
    /// Smallest and largest dihedral angle, in degrees.
    pub dihedral: [f64; 2],
}

impl TetShape {
    /// Of the tetrahedron with these corners, in any order.
    pub fn new(p: &[Vec3; 4]) -> Self {
        let (a, b, c) = (p[1] - p[0], p[2] - p[0], p[3] - p[0]);
        let six = a.dot(&b.cross(&c)).abs();
        let numerator = a.norm_squared() * b.cross(&c) + b.norm_squared() * c.cross(&a) + c.norm_squared() * a.cross(&b);
        let radius = numerator.norm() / (2.0 * six);
        // Each edge with the two corners that are not on it.
        const EDGES: [[usize; 4]; 6] = [[0, 1, 2, 3], [0, 2, 1, 3], [0, 3, 1, 2], [1, 2, 0, 3], [1, 3, 0, 2], [2, 3, 0, 1]];
        let mut shortest = f64::INFINITY;
        let mut dihedral = [f64::INFINITY, 0.0];
        for [i, j, k, l] in EDGES {
            let e = p[j] - p[i];
            shortest = shortest.min(e.norm());
            let (m, n) = (e.cross(&(p[k] - p[i])), e.cross(&(p[l] - p[i])));
            let angle = libm::atan2(m.cross(&n).norm(), m.dot(&n)).to_degrees();
            dihedral = [dihedral[0].min(angle), dihedral[1].max(angle)];
        }
        // Twice the surface: the inradius is 3 V / surface, so R/r = R * doubled / (6 V).
        let doubled = a.cross(&b).norm() + b.cross(&c).norm() + c.cross(&a).norm() + (b - a).cross(&(c - a)).norm();
        let finite = |x: f64| if x.is_finite() { x } else { f64::INFINITY };
        Self { volume: six / 6.0, radius_edge: finite(radius / shortest), aspect: finite(radius * doubled / six), dihedral }
    }
}

impl TetQuality {
    /// Of these tetrahedra.
    pub fn new(shapes: &[TetShape], ratio_bound: f64) -> Self {
        let limit = ratio_bound * (1.0 + ROUNDING);
        Self {
            tets: shapes.len() as u64,
            volume: shapes.iter().map(|s| s.volume).sum(),
            ratio_bound,
            above_bound: shapes.iter().filter(|s| s.radius_edge > limit).count() as u64,
            radius_edge: Distribution::new(
                "radius-edge ratio",
                &[0.0, 0.8, 1.0, 1.2, 1.4, 1.6, 2.0, 3.0, 5.0, 10.0, 100.0],
                shapes.iter().map(|s| s.radius_edge),
            ),
            aspect: Distribution::new(
                "aspect ratio R/r",
                &[3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 20.0, 50.0, 100.0, 1000.0],
                shapes.iter().map(|s| s.aspect),
            ),
            min_dihedral: Distribution::new(
                "smallest dihedral angle",
                &[0.0, 1.0, 5.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0],
                shapes.iter().map(|s| s.dihedral[0]),
            ),
            max_dihedral: Distribution::new(
                "largest dihedral angle",
                &[70.0, 80.0, 100.0, 120.0, 140.0, 160.0, 170.0, 175.0, 179.0],
                shapes.iter().map(|s| s.dihedral[1]),
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regular_and_corner_of_a_cube() {
        let v = Vec3::new;
        let regular = TetShape::new(&[v(1., 1., 1.), v(1., -1., -1.), v(-1., 1., -1.), v(-1., -1., 1.)]);
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} is not {b}");
        close(regular.volume, 8.0 / 3.0);
        close(regular.radius_edge, 6f64.sqrt() / 4.0);
        close(regular.aspect, 3.0);
        close(regular.dihedral[0], libm::acos(1.0 / 3.0).to_degrees());
        close(regular.dihedral[0], regular.dihedral[1]);
        let corner = TetShape::new(&[Vec3::zeros(), Vec3::x(), Vec3::y(), Vec3::z()]);
        close(corner.radius_edge, 0.75f64.sqrt());
        close(corner.dihedral[1], 90.0);
        // Inradius 1 / (3 + sqrt(3)).
        close(corner.aspect, 0.75f64.sqrt() * (3.0 + 3f64.sqrt()));
    }

    #[test]
    fn flat_ones_are_infinite_not_undefined() {
        let flat = TetShape::new(&[Vec3::zeros(), Vec3::x(), Vec3::y(), Vec3::new(1.0, 1.0, 0.0)]);
        assert_eq!((flat.radius_edge, flat.aspect), (f64::INFINITY, f64::INFINITY));
        assert_eq!(TetQuality::new(&[flat], 2.0).above_bound, 1);
    }
}
