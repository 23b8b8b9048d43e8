//! The one interface of all supports: where the surface is, how it lies there and how it bends.

use super::analytic::{Cone, Ellipsoid, Image, Torus};
use super::fit::FittedSurface;
use super::plane::Plane;
use crate::geom::Vec3;
use nalgebra::Matrix3;

/// A direction is straight on a surface if its curvature is below this fraction of the largest: far above rounding, far below
/// what any facet could show.
const STRAIGHT: f64 = 1e-6;
/// The same on fitted patches, whose curvature is known to some per cent only.
const STRAIGHT_AS_FITTED: f64 = 0.05;

/// A point of a surface with its second-order neighbourhood.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Foot {
    /// The point.
    pub point: Vec3,
    /// Unit normal; its sense is the surface's own, not that of any facet.
    pub normal: Vec3,
    /// Second fundamental form: the normal curvature along a unit tangent t is `t' * bending * t`, positive where the surface
    /// bends away from its normal (outside of a sphere). Symmetric, zero along the normal.
    pub bending: Matrix3<f64>,
}

impl Foot {
    /// Normal curvature along a direction (its component along the normal does not count); 0 for a zero direction.
    pub fn curvature_along(&self, direction: &Vec3) -> f64 {
        let tangent = direction - self.normal * self.normal.dot(direction);
        let square = tangent.norm_squared();
        if square > 0.0 { (tangent.transpose() * self.bending * tangent)[0] / square } else { 0.0 }
    }

    /// The principal curvatures alone, the larger magnitude first.
    pub fn principal_values(&self) -> [f64; 2] {
        // The eigenvalues besides the zero along the normal, from trace and sum of squares.
        let (mean, squares) = (self.bending.trace() * 0.5, self.bending.norm_squared());
        let radius = (squares * 0.5 - mean * mean).max(0.0).sqrt().copysign(mean);
        [mean + radius, mean - radius]
    }

    /// The principal curvatures with their directions, the larger magnitude first. (Eigenvalues of the second fundamental
    /// form in the tangent plane.)
    pub fn principal(&self) -> [(f64, Vec3); 2] {
        let u = any_normal_to(&self.normal);
        let v = self.normal.cross(&u);
        let (bu, bv) = (self.bending * u, self.bending * v);
        let (a, b, c) = (u.dot(&bu), u.dot(&bv), v.dot(&bv));
        let (mean, half) = ((a + c) * 0.5, (a - c) * 0.5);
        let radius = libm::hypot(half, b);
        let turn = 0.5 * libm::atan2(b, half);
        let (s, k) = (libm::sin(turn), libm::cos(turn));
        let (first, second) = ((mean + radius, u * k + v * s), (mean - radius, v * k - u * s));
        if first.0.abs() >= second.0.abs() { [first, second] } else { [second, first] }
    }

    /// The magnitude of the larger principal curvature.
    pub fn largest_curvature(&self) -> f64 {
        self.principal_values()[0].abs()
    }

    /// Average of the principal curvatures (thesis 4.2.2, note i).
    pub fn mean_curvature(&self) -> f64 {
        self.bending.trace() * 0.5
    }
}

/// A point of a surface without what the second-order neighbourhood costs.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Nearest {
    /// The point.
    pub point: Vec3,
    /// Unit normal, as that of the [`Foot`].
    pub normal: Vec3,
    /// Magnitude of the larger principal curvature.
    pub curvature: f64,
}

impl From<Foot> for Nearest {
    fn from(foot: Foot) -> Self {
        Self { point: foot.point, normal: foot.normal, curvature: foot.largest_curvature() }
    }
}

/// A unit vector normal to a unit vector; the same for the same input.
pub fn any_normal_to(normal: &Vec3) -> Vec3 {
    let mut axis = Vec3::zeros();
    axis[normal.iamin()] = 1.0;
    normal.cross(&axis).normalize()
}

/// The second fundamental form of a level surface from gradient and Hessian of its function, about the unit gradient.
pub fn bending_of_level(gradient: &Vec3, hessian: &Matrix3<f64>) -> Matrix3<f64> {
    let length = gradient.norm();
    let n = gradient / length;
    let tangential = Matrix3::identity() - n * n.transpose();
    tangential * hessian * tangential / length
}

/// The true surface of facets.
#[derive(Clone, Debug)]
pub enum Support {
    /// Flat.
    Plane(Plane),
    /// Circular cylinder or cone.
    Cone(Cone),
    /// Ellipsoid or sphere.
    Ellipsoid(Ellipsoid),
    /// Torus.
    Torus(Torus),
    /// Affine image of one of the others.
    Image(Box<Image>),
    /// B-spline patches, one per facet (planes where those err).
    Fitted(Box<FittedSurface>),
}

impl Support {
    /// The closest point of the surface. Exact for analytic surfaces up to rounding; for images and fitted patches a local
    /// iteration that is exact for points near the surface. A point with several closest ones (a centre, an axis) gets one.
    pub fn closest(&self, point: &Vec3) -> Foot {
        match self {
            Self::Plane(s) => s.closest(point),
            Self::Cone(s) => s.closest(point),
            Self::Ellipsoid(s) => s.closest(point),
            Self::Torus(s) => s.closest(point),
            Self::Image(s) => s.closest(point),
            Self::Fitted(s) => s.closest(point),
        }
    }

    /// The closest point as [`Support::closest`] gives it, up to rounding; a third of its cost on the commonest surfaces.
    pub fn nearest(&self, point: &Vec3) -> Nearest {
        match self {
            Self::Plane(s) => s.nearest(point),
            Self::Cone(s) => s.nearest(point),
            Self::Ellipsoid(s) => s.nearest(point),
            Self::Fitted(s) => s.nearest(point),
            Self::Image(s) => s.nearest(point),
            Self::Torus(s) => s.nearest(point),
        }
    }

    /// Distance of a point to the surface.
    pub fn distance(&self, point: &Vec3) -> f64 {
        (self.nearest(point).point - point).norm()
    }

    /// What counts as no distance: patches of neighbouring facets differ by that.
    pub fn grain(&self) -> f64 {
        match self {
            Self::Fitted(s) => s.grain(),
            _ => 0.0,
        }
    }

    /// How far the points are apart by which it is known near a point: what is smaller is made up. 0 if it is known everywhere.
    pub fn spacing(&self, point: &Vec3) -> f64 {
        match self {
            Self::Fitted(s) => s.spacing(point),
            _ => 0.0,
        }
    }

    /// Whether it is known by its facets only.
    pub fn is_fitted(&self) -> bool {
        matches!(self, Self::Fitted(_))
    }

    /// Whether a direction is straight on the surface at one of its points.
    pub fn is_straight_along(&self, foot: &Foot, direction: &Vec3) -> bool {
        let straight = if self.is_fitted() { STRAIGHT_AS_FITTED } else { STRAIGHT };
        foot.curvature_along(direction).abs() <= straight * foot.largest_curvature()
    }

    /// Whether it is flat.
    pub fn is_plane(&self) -> bool {
        matches!(self, Self::Plane(_))
    }
}
