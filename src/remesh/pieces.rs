//! Cuts a planar facet across between marks on its border.

use crate::brep::complex::ComplexFacet;
use crate::geom::Vec3;
use crate::geom::polygon::triangulate;
use crate::ids::{Id, VertexId};
use std::collections::{BTreeMap, HashMap, HashSet};

/// Cosine of the angle between a chord and the border past which it runs along it (0.1 degrees).
const FLAT_COSINE: f64 = 1.0 - 1.5e-6;

/// A vertex to enter an edge, as seen from the edge's smaller end.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Mark {
    pub vertex: VertexId,
    /// Whether the band lies beyond, else before.
    pub is_hot_beyond: bool,
}

/// The marks of every edge in their order from its smaller end.
pub(super) type Marks = BTreeMap<[VertexId; 2], Vec<Mark>>;

/// The directed edges of loops.
pub(super) fn edges_of(loops: &[Vec<VertexId>]) -> impl Iterator<Item = [VertexId; 2]> + '_ {
    let proper = loops.iter().filter(|l| l.len() > 2);
    proper.flat_map(|l| (0..l.len()).map(move |k| [l[k], l[(k + 1) % l.len()]]))
}

/// A mark in a loop that has got it.
struct Placed {
    vertex: VertexId,
    /// The directed edge that it was put into.
    edge: [VertexId; 2],
    /// Whether the band follows in the loop, else precedes.
    is_opening: bool,
}

/// The facet with the marks of its edges, cut in pieces where marks of two edges bound the same band; whole if it cannot be
/// cut.
pub(super) fn cut_facet(mut facet: ComplexFacet, marks: &Marks, points: &[Vec3]) -> Vec<ComplexFacet> {
    let mut placed = Vec::new();
    for walk in facet.loops.iter_mut().filter(|l| l.len() > 2) {
        *walk = marked(walk, marks, &mut placed);
    }
    if placed.is_empty() {
        return vec![facet];
    }
    let chords = chords(&placed, points);
    let cut = |chords: &[[VertexId; 2]]| pieces(&facet, &tiles(&facet, chords, points)?, chords);
    cut(&chords).or_else(|| cut(&[])).unwrap_or_else(|| vec![facet.clone()])
}

/// The facet cut from each of some corners across; in triangles if a corner cannot be cut off.
pub(super) fn cut_at(facet: ComplexFacet, corners: &[VertexId], points: &[Vec3]) -> Vec<ComplexFacet> {
    let mut chords: Vec<[VertexId; 2]> = Vec::new();
    let mut triangles = facet.triangles.clone();
    for &corner in corners {
        if chords.iter().any(|c| c.contains(&corner)) {
            continue;
        }
        let found = chords_from(&facet.loops, corner, points).into_iter().find_map(|chord| {
            let all = [&chords[..], &[chord]].concat();
            tiles(&facet, &all, points).map(|t| (chord, t))
        });
        let Some((chord, cut)) = found else { return facet.divided().collect() };
        chords.push(chord);
        triangles = cut;
    }
    pieces(&facet, &triangles, &chords).unwrap_or_else(|| facet.divided().collect())
}

/// Chords from a corner of the outer loop to its others: those that cut off no triangle first, and of these the one that leaves
/// the largest angles.
fn chords_from(loops: &[Vec<VertexId>], corner: VertexId, points: &[Vec3]) -> Vec<[VertexId; 2]> {
    let walk = &loops[0];
    let n = walk.len();
    let Some(from) = walk.iter().position(|&v| v == corner) else { return Vec::new() };
    let point = |k: usize| points[walk[k % n].index()];
    let cosine = |at: usize, a: usize, b: usize| {
        let (u, v) = (point(a) - point(at), point(b) - point(at));
        u.dot(&v) / (u.norm() * v.norm())
    };
    let sharpest = |to: usize| {
        let sides = [(from, to), (to, from)].into_iter().flat_map(|(p, q)| [(p, q, p + 1), (p, q, p + n - 1)]);
        sides.map(|(at, a, b)| cosine(at, a, b)).fold(-1.0, f64::max)
    };
    let ends = (2..n - 1).map(|k| (k == 2 || k == n - 2, sharpest((from + k) % n), walk[(from + k) % n]));
    let mut ends: Vec<(bool, f64, VertexId)> = ends.filter(|e| e.1 < FLAT_COSINE).collect();
    ends.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    ends.into_iter().map(|(_, _, v)| [corner.min(v), corner.max(v)]).collect()
}

