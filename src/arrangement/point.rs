//! Points of the arrangement: explicit vertices and what lines and planes through them meet in.
//!
//! An implicit point keeps how it was made ([`Source`]), its rounded place and a bound of that rounding. Signs are decided by a
//! filter on the rounded places, then by big integers ([`super::exact`]). Points are interned by exact equality: equal points
//! have equal numbers, however they were made, so that identity can be looked up instead of computed.

use super::exact::{self, ExactPoint, Integers};
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use crate::geom::dd::{self, Dd};
use crate::geom::hash::IndexMap;
use crate::geom::predicates::{self, Projection, Sign};
use std::cmp::Ordering;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering as Memory};

/// How a point is made, from explicit vertices.
#[derive(Clone, PartialEq, Debug)]
pub enum Source {
    /// A vertex with given coordinates.
    Explicit(u32),
    /// Where the line through two vertices meets the plane through three.
    LinePlane {
        /// Two vertices.
        line: [u32; 2],
        /// Three vertices.
        plane: [u32; 3],
    },
    /// Where two coplanar lines meet, seen in a projection in which they are not parallel.
    LineLine {
        /// The line that carries the point.
        line: [u32; 2],
        /// The other line.
        other: [u32; 2],
        /// The projection.
        projection: Projection,
    },
    /// Where three planes, each through three vertices, meet.
    ThreePlanes([[u32; 3]; 3]),
    /// The barycentre of three points.
    Middle(Box<[Source; 3]>),
}

/// Rounded place of a point.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Place {
    /// Rounded coordinates.
    pub at: Vec3,
    /// Bound of the error of each coordinate; 0 if exact.
    pub error: f64,
    /// What rounding took from the coordinates, as far as it is known.
    low: Vec3,
    /// Bound of the error of each coordinate together with `low`.
    fine_error: f64,
}

impl Place {
    fn exactly(at: Vec3) -> Self {
        Self { at, error: 0.0, low: Vec3::zeros(), fine_error: 0.0 }
    }
    /// A coordinate in double-double.
    fn fine(&self, axis: usize) -> Dd {
        Dd { hi: self.at[axis], lo: self.low[axis] }
    }
    /// The difference of a coordinate if its sign is certain in double-double.
    fn fine_difference(&self, other: &Self, axis: usize) -> Option<f64> {
        let difference = (self.fine(axis) - other.fine(axis)).hi;
        let bound = (self.fine_error + other.fine_error) * (1.0 + 4.0 * f64::EPSILON);
        (difference.abs() * (1.0 - OPERATIONS * dd::UNIT) > bound).then_some(difference)
    }
}

/// How often signs needed which stage.
#[derive(Debug, Default)]
pub struct SignCounts {
    /// All signs and equalities of implicit points.
    pub all: AtomicU64,
    /// Those decided by big integers.
    pub exact: AtomicU64,
}

/// All points: the explicit ones first, with their own numbers.
pub struct Points<'a> {
    explicit: &'a [Vec3],
    exponent: i32,
    implicit: Vec<Implicit>,
    /// Interning table: the last of the points rounded into each grid cell, and for each point there the one before.
    grid: IndexMap<[i64; 3], u32>,
    previous: Vec<u32>,
    cell: f64,
    /// Coordinates up to which cells have that size; farther out they grow with the coordinates.
    near: f64,
    /// Rounded places worse than this, and a few units in their last place, are computed exactly instead.
    worst: f64,
    /// Statistics.
    pub counts: SignCounts,
}

struct Implicit {
    source: Source,
    place: Place,
    exact: OnceLock<Box<ExactPoint>>,
}

/// The end of a list of points.
const NONE: u32 = u32::MAX;
/// Grid cells of the interning table as a fraction of the model's size: far above rounding errors (so that a point falls into
/// one cell almost always), far below the distance of points that differ.
const GRID_FRACTION: f64 = 1.0 / (1u64 << 34) as f64;
/// Offset of the grid in cells, so that planes through the origin do not lie on its lines.
const GRID_OFFSET: [f64; 3] = [0.371, 0.433, 0.289];
/// A rounded place worse than this fraction of the model's size is computed exactly instead.
const WORST_ERROR: f64 = 1e-14;
/// ... or, far from the origin, than this many units in the last place.
const WORST_ULPS: f64 = 8.0;
/// Places nearer to the origin than this many sizes lie in cells of one size.
const NEAR: f64 = 1e3;
/// Half a unit in the last place, relative.
const ROUND: f64 = f64::EPSILON / 2.0;

