//! Facets near a contact as planar figures: plane, outline with everything inserted, and what lies on them.

use super::edges::EdgeSet;
use super::figure::{Figure, MANY, is_enclosed};
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use crate::geom::polygon::vector_area;
use crate::geom::predicates::{Projection, orient2d};
use crate::geom::segment::nearest_on;

/// An active facet.
pub(super) struct Outline {
    pub facet: u32,
    /// Unit normal, outwards.
    pub normal: Vec3,
    pub origin: Vec3,
    pub area: f64,
    pub projection: Projection,
    /// Box of the facet as it came.
    pub bounds: Aabb,
    /// Loops as points, with everything inserted into the edges.
    pub loops: Vec<Vec<u32>>,
    /// Loops as they came, if they differ. What is not on the outline is further from it than the tolerance, hence inside both
    /// or neither.
    frame: Option<Vec<Vec<u32>>>,
    /// What a long outline is searched by; a short one is searched as it is.
    index: Option<Box<Index>>,
}

struct Index {
    /// Edges, lower point first, sorted.
    sides: Vec<[u32; 2]>,
    /// Points, sorted.
    corners: Vec<u32>,
    /// Sides as they came, seen along the projection.
    figure: Figure,
}

impl Index {
    fn new(loops: &[Vec<u32>], frame: &[Vec<u32>], flat: impl Fn(u32) -> [f64; 2]) -> Self {
        let mut edges: Vec<[u32; 2]> = sides(loops).map(|[a, b]| [a.min(b), a.max(b)]).collect();
        edges.sort_unstable();
        let mut corners = loops.concat();
        corners.sort_unstable();
        Self { sides: edges, corners, figure: Figure::new(sides(frame).map(|side| side.map(&flat)).collect()) }
    }
}

impl Outline {
    /// Of a facet as it came, whose loops `corners` give the plane; with `set`, with everything inserted into its edges.
    pub fn new(facet: u32, corners: Vec<Vec<u32>>, set: Option<&EdgeSet>, points: &[Vec3]) -> Self {
        let vector = vector_area(corners.iter().map(Vec::as_slice), points);
        let area = vector.norm();
        let normal = if area > 0.0 { vector / area } else { Vec3::zeros() };
        let origin = corners.first().and_then(|w| w.first()).map_or(Vec3::zeros(), |&v| points[v as usize]);
        let bounds = Aabb::around(corners.first().into_iter().flatten().map(|&v| &points[v as usize]));
        let (loops, frame) = match set.and_then(|s| s.expand(facet, &corners)) {
            Some(loops) => (loops, Some(corners)),
            None => (corners, None),
        };
        let projection = Projection::along(&normal);
        let is_long = loops.iter().map(Vec::len).sum::<usize>() >= MANY;
        let flat = |v: u32| projection.apply(&points[v as usize]);
        let index = is_long.then(|| Box::new(Index::new(&loops, frame.as_ref().unwrap_or(&loops), flat)));
        Self { facet, normal, origin, area, projection, bounds, loops, frame, index }
    }
    /// Signed distance from the plane.
    pub fn height(&self, p: &Vec3) -> f64 {
        (p - self.origin).dot(&self.normal)
    }
    /// Loops as they came.
    fn frame(&self) -> &[Vec<u32>] {
        self.frame.as_ref().unwrap_or(&self.loops)
    }
    /// Points of the outline.
    pub fn corners(&self) -> impl Iterator<Item = u32> + '_ {
        self.loops.iter().flatten().copied()
    }
    /// Whether a point is one of the outline.
    pub fn has_corner(&self, point: u32) -> bool {
        match &self.index {
            Some(index) => index.corners.binary_search(&point).is_ok(),
            None => self.loops.iter().any(|w| w.contains(&point)),
        }
    }
    /// Whether two points are joined by an edge of the outline.
    pub fn has_side(&self, [a, b]: [u32; 2]) -> bool {
        match &self.index {
            Some(index) => index.sides.binary_search(&[a.min(b), a.max(b)]).is_ok(),
            None => sides(&self.loops).any(|s| s == [a, b] || s == [b, a]),
        }
    }
    /// Whether a place that is not on the outline lies inside it, seen along the projection.
    pub fn encloses(&self, p: &Vec3, points: &[Vec3]) -> bool {
        let q = self.projection.apply(p);
        let [lo, hi] = [&self.bounds.lo, &self.bounds.hi].map(|c| self.projection.apply(c));
        if (0..2).any(|k| q[k] < lo[k] || q[k] > hi[k]) {
            return false;
        }
        let flat = |v: u32| self.projection.apply(&points[v as usize]);
        match &self.index {
            Some(index) => index.figure.encloses(q),
            None => is_enclosed(q, sides(self.frame()).map(|side| side.map(flat))),
        }
    }
    /// Whether it has one loop that turns left at every corner, or not at all.
    pub fn is_convex(&self, points: &[Vec3]) -> bool {
        let [walk] = self.frame() else { return false };
        let (n, flat) = (walk.len(), |v: u32| self.projection.apply(&points[v as usize]));
        (0..n).all(|k| orient2d(flat(walk[k]), flat(walk[(k + 1) % n]), flat(walk[(k + 2) % n])) >= 0)
    }
    /// Whether the segment between two points of the facet runs inside it, away from its sides.
    pub fn is_chord(&self, ends: [u32; 2], tolerance: f64, points: &[Vec3]) -> bool {
        let [a, b] = ends.map(|v| points[v as usize]);
        let middle = (a + b) * 0.5;
        let is_clear = |[a, b]: [u32; 2]| !is_within(&[points[a as usize], points[b as usize]], &middle, tolerance);
        // Of a long outline hardly any side comes near; twice the tolerance leaves room for rounding.
        let [lo, hi] = [-2.0, 2.0].map(|k| self.projection.apply(&middle.add_scalar(k * tolerance)));
        let is_far = || self.index.as_ref().is_some_and(|index| !index.figure.has_side_near(lo, hi));
        !self.has_side(ends) && self.encloses(&middle, points) && (is_far() || sides(self.frame()).all(is_clear))
    }
    /// Whether all points of `other` lie within `tolerance` of the plane.
    pub fn is_level_with(&self, other: &Self, tolerance: f64, points: &[Vec3]) -> bool {
        other.loops.iter().flatten().all(|&v| self.height(&points[v as usize]).abs() <= tolerance)
    }
    /// Whether an edge of `other`, other than one of this outline, runs inside: of two facets in one plane without crossing
    /// edges, that one overlaps the other.
    pub fn is_entered_by(&self, other: &Self, points: &[Vec3]) -> bool {
        sides(&other.loops).any(|side| {
            !self.has_side(side) && {
                let [a, b] = side.map(|v| points[v as usize]);
                self.encloses(&((a + b) * 0.5), points)
            }
        })
    }
}

