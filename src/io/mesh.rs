//! The labelled mesh that files carry: nodes, triangles with markers, tetrahedra with regions, and the names of both.
//!
//! A surface is such a mesh without tetrahedra. Coordinates are in the scene's unit.

use crate::declare_ids;
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use crate::ids::{Id, IdVec};
use crate::plc::Seed;
use std::collections::{BTreeMap, HashMap};

declare_ids! {
    /// A node of a mesh.
    NodeId;
}

/// Number of a region as written to files; 0 is the outside.
pub type RegionNumber = u32;
/// Number of a marker as written to files; 0 is "no name".
pub type MarkerNumber = u32;

/// A mesh with names.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Nodes.
    pub nodes: IdVec<NodeId, Vec3>,
    /// Triangles of interfaces and boundaries, each once.
    pub triangles: Vec<Triangle>,
    /// Tetrahedra, of positive volume.
    pub tets: Vec<Tet>,
    /// A point inside of each volume of a surface, if they are known.
    pub seeds: Vec<Seed>,
    /// A point inside of each cavity, if they are known.
    pub holes: Vec<Vec3>,
    /// Names of regions.
    pub regions: BTreeMap<RegionNumber, String>,
    /// Names of markers.
    pub markers: BTreeMap<MarkerNumber, String>,
}

/// A triangle of an interface or boundary.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Triangle {
    /// Corners.
    pub corners: [NodeId; 3],
    /// Its marker.
    pub marker: MarkerNumber,
    /// Regions in front (where the corners are seen counter-clockwise) and behind.
    pub sides: [RegionNumber; 2],
}

/// A tetrahedron.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Tet {
    /// Corners; the last one lies on the side of the first three from which they are seen counter-clockwise.
    pub corners: [NodeId; 4],
    /// Its region.
    pub region: RegionNumber,
}

/// The faces of a tetrahedron, each seen counter-clockwise from inside.
pub const TET_FACES: [[usize; 3]; 4] = [[0, 1, 2], [0, 3, 1], [1, 3, 2], [0, 2, 3]];

impl Mesh {
    /// The corners' positions of a triangle.
    pub fn triangle_points(&self, t: &Triangle) -> [Vec3; 3] {
        t.corners.map(|v| self.nodes[v])
    }
    /// The corners' positions of a tetrahedron.
    pub fn tet_points(&self, t: &Tet) -> [Vec3; 4] {
        t.corners.map(|v| self.nodes[v])
    }
    /// The name of a region.
    pub fn region_name(&self, region: RegionNumber) -> String {
        self.regions.get(&region).cloned().unwrap_or_else(|| format!("region{region}"))
    }
    /// The box around all nodes.
    pub fn bounds(&self) -> Aabb {
        Aabb::around(self.nodes.iter())
    }

    /// Volume of each region, from its tetrahedra, or, without any, from the triangles around it.
    pub fn volumes(&self) -> BTreeMap<RegionNumber, f64> {
        let mut sum = BTreeMap::new();
        for t in &self.tets {
            let [a, b, c, d] = self.tet_points(t);
            *sum.entry(t.region).or_insert(0.0) += (b - a).cross(&(c - a)).dot(&(d - a)) / 6.0;
        }
        if self.tets.is_empty() {
            let origin = self.nodes.iter().next().copied().unwrap_or_default();
            for t in &self.triangles {
                let [a, b, c] = self.triangle_points(t).map(|p| p - origin);
                let cone = a.cross(&b).dot(&c) / 6.0;
                for (side, sign) in t.sides.into_iter().zip([-1.0, 1.0]) {
                    if side != 0 {
                        *sum.entry(side).or_insert(0.0) += sign * cone;
                    }
                }
            }
        }
        sum
    }

    /// Turns tetrahedra of negative volume, finds the regions at both sides of each triangle, and orients the triangles: the
    /// outside, else the region with the larger number, is in front.
    pub fn orient(&mut self) {
        for k in 0..self.tets.len() {
            let [a, b, c, d] = self.tet_points(&self.tets[k]);
            if (b - a).cross(&(c - a)).dot(&(d - a)) < 0.0 {
                self.tets[k].corners.swap(1, 2);
            }
        }
        self.find_sides();
        for t in &mut self.triangles {
            let [front, behind] = t.sides;
            if behind == 0 || (front != 0 && front < behind) {
                t.corners.swap(1, 2);
                t.sides = [behind, front];
            }
        }
    }

    /// Sides of the triangles from the tetrahedra; without tetrahedra they stay as they are.
    fn find_sides(&mut self) {
        if self.tets.is_empty() {
            return;
        }
        let mut slots = HashMap::with_capacity(self.triangles.len());
        for (k, t) in self.triangles.iter_mut().enumerate() {
            t.sides = [0, 0];
            slots.insert(sorted(t.corners), k);
        }
        for tet in &self.tets {
            for face in TET_FACES {
                let corners = face.map(|k| tet.corners[k]);
                if let Some(&k) = slots.get(&sorted(corners)) {
                    let t = &mut self.triangles[k];
                    let side = usize::from(!is_same_cycle(t.corners, corners));
                    t.sides[side] = tet.region;
                }
            }
        }
    }

