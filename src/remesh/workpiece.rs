//! The kernel model under work, with what the operators need to know about it: supports, places, sizes.

use super::bands::Choice;
use super::history::History;
use super::quality::{is_needle, sharpest_cosine};
use super::sizing::{Bound, Bounds};
use crate::brep::model::Brep;
use crate::brep::store::EdgeId;
use crate::declare_ids;
use crate::geom::Vec3;
use crate::ids::{FacetId, Id, IdVec, SurfaceId, VertexId};
use crate::patch::curve::Curve;
use crate::patch::support::Support;
use std::cell::Cell;
use std::collections::HashMap;
use std::sync::Arc;

declare_ids! {
    /// A feature curve: a chain of feature edges between corners.
    CurveId;
}

/// Where a vertex may move: the degree of freedom of thesis 4.3, derived from the edges at it.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Place {
    /// Not at all: a corner of the model, an apex, or a vertex of a curved facet that stays as it is (degree 0).
    Corner,
    /// Along a feature curve (degree 1 and intersection).
    Curve(CurveId),
    /// On its surface (degree 2).
    Surface(SurfaceId),
}

/// Cosine of the angle between a triangle and its support past which it counts as flipped (75 degrees: coarse facets of
/// small circles tilt a lot).
const FLIPPED_COSINE: f64 = 0.26;

/// Sine of the smallest angle below which a triangle is a needle: it has no side that faces anywhere, and folds over if its
/// vertices move by rounding (0.006 degrees; what features need is made by the evaluator, and stays).
pub(super) const NEEDLE_SINE: f64 = 1e-4;

/// What a triangle is like, or would be.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Measure {
    /// Cosine of the smallest angle.
    pub cosine: f64,
    /// Largest distance from the support as a fraction of the allowed deviation.
    pub excess: f64,
    /// Whether it faces the wrong way, or is a needle that faces none.
    pub is_flipped: bool,
}

impl Measure {
    /// Better than any triangle: the start of a fold with `worse_of`.
    pub const BEST: Self = Self { cosine: 0.5, excess: 0.0, is_flipped: false };
    /// The worse of two in each respect.
    pub fn worse_of(self, other: Self) -> Self {
        Self {
            cosine: self.cosine.max(other.cosine),
            excess: self.excess.max(other.excess),
            is_flipped: self.is_flipped || other.is_flipped,
        }
    }
}

/// What measuring a triangle needs of its surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Area<'a> {
    support: &'a Support,
    /// +1 if the triangle's normal has the sense of its support's, else -1.
    sense: f64,
    bound: Bound,
    /// Share of the bound that it may use.
    share: f64,
}

impl Area<'_> {
    /// The largest distance of a triangle's centre and of some other points from the support, as a fraction of what is allowed,
    /// and whether the triangle faces the wrong way. Middles of edges and the circumcentre are where a sphere and a cylinder are
    /// farthest off.
    pub fn deviation(&self, [a, b, c]: &[Vec3; 3], points: &[Vec3]) -> (f64, bool) {
        let normal = (b - a).cross(&(c - a)) * self.sense;
        let center = inner_center([a, b, c]);
        let foot = self.support.nearest(&center);
        let is_flipped = is_needle([a, b, c], NEEDLE_SINE) || normal.dot(&foot.normal) <= FLIPPED_COSINE * normal.norm();
        let allowed = self.bound.along(foot.curvature) * self.share;
        let deviation = points.iter().map(|p| self.support.distance(p)).fold((foot.point - center).norm(), f64::max);
        (deviation / allowed, is_flipped)
    }
}

/// The circumcentre of a triangle if it is acute, else the barycentre.
fn inner_center([a, b, c]: [&Vec3; 3]) -> Vec3 {
    // Squares of the edges opposite to the corners.
    let [p, q, r] = [c - b, a - c, b - a].map(|e| e.norm_squared());
    let shares = [p * (q + r - p), q * (r + p - q), r * (p + q - r)];
    if shares.iter().any(|&s| s <= 0.0) {
        return (a + b + c) / 3.0;
    }
    (a * shares[0] + b * shares[1] + c * shares[2]) / shares.iter().sum::<f64>()
}

