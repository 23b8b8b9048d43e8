//! How long edges should be and how far from the true surface facets may be.

use super::gaps::Gaps;
use super::workpiece::{Place, Workpiece};
use crate::brep::complex::Marker;
use crate::geom::Vec3;
use crate::ids::{FacetId, Id, IdVec, MarkerId, PartId, SurfaceId, VertexId};
use crate::patch::support::{Foot, Support};
use crate::scene::model::Part;
use std::cell::Cell;

/// Wanted edge length as a fraction of the one whose chord has just the allowed deviation. Lengths scatter by a quarter about
/// the wanted one, and few should have to be split for their deviation alone.
const SAFETY: f64 = 0.88;

/// Growth of the wanted length per unit of length: neighbouring triangles differ by about this much.
const GRADATION: f64 = 0.35;

/// Wanted length over the distance to a facet across a thin gap. Measured on the windings of transformer3 (gap 2.5, deviation
/// 1.15): 2 leaves 83400 tetrahedra, 4 68400, 6 63500, because every triangle beside the gap shows on the far side too.
const PER_GAP: f64 = 6.0;

/// Wanted length over the width of a strip between two feature curves: equilateral triangles across it.
pub(super) const PER_STRIP: f64 = 1.2;

/// Least wanted length beside gaps, in strips and beside short chords, as a fraction of the one that the curvature asks for:
/// whoever models a coating does not want a million triangles of it, and the true curves of an almost tangent contact may
/// coincide. The gap of a machine asks for a seventh.
pub(super) const NARROWEST: f64 = 0.1;

/// Smallest wanted length as a fraction of the model's size: keeps apexes finite.
pub(super) const LEAST_SIZE: f64 = 1e-4;

/// Wanted length as a fraction of the model's size from which a place is taken for no apex.
const LARGE_SIZE: f64 = 0.1;

/// The default bound over the mean deviation of a surface's facets as evaluated: their chords touch the surface along rulings,
/// triangles of that size only in corners. At 1.5 triangles are as wide as the strips were; with 1, TetGen needs a third more
/// tetrahedra. With 1.7 it needs a fifth less on union_two_differences in Interfaces (6090 against 7450), but half more on
/// turned sphere grids. (Gmsh and Netgen leave 1.5 to 2.5 times the chord error.)
pub(super) const EASE: f64 = 1.5;

/// The default bound follows the curvature (equation 4.1) within this factor of its mean.
const BOUND_RANGE: f64 = 4.0;

/// Shortest edges over the distance of the points by which a surface is known, where the user or a gap asks for short ones:
/// there is nothing finer to be followed.
const FINEST: f64 = 0.25;

/// A slide by a few hundredths of an edge changes its deviation by this factor at most.
const SLACK: f64 = 1.1;

/// The allowed deviation, by surface: a wire is to stay a wire beside the sphere of air around it.
#[derive(Clone, Debug)]
pub(super) enum Bounds {
    /// Given by the user: the same everywhere.
    Given(f64),
    /// What the facets of each surface keep.
    Present(IdVec<SurfaceId, Bound>),
}

impl Bounds {
    /// That of a surface.
    pub fn of(&self, surface: SurfaceId) -> Bound {
        match self {
            Self::Given(d) => Bound::Fixed(*d),
            Self::Present(bounds) => bounds[surface],
        }
    }

    /// Shortest length that makes sense where a surface is known by points that are so far apart: no less than that, unless the
    /// user wants it finer.
    pub fn finest(&self, spacing: f64) -> f64 {
        match self {
            Self::Given(_) => FINEST * spacing,
            Self::Present(_) => spacing,
        }
    }

    /// How far it may be passed where otherwise facets would be merged: not at all if the user has set it.
    pub fn slack(&self) -> f64 {
        match self {
            Self::Given(_) => 1.0,
            Self::Present(_) => SLACK,
        }
    }
}

/// The allowed deviation on a surface or curve.
#[derive(Clone, Copy, Debug)]
pub(super) enum Bound {
    /// The same everywhere.
    Fixed(f64),
    /// Equation 4.1: `scale / curvature`, within `range`. The thesis fixes the factor for a sphere of radius 100; here the mean
    /// curvature of the surface takes its place, so that the result does not depend on the unit.
    ByCurvature {
        /// Mean deviation times mean curvature of the surface's facets.
        scale: f64,
        /// Least and largest deviation.
        range: [f64; 2],
    },
}

