use super::solid::{Freedom, Shape};
use super::*;
use crate::geom::polygon::{triangulate, vector_area};
use crate::geom::{Affine, Vec3};
use crate::ids::IdVec;
use crate::scene::model::*;
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

pub(super) const FRAME: Frame = Frame {
    origin: Vec3::new(0.0, 0.0, 0.0),
    x: Vec3::new(1.0, 0.0, 0.0),
    y: Vec3::new(0.0, 1.0, 0.0),
    z: Vec3::new(0.0, 0.0, 1.0),
};

pub(super) fn leaf(primitive: Primitive) -> Leaf {
    Leaf {
        primitive,
        transform: Affine::identity(),
        division: Division { segments: Some(24), max_angle: None, max_chord_error: None },
        tolerance: None,
        is_triangulated: false,
        name: None,
        span: Default::default(),
    }
}

pub(super) fn scene(leaves: Vec<Leaf>) -> Scene {
    Scene {
        name: "test".into(),
        unit: "mm".into(),
        hash: String::new(),
        tolerance: 1e-9,
        overlap: Policy::Allow,
        gaps: Policy::Allow,
        remesh: Default::default(),
        mesh: Default::default(),
        leaves: leaves.into_iter().collect::<IdVec<_, _>>(),
        parts: IdVec::new(),
        boundaries: IdVec::new(),
        interfaces: Default::default(),
    }
}

pub(super) fn one(leaf: Leaf) -> Solid {
    build(&scene(vec![leaf])).unwrap().remove(0)
}

fn points(solid: &Solid) -> Vec<Vec3> {
    solid.vertices.iter().map(|v| v.point).collect()
}

fn triangles(solid: &Solid) -> Vec<[u32; 3]> {
    let points = points(solid);
    let cut = |f: solid::SolidFacet| {
        let loops: Vec<&[u32]> = f.loops.iter().collect();
        triangulate(&loops, &[], &[], &points).unwrap_or_else(|e| panic!("{e:?} {f:?}"))
    };
    solid.facets.iter().flat_map(cut).collect()
}

fn volume(solid: &Solid) -> f64 {
    let p = points(solid);
    let o = p[0];
    let six = |t: [u32; 3]| {
        let [a, b, c] = t.map(|v| p[v as usize] - o);
        a.dot(&b.cross(&c))
    };
    triangles(solid).into_iter().map(six).sum::<f64>() / 6.0
}

/// Every invariant of a solid; gives V - E + F - (loops - facets), which is 2 (shells - handles).
pub(super) fn check(solid: &Solid) -> i64 {
    let p = points(solid);
    let size = p.iter().map(|v| v.amax()).fold(0.0, f64::max);
    let mut edges: BTreeMap<(u32, u32), i32> = BTreeMap::new();
    let mut used = vec![false; p.len()];
    let mut holes = 0;
    for facet in solid.facets.iter() {
        assert!((facet.surface as usize) < solid.surfaces.len());
        holes += facet.loops.count() as i64 - 1;
        let normal = vector_area(facet.loops.iter(), &p).normalize();
        let at = p[facet.loops.outer()[0] as usize];
        for walk in facet.loops.iter() {
            assert!(walk.len() >= 3);
            for (k, &a) in walk.iter().enumerate() {
                used[a as usize] = true;
                *edges.entry((a, walk[(k + 1) % walk.len()])).or_default() += 1;
                let away = (p[a as usize] - at).dot(&normal).abs();
                assert!(away <= 4.0 * f64::EPSILON * size, "{away} from the plane: {facet:?}");
            }
        }
    }
    assert!(used.iter().all(|u| *u), "a vertex is unused");
    for (&(a, b), &n) in &edges {
        assert_eq!((n, edges.get(&(b, a))), (1, Some(&1)), "edge {a} {b} at {}", p[a as usize]);
    }
    let mut sorted: Vec<[u64; 3]> = p.iter().map(|v| [v.x, v.y, v.z].map(|c| (c + 0.0).to_bits())).collect();
    sorted.sort_unstable();
    assert!(sorted.windows(2).all(|w| w[0] != w[1]), "two vertices coincide");
    assert!(volume(solid) > 0.0, "inside out");
    p.len() as i64 - edges.len() as i64 / 2 + solid.facets.len() as i64 - holes
}

