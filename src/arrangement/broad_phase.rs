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

/// Pairs with overlapping boxes, sorted. Every leaf has a tree of its own, of its triangles near another leaf, so that the many
/// neighbours within one leaf are never looked at.
fn candidates(mesh: &Mesh) -> Vec<[u32; 2]> {
    let points = &mesh.input.points;
    // Triangles with their sheets, which tell most pairs apart, and boxes.
    let mut leaves: Vec<(Vec<[u32; 2]>, Vec<Aabb>)> = Vec::new();
    for &t in &mesh.near {
        let leaf = mesh.leaf_of(t) as usize;
        if leaves.len() <= leaf {
            leaves.resize_with(leaf + 1, Default::default);
        }
        leaves[leaf].0.push([t, mesh.sheet_of(t)]);
        leaves[leaf].1.push(Aabb::around(mesh.triangles[t as usize].map(|v| &points[v as usize])));
    }
    let is_parallel = mesh.near.len() >= PARALLEL_PAIRS;
    let trees: Vec<(Vec<[u32; 2]>, Bvh)> = if is_parallel {
        leaves.into_par_iter().map(|(triangles, boxes)| (triangles, Bvh::new(boxes))).collect()
    } else {
        leaves.into_iter().map(|(triangles, boxes)| (triangles, Bvh::new(boxes))).collect()
    };
    let crowd = Bvh::new(trees.iter().map(|t| t.1.bounds()).collect());
    let mut near: Vec<[u32; 2]> = Vec::new();
    for task in crowd.pair_tasks(1) {
        crowd.overlapping_pairs(task, |a, b| {
            near.push([a.min(b), a.max(b)]);
            ControlFlow::Continue(())
        });
    }
    let join = |&[a, b]: &[u32; 2]| {
        let ((first, tree), (second, other)) = (&trees[a as usize], &trees[b as usize]);
        // Pairs as one number each: those are sorted in half the time.
        let mut found: Vec<u64> = Vec::new();
        tree.pairs(other, 0.0, |i, j| {
            let ([t, mine], [u, yours]) = (first[i as usize], second[j as usize]);
            if mine != yours && !mesh.has_common_leaf(t, u) {
                found.push(u64::from(t.min(u)) << 32 | u64::from(t.max(u)));
            }
            ControlFlow::Continue(())
        });
        found
    };
    let mut pairs: Vec<u64> =
        if is_parallel { near.par_iter().flat_map_iter(join).collect() } else { near.iter().flat_map(join).collect() };
    pairs.sort_unstable();
    pairs.into_iter().map(|p| [(p >> 32) as u32, p as u32]).collect()
}
