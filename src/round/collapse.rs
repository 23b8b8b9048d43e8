//! Points that are nearer than a few units in the last place become one vertex.

use crate::geom::Vec3;
use crate::geom::hash::IndexMap;
use crate::geom::polygon;
use crate::geom::predicates::Projection;

/// Walks up to which comparing all pairs is faster than sorting.
const SHORT_WALK: usize = 16;

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

/// Makes the loops of one facet simple again. An edge walked in both directions bounds nothing there: it, and a loop that
/// collapsed to a point, is a place where something touches, and stays if it lies inside. A loop is cut where it visits a
/// vertex twice. What the facet covers stays the same.
pub fn tidy(facet: &mut Vec<Vec<u32>>, points: &[Vec3]) {
    if facet.iter().all(|walk| walk.len() >= 3) && !has_repeats(facet) {
        return;
    }
    let mut touching: Vec<Vec<u32>> = facet.iter().filter(|w| w.iter().all(|v| *v == w[0])).map(|w| vec![w[0]]).collect();
    let edges = facet.iter().flat_map(|w| (0..w.len()).map(|k| [w[k], w[(k + 1) % w.len()]])).filter(|[a, b]| a != b);
    let mut left: Vec<Option<[u32; 2]>> = Vec::new();
    let mut unmatched: IndexMap<[u32; 2], Vec<usize>> = IndexMap::default();
    for [a, b] in edges {
        match unmatched.get_mut(&[b, a]).and_then(Vec::pop) {
            Some(k) => touching.extend(left[k].take().map(Vec::from)),
            None => {
                unmatched.entry([a, b]).or_default().push(left.len());
                left.push(Some([a, b]));
            }
        }
    }
    *facet = simple_loops(left.into_iter().flatten().collect());
    put_outer_first(facet, points);
    touching.iter_mut().for_each(|t| t.sort_unstable());
    touching.sort_unstable_by_key(|t| (std::cmp::Reverse(t.len()), t.clone()));
    touching.dedup();
    let is_inside = within(facet, points);
    let is_rim = |t: &[u32]| {
        t.len() == 2 && [[t[0], t[1]], [t[1], t[0]]].iter().any(|e| unmatched.get(e).is_some_and(|k| !k.is_empty()))
    };
    for found in touching {
        let middle = found.iter().map(|&v| points[v as usize]).sum::<Vec3>() / found.len() as f64;
        let is_known = is_rim(&found) || found.len() == 1 && facet.iter().any(|walk| walk.contains(&found[0]));
        if !is_known && is_inside(&middle) {
            facet.push(found);
        }
    }
}

/// The loop of the largest area comes first.
pub fn put_outer_first(facet: &mut [Vec<u32>], points: &[Vec3]) {
    let size = |walk: &Vec<u32>| polygon::vector_area([&walk[..]], points).norm();
    let sizes: Vec<f64> = facet.iter().map(size).collect();
    let outer = (0..sizes.len()).fold(0, |m, k| if sizes[k] > sizes[m] { k } else { m });
    if !facet.is_empty() {
        facet[..=outer].rotate_right(1);
    }
}

/// Whether loops visit a vertex twice.
fn has_repeats(facet: &[Vec<u32>]) -> bool {
    if let [walk] = facet
        && walk.len() <= SHORT_WALK
    {
        return walk.iter().enumerate().any(|(k, v)| walk[..k].contains(v));
    }
    let mut all = facet.concat();
    all.sort_unstable();
    all.windows(2).any(|w| w[0] == w[1])
}

