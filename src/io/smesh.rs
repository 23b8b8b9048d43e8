//! TetGen's .smesh: the triangles with their markers and one seed per connected region; names in comments.

use super::mesh::{Mesh, NodeId, TET_FACES, sorted};
use super::names::name_of;
use super::poly;
use crate::geom::Vec3;
use crate::plc::Seed;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::io::{self, Write};

/// Writes the triangles and their nodes, not those inside of volumes; a mesh of tetrahedra has its seeds in them.
///
/// # Errors
/// What the writer reports.
pub fn write(mesh: &Mesh, out: &mut dyn Write) -> io::Result<()> {
    write_name_comments(mesh, out)?;
    let used: BTreeSet<NodeId> = mesh.triangles.iter().flat_map(|t| t.corners).collect();
    let numbers: BTreeMap<NodeId, usize> = used.into_iter().zip(1..).collect();
    writeln!(out, "{} 3 0 0", numbers.len())?;
    for (&v, number) in &numbers {
        let p = mesh.nodes[v];
        writeln!(out, "{number} {:?} {:?} {:?}", p.x, p.y, p.z)?;
    }
    writeln!(out, "{} 1", mesh.triangles.len())?;
    for t in &mesh.triangles {
        let [a, b, c] = t.corners.map(|v| numbers[&v]);
        writeln!(out, "3 {a} {b} {c} {}", t.marker)?;
    }
    let seeds = if mesh.tets.is_empty() { mesh.seeds.clone() } else { seeds(mesh) };
    let mut volumes = String::new();
    // Writing to a String cannot fail.
    let _ = poly::volumes(&mut volumes, &mesh.holes, &seeds);
    out.write_all(volumes.as_bytes())
}

/// Comments that name regions and markers.
pub(crate) fn write_name_comments(mesh: &Mesh, out: &mut dyn Write) -> io::Result<()> {
    for (kind, names) in [("region", &mesh.regions), ("marker", &mesh.markers)] {
        for number in names.keys() {
            writeln!(out, "# {kind} {number} {}", name_of(names, *number, kind))?;
        }
    }
    Ok(())
}

/// A point strictly inside each connected volume of one region: the centroid of its largest tetrahedron.
fn seeds(mesh: &Mesh) -> Vec<Seed> {
    // Components by union-find over tetrahedra that share a face without a triangle.
    let walls: BTreeSet<_> = mesh.triangles.iter().map(|t| sorted(t.corners)).collect();
    let mut parent: Vec<usize> = (0..mesh.tets.len()).collect();
    let mut first = HashMap::new();
    for (k, tet) in mesh.tets.iter().enumerate() {
        for face in TET_FACES {
            let key = sorted(face.map(|c| tet.corners[c]));
            if walls.contains(&key) {
                continue;
            }
            if let Some(other) = first.insert(key, k) {
                let (a, b) = (root(&mut parent, k), root(&mut parent, other));
                parent[a.max(b)] = a.min(b);
            }
        }
    }
    let mut best: BTreeMap<usize, (f64, usize)> = BTreeMap::new();
    for (k, tet) in mesh.tets.iter().enumerate() {
        let [a, b, c, d] = mesh.tet_points(tet);
        let volume = (b - a).cross(&(c - a)).dot(&(d - a));
        let entry = best.entry(root(&mut parent, k)).or_insert((volume, k));
        if volume > entry.0 {
            *entry = (volume, k);
        }
    }
    let seed = |k: usize| Seed {
        point: mesh.tet_points(&mesh.tets[k]).iter().sum::<Vec3>() * 0.25,
        region: mesh.tets[k].region.into(),
        max_volume: None,
    };
    best.into_values().map(|(_, k)| seed(k)).collect()
}

fn root(parent: &mut [usize], mut k: usize) -> usize {
    while parent[k] != k {
        parent[k] = parent[parent[k]];
        k = parent[k];
    }
    k
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::mesh::tests::cube;

    #[test]
    fn one_seed_per_piece() {
        let mut mesh = cube();
        assert_eq!(seeds(&mesh).iter().map(|s| s.region).collect::<Vec<_>>(), [1, 2]);
        // Without the inner triangles the regions are one volume.
        mesh.triangles.retain(|t| t.marker != 5);
        assert_eq!(seeds(&mesh).len(), 1);
    }

    /// `gsm check` finds vertices that no facet uses.
    #[test]
    fn nodes_inside_of_volumes_are_left_out() {
        let text = |mesh: &Mesh| {
            let mut out = Vec::new();
            write(mesh, &mut out).unwrap();
            String::from_utf8(out).unwrap()
        };
        let mut mesh = cube();
        let before = text(&mesh);
        mesh.nodes.push(Vec3::new(0.3, 0.3, 0.3));
        assert_eq!(text(&mesh), before);
    }
}
