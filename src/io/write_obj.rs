//! Wavefront OBJ: one group per marker, each triangle once.

use super::mesh::Mesh;
use super::names::name_of;
use std::collections::BTreeMap;
use std::io::{self, Write};

/// Writes the triangles.
///
/// # Errors
/// What the writer reports.
pub fn write(mesh: &Mesh, out: &mut dyn Write) -> io::Result<()> {
    for p in &mesh.nodes {
        writeln!(out, "v {:?} {:?} {:?}", p.x, p.y, p.z)?;
    }
    let mut groups: BTreeMap<u32, Vec<_>> = BTreeMap::new();
    for t in &mesh.triangles {
        groups.entry(t.marker).or_default().push(t);
    }
    for (marker, triangles) in groups {
        writeln!(out, "g {}", name_of(&mesh.markers, marker, "marker"))?;
        for t in triangles {
            let [a, b, c] = t.corners.map(|v| v.0 + 1);
            writeln!(out, "f {a} {b} {c}")?;
        }
    }
    Ok(())
}
