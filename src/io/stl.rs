//! Stereolithography, text or binary: triangles, each with its own points. The solids of a text are groups by their names.

use super::{FormatError, Groups, PolygonMesh, as_text, coordinates};

/// Bytes before the triangles of a binary file, the last four being their number.
const HEADER: usize = 84;
/// Bytes of a binary triangle: normal, three points, attribute.
const TRIANGLE: usize = 50;
/// The group of triangles whose solid has no name.
const UNNAMED: &str = "surface";

/// Reads the bytes of an STL file. A file is binary if its length is what its triangle count says, whatever its header claims.
///
/// # Errors
/// Text: with the line. Binary: if its length is not what its count says.
pub fn read(bytes: &[u8]) -> Result<PolygonMesh, FormatError> {
    let mut mesh = PolygonMesh::default();
    let declared = bytes.get(80..HEADER).and_then(|b| b.try_into().ok()).map(|b| u32::from_le_bytes(b) as usize);
    let is_binary = declared.is_some_and(|n| n.checked_mul(TRIANGLE).and_then(|l| l.checked_add(HEADER)) == Some(bytes.len()));
    if is_binary {
        read_binary(&bytes[HEADER..], &mut mesh)?;
    } else if bytes.trim_ascii_start().starts_with(b"solid") && !bytes.contains(&0) {
        read_text(&as_text(bytes), &mut mesh)?;
    } else {
        let message = match declared {
            Some(n) if bytes.contains(&0) => {
                format!("a binary STL of {n} triangles does not have {} bytes: is it cut off?", bytes.len())
            }
            _ => "neither a text nor a binary STL".into(),
        };
        return Err(FormatError::new(0, message));
    }
    if mesh.groups.is_empty() {
        mesh.groups.push(UNNAMED.into());
    }
    Ok(mesh)
}

fn read_binary(bytes: &[u8], mesh: &mut PolygonMesh) -> Result<(), FormatError> {
    for (k, triangle) in bytes.chunks_exact(TRIANGLE).enumerate() {
        let first = mesh.points.len() as u32;
        for corner in triangle[12..48].chunks_exact(12) {
            let x = |i: usize| f64::from(f32::from_le_bytes([corner[i], corner[i + 1], corner[i + 2], corner[i + 3]]));
            let point = [x(0), x(4), x(8)];
            if point.iter().any(|c| !c.is_finite()) {
                return Err(FormatError::new(0, format!("triangle {k} has a coordinate that is not finite")));
            }
            mesh.points.push(point);
        }
        mesh.polygons.push([first, first + 1, first + 2]);
        mesh.group_of.push(0);
    }
    Ok(())
}

fn read_text(text: &str, mesh: &mut PolygonMesh) -> Result<(), FormatError> {
    let (mut corners, mut name, mut groups) = (0, UNNAMED, Groups::default());
    // The group of the present solid, once it has a facet.
    let mut group = None;
    for (k, line) in text.lines().enumerate() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("vertex") => {
                mesh.points.push(coordinates(words, k + 1)?);
                corners += 1;
            }
            Some("endfacet") => {
                if corners != 3 {
                    return Err(FormatError::new(k + 1, format!("a facet has {corners} vertices instead of 3")));
                }
                corners = 0;
                let end = mesh.points.len() as u32;
                mesh.polygons.push([end - 3, end - 2, end - 1]);
                let number = group.unwrap_or_else(|| groups.called(name));
                mesh.group_of.push(number);
                group = Some(number);
            }
            Some("solid") => {
                let rest = line.trim_ascii_start()["solid".len()..].trim();
                (name, group) = (if rest.is_empty() { UNNAMED } else { rest }, None);
            }
            Some("facet" | "outer" | "endloop" | "endsolid") | None => {}
            Some(word) => return Err(FormatError::new(k + 1, format!("unknown keyword '{word}'"))),
        }
    }
    mesh.groups = groups.names;
    if corners != 0 { Err(FormatError::new(0, "the file ends within a facet")) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FACET: &str =
        "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1.5 0\nendloop\nendfacet\nendsolid a\n";

    #[test]
    fn text_and_binary_agree() {
        let text = read(FACET.as_bytes()).unwrap();
        let mut bytes = b"solid, says a lying header".to_vec();
        bytes.resize(80, b' ');
        bytes.extend(1u32.to_le_bytes());
        let numbers = [0f32, 0., 1., 0., 0., 0., 1., 0., 0., 0., 1.5, 0.];
        bytes.extend(numbers.iter().flat_map(|x| x.to_le_bytes()));
        bytes.extend([0, 0]);
        let binary = read(&bytes).unwrap();
        assert_eq!((&binary.points, &binary.polygons), (&text.points, &text.polygons));
        assert_eq!((&binary.groups[..], &text.groups[..]), (&["surface".to_string()][..], &["a".to_string()][..]));
        assert_eq!(text.points[2], [0.0, 1.5, 0.0]);
        bytes.pop();
        // A header that lies, on a file that is cut off.
        assert!(read(&bytes).unwrap_err().message.contains("does not have"));
        assert!(read(&bytes[1..]).unwrap_err().message.contains("does not have"));
    }

    #[test]
    fn solids_are_groups_by_their_names() {
        let named = |name: &str| FACET.replace(" a\n", name);
        let text = [named(" base plate\n"), named("\n"), named(" base plate\n"), FACET.to_string()].concat();
        let mesh = read(text.as_bytes()).unwrap();
        assert_eq!(
            (mesh.groups, mesh.group_of),
            (["base plate", "surface", "a"].map(str::to_owned).to_vec(), vec![0, 1, 0, 2])
        );
    }

    #[test]
    fn faults_name_their_line() {
        assert_eq!(read(FACET.replace("1.5", "inf").as_bytes()).unwrap_err().line, 6);
        assert_eq!(read(FACET.replace("vertex 1 0 0\n", "").as_bytes()).unwrap_err().line, 7);
    }
}
