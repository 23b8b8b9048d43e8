//! Text to [`Scene`]: reads RON, binds names, parameters and units, and reports every fault with its place.
//!
//! Gives [`model::Scene`] to `primitive`: numbers only, in one unit; all names resolved; CSG trees over leaf solids.
//!
//! ```text
//! text ── ron, serde ──▶ ast        one type per node; every value keeps its text and so its place (source, ast, fault)
//!      ── reader ──────▶ tree       numbers: units, expressions, parameters; each named solid read once (solids, ..)
//!      ── leaves ──────▶ model      motions pushed to the leaves, equal leaves made one (place, leaves, parts)
//! ```
#![doc = include_str!("LANGUAGE.md")]

mod arcs;
mod ast;
mod curves;
mod expr;
mod fault;
mod fields;
mod foreign;
mod frames;
mod interfaces;
mod leaves;
mod memory;
pub mod model;
mod motion;
mod params;
mod parts;
mod place;
mod polyline;
mod primitives;
mod reader;
mod settings;
mod sides;
mod solids;
mod source;
mod sweeps;
#[cfg(test)]
mod tests;
mod tree;
mod units;

use crate::diag::{Diagnostic, Outcome, Span, with_line_feeds};
use leaves::{Planter, Settings};
use model::Scene;
use parts::Parts;
use reader::{Owner, Reader};
use sha2::{Digest, Sha256};
use solids::SolidReader;
use source::Raw;
use std::fmt::Write as _;
use std::io::Read as _;
use std::path::Path;
use units::Unit;

/// Stack of the thread that reads a scene: what the deepest allowed nesting takes, several times.
const STACK: usize = 256 << 20;

/// What an untrusted scene may cost.
#[derive(Clone, Debug)]
pub struct Limits {
    /// Length of the scene file in bytes (default 16 MiB).
    pub file_size: u64,
    /// Solids and operations, counting all copies (default one million).
    pub nodes: usize,
    /// Estimated memory in bytes of the divided solids (default 8e9).
    pub memory: f64,
    /// Whether imports may lie outside of the scene's folder (default no).
    pub is_outside_allowed: bool,
}

impl Default for Limits {
    fn default() -> Self {
        Self { file_size: 16 << 20, nodes: 1_000_000, memory: 8e9, is_outside_allowed: false }
    }
}

/// A scene that was read.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The scene.
    pub scene: Scene,
    /// What may not be meant.
    pub warnings: Vec<Diagnostic>,
    /// The text, for messages that show a line of it.
    pub text: String,
}

/// Reads the scene file at `path`; `overrides` are parameters (name, expression) set from outside.
///
/// Errors: all faults found, in the order of their places; those without place concern the file or the overrides.
pub fn load(path: &Path, overrides: &[(String, String)], limits: &Limits) -> Outcome<Loaded> {
    let text = read_text(path, limits).map_err(|fault| vec![fault])?;
    let name = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let folder = path.parent().unwrap_or(Path::new(""));
    let (scene, warnings) = parse(&name, folder, &text, overrides, limits)?;
    Ok(Loaded { scene, warnings, text })
}

fn read_text(path: &Path, limits: &Limits) -> Result<String, Diagnostic> {
    let fault = |code, what: &str, hint: &str| Diagnostic::error(code, what).hint(hint);
    let missing = |error: std::io::Error| {
        Diagnostic::unreadable("missing-file", path, &error).hint("a scene is a text file; `gsm new` writes one to start from")
    };
    let file = std::fs::File::open(path).map_err(missing)?;
    if let Some(fault) = foreign::told(path) {
        return Err(fault);
    }
    let mut bytes = Vec::new();
    // One byte more than allowed tells that there are too many, also for what is no regular file.
    file.take(limits.file_size + 1).read_to_end(&mut bytes).map_err(missing)?;
    if bytes.len() as u64 > limits.file_size {
        let what = format!("the file has more than {} bytes", limits.file_size);
        return Err(fault("scene-too-large", &what, "is it a scene? Repeat solids by `solids`, Linear, Polar and `copies`"));
    }
    let text = String::from_utf8(bytes).map_err(|error| {
        let good = String::from_utf8_lossy(&error.as_bytes()[..error.utf8_error().valid_up_to()]).into_owned();
        let last = good.rsplit('\n').next().unwrap_or("");
        let span = Span { line: good.matches('\n').count() as u32 + 1, column: last.chars().count() as u32 + 1 };
        fault("syntax", "the file is not UTF-8 text", "save it as UTF-8; a scene is a text in RON").at(span)
    })?;
    let text = with_line_feeds(text);
    // Some editors begin a file with a byte order mark.
    Ok(text.strip_prefix('\u{feff}').map_or_else(|| text.clone(), str::to_owned))
}

