//! Geomview OFF: triangles; names and markers have no place in the format but comments.

use super::mesh::Mesh;
use std::io::{self, Write};

/// The comment that gives a marker its name, up to the marker.
pub(super) const MARKER: &str = "# marker ";
/// The comment before the first triangle of a marker, up to the marker.
pub(super) const FROM_HERE: &str = "# from here marker ";

/// Writes the triangles in marker order; a comment stands before each marker's first one.
///
/// # Errors
/// What the writer reports.
pub fn write(mesh: &Mesh, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "OFF")?;
    super::smesh::write_name_comments(mesh, out)?;
    writeln!(out, "{} {} 0", mesh.nodes.len(), mesh.triangles.len())?;
    for p in &mesh.nodes {
        writeln!(out, "{:?} {:?} {:?}", p.x, p.y, p.z)?;
    }
    let mut triangles: Vec<_> = mesh.triangles.iter().collect();
    triangles.sort_by_key(|t| t.marker);
    let mut last = None;
    for t in triangles {
        if last.replace(t.marker) != Some(t.marker) {
            writeln!(out, "{FROM_HERE}{}", t.marker)?;
        }
        let [a, b, c] = t.corners.map(|v| v.0);
        writeln!(out, "3 {a} {b} {c}")?;
    }
    Ok(())
}
