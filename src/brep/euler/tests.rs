//! Each operator against its inverse, by ids and by count; random sequences.

use super::super::samples::{block, over, plate, touching, voxels};
use super::super::store::{EdgeId, FinId, HalfEdgeId, Side, Topology};
use super::{Apart, Tally};
use crate::ids::{FacetId, RegionId, VertexId};
use proptest::prelude::*;

/// Counts, asserting that links are sound, every shell is a closed surface and the ledger has told the truth.
fn sound(topology: &Topology, before: Tally) -> Tally {
    let links = topology.check_links();
    assert!(links.is_empty(), "{links:#?}");
    let count = topology.count();
    assert!(count.shells.iter().all(|s| s.fault.is_none()), "{:#?}", count.shells);
    let mut expected = before;
    expected += topology.ledger();
    assert_eq!(count.tally, expected, "the ledger differs from the count");
    count.tally
}

/// Everything that has meaning: loops as vertices and edges, rings, sides; not list orders.
fn picture(topology: &Topology) -> impl PartialEq + std::fmt::Debug + use<> {
    let facets: Vec<_> = topology
        .facets()
        .map(|f| {
            let mut loops: Vec<Vec<_>> = topology
                .loops(f)
                .map(|w| {
                    let mut fins: Vec<_> =
                        topology.fins_of(w).map(|at| (topology.fin_ends(at), topology.edge_of(at))).collect();
                    let first = (0..fins.len()).min_by_key(|&k| fins[k]).unwrap();
                    fins.rotate_left(first);
                    fins
                })
                .collect();
            loops[1..].sort();
            (f, loops, topology.sides(f), topology.shells_beside(f).map(|s| topology.is_outer(s)))
        })
        .collect();
    let edges: Vec<_> = topology
        .edges()
        .map(|e| {
            let mut ring: Vec<_> = topology.fins_around(e).map(|f| (topology.facet_of(f), topology.is_along(f))).collect();
            let first = (0..ring.len()).min_by_key(|&k| (ring[k], ring[(k + 1) % ring.len()])).unwrap();
            ring.rotate_left(first);
            (e, topology.ends(e), ring)
        })
        .collect();
    (topology.vertices().collect::<Vec<_>>(), edges, facets, topology.regions().collect::<Vec<_>>())
}

/// Applies an operator and its inverse: both leave sound models, the second the first one.
fn there_and_back<T>(mut topology: Topology, act: impl Fn(&mut Topology) -> T, back: impl Fn(&mut Topology, T)) -> Tally {
    let before = topology.count().tally;
    let old = picture(&topology);
    let done = act(&mut topology);
    let after = sound(&topology, before);
    let mut added = after;
    added += -before;
    back(&mut topology, done);
    assert_eq!(sound(&topology, before), before);
    assert_eq!(picture(&topology), old);
    added
}

fn cubes(cells: &[([i32; 3], u32)]) -> Topology {
    voxels(cells, false).brep().topology
}

fn pair() -> Topology {
    cubes(&[([0, 0, 0], 1), ([1, 0, 0], 2)])
}

fn fin_at(topology: &Topology, facet: FacetId, vertex: VertexId) -> FinId {
    topology.fins_of_facet(facet).find(|&f| topology.fin_ends(f)[0] == vertex).unwrap()
}

#[test]
fn mvfr_kvfr() {
    let added = there_and_back(Topology::new(), |t| t.mvfr(RegionId(0)).1, |t, f| t.kvfr(f).unwrap());
    assert_eq!(added, Tally { v: 2, f: 2, r: 1, s: 1, ..Tally::default() });
    there_and_back(pair(), |t| t.mvfr(RegionId(2)).1, |t, f| t.kvfr(f).unwrap());
}

#[test]
fn mev_kev_spur() {
    let fins: Vec<FinId> = pair().fins().collect();
    for fin in fins {
        let start = pair().fin_ends(fin)[0];
        let added = there_and_back(pair(), |t| t.mev(fin).0, |t, e| t.kev(e, start).unwrap());
        assert_eq!(added, Tally { v: 2, e: 2, ..Tally::default() });
    }
    let lone = touching(false).brep().topology;
    let fin = lone.fins().find(|&f| lone.edge_of(f).is_none()).unwrap();
    let vertex = lone.fin_ends(fin)[0];
    there_and_back(lone, |t| t.mev(fin).0, |t, e| t.kev(e, vertex).unwrap());
}

