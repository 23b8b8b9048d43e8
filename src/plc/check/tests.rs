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
