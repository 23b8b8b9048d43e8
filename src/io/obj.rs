//! Wavefront OBJ through `tobj`, in double precision. Objects and groups (`o`, `g`) become named sides; materials, normals
//! and texture coordinates are passed over.

use super::{FormatError, Groups, PolygonMesh, coordinates};
use tobj::{LoadError, LoadOptions};

/// Reads the text of an OBJ file.
///
/// # Errors
/// With the line where it can be found: bad numbers, point numbers out of range, no polygon at all.
pub fn read(text: &str) -> Result<PolygonMesh, FormatError> {
    let options = LoadOptions { ignore_points: true, ignore_lines: true, ..Default::default() };
    let (models, _) = tobj::load_obj_buf(&mut text.as_bytes(), &options, |_| Err(LoadError::OpenFileFailed))
        .map_err(|e| locate(text).unwrap_or_else(|| FormatError::new(0, e.to_string())))?;
    let (mut mesh, mut groups) = (PolygonMesh::default(), Groups::default());
    for model in &models {
        let base = mesh.points.len();
        if base + model.mesh.positions.len() / 3 > u32::MAX as usize {
            return Err(FormatError::new(0, "too many points"));
        }
        for p in model.mesh.positions.chunks_exact(3) {
            if p.iter().any(|x| !x.is_finite()) {
                return Err(locate(text).unwrap_or_else(|| FormatError::new(0, "a coordinate is not finite")));
            }
            mesh.points.push([p[0], p[1], p[2]]);
        }
        let group = groups.called(&model.name);
        let mut indices = model.mesh.indices.iter().map(|i| i + base as u32);
        // tobj gives no sizes if all are triangles.
        let sizes = &model.mesh.face_arities;
        let count = if sizes.is_empty() { model.mesh.indices.len() / 3 } else { sizes.len() };
        for k in 0..count {
            let size = sizes.get(k).map_or(3, |s| *s as usize);
            let polygon = indices.by_ref().take(size);
            if size >= 3 {
                mesh.polygons.push(polygon);
                mesh.group_of.push(group);
            } else {
                polygon.for_each(drop);
            }
        }
    }
    mesh.groups = groups.names;
    if let [only] = &mut mesh.groups[..]
        && only == tobj_default_name()
    {
        *only = "surface".into();
    }
    Ok(mesh)
}

/// The name that tobj gives to faces before any `o` or `g`.
fn tobj_default_name() -> &'static str {
    "unnamed_object"
}

/// The first line that cannot be right, which tobj does not tell.
fn locate(text: &str) -> Option<FormatError> {
    let mut points = 0i64;
    for (k, line) in text.lines().enumerate() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => match coordinates(words, k + 1) {
                Ok(_) => points += 1,
                Err(e) => return Some(e),
            },
            Some("f") => {
                for word in words {
                    let number = word.split('/').next().unwrap_or("").parse::<i64>();
                    let is_known = number.as_ref().is_ok_and(|&n| n != 0 && n <= points && -n <= points);
                    if !is_known {
                        return Some(FormatError::new(k + 1, format!("'{word}' is not one of the {points} points before it")));
                    }
                }
            }
            _ => {}
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    const TETRAHEDRON: &str = "mtllib none.mtl\nv 0 0 0\nv 0.1 0 0\nv 0 1 0\nv 0 0 1\ng base\nf 1 3 2\ng walls\nusemtl red\nf 1/1/1 2/1/1 4\nf 1 -1 3\nf 2 3 4\n";

    #[test]
    fn groups_become_sides_in_double_precision() {
        let text = TETRAHEDRON.to_string();
        let mesh = read(&text).unwrap();
        assert_eq!(mesh.groups, ["base", "walls"]);
        assert_eq!(mesh.group_of, [0, 1, 1, 1]);
        assert!(mesh.points.contains(&[0.1, 0.0, 0.0]));
        let plain = read("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n").unwrap();
        assert_eq!((&plain.groups[..], plain.polygons.of(0)), (&["surface".to_string()][..], &[0, 1, 2, 3][..]));
    }

    #[test]
    fn faults_name_their_line() {
        assert_eq!(read(&TETRAHEDRON.replace("f 2 3 4", "f 2 3 9")).unwrap_err().line, 12);
        assert_eq!(read(&TETRAHEDRON.replace("v 0 1 0", "v 0 x 0")).unwrap_err().line, 4);
        assert_eq!(read(&TETRAHEDRON.replace("v 0 1 0", "v 0 inf 0")).unwrap_err().line, 4);
    }
}