#[test]
fn a_circle_that_touches_its_axis_is_turned() {
    let arc = Some(Arc2 { center: [5.0, 0.0], is_ccw: true });
    let segments = vec![Segment2 { end: [10.0, 0.0], arc, name: None }];
    let outer = Path2 { start: [10.0, 0.0], segments, is_closed: true };
    let profile = Profile { outer, holes: Vec::new() };
    let solid = one(leaf(Primitive::Revolution { frame: FRAME, profile, start: 0.0, angle: TAU }));
    // Pinched in one vertex, whose two uses belong to one shell: a sphere with two points made one.
    assert_eq!(check(&solid), 1);
    // The polyhedron has less than the torus by its chord error.
    let exact = 2.0 * PI * PI * 5.0 * 25.0;
    assert!((0.95..1.0).contains(&(volume(&solid) / exact)), "{}", volume(&solid) / exact);
}

#[test]
fn an_arc_below_the_tolerance_is_no_circle() {
    let line = |end| Segment2 { end, arc: None, name: None };
    for radius in [1e-9, 2e-8] {
        let center = [20.0 - radius, 5.0];
        let arc = Segment2 { end: [20.0 - radius, 5.0 + radius], arc: Some(Arc2 { center, is_ccw: true }), name: None };
        let segments = vec![line([20.0, 0.0]), line([20.0, 5.0]), arc, line([10.0, 5.0 + radius]), line([10.0, 0.0])];
        let outer = Path2 { start: [10.0, 0.0], segments, is_closed: true };
        let profile = Profile { outer, holes: Vec::new() };
        let solid = one(leaf(Primitive::Revolution { frame: FRAME, profile, start: 0.0, angle: TAU }));
        let exact = PI * (400.0 - 100.0) * 5.0;
        assert!((0.97..1.0).contains(&(volume(&solid) / exact)));
    }
}

pub(super) fn smallest_angle(solid: &Solid, side: &str) -> f64 {
    let p = points(solid);
    let mut smallest = 180f64;
    for f in solid.facets.iter().filter(|f| solid.surfaces[f.surface as usize].side == side) {
        let w = f.loops.outer();
        assert_eq!(w.len(), 3);
        for k in 0..3 {
            let at = |i: usize| p[w[(k + i) % 3] as usize];
            smallest = smallest.min((at(1) - at(0)).angle(&(at(2) - at(0))).to_degrees());
        }
    }
    smallest
}

fn near(a: f64, b: f64) {
    assert!((a - b).abs() <= 1e-12 * b.abs(), "{a} is not {b}");
}

/// Area of a regular polygon on a circle, or of its part, in units of r^2.
fn chords(n: f64, sweep: f64) -> f64 {
    n / 2.0 * (sweep / n).sin()
}

fn cylinder(radius: f64, height: f64) -> Primitive {
    Primitive::Cone { frame: FRAME, bottom_radius: radius, top_radius: radius, height }
}

pub(super) fn polygon(points: &[[f64; 2]]) -> Path2 {
    let segment = |end| Segment2 { end, arc: None, name: None };
    let mut segments: Vec<Segment2> = points[1..].iter().copied().map(segment).collect();
    segments.push(segment(points[0]));
    Path2 { start: points[0], segments, is_closed: true }
}

fn circle(center: [f64; 2], radius: f64) -> Path2 {
    let start = [center[0] + radius, center[1]];
    let arc = Some(Arc2 { center, is_ccw: true });
    Path2 { start, segments: vec![Segment2 { end: start, arc, name: None }], is_closed: true }
}

fn rounded(lo: [f64; 2], hi: [f64; 2], r: f64) -> Path2 {
    let line = |x, y| Segment2 { end: [x, y], arc: None, name: None };
    let arc = |x, y, cx, cy| Segment2 { end: [x, y], arc: Some(Arc2 { center: [cx, cy], is_ccw: true }), name: None };
    let segments = vec![
        line(hi[0] - r, lo[1]),
        arc(hi[0], lo[1] + r, hi[0] - r, lo[1] + r),
        line(hi[0], hi[1] - r),
        arc(hi[0] - r, hi[1], hi[0] - r, hi[1] - r),
        line(lo[0] + r, hi[1]),
        arc(lo[0], hi[1] - r, lo[0] + r, hi[1] - r),
        line(lo[0], lo[1] + r),
        arc(lo[0] + r, lo[1], lo[0] + r, lo[1] + r),
    ];
    Path2 { start: [lo[0] + r, lo[1]], segments, is_closed: true }
}

pub(super) fn plain(outer: Path2) -> Profile {
    Profile { outer, holes: vec![] }
}

