//! The repair by itself: complexes whose vertices are shaken so that facets cross.

use super::*;
use crate::evaluate::evaluate;
use crate::plc::measure::measure;
use crate::report::timing::Timings;
use crate::scene::{self, Limits};

/// How far things hover over the plate.
const GAP: f64 = 1e-5;
/// A room, a plate, and a part that stands on the plate with one foot and hovers over it with a facet, an edge and a corner.
const PARTS: [&str; 3] = [
    "Block(size: (12, 12, 12), center: (0, 0, 0))",
    "Block(min: (-4, -4, -1), max: (4, 4, 0))",
    "Union([Block(min: (-3, -3, 0), max: (-2, 3, 1)), Cylinder(radius: 1, height: 1, base: (2, 2, 1e-5)), \
     Translate(by: (0, -2, 0.70711678), solid: Rotate(axis: X, angle: 45, solid: Block(size: (1, 1, 1), center: (0, 0, 0)))), \
     Sphere(radius: 0.75, center: (2.5, -2, 0.75001), discretization: (segments: 12))])",
];

fn complex() -> Complex {
    let parts: Vec<String> = PARTS.iter().enumerate().map(|(k, s)| format!("Part(name: \"p{k}\", solid: {s})")).collect();
    complex_of(&parts.join(", "))
}

fn complex_of(parts: &str) -> Complex {
    let text = format!("Scene(units: \"mm\", remesh: Off, parts: [{parts}])");
    let (scene, _) = scene::parse("shaken", std::path::Path::new("."), &text, &[], &Limits::default()).unwrap();
    let solids = crate::primitive::build(&scene).unwrap();
    evaluate(&scene, &solids, &mut Timings::default()).unwrap().complex
}

#[test]
fn cavities_of_a_ball_of_many_facets_are_voids_of_its_region() {
    // Rays from the second cavity on search the ball's facets by a tree.
    let cubes = "Block(size: (1, 1, 1), center: (-3, 0, 0)), Block(size: (1, 1, 1), center: (0, 0, 0)), \
                 Block(size: (1, 1, 1), center: (3, 0, 0))";
    let complex = complex_of(&format!("Part(name: \"ball\", solid: Difference([Sphere(radius: 10), {cubes}]))"));
    let whole = complex_of("Part(name: \"ball\", solid: Sphere(radius: 10))");
    assert_eq!(complex.regions.iter().map(|r| r.part.is_some()).collect::<Vec<_>>(), [false, true, false, false, false]);
    let (volumes, solid) = (measure(&complex).volumes, measure(&whole).volumes);
    let found: Vec<f64> = volumes.iter().copied().skip(1).collect();
    let expected = [solid.iter().nth(1).unwrap() - 3.0, 1.0, 1.0, 1.0];
    assert!(found.iter().zip(expected).all(|(v, e)| (v - e).abs() < 1e-9), "{found:?}");
}

/// The facets over other places.
fn moved(complex: &Complex, place: impl FnMut(&ComplexVertex) -> Vec3) -> Draft {
    let loops = |f: &ComplexFacet| f.loops.iter().map(|l| l.iter().map(|v| v.0).collect()).collect();
    Draft {
        facets: complex.facets.iter().map(|f| Lineage { corners: 0, ..Lineage::of(f) }).collect(),
        loops: complex.facets.iter().map(loops).collect(),
        places: complex.vertices.iter().map(place).collect(),
        explicit: 0,
    }
}

/// Repairs what moving by at most `step` broke; yields how often facets met.
fn repaired(mut complex: Complex, draft: Draft, step: f64) -> usize {
    let before = measure(&complex).volumes;
    let area: f64 = complex.facets.iter().flat_map(|f| &f.triangles).map(|t| area_of(&complex, t)).sum();
    fill(&mut complex, draft, 2.0 * step).unwrap();
    let mut parts = complex.regions.iter().map(|r| r.part).collect();
    let (repairs, checked) = settle(&mut complex, &mut parts, 2.0 * step).unwrap();
    let why = || repair::cut_again(&complex, checked.as_ref().err().map_or(&[], |f| f), 2.0 * step).err();
    assert!(checked.is_ok(), "step {step:e}, {repairs:?}: {:?}; {checked:?}", why());
    for (old, new) in before.iter().zip(measure(&complex).volumes.iter()) {
        assert!((old - new).abs() <= 4.0 * area * step, "step {step:e}: {old} became {new}");
    }
    repairs.contacts
}

fn area_of(complex: &Complex, t: &[VertexId; 3]) -> f64 {
    let [a, b, c] = t.map(|v| complex.vertices[v].point);
    0.5 * (b - a).cross(&(c - a)).norm()
}

#[test]
fn a_coarser_grid_breaks_facets_and_repair_keeps_the_volumes() {
    for grid in [2.0 * GAP, 16.0 * GAP] {
        let complex = complex();
        let draft = moved(&complex, |v| v.point.map(|x| (x / grid).round() * grid));
        assert!(repaired(complex, draft, grid) > 0, "grid {grid:e}: nothing was to be repaired");
    }
}

#[test]
fn shaken_vertices_are_repaired() {
    let mut state = 7u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / f64::from(1u32 << 30) - 1.0
    };
    for step in [GAP, 2.0 * GAP, 8.0 * GAP] {
        let complex = complex();
        let draft = moved(&complex, |v| v.point.map(|x| x + step * random()));
        assert!(repaired(complex, draft, 2.0 * step) > 0, "step {step:e}: nothing was to be repaired");
    }
}
