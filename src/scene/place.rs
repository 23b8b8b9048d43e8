//! A primitive moved: where possible its numbers are, so that equal solids are recognised as equal whichever way they were
//! written; what remains is a matrix.

use super::model::{Arc2, Frame, Path2, Primitive, Profile};
use super::motion::{Class, Motion};
use super::polyline::full_circle;
use crate::geom::{Affine, Vec3};

/// How far, relative to its distance from the origin, a point may move under a rotation and still count as lying on the axis:
/// some roundings of f64.
const ON_AXIS: f64 = 1e-14;

/// `primitive` after `motions`, the first one first, and the matrix of those that its numbers cannot carry.
pub(super) fn placed<'m>(primitive: &Primitive, motions: impl Iterator<Item = &'m Motion>) -> (Primitive, Affine) {
    let mut primitive = primitive.clone();
    let mut rest: Option<Affine> = None;
    for motion in motions {
        match (&rest, moved(&primitive, motion)) {
            (None, Some(image)) => primitive = image,
            (None, None) => rest = Some(motion.affine()),
            (Some(map), _) => rest = Some(motion.affine() * map),
        }
    }
    (primitive, rest.unwrap_or_else(Affine::identity))
}

/// The image as a primitive of the same kind with the same sides, if it is one.
fn moved(primitive: &Primitive, motion: &Motion) -> Option<Primitive> {
    let is_diagonal = motion.linear.iter().enumerate().all(|(k, x)| k % 4 == 0 || *x == 0.0);
    match primitive {
        Primitive::Block { lo, hi } if is_diagonal && motion.linear.diagonal().min() > 0.0 => {
            Some(Primitive::Block { lo: motion.point(lo), hi: motion.point(hi) })
        }
        Primitive::Ellipsoid { center, radii } if is_diagonal => {
            let radii = radii.component_mul(&motion.linear.diagonal().abs());
            Some(Primitive::Ellipsoid { center: motion.point(center), radii })
        }
        Primitive::Block { .. } | Primitive::Ellipsoid { .. } | Primitive::Import { .. } => None,
        _ => with_frame(primitive, motion),
    }
}

fn with_frame(primitive: &Primitive, motion: &Motion) -> Option<Primitive> {
    let mut image = primitive.clone();
    let is_round = is_round(primitive);
    let frame = frame_of(&mut image)?;
    let turned = |v: &Vec3| (motion.linear * v).map(|x| x + 0.0);
    match motion.class {
        Class::Translation => frame.origin += motion.shift,
        // A full body of revolution turned about its own axis is itself.
        Class::Rotation(_) if is_round && keeps_axis(frame, motion) => {}
        Class::Rotation(_) => {
            *frame =
                Frame { origin: motion.point(&frame.origin), x: turned(&frame.x), y: turned(&frame.y), z: turned(&frame.z) };
        }
        Class::Mirror if matches!(primitive, Primitive::Cone { .. } | Primitive::Torus { .. }) => {
            // Mirrored at its own plane y = 0 as well, which changes nothing, so that the frame stays right-handed.
            *frame =
                Frame { origin: motion.point(&frame.origin), x: turned(&frame.x), y: -turned(&frame.y), z: turned(&frame.z) };
        }
        Class::Scale(factor) => {
            frame.origin = motion.point(&frame.origin);
            scale(&mut image, factor);
        }
        Class::Mirror | Class::Stretch => return None,
    }
    Some(image)
}

fn frame_of(primitive: &mut Primitive) -> Option<&mut Frame> {
    match primitive {
        Primitive::Pyramid { frame, .. }
        | Primitive::Cone { frame, .. }
        | Primitive::Torus { frame, .. }
        | Primitive::Extrusion { frame, .. }
        | Primitive::Revolution { frame, .. }
        | Primitive::PathSweep { frame, .. } => Some(frame),
        Primitive::Block { .. } | Primitive::Ellipsoid { .. } | Primitive::Import { .. } => None,
    }
}

/// Whether the primitive is a full body of revolution about its frame's axis.
fn is_round(primitive: &Primitive) -> bool {
    let is_centred = |path: &Path2| full_circle(path).is_some_and(|(center, _)| center == [0.0, 0.0]);
    match primitive {
        Primitive::Cone { .. } | Primitive::Torus { .. } => true,
        Primitive::Revolution { angle, .. } => *angle >= std::f64::consts::TAU,
        Primitive::Extrusion { profile, .. } => is_centred(&profile.outer) && profile.holes.iter().all(is_centred),
        _ => false,
    }
}

fn keeps_axis(frame: &Frame, motion: &Motion) -> bool {
    let size = frame.origin.norm() + motion.center.norm();
    (motion.linear * frame.z - frame.z).norm() <= ON_AXIS
        && (motion.point(&frame.origin) - frame.origin).norm() <= ON_AXIS * size
}

fn scale(primitive: &mut Primitive, factor: f64) {
    let scaled = |p: &mut [f64; 2]| *p = p.map(|x| x * factor);
    match primitive {
        Primitive::Cone { bottom_radius, top_radius, height, .. } => {
            *bottom_radius *= factor;
            *top_radius *= factor;
            *height *= factor;
        }
        Primitive::Torus { major_radius, minor_radius, .. } => {
            *major_radius *= factor;
            *minor_radius *= factor;
        }
        Primitive::Pyramid { base, apex, .. } => {
            base.iter_mut().for_each(scaled);
            *apex *= factor;
        }
        Primitive::Extrusion { profile, length, .. } => {
            scale_profile(profile, factor);
            *length *= factor;
        }
        Primitive::Revolution { profile, .. } => scale_profile(profile, factor),
        Primitive::PathSweep { profile, path, .. } => {
            scale_profile(profile, factor);
            scale_path(path, factor);
        }
        Primitive::Block { .. } | Primitive::Ellipsoid { .. } | Primitive::Import { .. } => {}
    }
}

fn scale_profile(profile: &mut Profile, factor: f64) {
    scale_path(&mut profile.outer, factor);
    profile.holes.iter_mut().for_each(|hole| scale_path(hole, factor));
}

fn scale_path(path: &mut Path2, factor: f64) {
    let scaled = |p: [f64; 2]| p.map(|x| x * factor);
    path.start = scaled(path.start);
    for segment in &mut path.segments {
        segment.end = scaled(segment.end);
        segment.arc = segment.arc.map(|arc| Arc2 { center: scaled(arc.center), ..arc });
    }
}
