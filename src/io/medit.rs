//! Medit / MMG .mesh, ASCII. The format has numbers only; names stand in comments, which [`read`] takes back.

use super::mesh::{Mesh, NodeId, Tet, Triangle};
use super::names::Tags;
use super::words::Words;
use crate::diag::Diagnostic;
use crate::ids::Id;
use std::io::{self, Write};

/// Writes the mesh; references are the tags of [`Tags`], and marker 0 is kept.
///
/// # Errors
/// What the writer reports.
pub fn write(mesh: &Mesh, out: &mut dyn Write) -> io::Result<()> {
    let tags = Tags::new(mesh);
    writeln!(out, "MeshVersionFormatted 2\nDimension 3")?;
    for (tag, name) in &tags.volumes {
        writeln!(out, "# region {tag} {name}")?;
    }
    for (tag, name) in &tags.surfaces {
        writeln!(out, "# marker {tag} {name}")?;
    }
    writeln!(out, "Vertices\n{}", mesh.nodes.len())?;
    for p in &mesh.nodes {
        writeln!(out, "{:?} {:?} {:?} 0", p.x, p.y, p.z)?;
    }
    writeln!(out, "Triangles\n{}", mesh.triangles.len())?;
    for t in &mesh.triangles {
        let [a, b, c] = t.corners.map(|v| v.0 + 1);
        writeln!(out, "{a} {b} {c} {}", tags.surface(t.marker).unwrap_or(0))?;
    }
    writeln!(out, "Tetrahedra\n{}", mesh.tets.len())?;
    for t in &mesh.tets {
        let [a, b, c, d] = t.corners.map(|v| v.0 + 1);
        writeln!(out, "{a} {b} {c} {d} {}", t.region)?;
    }
    writeln!(out, "End")
}

/// Reads vertices, triangles and tetrahedra; other sections are passed over.
///
/// # Errors
/// A [`Diagnostic`] with file and line if the text is no such file.
pub fn read(file: &str, text: &str) -> Result<Mesh, Diagnostic> {
    let mut words = Words::new(file, text, Some('#'));
    let mut mesh = Mesh::default();
    let mut is_mesh = false;
    while let Some(word) = words.next_word() {
        match word {
            "MeshVersionFormatted" => is_mesh = true,
            "Dimension" if words.number::<u32>("a dimension")? != 3 => return Err(words.fault("is not three-dimensional")),
            "Vertices" => {
                let count: u64 = words.number("a count of vertices")?;
                for _ in 0..count {
                    mesh.nodes.push(words.point()?);
                    words.number::<i64>("a reference")?;
                }
            }
            "Triangles" => {
                let count: u64 = words.number("a count of triangles")?;
                for _ in 0..count {
                    let (corners, marker) = (corners(&mut words, &mesh)?, words.number("a reference")?);
                    mesh.triangles.push(Triangle { corners, marker, sides: [0, 0] });
                }
            }
            "Tetrahedra" => {
                let count: u64 = words.number("a count of tetrahedra")?;
                for _ in 0..count {
                    let (corners, region) = (corners(&mut words, &mesh)?, words.number("a reference")?);
                    mesh.tets.push(Tet { corners, region });
                }
            }
            _ => {}
        }
    }
    if !is_mesh {
        return Err(words.fault("is no Medit file: MeshVersionFormatted is missing"));
    }
    read_names(text, &mut mesh);
    mesh.orient();
    Ok(mesh)
}

fn corners<const N: usize>(words: &mut Words, mesh: &Mesh) -> Result<[NodeId; N], Diagnostic> {
    let mut corners = [NodeId(0); N];
    for c in &mut corners {
        let number: usize = words.number("a vertex number")?;
        if number == 0 || number > mesh.nodes.len() {
            return Err(words.fault(format!("vertex {number} does not exist")));
        }
        *c = NodeId::new(number - 1);
    }
    Ok(corners)
}

/// Names from comments `# region 1 iron`, as [`write()`] leaves them (the .ply and .off writers do, too).
pub(crate) fn read_names(text: &str, mesh: &mut Mesh) {
    for line in text.lines() {
        let mut words = line.trim_start_matches(['#', ' ']).split_whitespace();
        if let (true, Some(kind), Some(Ok(tag)), Some(name)) =
            (line.starts_with('#'), words.next(), words.next().map(str::parse), words.next())
        {
            match kind {
                "region" => mesh.regions.insert(tag, name.to_string()),
                "marker" => mesh.markers.insert(tag, name.to_string()),
                _ => None,
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::mesh::tests::cube;

    #[test]
    fn comes_back_whole() {
        let mesh = cube();
        let mut text = Vec::new();
        write(&mesh, &mut text).unwrap();
        assert_eq!(read("x.mesh", std::str::from_utf8(&text).unwrap()).unwrap(), mesh);
    }

    #[test]
    fn missing_vertices_are_named() {
        let text = "MeshVersionFormatted 2\nDimension 3\nVertices\n1\n0 0 0 0\nTriangles\n1\n1 2 1 0\nEnd\n";
        assert!(read("x.mesh", text).unwrap_err().message.contains("x.mesh:8: vertex 2"));
    }
}
