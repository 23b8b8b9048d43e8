//! Makes facets of a surface that lie almost in one plane lie in it, or turns them clear of each other.
//!
//! TetGen 1.5 and 1.6 merge neighbouring facets of one marker whose planes differ by less than 0.1 degrees, and the merged
//! facet encloses another volume. That comes about where a vertex of a band lies almost on a ruling: the triangle at the
//! strip's end is almost in the strip's plane. Slid onto the ruling, by a hundredth of the edge length, it is in that plane but
//! for rounding: merging is harmless then, and even wanted, for an edge less is an edge less that TetGen has to keep.
//!
//! Most of all where an obtuse angle faces the edge: its corner lies in the edge's diametral sphere, TetGen splits the edge,
//! and the new vertex encroaches on the edges around. A sphere of acute triangles is meshed without a split; with four obtuse
//! ones 64 edges were split, and 21 tetrahedra stayed above ratio 2.0.

use super::operators::Effect;
use super::quality::{RIGHT, cosine_of_degrees};
use super::ring::Ring;
use super::sizing::Limits;
use super::straight::is_straight;
use super::workpiece::{Measure, Place, Workpiece};
use crate::brep::store::{EdgeId, FinId};
use crate::geom::Vec3;
use crate::ids::{FacetId, Id, SurfaceId, VertexId};
use crate::patch::support::Support;
use crate::round::PLANAR_ULPS;
use std::cmp::Reverse;

/// Sine of the angle between planes below which TetGen might merge facets: 0.12 degrees.
const MERGED_SINE: f64 = 2.1e-3;
/// Sine below which facets are brought into one plane where that costs no shape (12.7 degrees, almost the bend of 24 chords per
/// circle); not on fitted surfaces, where most bends are as weak. The more, the fewer edges TetGen has to keep: with 0.15,
/// transformer3 wholly remeshed needs 2 % more tetrahedra.
const NEAR_SINE: f64 = 0.22;
/// Harm of a bend that TetGen might merge, of any edge that an obtuse angle faces, and of a bend that a wide angle faces, where
/// other bends count 1: an edge that an obtuse angle faces is encroached upon by its corner, and TetGen splits it and some
/// fifteen around.
const MERGED_HARM: usize = 100;
const OBTUSE_HARM: usize = 10;
const WIDE_HARM: usize = 4;
/// Cosine of the angle, 45 degrees, that must face an edge for it to be tried: others are short; to leave them out saves a
/// fifth of the remeshing of transformer3, and needs 1 % more tetrahedra.
const FACED_COSINE: f64 = 0.7;
/// Cosine of the angle from which one is wide, 84 degrees: what is near 90 gets there by the moves of its neighbours.
const WIDE_COSINE: f64 = 0.1045;
/// Facets are in one plane if no corner is farther off than this fraction of the size.
const COPLANAR: f64 = 1e-13;
/// Smallest angle, in degrees, that bringing facets into one plane may leave.
const FLAT_KEEPS: f64 = 40.0;
/// The same where facets must be kept from being merged: by a move that leaves decent shapes if there is one, else by any that
/// leaves none so poor that facets around would be given up for it.
const FORCED_KEEPS: [f64; 3] = [30.0, 10.0, 2.0];
/// Deviation is measured at the points of a triangle whose barycentric coordinates are multiples of one over this: vertices
/// that left their surface for a plane add to the chords' deviation between the points that are looked at elsewhere.
const SAMPLES: u32 = 4;
/// Lengths of slides that are tried, in shortest edges at the vertex, until one helps.
const SLIDES: [f64; 6] = [0.005, 0.01, 0.02, 0.04, 0.08, 0.16];
/// How far a vertex may leave its surface towards another one, as a share of the gap: that one may come as near.
const GAP_SHARE: f64 = 0.25;
/// Newton steps to a plane along a curve; they start at a hundredth of the distance.
const FOOT_STEPS: usize = 4;
/// How often: first all edges are looked at, then those around a move, which may bring another edge into trouble. Each move
/// lessens the harm, so it ends before.
const PASSES: usize = 8;

/// The worth of a move, smallest best: harm done away with, angles.
type Rank = (Reverse<usize>, f64);

/// The bends of a workpiece.
struct Bends<'a> {
    work: &'a mut Workpiece,
    limits: &'a Limits<'a>,
    /// Unit normals of all facets as they are.
    normals: Vec<Vec3>,
    /// Distance off a plane that counts as none.
    flat: f64,
    /// Whether all has to be done that is legal, else only what costs no shape.
    is_forced: bool,
}