impl<'a> Points<'a> {
    /// The store over explicit vertices; `bounds` are those of the model, whose size tells how exact a place has to be, or
    /// empty.
    pub fn new(explicit: &'a [Vec3], bounds: &Aabb) -> Self {
        let bounds = if bounds.is_empty() { Aabb::around(explicit) } else { *bounds };
        let size = bounds.diagonal().max(f64::MIN_POSITIVE);
        let far = if bounds.is_empty() { 0.0 } else { bounds.lo.amax().max(bounds.hi.amax()) };
        let large = size.max(far / NEAR);
        Self {
            explicit,
            exponent: exact::common_exponent(explicit),
            implicit: Vec::new(),
            grid: IndexMap::default(),
            previous: Vec::new(),
            cell: large * GRID_FRACTION,
            near: large * NEAR,
            worst: size * WORST_ERROR,
            counts: SignCounts::default(),
        }
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.explicit.len() + self.implicit.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Number of explicit points.
    pub fn explicit_len(&self) -> usize {
        self.explicit.len()
    }

    /// Whether the point is an explicit vertex.
    pub fn is_explicit(&self, p: u32) -> bool {
        (p as usize) < self.explicit.len()
    }

    /// Rounded place.
    pub fn place(&self, p: u32) -> Place {
        match self.explicit.get(p as usize) {
            Some(&at) => Place::exactly(at),
            None => self.implicit[p as usize - self.explicit.len()].place,
        }
    }

    /// Rounded coordinates.
    pub fn at(&self, p: u32) -> Vec3 {
        *self.rounded(p).0
    }

    /// Rounded coordinates and the bound of their errors: all that most signs need.
    fn rounded(&self, p: u32) -> (&Vec3, f64) {
        match self.explicit.get(p as usize) {
            Some(at) => (at, 0.0),
            None => {
                let place = &self.implicit[p as usize - self.explicit.len()].place;
                (&place.at, place.error)
            }
        }
    }

    fn integers(&self) -> Integers<'_> {
        Integers { points: self.explicit, exponent: self.exponent }
    }

