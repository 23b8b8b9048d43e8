//! Exact ray casting among triangles.
//!
//! Rays are segments to a point beyond everything. Which triangles a segment crosses is decided by signs alone; a segment
//! through an edge or a vertex is refused and another direction is tried.

use crate::geom::Vec3;
use crate::geom::aabb::{Aabb, Segment};
use crate::geom::bvh::Bvh;
use crate::geom::embedding::projection_of;
use crate::geom::predicates::{orient2d, orient3d};
use std::cell::Cell;

/// Directions tried in turn: no two components in a simple ratio, so that designed geometry rarely lies along them.
const DIRECTIONS: [[f64; 3]; 8] = [
    [0.577_211, 0.697_313, 0.424_947],
    [-0.261_497, 0.915_965, -0.305_216],
    [0.764_223, -0.110_001, -0.643_410],
    [-0.412_454, -0.567_143, 0.718_281],
    [0.187_859, 0.303_663, -0.934_171],
    [-0.870_588, 0.237_205, 0.429_957],
    [0.050_661, -0.923_447, 0.381_966],
    [-0.662_743, -0.483_675, -0.572_467],
];

/// Reach of the first search for the next triangle at least, in the distances that are too near to be told: up to such a one, the
/// search would end with nothing.
const AT_FIRST: f64 = 2.0;
/// By how much each further search reaches farther.
const FARTHER: f64 = 4.0;

/// Triangles with a box tree over them.
pub struct Caster<'a> {
    points: &'a [Vec3],
    triangles: &'a [[u32; 3]],
    tree: Bvh,
    reach: f64,
}

/// A triangle that a segment crosses in its inside.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Crossing {
    /// Where on the segment, from 0 to 1, to rounding.
    pub at: f64,
    /// The triangle.
    pub triangle: u32,
    /// Whether the segment begins in front of it (where its vertices are seen counter-clockwise).
    pub from_front: bool,
}

/// Why a segment gives no crossings.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum CastError {
    /// Its first point lies on this triangle.
    On(u32),
    /// It meets an edge or a vertex: try another.
    Degenerate,
}

impl<'a> Caster<'a> {
    /// A caster among these triangles; coordinates are finite.
    pub fn new(points: &'a [Vec3], triangles: &'a [[u32; 3]]) -> Self {
        let boxes = triangles.iter().map(|t| Aabb::around(t.iter().map(|&v| &points[v as usize]))).collect();
        let tree = Bvh::new(boxes);
        // Twice the size: from any point of the model, every direction ends outside.
        let reach = 2.0 * tree.bounds().diagonal().max(f64::MIN_POSITIVE);
        Self { points, triangles, tree, reach }
    }

    /// The corners of a triangle.
    pub fn corners(&self, triangle: u32) -> [Vec3; 3] {
        self.triangles[triangle as usize].map(|v| self.points[v as usize])
    }

    /// All triangles crossed by a ray from `from` to the outside, in no particular order.
    ///
    /// # Errors
    /// If the point lies on a triangle, or every direction that was tried meets an edge or a vertex.
    pub fn cast(&self, from: &Vec3) -> Result<Vec<Crossing>, CastError> {
        for direction in DIRECTIONS {
            match self.crossings(from, &(from + Vec3::from(direction) * self.reach_from(from))) {
                Err(CastError::Degenerate) => {}
                done => return done,
            }
        }
        Err(CastError::Degenerate)
    }

    /// All triangles crossed by a line through the inside of `triangle`, itself among them, in order along the line (to
    /// rounding).
    ///
    /// # Errors
    /// If every direction that was tried meets an edge or a vertex, or misses the triangle by rounding.
    pub fn line_through(&self, triangle: u32) -> Result<Vec<Crossing>, CastError> {
        let [a, b, c] = self.corners(triangle);
        let center = (a + b + c) / 3.0;
        for direction in DIRECTIONS {
            let step = Vec3::from(direction) * self.reach_from(&center);
            if let Ok(mut found) = self.crossings(&(center - step), &(center + step))
                && found.iter().any(|c| c.triangle == triangle)
            {
                found.sort_by(|x, y| x.at.total_cmp(&y.at).then(x.triangle.cmp(&y.triangle)));
                return Ok(found);
            }
        }
        Err(CastError::Degenerate)
    }

    fn reach_from(&self, from: &Vec3) -> f64 {
        self.reach + 2.0 * (from - self.tree.bounds().center()).norm()
    }

    fn crossings(&self, p: &Vec3, q: &Vec3) -> Result<Vec<Crossing>, CastError> {
        let (segment, mut found) = (Segment::new(p, q, &self.tree.bounds()), Ok(Vec::new()));
        self.tree.search(
            |b| segment.may_meet(b, 1.0),
            |t| {
                match (self.crossing(p, q, t), &mut found) {
                    (Ok(Some(c)), Ok(list)) => list.push(c),
                    // That the point lies on a triangle is final; keep it over a degenerate direction.
                    (Err(e), Ok(_) | Err(CastError::Degenerate)) => found = Err(e),
                    _ => {}
                }
            },
        );
        found
    }

