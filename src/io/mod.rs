//! Files: one module per format, all with the names of regions and markers, and safe writing.
//!
//! [`mesh::Mesh`] is what mesh files carry: the volume mesh that comes back from TetGen, or the triangulated surface of a
//! complex. Readers of imported surfaces yield a [`PolygonMesh`]; they trust nothing that a file declares.

pub mod atomic;
pub mod format;
pub mod glb;
pub mod manifest;
pub mod medit;
pub mod mesh;
pub mod msh;
pub mod names;
pub mod obj;
pub mod off;
pub mod ply;
pub mod poly;
pub mod smesh;
pub mod stl;
pub mod vtu;
pub mod words;
pub mod write_obj;
pub mod write_off;
pub mod write_stl;

use crate::diag::{Diagnostic, with_line_feeds};
use crate::geom::lists::Lists;
use std::borrow::Cow;
use std::collections::HashMap;
use std::path::Path;

/// Largest surface file: what is longer has more facets than a leaf may have (STL takes some 250 bytes for one as text, 50 as
/// binary; other formats less than 100).
const MAX_FILE_BYTES: u64 = 3 << 30;

/// Polygons over numbered points, as a file gives them: nothing is welded, checked or oriented.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct PolygonMesh {
    /// Points, finite, in the file's unit.
    pub points: Vec<[f64; 3]>,
    /// Point numbers of each polygon, all in range, at least three.
    pub polygons: Lists,
    /// For each polygon, its group.
    pub group_of: Vec<u32>,
    /// Names of the groups; a file without groups has one, `surface`.
    pub groups: Vec<String>,
}

/// The names of a file's groups in the order in which they come, while it is read.
#[derive(Default)]
struct Groups {
    names: Vec<String>,
    /// Looked up only: files may have as many groups as facets.
    numbers: HashMap<String, u32>,
}

impl Groups {
    /// The number of the group of this name, which is added if there is none.
    fn called(&mut self, name: &str) -> u32 {
        if let Some(number) = self.numbers.get(name) {
            return *number;
        }
        let number = self.names.len() as u32;
        self.names.push(name.into());
        self.numbers.insert(name.into(), number);
        number
    }
}

/// The format of a surface file.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum SurfaceFormat {
    /// Wavefront, `.obj`.
    Obj,
    /// Geomview, `.off`.
    Off,
    /// Stereolithography, `.stl`, text or binary: coordinates are single precision and every triangle has its own points.
    Stl,
}

impl SurfaceFormat {
    /// As messages call it.
    pub(crate) fn told(self) -> &'static str {
        match self {
            Self::Obj => "a Wavefront .obj",
            Self::Off => "a Geomview .off",
            Self::Stl => "an .stl, text or binary",
        }
    }

    /// By the file name's extension.
    pub fn of(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "obj" => Some(Self::Obj),
            "off" => Some(Self::Off),
            "stl" => Some(Self::Stl),
            _ => None,
        }
    }
}

/// Reads a surface file; the format goes by the extension.
///
/// # Errors
/// If the file is missing, too long, of an unknown format or malformed, with its name and line.
pub fn read_surface(path: &Path) -> Result<PolygonMesh, Diagnostic> {
    let name = path.display();
    let Some(format) = SurfaceFormat::of(path) else {
        return Err(
            Diagnostic::error("unknown-format", format!("{name}: unknown kind of surface file")).hint("use .obj, .off or .stl")
        );
    };
    let cannot = |e: std::io::Error| Diagnostic::unreadable("unreadable-file", path, &e).hint("give the path of a surface");
    let length = std::fs::metadata(path).map_err(cannot)?.len();
    if length > MAX_FILE_BYTES {
        let fault = Diagnostic::error("too-large-file", format!("{name}: {length} bytes, more than {MAX_FILE_BYTES}"));
        return Err(fault.hint("reduce the surface before it is imported"));
    }
    let bytes = std::fs::read(path).map_err(cannot)?;
    let mesh = match format {
        SurfaceFormat::Obj => obj::read(&as_text(&bytes)),
        SurfaceFormat::Off => off::read(&as_text(&bytes)),
        SurfaceFormat::Stl => stl::read(&bytes),
    };
    mesh.map_err(|e| {
        let fault = Diagnostic::error("malformed-file", e.in_file(path));
        fault.hint(format!("is it really {}? Export it again, or correct that line", format.told()))
    })
}

/// The bytes of a text with line feeds between its lines; copied only where they have to be changed.
fn as_text(bytes: &[u8]) -> Cow<'_, str> {
    // Some programs begin a text with a byte order mark.
    let bytes = bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(bytes);
    // Nearly all files are good; those are checked in a fraction of the time.
    let text = str::from_utf8(bytes).map_or_else(|_| String::from_utf8_lossy(bytes), Cow::Borrowed);
    if text.contains('\r') { Cow::Owned(with_line_feeds(text.into_owned())) } else { text }
}

/// What is wrong with a file.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct FormatError {
    /// Line, from 1; 0 if not known.
    pub line: usize,
    /// What is wrong.
    pub message: String,
}

impl FormatError {
    pub(crate) fn new(line: usize, message: impl Into<String>) -> Self {
        Self { line, message: message.into() }
    }
    /// `file:line: message`.
    fn in_file(&self, path: &Path) -> String {
        match self.line {
            0 => format!("{}: {}", path.display(), self.message),
            line => format!("{}:{line}: {}", path.display(), self.message),
        }
    }
}

/// Three coordinates from the words of a line.
pub(crate) fn coordinates<'a>(mut words: impl Iterator<Item = &'a str>, line: usize) -> Result<[f64; 3], FormatError> {
    let mut point = [0f64; 3];
    for x in &mut point {
        let word = words.next().ok_or_else(|| FormatError::new(line, "three coordinates are expected"))?;
        *x = word.parse().map_err(|_| FormatError::new(line, format!("'{word}' is not a number")))?;
        if !x.is_finite() {
            return Err(FormatError::new(line, format!("coordinate '{word}' is not finite")));
        }
    }
    Ok(point)
}
