//! Whole models: counts that can be checked by hand, round trips, defects that must be found.

use super::euler::Tally;
use super::model::Brep;
use super::samples::{block, over, plate, touching, voxels};
use super::store::{FinId, Side};
use crate::ids::{FacetId, RegionId};

/// Checks the model and gives its count.
pub fn sound(brep: &Brep) -> Tally {
    let findings = brep.check();
    assert!(findings.is_empty(), "{findings:#?}");
    let tally = brep.topology.count().tally;
    assert!(tally.is_balanced(), "{tally:?}");
    tally
}

fn cubes(cells: &[([i32; 3], u32)]) -> Brep {
    voxels(cells, false).brep()
}

const A: ([i32; 3], u32) = ([0, 0, 0], 1);

#[test]
fn cube_has_two_uses_of_everything() {
    let tally = sound(&cubes(&[A]));
    assert_eq!(tally, Tally { v: 16, e: 24, f: 12, l: 0, r: 1, s: 1, h: 0 });
}

#[test]
fn cubes_that_share_a_facet() {
    let brep = cubes(&[A, ([1, 0, 0], 2)]);
    assert_eq!(brep.topology.counts(), [12, 20, 11]);
    // In each cube 8, 12, 6; in the air around both 12, 20, 10.
    assert_eq!(sound(&brep), Tally { v: 28, e: 44, f: 22, l: 0, r: 2, s: 1, h: 0 });
    let shared = brep.topology.facets().find(|&f| brep.topology.sides(f) == [RegionId(2), RegionId(1)]);
    assert!(shared.is_some());
    let triple = brep.topology.edges().filter(|&e| brep.topology.ring_len(e) == 3).count();
    assert_eq!(triple, 4);
}

#[test]
fn cubes_that_share_an_edge() {
    let brep = cubes(&[A, ([1, 1, 0], 2)]);
    assert_eq!(brep.topology.counts(), [14, 23, 12]);
    // The air passes between them on both sides of the edge: two edge uses in one shell, 14 vertex uses.
    assert_eq!(sound(&brep), Tally { v: 8 + 8 + 14, e: 48, f: 24, l: 0, r: 2, s: 1, h: 0 });
    let edge = brep.topology.edges().find(|&e| brep.topology.ring_len(e) == 4).unwrap();
    let around: Vec<u32> = brep
        .topology
        .fins_around(edge)
        .map(|fin| brep.topology.face_use(brep.topology.facing(fin, true)))
        .map(|at| brep.topology.region(brep.topology.shell(at)).0)
        .collect();
    assert!(around == [0, 1, 0, 2] || around == [1, 0, 2, 0] || around == [0, 2, 0, 1] || around == [2, 0, 1, 0]);
}

#[test]
fn cubes_that_share_a_vertex() {
    let brep = cubes(&[A, ([1, 1, 1], 2)]);
    assert_eq!(brep.topology.counts()[0], 15);
    assert_eq!(sound(&brep), Tally { v: 32, e: 48, f: 24, l: 0, r: 2, s: 2, h: 0 });
    let uses: Vec<usize> = brep.topology.vertices().map(|v| brep.topology.vertex_uses(v)).collect();
    assert_eq!(uses.iter().filter(|&&n| n == 4).count(), 1);
}

#[test]
fn holes_are_handles_on_both_sides() {
    let ring = over(block([0, 0, 0], [3, 3, 1], 1), vec![([1, 1, 0], 0)]);
    assert_eq!(sound(&cubes(&ring)).h, 2);
    let two = over(block([0, 0, 0], [5, 3, 1], 1), vec![([1, 1, 0], 0), ([3, 1, 0], 0)]);
    assert_eq!(sound(&cubes(&two)).h, 4);
    // As polygons with holes: per side 16 vertices, 24 edges, 10 facets with 2 inner loops.
    let brep = plate().brep();
    assert_eq!(sound(&brep), Tally { v: 32, e: 48, f: 20, l: 4, r: 1, s: 1, h: 2 });
    // A link of two rings within an air box: one handle per ring and side.
    let grid: Vec<_> = block([0, 0, 0], [5, 5, 5], 1)
        .into_iter()
        .map(|(c, r)| (c, if c.iter().filter(|&&x| x % 2 == 0).count() >= 2 { 2 } else { r }))
        .collect();
    // The frame of 3 x 3 x 3 posts: 27 nodes, 54 bars, 28 independent cycles.
    let tally = sound(&cubes(&grid));
    assert!(tally.h >= 28, "{tally:?}");
}

