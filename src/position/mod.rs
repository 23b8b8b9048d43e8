//! General position: a trace of stretch for what lies askew, of which TetGen would die.
//!
//! The corners of a circle lie on one circle, those of a rectangle too. In a plane along the axes all signs that TetGen takes
//! of them are exact zeros, which it knows how to break. In any other plane rounding puts each corner a little above or below
//! the plane; four of them, on one circle but for rounding as well, then span a flat tetrahedron that no other corner is nearer
//! to, and TetGen 1.5 does not find the facet among such tetrahedra: of single cylinders and cones, freely turned, it loses
//! every second one (abort, crash or endless loop).
//!
//! So what hangs together and has such a polygon is stretched along the axes, by factors that differ from 1 and from each
//! other, until its corners have moved by a hundredth of the tolerance, or more far from the origin. Circles become ellipses,
//! and no corner is on the circle of three others by a distance that is 10000 times what rounding moves it out of the plane.
//! Planes stay planes, those along the axes exactly so; contacts stay what they are, since what touches hangs together. What
//! does not touch is mostly further apart than that; it is proved that nothing meets, and pieces that would meet something stay
//! as they were.
//!
//! Another cause of death are corners in line but for rounding: TetGen triangulates each polygon corner by corner, in the order of
//! the loop. A corner in line with an edge that is there already divides it; if instead two of them come before the edge's end,
//! rounding decides which of the edges that they make is outermost, and at times an edge of the loop is not found any more
//! (`sscoutsegment`; of polygons with six corners within an outer edge, every third one). So polygons with two further corners on
//! the line of an outer edge are given to TetGen in their triangles, which it merges again, whatever stands askew. One corner
//! alone does no harm; but among stretched pieces a notch in an edge, which leaves two edges in line, does: these polygons are
//! divided as well, unless the complex was remeshed: there most such corners are the remesher's, off the line by a trace, and
//! triangles of these polygons are needles that gain nothing.
//!
//! What stands free, with no air around it, gets a lone vertex in each such circle besides: see `pins`.
//!
//! ```text
//! rounded: a flat tetrahedron over 4 corners       stretched: the empty circle of 3 corners leaves out the 4th
//! ```

mod pins;

use crate::brep::complex::{Complex, ComplexFacet};
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use crate::geom::embedding::violations;
use crate::geom::polygon::{is_planar, triangulate};
use crate::geom::predicates::{Projection, orient2d, orient3d};
use crate::geom::union_find::UnionFind;
use crate::ids::{FacetId, Id, VertexId};
use crate::round::PLANAR_ULPS;
use std::collections::BTreeSet;

/// How far corners move at most, as a share of the tolerance: what touches within the tolerance is known no better anyway. Far
/// from the origin the share is as much larger as the largest coordinate is larger than the size.
const SHARE: f64 = 0.01;
/// And as a share of the largest coordinate: whoever lets parts touch from afar wants nothing else moved.
const MOST: f64 = 1e-10;
/// Ways, in units in the last place of the largest coordinate, that are too small to tell from rounding.
const LEAST_ULPS: f64 = 16.0;
/// Distance of a corner from the circle of three others, in its radii, below which it is on it: what contact leaves of a
/// circle.
const ROUND: f64 = 1e-9;
/// Distance of a corner from the line of an edge, in sizes, below which it is on it: rounding, and nothing else.
const IN_LINE: f64 = 1e-12;
/// Corners in line with an outer edge, but for rounding, of which TetGen never died where nothing else was askew.
const HARMLESS: usize = 1;
/// Polygons of more triangles are not searched for corners in line: every corner is compared with every edge.
const MANY: usize = 200;
/// Pairs that meet which are looked for at once, and how often, before all pieces are put back: what meets is rare.
const PAIRS: usize = 1000;
const ROUNDS: usize = 4;
/// Stretch along x, y and z. Together they keep volumes. Planes exist in which such a stretch leaves circles round: they hold
/// the x axis, and are inclined to the others by angles that people hardly give (61.7 degrees).
const ALONG: Vec3 = Vec3::new(0.31, -1.0, 0.69);

