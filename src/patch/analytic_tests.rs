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
    let nearest = support.nearest(&point);
    assert!((nearest.point - foot.point).norm().max((nearest.normal - foot.normal).norm()) < 1e-12, "nearest is closest");
    let curvature = foot.largest_curvature();
    assert!((nearest.curvature - curvature).abs() < 1e-9 * (1.0 + curvature), "{} {curvature}", nearest.curvature);
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

/// Feet that are pushed off along the normal come back, from any distance, however slim the ellipsoid.
#[test]
fn slim_ellipsoids_give_their_feet_back() {
    let radii = Vec3::new(50.0, 7.0, 0.4);
    let slim = Ellipsoid::new(tilted(), radii);
    for p in samples() {
        let foot = slim.closest(&(p * 20.0));
        // Inside, centres of curvature are no nearer than the least radius of curvature.
        for height in [1e-9, 1e-3, 0.1, 1.0, 100.0, -1e-9, -1e-4, -0.1 * 0.4 * 0.4 / 50.0] {
            let found = slim.closest(&(foot.point + foot.normal * height));
            assert!((found.point - foot.point).norm() < 1e-9 * 50.0, "{height}: {:?} {:?}", found.point, foot.point);
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

/// Corners of the facets of curved sides lie on the side's shape, as far as rounding goes.
#[test]
fn facets_have_their_corners_on_their_shapes() {
    let path = "Path(start: (-20, 0), segments: [Line(to: (30, 0)), Arc(to: (60, 30), center: (30, 30)), Line(to: (60, 60)), \
                Arc(to: (90, 90), center: (90, 60), ccw: false), Line(to: (95, 90))], closed: false)";
    let profile = "RoundedRectangle(size: (8, 6), center: (1, 2), radius: 2)";
    let solids = [
        "Cylinder(radius: 3, height: 8, base: (1, 2, 3), axis: (1, 1, 0))".to_string(),
        "Frustum(bottom_radius: 5, top_radius: 2, height: 8, axis: Y)".into(),
        "Cone(radius: 5, height: 8, base: (70, -30, 0))".into(),
        "Sphere(radius: 4, center: (1, 2, 3))".into(),
        "Ellipsoid(radii: (6, 4, 3), center: (145, -30, 5))".into(),
        "Torus(major_radius: 6, minor_radius: 2, center: (1, 2, 3), axis: X)".into(),
        format!("Extrude(profile: {profile}, height: 5, axis: (1, 2, 2))"),
        format!("Revolve(profile: {}, angle: 120, axis: Y)", profile.replace("(1, 2)", "(9, 2)")),
        format!("Sweep(profile: {profile}, path: {path}, base: (7, 8, 9), axis: (0, 1, 1))"),
        format!("Mirror(normal: X, solid: Scale(by: (1, 2, 3), solid: Sweep(profile: Circle(radius: 3), path: {path})))"),
    ];
    for (solid, triangulated) in solids.iter().flat_map(|s| [(s, false), (s, true)]) {
        let text = format!("Scene(units: \"mm\", triangulated: {triangulated}, parts: [Part(name: \"a\", solid: {solid})])");
        let scene = crate::scene::parse("s", std::path::Path::new("."), &text, &[], &Default::default()).unwrap().0;
        for solid in crate::primitive::build(&scene).unwrap() {
            let at = |v: u32| solid.vertices[v as usize].point;
            for facet in solid.facets.iter() {
                let Some(support) = support_of_shape(&solid.surfaces[facet.surface as usize].shape) else { continue };
                for p in facet.loops.corners().map(at) {
                    assert!(
                        support.distance(&p) < 1e-12 * (1.0 + p.norm()),
                        "{text}\n{:?} {p:?}",
                        solid.surfaces[facet.surface as usize]
                    );
                }
            }
        }
    }
}

#[test]
fn feet_on_an_elliptic_cylinder_are_exact_on_both_sides() {
    let frame = Frame { origin: Vec3::zeros(), x: Vec3::x(), y: Vec3::y(), z: Vec3::z() };
    let map = nalgebra::try_convert(nalgebra::Scale3::new(2.0, 1.0, 1.0).to_homogeneous()).unwrap();
    let image = Support::Image(Box::new(Image::new(Support::Cone(Cone::new(frame, 1.0, 0.0)), map).unwrap()));
    for k in 0..24 {
        let (s, c) = (libm::sin(f64::from(k)), libm::cos(f64::from(k)));
        // The ellipse (2 cos, sin): normal (cos, 2 sin), curvature 2 / (4 sin^2 + cos^2)^1.5, at least 0.25 and at most 2.
        let (foot, normal) = (Vec3::new(2.0 * c, s, 0.3), Vec3::new(c, 2.0 * s, 0.0).normalize());
        let curvature = 2.0 / (4.0 * s * s + c * c).powi(3).sqrt();
        for distance in [0.0, 1e-3, 0.1, 0.2, 10.0, -1e-3, -0.1, -0.2] {
            let found = image.nearest(&(foot + normal * distance));
            assert!((found.point - foot).norm() < 1e-14 * (1.0 + 100.0 * f64::abs(distance)), "{k} {distance} {found:?}");
            assert!((found.normal - normal).norm() < 1e-12 && (found.curvature - curvature).abs() < 1e-12);
            let full = image.closest(&(foot + normal * distance));
            assert!((full.point - foot).norm() < 1e-12 && (full.largest_curvature() - curvature).abs() < 1e-12);
        }
    }
}
