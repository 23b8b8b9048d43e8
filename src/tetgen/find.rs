//! Which TetGen programs there are.

use super::child::{self, Ending, Limits};
use crate::diag::Diagnostic;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Environment variable that names the program.
pub const VARIABLE: &str = "GSM_TETGEN";
/// Names under which installations put it on PATH; a newer one may stand beside Debian's 1.5.0.
const NAMES: [&str; 4] = ["tetgen", "tetgen1.6", "tetgen-1.6", "tetgen16"];
/// What asking for the version may take.
const PROBE: Limits = Limits { time: Duration::from_secs(10), stall: Duration::from_secs(10), memory: 1 << 30 };

/// A TetGen program.
#[derive(Clone, PartialEq, Eq, Debug, serde::Serialize)]
pub struct Program {
    /// Where it is.
    pub path: PathBuf,
    /// What it says of itself, e.g. `1.5`; empty if it does not say.
    pub version: String,
}

/// The programs to use, in order: the given one, or what the environment names, else all on PATH, oldest version first, since
/// the ladder takes the first as the usual one and later ones as newer.
///
/// # Errors
/// If there is none, with how to get it.
pub fn find(given: Option<&Path>) -> Result<Vec<Program>, Diagnostic> {
    if let Some(path) = given {
        return only(path, "--tetgen");
    }
    if let Some(path) = std::env::var_os(VARIABLE).filter(|v| !v.is_empty()) {
        return only(Path::new(&path), VARIABLE);
    }
    let folders: Vec<PathBuf> = std::env::var_os("PATH").map(|p| std::env::split_paths(&p).collect()).unwrap_or_default();
    let paths = NAMES.iter().filter_map(|name| folders.iter().map(|f| f.join(name)).find(|p| p.is_file()));
    let probed = paths.map(|path| probe(&path)).collect::<Result<Vec<_>, _>>()?;
    let mut found: Vec<Program> = probed.into_iter().flatten().collect();
    found.sort_by(|a, b| a.version.cmp(&b.version));
    if found.is_empty() {
        return Err(missing("TetGen was not found on PATH"));
    }
    Ok(found)
}

fn only(path: &Path, source: &str) -> Result<Vec<Program>, Diagnostic> {
    match probe(path)? {
        Some(program) => Ok(vec![program]),
        None => Err(missing(&format!("{} ({source}) is not TetGen", path.display()))),
    }
}

fn missing(message: &str) -> Diagnostic {
    Diagnostic::error("no-tetgen", message)
        .hint("Debian and Ubuntu: apt-get install tetgen; macOS: brew install tetgen; sources: https://wias-berlin.de/software/tetgen")
        .hint(format!("or name the program by --tetgen PATH or the environment variable {VARIABLE}"))
}

/// Runs `tetgen -h`: the help names the program and `Version 1.5`. (Its exit code means nothing: 1.5.0 aborts after its help.)
/// Errors: there is no room for what it says.
fn probe(path: &Path) -> Result<Option<Program>, Diagnostic> {
    let folder = child::Folder::new().map_err(|e| child::no_room(&e))?;
    let run = child::run(path, &["-h"], folder.path(), &PROBE).ok();
    let Some(run) = run.filter(|run| run.ending != Ending::OutOfTime && run.log.contains("TetGen")) else {
        return folder.check_room().map(|()| None);
    };
    let version = run.log.split_once("Version ").and_then(|(_, rest)| rest.split_whitespace().next()).unwrap_or("");
    Ok(Some(Program { path: path.to_path_buf(), version: version.to_string() }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_tetgen_is_refused_with_advice() {
        for path in ["/bin/echo", "/nowhere/tetgen"] {
            let fault = find(Some(Path::new(path))).unwrap_err();
            assert!(fault.message.contains(path) && fault.hints[0].contains("apt-get install tetgen"));
        }
    }
}
