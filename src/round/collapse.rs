//! Points that are nearer than a few units in the last place become one vertex.

use crate::geom::Vec3;
use crate::geom::hash::IndexMap;
use crate::geom::polygon;
use crate::geom::predicates::Projection;

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
        tidy(facet, &points);
    }
    (points, facets)
}

/// Drops what collapsed in one facet. A hole or a slit that collapsed to a line or a point is a place where something touches.
fn tidy(facet: &mut Vec<Vec<u32>>, points: &[Vec3]) {
    let is_proper = |walk: &Vec<u32>| {
        let n = walk.len();
        n >= 3 && (0..n).all(|k| walk[k] != walk[(k + 1) % n] && walk[k] != walk[(k + 2) % n])
    };
    if facet.iter().all(is_proper) {
        return;
    }
    let mut touching: Vec<Vec<u32>> = Vec::new();
    for walk in facet.iter_mut() {
        let first = walk[0];
        let is_point = walk.iter().all(|&v| v == first);
        *walk = without_spikes(std::mem::take(walk), &mut touching);
        if is_point {
            touching.push(vec![first]);
        }
    }
    if facet.first().is_some_and(|outer| outer.len() < 3) {
        facet.clear();
        return;
    }
    facet.retain(|walk| walk.len() >= 3);
    touching.iter_mut().for_each(|t| t.sort_unstable());
    touching.sort_unstable_by_key(|t| (std::cmp::Reverse(t.len()), t.clone()));
    touching.dedup();
    let is_inside = within(facet, points);
    for found in touching {
        let middle = found.iter().map(|&v| points[v as usize]).sum::<Vec3>() / found.len() as f64;
        let is_known = found.len() == 1 && facet.iter().any(|walk| walk.contains(&found[0]));
        if !is_known && is_inside(&middle) {
            facet.push(found);
        }
    }
}

/// Tells whether a place in the plane of a polygon is inside of it, to rounding.
fn within(loops: &[Vec<u32>], points: &[Vec3]) -> impl Fn(&Vec3) -> bool + use<> {
    let projection = Projection::along(&polygon::vector_area(loops.iter().map(|l| &l[..]), points));
    let ends = loops.iter().flat_map(|l| (0..l.len()).map(|k| [l[k], l[(k + 1) % l.len()]]));
    let edges: Vec<[[f64; 2]; 2]> = ends.map(|e| e.map(|v| projection.apply(&points[v as usize]))).collect();
    move |place| {
        let [x, y] = projection.apply(place);
        let is_left =
            |[a, b]: &&[[f64; 2]; 2]| (a[1] > y) != (b[1] > y) && x < a[0] + (b[0] - a[0]) * (y - a[1]) / (b[1] - a[1]);
        edges.iter().filter(is_left).count() % 2 == 1
    }
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

/// Drops repeated neighbours and steps back and forth, which are added to `spikes`.
fn without_spikes(walk: Vec<u32>, spikes: &mut Vec<Vec<u32>>) -> Vec<u32> {
    if walk.len() <= 2 {
        spikes.push(walk);
        return Vec::new();
    }
    let mut out: Vec<u32> = Vec::with_capacity(walk.len());
    for v in walk {
        if out.last() == Some(&v) {
            continue;
        }
        if out.len() >= 2 && out[out.len() - 2] == v {
            spikes.extend(out.pop().map(|tip| vec![v, tip]));
            continue;
        }
        out.push(v);
    }
    loop {
        let n = out.len();
        if n > 1 && out[0] == out[n - 1] {
            out.pop();
        } else if n > 2 && out[1] == out[n - 1] {
            out.pop();
            spikes.push(vec![out.remove(0), out[0]]);
        } else if n > 2 && out[0] == out[n - 2] {
            spikes.extend(out.pop().map(|tip| vec![out[0], tip]));
            out.pop();
        } else {
            if n == 2 {
                spikes.push(std::mem::take(&mut out));
            }
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
    fn a_hole_that_collapses_is_a_touching_point_and_an_inner_slit_a_touching_edge() {
        let p = |x: f64, y: f64| Vec3::new(x, y, 0.0);
        let places =
            [p(0., 0.), p(8., 0.), p(8., 8.), p(0., 8.), p(6., 6.), p(6., 6.), p(6., 6.), p(2., 2.), p(0., 0.), p(9., 0.)];
        let square = vec![0, 1, 9, 1, 2, 3, 8, 7];
        let (_, loops) = weld(vec![vec![square, vec![4, 5, 6]]], &places, 4, 1e-15);
        assert_eq!(loops[0], vec![vec![0, 1, 3, 4], vec![0, 5], vec![6]]);
    }

    #[test]
    fn spikes_go() {
        assert_eq!(without_spikes(vec![0, 1, 2, 1, 3], &mut Vec::new()), vec![0, 1, 3]);
        assert!(without_spikes(vec![0, 1, 0, 1], &mut Vec::new()).len() < 3);
        let mut spikes = Vec::new();
        assert_eq!(without_spikes(vec![4, 0, 1, 3, 0], &mut spikes), vec![0, 1, 3]);
        assert_eq!(spikes, vec![vec![4, 0]]);
    }
}
