//! What is known of the strips of ruled surfaces: their rulings, and which of their corners lie off the true surface.

use super::Supports;
use super::pieces::edges_of;
use super::workpiece::sorted;
use crate::brep::complex::{Complex, ComplexFacet};
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use crate::ids::{FacetId, Id, SurfaceId, VertexId};
use crate::patch::support::Support;

/// Distance from the true surface, as a fraction of the model's size, past which a corner is off it: contact moves corners by
/// less.
const OFF: f64 = 1e-7;

pub(super) type Edge = [VertexId; 2];

/// Facets that an intersection cut, and triangles that share a corner with one.
fn modified_or_beside(complex: &Complex) -> Vec<bool> {
    let mut is_near = vec![false; complex.vertices.len()];
    for v in complex.facets.iter().filter(|f| f.is_modified).flat_map(|f| f.loops.iter().flatten()) {
        is_near[v.index()] = true;
    }
    let is_beside = |f: &ComplexFacet| f.triangles.len() == 1 && f.loops[0].iter().any(|v| is_near[v.index()]);
    complex.facets.iter().map(|f| f.is_modified || is_beside(f)).collect()
}

/// The strips of ruled surfaces in a complex.
pub(super) struct Strips<'a> {
    pub complex: &'a Complex,
    pub supports: &'a Supports,
    /// Every edge with its facets, sorted.
    facets_of_edge: Vec<(Edge, FacetId)>,
    /// What counts as no distance.
    pub reach: f64,
    /// By facet: whether an intersection cut it or a triangle beside it.
    pub is_modified: Vec<bool>,
}

impl<'a> Strips<'a> {
    pub fn of(complex: &'a Complex, supports: &'a Supports) -> Self {
        let mut facets_of_edge: Vec<(Edge, FacetId)> = Vec::new();
        for (id, facet) in complex.facets.enumerate() {
            facets_of_edge.extend(edges_of(&facet.loops).map(|e| (sorted(e), id)));
        }
        facets_of_edge.sort_unstable();
        let reach = OFF * Aabb::around(complex.vertices.iter().map(|v| &v.point)).diagonal();
        Self { complex, supports, facets_of_edge, reach, is_modified: modified_or_beside(complex) }
    }

    pub fn around(&self, edge: Edge) -> impl Iterator<Item = FacetId> + '_ {
        let first = self.facets_of_edge.partition_point(|e| e.0 < edge);
        self.facets_of_edge[first..].iter().take_while(move |e| e.0 == edge).map(|e| e.1)
    }

    pub fn point(&self, vertex: VertexId) -> Vec3 {
        self.complex.vertices[vertex].point
    }

    /// The support of a facet; fitted ones only where they are needed, for there is one patch to be fitted for every facet.
    pub fn support(&self, facet: FacetId) -> Option<&'a Support> {
        let support = self.supports[self.complex.facets[facet].surface].as_deref()?;
        (!support.is_fitted() || self.is_modified[facet.index()]).then_some(support)
    }

    /// Whether [`Self::support`] leaves out the support of a facet.
    fn is_hidden(&self, facet: FacetId) -> bool {
        self.supports[self.complex.facets[facet].surface].is_some() && self.support(facet).is_none()
    }

    /// Whether a facet is remeshed in bands: it lies between rulings, or beside one where the surface is known.
    pub fn is_strip(&self, facet: FacetId) -> bool {
        let least = if self.support(facet).is_some_and(Support::is_fitted) { 2 } else { 1 };
        self.is_ruled(facet) && self.rulings(facet).len() >= least
    }

    /// Whether the surface of a facet is straight in one direction.
    fn is_ruled(&self, facet: FacetId) -> bool {
        let Some(support) = self.support(facet) else { return false };
        let [a, b, c] = self.complex.facets[facet].triangles[0].map(|v| self.point(v));
        let foot = support.closest(&((a + b + c) / 3.0));
        support.is_straight_along(&foot, &foot.principal()[1].1)
    }

    /// Whether an edge is straight on the surface of a facet.
    pub fn is_straight_on(&self, [a, b]: Edge, facet: FacetId) -> bool {
        let Some(support) = self.support(facet) else { return !self.is_hidden(facet) };
        let (a, b) = (self.point(a), self.point(b));
        let foot = support.closest(&((a + b) * 0.5));
        support.is_straight_along(&foot, &(b - a))
    }

    /// Whether an edge is straight on all surfaces there, so that strips on all its sides can be cut at the same place: inside
    /// of a surface, or where another one meets it along a ruling.
    fn is_ruling(&self, edge: Edge) -> bool {
        // Facets whose support is hidden follow those that an intersection cut.
        let mut known = self.around(edge).filter(|&f| !self.is_hidden(f)).peekable();
        known.peek().is_some() && known.all(|f| self.is_straight_on(edge, f))
    }

    /// By vertex: whether an intersection of facets put it off one of its surfaces. Not so the ends of a line that is straight
    /// on all its surfaces: it cuts strips along, and they stay planar if it moves to the true surface.
    pub fn off_vertices(&self) -> Vec<bool> {
        let mut straight: Vec<(VertexId, SurfaceId)> = Vec::new();
        for run in self.facets_of_edge.chunk_by(|a, b| a.0 == b.0) {
            let edge = run[0].0;
            if run.iter().all(|e| self.is_straight_on(edge, e.1)) {
                let surfaces = run.iter().map(|e| self.complex.facets[e.1].surface);
                straight.extend(surfaces.flat_map(|s| edge.map(|v| (v, s))));
            }
        }
        straight.sort_unstable();
        let mut is_off = vec![false; self.complex.vertices.len()];
        for (id, facet) in self.complex.facets.enumerate() {
            let Some(support) = self.support(id) else { continue };
            for &v in facet.loops.iter().flatten() {
                is_off[v.index()] |=
                    support.distance(&self.point(v)) > self.reach && straight.binary_search(&(v, facet.surface)).is_err();
            }
        }
        is_off
    }

    pub fn rulings(&self, facet: FacetId) -> Vec<Edge> {
        edges_of(&self.complex.facets[facet].loops).map(sorted).filter(|&e| self.is_ruling(e)).collect()
    }

    /// Start, direction and length of a ruling.
    pub fn line(&self, ruling: Edge) -> (Vec3, Vec3, f64) {
        let [a, b] = ruling.map(|v| self.point(v));
        let length = (b - a).norm();
        (a, (b - a) / length, length)
    }

    /// How far a facet reaches from one of its rulings.
    pub fn width(&self, facet: FacetId, ruling: Edge) -> f64 {
        let (start, along, _) = self.line(ruling);
        let corners = self.complex.facets[facet].loops.iter().flatten();
        corners.map(|&v| (self.point(v) - start).cross(&along).norm()).fold(0.0, f64::max)
    }
}