fn reversed(path: &Path2) -> Path2 {
    let mut ends: Vec<[f64; 2]> = vec![path.start];
    ends.extend(path.segments.iter().map(|s| s.end));
    let turn = |a: Arc2| Arc2 { is_ccw: !a.is_ccw, ..a };
    let segments = (0..path.segments.len())
        .rev()
        .map(|k| Segment2 { end: ends[k], arc: path.segments[k].arc.map(turn), name: None })
        .collect();
    Path2 { start: ends[ends.len() - 1], segments, is_closed: path.is_closed }
}

#[test]
fn block_and_mirrored_block() {
    let mut block = leaf(Primitive::Block { lo: Vec3::new(-1., 0., 2.), hi: Vec3::new(1., 3., 6.) });
    let solid = one(block.clone());
    assert_eq!((check(&solid), solid.facets.len(), volume(&solid)), (2, 6, 24.0));
    block.transform = nalgebra::convert(nalgebra::Scale3::new(-1.0, 1.0, 2.0));
    let solid = one(block);
    assert_eq!((check(&solid), volume(&solid)), (2, 48.0));
    let facet = solid.facets.iter().find(|f| solid.surfaces[f.surface as usize].side == "x+").unwrap();
    assert!(facet.loops.outer().iter().all(|v| solid.vertices[*v as usize].point.x == -1.0));
}

#[test]
fn pyramids_of_either_orientation() {
    for (reverse, z) in [(false, 3.0), (true, 3.0), (false, -3.0), (true, -3.0)] {
        let mut base = vec![[0., 0.], [4., 0.], [4., 4.], [2., 1.], [0., 4.]];
        if reverse {
            base.reverse();
        }
        let solid = one(leaf(Primitive::Pyramid { frame: FRAME, base, apex: Vec3::new(1., 1., z) }));
        assert_eq!((check(&solid), solid.facets.len()), (2, 6));
        near(volume(&solid), 10.0);
    }
}

#[test]
fn cylinder_frustum_and_cones() {
    let solid = one(leaf(cylinder(50.0, 100.0)));
    assert_eq!((check(&solid), solid.facets.len(), solid.surfaces.len()), (2, 26, 3));
    near(volume(&solid), chords(24., TAU) * 2500.0 * 100.0);
    assert_eq!(solid.vertices[0].freedom, Freedom::Edge);
    assert!(points(&solid).contains(&Vec3::new(50.0, 0.0, 0.0)));
    for (r0, r1, facets) in [(50., 20., 26), (50., 0., 25), (0., 50., 25)] {
        let solid = one(leaf(Primitive::Cone { frame: FRAME, bottom_radius: r0, top_radius: r1, height: 90.0 }));
        assert_eq!((check(&solid), solid.facets.len()), (2, facets));
        near(volume(&solid), chords(24., TAU) * (r0 * r0 + r0 * r1 + r1 * r1) * 30.0);
        let fixed = solid.vertices.iter().filter(|v| v.freedom == Freedom::Fixed).count();
        assert_eq!(fixed, usize::from(r0 == 0.0 || r1 == 0.0));
        let side = solid.surfaces.iter().find(|s| s.side == "side").unwrap();
        assert!(matches!(side.shape, Shape::Cone { radius, slope, .. } if radius == r0 && slope == (r1 - r0) / 90.0));
    }
}

#[test]
fn triangulated_cylinder_and_cone_are_well_shaped() {
    for (r1, angle) in [(50.0, 45.0), (0.0, 15.0)] {
        let cone = Primitive::Cone { frame: FRAME, bottom_radius: 50.0, top_radius: r1, height: 100.0 };
        let solid = one(Leaf { is_triangulated: true, ..leaf(cone) });
        assert_eq!(check(&solid), 2);
        let smallest = smallest_angle(&solid, "side");
        assert!(smallest > angle, "{smallest} in {} facets", solid.facets.len());
    }
}

#[test]
fn sphere_has_all_vertices_on_it() {
    let solid = one(leaf(Primitive::Ellipsoid { center: Vec3::new(25., 25., 75.), radii: Vec3::repeat(30.0) }));
    assert_eq!((check(&solid), solid.facets.len()), (2, 8 * 36));
    for v in &solid.vertices {
        assert!(((v.point - Vec3::new(25., 25., 75.)).norm() - 30.0).abs() < 2e-14 * 3.0);
    }
    let on_equator = solid.vertices.iter().filter(|v| v.point.z == 75.0).count();
    assert_eq!(on_equator, 24);
    assert!(smallest_angle(&solid, "side") > 44.0);
}

