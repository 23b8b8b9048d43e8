//! Each defect is found, and only that one.

use super::*;
use crate::geom::Vec3;
use crate::plc::samples::{self, Sample};
use crate::plc::{PlcFacet, Seed};

fn plc_of(sample: &Sample) -> Plc {
    build::build(&sample.complex(), &sample.scene().parts).unwrap()
}

/// The kinds of findings after a change to a valid PLC.
fn codes(sample: &Sample, change: impl Fn(&mut Plc)) -> Vec<&'static str> {
    let mut plc = plc_of(sample);
    assert_eq!(check(&plc, None), []);
    change(&mut plc);
    let mut codes: Vec<_> = check(&plc, None).iter().map(|d| d.code).collect();
    codes.dedup();
    codes
}

#[test]
fn seeded_defects_are_found_one_by_one() {
    for sample in [samples::two_cubes(), samples::two_cubes().rotated()] {
        assert_eq!(codes(&sample, |p| p.facets.push(p.facets[3].clone())), ["duplicate-facet"]);
        assert_eq!(codes(&sample, |p| drop(p.facets.remove(0))), ["open-edge"]);
        assert_eq!(codes(&sample, |p| p.seeds.truncate(1)), ["missing-seed"]);
        assert_eq!(
            codes(&sample, |p| {
                let point = p.seeds[0].point * 0.75 + p.seeds[1].point * 0.25;
                p.seeds.push(Seed { point, region: 9, max_volume: None });
            }),
            ["two-seeds"]
        );
        let empty = PlcFacet { polygons: vec![vec![0, 1]], ..PlcFacet::default() };
        assert_eq!(codes(&sample, |p| p.facets.push(empty.clone()))[0], "bad-polygon");
        let outside = |p: &mut Plc| p.seeds.push(Seed { point: Vec3::repeat(50.0), region: 9, max_volume: None });
        assert_eq!(codes(&sample, outside), ["seed-outside"]);
        assert_eq!(codes(&sample, |p| p.vertices.push(Vec3::repeat(7.0))), ["orphan-vertex"]);
        let duplicate = |p: &mut Plc| {
            p.vertices.push(p.vertices[0]);
            let last = p.vertices.len() as u32 - 1;
            p.facets[0].polygons[0].iter_mut().filter(|v| **v == 0).for_each(|v| *v = last);
        };
        assert_eq!(codes(&sample, duplicate), ["duplicate-vertex"]);
        let lift = |p: &mut Plc| {
            // A corner of three squares, moved across all of them.
            let step = (p.vertices[8] - p.vertices[1] + p.vertices[0] - p.vertices[2]) * 1e-12;
            p.vertices[8] += step;
        };
        assert_eq!(codes(&sample, lift), ["not-planar"]);
    }
}

#[test]
fn a_vertex_in_an_edge_of_one_polygon_is_a_t_junction() {
    let junction = |p: &mut Plc| {
        p.vertices.push((p.vertices[0] + p.vertices[1]) * 0.5);
        let last = p.vertices.len() as u32 - 1;
        // Side y- is 0, 1, 5, 4.
        p.facets[2].polygons[0].insert(1, last);
    };
    assert_eq!(codes(&samples::two_cubes(), junction), ["t-junction"]);
}

#[test]
fn a_vertex_that_no_facet_lists_may_lie_on_one() {
    let put = |p: &mut Plc| p.vertices.push(Vec3::new(0.5, 0.25, 1.0));
    assert_eq!(codes(&samples::cube(), put), ["unlisted-vertex"]);
}

#[test]
fn penetration_by_one_unit_in_the_last_place() {
    let sample = samples::touching();
    let clear = |z: f64| {
        move |p: &mut Plc| {
            // The pyramid's apex, vertex 8, leaves the list of the top and moves.
            p.facets[5].polygons.retain(|w| w.len() != 1);
            p.vertices[8].z = z;
        }
    };
    assert_eq!(codes(&sample, clear(1.0 + f64::EPSILON)), [""; 0]);
    assert_eq!(codes(&sample, clear(1.0)), ["vertex-on-facet"]);
    assert_eq!(codes(&sample, clear(1.0 - f64::EPSILON / 2.0)), ["penetration"]);
}