/// Reads the scene `text`; relative files are beside `folder`. Gives the scene and warnings.
///
/// Errors: as [`load`].
pub fn parse(
    name: &str,
    folder: &Path,
    text: &str,
    overrides: &[(String, String)],
    limits: &Limits,
) -> Outcome<(Scene, Vec<Diagnostic>)> {
    // On a thread of its own, because the depth of a scene costs stack.
    std::thread::scope(|scope| {
        let work = || parse_here(name, folder, text, overrides, limits);
        let thread = std::thread::Builder::new().stack_size(STACK).spawn_scoped(scope, work);
        let outcome = thread.map_err(|error| error.to_string()).and_then(|t| t.join().map_err(|_| "it ended early".into()));
        outcome
            .unwrap_or_else(|why: String| Err(vec![Diagnostic::internal("scene-thread", format!("reading the scene: {why}"))]))
    })
}

fn parse_here(
    name: &str,
    folder: &Path,
    text: &str,
    overrides: &[(String, String)],
    limits: &Limits,
) -> Outcome<(Scene, Vec<Diagnostic>)> {
    let metre = units::UNITS[0];
    let mut reader = Reader::new(text, metre);
    let whole = reader.source.whole();
    if whole.0.is_empty() {
        let hint = "a scene is Scene(units: \"mm\", parts: [..]); `gsm new` writes one to start from";
        reader.fail::<()>(whole, "no-scene", "the file holds no scene", hint);
        return Err(reader.take_faults());
    }
    let scene = reader.read::<ast::Scene>(whole).and_then(|node| {
        reader.scene_unit(&node);
        reader.load_params(node.params, overrides);
        read_scene(&mut reader, &node, folder, limits)
    });
    match scene {
        Some(scene) if !reader.has_faults() => {
            let scene = Scene { name: name.to_owned(), hash: hash(text, overrides), ..scene };
            Ok((scene, std::mem::take(&mut reader.warnings)))
        }
        _ => Err(reader.take_faults()),
    }
}

/// Metres of one unit of this name, e.g. 0.001 for `mm`; `None` for names that are no unit.
pub fn meters(unit: &str) -> Option<f64> {
    Unit::named(unit)?.convert("1", 1, Unit::named("m")?)
}

fn read_scene<'a>(reader: &mut Reader<'a>, node: &ast::Scene<'a>, folder: &Path, limits: &Limits) -> Option<Scene> {
    // The usual distance at which f64 coordinates that were meant to agree do.
    let tolerance = node.tolerance.0.map_or(Some(1e-9), |raw| reader.tolerance(raw));
    let overlap = reader.read_or(node.overlap, model::Policy::Allow);
    let gaps = reader.read_or(node.gaps, model::Policy::Allow);
    let remesh = reader.remesh(node);
    let mesh = reader.mesh(node.mesh);
    let division = node.discretization.0.map_or(Some(settings::DEFAULT_DIVISION), |raw| reader.division(raw));
    let is_triangulated = reader.read_or(node.triangulated, false);
    let unit: Unit = reader.unit;
    let owner = Owner { kind: "Scene", raw: reader.source.whole() };
    let list = reader.need(owner, "parts", node.parts);
    // Faults of the settings must not hide those of the parts.
    let settings = Settings {
        division: division.unwrap_or(settings::DEFAULT_DIVISION),
        is_triangulated: is_triangulated.unwrap_or(false),
    };
    let mut parts = Parts::new(Planter::new(limits));
    let mut solids = SolidReader::new(reader, node.solids, folder, limits.is_outside_allowed);
    let entries = list.and_then(|raw| solids.reader.read::<Vec<Raw>>(raw));
    for &raw in entries.iter().flatten() {
        parts.add(&mut solids, raw, settings);
    }
    solids.finish();
    parts.is_incomplete |= entries.is_none();
    let interfaces = interfaces::read(reader, node.interfaces, &parts);
    reader.warnings.extend(parts.planter.forecast());
    if let (Some([]), Some(raw)) = (entries.as_deref(), list) {
        let hint = "write one at least: parts: [Part(name: \"a\", solid: Block(size: (1, 1, 1)))]";
        reader.fail::<()>(raw, "no-parts", "the scene has no parts", hint);
    }
    Some(Scene {
        name: String::new(),
        unit: unit.name.to_owned(),
        hash: String::new(),
        tolerance: tolerance?,
        overlap: overlap?,
        gaps: gaps?,
        remesh: remesh?,
        mesh: mesh?,
        leaves: parts.planter.leaves,
        parts: parts.parts,
        boundaries: parts.boundaries,
        interfaces,
    })
}

/// SHA-256 of the text and the overrides, each with its length so that no two scenes are written alike.
fn hash(text: &str, overrides: &[(String, String)]) -> String {
    let mut sha = Sha256::new();
    let pieces = std::iter::once(text).chain(overrides.iter().flat_map(|(name, value)| [name.as_str(), value.as_str()]));
    for piece in pieces {
        sha.update((piece.len() as u64).to_le_bytes());
        sha.update(piece.as_bytes());
    }
    sha.finalize().iter().fold(String::new(), |mut hex, byte| {
        // Writing to a String cannot fail.
        let _ = write!(hex, "{byte:02x}");
        hex
    })
}
