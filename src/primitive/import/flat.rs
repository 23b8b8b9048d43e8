//! Facets without area, as programs leave them where an edge ends within another one: the facet beyond their longest edge takes
//! their corners, so that the surface stays closed.

use super::Surface;
use crate::geom::Vec3;
use crate::geom::hash::IndexMap;
use crate::geom::lists::Lists;
use crate::geom::polygon::vector_area;
use std::collections::VecDeque;

/// Distance from a line that is rounding, in flatnesses of the surface: products over its length, from another corner than the
/// area was, round by up to two, and corners taken from another facet by as much again.
const LINE: f64 = 4.0;

/// The polygon of an edge that several have.
const SEVERAL: u32 = u32::MAX;

/// Takes polygons without area out of the surface, all that have one neighbour beyond their longest edge and their other
/// corners on it, to rounding, and in order along it; the others stay. O(n) if there are any, plus the corners of those that
/// are changed.
pub(super) fn absorb(surface: &mut Surface) {
    let flatness = surface.flatness();
    let is_flat = |walk: &[u32]| vector_area([walk], &surface.points) == Vec3::zeros();
    let flat: VecDeque<u32> = (0u32..).zip(surface.polygons.iter()).filter(|(_, walk)| is_flat(walk)).map(|(k, _)| k).collect();
    if flat.is_empty() {
        return;
    }
    let mut walks: Vec<Vec<u32>> = surface.polygons.iter().map(<[u32]>::to_vec).collect();
    let mut polygon_of: IndexMap<[u32; 2], u32> = IndexMap::default();
    for (walk, k) in walks.iter().zip(0u32..) {
        for side in sides(walk) {
            polygon_of.entry(side).and_modify(|owner| *owner = SEVERAL).or_insert(k);
        }
    }
    let mut waiting = flat;
    while let Some(k) = waiting.pop_front() {
        let walk = &walks[k as usize];
        let Some((ends, between)) = line_of(walk, &surface.points, flatness) else { continue };
        let back = [ends[1], ends[0]];
        // A polygon may have lost the side in a spike.
        let is_beyond = |&n: &u32| n != SEVERAL && n != k && sides(&walks[n as usize]).any(|side| side == back);
        let Some(beyond) = polygon_of.get(&back).copied().filter(is_beyond) else { continue };
        let joined = without_spikes(spliced(&walks[beyond as usize], back, &between));
        for side in sides(&joined) {
            polygon_of.entry(side).and_modify(|owner| *owner = if *owner == k { beyond } else { *owner });
        }
        polygon_of.remove(&ends);
        polygon_of.remove(&back);
        walks[k as usize].clear();
        walks[beyond as usize] = joined;
        // What it took may have left it without area.
        if walks[beyond as usize].len() >= 3 {
            waiting.push_back(beyond);
        }
    }
    let mut polygons = Lists::default();
    let mut group_of = Vec::with_capacity(walks.len());
    for (walk, &group) in walks.iter().zip(&surface.group_of).filter(|(walk, _)| walk.len() >= 3) {
        polygons.push(walk.iter().copied());
        group_of.push(group);
    }
    (surface.polygons, surface.group_of) = (polygons, group_of);
}

fn sides(walk: &[u32]) -> impl Iterator<Item = [u32; 2]> {
    (0..walk.len()).map(|k| [walk[k], walk[(k + 1) % walk.len()]])
}

/// The longest side of a polygon on a line, and its other corners from the end of that side back to its begin; `None` if they
/// do not follow each other along it, or one lies further off than rounding (halves of equal area may turn against each other).
fn line_of(walk: &[u32], points: &[Vec3], flatness: f64) -> Option<([u32; 2], Vec<u32>)> {
    let p = |v: u32| points[v as usize];
    let length = |k: usize| (p(walk[(k + 1) % walk.len()]) - p(walk[k])).norm_squared();
    let longest = (0..walk.len()).max_by(|&a, &b| length(a).total_cmp(&length(b)))?;
    let around: Vec<u32> = (1..=walk.len()).map(|k| walk[(longest + k) % walk.len()]).collect();
    let (&end, &begin) = (around.first()?, around.last()?);
    let along = p(begin) - p(end);
    let is_onward = around.windows(2).all(|pair| along.dot(&(p(pair[1]) - p(pair[0]))) > 0.0);
    let is_near = |&v: &u32| along.cross(&(p(v) - p(end))).norm() <= LINE * flatness * along.norm();
    (is_onward && around.iter().all(is_near)).then(|| ([begin, end], around[1..around.len() - 1].to_vec()))
}

/// A walk with corners put into one of its sides.
fn spliced(walk: &[u32], side: [u32; 2], between: &[u32]) -> Vec<u32> {
    let mut found = Vec::with_capacity(walk.len() + between.len());
    for [a, b] in sides(walk) {
        found.push(a);
        if [a, b] == side {
            found.extend(between);
        }
    }
    found
}

/// A walk without corners from which it turns right back.
fn without_spikes(mut walk: Vec<u32>) -> Vec<u32> {
    while walk.len() >= 3 {
        let n = walk.len();
        let Some(k) = (0..n).find(|&k| walk[(k + n - 1) % n] == walk[(k + 1) % n]) else { break };
        // The corner, and one of the two equal ones beside it.
        let mut gone = [k, (k + 1) % n];
        gone.sort_unstable();
        walk.remove(gone[1]);
        walk.remove(gone[0]);
    }
    walk
}
