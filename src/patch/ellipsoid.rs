//! Closest point of an ellipsoid.

use super::analytic::{into_frame, out_of_frame};
use super::support::{Foot, Nearest, bending_of_level};
use crate::geom::Vec3;
use crate::scene::model::Frame;
use nalgebra::{Matrix3, Rotation3};

/// Newton steps at most; from the left end of the bracket the modified step needs about ten, near the surface three.
const MAX_STEPS: usize = 60;

/// Ellipsoid with half axes along the axes of a frame.
#[derive(Clone, Debug)]
pub struct Ellipsoid {
    frame: Frame,
    radii: Vec3,
}

impl Ellipsoid {
    /// The ellipsoid with these half axes, all positive.
    pub fn new(frame: Frame, radii: Vec3) -> Self {
        Self { frame, radii }
    }

    /// The closest point if the half axes are equal and the point is not the centre.
    fn on_sphere(&self, point: &Vec3) -> Option<Nearest> {
        let radius = self.radii.x;
        if self.radii.y != radius || self.radii.z != radius {
            return None;
        }
        let normal = (point - self.frame.origin).try_normalize(0.0)?;
        Some(Nearest { point: self.frame.origin + normal * radius, normal, curvature: 1.0 / radius })
    }

    pub(super) fn nearest(&self, point: &Vec3) -> Nearest {
        self.on_sphere(point).unwrap_or_else(|| {
            let (foot, gradient, squares) = self.foot(point);
            let length = gradient.norm();
            // Mean and Gaussian curvature of a level surface (Goldman 2005); its Hessian is diagonal here.
            let bent = gradient.component_mul(&squares).dot(&gradient);
            let mean = (length * length * squares.sum() - bent) / (2.0 * length.powi(3));
            let minors = Vec3::new(squares.y * squares.z, squares.z * squares.x, squares.x * squares.y);
            let gaussian = gradient.component_mul(&minors).dot(&gradient) / length.powi(4);
            let curvature = mean + (mean * mean - gaussian).max(0.0).sqrt();
            let [point, normal] = [foot, gradient / length].map(|v| out_of_frame(&self.frame, &v));
            Nearest { point: self.frame.origin + point, normal, curvature }
        })
    }

    /// Foot of a point, gradient of the level there and inverse squares of the half axes, in the frame's coordinates.
    fn foot(&self, point: &Vec3) -> (Vec3, Vec3, Vec3) {
        let local = into_frame(&self.frame, point);
        let foot = closest_in_octant(&self.radii, &local.abs());
        let foot = Vec3::new(foot.x.copysign(local.x), foot.y.copysign(local.y), foot.z.copysign(local.z));
        let squares = self.radii.map(|r| 1.0 / (r * r));
        (foot, foot.component_mul(&squares), squares)
    }

    pub(super) fn closest(&self, point: &Vec3) -> Foot {
        if let Some(Nearest { point, normal, curvature }) = self.on_sphere(point) {
            return Foot { point, normal, bending: (Matrix3::identity() - normal * normal.transpose()) * curvature };
        }
        let (foot, gradient, squares) = self.foot(point);
        let gradient = out_of_frame(&self.frame, &gradient);
        let axes = Rotation3::from_basis_unchecked(&[self.frame.x, self.frame.y, self.frame.z]);
        let hessian = axes.matrix() * Matrix3::from_diagonal(&squares) * axes.matrix().transpose();
        Foot {
            point: self.frame.origin + out_of_frame(&self.frame, &foot),
            normal: gradient.normalize(),
            bending: bending_of_level(&gradient, &hessian),
        }
    }
}

/// The closest point in the octant of positive coordinates to a point of it, after Eberly, "Distance from a point to an
/// ellipse, an ellipsoid, or a hyperellipsoid" (2013): the foot is r² y / (r² + t) for the largest root t of the secular
/// equation, found from the left of the root by Newton's method on its reciprocal square root (Moré 1978), which is
/// nearly linear. The special case of points in the plane of symmetry across the smallest axis is kept apart.
fn closest_in_octant(radii: &Vec3, point: &Vec3) -> Vec3 {
    let least = radii.min();
    // Everything relative to the smallest half axis: ratio >= 1, s > -1.
    let ratio = radii.map(|r| (r / least) * (r / least));
    let z = point.component_div(radii);
    let start = (0..3).map(|k| ratio[k] * (z[k] - 1.0)).fold(-1.0, f64::max);
    let terms = |s: f64| (0..3).filter(|&k| z[k] > 0.0).map(move |k| (ratio[k] * z[k] / (s + ratio[k]), s + ratio[k]));
    let value = |s: f64| terms(s).map(|(x, _)| x * x).sum::<f64>();
    // A start right of -1 comes from a term that is 1 there, so the root is not left of it.
    if start <= -1.0 && value(start) < 1.0 {
        return foot_across_smallest(radii, &ratio, point);
    }
    // Near the surface the root is near 0, and a step from there leaves little to do; right of it the first step leads left.
    let mut s = start.max(0.0);
    for _ in 0..MAX_STEPS {
        let g = value(s);
        let slope: f64 = terms(s).map(|(x, d)| x * x / d).sum();
        let step = g * (g.sqrt() - 1.0) / slope;
        if !step.is_finite() || step.abs() <= f64::EPSILON * (1.0 + s.abs()) {
            break;
        }
        s = (s + step).max(start);
    }
    let foot = Vec3::from_fn(|k, _| if z[k] > 0.0 { ratio[k] * point[k] / (s + ratio[k]) } else { 0.0 });
    // Onto the surface exactly, along the ray from the centre: removes what is left of the iteration's error.
    let level = foot.component_div(radii).norm();
    if level > 0.0 { foot / level } else { foot_across_smallest(radii, &ratio, point) }
}

/// The foot of a point near the middle, off the smallest axis: two mirror feet exist, the positive one is given.
fn foot_across_smallest(radii: &Vec3, ratio: &Vec3, point: &Vec3) -> Vec3 {
    let small = radii.imin();
    let mut foot = Vec3::from_fn(|k, _| if ratio[k] > 1.0 { ratio[k] * point[k] / (ratio[k] - 1.0) } else { 0.0 });
    foot[small] = 0.0;
    let rest = 1.0 - foot.component_div(radii).norm_squared();
    foot[small] = radii[small] * rest.max(0.0).sqrt();
    foot
}
