//! Polygons that TetGen can take: planar, and without corners that are straight but for rounding, of which TetGen 1.5 dies.
//!
//! A plane or strip beside remeshed facets has such corners on its straight edges. They are moved out of the edge by a trace,
//! within the polygon's plane; where another polygon has them too, the polygon is cut from there across: all pieces lie in one
//! plane, and TetGen merges them.

use super::pieces::{cut_at, edges_of};
use super::workpiece::{Place, Workpiece};
use crate::brep::complex::Complex;
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use crate::geom::polygon::is_planar;
use crate::geom::predicates::{Projection, orient2d};
use crate::ids::{FacetId, Id, IdVec, VertexId};
use crate::patch::curve::Curve;
use crate::round::PLANAR_ULPS;
use std::collections::{BTreeMap, HashSet};

/// Sine of the turn below which a corner counts as straight.
const STRAIGHT_SINE: f64 = 1e-9;

/// How far such corners are moved, as a fraction of the way to the nearer end of their line: far above TetGen's tolerance of
/// 1e-8, far below what any deviation allows. Of 40 askew complexes TetGen 1.5 died on 11 as they are; with 1e-6 on 19.
pub(super) const TRACE: f64 = 1e-5;

impl Workpiece {
    /// Moves nearly straight corners of polygons outwards, if all other facets there are remeshed triangles or lie in the same
    /// plane. From then on they slide along lines of their own.
    pub fn clear_straight_corners(&mut self) {
        let points: Vec<Vec3> = self.brep.vertices.iter().map(|v| v.point).collect();
        let topology = &self.brep.topology;
        let polygons = topology.facets().filter(|&f| self.corners(f).is_none());
        let mut moves: BTreeMap<VertexId, (Vec3, Vec3, FacetId)> = BTreeMap::new();
        for facet in polygons {
            let loops: Vec<Vec<VertexId>> = topology.loops(facet).map(|w| topology.corners(w).collect()).collect();
            let normal = self.normal(facet);
            // Corners that follow each other on one line come to lie on a bow.
            for run in straight_corners(&loops, &points).chunk_by(|p, q| p[1] == q[0]) {
                let (from, to) = (self.point(run[0][0]), self.point(run[run.len() - 1][2]));
                let (length, direction) = ((to - from).norm(), (to - from).normalize());
                let out = direction.cross(&normal);
                for &[_, at, _] in run {
                    let is_free = |f| f == facet || self.is_treated(f) || self.are_in_one_plane(&[facet, f]);
                    if topology.facets_at(at).all(is_free) {
                        let here = self.point(at);
                        let way = TRACE * (here - from).norm() * (to - here).norm() / length;
                        moves.entry(at).or_insert((here + out * way, direction, facet));
                    }
                }
            }
        }
        for (vertex, (origin, direction, facet)) in moves {
            self.relocate(vertex, origin);
            if matches!(self.place(vertex), Place::Curve(_)) {
                self.places[vertex.index()] = Place::Curve(self.add_curve(Curve::Line { origin, direction }, &[facet]));
            }
        }
    }

    /// Whether a move of a vertex makes a corner of a polygon straight that was not.
    pub fn would_straighten(&self, vertex: VertexId, to: &Vec3) -> bool {
        let topology = &self.brep.topology;
        topology.fins_at(vertex).filter(|&fin| self.corners(topology.facet_of(fin)).is_none()).any(|fin| {
            let before = topology.prev_fin(fin);
            let fins =
                [topology.prev_fin(before), before, fin, topology.next_fin(fin), topology.next_fin(topology.next_fin(fin))];
            let now = fins.map(|fin| self.point(topology.fin_ends(fin)[0]));
            let then = [now[0], now[1], *to, now[3], now[4]];
            let corners = |way: [Vec3; 5]| [0, 1, 2].map(|k| is_straight(&[way[k], way[k + 1], way[k + 2]]));
            corners(now).into_iter().zip(corners(then)).any(|(was, is)| is && !was)
        })
    }
}

/// Divides polygons that are no longer planar, strips beside curves that moved to the true surface, into their triangles, which
/// are planar always, and cuts those to which remeshing gave nearly straight corners. Those of the evaluated complex stay: of
/// turned scenes TetGen died as often with them cut.
pub(super) fn cut_unsound(complex: &mut Complex, evaluated: &Complex) {
    let known: HashSet<[u64; 3]> = evaluated.vertices.iter().map(|v| bits(&v.point)).collect();
    let points: Vec<Vec3> = complex.vertices.iter().map(|v| v.point).collect();
    let extent = Aabb::around(&points).diagonal();
    let flatness = PLANAR_ULPS * f64::EPSILON * points.iter().fold(extent, |m, p| m.max(p.amax()));
    let mut facets = Vec::new();
    for facet in std::mem::take(&mut complex.facets) {
        let loops: Vec<Vec<u32>> = facet.loops.iter().map(|l| l.iter().map(|v| v.0).collect()).collect();
        let walks: Vec<&[u32]> = loops.iter().map(|l| &l[..]).collect();
        if facet.triangles.len() == 1 {
            facets.push(facet);
        } else if is_planar(&walks, &points, flatness) {
            let corners: Vec<VertexId> = straight_corners(&facet.loops, &points)
                .into_iter()
                .map(|way| way[1])
                .filter(|v| !known.contains(&bits(&points[v.index()])))
                .collect();
            if corners.is_empty() {
                facets.push(facet);
            } else {
                facets.extend(cut_at(facet, &corners, &points));
            }
        } else {
            facets.extend(facet.divided());
        }
    }
    complex.facets = facets.into_iter().collect::<IdVec<_, _>>();
}

fn bits(p: &Vec3) -> [u64; 3] {
    [p.x, p.y, p.z].map(f64::to_bits)
}

/// Corners of a polygon that are nearly, but not exactly, straight, each between its neighbours; none of an edge that lies
/// inside of it.
fn straight_corners(loops: &[Vec<VertexId>], points: &[Vec3]) -> Vec<[VertexId; 3]> {
    let sides = [Vec3::x(), Vec3::y(), Vec3::z()].map(|axis| Projection::along(&axis));
    let edges: HashSet<[VertexId; 2]> = edges_of(loops).collect();
    let mut found = Vec::new();
    for walk in loops.iter().filter(|w| w.len() > 2) {
        for (k, &at) in walk.iter().enumerate() {
            let n = walk.len();
            let corner = [walk[(k + n - 1) % n], at, walk[(k + 1) % n]];
            let way = corner.map(|v| points[v.index()]);
            let [a, b, c] = &way;
            let turns = |p: &Projection| orient2d(p.apply(a), p.apply(b), p.apply(c)) != 0;
            if is_straight(&way) && sides.iter().any(turns) && !edges.contains(&[at, corner[0]]) {
                found.push(corner);
            }
        }
    }
    found
}

/// Whether a way is straight at its middle point but for rounding.
pub(super) fn is_straight([a, b, c]: &[Vec3; 3]) -> bool {
    let (u, v) = (b - a, c - b);
    u.cross(&v).norm() <= STRAIGHT_SINE * u.norm() * v.norm() && u.dot(&v) > 0.0
}