#[test]
fn mev_kev_in_an_edge_of_two_three_and_four_fins() {
    for topology in [pair(), cubes(&[([0, 0, 0], 1), ([1, 1, 0], 2)])] {
        for edge in topology.edges().collect::<Vec<_>>() {
            let k = topology.ring_len(edge) as i64;
            let end = topology.ends(edge)[1];
            // Contracting the new half onto its far end leaves the old edge.
            let added = there_and_back(topology.clone(), |t| t.mev_in_edge(edge).0, |t, e| t.kev(e, end).unwrap());
            assert_eq!(added, Tally { v: k, e: k, ..Tally::default() });
        }
    }
}

#[test]
fn kev_then_mev_fan_restores() {
    for topology in [pair(), cubes(&[([0, 0, 0], 1), ([1, 1, 0], 2)]), plate().brep().topology] {
        let before = topology.count().tally;
        for edge in topology.edges().collect::<Vec<_>>() {
            for kept in topology.ends(edge) {
                let mut t = topology.clone();
                let gone = t.other_end(edge, kept);
                let moved: Vec<EdgeId> = t.edges_at(gone).filter(|&e| e != edge).collect();
                // Contracting the one edge that the two cubes share would part the air around it.
                let done = t.kev(edge, kept);
                assert_eq!(done.is_err(), t.ring_len(edge) == 4);
                if done.is_err() {
                    continue;
                }
                sound(&t, before);
                let (again, new) = t.mev_fan(kept, &moved).unwrap();
                assert_eq!([again, EdgeId(edge.0)], [edge; 2]);
                assert_eq!(new, gone);
                assert_eq!(sound(&t, before), before);
                for f in topology.facets() {
                    assert_eq!(t.sides(f), topology.sides(f));
                    let vertices = |t: &Topology| {
                        let mut all: Vec<_> = t.fins_of_facet(f).map(|at| t.fin_ends(at)).collect();
                        all.sort_unstable();
                        all
                    };
                    assert_eq!(vertices(&t), vertices(&topology));
                }
            }
        }
    }
}

#[test]
fn mef_kef() {
    let t = pair();
    for facet in t.facets().collect::<Vec<_>>() {
        let fins: Vec<FinId> = t.fins_of_facet(facet).collect();
        let added = there_and_back(
            t.clone(),
            |t| t.mef(fins[0], fins[2]).unwrap().1,
            |t, new| {
                let gone = t
                    .fins_of_facet(new)
                    .find(|&f| t.ring_len(t.edge_of(f).unwrap()) == 2 && t.fin_ends(f)[1] == t.fin_ends(fins[0])[0]);
                t.kef(gone.unwrap()).unwrap();
            },
        );
        assert_eq!(added, Tally { e: 2, f: 2, ..Tally::default() });
    }
}

#[test]
fn mef_in_edge_kef_digon() {
    for topology in [pair(), cubes(&[([0, 0, 0], 1), ([1, 1, 0], 2)])] {
        for edge in topology.edges().collect::<Vec<_>>() {
            let ring: Vec<FinId> = topology.fins_around(edge).collect();
            for first in 0..ring.len() {
                for n in 1..ring.len() {
                    let last = ring[(first + n - 1) % ring.len()];
                    let added = there_and_back(
                        topology.clone(),
                        |t| t.mef_in_edge(ring[first], last).unwrap().1,
                        |t, facet| {
                            let kept = t.fins_of_facet(facet).find(|&f| t.edge_of(f) == Some(edge)).unwrap();
                            t.kef_digon(kept).unwrap();
                        },
                    );
                    assert_eq!(added, Tally { e: 2, f: 2, ..Tally::default() });
                }
            }
        }
    }
}

#[test]
fn mekl_keml() {
    let t = plate().brep().topology;
    let facet = t.facets().find(|&f| t.loops(f).count() == 2).unwrap();
    let walks: Vec<_> = t.loops(facet).collect();
    let corner = |k: usize| t.fins_of(walks[k]).next().unwrap();
    let (from, to) = (corner(0), corner(1));
    let added = there_and_back(
        t.clone(),
        |t| t.mekl(from, to).unwrap(),
        |t, edge| {
            let out = t.fins_around(edge).find(|&f| t.is_along(f)).unwrap();
            t.keml(out).unwrap();
        },
    );
    assert_eq!(added, Tally { e: 2, l: -2, ..Tally::default() });
    // Onto a lone vertex.
    let t = touching(false).brep().topology;
    let lone = t.fins().find(|&f| t.edge_of(f).is_none()).unwrap();
    let from = t.fins_of(t.loops(t.facet_of(lone)).next().unwrap()).next().unwrap();
    there_and_back(
        t,
        |t| t.mekl(from, lone).unwrap(),
        |t, edge| {
            let out = t.fins_around(edge).find(|&f| t.is_along(f)).unwrap();
            t.keml(out).unwrap();
        },
    );
}

