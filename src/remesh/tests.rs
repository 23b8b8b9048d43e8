//! Cylinders, cones and spheres built in code; a tee of two cylinders comes from the evaluator's scenes.

use super::quality::sharpest_cosine;
use super::*;
use crate::brep::complex::{ComplexFacet, ComplexSurface, ComplexVertex, Marker, Region};
use crate::ids::{LeafId, MarkerId, PartId, RegionId, SurfaceId, VertexId};
use crate::primitive::solid::{Freedom, Shape};
use crate::scene::model::Frame;

const FRAME: Frame = Frame {
    origin: Vec3::new(0.0, 0.0, 0.0),
    x: Vec3::new(1.0, 0.0, 0.0),
    y: Vec3::new(0.0, 1.0, 0.0),
    z: Vec3::new(0.0, 0.0, 1.0),
};

/// A solid of one part from polygons with their surface.
fn complex(points: Vec<(Vec3, Freedom)>, polygons: Vec<(Vec<u32>, u32)>, shapes: Vec<Shape>) -> Complex {
    let positions: Vec<Vec3> = points.iter().map(|p| p.0).collect();
    let facets = polygons.into_iter().enumerate().map(|(k, (walk, surface))| ComplexFacet {
        triangles: crate::geom::polygon::triangulate(&[&walk], &[], &[], &positions)
            .unwrap()
            .into_iter()
            .map(|t| t.map(VertexId))
            .collect(),
        loops: vec![walk.into_iter().map(VertexId).collect()],
        sides: [RegionId(0), RegionId(1)],
        surface: SurfaceId(surface),
        source: (LeafId(0), k as u32),
        marker: MarkerId(0),
        is_modified: true,
    });
    let surface = |shape| ComplexSurface { leaf: LeafId(0), side: "side".into(), shape };
    Complex {
        facets: facets.collect(),
        vertices: points.into_iter().map(|(point, freedom)| ComplexVertex { point, freedom }).collect(),
        regions: [Region { part: None }, Region { part: Some(PartId(0)) }].into_iter().collect(),
        surfaces: shapes.into_iter().map(surface).collect(),
        markers: [Marker { name: "a|outer".into(), parts: [Some(PartId(0)), None], interface: MarkerId(0), max_edge: None }]
            .into_iter()
            .collect(),
        killed: Vec::new(),
    }
}

fn rim(radius: f64, z: f64, n: u32) -> impl Iterator<Item = (Vec3, Freedom)> {
    (0..n).map(move |k| {
        let a = std::f64::consts::TAU * f64::from(k) / f64::from(n);
        (Vec3::new(radius * libm::cos(a), radius * libm::sin(a), z), Freedom::Edge)
    })
}

pub fn cylinder(radius: f64, height: f64, n: u32) -> Complex {
    let points = rim(radius, 0.0, n).chain(rim(radius, height, n)).collect();
    let mut polygons = vec![((0..n).rev().collect(), 1), ((n..2 * n).collect(), 2)];
    polygons.extend((0..n).map(|k| (vec![k, (k + 1) % n, n + (k + 1) % n, n + k], 0)));
    let side = Shape::Cone { frame: FRAME, radius, slope: 0.0 };
    complex(points, polygons, vec![side, Shape::Plane, Shape::Plane])
}

pub fn cone(radius: f64, height: f64, n: u32) -> Complex {
    let mut points: Vec<_> = rim(radius, 0.0, n).collect();
    points.push((Vec3::new(0.0, 0.0, height), Freedom::Fixed));
    let mut polygons = vec![((0..n).rev().collect::<Vec<u32>>(), 1)];
    polygons.extend((0..n).map(|k| (vec![k, (k + 1) % n, n], 0)));
    complex(points, polygons, vec![Shape::Cone { frame: FRAME, radius, slope: -radius / height }, Shape::Plane])
}

/// Smallest angle in degrees and share above 40 degrees of the triangular facets of surface 0; number of all its triangles.
fn quality(complex: &Complex) -> (f64, f64, usize) {
    let facets = || complex.facets.iter().filter(|f| f.surface == SurfaceId(0));
    let angle = |f: &ComplexFacet| {
        let t = [0, 1, 2].map(|k| &complex.vertices[f.loops[0][k]].point);
        libm::acos(sharpest_cosine(t, 0.0)).to_degrees()
    };
    let angles: Vec<f64> = facets().filter(|f| f.triangles.len() == 1).map(angle).collect();
    let least = angles.iter().copied().fold(90.0, f64::min);
    let good = angles.iter().filter(|&&a| a > 40.0).count();
    (least, good as f64 / angles.len() as f64, facets().map(|f| f.triangles.len()).sum())
}

