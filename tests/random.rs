//! Random scenes: boxes on a grid against counted voxels, trees of all primitives against set identities, assemblies against the
//! box that encloses them. GSM_RANDOM is the number of each kind, GSM_RANDOM_SEED the first; a failure prints its scene.

#[path = "random/generator.rs"]
mod generator;

use generator::{Generator, Voxels};
use gsm::brep::complex::Complex;
use gsm::brep::model::Brep;
use gsm::diag::Diagnostic;
use gsm::evaluate::evaluate;
use gsm::geom::Vec3;
use gsm::ids::Id;
use gsm::io::manifest::Manifest;
use gsm::plc::{self, check, measure};
use gsm::primitive::solid::Solid;
use gsm::report::timing::Timings;
use gsm::scene::model::Scene;
use gsm::scene::{self, Limits};
use rayon::prelude::*;
use std::path::Path;

/// Scenes of each kind unless GSM_RANDOM says otherwise.
const COUNT: u64 = 60;
/// What welding may change a volume by, relative to the volumes at hand: area times tolerance, with room for flat solids.
const VOLUME_ERROR: f64 = 1e-7;

/// What a scene became.
struct Built {
    /// Volume of each part; 0 if nothing is left of it.
    volumes: Vec<f64>,
    regions: usize,
    repairs: u32,
}

/// Builds a scene and checks all that holds for every scene.
fn build(parts: &[(String, String)]) -> Result<Built, String> {
    let list: Vec<String> = parts.iter().map(|(name, solid)| format!("Part(name: \"{name}\", solid: {solid})")).collect();
    let text = format!("Scene(units: \"mm\", remesh: Off, parts: [\n{}\n])", list.join(",\n"));
    let fail = |what: &str, found: &[Diagnostic]| {
        let said: Vec<String> = found.iter().take(3).map(|d| format!("{}: {} at {:?}", d.code, d.message, d.points)).collect();
        format!("{what}: {}\n{text}", said.join("; "))
    };
    let (scene, _) = scene::parse("random", Path::new("."), &text, &[], &Limits::default()).map_err(|e| fail("scene", &e))?;
    let solids = gsm::primitive::build(&scene).map_err(|e| fail("primitive", &e))?;
    let evaluation = match evaluate(&scene, &solids, &mut Timings::default()) {
        Ok(evaluation) => evaluation,
        Err(e) if parts.len() == 1 && e.iter().all(|d| d.code == "empty-part") => {
            return Ok(Built { volumes: vec![0.0], regions: 0, repairs: 0 });
        }
        Err(e) => return Err(fail("evaluate", &e)),
    };
    let complex = evaluation.complex;
    let plc = plc::build::build(&complex, &scene.parts).map_err(|e| fail("plc", &e))?;
    let measures = measure::measure(&complex);
    let manifest = Manifest::new(&scene, &complex, &measures, &plc);
    let found = [check::check_complex(&complex, &plc, &manifest), check::check(&plc, Some(&manifest))].concat();
    if !found.is_empty() {
        return Err(fail("check", &found));
    }
    // Closed, and V - E + F - L = 2 (R + S - H).
    let brep = Brep::from_complex(complex.clone()).map_err(|e| format!("kernel: {e:?}\n{text}"))?;
    if !brep.check().is_empty() {
        return Err(format!("kernel: {:?}\n{text}", brep.check()));
    }
    if let Some(what) = stray(&scene, &solids, &complex) {
        return Err(format!("lineage: {what}\n{text}"));
    }
    let mut volumes = vec![0.0; parts.len()];
    for (region, volume) in complex.regions.enumerate().map(|(id, region)| (region, measures.volumes[id])) {
        if let Some(part) = region.part {
            volumes[part.index()] += volume;
        }
    }
    Ok(Built { volumes, regions: complex.regions.len(), repairs: evaluation.repairs.rounds })
}

/// A facet that does not lie on the facet of the leaf that it says it comes from.
fn stray(scene: &Scene, solids: &[Solid], complex: &Complex) -> Option<String> {
    let size = complex.vertices.iter().fold(0.0, |m: f64, v| m.max(v.point.amax()));
    complex.facets.iter().find_map(|facet| {
        let (leaf, number) = facet.source;
        let solid = &solids[leaf.index()];
        let source = &solid.facets[number as usize];
        let at = |v: u32| solid.vertices[v as usize].point;
        let walk = &source.loops[0];
        let corners = (1..walk.len() - 1).map(|k| [at(walk[0]), at(walk[k]), at(walk[k + 1])]);
        let normal = corners.map(|[a, b, c]| (b - a).cross(&(c - a))).sum::<Vec3>().normalize();
        let height = |p: Vec3| (p - at(walk[0])).dot(&normal).abs();
        let worst = facet.loops.iter().flatten().map(|v| height(complex.vertices[*v].point)).fold(0.0, f64::max);
        let is_own = complex.surfaces[facet.surface].leaf == leaf
            && complex.surfaces[facet.surface].side == solid.surfaces[source.surface as usize].side;
        (worst > 4.0 * scene.tolerance * size || !is_own).then(|| format!("{leaf:?} facet {number}, {worst:e} off"))
    })
}

