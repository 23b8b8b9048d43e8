//! Points that are nearer than a few units in the last place become one vertex.

use crate::geom::Vec3;
use crate::geom::hash::IndexMap;

/// Facets' loops over rounded vertices.
pub type Loops = Vec<Vec<Vec<u32>>>;

/// Numbers the used places in order of first use; places within `reach` of an earlier one get its number, and what collapses is
/// dropped: repeated vertices, loops that become lines. A facet whose outer loop collapses keeps no loop.
///
/// The first `explicit` places are vertices that contact has kept apart; they win over intersection points.
pub fn weld(mut facets: Loops, places: &[Vec3], explicit: usize, reach: f64) -> (Vec<Vec3>, Loops) {
    let number = number_places(&facets, places, explicit, reach);
    let mut points = Vec::new();
    let mut slot = vec![u32::MAX; places.len()];
    let mut vertex = |p: u32| {
        let p = number[p as usize] as usize;
        if slot[p] == u32::MAX {
            slot[p] = points.len() as u32;
            // Adding zero turns -0 into 0, so that both are one place.
            points.push(places[p].map(|x| x + 0.0));
        }
        slot[p]
    };
    for v in facets.iter_mut().flatten().flatten() {
        *v = vertex(*v);
    }
    for facet in &mut facets {
        tidy(facet);
    }
    (points, facets)
}

/// Drops what collapsed in one facet.
fn tidy(facet: &mut Vec<Vec<u32>>) {
    let is_proper = |walk: &Vec<u32>| {
        let n = walk.len();
        n >= 3 && (0..n).all(|k| walk[k] != walk[(k + 1) % n] && walk[k] != walk[(k + 2) % n])
    };
    if facet.iter().all(is_proper) {
        return;
    }
    let was: Vec<usize> = facet.iter().map(Vec::len).collect();
    for walk in facet.iter_mut() {
        *walk = without_spikes(std::mem::take(walk));
    }
    if facet.first().is_some_and(|outer| outer.len() < 3) {
        facet.clear();
        return;
    }
    // A hole that collapsed is still a place where something touches, and is found as such by the exact test.
    let mut k = 0;
    facet.retain(|walk| {
        k += 1;
        walk.len() >= 3 || was[k - 1] <= 2
    });
}

/// For every used place the place that represents it.
fn number_places(facets: &Loops, places: &[Vec3], explicit: usize, reach: f64) -> Vec<u32> {
    let mut is_used = vec![false; places.len()];
    for &p in facets.iter().flatten().flatten() {
        is_used[p as usize] = true;
    }
    let mut number: Vec<u32> = (0..places.len() as u32).collect();
    // A grid of twice the reach: what is near lies in at most eight cells. Only the cells that an intersection point sees matter.
    let cell = 2.0 * reach;
    let key = |p: usize, d: f64| [0, 1, 2].map(|k| ((places[p][k] + d) / cell).floor() as i64);
    let cells_near = |p: usize| {
        let (lo, hi) = (key(p, -reach), key(p, reach));
        let line = move |x: i64, y: i64| (lo[2]..=hi[2]).map(move |z| [x, y, z]);
        (lo[0]..=hi[0]).flat_map(move |x| (lo[1]..=hi[1]).flat_map(move |y| line(x, y)))
    };
    let intersections = || (explicit.min(places.len())..places.len()).filter(|&p| is_used[p]);
    let mut grid: IndexMap<[i64; 3], Vec<u32>> = intersections().flat_map(cells_near).map(|seen| (seen, Vec::new())).collect();
    if grid.is_empty() {
        return number;
    }
    for p in (0..explicit).filter(|&p| is_used[p]) {
        if let Some(here) = grid.get_mut(&key(p, 0.0)) {
            here.push(p as u32);
        }
    }
    for p in intersections() {
        let is_close = |q: &&u32| (places[**q as usize] - places[p]).norm() <= reach;
        match cells_near(p).find_map(|seen| grid.get(&seen)?.iter().find(is_close).copied()) {
            Some(q) => number[p] = q,
            None => grid.entry(key(p, 0.0)).or_default().push(p as u32),
        }
    }
    number
}

/// Drops repeated neighbours and steps back and forth.
fn without_spikes(walk: Vec<u32>) -> Vec<u32> {
    if walk.len() <= 2 {
        return walk;
    }
    let mut out: Vec<u32> = Vec::with_capacity(walk.len());
    for v in walk {
        if out.last() == Some(&v) {
            continue;
        }
        if out.len() >= 2 && out[out.len() - 2] == v {
            out.pop();
            continue;
        }
        out.push(v);
    }
    loop {
        let n = out.len();
        if n > 1 && out[0] == out[n - 1] {
            out.pop();
        } else if n > 2 && (out[1] == out[n - 1] || out[0] == out[n - 2]) {
            if out[1] == out[n - 1] {
                out.remove(0);
                out.pop();
            } else {
                out.pop();
                out.pop();
            }
        } else {
            return out;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_places_are_one_vertex() {
        let places = [Vec3::zeros(), Vec3::x(), Vec3::y(), Vec3::x(), Vec3::new(-0.0, 0.0, 0.0)];
        let (points, loops) = weld(vec![vec![vec![0, 1, 2]], vec![vec![3, 4, 2]], vec![vec![0, 1, 3]]], &places, 3, 1e-15);
        assert_eq!(points.len(), 3);
        assert_eq!(loops, vec![vec![vec![0, 1, 2]], vec![vec![1, 0, 2]], vec![]]);
    }

    #[test]
    fn spikes_go() {
        assert_eq!(without_spikes(vec![0, 1, 2, 1, 3]), vec![0, 1, 3]);
        assert!(without_spikes(vec![0, 1, 0, 1]).len() < 3);
    }
}
