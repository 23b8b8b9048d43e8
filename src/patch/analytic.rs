//! Exact surfaces of primitives.

use super::support::{Foot, Nearest, Support, any_normal_to, bending_of_level};
use crate::geom::{Affine, Vec3};
use crate::primitive::solid::Shape;
use crate::scene::model::Frame;
use nalgebra::Matrix3;

pub use super::ellipsoid::Ellipsoid;

/// The smallest radius, as a fraction of the reference size, at which a curvature 1 / radius is still told apart from that of
/// an apex; keeps curvatures finite.
const SMALLEST_RADIUS: f64 = 1e-12;

/// The exact support of a shape; `None` for planes (facets carry their own) and sampled surfaces.
pub fn support_of_shape(shape: &Shape) -> Option<Support> {
    match shape {
        Shape::Plane | Shape::Sampled => None,
        Shape::Cone { frame, radius, slope } => Some(Support::Cone(Cone::new(*frame, *radius, *slope))),
        Shape::Ellipsoid { frame, radii } => Some(Support::Ellipsoid(Ellipsoid::new(*frame, *radii))),
        Shape::Torus { frame, major_radius, minor_radius } => {
            Some(Support::Torus(Torus { frame: *frame, major: *major_radius, minor: *minor_radius }))
        }
        Shape::Image { shape, map } => Some(Support::Image(Box::new(Image::new(support_of_shape(shape)?, *map)?))),
    }
}

/// Coordinates of a point in a frame.
pub(super) fn into_frame(frame: &Frame, point: &Vec3) -> Vec3 {
    let d = point - frame.origin;
    Vec3::new(d.dot(&frame.x), d.dot(&frame.y), d.dot(&frame.z))
}

/// A direction given in a frame's coordinates.
pub(super) fn out_of_frame(frame: &Frame, v: &Vec3) -> Vec3 {
    frame.x * v.x + frame.y * v.y + frame.z * v.z
}

/// Axial and radial part of a point: unit radial direction (x of the frame on the axis), radius, height.
fn cylindrical(frame: &Frame, point: &Vec3) -> (Vec3, f64, f64) {
    let local = into_frame(frame, point);
    let radius = (local.x * local.x + local.y * local.y).sqrt();
    let radial = if radius > 0.0 { (frame.x * local.x + frame.y * local.y) / radius } else { frame.x };
    (radial, radius, local.z)
}

/// Circular cylinder or cone about the frame's z axis; unbounded, one nappe.
#[derive(Clone, Debug)]
pub struct Cone {
    frame: Frame,
    radius: f64,
    slope: f64,
    /// Length of (1, slope).
    stretch: f64,
}

impl Cone {
    /// The cone of radius `radius + slope * z`.
    pub fn new(frame: Frame, radius: f64, slope: f64) -> Self {
        Self { frame, radius, slope, stretch: libm::hypot(1.0, slope) }
    }

    pub(super) fn closest(&self, point: &Vec3) -> Foot {
        let Nearest { point, normal, curvature } = self.nearest(point);
        let around = self.frame.z.cross(&normal).try_normalize(0.0).unwrap_or(self.frame.y);
        Foot { point, normal, bending: around * around.transpose() * curvature }
    }

    pub(super) fn nearest(&self, point: &Vec3) -> Nearest {
        let (radial, radius, height) = cylindrical(&self.frame, point);
        // In the half plane (radius, height): the foot on the line radius = r + slope * height, not below the axis.
        let along = (height + self.slope * (radius - self.radius)) / (self.stretch * self.stretch);
        let mut foot_radius = self.radius + self.slope * along;
        let mut foot_height = along;
        if foot_radius < 0.0 {
            foot_radius = 0.0;
            foot_height = -self.radius / self.slope;
        }
        let normal = (radial - self.frame.z * self.slope) / self.stretch;
        let least = SMALLEST_RADIUS * (self.radius.abs() + height.abs() + radius);
        let curvature = 1.0 / (self.stretch * foot_radius.max(least).max(f64::MIN_POSITIVE));
        Nearest { point: self.frame.origin + radial * foot_radius + self.frame.z * foot_height, normal, curvature }
    }
}

/// Torus about the frame's z axis.
#[derive(Clone, Debug)]
pub struct Torus {
    frame: Frame,
    major: f64,
    minor: f64,
}

impl Torus {
    pub(super) fn closest(&self, point: &Vec3) -> Foot {
        let (Nearest { point, normal, .. }, radial, across) = self.foot(point);
        let around = self.frame.z.cross(&radial);
        let tube = normal.cross(&around);
        let bending = tube * tube.transpose() / self.minor + around * around.transpose() * across;
        Foot { point, normal, bending }
    }

    pub(super) fn nearest(&self, point: &Vec3) -> Nearest {
        self.foot(point).0
    }

    /// The foot, the direction from the axis to it and the curvature around the axis.
    fn foot(&self, point: &Vec3) -> (Nearest, Vec3, f64) {
        let (radial, _, _) = cylindrical(&self.frame, point);
        let center = self.frame.origin + radial * self.major;
        let normal = (point - center).try_normalize(0.0).unwrap_or(radial);
        let outward = normal.dot(&radial);
        let across = outward / (self.major + self.minor * outward).max(SMALLEST_RADIUS * self.major);
        let curvature = across.abs().max(1.0 / self.minor);
        (Nearest { point: center + normal * self.minor, normal, curvature }, radial, across)
    }
}

