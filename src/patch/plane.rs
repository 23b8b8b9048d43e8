//! Planes: the support of planar facets, and of what no patch fits.

use super::support::{Foot, Nearest};
use crate::geom::Vec3;
use nalgebra::Matrix3;

/// A plane.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Plane {
    /// One of its points.
    pub origin: Vec3,
    /// Unit normal.
    pub normal: Vec3,
}

impl Plane {
    /// The plane through a point with a normal of any length; `None` if the normal is zero.
    pub fn new(origin: Vec3, normal: Vec3) -> Option<Self> {
        let normal = normal.try_normalize(0.0)?;
        Some(Self { origin, normal })
    }

    /// The closest point. On an axis-parallel plane its third coordinate is the plane's, bit by bit.
    pub fn closest(&self, point: &Vec3) -> Foot {
        let Nearest { point, normal, .. } = self.nearest(point);
        Foot { point, normal, bending: Matrix3::zeros() }
    }

    /// The closest point.
    pub(super) fn nearest(&self, point: &Vec3) -> Nearest {
        let axis = self.normal.iamax();
        let mut foot = point - self.normal * self.height(point);
        if self.normal[axis].abs() == 1.0 {
            foot[axis] = self.origin[axis];
        }
        Nearest { point: foot, normal: self.normal, curvature: 0.0 }
    }

    /// Signed distance of a point, positive on the side of the normal.
    pub fn height(&self, point: &Vec3) -> f64 {
        (point - self.origin).dot(&self.normal)
    }
}