/// Two blocks, the second without its lower facet standing on the first: MFKLH of the hole.
#[test]
fn kfmlh_mfklh_joins_and_parts_shells() {
    // Region 1 is both cubes: two components of one region, told apart by one of them being an inner shell.
    let mut t = cubes(&[([0, 0, 0], 1), ([3, 0, 0], 2)]);
    let before = t.count().tally;
    t.mskr(RegionId(2), RegionId(1)).unwrap();
    sound(&t, before);
    let outward: Vec<FacetId> = t.facets().filter(|&f| t.sides(f) == [RegionId(0), RegionId(1)]).collect();
    let heir = outward[0];
    let is_near = |t: &Topology, f: FacetId| t.shells_beside(f) == t.shells_beside(heir);
    let facet = *outward.iter().find(|&&f| !is_near(&t, f)).unwrap();
    let mut back = t.clone();
    let walk = back.kfmlh(facet, heir).unwrap();
    let joined = sound(&back, before);
    assert_eq!(joined.h, 0);
    assert_eq!(back.shells().count(), 2);
    let again = back.mfklh(walk).unwrap();
    assert_eq!(again, facet);
    assert_eq!(sound(&back, before), t.count().tally);
    assert_eq!(back.shells().count(), 4);
    // Two facets of one cube: a handle on both sides.
    let opposite = *outward.iter().find(|&&f| is_near(&t, f) && f != heir).unwrap();
    let walk = t.kfmlh(opposite, heir).unwrap();
    assert_eq!(sound(&t, before).h, 2);
    t.mfklh(walk).unwrap();
    assert_eq!(sound(&t, before).h, 0);
}

#[test]
fn mskr_ksmr_makes_a_cavity_part_of_its_surroundings() {
    let t = cubes(&over(block([0, 0, 0], [3, 3, 3], 1), block([1, 1, 1], [2, 2, 2], 2)));
    let shell = t.shells_of(RegionId(2)).next().unwrap();
    let added =
        there_and_back(t, |t| t.mskr(RegionId(2), RegionId(1)).unwrap(), |t, ()| assert_eq!(t.ksmr(shell), Ok(RegionId(2))));
    assert_eq!(added, Tally { r: -1, s: 1, ..Tally::default() });
}

#[test]
fn kffr_mffr_removes_and_sets_a_wall() {
    let t = pair();
    let before = t.count().tally;
    for facet in t.facets().collect::<Vec<_>>() {
        for dying in Side::BOTH {
            let mut t = t.clone();
            let fins: Vec<FinId> = t.fins_of_facet(facet).collect();
            let region = t.sides(facet)[dying as usize];
            // What the facet's front faces, to put it back.
            let faced: Vec<HalfEdgeId> = fins.iter().rev().map(|f| t.mate(f.on(Side::Front))).collect();
            if region == RegionId(0) {
                assert!(t.kffr(facet, dying).is_err());
                continue;
            }
            t.kffr(facet, dying).unwrap();
            assert_eq!(sound(&t, before).r, 1);
            let (again, apart) = t.mffr(&faced).unwrap();
            assert_eq!(again, facet);
            assert_eq!(apart, Apart::Region(region));
            let after = sound(&t, before);
            // The front's region is the new one, whichever side died; counts agree if that was a bounded one.
            assert_eq!([after.v, after.e, after.f, after.h], [before.v, before.e, before.f, before.h]);
        }
    }
}