/// A complex in which what lies askew is in general position, with the same names, numbers and loops; new are only lone
/// vertices, at the end of the vertices and of their facets' loops.
///
/// `tolerance` is the one that decided what touches, in the scene's unit; `is_remeshed` tells whether the remesher saw the
/// complex. Pieces whose polygons would not be planar to rounding, or not simple, stay as they are; so do those that would meet
/// something. Cost: n log n, and next to nothing if nothing is askew.
pub fn position(mut complex: Complex, tolerance: f64, is_remeshed: bool) -> Complex {
    let points: Vec<Vec3> = complex.vertices.iter().map(|v| v.point).collect();
    let reach = points.iter().fold(0.0, |m: f64, p| m.max(p.amax()));
    let size = Aabb::around(&points).diagonal();
    // Far from the origin rounding grows with the coordinates, and with it what tells corners from those of a circle.
    let way = (SHARE * tolerance * (reach / size).max(1.0)).min(MOST * reach);
    let mut pieces = Pieces::of(&complex);
    if way < LEAST_ULPS * f64::EPSILON * reach {
        pieces.is_moved.fill(false);
    }
    pieces.stretch(&mut complex, way);
    // Now: lines that are exact before a stretch are not after it.
    pieces.divide_aligned(&mut complex, size, is_remeshed);
    if !pieces.is_moved.contains(&true) {
        return complex;
    }
    let mut before = Before { points, triangles: Vec::new() };
    let mut unsound = pieces.renew_polygons(&mut complex, &mut before);
    for round in 1.. {
        pieces.put_back(&mut complex, &before, &unsound);
        unsound = pieces.meeting(&complex);
        if unsound.is_empty() {
            break;
        }
        if round == ROUNDS {
            unsound = (0..pieces.is_moved.len()).collect();
        }
    }
    pieces.pin(&mut complex, &before.points);
    complex
}

/// What was there before the stretch.
struct Before {
    /// By vertex.
    points: Vec<Vec3>,
    /// Triangulations of the facets that got new ones.
    triangles: Vec<(FacetId, Vec<[VertexId; 3]>)>,
}

/// What hangs together over vertices.
struct Pieces {
    /// By vertex.
    of: Vec<u32>,
    /// By piece: whether it is stretched, since a polygon of it lies askew.
    is_moved: Vec<bool>,
}

impl Pieces {
    fn of(complex: &Complex) -> Self {
        let mut sets = UnionFind::new(complex.vertices.len());
        for facet in complex.facets.iter() {
            let mut corners = facet.loops.iter().flatten();
            let Some(first) = corners.next() else { continue };
            corners.for_each(|v| sets.join(first.0, v.0));
        }
        let (of, count) = sets.number();
        let mut pieces = Self { of, is_moved: vec![false; count] };
        for facet in complex.facets.iter() {
            let piece = pieces.of_facet(facet);
            pieces.is_moved[piece] = pieces.is_moved[piece] || is_askew(facet, complex);
        }
        pieces
    }

    fn of_facet(&self, facet: &ComplexFacet) -> usize {
        facet.loops.iter().flatten().next().map_or(0, |v| self.of[v.index()] as usize)
    }

    /// Divides polygons in which other corners lie in line with an edge: TetGen 1.5 loses an edge among the flat triangles that
    /// it makes of these, and merges the triangles that it is given. Where one of them is flat, all stays.
    fn divide_aligned(&self, complex: &mut Complex, size: f64, is_remeshed: bool) {
        let points: Vec<Vec3> = complex.vertices.iter().map(|v| v.point).collect();
        let mut facets = Vec::with_capacity(complex.facets.len());
        for facet in std::mem::take(&mut complex.facets) {
            let is_any = self.is_moved[self.of_facet(&facet)] && !is_remeshed;
            let most = if is_any { 0 } else { HARMLESS };
            let is_meant = (3..=MANY).contains(&facet.triangles.len()) && aligned(&facet, !is_any, &points, size) > most;
            if is_meant && !facet.triangles.iter().any(|t| is_flat(t, &points, size)) {
                facets.extend(facet.divided());
            } else {
                facets.push(facet);
            }
        }
        complex.facets = facets.into_iter().collect();
    }