#[test]
fn a_sheet_a_seed_on_a_facet_and_a_crossing_polygon() {
    let sheet = |p: &mut Plc| {
        let base = p.vertices.len() as u32;
        for (x, y) in [(0.2, 0.2), (0.4, 0.2), (0.3, 0.4)] {
            p.vertices.push(Vec3::new(x, y, 0.5));
        }
        p.facets.push(PlcFacet { polygons: vec![vec![base, base + 1, base + 2]], holes: vec![], marker: 1 });
    };
    assert_eq!(codes(&samples::cube(), sheet), ["open-edge"]);
    assert_eq!(codes(&samples::cube(), |p| p.seeds[0].point.z = 1.0), ["seed-on-facet"]);
    assert_eq!(codes(&samples::cube(), |p| p.facets[0].polygons[0].swap(0, 1)), ["not-simple"]);
}

#[test]
fn a_bent_facet_is_found_however_it_is_listed() {
    let lift = |p: &mut Plc| {
        let top = p.facets[0].polygons[0].clone();
        p.vertices[top[0] as usize] += Vec3::new(0.1, 0.2, 0.3);
        top
    };
    let whole = codes(&samples::cube(), |p| _ = lift(p));
    assert!(whole.contains(&"not-planar"));
    let by_segments = codes(&samples::cube(), |p| {
        let top = lift(p);
        p.facets[0].polygons = (0..4).map(|k| vec![top[k], top[(k + 1) % 4]]).collect();
    });
    assert_eq!(by_segments, whole);
}

/// A cube in a large one, with further vertices 16, ...; region 1 between them and region 2 inside.
fn nested(further: &[[f64; 3]], change: impl Fn(&mut Plc)) -> Vec<(&'static str, Severity)> {
    let corner = |k: usize, lo: f64, hi: f64| [k & 1, k >> 1 & 1, k >> 2].map(|b| if b == 0 { lo } else { hi });
    let corners = (0..16).map(|k| corner(k % 8, [-3.0, 0.0][k / 8], [6.0, 1.0][k / 8]));
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let facet = |k: u32| PlcFacet {
        polygons: vec![sides[k as usize % 6].map(|v| v + k / 6 * 8).to_vec()],
        holes: vec![],
        marker: 1 + i64::from(k),
    };
    let seed = |x: f64, region| Seed { point: Vec3::repeat(x), region, max_volume: None };
    let mut plc = Plc {
        vertices: corners.chain(further.iter().copied()).map(Vec3::from).collect(),
        facets: (0..12).map(facet).collect(),
        seeds: vec![seed(-1.5, 1), seed(0.45, 2)],
        holes: vec![],
    };
    change(&mut plc);
    check(&plc, None).iter().map(|d| (d.code, d.severity)).collect()
}

