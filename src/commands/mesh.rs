//! `gsm mesh`: from a scene to a volume mesh for solvers.

use super::session::{self, Exit, Session};
use crate::cli::{MeshArgs, MshVersion};
use crate::diag::Diagnostic;
use crate::io::atomic::{self, NewFile};
use crate::io::format::{self, Format};
use crate::io::manifest::{self, Manifest};
use crate::io::poly;
use crate::pipeline::{self, Overrides};
use crate::report::timing::Timings;
use crate::report::volume::VolumeReport;
use crate::scene;
use crate::scene::model::{MeshOptions, RemeshMode, Thresholds};
use crate::tetgen::{self, Input, Meshed, Options, Program, find, thin};
use serde::Serialize;
use std::fmt::Write as _;
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// What to do about a missed threshold.
const QUALITY: &str =
    "the files are written; ask for a smaller --ratio, a larger --dihedral or smaller max_volume, or lower the bar";

/// What a run says.
#[derive(Serialize)]
struct MeshReport<'a> {
    gsm: &'static str,
    outputs: Vec<String>,
    tetgen: &'a Program,
    attempts: Vec<AttemptReport>,
    /// By how much vertices were moved, as a fraction of the size.
    moved: f64,
    #[serde(flatten)]
    mesh: VolumeReport,
    missed: Vec<String>,
    timings: &'a Timings,
}

#[derive(Serialize)]
struct AttemptReport {
    change: String,
    tetgen: String,
    verdict: String,
    seconds: f64,
}

/// What is to be meshed.
struct Task {
    input: Input,
    manifest: Option<Manifest>,
    wanted: MeshOptions,
    /// Whether facets may be other than evaluated.
    is_remeshed: bool,
    name: String,
    warnings: Vec<Diagnostic>,
}

/// Meshes and writes all files, or complains and writes none. A missed threshold does not keep the files from being written.
///
/// # Errors
/// Those of standard output.
pub fn run(args: &MeshArgs, session: &mut Session) -> io::Result<Exit> {
    session.set_threads();
    let mut timings = session.timings(&args.path);
    // A missing program or folder, or a name that is no format, is told before the work.
    let programs = match find::find(args.tetgen.as_deref()) {
        Ok(programs) => programs,
        Err(fault) => return complain(vec![fault], args, session, Exit::Outside),
    };
    let unknown = args.output.iter().find_map(|path| Format::of(path).err());
    let misplaced = unknown.or_else(|| session::overwriting(&args.path, &args.output));
    let misplaced = misplaced.or_else(|| session::written_twice(&args.output));
    if let Some(fault) = misplaced.or_else(|| session::missing_folder(&args.output)) {
        let exit = Exit::of(std::slice::from_ref(&fault));
        return complain(vec![fault], args, session, exit);
    }
    let mut task = match load(args, session::overrides(&args.changes), &mut timings) {
        Ok(task) => task,
        Err(faults) => {
            let exit = Exit::of(&faults);
            return complain(faults, args, session, exit);
        }
    };
    if let Some(thin) = thin::warning(&task.input) {
        // Before the long work; with JSON there is no before.
        match args.common.json {
            true => task.warnings.push(thin),
            false => session.complain(&[thin], &args.path, ""),
        }
    }
    let options = Options { on_attempt: session.progress(), ..options(args, &task.wanted) };
    let mut result = timings.measure("tetgen", || tetgen::mesh(&task.input, &programs, &options));
    if let Err(faults) = &result
        && task.is_remeshed
        && let Some(failure) = faults.iter().find(|f| f.code == "tetgen-failed")
        && let Ok(plain) = without_remeshing(failure, args, &mut timings)
    {
        task = plain;
        result = timings.measure("tetgen", || tetgen::mesh(&task.input, &programs, &options));
    }
    let meshed = match result {
        Ok(mut meshed) => {
            task.warnings.append(&mut meshed.warnings);
            meshed
        }
        Err(faults) => return complain([task.warnings, faults].concat(), args, session, Exit::Outside),
    };
    let outputs = match args.output.is_empty() {
        true => vec![PathBuf::from(format!("{}.msh", task.name))],
        false => args.output.clone(),
    };
    if let Err(fault) = timings.measure("write", || write(&meshed, &task, &outputs, args.msh)) {
        return complain([task.warnings, vec![fault]].concat(), args, session, Exit::Wrong);
    }
    report(args, session, &task, &meshed, &outputs, options.ratio, timings)
}

/// The scene with its surfaces as they were evaluated: what is left to try where TetGen fails on remeshed ones.
fn without_remeshing(failure: &Diagnostic, args: &MeshArgs, timings: &mut Timings) -> Result<Task, Vec<Diagnostic>> {
    let off = Overrides { set: &args.changes.set, remesh: Some(RemeshMode::Off) };
    let mut task = load(args, off, timings)?;
    let message = format!("{} of the remeshed surfaces; they are now as evaluated", failure.message);
    task.warnings.push(Diagnostic::warning("not-remeshed", message).hint("`--remesh off` does this at once"));
    Ok(task)
}

