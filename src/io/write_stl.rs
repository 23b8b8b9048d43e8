//! STL, ASCII: one `solid` per region, closed, its normals outwards; so an interface stands in both its regions' solids. A
//! surface without regions is one `solid` per marker.

use super::mesh::{Mesh, Triangle};
use super::names::name_of;
use crate::geom::Vec3;
use std::collections::BTreeMap;
use std::io::{self, Write};

/// Writes the solids. Numbers keep all digits, so that equal vertices stay equal.
///
/// # Errors
/// What the writer reports.
pub fn write(mesh: &Mesh, out: &mut dyn Write) -> io::Result<()> {
    for (name, triangles) in solids(mesh) {
        writeln!(out, "solid {name}")?;
        for [a, b, c] in triangles {
            let normal = (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_default();
            writeln!(out, "facet normal {}\nouter loop", text(normal))?;
            for p in [a, b, c] {
                writeln!(out, "vertex {}", text(p))?;
            }
            writeln!(out, "endloop\nendfacet")?;
        }
        writeln!(out, "endsolid {name}")?;
    }
    Ok(())
}

/// The triangles of each solid, by its name.
fn solids(mesh: &Mesh) -> Vec<(String, Vec<[Vec3; 3]>)> {
    let mut solids = Vec::new();
    for (region, triangles) in by_region(mesh) {
        if region != 0 {
            solids.push((name_of(&mesh.regions, region, "region"), triangles));
        }
    }
    let mut markers: BTreeMap<u32, Vec<[Vec3; 3]>> = BTreeMap::new();
    for t in mesh.triangles.iter().filter(|t| t.sides == [0, 0]) {
        markers.entry(t.marker).or_default().push(mesh.triangle_points(t));
    }
    solids.extend(markers.into_iter().map(|(marker, triangles)| (name_of(&mesh.markers, marker, "marker"), triangles)));
    solids
}

fn text(p: Vec3) -> String {
    format!("{:?} {:?} {:?}", p.x, p.y, p.z)
}

/// The triangles around each region, counter-clockwise seen from outside; of triangles without regions, all under 0.
pub(crate) fn by_region(mesh: &Mesh) -> BTreeMap<u32, Vec<[Vec3; 3]>> {
    let mut regions: BTreeMap<u32, Vec<[Vec3; 3]>> = BTreeMap::new();
    for t in &mesh.triangles {
        let [a, b, c] = mesh.triangle_points(t);
        let &Triangle { sides: [front, behind], .. } = t;
        if front != 0 {
            regions.entry(front).or_default().push([a, c, b]);
        }
        if behind != 0 || front == 0 {
            regions.entry(behind).or_default().push([a, b, c]);
        }
    }
    regions
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::mesh::tests::cube;

    #[test]
    fn each_region_is_closed_and_outward() {
        let mut text = Vec::new();
        write(&cube(), &mut text).unwrap();
        let text = String::from_utf8(text).unwrap();
        assert_eq!(text.matches("\nendsolid").count(), 2);
        assert_eq!(text.matches("facet normal").count(), 12 + 2 * 2);
        for (_, triangles) in by_region(&cube()) {
            let volume: f64 = triangles.iter().map(|[a, b, c]| a.cross(b).dot(c) / 6.0).sum();
            assert!((volume - 0.5).abs() < 1e-15);
        }
    }
}
