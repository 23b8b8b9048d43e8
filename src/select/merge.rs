//! Retained sub-cells of one facet with the same sides become one polygon.

use super::{SHARE, SelectedFacet};
use crate::arrangement::Arrangement;
use crate::classify::EdgeUses;
use crate::contact::conforming::Owner;
use crate::geom::hash::IndexSet;
use crate::geom::union_find::UnionFind;
use crate::ids::{Id, LeafId, MarkerId};
use rayon::prelude::*;
use std::ops::Range;

/// Walks up to which comparing all pairs is faster than sorting.
const SHORT_WALK: usize = 16;

/// `source_of`: for each retained piece, which of its owners it counts as a piece of. Merges across every edge at which exactly
/// two retained pieces meet that come from the same facet, and have the same volumes in front and behind and the same marker.
pub fn merge(
    arrangement: &Arrangement,
    edges: &EdgeUses,
    kept: &[bool],
    marker_of: &[MarkerId],
    source_of: &[u32],
    volumes_of: impl Fn(usize) -> [u32; 2] + Sync,
) -> Vec<SelectedFacet> {
    let cells = &arrangement.cells;
    let source = |cell: usize| cells.owners_of(cell)[source_of[cell] as usize];
    let key = |cell: usize| {
        let owner = source(cell);
        let [front, back] = volumes_of(cell);
        // Seen from the source facet's outside, so that pieces of either orientation compare.
        let sides = if owner.is_flipped { [back, front] } else { [front, back] };
        (owner.leaf, owner.facet, sides, marker_of[cell])
    };
    let mut sets = UnionFind::new(cells.len());
    // For each corner whose edge vanishes, the matching corner on the other side.
    let mut twin = vec![u32::MAX; cells.corners().len()];
    let cell = |corner: u32| edges.cell_of[corner as usize] as usize;
    let vanishing = |group: &[u32]| {
        let mut alive = group.iter().copied().filter(|&c| kept[cell(c)]);
        let (Some(a), Some(b), None) = (alive.next(), alive.next(), alive.next()) else { return None };
        let (p, q) = (cell(a), cell(b));
        let is_opposite = edges.is_forward[a as usize] != edges.is_forward[b as usize];
        let is_same_turn = source(p).is_flipped == source(q).is_flipped;
        (is_opposite && is_same_turn && (p == q || key(p) == key(q))).then_some([a, b])
    };
    let shares: Vec<Range<usize>> =
        (0..edges.count()).step_by(SHARE).map(|from| from..(from + SHARE).min(edges.count())).collect();
    let search = |share: &Range<usize>| edges.groups_in(share.clone()).filter_map(vanishing).collect::<Vec<_>>();
    let found: Vec<Vec<[u32; 2]>> = shares.par_iter().map(search).collect();
    for [a, b] in found.into_iter().flatten() {
        sets.join(cell(a) as u32, cell(b) as u32);
        twin[a as usize] = b;
        twin[b as usize] = a;
    }
    let (set_of, _) = sets.number();
    collect(arrangement, edges, kept, &set_of, &twin, &|cell| (source(cell), volumes_of(cell), marker_of[cell]))
}

fn collect(
    arrangement: &Arrangement,
    edges: &EdgeUses,
    kept: &[bool],
    set_of: &[u32],
    twin: &[u32],
    describe: &dyn Fn(usize) -> (Owner, [u32; 2], MarkerId),
) -> Vec<SelectedFacet> {
    let cells = &arrangement.cells;
    let mut facets: Vec<SelectedFacet> = Vec::with_capacity(kept.iter().filter(|k| **k).count());
    let mut facet_of_set = vec![u32::MAX; cells.len()];
    for cell in (0..cells.len()).filter(|&c| kept[c]) {
        let slot = &mut facet_of_set[set_of[cell] as usize];
        if *slot == u32::MAX {
            *slot = facets.len() as u32;
            let (owner, volumes, marker) = describe(cell);
            let source = (owner.leaf, owner.facet);
            facets.push(SelectedFacet {
                loops: Vec::new(),
                volumes,
                source,
                is_flipped: owner.is_flipped,
                marker,
                is_partial: false,
            });
        }
    }
    let mut is_walked = vec![false; twin.len()];
    let mut lone = Vec::new();
    for (range, cell) in cells.loop_ranges() {
        if !kept[cell] {
            continue;
        }
        let facet = facet_of_set[set_of[cell] as usize];
        if range.len() == 1 {
            lone.push((cells.corners()[range.start], facet));
            continue;
        }
        for start in range {
            if twin[start] == u32::MAX && !is_walked[start] {
                let walk = walk(edges, cells.corners(), twin, &mut is_walked, start as u32);
                split_simple(walk, &mut facets[facet as usize].loops);
            }
        }
    }
    for facet in &mut facets {
        put_outer_first(arrangement, &mut facet.loops);
    }
    let vanished = (0..twin.len())
        .filter(|&c| twin[c] != u32::MAX)
        .map(|c| (cells.corners()[c], facet_of_set[set_of[edges.cell_of[c] as usize] as usize]));
    keep_lone_points(&mut facets, arrangement.points.len(), lone.into_iter().chain(vanished));
    mark_partial(arrangement, &mut facets, kept, &facet_of_set, set_of);
    facets
}

