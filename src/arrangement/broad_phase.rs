//! Pairs of triangles of different leaves that meet.

use super::graph::Mesh;
use super::intersect::{Contact, intersect};
use crate::geom::aabb::Aabb;
use crate::geom::bvh::Bvh;
use rayon::prelude::*;

/// Triangles handled by one task: small enough to share the work, large enough that handing it out costs nothing.
const CHUNK: usize = 512;

/// Pairs that meet, by first and then second triangle.
pub struct Contacts {
    /// First triangle, second triangle (larger number), where they meet.
    pub found: Vec<(u32, u32, Contact)>,
    /// Pairs that were looked at.
    pub candidates: u64,
}

/// Finds all contacts between triangles that have no leaf in common: a leaf is valid in itself.
pub fn contacts(mesh: &Mesh) -> Contacts {
    let count = mesh.triangles.len();
    let points = &mesh.input.points;
    let boxes: Vec<Aabb> = mesh.triangles.iter().map(|t| Aabb::around(t.map(|v| &points[v as usize]))).collect();
    let crowd = Crowd::new(mesh, &boxes);
    let active: Vec<u32> = (0..count as u32).filter(|&t| crowd.has_company(mesh.leaf_of(t), &boxes[t as usize])).collect();
    let tree = Bvh::new(active.iter().map(|&t| boxes[t as usize]).collect());
    let one = |chunk: &[u32]| {
        let (mut found, mut candidates, mut near) = (Vec::new(), 0u64, Vec::new());
        for &t in chunk {
            near.clear();
            tree.overlapping(&boxes[t as usize], |k| {
                let u = active[k as usize];
                if u > t && !mesh.has_common_leaf(t, u) {
                    near.push(u);
                }
            });
            near.sort_unstable();
            candidates += near.len() as u64;
            let corners = mesh.corners(t);
            found.extend(near.iter().filter_map(|&u| intersect(&corners, &mesh.corners(u)).map(|c| (t, u, c))));
        }
        (found, candidates)
    };
    let parts: Vec<(Vec<_>, u64)> = if active.len() <= 4 * CHUNK {
        active.chunks(CHUNK).map(one).collect()
    } else {
        active.par_chunks(CHUNK).map(one).collect()
    };
    let candidates = parts.iter().map(|p| p.1).sum();
    Contacts { found: parts.into_iter().flat_map(|p| p.0).collect(), candidates }
}

/// Boxes of the leaves: triangles near no other leaf are left out at once.
struct Crowd {
    tree: Bvh,
}

impl Crowd {
    fn new(mesh: &Mesh, boxes: &[Aabb]) -> Self {
        let mut leaves = Vec::new();
        for (t, bounds) in boxes.iter().enumerate() {
            for owner in mesh.owners(t as u32) {
                let leaf = owner.leaf.0 as usize;
                if leaves.len() <= leaf {
                    leaves.resize(leaf + 1, Aabb::EMPTY);
                }
                leaves[leaf] = leaves[leaf].union(bounds);
            }
        }
        Self { tree: Bvh::new(leaves) }
    }

    fn has_company(&self, leaf: u32, bounds: &Aabb) -> bool {
        let mut others = false;
        self.tree.overlapping(bounds, |other| others |= other != leaf);
        others
    }
}
