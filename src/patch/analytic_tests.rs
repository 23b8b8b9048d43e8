//! Feet of exact surfaces against conditions that any closest point meets.

use super::*;
use nalgebra::Rotation3;

fn tilted() -> Frame {
    let turn = Rotation3::from_euler_angles(0.3, -0.7, 1.1);
    Frame { origin: Vec3::new(1.0, -2.0, 0.5), x: turn * Vec3::x(), y: turn * Vec3::y(), z: turn * Vec3::z() }
}

/// The foot is on the surface, the point is along the normal from it, and the normal field turns as the bending says.
fn assert_is_foot(support: &Support, point: Vec3) {
    let foot = support.closest(&point);
    let again = support.closest(&foot.point);
    assert!((again.point - foot.point).norm() < 1e-9, "on the surface");
    assert!((point - foot.point).cross(&foot.normal).norm() < 1e-7, "along the normal: {point:?}");
    let step = 1e-5;
    for (curvature, direction) in foot.principal() {
        let beside = support.closest(&(foot.point + direction * step));
        let turned = (beside.normal - foot.normal).dot(&direction) / step;
        assert!((turned - curvature).abs() < 1e-3 * (1.0 + curvature.abs()), "bending {turned} {curvature}");
    }
}

fn samples() -> Vec<Vec3> {
    let f = |k: u64, m: u64| ((k * 7919 + m * 104_729 + 13) % 997) as f64 / 997.0 * 6.0 - 3.0;
    (0..60).map(|k| Vec3::new(f(k, 1), f(k, 2), f(k, 3))).collect()
}

#[test]
fn feet_meet_the_conditions() {
    let cylinder = Support::Cone(Cone::new(tilted(), 1.5, 0.0));
    let ellipsoid = Support::Ellipsoid(Ellipsoid::new(tilted(), Vec3::new(3.0, 2.0, 1.0)));
    let torus = Support::Torus(Torus { frame: tilted(), major: 2.0, minor: 0.5 });
    for p in samples() {
        for s in [&cylinder, &ellipsoid, &torus] {
            assert_is_foot(s, p);
        }
    }
}

#[test]
fn cone_foot_stays_on_its_nappe() {
    let frame = Frame { origin: Vec3::zeros(), x: Vec3::x(), y: Vec3::y(), z: Vec3::z() };
    let cone = Cone::new(frame, 50.0, -0.5);
    assert_eq!(cone.closest(&Vec3::new(0.0, 0.0, 150.0)).point, Vec3::new(0.0, 0.0, 100.0));
    let foot = cone.closest(&Vec3::new(30.0, 0.0, 60.0));
    // Line radius = 50 - z / 2: distance from (30, 60) is 10 / |(1, 0.5)|.
    assert!(((foot.point - Vec3::new(30.0, 0.0, 60.0)).norm() - 10.0 / 1.25f64.sqrt()).abs() < 1e-12);
    assert!((foot.principal()[0].0 - 1.0 / (foot.point.x * 1.25f64.sqrt())).abs() < 1e-12);
}

#[test]
fn ellipsoid_feet_of_the_hard_points() {
    let frame = Frame { origin: Vec3::zeros(), x: Vec3::x(), y: Vec3::y(), z: Vec3::z() };
    let e = Ellipsoid::new(frame, Vec3::new(3.0, 2.0, 1.0));
    let near = |a: Vec3, b: Vec3| assert!((a - b).norm() < 1e-12, "{a:?} {b:?}");
    near(e.closest(&Vec3::zeros()).point, Vec3::z());
    near(e.closest(&Vec3::new(0.0, 0.0, 0.25)).point, Vec3::z());
    near(e.closest(&Vec3::new(5.0, 0.0, 0.0)).point, Vec3::new(3.0, 0.0, 0.0));
    near(e.closest(&Vec3::new(0.0, -7.0, 0.0)).point, Vec3::new(0.0, -2.0, 0.0));
    // Inside, off the smallest axis: x = 9 * 0.8 / 8 = 0.9, z = sqrt(1 - 0.09).
    near(e.closest(&Vec3::new(0.8, 0.0, 0.0)).point, Vec3::new(0.9, 0.0, 0.91f64.sqrt()));
    let ball = Ellipsoid::new(frame, Vec3::repeat(2.0));
    near(ball.closest(&Vec3::new(3.0, 4.0, 0.0)).point, Vec3::new(1.2, 1.6, 0.0));
}

#[test]
fn image_of_a_sphere_is_the_ellipsoid() {
    let frame = Frame { origin: Vec3::zeros(), x: Vec3::x(), y: Vec3::y(), z: Vec3::z() };
    let radii = Vec3::new(1.0, 1.5, 0.8);
    let ellipsoid = Support::Ellipsoid(Ellipsoid::new(frame, radii));
    let ball = Support::Ellipsoid(Ellipsoid::new(frame, Vec3::repeat(1.0)));
    let map = Affine::from_matrix_unchecked(nalgebra::Matrix4::new_nonuniform_scaling(&radii));
    let image = Support::Image(Box::new(Image::new(ball, map).unwrap()));
    for p in samples() {
        let on = ellipsoid.closest(&p);
        let beside = on.point + on.normal * 0.05;
        let (a, b) = (ellipsoid.closest(&beside), image.closest(&beside));
        assert!((a.point - b.point).norm() < 1e-9);
        assert!((a.normal - b.normal).norm() < 1e-8);
        assert!((a.bending - b.bending).norm() < 1e-6);
    }
}