/// A scene through the pipeline, or a .poly with its manifest.
fn load(args: &MeshArgs, overrides: Overrides, timings: &mut Timings) -> Result<Task, Vec<Diagnostic>> {
    if poly::is_plc(&args.path) {
        let one = |fault| vec![fault];
        let manifest = Manifest::beside(&args.path).map_err(one)?;
        let plc = poly::read(&args.path).map_err(one)?;
        let input = timings.measure("check", || Input::from_plc(plc, manifest.as_ref()))?;
        let name = args.path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        return Ok(Task { input, manifest, wanted: MeshOptions::default(), name, warnings: Vec::new(), is_remeshed: false });
    }
    let model = pipeline::run(&args.path, overrides, std::mem::take(timings))?;
    *timings = model.timings;
    Ok(Task {
        input: Input::new(model.plc, &model.complex, &model.scene.parts),
        manifest: Some(model.manifest),
        is_remeshed: model.scene.remesh.mode != RemeshMode::Off,
        wanted: model.scene.mesh,
        name: model.scene.name,
        warnings: model.warnings,
    })
}

/// The command line goes before the scene.
fn options(args: &MeshArgs, scene: &MeshOptions) -> Options {
    /// Bytes of a GiB.
    const GIB: f64 = (1u64 << 30) as f64;
    Options {
        ratio: args.ratio.unwrap_or(scene.ratio),
        dihedral: args.dihedral.or(scene.dihedral).unwrap_or(0.0),
        max_volume: args.max_volume,
        time: Duration::try_from_secs_f64(args.time_limit).unwrap_or(Duration::MAX),
        memory: (args.memory_limit * GIB) as u64,
        on_attempt: None,
    }
}

fn write(meshed: &Meshed, task: &Task, outputs: &[PathBuf], msh: MshVersion) -> Result<(), Diagnostic> {
    let meters = task.manifest.as_ref().and_then(|m| scene::meters(&m.unit)).unwrap_or(1.0);
    let mut contents = Vec::new();
    for path in outputs {
        let format = with_version(Format::of(path)?, msh);
        contents.push((path.clone(), format, format::render(&meshed.mesh, meters, format, path)?));
    }
    // The manifest stands beside the first file; its volumes are those of the complex that was meshed.
    let mut json = None;
    if let (Some(manifest), Some((first, format, content))) = (&task.manifest, contents.first()) {
        let mut manifest = format::manifest_of(manifest.clone(), *format, content)?;
        for region in &mut manifest.regions {
            let volume = u32::try_from(region.region).ok().and_then(|r| meshed.volumes.get(&r));
            if let (true, Some(volume)) = (meshed.moved > 0.0, volume) {
                region.volume = *volume;
            }
        }
        json = Some((manifest::path_beside(first), manifest.to_json()?.into_bytes()));
    }
    let all = contents.iter().map(|(path, _, content)| (path, content)).chain(json.as_ref().map(|(path, json)| (path, json)));
    let files: Vec<NewFile> = all.map(|(path, content)| NewFile { path: path.clone(), content }).collect();
    atomic::write_all(&files)
}

/// The version of .msh that was asked for; other formats as they are.
pub(super) fn with_version(format: Format, msh: MshVersion) -> Format {
    if format == Format::Msh22 && msh == MshVersion::V41 { Format::Msh41 } else { format }
}

fn report(
    args: &MeshArgs,
    session: &mut Session,
    task: &Task,
    meshed: &Meshed,
    outputs: &[PathBuf],
    ratio: f64,
    mut timings: Timings,
) -> io::Result<Exit> {
    let said = Thresholds {
        min_dihedral: args.min_dihedral,
        max_ratio: args.max_ratio,
        max_aspect: args.max_aspect,
        min_angle: args.min_angle,
        max_condition: args.max_condition,
    };
    let wanted = said.or(task.wanted.thresholds);
    let with_stiffness = args.condition || wanted.max_condition.is_some();
    let mesh = timings.measure("report", || VolumeReport::new(&meshed.mesh, ratio, with_stiffness));
    let missed = mesh.missed(&wanted);
    let exit = if missed.is_empty() { Exit::Good } else { Exit::Quality };
    let attempts = meshed.attempts.iter().map(|a| AttemptReport {
        change: a.to_string(),
        tetgen: a.version.clone(),
        verdict: a.verdict.clone(),
        seconds: a.seconds,
    });
    let report = MeshReport {
        gsm: env!("CARGO_PKG_VERSION"),
        outputs: outputs.iter().map(|p| p.display().to_string()).collect(),
        tetgen: &meshed.program,
        attempts: attempts.collect(),
        moved: meshed.moved,
        mesh,
        missed,
        timings: &timings,
    };
    let faults = report.missed.iter().map(|m| Diagnostic::error("quality", m.clone()).hint(QUALITY));
    let told: Vec<Diagnostic> = task.warnings.iter().cloned().chain(faults).collect();
    if session.common.json {
        session.json(&args.path, &told, &report)?;
        return Ok(exit);
    }
    session.complain(&told, &args.path, task.manifest.as_ref().map_or("", |m| &m.unit));
    if !session.common.quiet {
        session.out.write_all(text(&report).as_bytes())?;
    }
    Ok(exit)
}

fn text(report: &MeshReport) -> String {
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = writeln!(out, "TetGen {} ({})", report.tetgen.version, report.tetgen.path.display());
    for a in &report.attempts {
        let _ = writeln!(out, "  {}: {} ({:.1} s)", a.change, a.verdict, a.seconds);
    }
    let _ = write!(out, "\n{}", report.mesh);
    let _ = writeln!(out, "\nwritten: {}", report.outputs.join(", "));
    out
}

fn complain(faults: Vec<Diagnostic>, args: &MeshArgs, session: &mut Session, exit: Exit) -> io::Result<Exit> {
    session.fail(&faults, Path::new(&args.path), "")?;
    // A fault of gsm itself is one whatever was being done.
    Ok(if Exit::of(&faults) == Exit::Internal { Exit::Internal } else { exit })
}
