//! One exact ray per connected component (thesis 2.2.4.3: ray casting).

use crate::arrangement::Arrangement;
use crate::arrangement::exact::{self, ExactPoint};
use crate::arrangement::point::Source;
use crate::arrangement::projection_of_triangle;
use crate::diag::Diagnostic;
use crate::geom::Vec3;
use crate::geom::aabb::{Aabb, Segment};
use crate::geom::bvh::Bvh;
use crate::geom::lists::Lists;
use crate::geom::predicates::{Sign, orient3d};
use std::cell::{Cell, OnceCell};

/// Directions tried before giving up; each fails only if the ray meets an edge exactly.
const TRIES: u64 = 64;

/// Casts rays against the leaves.
pub struct Rays<'a> {
    arrangement: &'a Arrangement<'a>,
    /// Triangles of each leaf.
    triangles: Lists,
    /// Boxes of the leaves.
    leaves: Bvh,
    /// What is kept for further rays through each leaf.
    searches: Vec<Search>,
}

/// A tree over a leaf's triangles, made for the second ray: most leaves are met by one or none. Not `Sync`, on purpose: rays
/// are cast one after the other, each only where the labels spread so far do not reach, so that threads would wait for each
/// other.
#[derive(Default)]
struct Search {
    is_repeated: Cell<bool>,
    tree: OnceCell<Bvh>,
}

/// Triangles of a leaf up to which all are looked at.
const FEW: usize = 64;

impl<'a> Rays<'a> {
    /// Sorts the triangles by leaf.
    pub fn new(arrangement: &'a Arrangement<'a>) -> Self {
        let input = arrangement.input;
        let mut by_leaf: Vec<(u32, u32)> = Vec::with_capacity(input.triangles.len());
        let mut leaf_boxes: Vec<Aabb> = Vec::new();
        for (t, corners) in input.triangles.iter().enumerate() {
            let own = Aabb::around(corners.map(|v| &input.points[v as usize]));
            for owner in input.owners_of_triangle(t as u32) {
                let leaf = owner.leaf.0 as usize;
                if leaf_boxes.len() <= leaf {
                    leaf_boxes.resize(leaf + 1, Aabb::EMPTY);
                }
                by_leaf.push((owner.leaf.0, t as u32));
                leaf_boxes[leaf] = leaf_boxes[leaf].union(&own);
            }
        }
        let triangles = Lists::new(leaf_boxes.len(), &by_leaf);
        let searches = leaf_boxes.iter().map(|_| Search::default()).collect();
        Self { arrangement, triangles, leaves: Bvh::new(leaf_boxes), searches }
    }

    /// The leaves that contain the space in front of a sub-cell; `None` if it has no place to cast a ray from.
    pub fn label_in_front(&self, cell: usize) -> Result<Option<Vec<u32>>, Diagnostic> {
        let Some(inside) = self.inner_point(cell) else { return Ok(None) };
        let owners = self.arrangement.cells.owners_of(cell);
        let from = Origin { exact: self.arrangement.points.exact_of(&inside), near: self.arrangement.points.round(&inside).at };
        let margin = self.leaves.bounds().diagonal() * 1e-9; // the rounded origin only selects leaves to look at
        let mut label: Vec<u32> = owners.iter().filter(|o| o.is_flipped).map(|o| o.leaf.0).collect();
        let mut around = Vec::new();
        self.leaves.search(|b| b.inflated(margin).contains(&from.near), |leaf| around.push(leaf));
        for leaf in around.into_iter().filter(|leaf| owners.iter().all(|o| o.leaf.0 != *leaf)) {
            if self.is_inside(&from, leaf)? {
                label.push(leaf);
            }
        }
        label.sort_unstable();
        label.dedup();
        Ok(Some(label))
    }

    /// A point strictly inside a sub-cell: the barycentre of an ear of its outer loop that holds no other point.
    fn inner_point(&self, cell: usize) -> Option<Source> {
        let (cells, points) = (&self.arrangement.cells, &self.arrangement.points);
        let triangle = self.arrangement.input.triangles[cells.triangle[cell] as usize];
        let projection = projection_of_triangle(self.arrangement.input, triangle);
        let all: Vec<u32> = cells.loops(cell).flatten().copied().collect();
        let outer = cells.loops(cell).next()?;
        let n = outer.len();
        (0..n).find_map(|k| {
            let ear = [outer[(k + n - 1) % n], outer[k], outer[(k + 1) % n]];
            let turn = |a: u32, b: u32, c: u32| points.orient2d(a, b, c, projection);
            if turn(ear[0], ear[1], ear[2]) <= 0 {
                return None;
            }
            let is_in_ear = |p: &u32| !ear.contains(p) && (0..3).all(|e| turn(ear[e], ear[(e + 1) % 3], *p) >= 0);
            let is_free = !all.iter().any(is_in_ear);
            is_free.then(|| Source::Middle(Box::new(ear.map(|p| points.source(p)))))
        })
    }

