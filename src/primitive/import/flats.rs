//! Pieces of one plane become one facet: files of triangles hold many that were one, and fewer facets are intersected, written
//! and meshed faster.

use super::Surface;
use super::sides::Sides;
use crate::geom::Vec3;
use crate::geom::hash::IndexMap;
use crate::geom::lists::Lists;
use crate::geom::polygon::{is_planar, triangulate, vector_area};
use crate::geom::union_find::UnionFind;
use crate::primitive::solid::Facets;

/// The facets of the surface, where every set of polygons of one group that lie within `flatness` of a plane, and are together
/// a polygon, with holes or without, that has no further point inside, is that polygon; `None` if there is no such set. The
/// volume changes by rounding only. O(n log n).
pub(super) fn join(surface: &Surface, sides: &Sides, flatness: f64) -> Option<Facets> {
    let count = surface.polygons.count();
    let planes: Vec<Plane> = surface.polygons.iter().map(|walk| Plane::of(walk, &surface.points)).collect();
    let mut sets = UnionFind::new(count);
    let mut is_joined = false;
    for (_, sides) in sides.edges() {
        let &[a, b] = sides else { continue };
        let [a, b] = [a.polygon(), b.polygon()];
        if surface.group_of[a as usize] != surface.group_of[b as usize] {
            continue;
        }
        let [p, q] = [a, b].map(|k| &planes[k as usize]);
        let is_level = |plane: &Plane, k: u32| plane.holds(surface.polygons.of(k), &surface.points, flatness);
        if p.normal.dot(&q.normal) > 0.0 && is_level(p, b) && is_level(q, a) {
            sets.join(a, b);
            is_joined = true;
        }
    }
    is_joined.then(|| collect(surface, sets, flatness)).flatten()
}

/// Corners of a joined polygon at most: the evaluator looks at all pairs of some of a facet's corners, so that very large
/// polygons cost more than their triangles (two cylinders of 8000 segments 2.7 times as much, of 32000 seven times).
const MOST_CORNERS: usize = 1000;

struct Plane {
    origin: Vec3,
    normal: Vec3,
}

impl Plane {
    fn of(walk: &[u32], points: &[Vec3]) -> Self {
        Self { origin: points[walk[0] as usize], normal: vector_area([walk], points).normalize() }
    }
    fn holds(&self, walk: &[u32], points: &[Vec3], flatness: f64) -> bool {
        walk.iter().all(|&v| (points[v as usize] - self.origin).dot(&self.normal).abs() <= flatness)
    }
}

/// Each set in the place of its first polygon, as one facet where it can be.
fn collect(surface: &Surface, sets: UnionFind, flatness: f64) -> Option<Facets> {
    let (set_of, count) = sets.number();
    let members = Lists::from_iter(count, set_of.into_iter().zip(0u32..));
    if members.count() == surface.polygons.count() {
        return None;
    }
    let mut facets = Facets::default();
    for own in members.iter() {
        let group = surface.group_of[own[0] as usize];
        match (own.len() > 1).then(|| outline(surface, own, flatness)).flatten() {
            Some(loops) => facets.push(loops, group),
            None => own.iter().for_each(|&k| facets.push([surface.polygons.of(k).iter().copied()], group)),
        }
    }
    Some(facets)
}

/// The loops around polygons, the outer one first, if they bound a polygon of few enough corners that has all their points.
fn outline(surface: &Surface, own: &[u32], flatness: f64) -> Option<Vec<Vec<u32>>> {
    let walks = || own.iter().map(|&k| surface.polygons.of(k));
    let sides = || walks().flat_map(|w| (0..w.len()).map(move |k| [w[k], w[(k + 1) % w.len()]]));
    let mut all: Vec<[u32; 2]> = sides().collect();
    all.sort_unstable();
    let mut next: IndexMap<u32, u32> = IndexMap::default();
    for &[a, b] in all.iter().filter(|[a, b]| all.binary_search(&[*b, *a]).is_err()) {
        if next.insert(a, b).is_some() {
            return None;
        }
    }
    let mut points: Vec<u32> = all.iter().map(|side| side[0]).collect();
    points.dedup();
    if next.len() != points.len() || points.len() > MOST_CORNERS {
        return None;
    }
    let mut loops: Vec<Vec<u32>> = Vec::new();
    for [start, _] in sides() {
        let (mut walk, mut at) = (Vec::new(), start);
        while let Some(onward) = next.remove(&at) {
            walk.push(at);
            at = onward;
        }
        if at != start {
            return None;
        }
        loops.extend((!walk.is_empty()).then_some(walk));
    }
    let area = |walks: &[Vec<u32>]| vector_area(walks.iter().map(Vec::as_slice), &surface.points);
    let whole = area(&loops);
    // Holes turn the other way.
    let is_outer = |walk: &Vec<u32>| area(std::slice::from_ref(walk)).dot(&whole) > 0.0;
    let outer = loops.iter().position(is_outer)?;
    loops[..=outer].rotate_right(1);
    let all: Vec<&[u32]> = loops.iter().map(Vec::as_slice).collect();
    let is_one = loops.iter().skip(1).all(|walk| !is_outer(walk));
    // Walked around inside out, it would turn over.
    let is_along = || walks().all(|w| vector_area([w], &surface.points).dot(&whole) > 0.0);
    let triangles = points.len() + 2 * (loops.len() - 1);
    let is_simple = || triangulate(&all, &[], &[], &surface.points).is_ok_and(|t| t.len() + 2 == triangles);
    (is_one && is_planar(&all, &surface.points, flatness) && is_along() && is_simple()).then_some(loops)
}
