//! Pairs of facets of different leaves that come near each other.

use super::body::Body;
use crate::geom::aabb::Aabb;
use crate::geom::bvh::Bvh;
use rayon::prelude::*;
use std::ops::ControlFlow;

/// Facets below which everything stays on one thread: starting others costs more than a hundred microseconds.
pub(super) const PARALLEL_FROM: usize = 2000;

/// Box trees of the facets as they came, of every leaf that comes near another.
#[derive(Clone, Debug, Default)]
pub struct FacetTrees {
    leaf_boxes: Vec<Aabb>,
    trees: Vec<Bvh>,
}

impl FacetTrees {
    /// Trees for searches up to `reach`. O(n log n).
    pub(super) fn new(body: &Body, reach: f64) -> Self {
        let mut found = Self {
            leaf_boxes: body.solids.iter().map(|s| Aabb::around(s.vertices.iter().map(|v| &v.point))).collect(),
            trees: vec![],
        };
        let mut has_neighbour = vec![false; body.solids.len()];
        for [a, b] in found.leaf_pairs(|_, _| reach) {
            (has_neighbour[a as usize], has_neighbour[b as usize]) = (true, true);
        }
        let tree = |leaf: usize| {
            let facets = body.first_facet[leaf]..body.first_facet[leaf + 1];
            // What is set aside is nowhere.
            let bounds = |f: u32| if body.fate(f).is_aside() { Aabb::EMPTY } else { body.bounds(f) };
            if has_neighbour[leaf] { Bvh::new(facets.map(bounds).collect()) } else { Bvh::default() }
        };
        found.trees = if body.facet_count() >= PARALLEL_FROM {
            (0..body.solids.len()).into_par_iter().map(tree).collect()
        } else {
            (0..body.solids.len()).map(tree).collect()
        };
        found
    }

    /// All pairs (f, g) of facets, f in an earlier leaf, whose boxes come within `margin(leaf, leaf)`; in ascending order.
    ///
    /// Two trees are descended together, so that large surfaces far apart cost little. O(n log n + pairs).
    pub(super) fn facet_pairs(&self, body: &Body, margin: impl Fn(u32, u32) -> f64 + Sync) -> Vec<[u32; 2]> {
        let leaf_pairs = self.leaf_pairs(&margin);
        // Pairs as one number each: those are sorted in half the time.
        let search = |found: &mut Vec<u64>, &[a, b]: &[u32; 2]| {
            let (i, j) = (body.first_facet[a as usize], body.first_facet[b as usize]);
            self.visit([a, b], margin(a, b), |f, g| {
                found.push(u64::from(i + f) << 32 | u64::from(j + g));
                ControlFlow::Continue(())
            });
        };
        let mut pairs = Vec::new();
        if body.facet_count() >= PARALLEL_FROM {
            let lists: Vec<Vec<u64>> = leaf_pairs
                .par_chunks(leaf_pairs.len().div_ceil(64).max(1))
                .map(|chunk| {
                    let mut found = Vec::new();
                    chunk.iter().for_each(|p| search(&mut found, p));
                    found
                })
                .collect();
            pairs = lists.concat();
            pairs.par_sort_unstable();
        } else {
            leaf_pairs.iter().for_each(|p| search(&mut pairs, p));
            pairs.sort_unstable();
        }
        pairs.into_iter().map(|p| [(p >> 32) as u32, p as u32]).collect()
    }

    /// Calls `visit` with the facets (numbered within their leaves) of two leaves whose boxes come within `margin`, in no
    /// particular order, until it breaks.
    pub(super) fn visit(&self, [a, b]: [u32; 2], margin: f64, visit: impl FnMut(u32, u32) -> ControlFlow<()>) {
        self.trees[a as usize].pairs(&self.trees[b as usize], margin, visit);
    }

    /// Pairs of leaves whose boxes come within `margin(leaf, leaf)`, in ascending order.
    pub(super) fn leaf_pairs(&self, margin: impl Fn(u32, u32) -> f64) -> Vec<[u32; 2]> {
        let boxes = &self.leaf_boxes;
        let largest = (0..boxes.len() as u32).fold(0.0, |m: f64, a| m.max(margin(a, a)));
        let tree = Bvh::new(boxes.clone());
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
}
