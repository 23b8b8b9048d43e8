//! Quality of the triangles of a volume mesh (thesis 2.4.1), by ranges.

use super::distribution::Distribution;
use super::quality;
use crate::geom::Vec3;
use serde::Serialize;

/// Smallest angle in degrees below which, and above which, the thesis counts triangles.
const SMALL: f64 = 30.0;
const GOOD: f64 = 40.0;
/// An equilateral triangle's 30.000 must not count as below 30.
const ROUNDING: f64 = 1e-9;

/// Statistics of triangles; angles in degrees.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct TriangleStatistics {
    /// Their number.
    pub triangles: u64,
    /// Percentage with a smallest angle under 30 degrees.
    pub percent_below_30: f64,
    /// Percentage with a smallest angle over 40 degrees.
    pub percent_above_40: f64,
    /// Shortest edge.
    pub min_edge: f64,
    /// Longest edge.
    pub max_edge: f64,
    /// Smallest angle of each.
    pub min_angle: Distribution,
    /// Largest angle of each.
    pub max_angle: Distribution,
    /// Circumradius over inradius: 2 is equilateral.
    pub aspect: Distribution,
    /// Shape measure, 4 sqrt(3) area over the sum of squared edges: 1 is equilateral, 0 flat.
    pub distortion: Distribution,
}

impl TriangleStatistics {
    /// Of these triangles.
    pub fn new(triangles: &[[Vec3; 3]]) -> Self {
        let measured: Vec<_> = triangles.iter().map(|t| quality::triangle(*t)).collect();
        let edges = |[a, b, c]: &[Vec3; 3]| [b - a, c - b, a - c].map(|e| e.norm());
        let lengths = || triangles.iter().flat_map(edges);
        let percent = |count: usize| 100.0 * count as f64 / triangles.len().max(1) as f64;
        Self {
            triangles: triangles.len() as u64,
            percent_below_30: percent(measured.iter().filter(|q| q.min_angle < SMALL - ROUNDING).count()),
            percent_above_40: percent(measured.iter().filter(|q| q.min_angle > GOOD).count()),
            min_edge: lengths().reduce(f64::min).unwrap_or(0.0),
            max_edge: lengths().fold(0.0, f64::max),
            min_angle: Distribution::new(
                "smallest angle",
                &[0.0, 1.0, 5.0, 10.0, 20.0, 30.0, 40.0, 50.0],
                measured.iter().map(|q| q.min_angle),
            ),
            max_angle: Distribution::new(
                "largest angle",
                &[60.0, 80.0, 100.0, 120.0, 140.0, 160.0, 170.0],
                measured.iter().map(|q| q.max_angle),
            ),
            aspect: Distribution::new(
                "aspect ratio R/r",
                &[2.0, 2.5, 3.0, 4.0, 6.0, 10.0, 20.0, 100.0],
                measured.iter().map(|q| q.aspect_ratio),
            ),
            distortion: Distribution::new(
                "distortion",
                &[0.0, 0.1, 0.2, 0.4, 0.6, 0.8, 0.9],
                measured.iter().map(|q| q.distortion),
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equilateral_and_half_square() {
        let equilateral = [Vec3::zeros(), Vec3::x(), Vec3::new(0.5, 0.75f64.sqrt(), 0.0)];
        let half_square = [Vec3::zeros(), Vec3::x(), Vec3::y()];
        let q = TriangleStatistics::new(&[equilateral, half_square]);
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} is not {b}");
        close(q.min_angle.min, 45.0);
        close(q.max_angle.max, 90.0);
        close(q.aspect.min, 2.0);
        // R = sqrt(2) / 2, r = 1 / (2 + sqrt(2)).
        close(q.aspect.max, 0.5f64.sqrt() * (2.0 + 2f64.sqrt()));
        close(q.distortion.max, 1.0);
        close(q.distortion.min, 3f64.sqrt() / 2.0);
        close(q.max_edge, 2f64.sqrt());
        assert_eq!((q.percent_below_30, q.percent_above_40), (0.0, 100.0));
    }
}
