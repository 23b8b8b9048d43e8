//! Local operations on triangles, polygons with holes and several regions: each leaves a sound model, alone and in sequence.

use super::complex::ComplexVertex;
use super::local::{Refusal, Touched};
use super::model::Brep;
use super::samples::{block, over, plate, touching, voxels};
use super::store::EdgeId;
use super::tests::sound;
use crate::geom::Vec3;
use crate::ids::{FacetId, RegionId, VertexId};
use proptest::prelude::*;

fn middle(brep: &Brep, edge: EdgeId) -> ComplexVertex {
    let [a, b] = brep.topology.ends(edge).map(|v| brep.vertices[v]);
    ComplexVertex { point: (a.point + b.point) * 0.5, ..a }
}

fn edge_between(brep: &Brep, a: [f64; 3], b: [f64; 3]) -> EdgeId {
    let [a, b] = [a, b].map(|p| brep.topology.vertices().find(|&v| brep.point(v) == Vec3::from(p)).unwrap());
    brep.topology.edge_between(a, b).unwrap()
}

/// Volumes of all shells, by region.
fn volumes(brep: &Brep) -> Vec<f64> {
    let of = |region| brep.topology.shells_of(region).map(|shell| brep.shell_volume6(shell) / 6.0).sum();
    brep.topology.regions().map(of).collect()
}

fn near(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(x, y)| (x - y).abs() < 1e-9)
}

#[test]
fn split_divides_triangles_and_extends_polygons() {
    for divides in [true, false] {
        for sketch in [voxels(&[([0, 0, 0], 1), ([1, 0, 0], 2)], true), plate(), touching(true)] {
            let mut brep = sketch.brep();
            let before = volumes(&brep);
            for edge in brep.topology.edges().collect::<Vec<_>>() {
                let around = brep.topology.ring_len(edge);
                let [v, e, f] = brep.topology.counts();
                let triangles = brep.topology.facets_around(edge).filter(|&f| brep.topology.triangle(f).is_some()).count();
                let cut = if divides { triangles } else { 0 };
                let vertex = middle(&brep, edge);
                let touched = brep.split_edge(edge, vertex, |_, _| divides);
                assert_eq!(brep.topology.counts(), [v + 1, e + 1 + cut, f + cut]);
                assert_eq!(touched.facets.len(), around + cut);
                assert_eq!(brep.point(touched.vertex.unwrap()), vertex.point);
            }
            sound(&brep);
            assert!(near(&volumes(&brep), &before));
        }
    }
}

#[test]
fn collapse_undoes_a_split() {
    for divides in [true, false] {
        for sketch in [voxels(&[([0, 0, 0], 1), ([1, 0, 0], 2)], true), plate(), touching(true)] {
            let brep = sketch.brep();
            let (before, counts) = (volumes(&brep), brep.topology.counts());
            for edge in brep.topology.edges() {
                let mut brep = brep.clone();
                let touched = brep.split_edge(edge, middle(&brep, edge), |_, _| divides);
                let half = touched.edges[1];
                let plan = brep.plan_collapse(half, touched.vertex.unwrap()).unwrap();
                let undone: Touched = brep.collapse(&plan);
                assert_eq!(brep.topology.counts(), counts);
                assert_eq!(undone.removed_facets.len() + 1, undone.removed_edges.len());
                for &facet in &undone.facets {
                    brep.retriangulate(facet).unwrap();
                }
                sound(&brep);
                assert!(near(&volumes(&brep), &before));
            }
        }
    }
}

#[test]
fn swap_turns_the_diagonal_and_back() {
    let mut brep = voxels(&[([0, 0, 0], 1), ([1, 0, 0], 2)], true).brep();
    let before = volumes(&brep);
    let mut swapped = 0;
    for edge in brep.topology.edges().collect::<Vec<_>>() {
        let Ok(plan) = brep.plan_swap(edge) else { continue };
        let ends = brep.topology.ends(edge);
        brep.swap(&plan);
        sound(&brep);
        assert_eq!(brep.topology.edge_between(plan.opposite[0], plan.opposite[1]), Some(edge));
        assert!(near(&volumes(&brep), &before));
        swapped += 1;
        if swapped % 2 == 0 {
            let back = brep.plan_swap(edge).unwrap();
            brep.swap(&back);
            let again = brep.topology.ends(edge);
            assert!(again == ends || again == [ends[1], ends[0]]);
        }
    }
    // One diagonal per square; the edges between squares lie between different surfaces or regions.
    assert_eq!(swapped, 11);
}

#[test]
fn corners_and_curves_are_kept() {
    let brep = voxels(&over(block([0, 0, 0], [2, 1, 1], 1), block([2, 0, 0], [4, 1, 1], 2)), true).brep();
    let along = edge_between(&brep, [0., 0., 0.], [1., 0., 0.]);
    let [corner, inside] = [[0., 0., 0.], [1., 0., 0.]]
        .map(|p: [f64; 3]| brep.topology.vertices().find(|&v| brep.point(v) == Vec3::from(p)).unwrap());
    assert_eq!(brep.plan_collapse(along, corner).unwrap_err(), Refusal::Feature);
    assert!(brep.plan_collapse(along, inside).is_ok());
    // Across a square from one curve to another: leaves its curve.
    let across = brep.topology.edges_at(inside).find(|&e| !brep.is_feature(e)).unwrap();
    assert_eq!(brep.plan_collapse(across, inside).unwrap_err(), Refusal::Feature);
}

#[test]
fn a_tetrahedron_cannot_shrink() {
    let brep = touching(false).brep();
    for edge in brep.topology.edges() {
        for gone in brep.topology.ends(edge) {
            assert!(brep.plan_collapse(edge, gone).is_err());
        }
    }
}