    /// Exact place; cached for implicit points.
    pub fn exact(&self, p: u32) -> std::borrow::Cow<'_, ExactPoint> {
        use std::borrow::Cow;
        if self.is_explicit(p) {
            return Cow::Owned(self.integers().place(&Source::Explicit(p)));
        }
        let point = &self.implicit[p as usize - self.explicit.len()];
        if point.place.error == 0.0 {
            return Cow::Owned(self.exact_at(&point.place.at));
        }
        Cow::Borrowed(point.exact.get_or_init(|| Box::new(self.integers().place(&point.source))))
    }

    /// Exact place of a source that is not interned.
    pub fn exact_of(&self, source: &Source) -> ExactPoint {
        self.integers().place(source)
    }

    /// Exact place of coordinates from [`Points::coarse`].
    pub fn exact_at(&self, at: &Vec3) -> ExactPoint {
        Integers { points: std::slice::from_ref(at), exponent: self.exponent }.place(&Source::Explicit(0))
    }

    /// The nearest place with few enough bits for [`Points::exact_at`].
    pub fn coarse(&self, at: &Vec3) -> Vec3 {
        let step = 2f64.powi(self.exponent.max((self.cell / GRID_FRACTION).log2().floor() as i32 - 20));
        at.map(|x| (x / step).round() * step)
    }

    /// How a point was made.
    pub fn source(&self, p: u32) -> Source {
        if self.is_explicit(p) { Source::Explicit(p) } else { self.implicit[p as usize - self.explicit.len()].source.clone() }
    }

    /// Makes room for more points.
    pub fn reserve(&mut self, more: usize) {
        self.implicit.reserve(more);
        self.grid.reserve(more);
    }

    /// Makes explicit vertices known to the interning table, so that an implicit point that falls on one gets its number.
    pub fn register(&mut self, vertex: u32) {
        let at = &self.explicit[vertex as usize];
        self.put(self.key(at, self.level(at.amax())), vertex);
    }

    fn put(&mut self, key: [i64; 3], point: u32) {
        let last = self.grid.entry(key).or_insert(NONE);
        if self.previous.len() <= point as usize {
            self.previous.resize(point as usize + 1, NONE);
        }
        self.previous[point as usize] = std::mem::replace(last, point);
    }

    /// The number of the point made by `source`: that of an equal point if there is one.
    pub fn intern(&mut self, source: Source) -> u32 {
        let place = self.round(&source);
        self.intern_placed(source, place)
    }

    /// As [`Points::intern`], with the place from [`Points::round`].
    pub fn intern_placed(&mut self, source: Source, place: Place) -> u32 {
        let mut exact = None;
        for key in self.keys_near(&place) {
            let mut next = self.grid.get(&key).copied().unwrap_or(NONE);
            while next != NONE {
                let p = next;
                next = self.previous[p as usize];
                if self.may_be(p, &place) {
                    if place.error == 0.0 && self.rounded(p).1 == 0.0 {
                        return p;
                    }
                    self.counts.all.fetch_add(1, Memory::Relaxed);
                    self.counts.exact.fetch_add(1, Memory::Relaxed);
                    let mine = exact.get_or_insert_with(|| self.integers().place(&source));
                    if is_same(mine, &self.exact(p)) {
                        return p;
                    }
                }
            }
        }
        let id = self.len() as u32;
        let cache = OnceLock::new();
        if let Some(exact) = exact {
            let _ = cache.set(Box::new(exact));
        }
        self.implicit.push(Implicit { source, place, exact: cache });
        self.put(self.key(&place.at, self.level(place.at.amax())), id);
        id
    }

    /// Cells of all places that may be the same point.
    fn keys_near(&self, place: &Place) -> impl Iterator<Item = [i64; 3]> + use<> {
        let (reach, far) = (2.0 * (place.error + self.worst_at(&place.at)), place.at.amax());
        let cells = |level| {
            let shift = Vec3::repeat(reach);
            (self.key(&(place.at - shift), level), self.key(&(place.at + shift), level))
        };
        let levels = [self.level(far - reach), self.level(far + reach)];
        // A place near the border of two levels has cells of both.
        let ranges = [Some(cells(levels[0])), (levels[0] != levels[1]).then(|| cells(levels[1]))];
        ranges.into_iter().flatten().flat_map(|(lo, hi)| {
            let rows = (lo[0]..=hi[0]).flat_map(move |x| (lo[1]..=hi[1]).map(move |y| [x, y]));
            rows.flat_map(move |[x, y]| (lo[2]..=hi[2]).map(move |z| [x, y, z]))
        })
    }

    /// Errors that a rounded place may have.
    fn worst_at(&self, at: &Vec3) -> f64 {
        self.worst + at.amax() * WORST_ULPS * f64::EPSILON
    }

    /// How often cells are doubled at this distance from the origin.
    fn level(&self, far: f64) -> i32 {
        if far <= self.near { 0 } else { libm::log2(far / self.near).ceil() as i32 }
    }

    /// Whether a point may be at a place, as far as rounded places tell.
    fn may_be(&self, p: u32, place: &Place) -> bool {
        let other = self.place(p);
        let apart = place.error + other.error;
        (0..3).all(|k| (other.at[k] - place.at[k]).abs() <= apart && other.fine_difference(place, k).is_none())
    }

    fn key(&self, p: &Vec3, level: i32) -> [i64; 3] {
        let cell = if level == 0 { self.cell } else { self.cell * 2f64.powi(level) };
        [0, 1, 2].map(|k| (p[k] / cell + GRID_OFFSET[k]).floor() as i64)
    }

    /// Where the point of a source is if each coordinate is that of a line or plane which is level there, as all are of boxes:
    /// nothing need be computed, and nothing is rounded.
    fn level_place(&self, source: &Source) -> Option<Vec3> {
        let mut known = [None; 3];
        let mut level = |vertices: &[u32], axes: &[u8]| {
            for &k in axes {
                let mut heights = vertices.iter().map(|&v| self.explicit[v as usize][usize::from(k)]);
                let first = heights.next();
                if heights.all(|height| Some(height) == first) {
                    known[usize::from(k)] = first;
                }
            }
        };
        match source {
            Source::LinePlane { line, plane } => {
                level(line, &[0, 1, 2]);
                level(plane, &[0, 1, 2]);
            }
            Source::LineLine { line, other, projection } => {
                level(line, &[0, 1, 2]);
                // The point lies on the other line as far as the projection tells.
                level(other, &[projection.u, projection.v]);
            }
            Source::ThreePlanes(planes) => planes.iter().for_each(|plane| level(plane, &[0, 1, 2])),
            Source::Explicit(_) | Source::Middle(_) => return None,
        }
        let [Some(x), Some(y), Some(z)] = known else { return None };
        // Minus zero is zero, as it is where something is computed.
        Some(Vec3::new(x, y, z).add_scalar(0.0))
    }

    /// Rounded place of a source, with a bound of its error.
    pub fn round(&self, source: &Source) -> Place {
        if let Some(at) = self.level_place(source) {
            return Place::exactly(at);
        }
        let place = match source {
            Source::Explicit(v) => return Place::exactly(self.explicit[*v as usize]),
            Source::LinePlane { line, plane } => {
                let [p, q] = line.map(|v| &self.explicit[v as usize]);
                let [r, s, t] = plane.map(|v| &self.explicit[v as usize]);
                line_plane(p, q, r, s, t)
            }
            Source::LineLine { line, other, projection } => {
                let [p, q] = line.map(|v| &self.explicit[v as usize]);
                let [r, s] = other.map(|v| &self.explicit[v as usize]);
                line_line(p, q, r, s, *projection)
            }
            Source::ThreePlanes(planes) => three_planes(&planes.map(|t| t.map(|v| self.explicit[v as usize]))),
            Source::Middle(_) => None,
        };
        place.filter(|p| p.error <= self.worst_at(&p.at)).unwrap_or_else(|| {
            let exact = self.integers().place(source);
            let at = Vec3::from_fn(|k, _| exact::to_f64(&exact, k, self.exponent));
            let error = at.amax() * 2.0 * f64::EPSILON + f64::MIN_POSITIVE;
            Place { at, error, low: Vec3::zeros(), fine_error: error }
        })
    }

    /// Sign of the turn a, b, c in a projection. Exact.
    pub fn orient2d(&self, a: u32, b: u32, c: u32, projection: Projection) -> Sign {
        if a == b || b == c || c == a {
            return 0;
        }
        let [(pa, ea), (pb, eb), (pc, ec)] = [a, b, c].map(|p| self.rounded(p));
        let (fa, fb, fc) = (projection.apply(pa), projection.apply(pb), projection.apply(pc));
        let error = ea + eb + ec;
        if error == 0.0 {
            return predicates::orient2d(fa, fb, fc);
        }
        self.counts.all.fetch_add(1, Memory::Relaxed);
        let (x1, y1) = (fb[0] - fa[0], fb[1] - fa[1]);
        let (x2, y2) = (fc[0] - fa[0], fc[1] - fa[1]);
        let (m1, m2) = (x1 * y2, y1 * x2);
        let span = x1.abs() + y1.abs() + x2.abs() + y2.abs();
        // Each difference is off by at most `error` and its own rounding; the products and their difference round once more.
        let slack = error + 2.0 * ROUND * span;
        let bound = slack * (span + 2.0 * slack) + 8.0 * ROUND * (m1.abs() + m2.abs());
        let det = m1 - m2;
        if det.abs() > bound {
            return predicates::sign(det);
        }
        if let Some(sign) = fine_orient2d([a, b, c].map(|p| self.place(p)), projection) {
            return sign;
        }
        self.counts.exact.fetch_add(1, Memory::Relaxed);
        exact::orient2d(&self.exact(a), &self.exact(b), &self.exact(c), projection.u as usize, projection.v as usize)
    }

    /// Order of one coordinate of two points. Exact.
    pub fn compare(&self, a: u32, b: u32, axis: usize) -> Ordering {
        if a == b {
            return Ordering::Equal;
        }
        let [(pa, ea), (pb, eb)] = [a, b].map(|p| self.rounded(p));
        let difference = pa[axis] - pb[axis];
        let error = ea + eb;
        if error != 0.0 {
            self.counts.all.fetch_add(1, Memory::Relaxed);
        }
        if error == 0.0 || difference.abs() > error * (1.0 + 4.0 * f64::EPSILON) {
            return difference.partial_cmp(&0.0).unwrap_or(Ordering::Equal);
        }
        if let Some(difference) = self.place(a).fine_difference(&self.place(b), axis) {
            return difference.partial_cmp(&0.0).unwrap_or(Ordering::Equal);
        }
        self.counts.exact.fetch_add(1, Memory::Relaxed);
        exact::compare(&self.exact(a), &self.exact(b), axis)
    }
}