impl Bound {
    /// For the curvature of a curve, or the largest of a surface.
    pub fn along(&self, curvature: f64) -> f64 {
        match *self {
            Self::Fixed(d) => d,
            Self::ByCurvature { scale, range: [low, high] } => (scale / curvature.abs()).clamp(low, high),
        }
    }

    /// The stricter of two, for a curve between surfaces.
    pub fn stricter(self, other: Self) -> Self {
        if self.least() <= other.least() { self } else { other }
    }

    fn least(&self) -> f64 {
        match *self {
            Self::Fixed(d) => d,
            Self::ByCurvature { range, .. } => range[0],
        }
    }

    /// The bound that facets of a surface keep on average, eased.
    pub fn of_facets(support: &Support, facets: impl Iterator<Item = [Vec3; 3]>, size: f64) -> Self {
        let (mut deviation, mut bending, mut weight) = (0.0, 0.0, 0.0);
        for [a, b, c] in facets {
            let area = (b - a).cross(&(c - a)).norm();
            let foot = support.nearest(&((a + b + c) / 3.0));
            let middles = [(a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5];
            // The largest over the facet, not that of the barycentre alone: strips touch their cylinder at both long sides.
            deviation += area * middles.iter().map(|m| support.distance(m)).fold(0.0, f64::max);
            bending += area * foot.curvature;
            weight += area;
        }
        if weight == 0.0 {
            return Self::Fixed(size);
        }
        let mean = (EASE * deviation / weight).max(LEAST_SIZE * LEAST_SIZE * size);
        Self::ByCurvature { scale: mean * bending / weight, range: [mean / BOUND_RANGE, mean * BOUND_RANGE] }
    }
}

/// Edge length of equilateral triangles on a surface whose deviation is `allowed`: over an edge it is l² k1 / 8, at the centre
/// l² (k1 + k2) / 12.
pub(super) fn length_on(foot: &Foot, allowed: f64) -> f64 {
    let [k1, k2] = foot.principal_values();
    let bend = (k1.abs() / 8.0).max((k1 + k2).abs() / 12.0);
    (allowed / bend.max(f64::MIN_POSITIVE)).sqrt()
}

/// Wanted length over the largest edge that a user allows: where triangles are thinned out, edges grow to 1.5 wanted lengths.
/// Few are longer than that, by less than a tenth.
const PER_LARGEST: f64 = 1.0 / 1.5;

/// Wanted edge length of triangles on a surface near a point, for a deviation.
pub(super) fn wanted_for(support: &Support, point: &Vec3, deviation: f64) -> f64 {
    SAFETY * length_on(&support.closest(point), deviation)
}

/// Limits from outside: largest edges of parts and interfaces, and thin gaps.
pub(super) struct Limits<'a> {
    pub gaps: &'a Gaps,
    least: f64,
    /// A length that no apex asks for.
    large: f64,
    /// By marker: the length that its largest edge asks for.
    wanted: IdVec<MarkerId, f64>,
    /// Whether a gap was met that is too narrow for lengths to follow: facets may meet across it.
    pub is_cramped: Cell<bool>,
}

impl<'a> Limits<'a> {
    /// For interfaces of parts in a model of some size.
    pub fn new(gaps: &'a Gaps, size: f64, markers: &IdVec<MarkerId, Marker>, parts: &IdVec<PartId, Part>) -> Self {
        Self {
            gaps,
            least: LEAST_SIZE * size,
            is_cramped: Cell::new(false),
            large: LARGE_SIZE * size,
            wanted: markers.iter().map(|m| wanted_on(m, parts)).collect(),
        }
    }

    /// The wanted length, at most `length` and `wanted`, at a point of some surfaces; gaps do not make it less than `finest`.
    fn limit(&self, point: &Vec3, [length, wanted]: [f64; 2], surfaces: &[SurfaceId], finest: f64) -> f64 {
        let limited = PER_GAP * self.gaps.width(point, length.min(wanted) / PER_GAP, surfaces);
        if limited < finest.min(wanted) {
            self.is_cramped.set(true);
        }
        limited.max(finest.min(wanted)).max(self.least)
    }
}

/// The wanted length on an interface that the parts and the interface itself allow.
pub(super) fn wanted_on(marker: &Marker, parts: &IdVec<PartId, Part>) -> f64 {
    let of_parts = marker.parts.iter().filter_map(|part| parts.get((*part)?)?.max_edge);
    PER_LARGEST * of_parts.chain(marker.max_edge).fold(f64::INFINITY, f64::min)
}

