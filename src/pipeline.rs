//! The pipeline, stage by stage: scene file to everything that a command writes or says.

use crate::arrangement::Statistics;
use crate::brep::complex::Complex;
use crate::diag::{Diagnostic, Outcome};
use crate::evaluate;
use crate::io::manifest::Manifest;
use crate::plc::measure::{self, Measures};
use crate::plc::{self, Plc};
use crate::position::position;
use crate::primitive;
use crate::remesh::{self, change, forecast};
use crate::report::timing::Timings;
use crate::round::Repairs;
use crate::scene::model::{RemeshMode, Scene};
use crate::scene::{self, Limits};
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
    /// How often rounding was repaired.
    pub repairs: Repairs,
    /// What may not be meant.
    pub warnings: Vec<Diagnostic>,
    /// How long the stages took.
    pub timings: Timings,
}

/// What is set from outside of the scene.
#[derive(Clone, Copy, Debug, Default)]
pub struct Overrides<'a> {
    /// Parameters and their values.
    pub set: &'a [(String, String)],
    /// What is remeshed, if not what the scene says.
    pub remesh: Option<RemeshMode>,
}

/// Builds the scene at `path` with what is set from outside; `timings` is empty and is carried through.
///
/// # Errors
/// All faults that the first failing stage found, after the warnings of the stages before.
pub fn run(path: &Path, overrides: Overrides, mut timings: Timings) -> Outcome<Model> {
    let loaded = timings.measure("scene", || scene::load(path, overrides.set, &Limits::default()))?;
    let (mut scene, warnings) = (loaded.scene, loaded.warnings);
    scene.remesh.mode = overrides.remesh.unwrap_or(scene.remesh.mode);
    timings.tell(&warnings);
    // Inside the pool of threads, so that each parallel loop does not have to wake it.
    rayon::scope(|_| build(scene, warnings.clone(), timings)).map_err(|faults| [warnings, faults].concat())
}

fn build(scene: Scene, mut warnings: Vec<Diagnostic>, mut timings: Timings) -> Outcome<Model> {
    let solids = timings.measure("primitive", || primitive::build(&scene))?;
    let evaluation = evaluate::evaluate(&scene, &solids, &mut timings)?;
    // Their memory serves what follows.
    drop(solids);
    let (statistics, repairs, tolerance) = (evaluation.statistics, evaluation.repairs, evaluation.tolerance);
    warnings.extend(evaluation.warnings);
    // Before the work that it warns of.
    if let Some(warning) = forecast::forecast(&evaluation.complex, &scene, Limits::default().memory)? {
        timings.tell(std::slice::from_ref(&warning));
        warnings.push(warning);
    }
    let is_remeshed = scene.remesh.mode != RemeshMode::Off;
    let evaluated = is_remeshed.then(|| measure::measure(&evaluation.complex).by_part(&evaluation.complex, &scene.parts));
    let complex = timings.measure("remesh", || remesh::remesh(evaluation.complex, &scene.remesh, &scene.parts))?;
    let complex = timings.measure("position", || position(complex, tolerance, is_remeshed));
    let plc = timings.measure("plc", || plc::build::build(&complex, &scene.parts))?;
    let measures = timings.measure("measure", || measure::measure(&complex));
    if let Some(evaluated) = evaluated {
        warnings.extend(change::warnings(&evaluated, &measures.by_part(&complex, &scene.parts), &scene));
    }
    let manifest = Manifest::new(&scene, &complex, &measures, &plc);
    Ok(Model { scene, complex, measures, plc, manifest, statistics, repairs, warnings, timings })
}
