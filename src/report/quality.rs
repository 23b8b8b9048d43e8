//! Shape of triangles (thesis 2.4.1).

use crate::geom::Vec3;
use serde::Serialize;
use std::f64::consts::PI;

/// Measures of one triangle.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct TriangleQuality {
    /// Smallest angle, in degrees (2.4.1.1); 60 at best.
    pub min_angle: f64,
    /// Largest angle, in degrees.
    pub max_angle: f64,
    /// Circumradius over inradius (2.4.1.2); 2 at best, infinite without area.
    pub aspect_ratio: f64,
    /// Shape measure 4 sqrt(3) area / sum of squared edges (2.4.1.3, distortion metric): 1 at best, 0 without area.
    pub distortion: f64,
}

/// Measures a triangle. One without area has the angles 0 and 180 degrees.
pub fn triangle([a, b, c]: [Vec3; 3]) -> TriangleQuality {
    let edges = [c - b, a - c, b - a];
    let twice_area = edges[2].cross(&edges[1]).norm();
    let [p, q, r] = edges.map(|e| e.norm());
    let squares = p * p + q * q + r * r;
    if twice_area <= 0.0 {
        return TriangleQuality { min_angle: 0.0, max_angle: 180.0, aspect_ratio: f64::INFINITY, distortion: 0.0 };
    }
    // The tangent form keeps its digits at 0 and 180 degrees.
    let angle = |k: usize| {
        let cosine = -edges[(k + 1) % 3].dot(&edges[(k + 2) % 3]);
        libm::atan2(twice_area, cosine) * 180.0 / PI
    };
    let angles = [angle(0), angle(1), angle(2)];
    // R = pqr / (4 A), r = 2 A / (p + q + r).
    let aspect_ratio = p * q * r * (p + q + r) / (2.0 * twice_area * twice_area);
    TriangleQuality {
        min_angle: angles.into_iter().fold(f64::INFINITY, f64::min),
        max_angle: angles.into_iter().fold(0.0, f64::max),
        aspect_ratio,
        distortion: 2.0 * 3.0f64.sqrt() * twice_area / squares,
    }
}

/// Quality of a set of triangles. Shares are fractions of their number.
#[derive(Clone, Copy, PartialEq, Debug, Default, Serialize)]
pub struct Distribution {
    /// Number of triangles.
    pub triangles: usize,
    /// Smallest angle of all, in degrees.
    pub min_angle: f64,
    /// Largest angle of all, in degrees.
    pub max_angle: f64,
    /// Share whose smallest angle is below 30 degrees.
    pub below_30: f64,
    /// Share whose smallest angle is above 40 degrees.
    pub above_40: f64,
    /// Largest aspect ratio.
    pub max_aspect_ratio: f64,
    /// Mean distortion metric.
    pub mean_distortion: f64,
}

/// The distribution over some triangles; `None` if there are none.
pub fn distribution(triangles: impl IntoIterator<Item = [Vec3; 3]>) -> Option<Distribution> {
    let mut d = Distribution { min_angle: f64::INFINITY, ..Distribution::default() };
    let (mut below, mut above) = (0usize, 0usize);
    for corners in triangles {
        let q = triangle(corners);
        d.triangles += 1;
        d.min_angle = d.min_angle.min(q.min_angle);
        d.max_angle = d.max_angle.max(q.max_angle);
        d.max_aspect_ratio = d.max_aspect_ratio.max(q.aspect_ratio);
        d.mean_distortion += q.distortion;
        below += usize::from(q.min_angle < 30.0);
        above += usize::from(q.min_angle > 40.0);
    }
    if d.triangles == 0 {
        return None;
    }
    let n = d.triangles as f64;
    d.mean_distortion /= n;
    d.below_30 = below as f64 / n;
    d.above_40 = above as f64 / n;
    Some(d)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(x: f64, y: f64) -> bool {
        (x - y).abs() < 1e-12 * y.abs().max(1.0)
    }

    #[test]
    fn known_triangles() {
        let v = Vec3::new;
        let best = triangle([v(0., 0., 0.), v(1., 0., 0.), v(0.5, 0.0, 0.75f64.sqrt())]);
        assert!(near(best.min_angle, 60.0) && near(best.max_angle, 60.0));
        assert!(near(best.aspect_ratio, 2.0) && near(best.distortion, 1.0), "{best:?}");
        // 3-4-5: R = 2.5, r = 1, area 6, squared edges 50.
        let right = triangle([v(0., 0., 0.), v(3., 0., 0.), v(0., 4., 0.)]);
        assert!(near(right.max_angle, 90.0) && near(right.aspect_ratio, 2.5));
        assert!(near(right.distortion, 24.0 * 3.0f64.sqrt() / 50.0));
        let flat = triangle([v(0., 0., 0.), v(3., 0., 0.), v(1., 0., 0.)]);
        assert_eq!((flat.min_angle, flat.max_angle, flat.distortion), (0.0, 180.0, 0.0));
    }

    #[test]
    fn shares_count_triangles() {
        let v = Vec3::new;
        let good = [v(0., 0., 0.), v(1., 0., 0.), v(0.5, 0.0, 0.75f64.sqrt())];
        let poor = [v(0., 0., 0.), v(4., 0., 0.), v(0., 1., 0.)];
        let d = distribution([good, poor, poor, poor]).unwrap();
        assert_eq!((d.triangles, d.below_30, d.above_40), (4, 0.75, 0.25));
        assert!(near(d.min_angle, libm::atan(0.25) * 180.0 / PI));
        assert_eq!(distribution([]), None);
    }
}
