//! Planar facets beside the remeshed ones: their borders may change as long as they stay simple.

use super::workpiece::{NEEDLE_SINE, Workpiece};
use crate::geom::Vec3;
use crate::geom::predicates::{Projection, orient2d};
use crate::ids::{FacetId, VertexId};

/// A change of one corner of the borders: `vertex` goes to `to`, or, if it disappears, its neighbours are joined.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Change {
    /// A vertex moves.
    Move {
        /// Which.
        vertex: VertexId,
        /// Where to.
        to: Vec3,
    },
    /// A vertex of an edge is merged into the other end.
    Merge {
        /// The one that goes.
        gone: VertexId,
        /// The one that stays.
        kept: VertexId,
    },
    /// A vertex at this place enters the edge of two others.
    Insert {
        /// The ends of the edge.
        ends: [VertexId; 2],
        /// Its place.
        at: Vec3,
    },
}

type Point = [f64; 2];

impl Workpiece {
    /// Whether a polygon stays simple, with every hole and every vertex on the same side of its borders: no new border edge
    /// touches another edge, and no vertex lies in the area that the border sweeps over. Exact signs in the dominant
    /// projection. Nor may corners come so near to each other that what hangs on them becomes a needle.
    pub fn polygon_stays_simple(&self, facet: FacetId, change: Change) -> bool {
        let walks: Vec<Vec<VertexId>> =
            self.brep.topology.loops(facet).map(|l| self.brep.topology.corners(l).collect()).collect();
        let area: Vec3 =
            self.brep.triangles(facet).map(|t| t.map(|v| self.point(v))).map(|[a, b, c]| (b - a).cross(&(c - a))).sum();
        let projection = Projection::along(&area);
        let flat = |v: VertexId| projection.apply(&self.point(v));
        for walk in &walks {
            for k in 0..walk.len() {
                let n = walk.len();
                let (before, here, after) = (walk[(k + n - 1) % n], walk[k], walk[(k + 1) % n]);
                let path = match change {
                    Change::Move { vertex, to } if vertex == here => {
                        Path { ends: [before, after], old: Some(here), new: Some(projection.apply(&to)) }
                    }
                    Change::Merge { gone, kept } if gone == here => {
                        if n <= 3 || before == after {
                            return false;
                        }
                        // Joined to `kept` on both sides: the border edge between the two shrinks to nothing.
                        match (before == kept, after == kept) {
                            (true, _) | (_, true) => Path { ends: [before, after], old: Some(here), new: None },
                            _ => Path { ends: [before, after], old: Some(here), new: Some(flat(kept)) },
                        }
                    }
                    Change::Insert { ends, at } if [here, after] == ends || [after, here] == ends => {
                        Path { ends: [here, after], old: None, new: Some(projection.apply(&at)) }
                    }
                    _ => continue,
                };
                if path.makes_needle(&flat) || !path.is_clear(&walks, &flat) {
                    return false;
                }
            }
        }
        true
    }
}

/// A piece of border between two vertices, with the vertex between them before and after.
struct Path {
    ends: [VertexId; 2],
    old: Option<VertexId>,
    new: Option<Point>,
}

impl Path {
    /// Whether the new corner is much nearer to one end than to the other, and nearer than the old one was.
    fn makes_needle(&self, flat: &impl Fn(VertexId) -> Point) -> bool {
        let Some(new) = self.new else { return false };
        let distance = |p: Point, end: VertexId| {
            let q = flat(end);
            libm::hypot(p[0] - q[0], p[1] - q[1])
        };
        let [a, b] = self.ends;
        let comes_near = |end, other| {
            let near = distance(new, end);
            near < NEEDLE_SINE * distance(new, other) && self.old.is_none_or(|old| near < distance(flat(old), end))
        };
        comes_near(a, b) || comes_near(b, a)
    }

