//! Pairs of triangles of different leaves that meet.

use super::graph::Mesh;
use super::intersect::{Contact, intersect};
use crate::geom::aabb::Aabb;
use crate::geom::bvh::Bvh;
use rayon::prelude::*;
use std::ops::ControlFlow;

/// Candidate pairs from which on the work is shared between threads: below, handing it out costs more than it saves.
const PARALLEL_PAIRS: usize = 4096;

/// Pairs that meet, by first and then second triangle.
pub struct Contacts {
    /// First triangle, second triangle (larger number), where they meet.
    pub found: Vec<(u32, u32, Contact)>,
    /// Pairs that were looked at.
    pub candidates: u64,
}

/// Finds all contacts between triangles that have no leaf in common, since a leaf is valid in itself, nor a sheet, since contact
/// has made its cells conform.
pub fn contacts(mesh: &Mesh) -> Contacts {
    let pairs = candidates(mesh);
    let meet = |&[t, u]: &[u32; 2]| intersect(&mesh.corners(t), &mesh.corners(u)).map(|c| (t, u, c));
    let found = if pairs.len() < PARALLEL_PAIRS {
        pairs.iter().filter_map(meet).collect()
    } else {
        pairs.par_iter().with_min_len(PARALLEL_PAIRS / 4).filter_map(meet).collect()
    };
    Contacts { found, candidates: pairs.len() as u64 }
}

/// Pairs with overlapping boxes, sorted. Every leaf has a tree of its own, of those triangles that come near another leaf, so
/// that the many neighbours within one leaf are never looked at.
fn candidates(mesh: &Mesh) -> Vec<[u32; 2]> {
    let points = &mesh.input.points;
    let boxes: Vec<Aabb> = mesh.triangles.iter().map(|t| Aabb::around(t.map(|v| &points[v as usize]))).collect();
    let mut leaves: Vec<(Aabb, Vec<u32>)> = Vec::new();
    for t in 0..boxes.len() as u32 {
        let leaf = mesh.leaf_of(t) as usize;
        if leaves.len() <= leaf {
            leaves.resize(leaf + 1, (Aabb::EMPTY, Vec::new()));
        }
        leaves[leaf].0 = leaves[leaf].0.union(&boxes[t as usize]);
        leaves[leaf].1.push(t);
    }
    let crowd = Bvh::new(leaves.iter().map(|l| l.0).collect());
    let mut near: Vec<[u32; 2]> = Vec::new();
    for task in crowd.pair_tasks(1) {
        crowd.overlapping_pairs(task, |a, b| {
            near.push([a.min(b), a.max(b)]);
            ControlFlow::Continue(())
        });
    }
    let mut reach = vec![Aabb::EMPTY; leaves.len()];
    for &[a, b] in &near {
        reach[a as usize] = reach[a as usize].union(&leaves[b as usize].0);
        reach[b as usize] = reach[b as usize].union(&leaves[a as usize].0);
    }
    let trees: Vec<(Vec<u32>, Bvh)> = leaves
        .par_iter()
        .zip(&reach)
        .with_min_len(8)
        .map(|((_, triangles), reach)| {
            let active: Vec<u32> = triangles.iter().copied().filter(|&t| boxes[t as usize].overlaps(reach)).collect();
            let tree = Bvh::new(active.iter().map(|&t| boxes[t as usize]).collect());
            (active, tree)
        })
        .collect();
    let join = |&[a, b]: &[u32; 2]| {
        let ((first, tree), (second, other)) = (&trees[a as usize], &trees[b as usize]);
        let mut found = Vec::new();
        tree.pairs(other, 0.0, |i, j| {
            let (t, u) = (first[i as usize], second[j as usize]);
            if mesh.sheet_of(t) != mesh.sheet_of(u) && !mesh.has_common_leaf(t, u) {
                found.push([t.min(u), t.max(u)]);
            }
        });
        found
    };
    let mut pairs: Vec<[u32; 2]> = if boxes.len() < PARALLEL_PAIRS {
        near.iter().flat_map(join).collect()
    } else {
        near.par_iter().flat_map_iter(join).collect()
    };
    pairs.sort_unstable();
    pairs
}