/// The model under work.
#[derive(Clone)]
pub(super) struct Workpiece {
    pub brep: Brep,
    pub supports: IdVec<SurfaceId, Option<Arc<Support>>>,
    pub curves: IdVec<CurveId, Curve>,
    /// Curves of feature edges between two corners; only looked up.
    pub lone_edges: HashMap<[VertexId; 2], CurveId>,
    /// By facet: whether it is a triangle to be remeshed.
    pub is_treated: Vec<bool>,
    /// By facet: +1 if the facet's normal has the sense of its support's, else -1.
    pub sense: Vec<f64>,
    /// By vertex.
    pub places: Vec<Place>,
    /// By vertex: wanted edge length.
    pub sizes: Vec<f64>,
    pub bounds: Bounds,
    /// Of feature curves: the strictest of the surfaces around.
    pub curve_bounds: IdVec<CurveId, Bound>,
    /// Size of the model, or its distance from the origin if that is larger.
    pub extent: f64,
    /// How much obtuse triangles count as sharp ones.
    pub obtuse: f64,
    /// Cosine of the angle below which one is a flaw in trials.
    pub small: f64,
    /// By facet: its measure if it has been taken since the facet last changed.
    pub measures: Vec<Cell<Option<Measure>>>,
    /// By surface: share of the bound that it may use; less where facets came too near to others.
    pub shares: Vec<f64>,
    pub choice: Choice,
    /// What changed when.
    pub history: History,
}

impl Workpiece {
    #[inline]
    pub fn point(&self, vertex: VertexId) -> Vec3 {
        self.brep.vertices[vertex].point
    }

    pub fn points(&self, [a, b, c]: [VertexId; 3]) -> [Vec3; 3] {
        [self.point(a), self.point(b), self.point(c)]
    }

    pub fn place(&self, vertex: VertexId) -> Place {
        self.places[vertex.index()]
    }

    #[inline]
    pub fn is_treated(&self, facet: FacetId) -> bool {
        self.is_treated.get(facet.index()).copied().unwrap_or(false)
    }

    /// Whether a facet stays a strip of a curved surface.
    pub fn is_strip(&self, facet: FacetId) -> bool {
        !self.is_treated(facet) && self.support(facet).is_some()
    }

    /// The support of the surface of a facet.
    pub fn support(&self, facet: FacetId) -> Option<&Support> {
        self.supports[self.brep.facets[facet].surface].as_deref()
    }

    pub fn length(&self, edge: EdgeId) -> f64 {
        let [a, b] = self.brep.topology.ends(edge);
        (self.point(a) - self.point(b)).norm()
    }

    /// Length of an edge in units of the wanted length at its ends.
    pub fn relative_length(&self, edge: EdgeId) -> f64 {
        let [a, b] = self.brep.topology.ends(edge);
        (self.point(a) - self.point(b)).norm() * 2.0 / (self.sizes[a.index()] + self.sizes[b.index()])
    }

    /// Whether any facet at the edge is remeshed.
    pub fn is_active(&self, edge: EdgeId) -> bool {
        self.brep.topology.facets_around(edge).any(|f| self.is_treated(f))
    }

    /// The feature curve of an edge with a treated facet; `None` for an edge inside a surface.
    pub fn curve_of(&self, edge: EdgeId) -> Option<CurveId> {
        if !self.brep.is_feature(edge) {
            return None;
        }
        let ends = self.brep.topology.ends(edge);
        for end in ends {
            if let Place::Curve(c) = self.place(end) {
                return Some(c);
            }
        }
        self.lone_edges.get(&sorted(ends)).copied()
    }

