//! One exact ray per connected component (thesis 2.2.4.3: ray casting).

use crate::arrangement::Arrangement;
use crate::arrangement::exact::{self, ExactPoint};
use crate::arrangement::point::Source;
use crate::arrangement::projection_of_triangle;
use crate::diag::Diagnostic;
use crate::geom::Vec3;
use crate::geom::aabb::{Aabb, Segment};
use crate::geom::bvh::Bvh;
use crate::geom::predicates::{Sign, orient3d};

/// Directions tried before giving up; each fails only if the ray meets an edge exactly.
const TRIES: u64 = 64;

/// Rays from which on the triangles go into a box tree: most models need one or two, and looking at everything costs less then.
const TREE_FROM: usize = 4;

/// Casts rays against the leaves.
pub struct Rays<'a> {
    arrangement: &'a Arrangement<'a>,
    bounds: Aabb,
    /// Number of rays so far.
    cast: usize,
    /// Box tree of all triangles, if it pays.
    tree: Option<Bvh>,
}

impl<'a> Rays<'a> {
    /// Looks at the extent of everything.
    pub fn new(arrangement: &'a Arrangement<'a>) -> Self {
        Self { arrangement, bounds: Aabb::around(&arrangement.input.points), cast: 0, tree: None }
    }

    /// The leaves that contain the space in front of a sub-cell; `None` if it has no place to cast a ray from.
    pub fn label_in_front(&mut self, cell: usize) -> Result<Option<Vec<u32>>, Diagnostic> {
        let Some(inside) = self.inner_point(cell) else { return Ok(None) };
        let owners = self.arrangement.cells.owners_of(cell);
        let from = Origin { exact: self.arrangement.points.exact_of(&inside), near: self.arrangement.points.round(&inside).at };
        let mut label = self.leaves_around(&from)?;
        // The point lies on its owners.
        label.retain(|&leaf| owners.iter().all(|o| o.leaf.0 != leaf));
        label.extend(owners.iter().filter(|o| o.is_flipped).map(|o| o.leaf.0));
        label.sort_unstable();
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

    /// The leaves that a point is inside of, by the parity of the triangles that a ray meets; anything for those on which it lies.
    fn leaves_around(&mut self, from: &Origin) -> Result<Vec<u32>, Diagnostic> {
        for attempt in 0..TRIES {
            let target = self.far_point(&from.near, attempt);
            if let Some(mut passed) = self.passed(from, &target) {
                passed.sort_unstable();
                let is_odd = |leaf: &&[u32]| leaf.len() % 2 == 1;
                return Ok(passed.chunk_by(|a, b| a == b).filter(is_odd).map(|leaf| leaf[0]).collect());
            }
        }
        Err(Diagnostic::internal("ray", "every ray from a point meets an edge").near(from.near))
    }

    /// The leaves whose triangles a ray passes, once for each triangle; `None` if it meets the boundary of one.
    fn passed(&mut self, from: &Origin, target: &Vec3) -> Option<Vec<u32>> {
        let segment = Segment::new(&from.near, target);
        let is_near = |bounds: &Aabb| segment.may_meet(bounds, 1.0);
        let all = 0..self.arrangement.input.triangles.len() as u32;
        self.cast += 1;
        if self.cast == TREE_FROM {
            self.tree = Some(Bvh::new(all.clone().map(|t| self.bounds_of(t)).collect()));
        }
        let (mut passed, mut is_clear) = (Vec::new(), true);
        let mut look_at = |t: u32| match self.crosses(from, target, t) {
            Some(true) => passed.extend(self.arrangement.input.owners_of_triangle(t).iter().map(|o| o.leaf.0)),
            Some(false) => {}
            None => is_clear = false,
        };
        match &self.tree {
            Some(tree) => tree.search(is_near, look_at),
            None => all.filter(|&t| is_near(&self.bounds_of(t))).for_each(&mut look_at),
        }
        is_clear.then_some(passed)
    }

    /// A point well outside everything, on about the shortest way out of the box of all, which meets the least; the slant depends
    /// on the attempt.
    fn far_point(&self, from: &Vec3, attempt: u64) -> Vec3 {
        let Aabb { lo, hi } = &self.bounds;
        let ways = (0..3).flat_map(|k| [(from[k] - lo[k], k, -1.0), (hi[k] - from[k], k, 1.0)]);
        let (gap, axis, way) = ways.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, 0, 1.0));
        // Equidistributed and unrelated to coordinate directions: multiples of three irrational numbers.
        let slant = |x: f64| 0.5 * (((attempt + 1) as f64 * x).fract() - 0.5);
        let mut direction = Vec3::new(slant(0.754_877_666_2), slant(0.569_840_290_9), slant(0.819_172_513_4));
        direction[axis] = way;
        self.arrangement.points.coarse(&(from + direction * (gap + self.bounds.diagonal())))
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