/// A loop with the marks of its edges.
fn marked(walk: &[VertexId], marks: &Marks, placed: &mut Vec<Placed>) -> Vec<VertexId> {
    let mut out = Vec::new();
    for (k, &a) in walk.iter().enumerate() {
        out.push(a);
        let b = walk[(k + 1) % walk.len()];
        let list = marks.get(&[a.min(b), a.max(b)]).map_or(&[][..], Vec::as_slice);
        let mut here: Vec<Placed> =
            list.iter().map(|m| Placed { vertex: m.vertex, edge: [a, b], is_opening: m.is_hot_beyond == (a < b) }).collect();
        if b < a {
            here.reverse();
        }
        out.extend(here.iter().map(|p| p.vertex));
        placed.extend(here);
    }
    out
}

/// Pairs of marks on different edges, one opening and one closing, that are each other's nearest.
fn chords(placed: &[Placed], points: &[Vec3]) -> Vec<[VertexId; 2]> {
    let nearest = |p: &Placed| {
        let distance = |q: &Placed| (points[q.vertex.0 as usize] - points[p.vertex.0 as usize]).norm_squared();
        let fits = placed.iter().filter(|q| q.edge != p.edge && q.is_opening != p.is_opening);
        fits.min_by(|q, r| distance(q).total_cmp(&distance(r))).map(|q| q.vertex)
    };
    let partner: Vec<(VertexId, Option<VertexId>)> = placed.iter().map(|p| (p.vertex, nearest(p))).collect();
    let mutual = partner.iter().filter_map(|&(p, q)| q.map(|q| [p, q])).filter(|[p, q]| p < q);
    mutual.filter(|&[p, q]| partner.contains(&(q, Some(p)))).collect()
}

/// Triangles of a facet that have the chords as edges; `None` if a chord leaves the facet or meets its border.
fn tiles(facet: &ComplexFacet, chords: &[[VertexId; 2]], points: &[Vec3]) -> Option<Vec<[VertexId; 3]>> {
    let walks: Vec<Vec<u32>> = facet.loops.iter().map(|l| l.iter().map(|v| v.0).collect()).collect();
    let of_length = |n: usize| walks.iter().filter(move |w| w.len() == n);
    let loops: Vec<&[u32]> = walks.iter().filter(|w| w.len() > 2).map(Vec::as_slice).collect();
    let touching = of_length(2).map(|w| [w[0], w[1]]);
    let chains: Vec<[u32; 2]> = touching.chain(chords.iter().map(|c| c.map(|v| v.0))).collect();
    let lone: Vec<u32> = of_length(1).map(|w| w[0]).collect();
    let triangles = triangulate(&loops, &chains, &lone, points).ok()?;
    Some(triangles.into_iter().map(|t| t.map(VertexId)).collect())
}

fn turned(t: [VertexId; 3]) -> [[VertexId; 2]; 3] {
    [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]]
}

/// The pieces of a triangulated facet between the chords; `None` if loops touch so that they are not what bounds the pieces.
fn pieces(facet: &ComplexFacet, triangles: &[[VertexId; 3]], chords: &[[VertexId; 2]]) -> Option<Vec<ComplexFacet>> {
    let owner: HashMap<[VertexId; 2], usize> =
        triangles.iter().enumerate().flat_map(|(k, &t)| turned(t).map(|e| (e, k))).collect();
    let is_chord = |[a, b]: [VertexId; 2]| chords.contains(&[a.min(b), a.max(b)]);
    let mut piece_of = vec![usize::MAX; triangles.len()];
    let mut count = 0;
    for seed in 0..triangles.len() {
        if piece_of[seed] != usize::MAX {
            continue;
        }
        let mut stack = vec![seed];
        while let Some(k) = stack.pop() {
            if std::mem::replace(&mut piece_of[k], count) == usize::MAX {
                let across = turned(triangles[k]).into_iter().filter(|&e| !is_chord(e));
                stack.extend(across.filter_map(|[a, b]| owner.get(&[b, a]).copied()).filter(|&n| piece_of[n] == usize::MAX));
            }
        }
        count += 1;
    }
    let mut out: Vec<ComplexFacet> =
        (0..count).map(|_| ComplexFacet { loops: Vec::new(), triangles: Vec::new(), ..facet.clone() }).collect();
    for (t, &p) in triangles.iter().zip(&piece_of) {
        out[p].triangles.push(*t);
    }
    for (k, walk) in facet.loops.iter().cloned().enumerate() {
        let parts = if k == 0 { split_loop(walk, chords) } else { vec![walk] };
        for part in parts {
            let edge = part.get(1).and_then(|&b| owner.get(&[part[0], b]));
            let inside = || triangles.iter().position(|t| t.contains(&part[0]));
            if let Some(k) = edge.copied().or_else(inside) {
                out[piece_of[k]].loops.push(part);
            }
        }
    }
    out.iter().all(is_bounded).then_some(out)
}