#[test]
fn box_in_box_and_void() {
    let inner = block([1, 1, 1], [2, 2, 2], 2);
    let nested = cubes(&over(block([0, 0, 0], [3, 3, 3], 1), inner));
    let tally = sound(&nested);
    assert_eq!([tally.r, tally.s, tally.h], [2, 2, 0]);
    let inner = nested.topology.shells_of(RegionId(1)).filter(|&s| !nested.topology.is_outer(s)).count();
    assert_eq!(inner, 1);
    // Two separate boxes in one, touching along an edge: one inner shell.
    let pair = vec![([1, 1, 1], 2), ([2, 2, 1], 3)];
    let tally = sound(&cubes(&over(block([0, 0, 0], [4, 4, 3], 1), pair)));
    assert_eq!([tally.r, tally.s], [3, 2]);
}

#[test]
fn lone_vertex_and_lone_edge_in_a_facet() {
    let brep = touching(false).brep();
    // Block 8, 12, 6 and tetrahedron 4, 6, 4 on both sides; the lone vertex has a use and a loop on both sides of the top.
    assert_eq!(sound(&brep), Tally { v: 16 + 8 + 2, e: 24 + 12, f: 20, l: 2, r: 2, s: 2, h: 0 });
    let brep = touching(true).brep();
    // The edge has four fins: the top's two and the wedge's two. In the block (8 + 2 vertices, 12 + 1 edges, 6 facets, a loop),
    // in the wedge (4, 6, 4), in the air, where wedge and top are one shell (8 + 4, 12 + 6 + 1, 10, a loop).
    assert_eq!(sound(&brep), Tally { v: 10 + 4 + 12, e: 13 + 6 + 19, f: 20, l: 2, r: 2, s: 1, h: 0 });
    assert_eq!(brep.topology.edges().map(|e| brep.topology.ring_len(e)).max(), Some(4));
}

#[test]
fn round_trip_is_identity() {
    for sketch in [
        voxels(&over(block([0, 0, 0], [3, 3, 3], 1), vec![([1, 1, 1], 2), ([2, 2, 2], 3)]), false),
        plate(),
        touching(true),
        touching(false),
    ] {
        let complex = sketch.complex();
        let again = Brep::from_complex(complex.clone()).unwrap().to_complex();
        assert_eq!(complex.facets, again.facets);
        assert_eq!(complex.vertices, again.vertices);
        assert_eq!(complex.regions, again.regions);
    }
}

#[test]
fn wrong_sides_and_ids_are_refused() {
    let mut complex = voxels(&[A, ([1, 0, 0], 2)], false).complex();
    complex.facets[FacetId(3)].sides.reverse();
    let codes = |complex| Brep::from_complex(complex).unwrap_err().iter().map(|d| d.code).collect::<Vec<_>>();
    assert!(codes(complex).contains(&"brep-sides"));
    let mut complex = voxels(&[A], false).complex();
    complex.facets[FacetId(0)].loops[0][1] = crate::ids::VertexId(99);
    assert_eq!(codes(complex), ["brep-input"]);
    let mut complex = voxels(&[A], true).complex();
    let twice = complex.facets[FacetId(0)].clone();
    complex.facets.push(twice);
    assert!(codes(complex).contains(&"brep-radial"));
}

#[test]
fn damaged_links_are_found() {
    let good = cubes(&[A, ([1, 1, 0], 2)]);
    let code = |brep: &Brep| brep.check().first().map(|d| d.code);
    assert_eq!(code(&good), None);
    let mut brep = good.clone();
    brep.topology.fins[FinId(0)].next = FinId(2);
    assert_eq!(code(&brep), Some("brep-loop"));
    let mut brep = good.clone();
    brep.topology.fins[FinId(0)].edge = brep.topology.fins[FinId(1)].edge;
    assert_eq!(code(&brep), Some("brep-ring"));
    let mut brep = good.clone();
    brep.topology.facets[FacetId(0)].uses.swap(0, 1);
    assert_eq!(code(&brep), Some("brep-shell"));
    // A wrong radial order: the sectors no longer fit the shells.
    let mut brep = good.clone();
    let edge = brep.topology.edges().find(|&e| brep.topology.ring_len(e) == 4).unwrap();
    let f: Vec<FinId> = brep.topology.fins_around(edge).collect();
    brep.topology.set_ring(edge, &[f[0], f[2], f[1], f[3]]);
    assert_eq!(code(&brep), Some("brep-mates"));
    // Two shells under one name.
    let mut brep = cubes(&[A, ([1, 1, 1], 2)]);
    let air: Vec<_> = brep.topology.shells_of(RegionId(0)).collect();
    brep.topology.merge_shell(air[0], air[1]);
    assert_eq!(code(&brep), Some("brep-euler"));
}

#[test]
fn rotation_about_a_vertex_stays_in_the_shell() {
    let brep = cubes(&[A, ([1, 1, 0], 2), ([0, 1, 1], 3)]);
    let topology = &brep.topology;
    for fin in topology.fins() {
        for half in Side::BOTH.map(|side| fin.on(side)) {
            let home = topology.shell(topology.face_use(half));
            for at in topology.vertex_use(half) {
                assert_eq!(topology.start(at), topology.start(half));
                assert_eq!(topology.shell(topology.face_use(at)), home);
            }
        }
    }
}
