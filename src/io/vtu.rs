//! VTK XML unstructured grid (ParaView, meshio), ASCII: tetrahedra, then triangles.
//!
//! Cell data `region` (0 on triangles) and `marker` (0 on tetrahedra). Each name is an array of the file's field data that
//! holds its number and dimension, the convention of meshio's `field_data`.

use super::mesh::Mesh;
use super::names::Tags;
use std::fmt::Display;
use std::io::{self, Write};

/// VTK cell types.
const TRIANGLE: u8 = 5;
const TETRAHEDRON: u8 = 10;

/// Writes the mesh.
///
/// # Errors
/// What the writer reports.
pub fn write(mesh: &Mesh, out: &mut dyn Write) -> io::Result<()> {
    let tags = Tags::new(mesh);
    let (tets, triangles) = (mesh.tets.len(), mesh.triangles.len());
    writeln!(out, r#"<?xml version="1.0"?>"#)?;
    writeln!(out, r#"<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian">"#)?;
    writeln!(out, "<UnstructuredGrid>\n<FieldData>")?;
    for (dimension, names) in [(2, &tags.surfaces), (3, &tags.volumes)] {
        for (tag, name) in names {
            let name = escaped(name);
            writeln!(
                out,
                r#"<DataArray type="Int32" Name="{name}" NumberOfTuples="2" format="ascii">{tag} {dimension}</DataArray>"#
            )?;
        }
    }
    writeln!(out, "</FieldData>")?;
    writeln!(out, r#"<Piece NumberOfPoints="{}" NumberOfCells="{}">"#, mesh.nodes.len(), tets + triangles)?;
    writeln!(out, "<Points>\n{}", open("Float64", "Points", 3))?;
    for p in &mesh.nodes {
        writeln!(out, "{:?} {:?} {:?}", p.x, p.y, p.z)?;
    }
    writeln!(out, "</DataArray>\n</Points>\n<Cells>\n{}", open("Int64", "connectivity", 1))?;
    for t in &mesh.tets {
        let [a, b, c, d] = t.corners.map(|v| v.0);
        writeln!(out, "{a} {b} {c} {d}")?;
    }
    for t in &mesh.triangles {
        let [a, b, c] = t.corners.map(|v| v.0);
        writeln!(out, "{a} {b} {c}")?;
    }
    writeln!(out, "</DataArray>")?;
    let offsets = (1..=tets).map(|k| 4 * k).chain((1..=triangles).map(|k| 4 * tets + 3 * k));
    write_column("Int64", "offsets", offsets, out)?;
    let types = std::iter::repeat_n(TETRAHEDRON, tets).chain(std::iter::repeat_n(TRIANGLE, triangles));
    write_column("UInt8", "types", types, out)?;
    writeln!(out, "</Cells>\n<CellData Scalars=\"region\">")?;
    let regions = mesh.tets.iter().map(|t| t.region).chain(std::iter::repeat_n(0, triangles));
    write_column("Int32", "region", regions, out)?;
    let markers = mesh.triangles.iter().map(|t| tags.surface(t.marker).unwrap_or(0));
    write_column("Int32", "marker", std::iter::repeat_n(0, tets).chain(markers), out)?;
    writeln!(out, "</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>")
}

fn open(kind: &str, name: &str, components: u8) -> String {
    format!(r#"<DataArray type="{kind}" Name="{name}" NumberOfComponents="{components}" format="ascii">"#)
}

fn write_column<T: Display>(kind: &str, name: &str, items: impl Iterator<Item = T>, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, r#"<DataArray type="{kind}" Name="{name}" format="ascii">"#)?;
    for item in items {
        writeln!(out, "{item}")?;
    }
    writeln!(out, "</DataArray>")
}

fn escaped(name: &str) -> String {
    name.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