/// Whether a place is within `tolerance` of a segment that is longer than that.
fn is_within([a, b]: &[Vec3; 2], x: &Vec3, tolerance: f64) -> bool {
    (x - nearest_on(x, [a, b])).norm_squared() <= tolerance * tolerance
}

/// Whether a segment passes a place within `tolerance`, so that it may go through it in two shorter pieces.
pub(super) fn passes(ends: &[Vec3; 2], x: &Vec3, tolerance: f64) -> bool {
    let length = (ends[1] - ends[0]).norm();
    is_within(ends, x, tolerance) && ends.iter().all(|e| e != x && (e - x).norm() < length)
}

/// Directed edges of loops.
pub(super) fn sides<'a, W: AsRef<[u32]> + ?Sized + 'a>(
    loops: impl IntoIterator<Item = &'a W>,
) -> impl Iterator<Item = [u32; 2]> {
    // A comparison takes less time than a division.
    let ends = |w: &'a [u32]| (0..w.len()).map(move |k| [w[k], w[if k + 1 < w.len() { k + 1 } else { 0 }]]);
    loops.into_iter().flat_map(move |w| ends(w.as_ref()))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// The corners of a comb with teeth of all heights.
    pub(in crate::contact) fn comb(teeth: u32) -> Vec<Vec3> {
        let mut points = vec![Vec3::new(0.0, -1.0, 0.0), Vec3::new(f64::from(teeth), -1.0, 0.0)];
        for k in (0..teeth).rev() {
            let (x, height) = (f64::from(k), f64::from(1 + k * 7 % 13));
            points.extend(
                [(x + 0.75, 0.0), (x + 0.75, height), (x + 0.25, height), (x + 0.25, 0.0)].map(|(x, y)| Vec3::new(x, y, 0.0)),
            );
        }
        points
    }

    #[test]
    fn long_outlines_have_the_chords_that_short_ones_have() {
        let points = comb(40);
        let walk: Vec<u32> = (0..points.len() as u32).collect();
        let outline = Outline::new(0, vec![walk.clone()], None, &points);
        let plain = Outline { index: None, ..Outline::new(0, vec![walk], None, &points) };
        assert!(outline.index.is_some());
        // From tooth to tooth below their feet, and up a tooth; past the edge of a foot within the tolerance.
        let across = [(2, 9), (2, 5), (3, 4), (2, 3), (6, 13), (5, 6)];
        for (a, b) in across {
            for tolerance in [1e-9, 0.3, 2.0] {
                assert_eq!(
                    outline.is_chord([a, b], tolerance, &points),
                    plain.is_chord([a, b], tolerance, &points),
                    "{a} {b} {tolerance}"
                );
            }
        }
    }
}
