//! Where primitives about an axis stand.

use super::model::Frame;
use super::motion::{sin_cos, unit_vector};
use super::reader::{Owner, Reader};
use super::source::Field;
use crate::geom::Vec3;

/// Sine of the angle between two directions below which they count as parallel: a micro-degree, far above rounding.
const PARALLEL: f64 = 1e-8;

/// The fields that place a primitive about an axis.
#[derive(Clone, Copy, Default)]
pub(super) struct FrameFields<'a> {
    pub base: Field<'a>,
    pub axis: Field<'a>,
    pub x_axis: Field<'a>,
    pub start: Field<'a>,
}

/// Direction of angle 0 for an axis z, x, y: +x, +y, +z; for others the same of the dominant component, made perpendicular.
fn zero_direction(axis: &Vec3) -> Vec3 {
    // The largest component, ties in favour of z, then x.
    let dominant = [2, 0, 1].into_iter().rev().max_by(|&a, &b| axis[a].abs().total_cmp(&axis[b].abs())).unwrap_or(2);
    let mut direction = Vec3::zeros();
    direction[(dominant + 1) % 3] = 1.0;
    direction
}

/// The right-handed frame with this origin and axis (of length 1) whose x is `toward` made perpendicular to the axis and turned
/// by `start` degrees. `None` if `toward` is parallel to the axis.
pub(super) fn frame(origin: Vec3, axis: Vec3, toward: Option<Vec3>, start: f64) -> Option<Frame> {
    let toward = toward.unwrap_or_else(|| zero_direction(&axis));
    let across = toward - axis * toward.dot(&axis);
    if across.norm() <= PARALLEL * toward.norm() {
        return None;
    }
    let x = unit_vector(across)?;
    let y = axis.cross(&x).map(|c| c + 0.0);
    let (s, c) = sin_cos(start);
    Some(Frame { origin, x: (x * c + y * s).map(|e| e + 0.0), y: (y * c - x * s).map(|e| e + 0.0), z: axis })
}

impl<'a> Reader<'a> {
    /// The frame of a primitive about an axis; z through the origin if nothing is said.
    pub fn frame(&mut self, owner: Owner<'a>, fields: FrameFields<'a>) -> Option<Frame> {
        let origin = self.point_or_origin("base", fields.base);
        let axis = self.axis_or_z(fields.axis);
        let toward = self.maybe(fields.x_axis, |r, raw| r.axis("x_axis", raw));
        let start = fields.start.0.map_or(Some(0.0), |raw| self.degrees("start", raw));
        let (origin, axis, toward, start) = (origin?, axis?, toward?, start?);
        match frame(origin, axis, toward, start) {
            Some(frame) => Some(frame),
            None => {
                let at = fields.x_axis.0.unwrap_or(owner.raw);
                self.fail(at, "zero-axis", "`x_axis` is parallel to the axis", "choose one across it, or leave it out")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angle_zero_follows_the_convention() {
        for (axis, x, y) in [
            (Vec3::z(), Vec3::x(), Vec3::y()),
            (Vec3::x(), Vec3::y(), Vec3::z()),
            (Vec3::y(), Vec3::z(), Vec3::x()),
            (-Vec3::z(), Vec3::x(), -Vec3::y()),
        ] {
            let f = frame(Vec3::zeros(), axis, None, 0.0).unwrap();
            assert_eq!((f.x, f.y, f.z), (x, y, axis));
        }
        let oblique = unit_vector(Vec3::new(1.0, 1.0, 1.0)).unwrap();
        let f = frame(Vec3::zeros(), oblique, None, 20.0).unwrap();
        assert!((f.x.cross(&f.y) - f.z).norm() < 1e-15);
        assert!(frame(Vec3::zeros(), Vec3::z(), Some(Vec3::z()), 0.0).is_none());
    }
}
