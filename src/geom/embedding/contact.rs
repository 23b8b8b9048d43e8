//! Two triangles: do they meet where they must not?
//!
//! Two facts keep it short. First, what is apart in a projection is apart: if an edge of one triangle, seen along a
//! coordinate axis, has the whole other triangle strictly beyond it, nothing but shared vertices on that edge can be common.
//! That settles neighbours in a plane or on a smooth surface by signs in two dimensions. Second, the common part of two
//! triangles is convex and ends on their boundaries, so it suffices to test edges against triangles; with one shared vertex,
//! only the two edges opposite to it, because the common part, if it has a second point, runs from the shared vertex to one of
//! them.

use super::Kind;
use crate::geom::Vec3;
use crate::geom::predicates::{Projection, Sign, clear_side, orient2d, orient3d};

/// Two triangles with area, and for each a projection in which it is counter-clockwise.
pub(super) struct Pair<'a> {
    pub points: &'a [Vec3],
    pub triangles: [[u32; 3]; 2],
    pub projections: [Projection; 2],
    /// Points about which triangles meet in common edges only.
    pub is_disc: &'a [bool],
}

/// The worst kind found so far, and a point of it.
pub(super) type Contact = Option<(Kind, Vec3)>;

impl<'a> Pair<'a> {
    /// The worst forbidden contact and a point of it.
    pub fn forbidden_contact(&self) -> Contact {
        let [s, t] = self.triangles;
        let mut shared = [(0, 0); 3];
        let mut count = 0;
        for (i, v) in s.iter().enumerate() {
            if let Some(j) = t.iter().position(|w| w == v) {
                if self.is_disc[*v as usize] {
                    return None;
                }
                shared[count] = (i, j);
                count += 1;
            }
        }
        let [(i, j), (k, l), _] = shared;
        match count {
            0 => self.apart(self.corners(0, 0), self.corners(1, 0)),
            1 => self.at_vertex(self.corners(0, i), self.corners(1, j)),
            // The corners that are not shared come first.
            2 => self.across_edge(self.corners(0, 3 - i - k), self.corners(1, 3 - j - l)),
            _ => Some((Kind::Duplicate, *self.point(s[0]))),
        }
    }

    fn point(&self, v: u32) -> &'a Vec3 {
        &self.points[v as usize]
    }

    /// The corners of one of the two triangles, turned so that corner `first` comes first.
    fn corners(&self, which: usize, first: usize) -> [&'a Vec3; 3] {
        let t = self.triangles[which];
        [first, (first + 1) % 3, (first + 2) % 3].map(|k| self.point(t[k]))
    }

    /// Triangles (c, a, b) and (d, b, a) over a common edge, or (d, a, b) if they disagree in orientation.
    fn across_edge(&self, [c, a, b]: [&Vec3; 3], [d, ..]: [&Vec3; 3]) -> Contact {
        let is_across = |q: Projection| {
            let turn = |p: &Vec3| orient2d(q.apply(a), q.apply(b), q.apply(p));
            turn(c) * turn(d) < 0
        };
        let [p, q] = self.projections;
        if is_across(p) || is_across(q) || orient3d(a, b, c, d) != 0 {
            return None;
        }
        Some((Kind::Overlap, (a + b) * 0.5))
    }

    /// Triangles (a, b, c) and (a, d, e) with one common vertex.
    fn at_vertex(&self, s: [&Vec3; 3], t: [&Vec3; 3]) -> Contact {
        let [p, q] = self.projections;
        let ([_, b, c], [_, d, e]) = (s, t);
        if is_beyond_edge_at_first(s, p, [d, e]) || is_beyond_edge_at_first(t, q, [b, c]) {
            return None;
        }
        let [sd, se] = [d, e].map(|x| orient3d(s[0], s[1], s[2], x));
        if sd * se > 0 {
            return None;
        }
        let [sb, sc] = [b, c].map(|x| orient3d(t[0], t[1], t[2], x));
        if sb * sc > 0 {
            return None;
        }
        let mut worst = None;
        keep_worse(&mut worst, Segment { ends: [d, e], signs: [sd, se] }.contact(s, p));
        keep_worse(&mut worst, Segment { ends: [b, c], signs: [sb, sc] }.contact(t, q));
        raise_if_coplanar(worst, sd == 0 && se == 0)
    }

    /// Triangles without a common vertex.
    fn apart(&self, s: [&Vec3; 3], t: [&Vec3; 3]) -> Contact {
        let [p, q] = self.projections;
        // The cheapest tests first.
        let clear = t.map(|x| clear_side(s[0], s[1], s[2], x));
        if is_one_side(clear) || is_beyond_an_edge(s, p, t) {
            return None;
        }
        let of_t = t.map(|x| orient3d(s[0], s[1], s[2], x));
        if is_one_side(of_t) || is_beyond_an_edge(t, q, s) {
            return None;
        }
        let of_s = s.map(|x| orient3d(t[0], t[1], t[2], x));
        if is_one_side(of_s) {
            return None;
        }
        let mut worst = None;
        for k in 0..3 {
            let l = (k + 1) % 3;
            keep_worse(&mut worst, Segment { ends: [t[k], t[l]], signs: [of_t[k], of_t[l]] }.contact(s, p));
            keep_worse(&mut worst, Segment { ends: [s[k], s[l]], signs: [of_s[k], of_s[l]] }.contact(t, q));
        }
        raise_if_coplanar(worst, of_t == [0; 3])
    }
}