/// The sign of a turn if it is certain in double-double: two triangles of one polygon are not quite in one plane, and the lines
/// in which they cross a third differ in the last digit.
fn fine_orient2d([a, b, c]: [Place; 3], projection: Projection) -> Option<Sign> {
    let (u, v) = (projection.u as usize, projection.v as usize);
    let (x1, y1) = (b.fine(u) - a.fine(u), b.fine(v) - a.fine(v));
    let (x2, y2) = (c.fine(u) - a.fine(u), c.fine(v) - a.fine(v));
    let (m1, m2) = (x1 * y2, y1 * x2);
    let span = [x1, y1, x2, y2].iter().map(|x| x.magnitude()).sum::<f64>();
    // As in the filter before, with the rounding of double-double.
    let unit = OPERATIONS * dd::UNIT;
    let slack = a.fine_error + b.fine_error + c.fine_error + unit * span;
    let bound = 2.0 * slack * (span + slack) + unit * (m1.magnitude() + m2.magnitude());
    let det = (m1 - m2).hi;
    (det.abs() > bound).then(|| predicates::sign(det))
}

fn is_same(a: &ExactPoint, b: &ExactPoint) -> bool {
    (0..3).all(|k| exact::compare(a, b, k) == Ordering::Equal)
}

type D3 = [Dd; 3];