    fn crossing(&self, p: &Vec3, q: &Vec3, triangle: u32) -> Result<Option<Crossing>, CastError> {
        let [a, b, c] = self.corners(triangle);
        let (sp, sq) = (orient3d(&a, &b, &c, p), orient3d(&a, &b, &c, q));
        if sp == 0 {
            return match projection_of([a, b, c]) {
                Some(f) => {
                    let turns = [(a, b), (b, c), (c, a)].map(|(u, v)| orient2d(f.apply(&u), f.apply(&v), f.apply(p)));
                    if !turns.contains(&-1) {
                        Err(CastError::On(triangle))
                    } else if sq == 0 {
                        Err(CastError::Degenerate)
                    } else {
                        Ok(None)
                    }
                }
                None => Err(CastError::Degenerate),
            };
        }
        // The end lies beyond everything, so it is on no triangle even if it is in its plane.
        if sp * sq >= 0 {
            return Ok(None);
        }
        let seen = [orient3d(p, q, &a, &b), orient3d(p, q, &b, &c), orient3d(p, q, &c, &a)];
        if seen.contains(&1) && seen.contains(&-1) {
            return Ok(None);
        }
        if seen.contains(&0) {
            return Err(CastError::Degenerate);
        }
        let normal = (b - a).cross(&(c - a));
        let (hp, hq) = (normal.dot(&(p - a)), normal.dot(&(q - a)));
        Ok(Some(Crossing { at: hp / (hp - hq), triangle, from_front: sp > 0 }))
    }

    /// Distance, in units of `direction`, to the nearest triangle in front of `from` other than `skipped`, if it is more than
    /// `least`; in floats: where the ray grazes an edge, it may miss it.
    pub fn distance_to_next(&self, from: &Vec3, direction: &Vec3, skipped: u32, least: f64) -> Option<f64> {
        let beyond_all = self.reach_from(from) / direction.norm();
        let segment = Segment::new(from, &(from + direction * beyond_all), &self.tree.bounds());
        // The next triangle is mostly near, and very many may lie behind it: so far at first, then farther and farther.
        let mut until = (Aabb::around(self.corners(skipped).iter()).diagonal() / direction.norm()).max(AT_FIRST * least);
        loop {
            let best = Cell::new(until.min(beyond_all));
            // What lies behind the nearest triangle so far need not be looked at, and nothing if that is too near.
            self.tree.search(
                |b| best.get() > least && segment.may_meet(b, best.get() / beyond_all),
                |t| {
                    if t != skipped
                        && let Some(d) = ray_triangle(from, direction, self.corners(t))
                    {
                        best.set(best.get().min(d));
                    }
                },
            );
            if best.get() < until.min(beyond_all) {
                return (best.get() > least).then_some(best.get());
            }
            let is_more_beyond = until < beyond_all;
            if !is_more_beyond {
                return None;
            }
            until = (FARTHER * until).max(f64::MIN_POSITIVE);
        }
    }
}

/// Moeller and Trumbore 1997.
fn ray_triangle(from: &Vec3, direction: &Vec3, [a, b, c]: [Vec3; 3]) -> Option<f64> {
    let (e, f) = (b - a, c - a);
    let h = direction.cross(&f);
    let det = e.dot(&h);
    if det == 0.0 {
        return None;
    }
    let s = from - a;
    let u = s.dot(&h) / det;
    let w = s.cross(&e);
    let v = direction.dot(&w) / det;
    let t = f.dot(&w) / det;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0).then_some(t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crosses_one_of_two_triangles_and_knows_a_point_on_one() {
        let v = Vec3::new;
        let points = [v(0., 0., 0.), v(9., 0., 0.), v(0., 9., 0.), v(0., 0., 5.), v(9., 0., 5.), v(0., 9., 5.)];
        let triangles = [[0, 1, 2], [3, 4, 5]];
        let caster = Caster::new(&points, &triangles);
        assert_eq!(caster.cast(&v(2., 2., 0.)), Err(CastError::On(0)));
        assert_eq!(caster.cast(&v(0., 0., 0.)), Err(CastError::On(0)));
        let up = caster.cast(&v(1., 1., 4.5)).unwrap();
        assert_eq!(up.iter().map(|c| (c.triangle, c.from_front)).collect::<Vec<_>>(), [(1, false)]);
        assert_eq!(caster.distance_to_next(&v(1., 1., 0.), &v(0., 0., 1.), 0, 4.9), Some(5.0));
        assert_eq!(caster.distance_to_next(&v(1., 1., 0.), &v(0., 0., 1.), 0, 5.0), None);
    }
}