#[test]
fn ellipsoids_written_twice_are_one() {
    let sphere = |n, turn: f64| Leaf {
        division: Division { segments: Some(n), max_angle: None, max_chord_error: None },
        transform: nalgebra::convert(nalgebra::Rotation3::from_axis_angle(&Vec3::x_axis(), turn)),
        ..leaf(Primitive::Ellipsoid { center: Vec3::new(7., 0., 0.), radii: Vec3::repeat(3.0) })
    };
    let other = leaf(Primitive::Ellipsoid { center: Vec3::new(7., 0., 0.), radii: Vec3::new(3., 3., 4.) });
    let solids = build(&scene(vec![sphere(24, 0.0), sphere(40, 0.3), other])).unwrap();
    assert_eq!(solids[0].facets.len(), 800);
    assert_eq!(points(&solids[0]), points(&solids[1]));
    assert_eq!(solids[2].facets.len(), 288);
}

#[test]
fn torus_and_sphere_by_revolution() {
    let torus = one(leaf(Primitive::Torus { frame: FRAME, major_radius: 50.0, minor_radius: 15.0 }));
    assert_eq!(check(&torus), 0);
    let exact = 2.0 * PI * PI * 50.0 * 225.0;
    assert!((volume(&torus) / exact - 0.985).abs() < 0.015, "{}", volume(&torus) / exact);
    assert!(smallest_angle(&torus, "side") > 30.0, "{}", smallest_angle(&torus, "side"));
    assert!(torus.vertices.iter().all(|v| v.freedom == Freedom::Surface));
    let half = Path2 {
        start: [0.0, -20.0],
        segments: vec![
            Segment2 { end: [0.0, 20.0], arc: Some(Arc2 { center: [0.0, 0.0], is_ccw: true }), name: None },
            Segment2 { end: [0.0, -20.0], arc: None, name: None },
        ],
        is_closed: true,
    };
    let turned = |start, angle| leaf(Primitive::Revolution { frame: FRAME, profile: plain(half.clone()), start, angle });
    let ball = one(turned(0.0, TAU));
    assert_eq!(check(&ball), 2);
    assert!(matches!(ball.surfaces[0].shape, Shape::Ellipsoid { radii, .. } if radii == Vec3::repeat(20.0)));
    assert!(smallest_angle(&ball, "side1") > 28.0, "{}", smallest_angle(&ball, "side1"));
    let wedge = one(turned(0.5, 1.0));
    assert_eq!(check(&wedge), 2);
    assert!((volume(&wedge) / volume(&ball) * TAU - 1.0).abs() < 0.02);
}

#[test]
fn rings_and_sectors_are_few_facets() {
    let ring = plain(polygon(&[[45., 0.], [52., 0.], [52., 100.], [45., 100.]]));
    let turned = |start: f64, angle: f64| {
        one(leaf(Primitive::Revolution {
            frame: FRAME,
            profile: ring.clone(),
            start: start.to_radians(),
            angle: angle.to_radians(),
        }))
    };
    let full = turned(0., 360.);
    assert_eq!((check(&full), full.facets.len()), (0, 50));
    assert_eq!(full.facets.iter().filter(|f| f.loops.count() == 2).count(), 2);
    near(volume(&full), chords(24., TAU) * (52. * 52. - 45. * 45.) * 100.);
    let part = turned(15., 60.);
    assert_eq!((check(&part), part.facets.len()), (2, 12));
    near(volume(&part), chords(4., TAU / 6.) * (52. * 52. - 45. * 45.) * 100.);
    assert_eq!(part.vertices.iter().filter(|v| v.freedom == Freedom::Fixed).count(), 8);
    let pie = plain(polygon(&[[0., 0.], [52., 0.], [52., 100.], [0., 100.]]));
    let pie = one(leaf(Primitive::Revolution { frame: FRAME, profile: pie, start: 0.0, angle: PI / 2.0 }));
    assert_eq!((check(&pie), pie.facets.len()), (2, 10));
}