#[test]
fn mffr_across_a_ring_takes_a_handle() {
    let mut t = cubes(&over(block([0, 0, 0], [3, 3, 1], 1), vec![([1, 1, 0], 0)]));
    let before = t.count().tally;
    // The section x = 1 of the arm y in 0..1: a square of half-edges inside the ring.
    let brep = voxels(&over(block([0, 0, 0], [3, 3, 1], 1), vec![([1, 1, 0], 0)]), false).brep();
    let at = |p: [f64; 3]| brep.topology.vertices().find(|&v| brep.point(v) == crate::geom::Vec3::from(p)).unwrap();
    let square = [[1., 0., 0.], [1., 1., 0.], [1., 1., 1.], [1., 0., 1.]].map(at);
    let inside = |a: VertexId, b: VertexId| {
        let edge = t.edge_between(a, b).unwrap();
        let halves = t.fins_around(edge).flat_map(|f| Side::BOTH.map(|s| f.on(s)));
        halves.into_iter().find(|&h| t.start(h) == a && t.region(t.shell(t.face_use(h))) == RegionId(1)).unwrap()
    };
    let walk: Vec<HalfEdgeId> = (0..4).map(|k| inside(square[k], square[(k + 1) % 4])).collect();
    let (facet, apart) = t.mffr(&walk).unwrap();
    assert_eq!(apart, Apart::Handle);
    assert_eq!(sound(&t, before).h, before.h - 1);
    t.kffr(facet, Side::Front).unwrap();
    assert_eq!(sound(&t, before), before);
}

#[test]
fn cube_from_nothing() {
    let mut t = Topology::new();
    let (a, bottom, _) = t.mvfr(RegionId(0));
    // A square by three spurs and an edge, a pillar at each corner, roofs between the pillars: 7 MEV, 5 MEF.
    let mut ring = vec![a];
    for _ in 0..3 {
        let fin = fin_at(&t, bottom, ring[ring.len() - 1]);
        ring.push(t.mev(fin).1);
    }
    let (from, to) = (fin_at(&t, bottom, ring[0]), fin_at(&t, bottom, ring[3]));
    let top = t.mef(from, to).unwrap().1;
    let high: Vec<VertexId> = ring.iter().map(|&v| t.mev(fin_at(&t, top, v)).1).collect();
    for k in 0..4 {
        let (from, to) = (fin_at(&t, top, high[k]), fin_at(&t, top, high[(k + 1) % 4]));
        t.mef(from, to).or_else(|_| t.mef(to, from)).unwrap();
    }
    assert_eq!(t.counts(), [8, 12, 6]);
    assert_eq!(sound(&t, Tally::default()), Tally { v: 16, e: 24, f: 12, l: 0, r: 1, s: 1, h: 0 });
}

#[test]
fn what_is_illegal_changes_nothing() {
    let t = pair();
    let old = picture(&t);
    let mut t = t;
    let fins: Vec<FinId> = t.fins().collect();
    let shared = t.edges().find(|&e| t.ring_len(e) == 3).unwrap();
    let fin = t.fins_around(shared).next().unwrap();
    assert!(t.kef(fin).is_err() && t.keml(fin).is_err() && t.kef_digon(fin).is_err());
    assert!(t.mef(fins[0], fins[0]).is_err() && t.mekl(fins[0], fins[1]).is_err());
    assert!(t.mskr(RegionId(0), RegionId(1)).is_err() && t.kvfr(FacetId(0)).is_err());
    let loose = [fins[0].on(Side::Front), fins[2].on(Side::Front)];
    assert!(t.mffr(&loose).is_err());
    assert_eq!(picture(&t), old);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn random_sequences_keep_the_count(steps in prop::collection::vec((0u8..9, any::<u32>(), any::<u32>()), 1..60)) {
        let mut t = cubes(&[([0, 0, 0], 1), ([1, 1, 0], 2), ([0, 1, 1], 3), ([1, 0, 0], 3)]);
        let before = t.count().tally;
        for (what, x, y) in steps {
            let fins: Vec<FinId> = t.fins().collect();
            let pick = |n: u32| fins[n as usize % fins.len()];
            let (f, g) = (pick(x), pick(y));
            let edge = t.edge_of(f);
            match (what, edge) {
                (0, _) => { t.mev(f); }
                (1, Some(e)) => { t.mev_in_edge(e); }
                (2, Some(e)) => { let _ = t.kev(e, t.ends(e)[y as usize % 2]); }
                (3, _) => {
                    let around: Vec<FinId> = t.fins_from(f).collect();
                    let _ = t.mef(f, around[y as usize % around.len()]);
                }
                (4, Some(_)) => { let _ = t.kef(f); }
                (5, Some(_)) => { let _ = t.keml(f); }
                (6, _) => { let _ = t.mekl(f, g); }
                (7, Some(_)) => { let _ = t.kef_digon(f); }
                (8, _) => {
                    let walk = t.loops(t.facet_of(f)).nth(1);
                    if let Some(walk) = walk { let _ = t.mfklh(walk); } else { let _ = t.kfmlh(t.facet_of(f), t.facet_of(g)); }
                }
                _ => {}
            }
            sound(&t, before);
        }
    }
}
