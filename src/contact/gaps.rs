//! Leaves that come near each other without touching: most likely they were meant to touch.

use super::body::Body;
use super::candidates::{FacetTrees, PARALLEL_FROM, SHARES};
use super::conforming::Conforming;
use super::outline::{Outline, sides};
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use crate::geom::hash::IndexMap;
use crate::geom::lists::Lists;
use crate::geom::segment::between;
use crate::ids::LeafId;
use crate::primitive::solid::Solid;
use rayon::prelude::*;
use std::ops::ControlFlow;

/// Gaps up to this many tolerances are suspicious: whoever wants a gap writes one that a mesh can resolve.
pub const GAP: f64 = 100.0;

/// Outlines of the facets that are compared.
type Outlines = IndexMap<u32, Outline>;

/// Two leaves that come near without touching or crossing.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Gap {
    /// The leaves, the earlier first.
    pub leaves: [LeafId; 2],
    /// Their distance, in the scene's unit.
    pub distance: f64,
    /// A place of that distance, on one of them.
    pub place: Vec3,
}

/// All pairs of leaves that come nearer than [`GAP`] tolerances without touching or crossing, in ascending order, for the
/// solids that `conforming` was made from. Whether they belong to one part is the caller's to know. O(n log n + pairs of
/// facets).
pub fn nearly_touching(solids: &[Solid], conforming: &Conforming) -> Vec<Gap> {
    let reach = GAP * conforming.tolerance;
    let near = conforming.trees.leaf_pairs(|_, _| reach);
    let pairs = if near.is_empty() { near } else { apart(conforming, &near) };
    if pairs.is_empty() {
        return Vec::new();
    }
    let body = Body::apart(solids, conforming.tolerance);
    let search = |pairs: &[[u32; 2]]| -> Vec<Gap> {
        let mut outlines = Outlines::default();
        pairs.iter().filter_map(|&leaves| gap(&body, &conforming.trees, &mut outlines, leaves, reach)).collect()
    };
    if body.facet_count() < PARALLEL_FROM {
        return search(&pairs);
    }
    // In the order of pairs, so that those of one leaf mostly share its outlines.
    pairs.par_chunks(pairs.len().div_ceil(SHARES)).flat_map_iter(search).collect()
}

/// The gap between two leaves, unless it is wider than `reach` or they cross. `outlines` of facets are made when needed.
fn gap(body: &Body, trees: &FacetTrees, outlines: &mut Outlines, leaves: [u32; 2], reach: f64) -> Option<Gap> {
    let first = leaves.map(|l| body.first_facet[l as usize]);
    let mut is_crossing = false;
    // Of equal distances the one between the first facets counts, in whatever order they come.
    let mut best: Option<(f64, [u32; 2], Vec3)> = None;
    trees.visit(leaves, reach, |f, g| {
        let pair = [first[0] + f, first[1] + g];
        for f in pair {
            outlines.entry(f).or_insert_with(|| Outline::new(f, body.loops(f), None, &body.points));
        }
        let [Some(f), Some(g)] = pair.map(|f| outlines.get(&f)) else { return ControlFlow::Continue(()) };
        match distance(f, g, reach, &body.points) {
            None => {
                is_crossing = true;
                return ControlFlow::Break(());
            }
            Some((distance, place))
                if distance <= reach && best.is_none_or(|(d, p, _)| distance < d || distance == d && pair < p) =>
            {
                best = Some((distance, pair, place));
            }
            Some(_) => {}
        }
        ControlFlow::Continue(())
    });
    let (distance, _, place) = best.filter(|_| !is_crossing)?;
    Some(Gap { leaves: leaves.map(LeafId), distance, place })
}

/// Those of `pairs`, which are sorted, that have no point in common.
fn apart(conforming: &Conforming, pairs: &[[u32; 2]]) -> Vec<[u32; 2]> {
    let leaves_at = leaves_at_points(conforming);
    let mut is_apart = vec![true; pairs.len()];
    let mut left = pairs.len();
    let mut leaves: Vec<u32> = Vec::new();
    for v in 0..conforming.points.len() as u32 {
        leaves.clear();
        leaves.extend(leaves_at.of(v));
        leaves.sort_unstable();
        leaves.dedup();
        for (k, &a) in leaves.iter().enumerate() {
            for slot in leaves[k + 1..].iter().filter_map(|&b| pairs.binary_search(&[a, b]).ok()) {
                left -= usize::from(std::mem::replace(&mut is_apart[slot], false));
            }
        }
        // Where hundreds of leaves share hundreds of thousands of points, the first few points tell.
        if left == 0 {
            return Vec::new();
        }
    }
    pairs.iter().zip(is_apart).filter(|p| p.1).map(|p| *p.0).collect()
}

/// For every point near another leaf the leaves that have it, each once or oftener.
fn leaves_at_points(conforming: &Conforming) -> Lists {
    let is_near = |t: &u32| conforming.cells[conforming.cell_of_triangle[*t as usize] as usize].is_near;
    let mut last_leaf = vec![u32::MAX; conforming.points.len()];
    let mut found: Vec<(u32, u32)> = Vec::new();
    for t in (0..conforming.triangles.len() as u32).filter(is_near) {
        for leaf in conforming.owners_of_triangle(t).iter().map(|o| o.leaf.0) {
            for v in conforming.triangles[t as usize] {
                // Triangles come by leaf mostly.
                if std::mem::replace(&mut last_leaf[v as usize], leaf) != leaf {
                    found.push((v, leaf));
                }
            }
        }
    }
    Lists::new(conforming.points.len(), &found)
}

/// Distance of two planar facets and a place of it, if it is at most `reach`, or `None` if they cross.
fn distance(f: &Outline, g: &Outline, reach: f64, points: &[Vec3]) -> Option<(f64, Vec3)> {
    let mut best = (f64::INFINITY, Vec3::zeros());
    let mut improve = |d: f64, place: Vec3| {
        if d < best.0 {
            best = (d, place);
        }
    };
    let near = |outline: &Outline, other: &Outline| -> Vec<([Vec3; 2], Aabb)> {
        let other = other.bounds.inflated(reach);
        let ends = sides(&outline.loops).map(|side| side.map(|v| points[v as usize]));
        ends.map(|ends| (ends, Aabb::around(&ends))).filter(|side| other.overlaps(&side.1)).collect()
    };
    let (mine, yours) = (near(f, g), near(g, f));
    for (own, onto) in [(&mine, g), (&yours, f)] {
        for &([a, b], _) in own {
            let [h, k] = [a, b].map(|p| onto.height(&p));
            if (h > 0.0) != (k > 0.0) && onto.encloses(&(a + (b - a) * (h / (h - k))), points) {
                return None;
            }
            if onto.encloses(&a, points) {
                improve(h.abs(), a);
            }
        }
    }
    for (p, bounds) in &mine {
        let bounds = bounds.inflated(reach);
        for (q, _) in yours.iter().filter(|yours| bounds.overlaps(&yours.1)) {
            let (d, place) = between(p, q);
            improve(d, place);
        }
    }
    Some(best)
}