/// Whether the loops of a facet are the border of its triangles.
fn is_bounded(facet: &ComplexFacet) -> bool {
    let all: HashSet<[VertexId; 2]> = facet.triangles.iter().flat_map(|&t| turned(t)).collect();
    let border: HashSet<[VertexId; 2]> = all.iter().filter(|[a, b]| !all.contains(&[*b, *a])).copied().collect();
    !border.is_empty() && border == edges_of(&facet.loops).collect()
}

/// A loop cut along chords that do not cross.
fn split_loop(walk: Vec<VertexId>, chords: &[[VertexId; 2]]) -> Vec<Vec<VertexId>> {
    let mut parts = vec![walk];
    for [a, b] in chords {
        let found = parts.iter().enumerate().find_map(|(k, part)| {
            let at = |v| part.iter().position(|p| p == v);
            Some((k, at(a)?, at(b)?))
        });
        if let Some((k, i, j)) = found {
            let (i, j) = (i.min(j), i.max(j));
            let part = std::mem::take(&mut parts[k]);
            parts[k] = part[i..=j].to_vec();
            parts.push([&part[j..], &part[..=i]].concat());
        }
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ids::{LeafId, MarkerId, RegionId, SurfaceId};

    /// A strip 2 wide and 10 long, its rulings 0-1 and 2-3, with a hole and marks at heights 4 and 5.
    fn strip() -> (ComplexFacet, Vec<Vec3>) {
        let p = |x: f64, y: f64| Vec3::new(x, y, 0.0);
        let points =
            vec![p(2., 0.), p(2., 10.), p(0., 10.), p(0., 0.), p(0.5, 7.), p(1., 8.), p(1.5, 7.), p(2., 4.), p(0., 5.)];
        let facet = ComplexFacet {
            loops: vec![[0, 1, 2, 3].map(VertexId).to_vec(), [4, 5, 6].map(VertexId).to_vec()],
            triangles: Vec::new(),
            sides: [RegionId(0), RegionId(1)],
            surface: SurfaceId(0),
            source: (LeafId(0), 0),
            marker: MarkerId(0),
            is_modified: true,
        };
        (facet, points)
    }

    fn area(facet: &ComplexFacet, points: &[Vec3]) -> f64 {
        let corners = facet.triangles.iter().map(|t| t.map(|v| points[v.0 as usize]));
        corners.map(|[a, b, c]| (b - a).cross(&(c - a)).z / 2.0).sum()
    }

    #[test]
    fn a_strip_is_cut_where_the_bands_of_its_rulings_end() {
        let (facet, points) = strip();
        let mark = |v: u32, is_hot_beyond| vec![Mark { vertex: VertexId(v), is_hot_beyond }];
        // Towards vertices 1 and 2 the strip is hot: beyond 7 as seen from 0, before 8 as seen from 2.
        let marks: Marks =
            [([0, 1].map(VertexId), mark(7, true)), ([2, 3].map(VertexId), mark(8, false))].into_iter().collect();
        let mut found = cut_facet(facet, &marks, &points);
        found.sort_by_key(|f| f.loops.len());
        let [cold, hot] = &found[..] else { panic!("{} pieces", found.len()) };
        assert_eq!((cold.loops.len(), cold.loops[0].len(), area(cold, &points)), (1, 4, 9.0));
        assert_eq!((hot.loops.len(), hot.loops[0].len(), area(hot, &points)), (2, 4, 10.5));
    }

    #[test]
    fn marks_of_two_bands_are_not_joined() {
        let (facet, points) = strip();
        let mark = |v: u32, is_hot_beyond| vec![Mark { vertex: VertexId(v), is_hot_beyond }];
        // Hot above on one ruling, below on the other.
        let marks: Marks = [([0, 1].map(VertexId), mark(7, true)), ([2, 3].map(VertexId), mark(8, true))].into_iter().collect();
        let found = cut_facet(facet, &marks, &points);
        assert_eq!((found.len(), found[0].loops[0].len(), area(&found[0], &points)), (1, 6, 19.5));
    }
}