    /// Stretches pieces that lie askew, about their lowest corner: equal coordinates stay equal.
    fn stretch(&self, complex: &mut Complex, way: f64) {
        let mut boxes = vec![Aabb::EMPTY; self.is_moved.len()];
        for (vertex, &piece) in complex.vertices.iter().zip(&self.of) {
            boxes[piece as usize] = boxes[piece as usize].with(&vertex.point);
        }
        for (vertex, &piece) in complex.vertices.iter_mut().zip(&self.of) {
            if self.is_moved[piece as usize] {
                let bounds = boxes[piece as usize];
                vertex.point += (vertex.point - bounds.lo).component_mul(&ALONG) * (way / bounds.diagonal());
            }
        }
    }

    /// Triangulates the polygons of stretched pieces again; pieces with polygons of which none can be made, ascending.
    fn renew_polygons(&self, complex: &mut Complex, before: &mut Before) -> Vec<usize> {
        let points: Vec<Vec3> = complex.vertices.iter().map(|v| v.point).collect();
        let flatness = flatness(&points);
        let mut unsound = BTreeSet::new();
        for (k, facet) in complex.facets.iter_mut().enumerate().filter(|(_, f)| f.triangles.len() > 1) {
            let piece = self.of_facet(facet);
            if !self.is_moved[piece] {
                continue;
            }
            let loops: Vec<Vec<u32>> = facet.loops.iter().map(|walk| walk.iter().map(|v| v.0).collect()).collect();
            let walks: Vec<&[u32]> = loops.iter().map(Vec::as_slice).collect();
            match triangulate(&walks, &[], &[], &points) {
                Ok(triangles) if is_planar(&walks, &points, flatness) => {
                    let triangles = triangles.into_iter().map(|t| t.map(VertexId)).collect();
                    before.triangles.push((FacetId::new(k), std::mem::replace(&mut facet.triangles, triangles)));
                }
                _ => {
                    unsound.insert(piece);
                }
            }
        }
        unsound.into_iter().collect()
    }

    /// Makes some pieces what they were.
    fn put_back(&mut self, complex: &mut Complex, before: &Before, pieces: &[usize]) {
        if pieces.is_empty() {
            return;
        }
        let is_meant = |piece: usize| pieces.binary_search(&piece).is_ok();
        for (vertex, (point, &piece)) in complex.vertices.iter_mut().zip(before.points.iter().zip(&self.of)) {
            if is_meant(piece as usize) {
                vertex.point = *point;
            }
        }
        for (id, triangles) in &before.triangles {
            if is_meant(self.of_facet(&complex.facets[*id])) {
                complex.facets[*id].triangles.clone_from(triangles);
            }
        }
        pieces.iter().for_each(|&piece| self.is_moved[piece] = false);
    }

    /// Stretched pieces that meet something, ascending.
    fn meeting(&self, complex: &Complex) -> Vec<usize> {
        let points: Vec<Vec3> = complex.vertices.iter().map(|v| v.point).collect();
        let triangles = complex.triangles();
        let met = violations(&points, &triangles, PAIRS).into_iter().flat_map(|v| v.triangles);
        let pieces = met.map(|t| self.of[triangles[t as usize][0] as usize] as usize);
        pieces.filter(|&piece| self.is_moved[piece]).collect::<BTreeSet<_>>().into_iter().collect()
    }
}

