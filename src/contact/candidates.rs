//! Pairs of facets of different leaves that come near each other.

use super::body::Body;
use crate::geom::aabb::Aabb;
use crate::geom::bvh::Bvh;
use rayon::prelude::*;

/// Facets below which everything stays on one thread: starting others costs more than a hundred microseconds.
pub(super) const PARALLEL_FROM: usize = 2000;

/// All pairs (f, g) of facets, f in an earlier leaf, whose boxes come within `margin(leaf, leaf)`; in ascending order.
///
/// Only leaves whose boxes come near another get a box tree; two trees are descended together, so that large surfaces far apart
/// cost little. O(n log n + pairs).
pub(super) fn facet_pairs(body: &Body, margin: impl Fn(u32, u32) -> f64 + Sync) -> Vec<[u32; 2]> {
    let is_parallel = body.facet_count() >= PARALLEL_FROM;
    let leaf_boxes: Vec<Aabb> = body.solids.iter().map(|s| Aabb::around(s.vertices.iter().map(|v| &v.point))).collect();
    let leaf_pairs = leaf_pairs(&leaf_boxes, &margin);
    let mut has_neighbour = vec![false; leaf_boxes.len()];
    for &[a, b] in &leaf_pairs {
        (has_neighbour[a as usize], has_neighbour[b as usize]) = (true, true);
    }
    let tree = |leaf: usize| {
        let facets = body.first_facet[leaf]..body.first_facet[leaf + 1];
        if has_neighbour[leaf] { Bvh::new(facets.map(|f| body.bounds(f)).collect()) } else { Bvh::default() }
    };
    let trees: Vec<Bvh> = if is_parallel {
        (0..leaf_boxes.len()).into_par_iter().map(tree).collect()
    } else {
        (0..leaf_boxes.len()).map(tree).collect()
    };
    let search = |&[a, b]: &[u32; 2], found: &mut Vec<[u32; 2]>| {
        let (i, j) = (body.first_facet[a as usize], body.first_facet[b as usize]);
        trees[a as usize].pairs(&trees[b as usize], margin(a, b), |f, g| found.push([i + f, j + g]));
    };
    let mut pairs = Vec::new();
    if is_parallel {
        let lists: Vec<Vec<[u32; 2]>> = leaf_pairs
            .par_chunks(leaf_pairs.len().div_ceil(64).max(1))
            .map(|chunk| {
                let mut found = Vec::new();
                chunk.iter().for_each(|p| search(p, &mut found));
                found
            })
            .collect();
        pairs = lists.concat();
        pairs.par_sort_unstable();
    } else {
        leaf_pairs.iter().for_each(|p| search(p, &mut pairs));
        pairs.sort_unstable();
    }
    pairs
}

fn leaf_pairs(boxes: &[Aabb], margin: &impl Fn(u32, u32) -> f64) -> Vec<[u32; 2]> {
    let largest = (0..boxes.len() as u32).fold(0.0, |m: f64, a| m.max(margin(a, a)));
    let tree = Bvh::new(boxes.to_vec());
    let mut pairs = Vec::new();
    for (a, own) in boxes.iter().enumerate() {
        tree.overlapping(&own.inflated(largest), |b| {
            if a < b as usize && own.inflated(margin(a as u32, b)).overlaps(&boxes[b as usize]) {
                pairs.push([a as u32, b]);
            }
        });
    }
    pairs.sort_unstable();
    pairs
}