fn volume(complex: &Complex) -> f64 {
    let p = |v: VertexId| complex.vertices[v].point;
    let triangles = complex.facets.iter().flat_map(|f| f.triangles.iter());
    triangles.map(|t| p(t[0]).dot(&p(t[1]).cross(&p(t[2]))) / 6.0).sum()
}

fn full(max_deviation: f64) -> RemeshOptions {
    RemeshOptions { mode: RemeshMode::Full, max_deviation: Some(max_deviation), ..Default::default() }
}

#[test]
fn cylinder_gets_good_triangles_within_the_deviation() {
    let (radius, height, deviation) = (50.0, 200.0, 1.0);
    let before = cylinder(radius, height, 24);
    let after = remesh(before, &full(deviation), &IdVec::new()).unwrap();
    let (least, good, count) = quality(&after);
    let ideal = std::f64::consts::TAU * height / (6.0 * deviation) * 3f64.sqrt();
    // The aim is 1.5 times the ideal number. Here it is missed: the 24 chords of the rims are 0.74 wanted lengths long, just
    // too long to be collapsed, and the triangles between follow them.
    let share = count as f64 / ideal;
    assert!(least >= 30.0 && good >= 0.97 && share < 2.0, "{least} degrees, {good} above 40, {share} of the ideal number");
    let exact = std::f64::consts::PI * radius * radius * height;
    assert!((volume(&after) - exact).abs() < deviation * std::f64::consts::TAU * radius * height);
    // On the surface, or in a plane with neighbours near it.
    for v in after.vertices.iter() {
        assert!((libm::hypot(v.point.x, v.point.y) - radius).abs() <= deviation);
    }
}

#[test]
fn cone_keeps_its_apex_and_gets_few_triangles() {
    let after = remesh(cone(50.0, 100.0, 24), &full(0.46), &IdVec::new()).unwrap();
    let (least, good, count) = quality(&after);
    assert!(least >= 30.0 && good >= 0.97 && count < 700);
    assert!(after.vertices.iter().any(|v| v.point == Vec3::new(0.0, 0.0, 100.0)));
}

#[test]
fn no_facets_are_almost_in_one_plane() {
    let after = remesh(cylinder(50.0, 200.0, 24), &full(1.0), &IdVec::new()).unwrap();
    let point = |v: VertexId| after.vertices[v].point;
    let normal = |f: &ComplexFacet| {
        let corners = f.triangles.iter().map(|t| t.map(point));
        corners.map(|[a, b, c]| (b - a).cross(&(c - a))).sum::<Vec3>().normalize()
    };
    let side: Vec<&ComplexFacet> = after.facets.iter().filter(|f| f.surface == SurfaceId(0)).collect();
    assert!(side.iter().any(|f| f.triangles.len() > 1), "some facets share a plane");
    let mut pairs = 0;
    for (k, f) in side.iter().enumerate() {
        for g in &side[k + 1..] {
            let shared = f.loops[0].iter().filter(|v| g.loops[0].contains(v)).count();
            // TetGen merges what is bent by less than 0.1 degrees.
            if shared == 2 && normal(f).cross(&normal(g)).norm() < 1.7e-3 {
                let height = |v: &VertexId| normal(f).dot(&(point(*v) - point(f.loops[0][0]))).abs();
                assert!(g.loops[0].iter().all(|v| height(v) < 1e-10));
            }
            pairs += usize::from(shared == 2);
        }
    }
    assert!(pairs > 100);
}

/// A complex all of whose curved facets have been remeshed, before facets are brought into one plane.
pub fn polished(complex: Complex, max_deviation: f64) -> Workpiece {
    let supports = supports_of(&complex, RemeshOptions::default().patches);
    let gaps = Gaps::of(&complex, &supports);
    let choice = Choice::all(&complex, &supports, &gaps, &RemeshOptions::default(), &IdVec::new());
    let shares = vec![1.0; complex.surfaces.len()];
    let mut work = Workpiece::new(complex, supports, shares, choice).unwrap();
    work.bounds = Bounds::Given(max_deviation);
    let treated = work.chosen();
    let limits = Limits::new(&gaps, 1.0, &work.brep.markers, &IdVec::new());
    work.divide(&treated);
    work.find_features();
    assert!(work.run(&limits));
    work
}