fn minus(a: &Vec3, b: &Vec3) -> D3 {
    [0, 1, 2].map(|k| Dd::difference(a[k], b[k]))
}

fn cross(a: &D3, b: &D3) -> D3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: &D3, b: &D3) -> Dd {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Largest leading part.
fn size(a: &D3) -> f64 {
    a.iter().fold(0.0, |m, x| m.max(x.magnitude()))
}

/// Room for the few dozen double-double operations that make one coordinate.
const OPERATIONS: f64 = 64.0;

/// A place in double-double that is off by `error` before its last addition.
fn rounded(place: D3, error: f64) -> Place {
    let at = Vec3::from_fn(|k, _| place[k].hi);
    let low = Vec3::from_fn(|k, _| place[k].lo);
    Place { at, error: error + at.amax() * f64::EPSILON, low, fine_error: error + at.amax() * OPERATIONS * dd::UNIT }
}

/// `p + (q - p) num / den` with the errors of `num` and `den` given.
fn along(p: &Vec3, step: &D3, num: Dd, num_error: f64, den: Dd, den_error: f64) -> Option<Place> {
    if den.magnitude() <= 2.0 * den_error {
        return None;
    }
    let t = num / den;
    let t_error =
        (num_error + t.magnitude() * den_error) / (den.magnitude() - den_error) + OPERATIONS * dd::UNIT * t.magnitude();
    let error = size(step) * (t_error + OPERATIONS * dd::UNIT * t.magnitude());
    Some(rounded([0, 1, 2].map(|k| Dd::from(p[k]) + step[k] * t), error))
}

fn line_plane(p: &Vec3, q: &Vec3, r: &Vec3, s: &Vec3, t: &Vec3) -> Option<Place> {
    let (rs, rt, step, pr) = (minus(s, r), minus(t, r), minus(q, p), minus(r, p));
    let n = cross(&rs, &rt);
    let n_scale = size(&rs) * size(&rt);
    let unit = OPERATIONS * dd::UNIT * n_scale;
    along(p, &step, dot(&n, &pr), unit * size(&pr), dot(&n, &step), unit * size(&step))
}

fn line_line(p: &Vec3, q: &Vec3, r: &Vec3, s: &Vec3, projection: Projection) -> Option<Place> {
    let (u, v) = (projection.u as usize, projection.v as usize);
    let (rs, step, pr) = (minus(s, r), minus(q, p), minus(r, p));
    let flat = |a: &D3, b: &D3| a[u] * b[v] - a[v] * b[u];
    let unit = OPERATIONS * dd::UNIT * size(&rs);
    along(p, &step, flat(&pr, &rs), unit * size(&pr), flat(&step, &rs), unit * size(&step))
}

fn three_planes(planes: &[[Vec3; 3]; 3]) -> Option<Place> {
    let origin = planes[0][0];
    let normals = planes.map(|[a, b, c]| cross(&minus(&b, &a), &minus(&c, &a)));
    let scales = planes.map(|[a, b, c]| size(&minus(&b, &a)) * size(&minus(&c, &a)));
    let offsets: Vec<D3> = planes.iter().map(|t| minus(&t[0], &origin)).collect();
    let d = [0, 1, 2].map(|k| dot(&normals[k], &offsets[k]));
    let (c23, c31, c12) = (cross(&normals[1], &normals[2]), cross(&normals[2], &normals[0]), cross(&normals[0], &normals[1]));
    let w = dot(&normals[0], &c23);
    let scale = scales[0] * scales[1] * scales[2] * OPERATIONS * dd::UNIT;
    if w.magnitude() <= 2.0 * scale {
        return None;
    }
    let reach = offsets.iter().map(size).fold(0.0, f64::max);
    let moved: D3 = [0, 1, 2].map(|k| (d[0] * c23[k] + d[1] * c31[k] + d[2] * c12[k]) / w);
    let error = 4.0 * scale * (reach + size(&moved)) / (w.magnitude() - scale);
    Some(rounded([0, 1, 2].map(|k| Dd::from(origin[k]) + moved[k]), error))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_point_made_in_three_ways_has_one_number() {
        let v = |x: f64, y: f64, z: f64| Vec3::new(x, y, z);
        // The planes x = 0.3 y..., tilted so that nothing is representable.
        let p = v(0.1, 0.2, 0.3);
        let (a, b, c) = (v(1.0, 0.3, 0.1), v(0.2, 1.1, -0.3), v(-0.1, 0.2, 1.3));
        let explicit =
            [p - a, p + a, p - b, p + b, p - c, p + c, v(0., 0., 0.), v(3., 0., 0.), v(0., 3., 0.), v(0.5, 0.5, 7.0)];
        let mut points = Points::new(&explicit, &Aabb::EMPTY);
        let x = points.intern(Source::LinePlane { line: [6, 9], plane: [0, 3, 5] });
        let y = points.intern(Source::ThreePlanes([[6, 9, 0], [6, 9, 3], [0, 3, 5]]));
        assert_eq!(x, y);
        let z = points.intern(Source::LinePlane { line: [6, 9], plane: [1, 3, 5] });
        assert_ne!(x, z);
        let exact = points.exact(x).into_owned();
        for k in 0..3 {
            let rounded = exact::to_f64(&exact, k, points.exponent);
            assert!((rounded - points.at(x)[k]).abs() <= points.place(x).error);
        }
    }

    #[test]
    fn points_of_level_lines_and_planes_are_exact() {
        let v = |x: f64, y: f64, z: f64| Vec3::new(x, y, z);
        // A line along z at (0.1, 0.7), one along x at y = 0.7, planes x = 0.1, y = 0.7, z = -0, and one that is oblique.
        let explicit = [
            v(0.1, 0.7, -1.0),
            v(0.1, 0.7, 0.3),
            v(-3.0, 0.7, -0.0),
            v(2.0, 0.7, -0.0),
            v(0.1, 5.0, 1.0),
            v(0.1, -2.0, 7.0),
            v(9.0, 0.7, 2.0),
            v(0.0, 0.0, -0.0),
            v(1.0, 0.0, -0.0),
            v(0.0, 1.0, -0.0),
            v(0.4, 0.3, 0.0),
            v(0.6, 3.0, 1.0),
        ];
        let mut points = Points::new(&explicit, &Aabb::around(&explicit));
        let x = points.intern(Source::LinePlane { line: [0, 1], plane: [7, 8, 9] });
        assert_eq!((points.place(x), points.at(x).z.to_bits()), (Place::exactly(v(0.1, 0.7, 0.0)), 0));
        assert_eq!(points.intern(Source::ThreePlanes([[0, 4, 5], [2, 1, 6], [7, 8, 9]])), x);
        let projection = Projection { u: 0, v: 2 };
        assert_eq!(points.intern(Source::LineLine { line: [0, 1], other: [2, 3], projection }), x);
        // The same place where it has to be computed, and a point on the oblique plane beside it.
        assert_eq!(points.intern(Source::ThreePlanes([[0, 1, 10], [2, 1, 6], [7, 8, 9]])), x);
        let y = points.intern(Source::LinePlane { line: [0, 1], plane: [7, 8, 11] });
        assert!(y != x && points.place(y).error > 0.0);
        let computed = points.exact_of(&Source::ThreePlanes([[0, 1, 10], [2, 1, 6], [7, 8, 9]]));
        assert!(is_same(&points.exact(x), &computed));
    }

    #[test]
    fn points_are_told_apart_and_known_again_however_large_the_tools_are() {
        let v = |x: f64, y: f64, z: f64| Vec3::new(x, y, z);
        for far in [1.0, 1e9, 3e38] {
            // Two uprights that are 1e-7 apart, two planes of that size, and a third plane through both uprights.
            let level = |z: f64| [v(-far, -far, z), v(far, -far, z), v(0.0, far, z)];
            let uprights = [v(0.1, 0.3, -1.0), v(0.1, 0.3, 1.0), v(0.1 + 1e-7, 0.3, -1.0), v(0.1 + 1e-7, 0.3, 1.0)];
            let explicit = [&uprights[..], &level(0.25), &level(0.25 - 1e-7)].concat();
            let mut points = Points::new(&explicit, &Aabb::around(&uprights));
            let mut at = |line: [u32; 2], plane: [u32; 3]| points.intern(Source::LinePlane { line, plane });
            let all = [at([0, 1], [4, 5, 6]), at([2, 3], [4, 5, 6]), at([0, 1], [7, 8, 9]), at([2, 3], [7, 8, 9])];
            assert_eq!(all, [10, 11, 12, 13], "{far:e}");
            assert_eq!([at([1, 0], [6, 5, 4]), at([3, 2], [9, 7, 8])], [10, 13], "{far:e}");
            // Far outside of the model: where an edge of a plane meets an upright plane.
            let (edge, wall) = ([4, 5], [0, 1, 6]);
            let outside = at(edge, wall);
            assert_eq!([at([5, 4], [1, 6, 0]), outside], [outside; 2], "{far:e}");
            assert!(points.place(10).error <= 1e-14 && points.place(10).at == v(0.1, 0.3, 0.25), "{far:e}");
        }
    }

    #[test]
    fn a_point_on_a_vertex_is_the_vertex() {
        let explicit = [
            Vec3::new(0., 0., -1.),
            Vec3::new(0., 0., 1.),
            Vec3::new(-1., -1., 0.),
            Vec3::new(1., -1., 0.),
            Vec3::new(0., 1., 0.),
            Vec3::zeros(),
        ];
        let mut points = Points::new(&explicit, &Aabb::EMPTY);
        points.register(5);
        assert_eq!(points.intern(Source::LinePlane { line: [0, 1], plane: [2, 3, 4] }), 5);
    }

    #[test]
    fn turns_of_implicit_points_are_exact() {
        let explicit = [
            Vec3::new(0., 0., -1.),
            Vec3::new(0.3, 0.1, 1.),
            Vec3::new(-1., -1., 0.1),
            Vec3::new(1., -1., 0.2),
            Vec3::new(0., 1., 0.3),
        ];
        let mut points = Points::new(&explicit, &Aabb::EMPTY);
        let m = points.intern(Source::LinePlane { line: [0, 1], plane: [2, 3, 4] });
        let q = Projection { u: 0, v: 2 };
        assert_eq!(points.orient2d(0, 1, m, q), 0, "on its own line");
        assert_eq!(points.compare(0, m, 2), Ordering::Less);
    }
}