#[test]
fn coaxial_leaves_share_bits() {
    let n = |segments| Division { segments: Some(segments), max_angle: None, max_chord_error: None };
    let ring = plain(polygon(&[[45., 0.], [52., 0.], [52., 100.], [45., 100.]]));
    let sector =
        Primitive::Revolution { frame: FRAME, profile: ring.clone(), start: (-7f64).to_radians(), angle: 14f64.to_radians() };
    let whole = Primitive::Revolution { frame: FRAME, profile: ring, start: 0.0, angle: TAU };
    let rotor = Leaf { division: n(24), ..leaf(cylinder(45.0, 100.0)) };
    let around = Leaf { division: n(36), ..leaf(whole) };
    let turned = |degrees: f64| Leaf {
        transform: nalgebra::convert(nalgebra::Rotation3::from_axis_angle(&Vec3::z_axis(), degrees.to_radians())),
        ..leaf(sector.clone())
    };
    let solids = build(&scene(vec![rotor, around, turned(0.0), turned(30.0), turned(210.0)])).unwrap();
    let rim = |s: &Solid| {
        let on = |p: &Vec3| p.z == 0.0 && (p.xy().norm() - 45.0).abs() < 1e-9;
        points(s).into_iter().filter(on).map(|p| [p.x, p.y].map(f64::to_bits)).collect::<Vec<_>>()
    };
    let (inner, outer) = (rim(&solids[0]), rim(&solids[1]));
    assert_eq!(inner, outer);
    for s in &solids[2..] {
        assert_eq!(rim(s).len(), 3);
        assert!(rim(s).iter().all(|p| inner.contains(p)));
        check(s);
    }
}

#[test]
fn a_tilted_axis_turns_alike() {
    let tilt: Affine = nalgebra::convert(nalgebra::Isometry3::new(Vec3::new(3., 4., 5.), Vec3::new(0.3, 0.5, 0.1)));
    let lift = Frame { origin: Vec3::new(0., 0., 100.), ..FRAME };
    let low = Leaf { transform: tilt, ..leaf(cylinder(45.0, 100.0)) };
    let high = Primitive::Cone { frame: lift, bottom_radius: 45.0, top_radius: 20.0, height: 10.0 };
    let solids = build(&scene(vec![low, Leaf { transform: tilt, ..leaf(high) }])).unwrap();
    solids.iter().for_each(|s| assert_eq!(check(s), 2));
    let shared = points(&solids[1]).iter().filter(|p| points(&solids[0]).iter().any(|q| (*p - q).norm() < 1e-13)).count();
    assert_eq!(shared, 24);
}

#[test]
fn ellipses_keep_their_image() {
    let mut squeezed = leaf(cylinder(10.0, 5.0));
    squeezed.transform = nalgebra::convert(nalgebra::Scale3::new(2.0, 1.0, 1.0));
    let solid = one(squeezed.clone());
    check(&solid);
    near(volume(&solid), chords(24., TAU) * 100. * 2. * 5.);
    assert!(solid.surfaces.iter().any(|s| matches!(s.shape, Shape::Image { .. })));
    squeezed.transform = nalgebra::convert(nalgebra::Scale3::new(2.0, -2.0, 3.0));
    let solid = one(squeezed);
    check(&solid);
    assert!(solid.surfaces.iter().any(|s| matches!(s.shape, Shape::Cone { radius: 20.0, .. })));
}

#[test]
fn extrusions_with_holes_and_arcs() {
    let outer = rounded([94., 0.], [294., 200.], 50.);
    let inner = rounded([119., 25.], [269., 175.], 25.);
    for (outer, inner) in [(outer.clone(), inner.clone()), (reversed(&outer), reversed(&inner))] {
        for is_triangulated in [false, true] {
            let profile = Profile { outer: outer.clone(), holes: vec![inner.clone(), circle([194., 12.], 5.)] };
            let coil = Primitive::Extrusion { frame: FRAME, profile, length: 100.0 };
            let solid = one(Leaf { is_triangulated, ..leaf(coil) });
            assert_eq!(check(&solid), -2);
            let corner = |r: f64| r * r * (1.0 - chords(6., PI / 2.));
            let area = 4e4 - 4. * corner(50.) - (22500. - 4. * corner(25.)) - chords(24., TAU) * 25.0;
            if !is_triangulated {
                near(volume(&solid), area * 100.0);
                assert_eq!(solid.facets.len(), 2 + 2 * (4 + 24) + 24);
            }
            assert!(solid.vertices.iter().all(|v| v.freedom != Freedom::Fixed));
            assert_eq!(solid.surfaces.iter().filter(|s| s.side.starts_with("hole1_side")).count(), 8);
        }
    }
}

#[test]
fn triangulated_round_bar_is_well_shaped() {
    let bar = Primitive::Extrusion { frame: FRAME, profile: plain(circle([5., 5.], 10.0)), length: 40.0 };
    let solid = one(Leaf { is_triangulated: true, ..leaf(bar) });
    assert_eq!(check(&solid), 2);
    assert!(smallest_angle(&solid, "side1") > 45.0);
}

