//! A frame as the scene sees it, after the leaf's transform.

use super::solid::Shape;
use crate::geom::{Affine, Vec3};
use crate::scene::model::Frame;

/// Two lengths or directions are meant to be equal if they differ by less than this fraction: some rotations and scales of
/// rounding, far under the contact tolerance.
const SAME: f64 = 1e-12;

/// Where local coordinates (x, y, z) of a frame lie in the scene.
#[derive(Clone, Debug)]
pub(crate) struct Place {
    /// Image of the frame's origin.
    pub origin: Vec3,
    /// Images of the frame's axes; unit and orthogonal only if the transform keeps lengths and angles.
    pub axes: [Vec3; 3],
    /// The frame before the transform.
    frame: Frame,
    /// The transform.
    transform: Affine,
}

impl Place {
    pub fn new(frame: &Frame, transform: &Affine) -> Self {
        let image = |v: &Vec3| transform.matrix().fixed_view::<3, 3>(0, 0) * v;
        let origin = transform.transform_point(&frame.origin.into()).coords;
        Self { origin, axes: [image(&frame.x), image(&frame.y), image(&frame.z)], frame: *frame, transform: *transform }
    }

    /// The frame of the coordinate axes.
    pub fn of_axes(transform: &Affine) -> Self {
        let frame = Frame { origin: Vec3::zeros(), x: Vec3::x(), y: Vec3::y(), z: Vec3::z() };
        Self::new(&frame, transform)
    }

    /// Scene coordinates of a local point.
    pub fn point(&self, x: f64, y: f64, z: f64) -> Vec3 {
        self.origin + self.axes[0] * x + self.axes[1] * y + self.axes[2] * z
    }

    /// Whether the transform turns right hands into left ones.
    pub fn is_mirrored(&self) -> bool {
        self.axes[0].cross(&self.axes[1]).dot(&self.axes[2]) < 0.0
    }

    /// Scale of radii, if circles about the z axis stay circles about an axis.
    pub fn circle_scale(&self) -> Option<f64> {
        let [x, y, z] = &self.axes;
        let (a, b, c) = (x.norm(), y.norm(), z.norm());
        let is_kept = (a - b).abs() <= SAME * a
            && x.dot(y).abs() <= SAME * a * b
            && x.dot(z).abs() <= SAME * a * c
            && y.dot(z).abs() <= SAME * b * c;
        is_kept.then_some(a)
    }

    /// Scale of lengths, if it is the same in all directions.
    pub fn scale(&self) -> Option<f64> {
        let c = self.axes[2].norm();
        self.circle_scale().filter(|a| (a - c).abs() <= SAME * a)
    }

    /// Lengths of the axes' images, if they stay orthogonal.
    pub fn orthogonal_scales(&self) -> Option<Vec3> {
        let [x, y, z] = &self.axes;
        let (a, b, c) = (x.norm(), y.norm(), z.norm());
        let is_kept = x.dot(y).abs() <= SAME * a * b && x.dot(z).abs() <= SAME * a * c && y.dot(z).abs() <= SAME * b * c;
        is_kept.then(|| Vec3::new(a, b, c))
    }

    /// A right-handed frame in the scene with its origin at a local point. The z axis keeps its direction; callers have
    /// checked that the axes stayed orthogonal.
    fn frame_at(&self, x: f64, y: f64, z: f64) -> Frame {
        let [ex, ey, ez] = self.axes.map(|v| v.normalize());
        let ey = if self.is_mirrored() { -ey } else { ey };
        Frame { origin: self.point(x, y, z), x: ex, y: ey, z: ez }
    }

    fn image(&self, local: Shape) -> Shape {
        Shape::Image { shape: Box::new(local), map: self.transform }
    }

    fn local_frame(&self, x: f64, y: f64, z: f64) -> Frame {
        let f = &self.frame;
        Frame { origin: f.origin + f.x * x + f.y * y + f.z * z, ..*f }
    }

    /// A cone about the z direction through local (x, y), of radius `radius + slope * z`.
    pub fn cone(&self, center: [f64; 2], radius: f64, slope: f64) -> Shape {
        let [x, y] = center;
        match self.circle_scale() {
            Some(s) => {
                let slope = slope * s / self.axes[2].norm();
                Shape::Cone { frame: self.frame_at(x, y, 0.0), radius: radius * s, slope }
            }
            None => self.image(Shape::Cone { frame: self.local_frame(x, y, 0.0), radius, slope }),
        }
    }

    /// A torus about the z direction, its circle of centres about local (x, y, z).
    pub fn torus(&self, center: [f64; 3], major: f64, minor: f64) -> Shape {
        let [x, y, z] = center;
        match self.scale() {
            Some(s) => Shape::Torus { frame: self.frame_at(x, y, z), major_radius: major * s, minor_radius: minor * s },
            None => {
                let frame = self.local_frame(x, y, z);
                self.image(Shape::Torus { frame, major_radius: major, minor_radius: minor })
            }
        }
    }

    /// An ellipsoid about a local point with half axes along the frame's axes.
    pub fn ellipsoid(&self, center: Vec3, radii: Vec3) -> Shape {
        let [x, y, z] = center.into();
        match self.orthogonal_scales() {
            Some(s) => Shape::Ellipsoid { frame: self.frame_at(x, y, z), radii: radii.component_mul(&s) },
            None => self.image(Shape::Ellipsoid { frame: self.local_frame(x, y, z), radii }),
        }
    }

    /// A place inside this one: its frame is given in local coordinates.
    pub fn inner(&self, origin: [f64; 3], axes: [[f64; 3]; 3]) -> Self {
        let f = &self.frame;
        let vector = |v: [f64; 3]| f.x * v[0] + f.y * v[1] + f.z * v[2];
        let frame = Frame { origin: f.origin + vector(origin), x: vector(axes[0]), y: vector(axes[1]), z: vector(axes[2]) };
        Self::new(&frame, &self.transform)
    }
}
