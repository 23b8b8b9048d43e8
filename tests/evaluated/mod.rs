//! Scenes written as text, built, and checked for everything that holds for every scene.
#![allow(dead_code)]

use gsm::brep::complex::Complex;
use gsm::brep::model::Brep;
use gsm::diag::Diagnostic;
use gsm::evaluate::{Evaluation, evaluate};
use gsm::geom::Vec3;
use gsm::ids::Id;
use gsm::io::manifest::Manifest;
use gsm::plc::{self, check, measure};
use gsm::primitive::solid::Solid;
use gsm::report::timing::Timings;
use gsm::scene::model::Scene;
use gsm::scene::{self, Limits};
use std::path::Path;

/// What a scene became.
pub struct Built {
    /// All of it; `None` if nothing is left.
    pub evaluation: Option<Evaluation>,
    /// Volume of each part; 0 if nothing is left of it.
    pub volumes: Vec<f64>,
}

impl Built {
    /// How often rounding was repaired.
    pub fn repairs(&self) -> u32 {
        self.evaluation.as_ref().map_or(0, |e| e.repairs.rounds)
    }
    /// Numbers of vertices, facets and regions.
    pub fn counts(&self) -> [usize; 3] {
        self.evaluation.as_ref().map_or([0; 3], |e| [e.complex.vertices.len(), e.complex.facets.len(), e.complex.regions.len()])
    }
    /// Area of the interface of this name, 0 if there is none.
    pub fn area(&self, name: &str) -> f64 {
        self.evaluation.as_ref().map_or(0.0, |e| {
            let areas = measure::measure(&e.complex).areas;
            e.complex.markers.enumerate().filter(|m| m.1.name == name).map(|m| areas[m.0]).sum()
        })
    }
}

/// Builds a scene of parts (name, solid) and checks all that holds for every scene.
pub fn build<S: AsRef<str>>(parts: &[(S, S)]) -> Result<Built, String> {
    build_in(Path::new("."), parts)
}

/// The same where imports read from a folder.
pub fn build_in<S: AsRef<str>>(folder: &Path, parts: &[(S, S)]) -> Result<Built, String> {
    let list: Vec<String> =
        parts.iter().map(|(name, solid)| format!("Part(name: \"{}\", solid: {})", name.as_ref(), solid.as_ref())).collect();
    let text = format!("Scene(units: \"mm\", remesh: Off, parts: [\n{}\n])", list.join(",\n"));
    let fail = |what: &str, found: &[Diagnostic]| {
        let said: Vec<String> = found.iter().take(3).map(|d| format!("{}: {} at {:?}", d.code, d.message, d.points)).collect();
        format!("{what}: {}\n{text}", said.join("; "))
    };
    let (scene, _) = scene::parse("random", folder, &text, &[], &Limits::default()).map_err(|e| fail("scene", &e))?;
    let solids = gsm::primitive::build(&scene).map_err(|e| fail("primitive", &e))?;
    let evaluation = match evaluate(&scene, &solids, &mut Timings::default()) {
        Ok(evaluation) => evaluation,
        Err(e) if parts.len() == 1 && e.iter().all(|d| d.code == "empty-part") => {
            return Ok(Built { evaluation: None, volumes: vec![0.0] });
        }
        Err(e) => return Err(fail("evaluate", &e)),
    };
    let complex = &evaluation.complex;
    let plc = plc::build::build(complex, &scene.parts).map_err(|e| fail("plc", &e))?;
    let measures = measure::measure(complex);
    let manifest = Manifest::new(&scene, complex, &measures, &plc);
    let found = [check::check_complex(complex, &plc, &manifest), check::check(&plc, Some(&manifest))].concat();
    if !found.is_empty() {
        return Err(fail("check", &found));
    }
    // Closed, and V - E + F - L = 2 (R + S - H).
    let brep = Brep::from_complex(complex.clone()).map_err(|e| format!("kernel: {e:?}\n{text}"))?;
    if !brep.check().is_empty() {
        return Err(format!("kernel: {:?}\n{text}", brep.check()));
    }
    if let Some(what) = stray(&scene, &solids, complex) {
        return Err(format!("lineage: {what}\n{text}"));
    }
    let mut volumes = vec![0.0; parts.len()];
    for (region, volume) in complex.regions.enumerate().map(|(id, region)| (region, measures.volumes[id])) {
        if let Some(part) = region.part {
            volumes[part.index()] += volume;
        }
    }
    Ok(Built { evaluation: Some(evaluation), volumes })
}

/// A facet that does not lie on the facet of the leaf that it says it comes from.
fn stray(scene: &Scene, solids: &[Solid], complex: &Complex) -> Option<String> {
    let size = complex.vertices.iter().fold(0.0, |m: f64, v| m.max(v.point.amax()));
    complex.facets.iter().find_map(|facet| {
        let (leaf, number) = facet.source;
        let solid = &solids[leaf.index()];
        let source = solid.facets.of(number);
        let at = |v: u32| solid.vertices[v as usize].point;
        let walk = source.loops.outer();
        let corners = (1..walk.len() - 1).map(|k| [at(walk[0]), at(walk[k]), at(walk[k + 1])]);
        let normal = corners.map(|[a, b, c]| (b - a).cross(&(c - a))).sum::<Vec3>().normalize();
        let height = |p: Vec3| (p - at(walk[0])).dot(&normal).abs();
        let worst = facet.loops.iter().flatten().map(|v| height(complex.vertices[*v].point)).fold(0.0, f64::max);
        let is_own = complex.surfaces[facet.surface].leaf == leaf
            && complex.surfaces[facet.surface].side == solid.surfaces[source.surface as usize].side;
        (worst > 4.0 * scene.tolerance * size || !is_own).then(|| format!("{leaf:?} facet {number}, {worst:e} off"))
    })
}
