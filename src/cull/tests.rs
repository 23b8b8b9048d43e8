//! Piles of solids.

use super::*;
use crate::evaluate::evaluate;
use crate::geom::Vec3;
use crate::geom::polygon::vector_area;
use crate::plc::measure::measure;
use crate::report::timing::Timings;
use crate::scene::{self, Limits};

/// Squares about one axis: their corners are equally spaced.
const SQUARES: usize = 36;

fn pile() -> (Scene, Vec<Solid>) {
    let turned = |k: usize| {
        let angle = 90.0 * k as f64 / SQUARES as f64;
        format!("Rotate(axis: Z, angle: {angle:?}, solid: Block(size: (2, 2, 1), center: (0, 0, 0)))")
    };
    let cubes: Vec<String> = (0..SQUARES).map(turned).collect();
    let text = format!("Scene(units: \"mm\", remesh: Off, parts: [Part(name: \"it\", solid: Union([{}]))])", cubes.join(", "));
    let (scene, _) = scene::parse("pile", std::path::Path::new("."), &text, &[], &Limits::default()).unwrap();
    let solids = crate::primitive::build(&scene).unwrap();
    (scene, solids)
}

#[test]
fn cut_solids_are_closed_and_most_pieces_are_set_aside() {
    let (scene, solids) = pile();
    let culled = cull(&scene, &solids, 1e-9).unwrap();
    for (solid, pieces) in culled.solids.iter().zip(&culled.pieces) {
        assert_eq!(solid.facets.len(), pieces.len());
        let mut edges: Vec<[u32; 2]> = Vec::new();
        for walk in solid.facets.iter().flat_map(|f| f.loops.iter()) {
            edges.extend((0..walk.len()).map(|k| [walk[k], walk[(k + 1) % walk.len()]]));
        }
        edges.sort_unstable();
        assert!(edges.windows(2).all(|w| w[0] != w[1]));
        assert!(edges.iter().all(|&[a, b]| edges.binary_search(&[b, a]).is_ok()));
    }
    let all: Vec<Fate> = culled.pieces.iter().flatten().map(|p| p.fate).collect();
    let area_of = |is_counted: fn(Fate) -> bool| -> f64 {
        let of_solid = |(solid, pieces): (&Solid, &Vec<Piece>)| {
            let points: Vec<Vec3> = solid.vertices.iter().map(|v| v.point).collect();
            let facets = solid.facets.iter().zip(pieces).filter(|f| is_counted(f.1.fate));
            facets.map(|(f, _)| vector_area(f.loops.iter(), &points).norm()).sum::<f64>()
        };
        culled.solids.iter().zip(&culled.pieces).map(of_solid).sum()
    };
    let (aside, whole) = (area_of(Fate::is_aside), area_of(|_| true));
    assert!((whole - SQUARES as f64 * 16.0).abs() < 1e-9 && aside > 0.8 * whole, "{aside} of {whole}");
    // What is set aside is merged.
    assert!(all.iter().filter(|f| f.is_aside()).count() < 3 * 6 * SQUARES);
    assert!(all.contains(&Fate::Face([None, Some(PartId(0))])));
}

#[test]
fn turned_squares_make_the_star() {
    let (scene, solids) = pile();
    let complex = evaluate(&scene, &solids, &mut Timings::default()).unwrap().complex;
    // The outline is a side of a square from every corner halfway to the next.
    let half = std::f64::consts::FRAC_PI_4 / SQUARES as f64;
    let area = 4.0 * SQUARES as f64 * (1.0 - libm::tan(std::f64::consts::FRAC_PI_4 - half));
    assert!((measure(&complex).volumes[crate::ids::RegionId(1)] - area).abs() < 1e-9);
    assert_eq!(complex.regions.len(), 2);
}

#[test]
fn a_few_solids_are_left_alone() {
    let (scene, solids) = pile();
    assert!(cull(&scene, &solids[..DEEP - 1], 1e-9).is_none());
}