/// How the facets at an edge lie to each other.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Bend {
    /// In one plane.
    None,
    /// So nearly in one plane that TetGen might merge them.
    Merged,
    /// Nearly enough to be brought into one plane.
    Near,
    /// With a bend that stays; or they are not two of one surface.
    Full,
}

impl Bend {
    fn is_weak(self) -> bool {
        matches!(self, Self::Merged | Self::Near)
    }
}

/// A vertex elsewhere for once.
struct Shift {
    vertex: VertexId,
    to: Vec3,
    /// What the normals of the facets there would be.
    normals: Vec<(FacetId, Vec3)>,
}

impl Workpiece {
    /// Moves vertices until no two facets that are neighbours at some edges are almost, but not quite, in one plane, as far as
    /// that is legal.
    pub fn clear_bends(&mut self, limits: &Limits, mut edges: Vec<EdgeId>) {
        edges.sort_unstable();
        edges.dedup();
        let flat = COPLANAR * self.extent;
        let topology = &self.brep.topology;
        let mut normals = vec![Vec3::zeros(); topology.bounds()[2]];
        for facet in topology.facets() {
            normals[facet.index()] = self.normal(facet);
        }
        let mut bends = Bends { work: self, limits, normals, flat, is_forced: false };
        bends.clear(1, edges.clone());
        bends.is_forced = true;
        bends.clear(MERGED_HARM, edges);
    }

    /// Makes polygons of neighbouring facets in one plane, but none with a corner that is straight but for rounding: TetGen 1.5
    /// dies of these; it merges the facets itself.
    pub fn merge_flat(&mut self) {
        for edge in self.active_edges() {
            let facets: Vec<FacetId> = self.brep.topology.facets_around(edge).collect();
            if self.are_in_one_plane(&facets)
                && !self.leaves_straight_corner(edge)
                && let Some(merged) = self.brep.merge_facets(edge)
            {
                self.is_treated[merged.index()] = false;
            }
        }
    }

    /// Whether all corners of some facets lie in one plane but for rounding, half of what `gsm check` allows: it fits its plane
    /// by least squares, from which one of them may be twice as far.
    pub fn are_in_one_plane(&self, facets: &[FacetId]) -> bool {
        let normal = facets.iter().map(|&f| self.area(f)).sum::<Vec3>().normalize();
        let fins = facets.iter().flat_map(|&f| self.brep.topology.fins_of_facet(f));
        let heights = fins.flat_map(|fin| self.brep.topology.fin_ends(fin)).map(|v| normal.dot(&self.point(v)));
        let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        high - low <= PLANAR_ULPS * f64::EPSILON * self.extent
    }

    /// Whether one of the facets at an edge goes straight on into the other at an end of the edge.
    fn leaves_straight_corner(&self, edge: EdgeId) -> bool {
        let topology = &self.brep.topology;
        let fins: Vec<FinId> = topology.fins_around(edge).collect();
        let goes_on = |f: FinId, g: FinId| {
            let ([from, at], [_, to]) = (topology.fin_ends(topology.prev_fin(f)), topology.fin_ends(topology.next_fin(g)));
            is_straight(&[from, at, to].map(|v| self.point(v)))
        };
        matches!(fins[..], [f, g] if goes_on(f, g) || goes_on(g, f))
    }

    /// Cosine of the widest angle of a triangle at an edge that is opposite to it.
    fn widest_opposite(&self, edge: EdgeId) -> f64 {
        let [a, b] = self.brep.topology.ends(edge).map(|v| self.point(v));
        let apexes = self.apexes(edge).map(|v| self.point(v));
        apexes.map(|p| (a - p).dot(&(b - p)) / ((a - p).norm() * (b - p).norm())).fold(1.0, f64::min)
    }