/// The affine image of a surface.
#[derive(Clone, Debug)]
pub struct Image {
    shape: Support,
    map: Affine,
    inverse: Affine,
    /// The linear part of the inverse.
    linear: Matrix3<f64>,
}

/// Steps after which the iteration for an image gives up improving; near the surface three are enough.
const IMAGE_STEPS: usize = 60;
/// Distance from an image towards a centre of curvature, in radii, up to which steps follow its bending: well before the
/// centre.
const NEAR_IMAGE: f64 = 0.5;
/// Such a step, in radii of curvature, after which the foot is exact but for rounding, by quadratic convergence.
const LAST_STEP: f64 = 1e-8;

impl Image {
    /// The image of a support; `None` if the map is singular.
    pub fn new(shape: Support, map: Affine) -> Option<Self> {
        let inverse = map.try_inverse()?;
        let linear = inverse.matrix().fixed_view::<3, 3>(0, 0).into_owned();
        Some(Self { shape, map, inverse, linear })
    }

    pub(super) fn closest(&self, point: &Vec3) -> Foot {
        self.image_foot(&self.approach(point).0)
    }

    pub(super) fn nearest(&self, point: &Vec3) -> Nearest {
        let paraboloid = self.approach(point).1;
        Nearest { point: paraboloid.apex, normal: paraboloid.normal, curvature: paraboloid.largest_curvature() }
    }

    /// Foot by Newton's method: a step in the tangent plane of the image at the last foot, pulled back, and the closest point
    /// of the shape to that. Gives the foot on the shape and the image around it.
    fn approach(&self, point: &Vec3) -> (Foot, Paraboloid) {
        let mut foot = self.shape.closest(&self.pull_back(point));
        let mut at = self.paraboloid(&foot);
        for _ in 0..IMAGE_STEPS {
            let (step, is_newton) = at.step_towards(point);
            foot = self.shape.closest(&self.pull_back(&(at.apex + step)));
            let next = self.paraboloid(&foot);
            let moved = (next.apex - at.apex).norm();
            at = next;
            let is_last = is_newton && moved * at.largest_curvature() <= LAST_STEP;
            if is_last || moved <= 4.0 * f64::EPSILON * at.apex.amax() {
                break;
            }
        }
        (foot, at)
    }

    /// The image about that of a foot of the shape.
    fn paraboloid(&self, foot: &Foot) -> Paraboloid {
        let gradient = self.linear.tr_mul(&foot.normal);
        let length = gradient.norm();
        let normal = gradient / length;
        let u = any_normal_to(&normal);
        let tangents = [u, normal.cross(&u)];
        let [p, q] = tangents.map(|t| self.linear * t);
        let (bent, across) = (foot.bending * p, foot.bending * q);
        let bending = [p.dot(&bent), p.dot(&across), q.dot(&across)].map(|b| b / length);
        Paraboloid { apex: self.map.transform_point(&foot.point.into()).coords, normal, tangents, bending }
    }

    fn pull_back(&self, point: &Vec3) -> Vec3 {
        self.inverse.transform_point(&(*point).into()).coords
    }

    fn image_foot(&self, foot: &Foot) -> Foot {
        let gradient = self.linear.tr_mul(&foot.normal);
        let hessian = self.linear.tr_mul(&(foot.bending * self.linear));
        Foot {
            point: self.map.transform_point(&foot.point.into()).coords,
            normal: gradient.try_normalize(0.0).unwrap_or_else(|| any_normal_to(&foot.normal)),
            bending: bending_of_level(&gradient, &hessian),
        }
    }
}

/// A surface about one of its points, to second order.
struct Paraboloid {
    apex: Vec3,
    normal: Vec3,
    /// Orthogonal unit vectors.
    tangents: [Vec3; 2],
    /// Second fundamental form by these: of the first, mixed, of the second.
    bending: [f64; 3],
}

impl Paraboloid {
    fn largest_curvature(&self) -> f64 {
        let [a, b, c] = self.bending;
        let (mean, half) = ((a + c) * 0.5, (a - c) * 0.5);
        mean.abs() + (half * half + b * b).sqrt()
    }

    /// The step in the tangent plane after which the foot of a point is there but for the second order, and true; near a centre
    /// of curvature the step to beneath the point, and false.
    fn step_towards(&self, point: &Vec3) -> (Vec3, bool) {
        let way = point - self.apex;
        let height = self.normal.dot(&way);
        let [u, v] = &self.tangents;
        let (s, t) = (u.dot(&way), v.dot(&way));
        // Normals turn by bending times step, and the foot moves by height times that less.
        let [a, b, c] = self.bending.map(|b| b * height);
        if 0.5 * ((a + c) - libm::hypot(a - c, 2.0 * b)) < -NEAR_IMAGE {
            return (u * s + v * t, false);
        }
        let determinant = (1.0 + a) * (1.0 + c) - b * b;
        ((u * ((1.0 + c) * s - b * t) + v * ((1.0 + a) * t - b * s)) / determinant, true)
    }
}

#[cfg(test)]
#[path = "analytic_tests.rs"]
mod tests;