fn volume(solid: &str) -> Result<f64, String> {
    Ok(build(&[("it".into(), solid.into())])?.volumes[0])
}

/// Runs one kind of scene for all seeds.
fn run(what: &str, one: impl Fn(&mut Generator) -> Result<u32, String> + Sync) {
    let number = |name: &str, default| std::env::var(name).ok().and_then(|n| n.parse().ok()).unwrap_or(default);
    let (first, count) = (number("GSM_RANDOM_SEED", 0), number("GSM_RANDOM", COUNT));
    let results: Vec<(u64, Result<u32, String>)> =
        (first..first + count).into_par_iter().map(|seed| (seed, one(&mut Generator::new(seed)))).collect();
    let repairs = results.iter().filter(|r| matches!(r.1, Ok(n) if n > 0)).count();
    eprintln!("{what}: {count} scenes, rounding repaired in {repairs}");
    let failures: Vec<String> =
        results.into_iter().filter_map(|(seed, r)| r.err().map(|e| format!("{what}, seed {seed}: {e}"))).collect();
    assert!(failures.is_empty(), "{} of {count} failed\n{}", failures.len(), failures.join("\n"));
}

fn expect(what: &str, left: f64, right: f64, scale: f64) -> Result<(), String> {
    if (left - right).abs() <= VOLUME_ERROR * scale { Ok(()) } else { Err(format!("{what}: {left:?} is not {right:?}")) }
}

#[test]
fn boxes_on_a_grid_have_the_volume_of_their_voxels() {
    run("grid", |random| {
        let (solid, voxels): (String, Voxels) = random.grid_tree(3);
        let count = f64::from(voxels.count());
        expect(&solid, volume(&solid)?, count, count)?;
        let turned = random.turned(&solid);
        expect(&turned, volume(&turned)?, count, count)?;
        Ok(0)
    });
}

#[test]
fn trees_keep_the_identities_of_sets() {
    run("trees", |random| {
        let (a, b) = (random.tree(2), random.tree(2));
        let together = |operation: &str| {
            let built = build(&[("it".into(), format!("{operation}([{a}, {b}])"))])?;
            Ok::<_, String>((built.volumes[0], built.repairs))
        };
        let (both, any) = (together("Intersection")?, together("Union")?);
        let (rest, either) = (together("Difference")?, together("Xor")?);
        let (first, second) = (volume(&a)?, volume(&b)?);
        let scale = first + second;
        let told = format!("A: {a}\nB: {b}\n");
        expect(&format!("{told}union and intersection"), any.0 + both.0, scale, scale)?;
        expect(&format!("{told}difference and intersection"), rest.0 + both.0, first, scale)?;
        expect(&format!("{told}symmetric difference"), either.0 + both.0, any.0, scale)?;
        Ok(both.1 + any.1 + rest.1 + either.1)
    });
}

#[test]
fn assemblies_tile_the_box_that_encloses_them() {
    run("assemblies", |random| {
        let side = 2.0 * generator::REACH;
        let room = format!("Block(size: ({side:?}, {side:?}, {side:?}), center: (0, 0, 0))");
        let mut parts = vec![("room".to_string(), room)];
        for k in 0..2 + random.below(4) {
            parts.push((format!("part{k}"), random.tree(1)));
        }
        // A part that a later one swallows is an error, and not what is asked here.
        while parts.len() > 1 {
            match build(&parts) {
                Err(e) if e.contains("empty-part") => drop(parts.remove(1)),
                Err(e) => return Err(e),
                Ok(built) => {
                    let all = side * side * side;
                    expect(&format!("{parts:?}"), built.volumes.iter().sum(), all, all)?;
                    let last = parts.last().map_or(Ok(0.0), |p| volume(&p.1))?;
                    expect(&format!("{parts:?}: the last part"), built.volumes[parts.len() - 1], last, last)?;
                    assert!(built.regions > parts.len());
                    return Ok(built.repairs);
                }
            }
        }
        Ok(0)
    });
}
