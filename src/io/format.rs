//! Which format a path means, and reading and writing whole files.

use super::manifest::Manifest;
use super::mesh::Mesh;
use super::{glb, medit, msh, ply, poly, smesh, vtu, write_obj, write_off, write_stl};
use crate::diag::{Diagnostic, with_line_feeds};
use std::fs;
use std::path::Path;

/// Largest mesh file that is read: beyond it the node numbers would not fit anyway.
const MAX_FILE_BYTES: u64 = 8 << 30;

/// What `gsm convert` reads, here and where surfaces and complexes are read.
const READ: &str = "gsm reads .msh (2.2, 4.1), .mesh, .poly, .smesh, .obj, .off and .stl";

/// A mesh file format.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Format {
    /// Gmsh 2.2, what all solvers read.
    Msh22,
    /// Gmsh 4.1.
    Msh41,
    /// VTK XML unstructured grid.
    Vtu,
    /// Medit and MMG.
    Medit,
    /// Wavefront OBJ, a group per marker.
    Obj,
    /// STL, a solid per region.
    Stl,
    /// PLY.
    Ply,
    /// Geomview OFF.
    Off,
    /// TetGen's triangulated input.
    Smesh,
    /// glTF binary, for viewers.
    Glb,
}

impl Format {
    /// The format that a file name asks for; `.msh` is 2.2.
    ///
    /// # Errors
    /// If there is none, with the list of those there are.
    pub fn of(path: &Path) -> Result<Self, Diagnostic> {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase();
        Ok(match extension.as_str() {
            "msh" => Self::Msh22,
            "vtu" => Self::Vtu,
            "mesh" => Self::Medit,
            "obj" => Self::Obj,
            "stl" => Self::Stl,
            "ply" => Self::Ply,
            "off" => Self::Off,
            "smesh" => Self::Smesh,
            "glb" => Self::Glb,
            _ => {
                return Err(Diagnostic::usage(
                    "unknown-format",
                    format!("{}: the extension names no mesh format", path.display()),
                )
                .hint("use .msh, .vtu, .mesh, .obj, .stl, .ply, .off, .smesh or .glb"));
            }
        })
    }
}

/// A mesh file's content. `meters` is the length of the mesh's unit, for formats that have one of their own.
///
/// # Errors
/// If the format cannot hold the mesh.
pub fn render(mesh: &Mesh, meters: f64, format: Format, path: &Path) -> Result<Vec<u8>, Diagnostic> {
    let mut content = Vec::new();
    let out = &mut content;
    match format {
        Format::Msh22 => msh::write_22(mesh, out),
        Format::Msh41 => msh::write_41(mesh, out),
        Format::Vtu => vtu::write(mesh, out),
        Format::Medit => medit::write(mesh, out),
        Format::Obj => write_obj::write(mesh, out),
        Format::Stl => write_stl::write(mesh, out),
        Format::Ply => ply::write(mesh, out),
        Format::Off => write_off::write(mesh, out),
        Format::Smesh => smesh::write(mesh, out),
        Format::Glb => glb::write(mesh, meters, out),
    }
    .map_err(|e| {
        Diagnostic::error("cannot-write", format!("{}: {e}", path.display()))
            .hint("choose another format; .msh and .vtu hold everything")
    })?;
    Ok(content)
}

/// The manifest that stands beside a file of this content: a complex has to have as many facets as it says.
///
/// # Errors
/// An internal error, if the content is not of its format.
pub fn manifest_of(manifest: Manifest, format: Format, content: &[u8]) -> Result<Manifest, Diagnostic> {
    if format != Format::Smesh {
        return Ok(manifest);
    }
    Ok(manifest.recounted(&poly::parse(&String::from_utf8_lossy(content), None, true)?))
}

/// Reads a mesh file: MSH 2.2 and 4.1, Medit.
///
/// # Errors
/// If the format is not one of these, the file cannot be read, or it is damaged.
pub fn load(path: &Path) -> Result<Mesh, Diagnostic> {
    let file = path.display().to_string();
    let read = match Format::of(path) {
        Ok(Format::Msh22 | Format::Msh41) => msh::read,
        Ok(Format::Medit) => medit::read,
        Ok(_) => return Err(Diagnostic::usage("unreadable-format", format!("{file}: this format is only written")).hint(READ)),
        Err(fault) => return Err(Diagnostic { hints: vec![READ.to_owned()], ..fault }),
    };
    read(&file, &read_text(path)?)
}

/// A regular file's text, up to the size limit.
pub(crate) fn read_text(path: &Path) -> Result<String, Diagnostic> {
    let fault = |what: String| {
        Diagnostic::error("not-read", format!("{}: {what}", path.display()))
            .hint("give the path of a mesh file that can be read")
    };
    let unreadable = |e| Diagnostic::unreadable("not-read", path, &e).hint("give the path of a mesh file");
    let meta = fs::metadata(path).map_err(unreadable)?;
    if !meta.is_file() && !meta.is_dir() {
        return Err(fault("is no regular file".into()));
    }
    if meta.len() > MAX_FILE_BYTES {
        return Err(fault(format!("has {} bytes, more than {MAX_FILE_BYTES}", meta.len())));
    }
    fs::read_to_string(path).map(with_line_feeds).map_err(unreadable)
}