#[test]
fn racetrack_coil() {
    let path = rounded([0., 0.], [200., 100.], 30.);
    let section = plain(polygon(&[[-5., 0.], [5., 0.], [5., 20.], [-5., 20.]]));
    for path in [path.clone(), reversed(&path)] {
        for is_triangulated in [false, true] {
            let coil = Primitive::PathSweep { frame: FRAME, profile: section.clone(), path: path.clone() };
            let solid = one(Leaf { is_triangulated, ..leaf(coil) });
            assert_eq!(check(&solid), 0);
            let ring = |r: f64| chords(24., TAU) * r * r;
            let area = 2. * 10. * (140. + 40.) + ring(35.) - ring(25.);
            if !is_triangulated {
                near(volume(&solid), area * 20.0);
                assert_eq!(solid.facets.len(), 2 + 2 * (4 + 24));
                assert_eq!(solid.facets.iter().filter(|f| f.loops.count() == 2).count(), 2);
            }
        }
    }
}

#[test]
fn mitred_and_round_paths() {
    let square = polygon(&[[0., 0.], [100., 0.], [100., 60.], [0., 60.]]);
    let section = plain(polygon(&[[-5., 0.], [5., 0.], [0., 8.]]));
    let frame = one(leaf(Primitive::PathSweep { frame: FRAME, profile: section, path: square }));
    assert_eq!((check(&frame), frame.facets.len()), (0, 1 + 8));
    near(volume(&frame), 40.0 * 320.0);
    assert!(frame.vertices.iter().all(|v| v.freedom == Freedom::Fixed));
    let mut open = rounded([0., 0.], [200., 100.], 30.);
    open.segments.truncate(4);
    open.is_closed = false;
    for path in [open.clone(), reversed(&open)] {
        let wire = Primitive::PathSweep { frame: FRAME, profile: plain(circle([1., 2.], 4.)), path: path.clone() };
        for is_triangulated in [false, true] {
            let solid = one(Leaf { is_triangulated, ..leaf(wire.clone()) });
            assert_eq!(check(&solid), 2);
            let exact = PI * 16. * (140. + 40. + PI * 30.);
            assert!((volume(&solid) / exact - 0.985).abs() < 0.02, "{}", volume(&solid) / exact);
        }
    }
}

#[test]
fn impossible_shapes_are_refused() {
    let code = |p: Primitive| build(&scene(vec![leaf(p)])).unwrap_err()[0].code;
    let profile = plain(polygon(&[[-5., 0.], [5., 0.], [5., 20.], [-5., 20.]]));
    let tight = rounded([0., 0.], [200., 100.], 4.);
    assert_eq!(code(Primitive::PathSweep { frame: FRAME, profile: profile.clone(), path: tight }), "bad-path");
    let narrow = polygon(&[[0., 0.], [100., 0.], [100., 6.], [0., 6.]]);
    assert_eq!(code(Primitive::PathSweep { frame: FRAME, profile: profile.clone(), path: narrow }), "bad-path");
    assert_eq!(code(Primitive::Revolution { frame: FRAME, profile, start: 0., angle: TAU }), "bad-profile");
    // 24 chords of radius 10 come as near as 9.91 to the centre.
    let thin = Profile { outer: circle([0., 0.], 10.), holes: vec![polygon(&[[9.95, -0.1], [9.95, 0.1], [0., 0.]])] };
    build(&scene(vec![leaf(Primitive::Extrusion { frame: FRAME, profile: thin, length: 1. })])).unwrap();
    let turn = (7.5f64).to_radians();
    let (c, s) = (9.95 * turn.cos(), 9.95 * turn.sin());
    let thin = Profile { outer: circle([0., 0.], 10.), holes: vec![polygon(&[[c, s - 0.1], [c, s + 0.1], [0., 0.]])] };
    assert_eq!(code(Primitive::Extrusion { frame: FRAME, profile: thin, length: 1. }), "bad-profile");
    let bow = plain(polygon(&[[0., 0.], [1., 1.], [1., 0.], [0., 1.]]));
    assert_eq!(code(Primitive::Extrusion { frame: FRAME, profile: bow, length: 1. }), "bad-profile");
    let huge = Leaf {
        division: Division { segments: Some(u32::MAX), max_angle: None, max_chord_error: None },
        ..leaf(cylinder(1.0, 1.0))
    };
    assert_eq!(build(&scene(vec![huge])).unwrap_err()[0].code, "too-many-segments");
}
