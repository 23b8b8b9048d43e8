//! `gsm check`: is a scene's result, or a .poly, a valid PLC?

use super::session::{self, Exit, Session};
use crate::cli::CheckArgs;
use crate::diag::{Diagnostic, Severity};
use crate::io::manifest::{Counts, Manifest};
use crate::io::poly;
use crate::pipeline;
use crate::plc::check;
use crate::report::diagnostics::{self, Style};
use serde::Serialize;
use std::io::{self, IsTerminal};
use std::path::Path;

/// What a check says besides its findings.
#[derive(Serialize)]
struct Verdict {
    is_valid: bool,
    counts: Option<Counts>,
}

/// Checks a scene (builds it, writes nothing) or a .poly or .smesh file; what it finds goes to standard output.
///
/// # Errors
/// Those of standard output.
pub fn run(args: &CheckArgs, session: &mut Session) -> io::Result<Exit> {
    session.set_threads();
    let is_plc = poly::is_plc(&args.path);
    let (counts, unit, findings) = if is_plc { check_file(&args.path) } else { check_scene(args, session) };
    let exit = Exit::of(&findings);
    if session.common.json {
        session.json(&args.path, &findings, &Verdict { is_valid: exit == Exit::Good, counts })?;
    } else {
        session.out.write_all(render(counts, &findings, args, &unit, session).as_bytes())?;
    }
    Ok(exit)
}

type Checked = (Option<Counts>, String, Vec<Diagnostic>);

fn check_file(path: &Path) -> Checked {
    let mut faults = Vec::new();
    let manifest = Manifest::beside(path).unwrap_or_else(|fault| {
        faults.push(fault);
        None
    });
    let unit = manifest.as_ref().map_or(String::new(), |m| m.unit.clone());
    match poly::read(path) {
        Ok(plc) => {
            faults.extend(check::check(&plc, manifest.as_ref()));
            (Some(Counts::of(&plc)), unit, faults)
        }
        Err(fault) => {
            faults.push(fault);
            (None, unit, faults)
        }
    }
}

fn check_scene(args: &CheckArgs, session: &Session) -> Checked {
    let timings = session.timings(&args.path);
    match pipeline::run(&args.path, session::overrides(&args.changes), timings) {
        Ok(model) => {
            let mut findings = model.warnings;
            findings.extend(check::check_complex(&model.complex, &model.plc, &model.manifest));
            // The file itself must be valid too, with the triangulation that a reader makes.
            if Exit::of(&findings) == Exit::Good {
                findings.extend(check::check(&model.plc, Some(&model.manifest)));
            }
            (Some(Counts::of(&model.plc)), model.scene.unit, findings)
        }
        Err(faults) => (None, String::new(), faults),
    }
}

fn render(counts: Option<Counts>, findings: &[Diagnostic], args: &CheckArgs, unit: &str, session: &Session) -> String {
    let text = session::source_for(findings, &args.path);
    let is_coloured = io::stdout().is_terminal() && session::is_colour_wanted();
    let file = args.path.display().to_string();
    let style = Style { file: &file, text: text.as_deref(), unit, is_coloured };
    let mut out: String = findings.iter().filter(|d| !session.is_seen(d)).map(|d| diagnostics::render(d, &style)).collect();
    if session.common.quiet {
        return out;
    }
    let errors = findings.iter().filter(|d| d.severity > Severity::Warning).count();
    out += &match (errors, counts) {
        (0, Some(c)) => {
            format!("{file}: valid: {} vertices, {} facets, {} pieces, {} voids\n", c.vertices, c.facets, c.seeds, c.holes)
        }
        (1, _) => format!("{file}: 1 finding\n"),
        (n, _) => format!("{file}: {n} findings\n"),
    };
    out
}