pub(super) fn keep_worse(worst: &mut Contact, found: Contact) {
    if let Some(f) = found
        && worst.is_none_or(|w| f.0 > w.0)
    {
        *worst = Some(f);
    }
}

/// In one plane, a vertex inside the other triangle or two edges that cross mean common area.
fn raise_if_coplanar(worst: Contact, is_coplanar: bool) -> Contact {
    let raised = |kind| if is_coplanar && kind > Kind::VertexOnEdge { Kind::Overlap } else { kind };
    worst.map(|(kind, point)| (raised(kind), point))
}

fn is_one_side(signs: [Sign; 3]) -> bool {
    signs == [1; 3] || signs == [-1; 3]
}

/// Whether, seen in the projection, some edge of `s` has all of `others` strictly on its outer side.
fn is_beyond_an_edge(s: [&Vec3; 3], projection: Projection, others: [&Vec3; 3]) -> bool {
    let [a, b, c] = s.map(|p| projection.apply(p));
    let others = others.map(|p| projection.apply(p));
    [(a, b), (b, c), (c, a)].into_iter().any(|(u, v)| others.iter().all(|&x| orient2d(u, v, x) < 0))
}

/// The same for the two edges at the first, common corner and the two other corners of the other triangle.
fn is_beyond_edge_at_first(s: [&Vec3; 3], projection: Projection, others: [&Vec3; 2]) -> bool {
    let [a, b, c] = s.map(|p| projection.apply(p));
    let others = others.map(|p| projection.apply(p));
    [(a, b), (c, a)].into_iter().any(|(u, v)| others.iter().all(|&x| orient2d(u, v, x) < 0))
}

/// A segment and the sides of a triangle's plane on which its ends lie.
pub(super) struct Segment<'a> {
    pub ends: [&'a Vec3; 2],
    pub signs: [Sign; 2],
}

impl Segment<'_> {
    /// Where the segment meets the triangle, which is counter-clockwise in the projection.
    pub fn contact(&self, triangle: [&Vec3; 3], projection: Projection) -> Contact {
        let [p, q] = self.ends;
        match self.signs {
            [0, 0] => self.contact_in_plane(triangle, projection),
            [0, _] => locate(p, triangle, projection),
            [_, 0] => locate(q, triangle, projection),
            [i, j] if i != j => self.passage(triangle),
            _ => None,
        }
    }

    /// The segment lies in the triangle's plane. (A corner of the triangle inside the segment is found from the other side.)
    fn contact_in_plane(&self, triangle: [&Vec3; 3], projection: Projection) -> Contact {
        let [p, q] = self.ends;
        let mut worst = locate(p, triangle, projection);
        keep_worse(&mut worst, locate(q, triangle, projection));
        let flat = |x: &Vec3| projection.apply(x);
        let turn = |x, y, z| orient2d(flat(x), flat(y), flat(z));
        for k in 0..3 {
            let (u, v) = (triangle[k], triangle[(k + 1) % 3]);
            if turn(p, q, u) * turn(p, q, v) < 0 && turn(u, v, p) * turn(u, v, q) < 0 {
                let height = |x: &Vec3| {
                    let (u, v, x) = (flat(u), flat(v), flat(x));
                    (v[0] - u[0]) * (x[1] - u[1]) - (v[1] - u[1]) * (x[0] - u[0])
                };
                keep_worse(&mut worst, Some((Kind::EdgesCross, between(p, q, height(p), height(q)))));
            }
        }
        worst
    }

    /// The ends lie strictly on different sides of the triangle's plane.
    fn passage(&self, triangle: [&Vec3; 3]) -> Contact {
        let [p, q] = self.ends;
        let [a, b, c] = triangle;
        let mut seen = [0; 3];
        for (slot, (u, v)) in seen.iter_mut().zip([(a, b), (b, c), (c, a)]) {
            *slot = orient3d(p, q, u, v);
        }
        if seen.contains(&1) && seen.contains(&-1) {
            return None;
        }
        let normal = (b - a).cross(&(c - a));
        let point = || between(p, q, normal.dot(&(p - a)), normal.dot(&(q - a)));
        match seen.map(|x| x == 0) {
            [false, false, false] => Some((Kind::Penetration, point())),
            // Through the corner that two edges share.
            [true, true, false] => Some((Kind::VertexOnEdge, *b)),
            [false, true, true] => Some((Kind::VertexOnEdge, *c)),
            [true, false, true] => Some((Kind::VertexOnEdge, *a)),
            _ => Some((Kind::EdgesCross, point())),
        }
    }
}

/// How a point of the triangle's plane lies in the triangle.
fn locate(p: &Vec3, triangle: [&Vec3; 3], projection: Projection) -> Contact {
    let [a, b, c] = triangle.map(|x| projection.apply(x));
    let x = projection.apply(p);
    let turns = [orient2d(a, b, x), orient2d(b, c, x), orient2d(c, a, x)];
    if turns.contains(&-1) {
        return None;
    }
    let kind = match turns.iter().filter(|&&t| t == 0).count() {
        0 => Kind::VertexOnFacet,
        1 => Kind::VertexOnEdge,
        _ => Kind::CoincidentVertices,
    };
    Some((kind, *p))
}

/// The point between p and q where a height that is `hp` at p and `hq` at q vanishes, to rounding.
fn between(p: &Vec3, q: &Vec3, hp: f64, hq: f64) -> Vec3 {
    let t = hp / (hp - hq);
    p + (q - p) * if t.is_finite() { t.clamp(0.0, 1.0) } else { 0.5 }
}
