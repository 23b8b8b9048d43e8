//! What all commands share: where output goes, how diagnostics look, exit codes.

use crate::cli::{Changes, Common, Remesh};
use crate::diag::{Diagnostic, Severity, with_line_feeds};
use crate::pipeline::Overrides;
use crate::report::diagnostics::{self, Style};
use crate::report::timing::{Listener, Timings};
use crate::scene::model::RemeshMode;
use serde::Serialize;
use std::io::{self, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, OnceLock};
use std::time::{Duration, Instant};

/// Longest scene text that is read again to show a line of it.
const MAX_SHOWN_TEXT: u64 = 16 << 20;
/// Runs shorter than this show no progress: a flicker tells nobody anything.
const QUIET_TIME: Duration = Duration::from_millis(400);

/// How a command ended; the process's exit code.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub enum Exit {
    /// Good.
    Good = 0,
    /// The model, or a file, is wrong.
    Wrong = 1,
    /// The arguments are wrong.
    Usage = 2,
    /// A quality threshold was missed.
    Quality = 3,
    /// An outside program failed.
    Outside = 4,
    /// A fault of gsm itself.
    Internal = 70,
}

impl Exit {
    /// The exit that the worst diagnostic asks for.
    pub fn of(diagnostics: &[Diagnostic]) -> Self {
        match diagnostics.iter().map(|d| d.severity).max() {
            Some(Severity::Internal) => Self::Internal,
            Some(Severity::Error) => Self::Wrong,
            Some(Severity::Usage) => Self::Usage,
            _ => Self::Good,
        }
    }
}

/// Standard output and what decides how it is used.
pub struct Session<'a> {
    /// For what was asked.
    pub out: &'a mut dyn Write,
    /// Options of every command.
    pub common: &'a Common,
    /// What standard error has been told already.
    told: Arc<Mutex<Vec<Diagnostic>>>,
}

impl<'a> Session<'a> {
    /// With nothing told yet.
    pub fn new(out: &'a mut dyn Write, common: &'a Common) -> Self {
        Self { out, common, told: Arc::default() }
    }

    /// Sets the number of threads, before the first parallel stage.
    pub fn set_threads(&self) {
        if let Some(n) = self.common.threads {
            // It fails only if the pool exists already (several commands in one test process): then it stays as it is.
            drop(rayon::ThreadPoolBuilder::new().num_threads(n.get()).build_global());
        }
    }

    /// Where the pipeline tells the stage that begins.
    pub fn progress(&self) -> Option<fn(&str)> {
        (!self.common.quiet && !self.common.json && io::stderr().is_terminal()).then_some(show_progress as fn(&str))
    }

    /// Timings that show progress and tell warnings as soon as they are found; `file` is the one that spans refer to.
    pub fn timings(&self, file: &Path) -> Timings {
        let (told, file) = (self.told.clone(), file.to_path_buf());
        let hear = move |warnings: &[Diagnostic]| {
            complain(warnings, &file, "");
            if let Ok(mut told) = told.lock() {
                told.extend_from_slice(warnings);
            }
        };
        let is_heard = !self.common.quiet && !self.common.json;
        Timings { on_begin: self.progress(), on_warning: is_heard.then(|| Listener(Arc::new(hear))), ..Timings::default() }
    }

    /// Whether somebody who reads standard output has read this one on standard error already.
    pub fn is_seen(&self, diagnostic: &Diagnostic) -> bool {
        let is_told = || self.told.lock().is_ok_and(|told| told.contains(diagnostic));
        io::stdout().is_terminal() && io::stderr().is_terminal() && is_told()
    }

    /// Writes diagnostics to standard error that are not there yet; `file` is the one that spans refer to.
    pub fn complain(&self, diagnostics: &[Diagnostic], file: &Path, unit: &str) {
        let told = self.told.lock().map_or_else(|_| Vec::new(), |told| told.clone());
        let is_new = |d: &&Diagnostic| !told.contains(d) && (!self.common.quiet || d.severity > Severity::Warning);
        complain(&diagnostics.iter().filter(is_new).cloned().collect::<Vec<_>>(), file, unit);
    }

    /// Writes what a command found out about a file, and what there is to tell about it, as JSON.
    ///
    /// # Errors
    /// Those of standard output.
    pub fn json(&mut self, file: &Path, told: &[Diagnostic], result: &impl Serialize) -> io::Result<()> {
        json(&mut *self.out, Some(file), told, result)
    }

