//! The pipeline, stage by stage: scene file to everything that a command writes or says.

use crate::arrangement::Statistics;
use crate::brep::complex::Complex;
use crate::diag::{Diagnostic, Outcome};
use crate::evaluate;
use crate::geom::embedding;
use crate::io::manifest::Manifest;
use crate::plc::measure::{self, Measures};
use crate::plc::{self, Plc};
use crate::primitive;
use crate::remesh;
use crate::report::timing::Timings;
use crate::scene::{
    self, Limits,
    model::{RemeshMode, Scene},
};
use std::path::Path;

/// A built scene.
pub struct Model {
    /// The scene.
    pub scene: Scene,
    /// The evaluated model.
    pub complex: Complex,
    /// Its volumes and areas.
    pub measures: Measures,
    /// What the .poly holds.
    pub plc: Plc,
    /// What its numbers mean.
    pub manifest: Manifest,
    /// Counts of the arrangement.
    pub statistics: Statistics,
    /// What may not be meant.
    pub warnings: Vec<Diagnostic>,
    /// How long the stages took.
    pub timings: Timings,
}

/// Builds the scene at `path` with parameters set from outside; `timings` is empty and is carried through.
///
/// # Errors
/// All faults that the first failing stage found, after the warnings of the stages before.
pub fn run(path: &Path, overrides: &[(String, String)], mut timings: Timings) -> Outcome<Model> {
    let loaded = timings.measure("scene", || scene::load(path, overrides, &Limits::default()))?;
    let (scene, warnings) = (loaded.scene, loaded.warnings);
    build(scene, warnings.clone(), timings).map_err(|faults| [warnings, faults].concat())
}

fn build(scene: Scene, mut warnings: Vec<Diagnostic>, mut timings: Timings) -> Outcome<Model> {
    let solids = timings.measure("primitive", || primitive::build(&scene))?;
    let evaluation = evaluate::evaluate(&scene, &solids, &mut timings)?;
    let statistics = evaluation.statistics;
    warnings.extend(evaluation.warnings);
    let complex = timings.measure("remesh", || remeshed(&scene, evaluation.complex, &mut warnings))?;
    let plc = timings.measure("plc", || plc::build::build(&complex, &scene.parts))?;
    let measures = timings.measure("measure", || measure::measure(&complex));
    let manifest = Manifest::new(&scene, &complex, &measures, &plc);
    Ok(Model { scene, complex, measures, plc, manifest, statistics, warnings, timings })
}

/// The remeshed complex; the evaluated one, with a warning, if the remesher's result is no embedding: what is written is valid.
fn remeshed(scene: &Scene, complex: Complex, warnings: &mut Vec<Diagnostic>) -> Outcome<Complex> {
    if scene.remesh.mode == RemeshMode::Off {
        return Ok(complex);
    }
    let result = remesh::remesh(complex.clone(), &scene.remesh, &scene.parts)?;
    let points: Vec<_> = result.vertices.iter().map(|v| v.point).collect();
    let triangles: Vec<[u32; 3]> = result.facets.iter().flat_map(|f| f.triangles.iter().map(|t| t.map(|v| v.0))).collect();
    match embedding::violations(&points, &triangles, 1).first() {
        None => Ok(result),
        Some(violation) => {
            let text = "the remeshed surface would meet itself here, so the curved surfaces are left as they were";
            warnings.push(
                Diagnostic::warning("remesh-refused", text)
                    .near(violation.point)
                    .hint("set a smaller `max_deviation`, or `remesh: Off`"),
            );
            Ok(complex)
        }
    }
}