/// Walks the rim of a merged set: along corners, and through vanished edges to the next rim edge.
fn walk(edges: &EdgeUses, corners: &[u32], twin: &[u32], is_walked: &mut [bool], start: u32) -> Vec<u32> {
    let (mut corner, mut out) = (start, Vec::new());
    loop {
        is_walked[corner as usize] = true;
        out.push(corners[corner as usize]);
        corner = edges.next[corner as usize];
        while twin[corner as usize] != u32::MAX {
            corner = edges.next[twin[corner as usize] as usize];
        }
        if corner == start || is_walked[corner as usize] {
            return out;
        }
    }
}

/// The outer loop is the one with the largest area; the others are holes or touching edges.
fn put_outer_first(arrangement: &Arrangement, loops: &mut [Vec<u32>]) {
    if loops.len() < 2 {
        return;
    }
    let area = |walk: &Vec<u32>| {
        let o = arrangement.points.at(walk[0]);
        let ring = (0..walk.len()).map(|k| {
            let (a, b) = (arrangement.points.at(walk[k]), arrangement.points.at(walk[(k + 1) % walk.len()]));
            (a - o).cross(&(b - o))
        });
        ring.fold(crate::geom::Vec3::zeros(), |s, c| s + c).norm()
    };
    let areas: Vec<f64> = loops.iter().map(area).collect();
    let largest = (0..loops.len()).fold(0, |m, k| if areas[k] > areas[m] { k } else { m });
    loops.swap(0, largest);
}

/// Cuts a walk at vertices that it visits twice, so that every loop is simple: a hole that touches the rim in a vertex becomes
/// a loop of its own, an edge that is walked back and forth a loop of two.
fn split_simple(walk: Vec<u32>, loops: &mut Vec<Vec<u32>>) {
    if !has_repeats(&walk) {
        loops.push(walk);
        return;
    }
    let mut path: Vec<u32> = Vec::with_capacity(walk.len());
    for v in walk {
        if let Some(k) = path.iter().position(|&w| w == v) {
            loops.push(path.split_off(k));
        }
        path.push(v);
    }
    loops.push(path);
}

fn has_repeats(walk: &[u32]) -> bool {
    if walk.len() <= SHORT_WALK {
        return walk.iter().enumerate().any(|(k, v)| walk[..k].contains(v));
    }
    let mut sorted = walk.to_vec();
    sorted.sort_unstable();
    sorted.windows(2).any(|w| w[0] == w[1])
}

/// A point inside a merged facet stays listed if another facet has it on its rim.
fn keep_lone_points(facets: &mut [SelectedFacet], count: usize, inner: impl Iterator<Item = (u32, u32)>) {
    let mut is_on_rim = vec![false; count];
    for &p in facets.iter().flat_map(|f| f.loops.iter().flatten()) {
        is_on_rim[p as usize] = true;
    }
    // What the facets that have such points list, by facet and point: some have thousands of both.
    let mut listed: IndexSet<(u32, u32)> = IndexSet::default();
    let mut is_known = vec![false; facets.len()];
    for (point, facet) in inner.filter(|&(point, _)| is_on_rim[point as usize]) {
        let loops = &mut facets[facet as usize].loops;
        if !std::mem::replace(&mut is_known[facet as usize], true) {
            listed.extend(loops.iter().flatten().map(|&p| (facet, p)));
        }
        if listed.insert((facet, point)) {
            loops.push(vec![point]);
        }
    }
}

/// Marks the facets that do not consist of all pieces of their source.
fn mark_partial(arrangement: &Arrangement, facets: &mut [SelectedFacet], kept: &[bool], facet_of_set: &[u32], set_of: &[u32]) {
    let cells = &arrangement.cells;
    let mut first = Vec::new();
    for owner in (0..cells.len()).flat_map(|c| cells.owners_of(c)) {
        let leaf = owner.leaf.index();
        if first.len() <= leaf + 1 {
            first.resize(leaf + 2, 0u32);
        }
        first[leaf + 1] = first[leaf + 1].max(owner.facet + 1);
    }
    for leaf in 1..first.len() {
        first[leaf] += first[leaf - 1];
    }
    let slot = |leaf: LeafId, facet: u32| (first[leaf.index()] + facet) as usize;
    let mut pieces = vec![0u32; first.last().map_or(0, |n| *n as usize)];
    let mut mine = vec![0u32; facets.len()];
    for cell in 0..cells.len() {
        for owner in cells.owners_of(cell) {
            pieces[slot(owner.leaf, owner.facet)] += 1;
        }
        if kept[cell] {
            mine[facet_of_set[set_of[cell] as usize] as usize] += 1;
        }
    }
    for (facet, count) in facets.iter_mut().zip(mine) {
        facet.is_partial = pieces[slot(facet.source.0, facet.source.1)] != count;
    }
}