    /// The corners of the triangles at an edge that are opposite to it.
    fn apexes(&self, edge: EdgeId) -> impl Iterator<Item = VertexId> + '_ {
        let topology = &self.brep.topology;
        let fins = topology.fins_around(edge).filter(|&fin| topology.triangle(topology.facet_of(fin)).is_some());
        fins.map(|fin| topology.fin_ends(topology.prev_fin(fin))[0])
    }

    /// The edges of the treated facets at a vertex.
    pub fn edges_of_star(&self, vertex: VertexId) -> Vec<EdgeId> {
        let mut edges = self.edges_of(&self.star(vertex));
        edges.sort_unstable();
        edges.dedup();
        edges
    }

    fn area(&self, facet: FacetId) -> Vec3 {
        if let Some([a, b, c]) = self.corners(facet).map(|t| self.points(t)) {
            return (b - a).cross(&(c - a));
        }
        let corners = self.brep.triangles(facet).map(|t| t.map(|v| self.point(v)));
        corners.map(|[a, b, c]| (b - a).cross(&(c - a))).sum()
    }

    /// Unit normal of a facet.
    pub fn normal(&self, facet: FacetId) -> Vec3 {
        self.area(facet).try_normalize(0.0).unwrap_or_else(Vec3::zeros)
    }

    /// Multiple of the bound within which triangles stay that were like this.
    fn allowed(&self, before: Measure) -> f64 {
        before.excess.max(1.0) * self.bounds.slack()
    }

    /// How far a point of a facet deviates, in bounds.
    fn excess_at(&self, support: &Support, facet: FacetId, point: &Vec3) -> f64 {
        let foot = support.nearest(point);
        (foot.point - point).norm() / (self.bound_on(facet).along(foot.curvature) * self.share(facet))
    }

    fn foot_in_plane(&self, vertex: VertexId, origin: &Vec3, normal: &Vec3) -> Option<Vec3> {
        let height = |p: &Vec3| normal.dot(&(p - origin));
        let mut at = self.point(vertex);
        match self.place(vertex) {
            Place::Corner => return None,
            Place::Surface(_) => at -= normal * height(&at),
            Place::Curve(curve) => {
                for _ in 0..FOOT_STEPS {
                    let tangent = self.curves[curve].closest(&at)?.tangent;
                    at = self.home(vertex, &(at - tangent * (height(&at) / tangent.dot(normal))));
                }
            }
        }
        at.iter().all(|x| x.is_finite()).then_some(at)
    }

    /// Places near a vertex on its curve or surface, `step` times its shortest edge away.
    fn slides(&self, vertex: VertexId, step: f64) -> Vec<Vec3> {
        let here = self.point(vertex);
        let Some(directions) = self.directions(self.place(vertex), &here) else { return Vec::new() };
        let shortest = self.brep.topology.neighbours(vertex).map(|n| (self.point(n) - here).norm());
        let shortest = shortest.fold(f64::INFINITY, f64::min);
        directions.iter().map(|d| self.home(vertex, &(here + d * (step * shortest)))).collect()
    }
}