    fn is_clear(&self, walks: &[Vec<VertexId>], flat: &impl Fn(VertexId) -> Point) -> bool {
        let [a, b] = self.ends.map(flat);
        let segments: Vec<[Point; 2]> = match self.new {
            Some(m) => vec![[a, m], [m, b]],
            None => vec![[a, b]],
        };
        let old = self.old.map(flat);
        let swept: Vec<[Point; 3]> = match (old, self.new) {
            (Some(o), Some(m)) => vec![[a, o, m], [o, b, m]],
            (Some(m), None) | (None, Some(m)) => vec![[a, m, b]],
            (None, None) => Vec::new(),
        };
        let near = Rectangle::around([Some(a), Some(b), old, self.new].into_iter().flatten());
        let is_mine = |v: VertexId| Some(v) == self.old || self.ends.contains(&v);
        for walk in walks {
            let Some(&last) = walk.last() else { continue };
            let mut from = (last, flat(last));
            for &q in walk {
                let (p, at) = std::mem::replace(&mut from, (q, flat(q)));
                // Most are nowhere near.
                if !near.meets([at, from.1]) {
                    continue;
                }
                if !is_mine(p) && swept.iter().any(|t| is_inside(t, at)) {
                    return false;
                }
                // Edges of the piece itself go away.
                let goes = Some(p) == self.old || Some(q) == self.old || (self.old.is_none() && is_mine(p) && is_mine(q));
                if !goes && p != q && segments.iter().any(|s| touch(*s, [at, from.1])) {
                    return false;
                }
            }
        }
        // The two new edges must not fold onto each other.
        self.new.is_none_or(|m| orient2d(a, m, b) != 0 || is_between(a, m, b))
    }
}

/// Least and largest coordinates.
struct Rectangle([Point; 2]);

impl Rectangle {
    fn around(points: impl Iterator<Item = Point>) -> Self {
        let empty = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        Self(points.fold(empty, |[low, high], p| [[0, 1].map(|k| low[k].min(p[k])), [0, 1].map(|k| high[k].max(p[k]))]))
    }

    /// Whether the closed one around a segment has a point in common with it.
    fn meets(&self, [p, q]: [Point; 2]) -> bool {
        let Self([low, high]) = self;
        (0..2).all(|k| p[k].max(q[k]) >= low[k] && p[k].min(q[k]) <= high[k])
    }
}

fn is_between(a: Point, m: Point, b: Point) -> bool {
    (0..2).all(|k| m[k] >= a[k].min(b[k]) && m[k] <= a[k].max(b[k]))
}

/// Whether a point lies in the closed triangle, either orientation; nothing lies in a flat one.
fn is_inside(t: &[Point; 3], p: Point) -> bool {
    let turn = orient2d(t[0], t[1], t[2]);
    turn != 0 && (0..3).all(|k| orient2d(t[k], t[(k + 1) % 3], p) != -turn)
}

/// Whether two segments have a point in common other than a common end.
fn touch(s: [Point; 2], t: [Point; 2]) -> bool {
    let shared = s.iter().find(|p| t.contains(p));
    if let Some(&p) = shared {
        let other = |u: [Point; 2]| if u[0] == p { u[1] } else { u[0] };
        let (a, b) = (other(s), other(t));
        // Collinear on the same side: overlap.
        let along = (a[0] - p[0]) * (b[0] - p[0]) + (a[1] - p[1]) * (b[1] - p[1]);
        return orient2d(p, a, b) == 0 && along > 0.0;
    }
    let (o1, o2) = (orient2d(s[0], s[1], t[0]), orient2d(s[0], s[1], t[1]));
    let (o3, o4) = (orient2d(t[0], t[1], s[0]), orient2d(t[0], t[1], s[1]));
    if o1 * o2 < 0 && o3 * o4 < 0 {
        return true;
    }
    let on = |u: [Point; 2], p: Point, o: i8| o == 0 && is_between(u[0], p, u[1]);
    on(s, t[0], o1) || on(s, t[1], o2) || on(t, s[0], o3) || on(t, s[1], o4)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_touch_or_not() {
        let cross = [[0.0, -1.0], [0.0, 1.0]];
        assert!(touch([[-1.0, 0.0], [1.0, 0.0]], cross));
        assert!(touch([[0.0, 0.0], [1.0, 0.0]], cross));
        assert!(!touch([[0.5, 0.0], [1.0, 0.0]], cross));
        // A common end is no contact, an overlap from it is.
        assert!(!touch([[0.0, 1.0], [1.0, 0.0]], cross));
        assert!(touch([[0.0, 1.0], [0.0, 0.5]], cross));
    }

    #[test]
    fn inside_either_orientation() {
        let t = [[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]];
        assert!(is_inside(&t, [1.0, 1.0]) && is_inside(&[t[0], t[2], t[1]], [1.0, 1.0]));
        assert!(is_inside(&t, [2.0, 0.0]) && !is_inside(&t, [3.0, 3.0]));
    }
}
