//! Vertices left in the middle of a straight edge go.

use crate::geom::Vec3;
use crate::geom::lists::Lists;
use crate::geom::segment::distance_to;

/// Neighbours of every point along the rims of all facets, ascending.
struct Rims {
    neighbours: Vec<u32>,
    ends: Vec<u32>,
}

impl Rims {
    fn new(facets: &[Vec<Vec<u32>>], count: usize) -> Self {
        let mut pairs: Vec<(u32, u32)> = Vec::new();
        for walk in facets.iter().flatten().filter(|w| w.len() > 1) {
            for (k, &a) in walk.iter().enumerate() {
                let b = walk[(k + 1) % walk.len()];
                pairs.extend([(a, b), (b, a)]);
            }
        }
        let all = Lists::new(count, &pairs);
        let (mut neighbours, mut ends, mut own) = (Vec::with_capacity(pairs.len() / 2), vec![0], Vec::new());
        for p in 0..count as u32 {
            own.clear();
            own.extend_from_slice(all.of(p));
            own.sort_unstable();
            own.dedup();
            neighbours.extend_from_slice(&own);
            ends.push(neighbours.len() as u32);
        }
        Self { neighbours, ends }
    }

    fn of(&self, p: u32) -> &[u32] {
        &self.neighbours[self.ends[p as usize] as usize..self.ends[p as usize + 1] as usize]
    }
}

/// Removes every point that has two neighbours only, is not listed alone, and lies within `tolerance` of the straight edge that
/// replaces it (so does every other point that this edge replaces).
pub fn dissolve(facets: &mut [Vec<Vec<u32>>], places: &[Vec3], tolerance: f64) {
    let rims = Rims::new(facets, places.len());
    let mut is_passing: Vec<bool> = (0..places.len() as u32).map(|p| rims.of(p).len() == 2).collect();
    for walk in facets.iter().flatten().filter(|w| w.len() == 1) {
        is_passing[walk[0] as usize] = false;
    }
    let mut is_gone = vec![false; places.len()];
    let mut is_seen = vec![false; places.len()];
    // A point stays if the chain bends there; bends are the natural starts.
    let bends = |p: u32| match rims.of(p) {
        &[a, b] => distance_to(&places[p as usize], [&places[a as usize], &places[b as usize]]) > tolerance,
        _ => true,
    };
    let is_start: Vec<bool> =
        (0..places.len() as u32).map(|p| !rims.of(p).is_empty() && (!is_passing[p as usize] || bends(p))).collect();
    for start in (0..places.len() as u32).filter(|&p| is_start[p as usize]) {
        for &first in rims.of(start) {
            if !is_start[first as usize] && !is_seen[first as usize] {
                let chain = chain(&rims, &is_start, &mut is_seen, start, first);
                straighten(&chain, places, tolerance, &mut is_gone);
            }
        }
    }
    for walk in facets.iter_mut().flatten().filter(|w| w.len() > 2) {
        walk.retain(|&p| !is_gone[p as usize]);
    }
    facets.iter_mut().for_each(|facet| join_touching(facet, &is_gone));
}

/// Edges that touch a facet inside are loops of two: where their common point is gone, they are one edge.
fn join_touching(facet: &mut Vec<Vec<u32>>, is_gone: &[bool]) {
    let gone_in = |walk: &Vec<u32>| walk.iter().position(|&p| walk.len() == 2 && is_gone[p as usize]);
    while let Some((first, end)) = facet.iter().enumerate().find_map(|(k, walk)| Some((k, gone_in(walk)?))) {
        let [p, a] = [facet[first][end], facet[first][1 - end]];
        facet.remove(first);
        if let Some(next) = facet.iter_mut().find(|walk| walk.len() == 2 && walk.contains(&p)) {
            next.iter_mut().filter(|v| **v == p).for_each(|v| *v = a);
        }
    }
}

/// From a start through passing points to the next start.
fn chain(rims: &Rims, is_start: &[bool], is_seen: &mut [bool], start: u32, first: u32) -> Vec<u32> {
    let (mut out, mut before, mut at) = (vec![start], start, first);
    while !is_start[at as usize] {
        is_seen[at as usize] = true;
        out.push(at);
        let next = rims.of(at).iter().copied().find(|&n| n != before).unwrap_or(start);
        (before, at) = (at, next);
    }
    out.push(at);
    out
}

/// Marks the inner points of a chain that a straight edge may replace, as long edges as possible from the front.
fn straighten(chain: &[u32], places: &[Vec3], tolerance: f64, is_gone: &mut [bool]) {
    let at = |k: usize| &places[chain[k] as usize];
    let mut anchor = 0;
    for k in 1..chain.len() - 1 {
        let is_straight = (anchor + 1..=k).all(|i| distance_to(at(i), [at(anchor), at(k + 1)]) <= tolerance);
        // A closed chain must not shrink to an edge walked twice.
        if is_straight && chain[anchor] != chain[k + 1] {
            is_gone[chain[k] as usize] = true;
        } else {
            anchor = k;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn middle_points_go_and_corners_stay() {
        let p = |x: f64, y: f64| Vec3::new(x, y, 0.0);
        let places = [p(0., 0.), p(1., 0.), p(2., 0.), p(2., 2.), p(0., 2.), p(0., 1.)];
        let mut facets = vec![vec![vec![0, 1, 2, 3, 4, 5]]];
        dissolve(&mut facets, &places, 1e-9);
        assert_eq!(facets[0][0], vec![0, 2, 3, 4]);
    }

    #[test]
    fn a_touching_edge_of_two_pieces_becomes_one() {
        let p = |x: f64, y: f64, z: f64| Vec3::new(x, y, z);
        let places = [
            p(0., 0., 0.),
            p(4., 0., 0.),
            p(4., 4., 0.),
            p(0., 4., 0.),
            p(1., 1., 0.),
            p(2., 1., 0.),
            p(3., 1., 0.),
            p(2., 1., 1.),
        ];
        // A fin stands on a square along 4-5-6.
        let mut facets = vec![vec![vec![0, 1, 2, 3], vec![4, 5], vec![5, 6]], vec![vec![4, 5, 6, 7]]];
        dissolve(&mut facets, &places, 1e-9);
        assert_eq!(facets, [vec![vec![0, 1, 2, 3], vec![4, 6]], vec![vec![4, 6, 7]]]);
    }

    #[test]
    fn a_point_that_a_neighbour_needs_stays() {
        let p = |x: f64, y: f64| Vec3::new(x, y, 0.0);
        let places = [p(0., 0.), p(1., 0.), p(2., 0.), p(1., 2.), p(1., -2.)];
        // Two facets over the edge 0-1-2; a third ends at its middle.
        let mut facets = vec![vec![vec![0, 1, 2, 3]], vec![vec![0, 4, 1]]];
        dissolve(&mut facets, &places, 1e-9);
        assert_eq!(facets[0][0], vec![0, 1, 2, 3]);
        assert_eq!(facets[1][0], vec![0, 4, 1]);
    }
}
