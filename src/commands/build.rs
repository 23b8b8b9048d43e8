//! `gsm build`: from a scene to .poly and manifest.

use super::session::{self, Exit, Session};
use crate::cli::BuildArgs;
use crate::diag::Diagnostic;
use crate::io::atomic::{self, NewFile};
use crate::io::{manifest, poly};
use crate::pipeline::{self, Model};
use crate::report::{Report, text};
use std::io;
use std::path::{Path, PathBuf};

/// Builds a scene and writes both files, or complains and writes none.
///
/// # Errors
/// Those of standard output.
pub fn run(args: &BuildArgs, session: &mut Session) -> io::Result<Exit> {
    session.set_threads();
    if let Some(fault) = args.output.as_ref().and_then(|path| misplaced(args, path)) {
        return complain(vec![fault], args, session, "");
    }
    // Told before the work, as in `gsm mesh`.
    if let Some(fault) = session::missing_folder(args.output.as_slice()) {
        return complain(vec![fault], args, session, "");
    }
    let timings = session.timings(&args.scene);
    let mut model = match pipeline::run(&args.scene, session::overrides(&args.changes), timings) {
        Ok(model) => model,
        Err(faults) => return complain(faults, args, session, ""),
    };
    let path = args.output.clone().unwrap_or_else(|| PathBuf::from(format!("{}.poly", model.scene.name)));
    if let Err(fault) = write(&mut model, &path) {
        let unit = model.scene.unit.clone();
        return complain([std::mem::take(&mut model.warnings), vec![fault]].concat(), args, session, &unit);
    }
    let report = Report::new(&model, Some(path.display().to_string()));
    if session.common.json {
        session.json(&args.scene, &model.warnings, &report)?;
    } else {
        session.complain(&model.warnings, &args.scene, &model.scene.unit);
        if !session.common.quiet {
            session.out.write_all(text::render(&report).as_bytes())?;
            let (scene, poly) = (args.scene.display(), path.display());
            let picture = path.with_extension("glb");
            writeln!(
                session.out,
                "now: gsm mesh {scene} (tetrahedra for solvers) or gsm convert {poly} {} (for viewers)",
                picture.display()
            )?;
        }
    }
    // The process ends: giving its memory back list by list would take as long as a small stage.
    std::mem::forget(model);
    Ok(Exit::Good)
}

/// What is wrong with a place to write to, before the work.
fn misplaced(args: &BuildArgs, path: &Path) -> Option<Diagnostic> {
    if !path.extension().is_some_and(|e| e.eq_ignore_ascii_case("poly")) {
        let message = format!("{}: a build is written as .poly", path.display());
        let hint = "write -o NAME.poly; `gsm mesh` and `gsm convert` write other formats";
        return Some(Diagnostic::usage("unknown-format", message).hint(hint));
    }
    session::overwriting(&args.scene, &[path.to_path_buf()])
}

fn write(model: &mut Model, path: &Path) -> Result<(), Diagnostic> {
    let Model { plc, manifest, timings, .. } = model;
    timings.measure("write", || {
        let poly = poly::to_text(plc, Some(manifest));
        let json = manifest.to_json()?;
        let file = |path: PathBuf, content| NewFile { path, content };
        atomic::write_all(&[file(path.to_path_buf(), poly.as_bytes()), file(manifest::path_beside(path), json.as_bytes())])
    })
}

fn complain(faults: Vec<Diagnostic>, args: &BuildArgs, session: &mut Session, unit: &str) -> io::Result<Exit> {
    session.fail(&faults, &args.scene, unit)?;
    Ok(Exit::of(&faults))
}
