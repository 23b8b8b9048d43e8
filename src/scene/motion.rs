//! Translations, rotations, mirrors and scales, with exact entries where there are any.

use crate::geom::{Affine, Vec3};
use nalgebra::{Matrix3, Matrix4};
use std::f64::consts::PI;

/// What kind of map a [`Motion`] is.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Class {
    /// Moves without turning.
    Translation,
    /// Turns about this unit axis through the centre.
    Rotation(Vec3),
    /// Mirrors at a plane through the centre.
    Mirror,
    /// Scales alike in all directions, by a positive factor.
    Scale(f64),
    /// Scales each coordinate on its own.
    Stretch,
}

/// p -> linear (p - center) + center + shift.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Motion {
    pub class: Class,
    pub linear: Matrix3<f64>,
    pub center: Vec3,
    pub shift: Vec3,
}

impl Motion {
    /// The translation by `shift`.
    pub fn translation(shift: Vec3) -> Self {
        Self { class: Class::Translation, linear: Matrix3::identity(), center: Vec3::zeros(), shift }
    }

    /// The right-handed rotation by `degrees` about the unit vector `axis` through `center`. By multiples of 90 degrees about
    /// a coordinate axis all entries are 0 or +-1.
    pub fn rotation(axis: Vec3, degrees: f64, center: Vec3) -> Self {
        let (s, c) = sin_cos(degrees);
        let linear = Matrix3::identity() * c + axis.cross_matrix() * s + axis * axis.transpose() * (1.0 - c);
        Self { class: Class::Rotation(axis), linear: exact_axis(linear, axis, c), center, shift: Vec3::zeros() }
    }

    /// The mirror at the plane through `center` with the unit vector `normal`.
    pub fn mirror(normal: Vec3, center: Vec3) -> Self {
        let linear = Matrix3::identity() - normal * normal.transpose() * 2.0;
        Self { class: Class::Mirror, linear, center, shift: Vec3::zeros() }
    }

    /// The scale by `factors` about `center`.
    pub fn scale(factors: Vec3, center: Vec3) -> Self {
        let is_uniform = factors.x == factors.y && factors.y == factors.z && factors.x > 0.0;
        let class = if is_uniform { Class::Scale(factors.x) } else { Class::Stretch };
        Self { class, linear: Matrix3::from_diagonal(&factors), center, shift: Vec3::zeros() }
    }

    /// The image of a point.
    pub fn point(&self, p: &Vec3) -> Vec3 {
        match self.class {
            // Directly, so that a moved block has the same bits as one written there.
            Class::Translation => p + self.shift,
            _ => self.linear * (p - self.center) + self.center + self.shift,
        }
    }

    /// As a matrix.
    pub fn affine(&self) -> Affine {
        let mut matrix = Matrix4::identity();
        matrix.fixed_view_mut::<3, 3>(0, 0).copy_from(&self.linear);
        matrix.fixed_view_mut::<3, 1>(0, 3).copy_from(&self.point(&Vec3::zeros()));
        Affine::from_matrix_unchecked(matrix)
    }
}

/// About a coordinate axis, 1 * (1 - c) + c need not be 1: sets that entry.
fn exact_axis(mut linear: Matrix3<f64>, axis: Vec3, c: f64) -> Matrix3<f64> {
    for k in 0..3 {
        if axis[k].abs() == 1.0 {
            linear[(k, k)] = 1.0;
            linear[((k + 1) % 3, (k + 1) % 3)] = c;
            linear[((k + 2) % 3, (k + 2) % 3)] = c;
        }
    }
    linear
}

/// Sine and cosine of an angle in degrees: exact for multiples of 90, the nearest numbers for multiples of 30 and 45, and
/// exactly symmetric.
pub(super) fn sin_cos(degrees: f64) -> (f64, f64) {
    let turned = libm::fmod(degrees, 360.0);
    let quadrant = libm::rint(turned / 90.0);
    let rest = turned - 90.0 * quadrant;
    let magnitude = rest.abs();
    let (s, c) = if magnitude == 30.0 {
        (0.5, libm::sqrt(0.75))
    } else if magnitude == 45.0 {
        (libm::sqrt(0.5), libm::sqrt(0.5))
    } else {
        libm::sincos(magnitude / 180.0 * PI)
    };
    let s = if rest < 0.0 { -s } else { s };
    // Adding 0 turns -0 into 0.
    match (quadrant as i64).rem_euclid(4) {
        0 => (s + 0.0, c),
        1 => (c, -s + 0.0),
        2 => (-s + 0.0, -c),
        _ => (-c, s + 0.0),
    }
}

/// Degrees in radians; 360 gives 2 pi.
pub(super) fn radians(degrees: f64) -> f64 {
    degrees / 180.0 * PI
}

/// The direction of `v`, exact if it is that of a coordinate axis; `None` if it has none.
pub(super) fn unit_vector(v: Vec3) -> Option<Vec3> {
    let longest = v.amax();
    if !(longest > 0.0 && longest.is_finite()) {
        return None;
    }
    let scaled = v / longest;
    let unit = if scaled.iter().filter(|x| **x != 0.0).count() == 1 { scaled } else { scaled / scaled.norm() };
    Some(unit.map(|x| x + 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn right_angles_are_exact() {
        for k in -8i32..=8 {
            let (s, c) = sin_cos(90.0 * f64::from(k));
            assert_eq!((s, c), [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)][k.rem_euclid(4) as usize]);
        }
        assert_eq!(sin_cos(60.0).1, 0.5);
        assert_eq!(sin_cos(150.0).0, 0.5);
        assert_eq!(sin_cos(135.0).0, -sin_cos(135.0).1);
        let turn = Motion::rotation(Vec3::z(), 90.0, Vec3::new(1.0, 0.0, 0.0));
        assert_eq!(turn.point(&Vec3::new(3.0, 0.0, 5.0)), Vec3::new(1.0, 2.0, 5.0));
        assert!(turn.linear.iter().all(|x| [0.0, 1.0, -1.0].contains(x)));
    }

    #[test]
    fn rotations_are_rigid_and_right_handed() {
        let axis = unit_vector(Vec3::new(1.0, 2.0, -0.5)).unwrap();
        let turn = Motion::rotation(axis, 37.0, Vec3::zeros());
        assert!((turn.linear * turn.linear.transpose() - Matrix3::identity()).amax() < 1e-15);
        assert!((turn.linear.determinant() - 1.0).abs() < 1e-15);
        let diagonal = unit_vector(Vec3::new(1.0, 1.0, 1.0)).unwrap();
        let cyclic = Motion::rotation(diagonal, 120.0, Vec3::zeros());
        assert!((cyclic.linear * Vec3::x() - Vec3::y()).norm() < 1e-15);
    }
}