    /// What measuring a facet needs of its surface; `None` without a support.
    pub fn area_of(&self, facet: FacetId) -> Option<Area<'_>> {
        Some(Area {
            support: self.support(facet)?,
            sense: self.sense[facet.index()],
            bound: self.bound_on(facet),
            share: self.share(facet),
        })
    }

    /// Measures the triangle of a facet with other corner positions.
    pub fn measure(&self, facet: FacetId, corners: &[Vec3; 3]) -> Measure {
        let [a, b, c] = corners;
        let cosine = sharpest_cosine([a, b, c], self.obtuse);
        let Some(area) = self.area_of(facet) else { return Measure { cosine, ..Measure::BEST } };
        let (excess, is_flipped) = area.deviation(corners, &[(a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5]);
        Measure { cosine, excess, is_flipped }
    }

    /// Measures a treated facet as it is.
    pub fn measure_facet(&self, facet: FacetId) -> Measure {
        let known = self.measures.get(facet.index());
        if let Some(measure) = known.and_then(Cell::get) {
            return measure;
        }
        let measure = self.corners(facet).map_or(Measure::BEST, |t| self.measure(facet, &self.points(t)));
        if let Some(slot) = known {
            slot.set(Some(measure));
        }
        measure
    }

    /// Shape of a treated facet: the cosine of its measure, without a look at its support.
    pub fn sharpest(&self, facet: FacetId) -> f64 {
        if let Some(known) = self.measures.get(facet.index()).and_then(Cell::get) {
            return known.cosine;
        }
        let Some(corners) = self.corners(facet) else { return Measure::BEST.cosine };
        let [a, b, c] = self.points(corners);
        sharpest_cosine([&a, &b, &c], self.obtuse)
    }

    /// The worst shape of the treated facets at a vertex.
    pub fn sharpest_at(&self, vertex: VertexId) -> f64 {
        let star = self.brep.topology.facets_at(vertex).filter(|&f| self.is_treated(f));
        star.map(|f| self.sharpest(f)).fold(Measure::BEST.cosine, f64::max)
    }

    /// Whether a triangle's normal has the sense of its support's; `None` if it is too steep to tell.
    pub fn visible_sense(&self, facet: FacetId) -> Option<f64> {
        let [a, b, c] = self.points(self.corners(facet)?);
        let normal = (b - a).cross(&(c - a));
        let cosine = normal.dot(&self.support(facet)?.nearest(&((a + b + c) / 3.0)).normal);
        (cosine.abs() > FLIPPED_COSINE * normal.norm()).then_some(cosine.signum())
    }

    /// Corners of a triangular facet.
    pub fn corners(&self, facet: FacetId) -> Option<[VertexId; 3]> {
        self.brep.topology.triangle(facet)
    }

    /// The treated facets at a vertex.
    pub fn star(&self, vertex: VertexId) -> Vec<FacetId> {
        self.brep.topology.facets_at(vertex).filter(|&f| self.is_treated(f)).collect()
    }

    /// The worst in each respect of some treated facets.
    pub fn worst(&self, facets: &[FacetId]) -> Measure {
        facets.iter().map(|&f| self.measure_facet(f)).fold(Measure::BEST, Measure::worse_of)
    }

    /// The distance of the middle of an edge from its curve, as a fraction of what is allowed; 0 inside a surface.
    pub fn curve_excess(&self, curve: CurveId, a: &Vec3, b: &Vec3) -> f64 {
        let middle = (a + b) * 0.5;
        self.curves[curve].gap(&middle).map_or(0.0, |(gap, curvature)| gap / self.curve_bounds[curve].along(curvature))
    }

    /// Where a vertex belongs: on its curve or surface; where it is if it is a corner.
    pub fn home(&self, vertex: VertexId, point: &Vec3) -> Vec3 {
        match self.place(vertex) {
            Place::Corner => self.point(vertex),
            place => self.home_of(place, point),
        }
    }

    /// The nearest point of a curve or surface.
    pub fn home_of(&self, place: Place, point: &Vec3) -> Vec3 {
        match place {
            Place::Corner => *point,
            Place::Curve(c) => self.curves[c].nearest(point).unwrap_or(*point),
            Place::Surface(s) => self.supports[s].as_ref().map_or(*point, |s| s.nearest(point).point),
        }
    }

    /// The bound on the surface of a facet.
    pub fn bound_on(&self, facet: FacetId) -> Bound {
        self.bounds.of(self.brep.facets[facet].surface)
    }

    /// Share of the bound that the surface of a facet may use.
    pub fn share(&self, facet: FacetId) -> f64 {
        self.shares[self.brep.facets[facet].surface.index()]
    }

    /// Notes that facets have changed.
    pub fn mark(&mut self, facets: &[FacetId]) {
        for &facet in facets {
            if let Some(slot) = self.measures.get(facet.index()) {
                slot.set(None);
            }
        }
        let topology = &self.brep.topology;
        self.history.change(facets.iter().filter_map(|&f| topology.triangle(f)).flatten());
    }

    /// After an operation: makes room for new ids and marks the new triangles.
    pub fn register(&mut self, facets: &[FacetId], sense: f64) {
        let bound = self.brep.topology.bounds()[2];
        if self.is_treated.len() < bound {
            self.is_treated.resize(bound, false);
            self.sense.resize(bound, 1.0);
            self.measures.resize(bound, Cell::new(None));
        }
        for &facet in facets {
            self.is_treated[facet.index()] = true;
            self.sense[facet.index()] = sense;
            self.measures[facet.index()].set(None);
        }
    }
}

/// Both orders of a pair as one key.
pub(super) fn sorted([a, b]: [VertexId; 2]) -> [VertexId; 2] {
    if a <= b { [a, b] } else { [b, a] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sphere_is_farthest_off_at_the_circumcentre() {
        // Corners of a circle of radius 0.6, 0.8 from the sphere's centre: angles of 40, 60 and 80 degrees.
        let corner =
            |degrees: f64| Vec3::new(0.6 * libm::cos(degrees.to_radians()), 0.6 * libm::sin(degrees.to_radians()), 0.8);
        let acute = [0.0, 80.0, 200.0].map(corner);
        let center = inner_center([&acute[0], &acute[1], &acute[2]]);
        assert!((center - Vec3::new(0.0, 0.0, 0.8)).norm() < 1e-15 && (1.0 - center.norm() - 0.2).abs() < 1e-15);
        let [a, b, c] = [0.0, 80.0, 100.0].map(corner);
        assert_eq!(inner_center([&a, &b, &c]), (a + b + c) / 3.0, "obtuse: the middle of its longest edge is farther off");
    }
}
