//! PLY, ASCII: triangles with the properties `marker`, `front` and `behind` (regions at their sides); names in comments.

use super::mesh::Mesh;
use std::io::{self, Write};

/// Writes the triangles.
///
/// # Errors
/// What the writer reports.
pub fn write(mesh: &Mesh, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "ply\nformat ascii 1.0")?;
    for (kind, names) in [("region", &mesh.regions), ("marker", &mesh.markers)] {
        for number in names.keys() {
            writeln!(out, "comment {kind} {number} {}", super::names::name_of(names, *number, kind))?;
        }
    }
    writeln!(out, "element vertex {}", mesh.nodes.len())?;
    writeln!(out, "property double x\nproperty double y\nproperty double z")?;
    writeln!(out, "element face {}\nproperty list uchar int vertex_indices", mesh.triangles.len())?;
    writeln!(out, "property int marker\nproperty int front\nproperty int behind\nend_header")?;
    for p in &mesh.nodes {
        writeln!(out, "{:?} {:?} {:?}", p.x, p.y, p.z)?;
    }
    for t in &mesh.triangles {
        let ([a, b, c], [front, behind]) = (t.corners.map(|v| v.0), t.sides);
        writeln!(out, "3 {a} {b} {c} {} {front} {behind}", t.marker)?;
    }
    Ok(())
}