#[test]
fn spikes_and_segments_take_part_in_the_test_for_contacts() {
    // Vertex 15 is the corner (1, 1, 1) of the inner cube, whose facet 8 lies in z = 1.
    let spike = |p: &mut Plc| p.facets[7].polygons[0].splice(2..3, [15, 16, 15]).for_each(drop);
    let segment = |p: &mut Plc| p.facets[7].polygons.push(vec![15, 16]);
    let free = |p: &mut Plc| p.facets.push(PlcFacet { polygons: vec![vec![15, 16]], ..PlcFacet::default() });
    let error = |code| (code, Severity::Error);
    let warning = |code| (code, Severity::Warning);
    // Ends in the large cube, on its side, and outside.
    assert_eq!(nested(&[[2.0, 2.0, 1.0]], spike), [error("spike")]);
    assert_eq!(nested(&[[6.0, 2.0, 1.0]], spike), [error("spike"), error("vertex-on-facet")]);
    assert_eq!(nested(&[[7.0, 2.0, 1.0]], spike), [error("spike"), error("penetration")]);
    assert_eq!(nested(&[[2.0, 2.0, 1.0]], segment), [warning("loose-segment")]);
    assert_eq!(nested(&[[6.0, 2.0, 1.0]], segment), [error("vertex-on-facet")]);
    assert_eq!(nested(&[[7.0, 2.0, 1.0]], segment), [error("penetration")]);
    assert_eq!(nested(&[[2.0, 2.0, 1.0]], free), [warning("bad-polygon")]);
    assert_eq!(nested(&[[7.0, 2.0, 1.0]], free), [warning("bad-polygon"), error("penetration")]);
    // Through the inner cube itself, and along one of its edges.
    assert_eq!(nested(&[[-1.0, -1.0, -1.0]], free)[1], error("t-junction"));
    assert_eq!(nested(&[[0.5, 1.0, 1.0]], free)[1], error("t-junction"));
    // By themselves in the outside TetGen crashes on them.
    let outside = |p: &mut Plc| p.facets.push(PlcFacet { polygons: vec![vec![16, 17]], ..PlcFacet::default() });
    let apart = [[8.0, 0.0, 0.0], [9.0, 0.0, 0.0]];
    assert_eq!(nested(&apart, outside), [warning("bad-polygon"), error("loose-segment")]);
    // However many others there are that do no harm.
    let many = |p: &mut Plc| {
        p.facets.extend((18..58).map(|v| PlcFacet { polygons: vec![vec![v, v + 40]], ..PlcFacet::default() }));
        outside(p);
    };
    let rows = [2.0, 3.0].map(|z| (0..40).map(move |k| [2.0 + 0.1 * f64::from(k), 2.0, z]));
    let places: Vec<[f64; 3]> = apart.into_iter().chain(rows.into_iter().flatten()).collect();
    assert!(nested(&places, many).contains(&error("loose-segment")));
    // Two that cross each other, and one along the diagonal of a facet.
    let two = |p: &mut Plc| {
        outside(p);
        p.facets.push(PlcFacet { polygons: vec![vec![18, 19]], ..PlcFacet::default() });
    };
    let crossing = [[2.0, 2.0, 2.0], [4.0, 4.0, 2.0], [2.0, 4.0, 2.0], [4.0, 2.0, 2.0]];
    assert_eq!(nested(&crossing, two)[2], error("edges-cross"));
    // A facet is divided along one of its diagonals.
    let diagonal = |a, b| nested(&[], |p| p.facets.push(PlcFacet { polygons: vec![vec![a, b]], ..PlcFacet::default() }))[1];
    let mut found = [diagonal(12, 15), diagonal(13, 14)];
    found.sort_unstable();
    assert_eq!(found, [error("edges-cross"), error("unlisted-edge")]);
}

