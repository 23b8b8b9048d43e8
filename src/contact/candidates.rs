//! Pairs of facets of different leaves that come near each other.
//!
//! Boxes tell, but the box of a cap with a bore holds all that lies in the bore: with facets of many corners, the boxes of
//! others are compared as they are seen along an axis, too.

use super::body::Body;
use super::figure::{Figure, MANY};
use super::outline::sides;
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use crate::geom::bvh::{Bvh, Item};
use crate::geom::hash::IndexMap;
use crate::geom::predicates::Projection;
use rayon::prelude::*;
use std::ops::ControlFlow;

/// Facets below which everything stays on one thread: starting others costs more than a hundred microseconds.
pub(super) const PARALLEL_FROM: usize = 2000;
/// Pieces of the work that threads share, about.
pub(super) const SHARES: usize = 64;

/// Facets as they came, of those that come near the box of another leaf.
#[derive(Clone, Debug, Default)]
pub struct FacetTrees {
    leaf_boxes: Vec<Aabb>,
    leaves: Vec<Facets>,
}

/// Those of one leaf.
#[derive(Clone, Debug, Default)]
struct Facets {
    tree: Bvh,
    /// Those with many corners as they are seen along an axis.
    figures: IndexMap<u32, (Projection, Figure)>,
}

impl Facets {
    fn new(body: &Body, leaf: u32, around: &Aabb) -> Self {
        let first = body.first_facet[leaf as usize];
        let facets = first..body.first_facet[leaf as usize + 1];
        let bounds = |f: u32| {
            let own = body.bounds(f);
            // What is far from all other leaves meets none; what is set aside is compared with none.
            if around.overlaps(&own) && !body.fate(f).is_aside() { own } else { Aabb::EMPTY }
        };
        let has_many = |&f: &u32| body.own_loops(f).corners().take(MANY).count() == MANY;
        let figures = facets.clone().filter(has_many).filter_map(|f| Some((f - first, figure(body, f)?))).collect();
        Self { tree: Bvh::new(facets.map(bounds).collect()), figures }
    }

    /// Whether a box may come nearer than `margin` to a facet along every axis.
    fn may_meet(&self, facet: u32, bounds: &Aabb, margin: f64) -> bool {
        !self.figures.get(&facet).is_some_and(|(projection, figure)| {
            let near = bounds.inflated(margin);
            !figure.may_meet(projection.apply(&near.lo), projection.apply(&near.hi))
        })
    }
}

/// A facet seen along the axis nearest to its normal; `None` if it has no area.
fn figure(body: &Body, facet: u32) -> Option<(Projection, Figure)> {
    let vertices = &body.solids[body.leaf_of_facet[facet as usize] as usize].vertices;
    let normal = body.normal(facet);
    let projection = Projection::along(&normal);
    let place = |v: u32| projection.apply(&vertices[v as usize].point);
    let sides = sides(body.own_loops(facet).iter()).map(|side| side.map(place));
    (normal != Vec3::zeros()).then(|| (projection, Figure::new(sides.collect())))
}

impl FacetTrees {
    /// Trees for searches up to `reach`. O(n log n).
    pub(super) fn new(body: &Body, reach: f64) -> Self {
        let mut found = Self {
            leaf_boxes: body.solids.iter().map(|s| Aabb::around(s.vertices.iter().map(|v| &v.point))).collect(),
            leaves: vec![],
        };
        // The box of everything that comes near each leaf.
        let mut around = vec![Aabb::EMPTY; body.solids.len()];
        for pair in found.leaf_pairs(|_, _| reach) {
            for (leaf, other) in [(pair[0], pair[1]), (pair[1], pair[0])] {
                around[leaf as usize] = around[leaf as usize].union(&found.leaf_boxes[other as usize].inflated(reach));
            }
        }
        let facets = |leaf: usize| match around[leaf].is_empty() {
            true => Facets::default(),
            false => Facets::new(body, leaf as u32, &around[leaf]),
        };
        found.leaves = if body.facet_count() >= PARALLEL_FROM {
            (0..body.solids.len()).into_par_iter().map(facets).collect()
        } else {
            (0..body.solids.len()).map(facets).collect()
        };
        found
    }

    /// All pairs (f, g) of facets, f in an earlier leaf, that may come within `margin(leaf, leaf)`; in ascending order.
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
                .par_chunks(leaf_pairs.len().div_ceil(SHARES).max(1))
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

    /// Calls `visit` with the facets (numbered within their leaves) of two leaves that may come within `margin` along every
    /// axis, in no particular order, until it breaks.
    pub(super) fn visit(&self, leaves: [u32; 2], margin: f64, mut visit: impl FnMut(u32, u32) -> ControlFlow<()>) {
        let [a, b] = leaves.map(|leaf| &self.leaves[leaf as usize]);
        a.tree.pairs(&b.tree, margin, |f: &Item, g: &Item| {
            let may_meet = a.may_meet(f.number, &g.bounds, margin) && b.may_meet(g.number, &f.bounds, margin);
            if may_meet { visit(f.number, g.number) } else { ControlFlow::Continue(()) }
        });
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