    /// Tells why a command failed on a file: for scripts on standard output, else as [`Self::complain`] does.
    ///
    /// # Errors
    /// Those of standard output.
    pub fn fail(&mut self, faults: &[Diagnostic], file: &Path, unit: &str) -> io::Result<()> {
        if self.common.json {
            return self.json(file, faults, &serde_json::Map::new());
        }
        self.complain(faults, file, unit);
        Ok(())
    }
}

/// What scripts are told, the same for all commands.
#[derive(Serialize)]
struct Told<'a, T> {
    /// The file that it is about; none if the arguments were not understood.
    file: Option<String>,
    /// Empty exactly if the exit code is 0.
    errors: Vec<&'a Diagnostic>,
    warnings: Vec<&'a Diagnostic>,
    /// What the command found out; nothing if it failed.
    #[serde(flatten)]
    result: &'a T,
}

/// Writes what there is to tell as indented JSON.
///
/// # Errors
/// Those of `out`.
pub fn json(out: &mut dyn Write, file: Option<&Path>, told: &[Diagnostic], result: &impl Serialize) -> io::Result<()> {
    let (warnings, errors) = told.iter().partition(|d| d.severity == Severity::Warning);
    let told = Told { file: file.map(|f| f.display().to_string()), errors, warnings, result };
    serde_json::to_writer_pretty(&mut *out, &told)?;
    out.write_all(b"\n")
}

/// The fault of writing over the file that is read.
pub fn overwriting(input: &Path, outputs: &[PathBuf]) -> Option<Diagnostic> {
    let input = std::fs::canonicalize(input).ok()?;
    let same = outputs.iter().find(|output| std::fs::canonicalize(output).is_ok_and(|o| o == input))?;
    let message = format!("{} is the file that is read: it would be overwritten", same.display());
    Some(Diagnostic::usage("same-file", message).hint("name another file to write to"))
}

/// The fault of writing two outputs to one file.
pub fn written_twice(outputs: &[PathBuf]) -> Option<Diagnostic> {
    let (_, twice) = outputs.iter().enumerate().find(|&(k, output)| outputs[..k].contains(output))?;
    let message = format!("{} is named twice: one output would replace the other", twice.display());
    Some(Diagnostic::usage("same-file", message).hint("name each file once"))
}

/// The fault of writing into a folder that is not there.
pub fn missing_folder(outputs: &[PathBuf]) -> Option<Diagnostic> {
    let folders = outputs.iter().filter_map(|output| output.parent()).filter(|folder| !folder.as_os_str().is_empty());
    let folder = folders.into_iter().find(|folder| !folder.is_dir())?;
    let message = format!("cannot write into {}: there is no such folder", folder.display());
    Some(Diagnostic::error("cannot-write", message).hint("create it, or choose another place"))
}

/// Writes diagnostics to standard error.
fn complain(diagnostics: &[Diagnostic], file: &Path, unit: &str) {
    let text = source_for(diagnostics, file);
    let is_coloured = io::stderr().is_terminal() && is_colour_wanted();
    let name = file.display().to_string();
    let style = Style { file: &name, text: text.as_deref(), unit, is_coloured };
    let mut err = io::stderr().lock();
    for d in diagnostics {
        // Nobody is left to tell if standard error is closed.
        drop(err.write_all(diagnostics::render(d, &style).as_bytes()));
    }
}

/// What the command line changes in a scene, for the pipeline.
pub fn overrides(changes: &Changes) -> Overrides<'_> {
    let mode = |remesh| match remesh {
        Remesh::Full => RemeshMode::Full,
        Remesh::Interfaces => RemeshMode::Interfaces,
        Remesh::Off => RemeshMode::Off,
    };
    Overrides { set: &changes.set, remesh: changes.remesh.map(mode) }
}

/// Colours are wanted unless the user says no (no-color.org).
pub fn is_colour_wanted() -> bool {
    std::env::var_os("NO_COLOR").is_none_or(|v| v.is_empty())
}

/// The text of the file, if a diagnostic points into it.
pub fn source_for(diagnostics: &[Diagnostic], file: &Path) -> Option<String> {
    diagnostics.iter().find(|d| d.span.is_some())?;
    let is_small = std::fs::metadata(file).is_ok_and(|m| m.is_file() && m.len() <= MAX_SHOWN_TEXT);
    if is_small { std::fs::read_to_string(file).ok().map(with_line_feeds) } else { None }
}

fn show_progress(stage: &str) {
    static START: OnceLock<Instant> = OnceLock::new();
    if START.get_or_init(Instant::now).elapsed() > QUIET_TIME {
        let mut err = io::stderr().lock();
        // Overwritten by the next one; erased by whatever is written next.
        drop(write!(err, "\r\x1b[K{stage} ...\r"));
        drop(err.flush());
    }
}