/// Closed walks over directed edges, cut at vertices that they visit twice. As many edges end in a vertex as begin there.
pub fn simple_loops(edges: Vec<[u32; 2]>) -> Vec<Vec<u32>> {
    let mut from: IndexMap<u32, Vec<usize>> = IndexMap::default();
    for (k, edge) in edges.iter().enumerate().rev() {
        from.entry(edge[0]).or_default().push(k);
    }
    let mut loops: Vec<Vec<usize>> = Vec::new();
    let mut path: Vec<usize> = Vec::new();
    let mut step_of: IndexMap<u32, usize> = IndexMap::default();
    for &[start, _] in &edges {
        let mut at = start;
        while let Some(k) = from.get_mut(&at).and_then(Vec::pop) {
            step_of.insert(at, path.len());
            path.push(k);
            at = edges[k][1];
            if let Some(&first) = step_of.get(&at) {
                let mut cut = path.split_off(first);
                for &k in &cut {
                    step_of.remove(&edges[k][0]);
                }
                let lowest = (0..cut.len()).min_by_key(|&i| cut[i]).unwrap_or(0);
                cut.rotate_left(lowest);
                loops.push(cut);
            }
        }
    }
    // Loops and their starts in the order in which they came.
    loops.sort_unstable();
    loops.into_iter().map(|l| l.into_iter().map(|k| edges[k][0]).collect()).collect()
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

/// A direction in which hardly any two places of a model have the same height, of a length below 1.
const OBLIQUE: Vec3 = Vec3::new(0.618_03, 0.414_21, 0.577_35);
/// Heights may differ by this many times the reach where places do not: rounding takes some units in the last place from each.
const HEIGHTS: f64 = 4.0;

/// For every used place the place that represents it: the first that is near.
fn number_places(facets: &Loops, places: &[Vec3], explicit: usize, reach: f64) -> Vec<u32> {
    let mut is_used = vec![false; places.len()];
    for &p in facets.iter().flatten().flatten() {
        is_used[p as usize] = true;
    }
    let mut number: Vec<u32> = (0..places.len() as u32).collect();
    let used = |from: usize, to: usize| (from as u32..to as u32).filter(|&p| is_used[p as usize]);
    let explicit = explicit.min(places.len());
    if used(explicit, places.len()).next().is_none() {
        return number;
    }
    let mut by_height: Vec<(f64, u32)> = used(0, places.len()).map(|p| (places[p as usize].dot(&OBLIQUE), p)).collect();
    by_height.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut rank = vec![0; places.len()];
    by_height.iter().enumerate().for_each(|(k, &(_, p))| rank[p as usize] = k);
    for p in used(explicit, places.len()) {
        let (at, place) = (rank[p as usize], &places[p as usize]);
        let is_level = |other: &&(f64, u32)| (other.0 - by_height[at].0).abs() <= HEIGHTS * reach;
        let beside = by_height[..at].iter().rev().take_while(is_level).chain(by_height[at + 1..].iter().take_while(is_level));
        let represents = |q: &u32| *q < p && number[*q as usize] == *q && (places[*q as usize] - place).norm() <= reach;
        if let Some(first) = beside.map(|other| other.1).filter(represents).min() {
            number[p as usize] = first;
        }
    }
    number
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
        assert_eq!(tidied(&[&[0, 1, 2, 1, 3]]), [[0, 1, 3]]);
        assert!(tidied(&[&[0, 1, 0, 1]]).is_empty());
        assert_eq!(tidied(&[&[4, 0, 1, 3, 0]]), [vec![0, 1, 3], vec![0, 4]]);
    }

    #[test]
    fn loops_part_where_they_touch_themselves_and_join_where_they_share_an_edge() {
        // Two triangles that touch in 2; a square and a hole that has come to its edge 1-2.
        assert_eq!(tidied(&[&[0, 1, 2, 3, 5, 2]]), [[0, 1, 2], [2, 3, 5]]);
        assert_eq!(tidied(&[&[0, 1, 2, 3], &[4, 2, 1]]), [[0, 1, 4, 2, 3]]);
    }

    /// Loops over the corners of a square, a point inside and one above, tidied.
    fn tidied(loops: &[&[u32]]) -> Vec<Vec<u32>> {
        let places = [[0., 0.], [9., 0.], [9., 9.], [0., 9.], [6., 5.], [0., 18.]].map(|[x, y]| Vec3::new(x, y, 0.0));
        let mut facet: Vec<Vec<u32>> = loops.iter().map(|l| l.to_vec()).collect();
        tidy(&mut facet, &places);
        facet
    }
}