impl Workpiece {
    /// The wanted edge length at a vertex from curvature, parts and gaps, before gradation.
    pub fn own_size(&self, vertex: VertexId, limits: &Limits) -> f64 {
        let point = self.point(vertex);
        let star = self.star(vertex);
        let mut surfaces: Vec<SurfaceId> = star.iter().map(|&f| self.brep.facets[f].surface).collect();
        surfaces.sort_unstable();
        surfaces.dedup();
        let mut size = f64::INFINITY;
        for &id in &surfaces {
            let Some(s) = self.supports[id].as_deref() else { continue };
            let length = self.length_near((s, self.bounds.of(id)), &point, &star, limits);
            size = size.min(self.shares[id.index()].sqrt() * SAFETY * length);
        }
        if let Place::Curve(c) = self.place(vertex)
            && let Some(foot) = self.curves[c].closest(&point)
            && foot.curvature > 0.0
        {
            size = size.min((8.0 * self.curve_bounds[c].along(foot.curvature) / foot.curvature).sqrt());
        }
        let spacing =
            surfaces.iter().filter_map(|&s| self.supports[s].as_deref()).map(|s| s.spacing(&point)).fold(0.0, f64::max);
        let size = size.max(self.bounds.finest(spacing));
        let finest = (FINEST * spacing).max(NARROWEST * size);
        let facets = star.iter().filter_map(|&f| limits.wanted.get(self.brep.facets[f].marker));
        let wanted = facets.copied().fold(f64::INFINITY, f64::min);
        limits.limit(&point, [size.min(self.strip_width(vertex) * PER_STRIP), wanted], &surfaces, finest)
    }

    /// Width of the surface at a vertex of a feature curve: the shortest edge straight across to another curve. Edges around a
    /// common corner do not count, where curves meet at any width.
    fn strip_width(&self, vertex: VertexId) -> f64 {
        let topology = &self.brep.topology;
        if matches!(self.place(vertex), Place::Surface(_)) {
            return f64::INFINITY;
        }
        let along =
            |v: VertexId| topology.edges_at(v).filter(|&e| self.brep.is_feature(e)).map(move |e| topology.other_end(e, v));
        let is_across = |other: VertexId| {
            let place = self.place(other);
            let is_other = matches!(place, Place::Corner) || matches!(place, Place::Curve(_)) && place != self.place(vertex);
            let is_near_corner = along(vertex).any(|n| n == other || along(other).any(|m| m == n));
            is_other && !is_near_corner
        };
        let smooth = topology.edges_at(vertex).filter(|&e| self.is_active(e) && !self.brep.is_feature(e));
        smooth.filter(|&e| is_across(topology.other_end(e, vertex))).map(|e| self.length(e)).fold(f64::INFINITY, f64::min)
    }

    /// Length on a support near a point. At an apex, where the curvature has no bound, the length that is right at its own
    /// distance from there.
    fn length_near(&self, (support, bound): (&Support, Bound), point: &Vec3, star: &[FacetId], limits: &Limits) -> f64 {
        let length_at = |p: &Vec3| {
            let foot = support.closest(p);
            length_on(&foot, bound.along(foot.largest_curvature()))
        };
        let here = length_at(point);
        // No apex.
        if support.is_fitted() || here >= limits.large {
            return here;
        }
        let middle = star.iter().filter_map(|&f| self.corners(f)).flatten().map(|v| self.point(v) - point).sum::<Vec3>();
        let Some(away) = middle.try_normalize(0.0) else { return here };
        // Fixed point of length = length_at(distance length); a square root near an apex, so that few steps do.
        let mut length = length_at(&(point + away * here));
        // Only where the size grows fast, that is at an apex. On a cone the first step tells: the square of a length grows
        // linearly.
        if length < 2.0 * here {
            return here;
        }
        for _ in 1..6 {
            length = length_at(&(point + away * length.max(here)));
        }
        if length > 4.0 * here { length } else { here }
    }

    /// Lets sizes grow no faster than the gradation along edges.
    pub fn grade_sizes(&mut self) {
        let edges: Vec<_> = self.brep.topology.edges().filter(|&e| self.is_active(e)).collect();
        let links: Vec<([VertexId; 2], f64)> =
            edges.iter().map(|&e| (self.brep.topology.ends(e), GRADATION * self.length(e))).collect();
        // Each sweep carries sizes one edge further; beyond a few edges the growth has caught up with any size.
        for _ in 0..8 {
            for &([a, b], step) in &links {
                let (sa, sb) = (self.sizes[a.index()], self.sizes[b.index()]);
                self.sizes[a.index()] = sa.min(sb + step);
                self.sizes[b.index()] = sb.min(sa + step);
            }
        }
    }
}