impl Bends<'_> {
    /// Mends bends of at least some harm at some edges, those that the widest angles face first.
    fn clear(&mut self, least: usize, mut edges: Vec<EdgeId>) {
        for _ in 0..PASSES {
            edges.retain(|&e| self.bend(e, None).is_weak() && self.harm(e, None) >= least);
            let mut order: Vec<(f64, EdgeId)> = edges.into_iter().map(|e| (self.work.widest_opposite(e), e)).collect();
            order.retain(|o| self.is_forced || o.0 < FACED_COSINE);
            order.sort_by(|p, q| p.0.total_cmp(&q.0).then(p.1.cmp(&q.1)));
            let moved: Vec<VertexId> = order.into_iter().filter_map(|(_, e)| self.clear_bend(e)).collect();
            edges = moved.into_iter().flat_map(|v| self.work.edges_of_star(v)).collect();
            edges.sort_unstable();
            edges.dedup();
        }
    }

    /// How bad an edge is for TetGen: for its bend, and for the angles that face it.
    fn harm(&self, edge: EdgeId, shift: Option<&Shift>) -> usize {
        match self.bend(edge, shift) {
            Bend::None => 0,
            Bend::Merged => MERGED_HARM,
            // Right angles count: on which side of 90 degrees they are is a matter of rounding.
            _ if self.is_faced(edge, -RIGHT, shift) => OBTUSE_HARM,
            Bend::Near if self.is_faced(edge, WIDE_COSINE, shift) => WIDE_HARM,
            Bend::Near => 1,
            Bend::Full => 0,
        }
    }

    fn bend(&self, edge: EdgeId, shift: Option<&Shift>) -> Bend {
        let topology = &self.work.brep.topology;
        let mut facets = topology.facets_around(edge);
        let (Some(f), Some(g), None) = (facets.next(), facets.next(), facets.next()) else { return Bend::Full };
        let (m, n) = (self.normal(f, shift), self.normal(g, shift));
        let square = m.cross(&n).norm_squared();
        if square > NEAR_SINE * NEAR_SINE || self.work.brep.facets[f].marker != self.work.brep.facets[g].marker {
            return Bend::Full;
        }
        if square > MERGED_SINE * MERGED_SINE {
            let is_rough = self.work.support(f).is_some_and(Support::is_fitted);
            return if is_rough { Bend::Full } else { Bend::Near };
        }
        let start = self.point(topology.ends(edge)[0], shift);
        let is_off = |facet: FacetId, normal: &Vec3| {
            let mut corners = topology.fins_of_facet(facet).map(|fin| topology.fin_ends(fin)[0]);
            corners.any(|v| normal.dot(&(self.point(v, shift) - start)).abs() > self.flat)
        };
        if is_off(f, &n) || is_off(g, &m) { Bend::Merged } else { Bend::None }
    }

    /// Whether an angle wider than that of a cosine faces an edge.
    fn is_faced(&self, edge: EdgeId, cosine: f64, shift: Option<&Shift>) -> bool {
        let [a, b] = self.work.brep.topology.ends(edge).map(|v| self.point(v, shift));
        self.work.apexes(edge).any(|apex| {
            let apex = self.point(apex, shift);
            let (u, v) = (a - apex, b - apex);
            let along = u.dot(&v);
            along * along.abs() < cosine * cosine.abs() * u.norm_squared() * v.norm_squared()
        })
    }

    fn point(&self, vertex: VertexId, shift: Option<&Shift>) -> Vec3 {
        shift.filter(|t| t.vertex == vertex).map_or_else(|| self.work.point(vertex), |t| t.to)
    }

    fn normal(&self, facet: FacetId, shift: Option<&Shift>) -> Vec3 {
        let tried = shift.and_then(|t| t.normals.iter().find(|n| n.0 == facet));
        tried.map_or(self.normals[facet.index()], |n| n.1)
    }

    /// A vertex at another place. The planes of polygons stay.
    fn shift(&self, vertex: VertexId, to: Vec3) -> Shift {
        let triangles = self.work.brep.topology.facets_at(vertex).filter_map(|f| Some((f, self.work.corners(f)?)));
        let normals = triangles.map(|(facet, corners)| {
            let [a, b, c] = corners.map(|v| if v == vertex { to } else { self.work.point(v) });
            (facet, (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_else(Vec3::zeros))
        });
        Shift { vertex, to, normals: normals.collect() }
    }

    /// Makes the best move of a vertex of the facets at a bend that is too weak, and says of which.
    fn clear_bend(&mut self, edge: EdgeId) -> Option<VertexId> {
        if self.harm(edge, None) == 0 {
            return None;
        }
        let facets = self.work.brep.topology.facets_around(edge);
        let mut vertices: Vec<VertexId> = facets.filter_map(|f| self.work.corners(f)).flatten().collect();
        vertices.sort_unstable();
        vertices.dedup();
        let keeps: &[f64] = if self.is_forced { &FORCED_KEEPS } else { &[FLAT_KEEPS] };
        let mut best = None;
        for &keeps in keeps {
            best = best.or_else(|| self.best_move(edge, &vertices, keeps, |v| self.feet(v, edge)));
            for step in SLIDES.iter().filter(|_| self.is_forced) {
                best = best.or_else(|| self.best_move(edge, &vertices, keeps, |v| self.work.slides(v, *step)));
            }
        }
        let shift = best?;
        self.work.relocate(shift.vertex, shift.to);
        for (facet, normal) in shift.normals {
            self.normals[facet.index()] = normal;
        }
        Some(shift.vertex)
    }

    /// The best of the places that some vertices may go to, and by which the bend at an edge does less harm.
    fn best_move(
        &self,
        edge: EdgeId,
        vertices: &[VertexId],
        keeps: f64,
        places: impl Fn(VertexId) -> Vec<Vec3>,
    ) -> Option<Shift> {
        let mut best: Option<(Rank, Shift)> = None;
        let here = self.harm(edge, None);
        for &vertex in vertices {
            let mut places = places(vertex);
            self.keep_within_bound(vertex, &mut places);
            // Else two triangles at the edge of a polygon could come into one plane, and into a line there.
            places.retain(|to| !self.work.would_straighten(vertex, to));
            let shifts = places.into_iter().map(|to| self.shift(vertex, to));
            let shifts: Vec<Shift> = shifts.filter(|t| self.harm(edge, Some(t)) < here).collect();
            if shifts.is_empty() {
                continue;
            }
            // What a place mends first: it costs a fraction of a look at the supports.
            let edges = self.work.edges_of_star(vertex);
            let harm = |shift: Option<&Shift>| -> usize { edges.iter().map(|&e| self.harm(e, shift)).sum() };
            let before = harm(None);
            let mended = shifts.into_iter().map(|t| (before.saturating_sub(harm(Some(&t))), t));
            let mut shifts: Vec<(usize, Shift)> = mended.filter(|p| p.0 > 0).collect();
            self.keep_clear(vertex, &mut shifts);
            if shifts.is_empty() {
                continue;
            }
            let ring = self.work.ring(vertex);
            for (mended, shift) in shifts {
                if best.as_ref().is_some_and(|((most, _), _)| Reverse(mended) > *most) {
                    continue;
                }
                let Some(after) = self.bent(&ring, &shift, keeps) else { continue };
                let rank = (Reverse(mended), after.cosine);
                if best.as_ref().is_none_or(|b| rank < b.0) {
                    best = Some((rank, shift));
                }
            }
        }
        best.map(|b| b.1)
    }

    /// What the triangles around a vertex become after a shift; `None` if that is not allowed, or if an angle gets smaller than
    /// it was and than `keeps` degrees.
    fn bent(&self, ring: &Ring, shift: &Shift, keeps: f64) -> Option<Measure> {
        let before = ring.before;
        let floor = before.cosine.max(cosine_of_degrees(keeps));
        let allowed = self.work.allowed(before);
        let Effect { after, .. } = ring.plan(&shift.to, floor, allowed)?;
        let is_near = ring.facets().all(|f| self.is_sampled_within(f, shift, before.excess, allowed));
        (is_near && !after.is_flipped).then_some(after)
    }

    /// Whether a triangle deviates by at most `allowed` times the bound at a grid of points after a shift, and keeps clear of
    /// what is across a gap where that is more than `before` times.
    fn is_sampled_within(&self, facet: FacetId, shift: &Shift, before: f64, allowed: f64) -> bool {
        let (Some(corners), Some(support)) = (self.work.corners(facet), self.work.support(facet)) else { return true };
        let [a, b, c] = corners.map(|v| self.point(v, Some(shift)));
        let grid =
            (0..=SAMPLES).flat_map(|i| (0..=SAMPLES - i).map(move |j| [i, j].map(|k| f64::from(k) / f64::from(SAMPLES))));
        let mut points = grid.map(|[s, t]| a * s + b * t + c * (1.0 - s - t));
        points.all(|p| {
            let excess = self.work.excess_at(support, facet, &p);
            excess <= allowed && (excess <= before || self.is_clear(&p, self.work.brep.facets[facet].surface, support))
        })
    }

    /// Whether a point that left its surface is far enough from what is across a gap.
    fn is_clear(&self, point: &Vec3, surface: SurfaceId, support: &Support) -> bool {
        self.limits.gaps.is_clear(point, support.distance(point) / GAP_SHARE, surface, &self.work.supports)
    }

    /// Drops the places where a vertex deviates by more than its triangles may: most of those in the plane of a facet beside,
    /// and one look at the surface is less than what the bends around ask for.
    fn keep_within_bound(&self, vertex: VertexId, places: &mut Vec<Vec3>) {
        let Place::Surface(surface) = self.work.place(vertex) else { return };
        let Some(support) = self.work.supports[surface].as_deref().filter(|_| !places.is_empty()) else { return };
        let star = self.work.star(vertex);
        let Some(&facet) = star.first() else { return };
        let allowed = self.work.allowed(self.work.worst(&star));
        places.retain(|to| self.work.excess_at(support, facet, to) <= allowed);
    }

    /// Drops the places where a vertex does not keep clear of what is across a gap.
    fn keep_clear(&self, vertex: VertexId, shifts: &mut Vec<(usize, Shift)>) {
        let Place::Surface(surface) = self.work.place(vertex) else { return };
        let Some(support) = self.work.supports[surface].as_deref() else { return };
        shifts.retain(|(_, shift)| self.is_clear(&shift.to, surface, support));
    }

    /// Places of a vertex in the planes of those facets at an edge that it is not a corner of: the feet, or, on a curve, where
    /// the curve passes through.
    fn feet(&self, vertex: VertexId, edge: EdgeId) -> Vec<Vec3> {
        let [start, end] = self.work.brep.topology.ends(edge);
        if vertex == start || vertex == end {
            return Vec::new();
        }
        let facets = self.work.brep.topology.facets_around(edge);
        let others = facets.filter(|&f| self.work.corners(f).is_none_or(|t| !t.contains(&vertex)));
        let origin = self.work.point(start);
        others.filter_map(|f| self.work.foot_in_plane(vertex, &origin, &self.normals[f.index()])).collect()
    }
}