/// Whether a polygon is not exactly in one plane, has four corners in a row on one circle but for rounding, and no edge along
/// an axis: TetGen copes with all others, and the coordinates of what stands straight are to stay what the user wrote.
fn is_askew(facet: &ComplexFacet, complex: &Complex) -> bool {
    let Some(&[a, b, c]) = facet.triangles.first().filter(|_| facet.triangles.len() > 1) else { return false };
    let point = |v: VertexId| complex.vertices[v].point;
    let is_off = |&v: &VertexId| orient3d(&point(a), &point(b), &point(c), &point(v)) != 0;
    let (mut is_round, mut is_straight) = (false, false);
    for walk in facet.loops.iter().filter(|w| w.len() > 3) {
        for k in 0..walk.len() {
            let row = [0, 1, 2, 3].map(|i| point(walk[(k + i) % walk.len()]));
            is_round |= is_on_circle(&row);
            is_straight |= (row[1] - row[0]).iter().filter(|&&x| x == 0.0).count() >= 2;
        }
    }
    is_round && !is_straight && facet.loops.iter().flatten().any(is_off)
}

/// Whether the last point is on the circle of the first three but for rounding.
fn is_on_circle([a, b, c, d]: &[Vec3; 4]) -> bool {
    Circle::through(&[*a, *b, *c]).holds(d)
}

/// The circle of three points.
struct Circle {
    center: Vec3,
    radius: f64,
}

impl Circle {
    fn through([a, b, c]: &[Vec3; 3]) -> Self {
        let (u, v) = (b - a, c - a);
        let normal = u.cross(&v);
        let to_center =
            (normal.cross(&u) * v.norm_squared() + v.cross(&normal) * u.norm_squared()) / (2.0 * normal.norm_squared());
        Self { center: a + to_center, radius: to_center.norm() }
    }

    /// Whether a point of its plane is on it but for rounding.
    fn holds(&self, p: &Vec3) -> bool {
        ((p - self.center).norm() - self.radius).abs() <= ROUND * self.radius
    }
}

/// How far from its plane a corner of a polygon may be.
fn flatness(points: &[Vec3]) -> f64 {
    PLANAR_ULPS * f64::EPSILON * points.iter().fold(Aabb::around(points).diagonal(), |m, p| m.max(p.amax()))
}

/// How many corners of a polygon lie in line with an edge that they do not end, at most; none if all of them do exactly. With
/// `is_outer` only edges count on one side of whose line all of the polygon is.
fn aligned(facet: &ComplexFacet, is_outer: bool, points: &[Vec3], size: f64) -> usize {
    let sides = [Vec3::x(), Vec3::y(), Vec3::z()].map(|axis| Projection::along(&axis));
    let on_line = |walk: &[VertexId], k: usize| {
        let ends = [walk[k], walk[(k + 1) % walk.len()]];
        let [a, b] = ends.map(|v| points[v.index()]);
        let is_exact = |p: &Vec3| sides.iter().all(|s| orient2d(s.apply(&a), s.apply(&b), s.apply(p)) == 0);
        let along = (b - a).normalize();
        let off = |p: &Vec3| along.cross(&(p - a));
        let others = walk.iter().filter(|v| !ends.contains(v)).map(|v| points[v.index()]);
        let found: Vec<Vec3> = others.filter(|p| off(p).norm() <= IN_LINE * size).collect();
        let is_none = found.iter().all(is_exact)
            || is_outer && {
                let mut ways =
                    facet.loops.iter().flatten().map(|v| off(&points[v.index()])).filter(|w| w.norm() > IN_LINE * size);
                ways.next().is_some_and(|first| ways.any(|w| w.dot(&first) < 0.0))
            };
        if is_none { 0 } else { found.len() }
    };
    let walks = facet.loops.iter().filter(|w| w.len() > 4);
    walks.flat_map(|walk| (0..walk.len()).map(|k| on_line(walk, k))).max().unwrap_or(0)
}

/// Whether a corner of a triangle lies in line with the edge opposite.
fn is_flat(triangle: &[VertexId; 3], points: &[Vec3], size: f64) -> bool {
    let [a, b, c] = triangle.map(|v| points[v.index()]);
    let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
    (b - a).cross(&(c - a)).norm() <= IN_LINE * size * longest
}