#[test]
fn a_region_of_one_surface_keeps_its_shape() {
    // All facets one surface and marker: no features, only the link condition is left to save the last tetrahedron.
    let mut complex = voxels(&block([0, 0, 0], [2, 2, 2], 1), true).complex();
    let surface = complex.facets[FacetId(0)].surface;
    for facet in complex.facets.iter_mut() {
        facet.surface = surface;
        facet.marker = crate::ids::MarkerId(0);
    }
    let mut brep = Brep::from_complex(complex).unwrap();
    let mut collapsed = 0;
    loop {
        let plans = brep.topology.edges().flat_map(|e| brep.topology.ends(e).map(|v| (e, v)));
        let Some(plan) = plans.into_iter().find_map(|(e, v)| brep.plan_collapse(e, v).ok()) else { break };
        brep.collapse(&plan);
        collapsed += 1;
        sound(&brep);
    }
    assert_eq!(brep.topology.counts(), [4, 6, 4]);
    assert_eq!(collapsed, 22);
}

#[test]
fn polygons_divide_into_their_triangles() {
    for sketch in [plate(), touching(true), touching(false), voxels(&[([0, 0, 0], 1), ([1, 0, 0], 2)], false)] {
        let mut brep = sketch.brep();
        let before = volumes(&brep);
        let complex = brep.to_complex();
        let triangles: usize = complex.facets.iter().map(|f| f.triangles.len()).sum();
        for facet in brep.topology.facets().collect::<Vec<_>>() {
            brep.divide_facet(facet);
        }
        sound(&brep);
        assert_eq!(brep.topology.counts()[2], triangles);
        assert!(brep.topology.facets().all(|f| brep.topology.triangle(f).is_some()));
        assert!(near(&volumes(&brep), &before));
        let mut old: Vec<[VertexId; 3]> = complex.facets.iter().flat_map(|f| f.triangles.clone()).map(turned).collect();
        let mut new: Vec<[VertexId; 3]> =
            brep.topology.facets().filter_map(|f| brep.topology.triangle(f)).map(turned).collect();
        old.sort_unstable();
        new.sort_unstable();
        assert_eq!(old, new);
    }
}

#[test]
fn divided_polygons_merge_again() {
    let mut brep = voxels(&[([0, 0, 0], 1)], false).brep();
    let (counts, before) = (brep.topology.counts(), volumes(&brep));
    let facets: Vec<FacetId> = brep.topology.facets().collect();
    let cuts: Vec<EdgeId> = facets.into_iter().flat_map(|f| brep.divide_facet(f).edges).collect();
    assert!(brep.topology.counts()[2] > counts[2]);
    for edge in cuts {
        assert!(brep.merge_facets(edge).is_some());
    }
    sound(&brep);
    assert_eq!(brep.topology.counts(), counts);
    assert!(near(&volumes(&brep), &before));
    // Sides of a cube differ in surface.
    assert!(brep.topology.edges().collect::<Vec<_>>().into_iter().all(|e| brep.merge_facets(e).is_none()));
}

fn turned(t: [VertexId; 3]) -> [VertexId; 3] {
    let [a, b, c] = t;
    [[a, b, c], [b, c, a], [c, a, b]].into_iter().min().unwrap_or(t)
}

/// Whether a diagonal of a facet's triangles is an edge already.
fn has_edge_inside(brep: &Brep, facet: FacetId) -> bool {
    let sides = |[a, b, c]: [VertexId; 3]| [[a, b], [b, c], [c, a]];
    let own: Vec<Option<EdgeId>> = brep.topology.fins_of_facet(facet).map(|fin| brep.topology.edge_of(fin)).collect();
    let mut edges = brep.triangles(facet).flat_map(sides).filter_map(|[a, b]| brep.topology.edge_between(a, b));
    edges.any(|e| !own.contains(&Some(e)))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn random_sequences_stay_sound(steps in prop::collection::vec((0u8..6, any::<u32>()), 1..120), is_cut: bool) {
        let cells = over(block([0, 0, 0], [3, 2, 2], 1), over(block([1, 1, 0], [3, 2, 2], 2), vec![([0, 1, 1], 3), ([2, 0, 0], 0)]));
        let mut brep = voxels(&cells, is_cut).brep();
        let regions: Vec<RegionId> = brep.topology.regions().collect();
        for (what, n) in steps {
            let edges: Vec<EdgeId> = brep.topology.edges().collect();
            let edge = edges[n as usize % edges.len()];
            match what {
                0 => { brep.split_edge(edge, middle(&brep, edge), |_, f| f.0 % 2 == 0); }
                1..=3 => {
                    let gone = brep.topology.ends(edge)[what as usize % 2];
                    if let Ok(plan) = brep.plan_collapse(edge, gone) { brep.collapse(&plan); }
                }
                4 => if let Ok(plan) = brep.plan_swap(edge) { brep.swap(&plan); },
                _ => {
                    let facet = brep.topology.facets_around(edge).next().unwrap();
                    // Without a look at the geometry, facets come to lie on edges between their corners.
                    if brep.retriangulate(facet).is_ok() && !has_edge_inside(&brep, facet) { brep.divide_facet(facet); }
                }
            }
            let links = brep.topology.check_links();
            prop_assert!(links.is_empty(), "{:#?}", links);
            let count = brep.topology.count();
            prop_assert!(count.shells.iter().all(|s| s.fault.is_none()), "{:#?}", count);
            prop_assert_eq!(brep.topology.regions().collect::<Vec<_>>(), regions.clone());
            // No doubled edge.
            for v in brep.topology.vertices() {
                let mut around: Vec<VertexId> = brep.topology.neighbours(v).collect();
                let n = around.len();
                around.sort_unstable();
                around.dedup();
                prop_assert_eq!(n, around.len());
            }
        }
    }
}