#[test]
fn what_tetgen_takes_is_no_error() {
    let square = [[0.25, 0.25, 1.0], [0.75, 0.25, 1.0], [0.75, 0.75, 1.0], [0.25, 0.75, 1.0], [4.0, 4.0, 4.0]];
    let warning = |code| (code, Severity::Warning);
    let list = |polygons: &'static [&'static [u32]]| {
        move |p: &mut Plc| p.facets[7].polygons.extend(polygons.iter().map(|w| w.to_vec()))
    };
    let with = |polygons: &'static [&'static [u32]]| {
        nested(&square, |p| {
            p.vertices.pop();
            list(polygons)(p);
        })
    };
    assert_eq!(with(&[&[16, 17, 18, 19]]), []);
    assert_eq!(with(&[&[16, 17], &[18], &[19], &[16]]), []);
    assert_eq!(with(&[&[16, 17], &[17, 16], &[16, 18], &[19]]), []);
    assert_eq!(with(&[&[16, 17, 18], &[16, 18, 19]]), []);
    let hole = |at: [f64; 3]| {
        nested(&square[..4], |p| {
            list(&[&[16, 17], &[17, 18], &[18, 19], &[19, 16]])(p);
            p.facets[7].holes.push(at.into());
        })
    };
    assert_eq!(hole([0.5, 0.5, 1.0]), [("open-edge", Severity::Error)]);
    assert_eq!(hole([2.0, 0.5, 1.0]), [warning("idle-hole")]);
    assert_eq!(hole([0.5, 0.25, 1.0]), [("hole-on-edge", Severity::Error)]);
    let lone = |p: &mut Plc| p.facets.push(PlcFacet { polygons: vec![vec![16]], ..PlcFacet::default() });
    assert_eq!(nested(&square[4..], lone), [warning("bad-polygon")]);
    assert_eq!(nested(&[[4.0, 4.0, 1.0]], list(&[&[16]])), [warning("loose-vertex")]);
    assert_eq!(nested(&[[0.3, 0.4, 1.0]], lone), [warning("bad-polygon"), ("vertex-on-facet", Severity::Error)]);
    // A facet in two pieces, which have different volumes on their sides.
    let merge = |p: &mut Plc| {
        let polygon = p.facets[7].polygons.remove(0);
        p.facets[1].polygons.push(polygon);
        p.facets.remove(7);
        p.vertices.iter_mut().filter(|v| v.z == 6.0).for_each(|v| v.z = 1.0);
    };
    assert_eq!(nested(&[], merge), [warning("several-volumes")]);
    assert_eq!(nested(&[], |p| p.holes.push(Vec3::repeat(50.0))), [warning("seed-outside")]);
}

#[test]
fn a_manifest_that_says_something_else_is_found() {
    let sample = samples::two_cubes();
    let plc = plc_of(&sample);
    let complex = sample.complex();
    let manifest = Manifest::new(&sample.scene(), &complex, &crate::plc::measure::measure(&complex), &plc);
    let codes = |change: &dyn Fn(&mut Plc, &mut Manifest)| {
        let (mut plc, mut manifest) = (plc.clone(), manifest.clone());
        change(&mut plc, &mut manifest);
        let mut codes: Vec<_> = check(&plc, Some(&manifest)).iter().map(|d| d.code).collect();
        codes.dedup();
        codes
    };
    assert_eq!(codes(&|_, _| ()), [""; 0]);
    let swap = |p: &mut Plc| {
        let point = p.seeds[0].point;
        p.seeds[0].point = p.seeds[1].point;
        p.seeds[1].point = point;
    };
    assert_eq!(codes(&|p, _| swap(p))[0], "wrong-marker");
    let markers: Vec<i64> = plc.facets.iter().map(|f| f.marker).collect();
    let other = markers.iter().position(|&m| m != markers[0]).unwrap();
    assert_eq!(
        codes(&|p, _| p.facets[0].marker = markers[other]),
        ["wrong-marker", "wrong-area", "wrong-count", "wrong-area", "wrong-count"]
    );
    assert_eq!(codes(&|_, m| m.regions[0].volume *= 1.0 + 2e-9), ["wrong-volume"]);
    assert_eq!(codes(&|_, m| m.regions[0].volume = f64::NAN), ["wrong-volume"]);
    assert_eq!(codes(&|_, m| m.markers[0].area *= 1.0 + 2e-9), ["wrong-area"]);
    assert_eq!(codes(&|_, m| m.markers[0].facets += 1), ["wrong-count"]);
    assert_eq!(codes(&|_, m| m.counts.vertices += 1), ["wrong-count"]);
}

#[test]
fn a_wrong_region_on_a_side_is_found() {
    let sample = samples::two_cubes();
    let plc = plc_of(&sample);
    let mut complex = sample.complex();
    let measures = crate::plc::measure::measure(&complex);
    let manifest = Manifest::new(&sample.scene(), &complex, &measures, &plc);
    let facet = crate::ids::FacetId(2);
    complex.facets[facet].sides = [crate::ids::RegionId(0), crate::ids::RegionId(2)];
    let found = check_complex(&complex, &plc, &manifest);
    assert!(!found.is_empty() && found.iter().all(|d| d.code == "wrong-side"), "{found:?}");
}
