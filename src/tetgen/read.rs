//! TetGen's result: `.node`, `.ele` and `.face`.

use crate::diag::Diagnostic;
use crate::ids::Id;
use crate::io::format::read_text;
use crate::io::mesh::{Mesh, NodeId, Tet, Triangle};
use crate::io::words::Words;
use std::path::Path;

/// Reads `STEM.node`, `STEM.ele` and `STEM.face`. Tetrahedra keep TetGen's order of corners; regions and markers below 0 become
/// 0.
///
/// # Errors
/// If a file is missing or damaged.
pub fn read(stem: &Path) -> Result<Mesh, Diagnostic> {
    let mut mesh = Mesh::default();
    let (nodes, first) = table(stem, "node", 3, |words, _, tags| {
        let point = words.point()?;
        skip(words, tags)?;
        Ok(point)
    })?;
    mesh.nodes = nodes.into();
    let count = mesh.nodes.len();
    (mesh.tets, _) = table(stem, "ele", 4, |words, _, tags| {
        let corners = corners(words, first, count)?;
        let region = if tags > 0 { label(words)? } else { 0 };
        skip(words, tags.saturating_sub(1))?;
        Ok(Tet { corners, region })
    })?;
    (mesh.triangles, _) = table(stem, "face", 3, |words, _, tags| {
        let corners = corners(words, first, count)?;
        let marker = if tags > 0 { label(words)? } else { 0 };
        Ok(Triangle { corners, marker, sides: [0, 0] })
    })?;
    Ok(mesh)
}

/// The rows of a file and the number of its first one. The heads are `nodes 3 attributes markers`, `tets 4 attributes` and
/// `faces markers`; a row gets how many numbers follow its corners.
fn table<T>(
    stem: &Path,
    extension: &str,
    width: u32,
    mut row: impl FnMut(&mut Words, u64, u32) -> Result<T, Diagnostic>,
) -> Result<(Vec<T>, u64), Diagnostic> {
    let path = stem.with_extension(format!("1.{extension}"));
    let text = read_text(&path)?;
    let file = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let mut words = Words::new(&file, &text, Some('#'));
    let count: u64 = words.number("a count")?;
    let head: Vec<u32> = words.rest_of_line().iter().filter_map(|w| w.parse().ok()).collect();
    let tags = match (extension, &head[..]) {
        ("face", [tags, ..]) => *tags,
        (_, [n, tags @ ..]) if *n == width => tags.iter().sum(),
        _ => return Err(words.fault("has an unknown head")),
    };
    let mut rows = Vec::new();
    let mut first = 0;
    for k in 0..count {
        let number: u64 = words.number("a row number")?;
        if k == 0 {
            first = number;
        }
        rows.push(row(&mut words, number, tags)?);
    }
    Ok((rows, first))
}

fn corners<const N: usize>(words: &mut Words, first: u64, count: usize) -> Result<[NodeId; N], Diagnostic> {
    let mut corners = [NodeId(0); N];
    for c in &mut corners {
        let number: u64 = words.number("a node number")?;
        let index = number.checked_sub(first).and_then(|k| usize::try_from(k).ok()).filter(|k| *k < count);
        *c = NodeId::new(index.ok_or_else(|| words.fault(format!("node {number} does not exist")))?);
    }
    Ok(corners)
}

/// A region or marker, which TetGen may write as a real number.
fn label(words: &mut Words) -> Result<u32, Diagnostic> {
    Ok(words.real("a label")?.max(0.0) as u32)
}

fn skip(words: &mut Words, count: u32) -> Result<(), Diagnostic> {
    (0..count).try_for_each(|_| words.real("an attribute").map(drop))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vec3;
    use crate::tetgen::child::Folder;

    #[test]
    fn one_tetrahedron() {
        let folder = Folder::new().unwrap();
        let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
        write("m.1.node", "4 3 0 0\n 1 0 0 0\n 2 1 0 0\n 3 0 1 0\n 4 0 0 1\n# by TetGen\n");
        write("m.1.ele", "1 4 1\n 1 1 2 3 4 7\n");
        write("m.1.face", "1 1\n 1 1 2 3 -5\n");
        let mesh = read(&folder.path().join("m")).unwrap();
        assert_eq!(mesh.nodes.as_slice()[3], Vec3::z());
        assert_eq!(mesh.tets, [Tet { corners: [0, 1, 2, 3].map(NodeId), region: 7 }]);
        assert_eq!(mesh.triangles[0].marker, 0);
        write("m.1.ele", "1 4 1\n 1 1 2 3 5 7\n");
        assert!(read(&folder.path().join("m")).unwrap_err().message.contains("m.1.ele:2: node 5"));
        write("m.1.ele", "2 4 1\n 1 1 2 3 4 7\n");
        assert!(read(&folder.path().join("m")).unwrap_err().message.contains("ends before"));
    }
}
