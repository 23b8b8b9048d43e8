use super::tests::*;
use super::*;
use crate::geom::{Affine, Vec3};
use crate::scene::model::{Arc2, Path2, Primitive, Profile, Segment2};
use std::collections::BTreeSet;
use std::f64::consts::{PI, TAU};

/// The triangles and strips of a solid on a surface, by their corners.
fn facets_on(solid: &Solid, is_on: impl Fn(Vec3) -> bool) -> Vec<Vec<[i64; 3]>> {
    let at = |v: u32| solid.vertices[v as usize].point;
    let key = |&v: &u32| at(v).map(|c| (c * 1e6).round() as i64).into();
    let of = |walk: &[u32]| {
        let mut corners: Vec<[i64; 3]> = walk.iter().map(key).collect();
        corners.sort_unstable();
        corners
    };
    let walks = solid.facets.iter().map(|f| f.loops.outer()).filter(|w| w.len() <= 4 && w.iter().all(|&v| is_on(at(v))));
    walks.map(of).collect()
}

/// Where all solids have a surface, they have the same facets of it; gives their number.
fn assert_alike(solids: &[Solid], is_on: impl Fn(Vec3) -> bool + Copy, is_common: impl Fn(f64, f64) -> bool) -> usize {
    let inside = |corner: &[i64; 3]| {
        let [x, y, z] = corner.map(|c| c as f64 * 1e-6);
        is_common(libm::atan2(y, x).to_degrees().rem_euclid(360.0), z)
    };
    let sets: Vec<BTreeSet<_>> =
        solids.iter().map(|s| facets_on(s, is_on).into_iter().filter(|t| t.iter().all(inside)).collect()).collect();
    for (k, set) in sets.iter().enumerate() {
        assert_eq!(set.symmetric_difference(&sets[0]).count(), 0, "solid {k}");
    }
    sets[0].len()
}

/// Whether a place is so far from the z axis.
fn is_at(p: Vec3, radius: f64) -> bool {
    (p.x.hypot(p.y) - radius).abs() < 1e-9
}

fn chain(points: &[[f64; 2]]) -> Profile {
    plain(polygon(points))
}

/// The scene of leaves, of which only the first asks for triangles.
fn solids(leaves: Vec<Leaf>) -> Vec<Solid> {
    let mut scene = scene(leaves);
    scene.leaves.iter_mut().take(1).for_each(|l| l.is_triangulated = true);
    let solids = build(&scene).unwrap();
    solids.iter().for_each(|s| {
        check(s);
    });
    solids
}

#[test]
fn cylinders_of_one_surface_have_the_same_triangles() {
    // A shaft, a rotor about its middle upside down, a magnet on a part of it, and half a bush that was extruded.
    let shaft = leaf(Primitive::Cone { frame: FRAME, bottom_radius: 15.0, top_radius: 15.0, height: 160.0 });
    let turned = |lo: f64, hi: f64, start: f64, angle: f64| {
        let profile = chain(&[[15., lo], [45., lo], [45., hi], [15., hi]]);
        leaf(Primitive::Revolution { frame: FRAME, profile, start: start.to_radians(), angle: angle.to_radians() })
    };
    let mut rotor = turned(0.0, 100.0, 0.0, 360.0);
    let half_turn = nalgebra::Rotation3::from_axis_angle(&Vec3::x_axis(), PI);
    let lifted = nalgebra::Translation3::new(0.0, 0.0, 130.0) * half_turn;
    rotor.transform = nalgebra::convert(lifted);
    let arc = |to: [f64; 2], is_ccw| Segment2 { end: to, arc: Some(Arc2 { center: [0., 0.], is_ccw }), name: None };
    let line = |to: [f64; 2]| Segment2 { end: to, arc: None, name: None };
    let segments = vec![arc([-20., 0.], true), line([-15., 0.]), arc([15., 0.], false), line([20., 0.])];
    let outer = Path2 { start: [20., 0.], segments, is_closed: true };
    let mut bush = leaf(Primitive::Extrusion { frame: FRAME, profile: plain(outer), length: 80.0 });
    bush.transform = Affine::from_matrix_unchecked(nalgebra::Matrix4::new_translation(&Vec3::new(0., 0., 20.)));
    let solids = solids(vec![shaft, rotor, turned(40.0, 90.0, 20.0, 100.0), bush]);
    // Between 40 and 90 they have two rows of 8 mm and more; from 20 to 120 degrees some 7 chords.
    let count =
        assert_alike(&solids, |p| is_at(p, 15.0), |angle, z| (40.0..=90.0).contains(&z) && (19.9..=120.1).contains(&angle));
    assert!(count > 100, "{count}");
}

#[test]
fn cones_of_one_surface_have_the_same_triangles() {
    let radius = |z: f64| 40.0 - 0.25 * z;
    let plug = |lo: f64, hi: f64| chain(&[[0., lo], [radius(lo), lo], [radius(hi), hi], [0., hi]]);
    let socket = |lo: f64, hi: f64| chain(&[[50., lo], [50., hi], [radius(hi), hi], [radius(lo), lo]]);
    let turned = |profile, angle| leaf(Primitive::Revolution { frame: FRAME, profile, start: 0.0, angle });
    let full = chain(&[[0., 0.], [40., 0.], [0., 160.]]);
    let leaves =
        vec![turned(plug(0., 100.), TAU), turned(socket(10., 70.), TAU), turned(socket(30., 90.), PI), turned(full, TAU)];
    let solids = solids(leaves);
    let count = assert_alike(&solids, |p| is_at(p, radius(p.z)), |angle, z| (30.0..=70.0).contains(&z) && angle <= 180.0);
    assert!(count > 50, "{count}");
}