/// Beside a strut through a thin shell, facets stood upright on the true sphere. The nearest point to the middle of an edge lay at
/// its foot or beyond, so that splitting it gave as long an edge again, a hundred thousand times.
#[test]
fn splits_shorten_edges_that_stand_upright_on_their_surface() {
    let mut work = polished(cylinder(50.0, 200.0, 24), 1.0);
    let spike = work.active_vertices().into_iter().find(|&v| matches!(work.place(v), workpiece::Place::Surface(_))).unwrap();
    let longest = work.active_edges().into_iter().map(|e| work.length(e)).fold(0.0, f64::max);
    let foot = work.point(spike);
    work.relocate(spike, foot + Vec3::new(foot.x, foot.y, 0.0).normalize() * (4.0 * longest));
    let edges: Vec<_> = work.brep.topology.edges_at(spike).collect();
    let mut count = 0;
    for edge in edges {
        let ends = work.brep.topology.ends(edge).map(|v| work.point(v));
        let Some((_, at)) = work.site_of_split(edge) else { continue };
        assert!(ends.iter().all(|end| (at - end).norm() < 0.9 * work.length(edge)));
        count += 1;
    }
    assert!(count > 0);
}

/// Turns of wire that touch their core had every attempt broken off twice, the second time with twice as many triangles.
#[test]
fn a_surface_that_broke_an_attempt_off_is_not_tried_closer() {
    let complex = cylinder(50.0, 200.0, 24);
    let supports = supports_of(&complex, RemeshOptions::default().patches);
    let give_up = |is_done| {
        let choice = Choice { is_chosen: vec![true; complex.facets.len()], slides: Vec::new() };
        let mut retreat = Retreat { shares: vec![1.0; 3], choice, round: 0.0 };
        let place = Aabb::around(&[Vec3::new(50.0, 0.0, 90.0), Vec3::new(50.0, 0.0, 91.0)]);
        let fault = Fault { surface: SurfaceId(0), place, is_contact: true };
        assert!(retreat.give_up(&[fault], is_done, &complex, &supports));
        (retreat.shares[0], retreat.choice.is_chosen.contains(&false))
    };
    assert_eq!(give_up(true), (CLOSER_SHARE, false));
    assert_eq!(give_up(false), (1.0, true));
}

#[test]
fn off_changes_nothing() {
    let before = cylinder(1.0, 1.0, 8);
    let options = RemeshOptions { mode: RemeshMode::Off, ..Default::default() };
    assert_eq!(remesh(before.clone(), &options, &IdVec::new()).unwrap().facets, before.facets);
}

/// Distance from the axis of what a fitted support of the side makes of a point.
fn fitted_radius(complex: &Complex, point: Vec3) -> f64 {
    let supports = supports_of(complex, crate::scene::model::PatchMode::BSpline);
    let foot = supports[SurfaceId(0)].as_ref().unwrap().nearest(&point).point;
    libm::hypot(foot.x, foot.y)
}

#[test]
fn patches_of_long_strips_are_round_between_their_ends() {
    // A chord's middle is 0.43 inside; a plate without bending of its own would be 0.3 inside between the rims.
    let complex = cylinder(50.0, 300.0, 24);
    let apothem = 50.0 * libm::cos(std::f64::consts::PI / 24.0);
    for z in [1.0, 75.0, 150.0, 290.0] {
        let angle = std::f64::consts::PI / 24.0;
        let middle = Vec3::new(apothem * libm::cos(angle), apothem * libm::sin(angle), z);
        let radius = fitted_radius(&complex, middle);
        assert!((radius - 50.0).abs() < 0.03, "{radius} at {z}");
    }
}

#[test]
fn killed_caps_do_not_belong_to_the_side() {
    let mut complex = cylinder(50.0, 100.0, 24);
    let point = |v: VertexId| complex.vertices[v].point;
    let caps = complex.facets.iter().filter(|f| f.surface != SurfaceId(0));
    let triangles = caps.flat_map(|f| f.triangles.iter().map(move |t| (f.source, t.map(point))));
    let killed = triangles.map(|(source, triangle)| crate::brep::complex::KilledFacet { source, triangle }).collect();
    complex.facets = complex.facets.iter().filter(|f| f.surface == SurfaceId(0)).cloned().collect();
    complex.killed = killed;
    // Nearer to the cap than to the side, whose patch it is to be brought on.
    let radius = fitted_radius(&complex, Vec3::new(47.0, 1.0, 100.0));
    assert!((radius - 50.0).abs() < 0.03, "{radius}");
}
