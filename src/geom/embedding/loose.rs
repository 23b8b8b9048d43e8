//! Segments and vertices that belong to no triangle: do they meet triangles, or each other, where they must not?

use super::contact::{Contact, Segment, keep_worse};
use super::hulls::{Hulls, Thing};
use super::twins::NONE;
use super::{Kind, projection_of};
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use crate::geom::bvh::Bvh;
use crate::geom::predicates::{Projection, Sign, orient2d, orient3d};
use std::cmp::Ordering;
use std::ops::ControlFlow;

/// What a loose segment meets.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum Partner {
    /// A triangle.
    Triangle(u32),
    /// Another loose segment, with a larger number.
    Segment(u32),
}

/// A loose segment that meets something where it must not.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct LooseViolation {
    /// The segment.
    pub segment: u32,
    /// What it meets.
    pub with: Partner,
    /// How they meet.
    pub kind: Kind,
    /// A point of the meeting, to rounding.
    pub point: Vec3,
}

/// All contacts of segments with triangles, and of segments with each other, other than in shared vertices and whole shared
/// edges; at most `limit`. A segment with twice the same vertex is a lone vertex. The triangles are those of
/// [`super::violations`]; those without area are passed over. Cost: O(n log² n + pairs that no plane is found between + pairs
/// of a segment and a triangle whose boxes overlap).
pub fn loose_violations(points: &[Vec3], triangles: &[[u32; 3]], segments: &[[u32; 2]], limit: usize) -> Vec<LooseViolation> {
    if segments.is_empty() {
        return Vec::new();
    }
    let around = |vertices: &[u32]| Aabb::around(vertices.iter().map(|&v| &points[v as usize]));
    let faces = Bvh::new(triangles.iter().map(|t| around(t)).collect());
    let mut found = Vec::new();
    for (k, &ends) in segments.iter().enumerate() {
        faces.overlapping(&around(&ends), |t| {
            let contact = with_triangle(points, ends, triangles[t as usize]);
            let violation = |(kind, point)| LooseViolation { segment: k as u32, with: Partner::Triangle(t), kind, point };
            found.extend(contact.map(violation));
        });
        if found.len() >= limit {
            break;
        }
    }
    let mut met = Vec::new();
    let hulls = Hulls::new(&things(points, segments));
    for task in hulls.tasks(1) {
        hulls.pairs(task, |s, t| {
            let [s, t] = [s, t].map(|k| hulls.order()[k as usize]);
            let [s, t] = [s.min(t), s.max(t)];
            let contact = with_segment(points, segments[s as usize], segments[t as usize]);
            met.extend(contact.map(|(kind, point)| LooseViolation { segment: s, with: Partner::Segment(t), kind, point }));
            if met.len() < limit { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        });
    }
    found.extend(met);
    found.sort_by_key(|v| (v.segment, v.with));
    found.truncate(limit);
    found
}

/// The segments, each turned so that it begins where most others do, else along the axis that it runs along.
fn things(points: &[Vec3], segments: &[[u32; 2]]) -> Vec<Thing> {
    let mut degree = vec![0u32; points.len()];
    for &v in segments.iter().flatten() {
        degree[v as usize] += 1;
    }
    let turned = |&[a, b]: &[u32; 2]| {
        let [p, q] = [a, b].map(|v| points[v as usize]);
        let axis = (q - p).iamax();
        let is_along = match degree[a as usize].cmp(&degree[b as usize]) {
            Ordering::Equal => p[axis] <= q[axis],
            order => order == Ordering::Greater,
        };
        let [a, b] = if is_along { [a, b] } else { [b, a] };
        Thing { corners: [a, b, b].map(|v| points[v as usize]), hub: a, terrain: NONE }
    };
    segments.iter().map(turned).collect()
}

/// How a segment meets a triangle outside of what they share.
fn with_triangle(points: &[Vec3], ends: [u32; 2], triangle: [u32; 3]) -> Contact {
    let at = |v: u32| &points[v as usize];
    let corners = triangle.map(at);
    let projection = projection_of(corners.map(|p| *p))?;
    let [p, q] = ends.map(at);
    let sign = |x: &Vec3| orient3d(corners[0], corners[1], corners[2], x);
    match ends.map(|v| triangle.iter().position(|&w| w == v)) {
        [Some(_), Some(_)] => None,
        [Some(k), None] if sign(q) == 0 => from_corner(turned(corners, k), q, projection),
        [None, Some(k)] if sign(p) == 0 => from_corner(turned(corners, k), p, projection),
        [None, None] => {
            let signs = [sign(p), sign(q)];
            let mut worst = Segment { ends: [p, q], signs }.contact(corners, projection);
            if signs == [0, 0] {
                for corner in corners.into_iter().filter(|c| is_inside(c, p, q)) {
                    keep_worse(&mut worst, Some((Kind::VertexOnEdge, *corner)));
                }
            }
            worst
        }
        _ => None,
    }
}

fn turned<T: Copy>(corners: [T; 3], first: usize) -> [T; 3] {
    [first, (first + 1) % 3, (first + 2) % 3].map(|k| corners[k])
}

/// How the segment from the first corner of a triangle to a point of its plane goes on in the triangle.
fn from_corner([a, b, c]: [&Vec3; 3], end: &Vec3, projection: Projection) -> Contact {
    let [fa, fb, fc, fe] = [a, b, c, end].map(|x| projection.apply(x));
    let turns: [Sign; 2] = [orient2d(fa, fb, fe), orient2d(fc, fa, fe)];
    if turns.contains(&-1) {
        return None;
    }
    // Beyond, on or before the edge opposite to the corner.
    let reach = orient2d(fb, fc, fe);
    Some(match (turns, reach) {
        ([0, 0], _) => (Kind::CoincidentVertices, *end),
        ([0, _] | [_, 0], 0) => (Kind::CoincidentVertices, *end),
        ([0, _] | [_, 0], 1) => (Kind::VertexOnEdge, *end),
        ([0, _], _) => (Kind::VertexOnEdge, *b),
        ([_, 0], _) => (Kind::VertexOnEdge, *c),
        (_, 1) => (Kind::VertexOnFacet, *end),
        (_, 0) => (Kind::VertexOnEdge, *end),
        _ => (Kind::EdgesCross, (b + c) * 0.5),
    })
}

/// How two segments meet outside of vertices that they share.
fn with_segment(points: &[Vec3], s: [u32; 2], t: [u32; 2]) -> Contact {
    let at = |v: u32| &points[v as usize];
    let ([a, b], [c, d]) = (s.map(at), t.map(at));
    let loose_ends = t.iter().filter(|v| !s.contains(v)).map(|&v| (at(v), a, b));
    let others = s.iter().filter(|v| !t.contains(v)).map(|&v| (at(v), c, d));
    if let Some((p, ..)) = loose_ends.chain(others).find(|(p, x, y)| is_inside(p, x, y)) {
        return Some((Kind::VertexOnEdge, *p));
    }
    if s.iter().any(|v| t.contains(v)) || orient3d(a, b, c, d) != 0 {
        return None;
    }
    let cross = |q: Projection| {
        let turn = |x, y, z| orient2d(q.apply(x), q.apply(y), q.apply(z));
        turn(a, b, c) * turn(a, b, d) < 0 && turn(c, d, a) * turn(c, d, b) < 0
    };
    planes().any(cross).then(|| (Kind::EdgesCross, (a + b) * 0.5))
}

/// Whether a point lies on a segment, strictly between its ends.
pub(crate) fn is_inside(p: &Vec3, a: &Vec3, b: &Vec3) -> bool {
    let is_between = (0..3).all(|k| a[k].min(b[k]) <= p[k] && p[k] <= a[k].max(b[k]));
    is_between && p != a && p != b && planes().all(|q| orient2d(q.apply(a), q.apply(b), q.apply(p)) == 0)
}

/// The coordinate planes.
fn planes() -> impl Iterator<Item = Projection> {
    (0..3u8).map(|k| Projection { u: (k + 1) % 3, v: (k + 2) % 3 })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a segment between two points does with the triangle (0,0,0) (4,0,0) (0,4,0); a vertex number stands for itself.
    fn kind(from: [f64; 3], to: [f64; 3]) -> Option<Kind> {
        let corners = [[0., 0., 0.], [4., 0., 0.], [0., 4., 0.]];
        let mut points: Vec<Vec3> = corners.map(Vec3::from).to_vec();
        let ends = [from, to].map(|p| {
            corners.iter().position(|c| *c == p).unwrap_or_else(|| {
                points.push(p.into());
                points.len() - 1
            }) as u32
        });
        let found = loose_violations(&points, &[[0, 1, 2]], &[ends], 9);
        let back = loose_violations(&points, &[[0, 2, 1]], &[[ends[1], ends[0]]], 9);
        assert_eq!(found.iter().map(|f| f.kind).collect::<Vec<_>>(), back.iter().map(|f| f.kind).collect::<Vec<_>>());
        found.first().map(|f| f.kind)
    }

    #[test]
    fn a_segment_and_a_triangle() {
        let up = f64::from_bits(1.0f64.to_bits() - 1) - 1.0;
        for (from, to, expected) in [
            ([1., 1., -1.], [1., 1., 1.], Some(Kind::Penetration)),
            ([1., 1., -up], [1., 1., 1.], None),
            ([1., 1., up], [1., 1., 1.], Some(Kind::Penetration)),
            ([1., 1., 0.], [1., 1., 1.], Some(Kind::VertexOnFacet)),
            ([2., 2., -1.], [2., 2., 1.], Some(Kind::EdgesCross)),
            ([2., 2., 0.], [3., 3., 0.], Some(Kind::VertexOnEdge)),
            ([3., 2., 0.], [2., 3., 0.], None),
            ([5., -1., 0.], [-1., 5., 0.], Some(Kind::VertexOnEdge)),
            ([0., 0., 0.], [4., 0., 0.], None),
            ([0., 0., 0.], [4., 0., 1.], None),
            ([0., 0., 0.], [-4., 0., 0.], None),
            ([0., 0., 0.], [2., 0., 0.], Some(Kind::VertexOnEdge)),
            ([0., 0., 0.], [5., 0., 0.], Some(Kind::VertexOnEdge)),
            ([0., 0., 0.], [1., 1., 0.], Some(Kind::VertexOnFacet)),
            ([0., 0., 0.], [2., 2., 0.], Some(Kind::VertexOnEdge)),
            ([0., 0., 0.], [3., 3., 0.], Some(Kind::EdgesCross)),
            ([0., 4., 0.], [1., -1., 0.], Some(Kind::EdgesCross)),
            ([1., 1., 0.], [1., 1., 0.], Some(Kind::VertexOnFacet)),
            ([4., 4., 0.], [4., 4., 0.], None),
        ] {
            assert_eq!(kind(from, to), expected, "{from:?} {to:?}");
        }
    }

    #[test]
    fn segments_cross_overlap_and_touch() {
        let v = Vec3::new;
        let points = [v(0., 0., 0.), v(4., 0., 0.), v(2., -1., 0.), v(2., 1., 0.), v(6., 0., 0.), v(2., 0., 0.)];
        let kinds = |s, t| loose_violations(&points, &[], &[s, t], 9).iter().map(|f| f.kind).collect::<Vec<_>>();
        assert_eq!(kinds([0, 1], [2, 3]), [Kind::EdgesCross]);
        assert_eq!(kinds([0, 1], [0, 4]), [Kind::VertexOnEdge]);
        assert_eq!(kinds([0, 1], [5, 3]), [Kind::VertexOnEdge]);
        assert_eq!(kinds([0, 1], [5, 4]), [Kind::VertexOnEdge]);
        assert_eq!(kinds([0, 1], [5, 5]), [Kind::VertexOnEdge]);
        assert_eq!(kinds([0, 1], [1, 4]), []);
        assert_eq!(kinds([0, 1], [1, 0]), []);
        assert_eq!(kinds([0, 1], [3, 4]), []);
    }

    #[test]
    fn of_many_segments_the_same_pairs_are_found_as_of_two() {
        // Many that share ends, lie on one line, cross, or are lone vertices.
        let points: Vec<Vec3> = (0..27).map(|k| Vec3::new(f64::from(k % 3), f64::from(k / 3 % 3), f64::from(k / 9))).collect();
        let segments: Vec<[u32; 2]> = (0..300u32).map(|k| [(k * k + 7 * k) % 27, (11 * k + k / 27) % 27]).collect();
        let mut pairs = Vec::new();
        for s in 0..segments.len() {
            for t in s + 1..segments.len() {
                let found = with_segment(&points, segments[s], segments[t]);
                let violation =
                    |(kind, point)| LooseViolation { segment: s as u32, with: Partner::Segment(t as u32), kind, point };
                pairs.extend(found.map(violation));
            }
        }
        assert!(pairs.len() > 1000);
        assert_eq!(loose_violations(&points, &[], &segments, usize::MAX), pairs);
    }
}