    /// Drops nodes that no element uses and numbers the others densely, in their order.
    pub fn drop_unused_nodes(&mut self) {
        let mut is_used = vec![false; self.nodes.len()];
        let corners = self.triangles.iter().flat_map(|t| &t.corners).chain(self.tets.iter().flat_map(|t| &t.corners));
        corners.for_each(|v| is_used[v.index()] = true);
        let mut kept = IdVec::new();
        let new: Vec<NodeId> =
            self.nodes.iter().zip(&is_used).map(|(p, used)| if *used { kept.push(*p) } else { NodeId(u32::MAX) }).collect();
        self.nodes = kept;
        self.triangles.iter_mut().flat_map(|t| &mut t.corners).for_each(|v| *v = new[v.index()]);
        self.tets.iter_mut().flat_map(|t| &mut t.corners).for_each(|v| *v = new[v.index()]);
    }
}

/// The corners in ascending order: the key of a triangle however it is turned.
pub(crate) fn sorted(mut corners: [NodeId; 3]) -> [NodeId; 3] {
    corners.sort_unstable();
    corners
}

/// Whether two triples of the same nodes turn the same way.
fn is_same_cycle(a: [NodeId; 3], b: [NodeId; 3]) -> bool {
    (0..3).any(|k| a[0] == b[k] && a[1] == b[(k + 1) % 3])
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A unit cube of two regions, split by the plane through its diagonal: six tetrahedra, twelve outer triangles, two inner.
    pub(crate) fn cube() -> Mesh {
        let nodes = (0..8).map(|k| Vec3::new((k & 1) as f64, (k >> 1 & 1) as f64, (k >> 2 & 1) as f64)).collect();
        // Kuhn's division along the diagonal 0-7, one tetrahedron per order of the axes.
        let mut tets = Vec::new();
        for (i, [p, q]) in [[1, 3], [1, 5], [2, 3], [2, 6], [4, 5], [4, 6]].into_iter().enumerate() {
            tets.push(Tet { corners: [0, p, q, 7].map(NodeId), region: if [0, 1, 4].contains(&i) { 1 } else { 2 } });
        }
        let mut faces: BTreeMap<[NodeId; 3], Vec<u32>> = BTreeMap::new();
        for t in &tets {
            for f in TET_FACES {
                faces.entry(sorted(f.map(|k| t.corners[k]))).or_default().push(t.region);
            }
        }
        let triangles = faces
            .into_iter()
            .filter(|(_, r)| r.len() == 1 || r[0] != r[1])
            .map(|(corners, r)| Triangle { corners, marker: if r.len() == 1 { r[0] + 2 } else { 5 }, sides: [0, 0] })
            .collect();
        let names = |list: &[(u32, &str)]| list.iter().map(|(k, n)| (*k, n.to_string())).collect();
        let mut mesh = Mesh {
            nodes,
            triangles,
            tets,
            regions: names(&[(1, "iron"), (2, "air")]),
            seeds: Vec::new(),
            holes: Vec::new(),
            markers: names(&[(3, "iron|outer"), (4, "air|outer"), (5, "iron|air")]),
        };
        mesh.orient();
        mesh
    }

    #[test]
    fn cube_is_oriented_and_divided_in_halves() {
        let mut mesh = cube();
        let volumes = mesh.volumes();
        assert!((volumes[&1] - 0.5).abs() < 1e-15 && (volumes[&2] - 0.5).abs() < 1e-15);
        assert_eq!(mesh.triangles.len(), 14);
        assert!(mesh.triangles.iter().all(|t| t.sides == if t.marker == 5 { [2, 1] } else { [0, t.marker - 2] }));
        mesh.tets.clear();
        assert_eq!(mesh.volumes().len(), 2);
        assert!((mesh.volumes()[&2] - 0.5).abs() < 1e-15);
    }

    #[test]
    fn unused_nodes_go() {
        let mut mesh = cube();
        let volumes = mesh.volumes();
        let mut nodes: Vec<Vec3> = mesh.nodes.iter().copied().collect();
        nodes.insert(0, Vec3::repeat(9.0));
        mesh.nodes = nodes.into();
        mesh.triangles.iter_mut().flat_map(|t| &mut t.corners).for_each(|v| v.0 += 1);
        mesh.tets.iter_mut().flat_map(|t| &mut t.corners).for_each(|v| v.0 += 1);
        mesh.drop_unused_nodes();
        assert_eq!(mesh.nodes.len(), 8);
        assert_eq!(mesh.volumes(), volumes);
    }
}