    /// Whether a point that is not on the leaf is inside it: parity of the triangles that a ray meets.
    fn is_inside(&self, from: &Origin, leaf: u32) -> Result<bool, Diagnostic> {
        for attempt in 0..TRIES {
            let target = self.far_point(attempt);
            let segment = Segment::new(&from.near, &target, &self.leaves.bounds());
            let mut crossings = Some(0u32);
            self.along(leaf, &segment, |t| {
                crossings = crossings.and_then(|n| Some(n + u32::from(self.crosses(from, &target, t)?)));
            });
            if let Some(n) = crossings {
                return Ok(n % 2 == 1);
            }
        }
        Err(Diagnostic::internal("ray", "every ray from a point meets an edge").near(from.near))
    }

    /// Calls `visit` with the triangles of a leaf that a segment may meet.
    fn along(&self, leaf: u32, segment: &Segment, mut visit: impl FnMut(u32)) {
        let (triangles, search) = (self.triangles.of(leaf), &self.searches[leaf as usize]);
        if triangles.len() <= FEW || !search.is_repeated.replace(true) {
            let is_near = |t: &&u32| segment.may_meet(&self.bounds_of(**t), 1.0);
            return triangles.iter().filter(is_near).for_each(|&t| visit(t));
        }
        let tree = search.tree.get_or_init(|| Bvh::new(triangles.iter().map(|&t| self.bounds_of(t)).collect()));
        tree.search(|b| segment.may_meet(b, 1.0), |k| visit(triangles[k as usize]));
    }

    /// A point well outside everything, in a direction that depends on the attempt.
    fn far_point(&self, attempt: u64) -> Vec3 {
        let bounds = self.leaves.bounds();
        // Equidistributed and unrelated to coordinate directions: multiples of three irrational numbers.
        let f = |x: f64| ((attempt + 1) as f64 * x).fract() - 0.5;
        let direction = Vec3::new(f(0.754_877_666_2) + 0.1, f(0.569_840_290_9) + 0.2, 0.6 + f(0.819_172_513_4).abs());
        self.arrangement.points.coarse(&(bounds.center() + direction.normalize() * (2.0 * bounds.diagonal())))
    }

    fn bounds_of(&self, triangle: u32) -> Aabb {
        Aabb::around(self.arrangement.input.triangles[triangle as usize].map(|v| &self.arrangement.input.points[v as usize]))
    }

    /// Whether the open segment crosses a triangle whose box it may meet; `None` if it meets its boundary.
    fn crosses(&self, from: &Origin, to: &Vec3, triangle: u32) -> Option<bool> {
        let input = self.arrangement.input;
        let ids = input.triangles[triangle as usize];
        let [a, b, c] = ids.map(|v| &input.points[v as usize]);
        let above = orient3d(a, b, c, to);
        let below = self.orient(from, [Some(ids[0]), Some(ids[1]), Some(ids[2])], to);
        if above == 0 || below == 0 || above == below {
            return Some(false);
        }
        let mut sides = [0; 3];
        for k in 0..3 {
            sides[k] = self.orient(from, [None, Some(ids[k]), Some(ids[(k + 1) % 3])], to);
        }
        if sides.contains(&0) {
            // On the line of an edge: harmless if another edge separates.
            return if sides.contains(&1) && sides.contains(&-1) { Some(false) } else { None };
        }
        Some(sides[0] == sides[1] && sides[1] == sides[2])
    }

    /// Side of the origin about the plane of three points, `None` standing for the target.
    fn orient(&self, from: &Origin, plane: [Option<u32>; 3], target: &Vec3) -> Sign {
        let at = |v: Option<u32>| v.map_or(*target, |v| self.arrangement.input.points[v as usize]);
        let [a, b, c] = plane.map(at);
        let (u, v, w) = (b - a, c - a, from.near - a);
        let n = u.cross(&v);
        let det = n.dot(&w);
        // The origin is rounded to a few units in the last place; every product rounds as often.
        let scale = from.near.amax().max(a.amax()).max(b.amax()).max(c.amax());
        let bound = 64.0 * f64::EPSILON * (u.norm() * v.norm() * (w.norm() + scale) + scale * (u.norm() + v.norm()) * w.norm());
        if det.abs() > bound {
            return if det > 0.0 { 1 } else { -1 };
        }
        let points = &self.arrangement.points;
        let exact = |v: Option<u32>| match v {
            Some(v) => points.exact(v).into_owned(),
            None => points.exact_at(target),
        };
        let [a, b, c] = plane.map(exact);
        exact::orient3d(&a, &b, &c, &from.exact)
    }
}

struct Origin {
    exact: ExactPoint,
    near: Vec3,
}