#[test]
fn parts_of_a_torus_have_its_triangles() {
    let ring = leaf(Primitive::Torus { frame: FRAME, major_radius: 30.0, minor_radius: 10.0 });
    // Grooves along parts of it: an eighth all round, a quarter of it a third round upside down.
    let groove = |sweep: f64, angle: f64| {
        let (c, s) = (libm::cos(sweep), libm::sin(sweep));
        let arc = Segment2 { end: [30. + 10. * c, 10. * s], arc: Some(Arc2 { center: [30., 0.], is_ccw: true }), name: None };
        let line = |to: [f64; 2]| Segment2 { end: to, arc: None, name: None };
        let outer = Path2 { start: [40., 0.], segments: vec![arc, line([50., 10. * s]), line([50., 0.])], is_closed: true };
        leaf(Primitive::Revolution { frame: FRAME, profile: plain(outer), start: 0.0, angle })
    };
    let mut turned = groove(PI / 2.0, TAU / 3.0);
    turned.transform = nalgebra::convert(nalgebra::Scale3::new(1.0, -1.0, 1.0));
    let solids = solids(vec![ring, groove(PI / 4.0, TAU), turned]);
    let is_on = |p: Vec3| p.x.hypot(p.y) > 30.0 && ((p.x.hypot(p.y) - 30.0).hypot(p.z) - 10.0).abs() < 1e-9;
    let eighth = 10.0 * 0.5f64.sqrt() + 1e-6;
    let count = assert_alike(&solids, is_on, |angle, z| (0.0..=eighth).contains(&z) && !(0.1..239.9).contains(&angle));
    assert!(count > 20, "{count}");
}

#[test]
fn narrow_fillets_are_strips_wide_ones_triangles() {
    // A disc of radius 100 with a quarter of a circle about its rim: 6 chords of 15 degrees beside 24 around.
    let disc = |fillet: f64| {
        let arc = Some(Arc2 { center: [100.0 - fillet, 0.0], is_ccw: true });
        let segment = |end, arc| Segment2 { end, arc, name: None };
        let segments = vec![
            segment([100.0, 0.0], None),
            segment([100.0 - fillet, fillet], arc),
            segment([0.0, fillet], None),
            segment([0.0, 0.0], None),
        ];
        let profile = plain(Path2 { start: [0.0, 0.0], segments, is_closed: true });
        one(leaf(Primitive::Revolution { frame: FRAME, profile, start: 0.0, angle: TAU }))
    };
    let counts = |fillet: f64| {
        let solid = disc(fillet);
        assert_eq!(check(&solid), 2);
        let corners: Vec<usize> = solid.facets.iter().map(|f| f.loops.outer().len()).collect();
        [3, 4].map(|n| corners.iter().filter(|&&c| c == n).count())
    };
    assert_eq!(counts(5.0), [0, 6 * 24]);
    let [triangles, quads] = counts(95.0);
    assert!(triangles > 200 && quads == 0, "{triangles} {quads}");
}

#[test]
fn ellipses_about_one_axis_are_divided_alike() {
    let squeeze: Affine = nalgebra::convert(nalgebra::Scale3::new(2.0, 1.0, 1.0));
    let profile = chain(&[[10., 5.], [15., 5.], [15., 40.], [10., 40.]]);
    let sector = leaf(Primitive::Revolution { frame: FRAME, profile, start: 20f64.to_radians(), angle: 100f64.to_radians() });
    let rod = leaf(Primitive::Cone { frame: FRAME, bottom_radius: 10.0, top_radius: 10.0, height: 30.0 });
    let solids = solids([rod, sector].into_iter().map(|l| Leaf { transform: squeeze, ..l }).collect());
    // Seen without the scale: 20 to 120 degrees.
    let is_on = |p: Vec3| is_at(Vec3::new(p.x / 2.0, p.y, p.z), 10.0);
    let [low, high] = [20f64, 120f64].map(|a| libm::atan2(a.to_radians().sin(), 2.0 * a.to_radians().cos()).to_degrees());
    let count = assert_alike(&solids, is_on, |angle, z| (5.0..=30.0).contains(&z) && (low - 0.1..=high + 0.1).contains(&angle));
    assert!(count > 20, "{count}");
}

/// A profile of two arcs about centres apart.
fn lens() -> Profile {
    let arc = |to: [f64; 2], center: [f64; 2]| Segment2 { end: to, arc: Some(Arc2 { center, is_ccw: true }), name: None };
    let segments = vec![arc([0., 6.], [-8., 0.]), arc([0., -6.], [8., 0.])];
    plain(Path2 { start: [0., -6.], segments, is_closed: true })
}

#[test]
fn arcs_side_by_side_are_closed_at_mitres() {
    let line = |to: [f64; 2]| Segment2 { end: to, arc: None, name: None };
    let path = Path2 { start: [0., 0.], segments: vec![line([30., 0.]), line([30., 25.])], is_closed: false };
    let wire = Primitive::PathSweep { frame: FRAME, profile: lens(), path };
    for is_triangulated in [false, true] {
        assert_eq!(check(&one(Leaf { is_triangulated, ..leaf(wire.clone()) })), 2);
    }
}

#[test]
fn arcs_side_by_side_are_closed_when_sheared() {
    let bar = Primitive::Extrusion { frame: FRAME, profile: lens(), length: 20.0 };
    let turned: Affine = nalgebra::convert(nalgebra::Rotation3::from_axis_angle(&Vec3::y_axis(), 0.7));
    let long = Affine::from_matrix_unchecked(nalgebra::Matrix4::new_nonuniform_scaling(&Vec3::new(1., 1., 3.)));
    for is_triangulated in [false, true] {
        assert_eq!(check(&one(Leaf { is_triangulated, transform: long * turned, ..leaf(bar.clone()) })), 2);
    }
}
