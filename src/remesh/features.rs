//! Feature edges, their chains between corners, and the place of every vertex.

use super::sizing::Bound;
use super::workpiece::{CurveId, Place, Workpiece, sorted};
use crate::brep::store::EdgeId;
use crate::geom::Vec3;
use crate::ids::{FacetId, Id, LeafId, SurfaceId, VertexId};
use crate::patch::curve::Curve;
use crate::patch::plane::Plane;
use crate::patch::support::Support;
use crate::primitive::solid::Freedom;
use std::sync::Arc;

/// A chain that turns by more than this at a vertex (80 degrees) has a corner there. Coarse circles turn less: 45 degrees with
/// 8 segments.
const CORNER_COSINE: f64 = 0.17;

/// Sine below which two surfaces along a chain count as one (tangent or coincident): they do not define a curve.
const PARALLEL_SINE: f64 = 0.05;

/// What a facet contributes to the identity of a feature curve.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
enum Wall {
    /// A surface, flat or remeshed.
    Surface(SurfaceId),
    /// A single facet of a curved surface that stays as it is.
    Facet(LeafId, u32),
}

impl Workpiece {
    /// Finds feature curves and places. Must run after the treated facets have been divided into triangles.
    pub fn find_features(&mut self) {
        self.places = vec![Place::Corner; self.brep.topology.bounds()[0]];
        let active: Vec<EdgeId> = self.brep.topology.edges().filter(|&e| self.is_active(e)).collect();
        let is_feature: Vec<EdgeId> = active.iter().copied().filter(|&e| self.brep.is_feature(e)).collect();
        let vertices: Vec<VertexId> = self.brep.topology.vertices().collect();
        for &v in &vertices {
            if let Some(surface) = self.inner_surface(v) {
                self.places[v.index()] = Place::Surface(surface);
            }
        }
        let mut is_done = vec![false; self.brep.topology.bounds()[1]];
        for edge in is_feature {
            if !is_done[edge.index()] {
                self.trace(edge, &mut is_done);
            }
        }
        self.place_slides();
    }

    /// Vertices that were put into rulings stay on them where a strip stays.
    fn place_slides(&mut self) {
        for (vertex, direction) in self.choice.slides.clone() {
            let is_inner = self.brep.topology.edges_at(vertex).all(|e| !self.brep.is_feature(e));
            if is_inner && self.place(vertex) == Place::Corner {
                let star: Vec<FacetId> = self.brep.topology.facets_at(vertex).collect();
                let curve = self.add_curve(Curve::Line { origin: self.point(vertex), direction }, &star);
                self.places[vertex.index()] = Place::Curve(curve);
            }
        }
    }

    /// The surface of a vertex without feature edges; `None` at feature edges, at apexes and at facets that stay.
    fn inner_surface(&self, vertex: VertexId) -> Option<SurfaceId> {
        let facet = self.brep.topology.facets_at(vertex).next()?;
        let is_free = self.brep.topology.facets_at(vertex).all(|f| self.is_treated(f))
            && self.brep.topology.edges_at(vertex).all(|e| !self.brep.is_feature(e))
            && self.brep.vertices[vertex].freedom != Freedom::Fixed;
        is_free.then(|| self.brep.facets[facet].surface)
    }

    fn walls(&self, edge: EdgeId) -> Vec<Wall> {
        let wall = |f: FacetId| {
            let data = &self.brep.facets[f];
            let stays = !self.is_treated(f) && self.supports[data.surface].is_some();
            if stays { Wall::Facet(data.source.0, data.source.1) } else { Wall::Surface(data.surface) }
        };
        let mut walls: Vec<Wall> = self.brep.topology.facets_around(edge).map(wall).collect();
        walls.sort_unstable();
        walls.dedup();
        walls
    }

    /// The next feature edge of the chain past `vertex`; `None` at a corner.
    fn next_of_chain(&self, edge: EdgeId, vertex: VertexId) -> Option<EdgeId> {
        let mut features = self.brep.topology.edges_at(vertex).filter(|&e| self.brep.is_feature(e));
        let (a, b) = (features.next()?, features.next()?);
        if features.next().is_some() {
            return None;
        }
        let next = if a == edge { b } else { a };
        let walls = self.walls(edge);
        let stays = walls.iter().any(|w| matches!(w, Wall::Facet(..)));
        let (before, after) = (self.other_point(edge, vertex), self.other_point(next, vertex));
        let here = self.point(vertex);
        let (u, v) = (here - before, after - here);
        let is_smooth = u.dot(&v) > CORNER_COSINE * u.norm() * v.norm();
        (!stays && is_smooth && self.is_active(next) && self.walls(next) == walls).then_some(next)
    }

    fn other_point(&self, edge: EdgeId, vertex: VertexId) -> Vec3 {
        self.point(self.brep.topology.other_end(edge, vertex))
    }

    /// Follows the chain of a feature edge both ways and enters its curve.
    fn trace(&mut self, edge: EdgeId, is_done: &mut [bool]) {
        is_done[edge.index()] = true;
        let [a, b] = self.brep.topology.ends(edge);
        let mut chain = self.follow(edge, b, is_done);
        let is_closed = chain.last() == Some(&a);
        chain.insert(0, a);
        chain.insert(1, b);
        chain.dedup();
        if !is_closed {
            let mut back = self.follow(edge, a, is_done);
            back.reverse();
            back.extend(chain);
            chain = back;
        }
        let points: Vec<Vec3> = chain.iter().map(|&v| self.point(v)).collect();
        let supports = self.crossing_supports(edge, &points);
        let is_cut = chain.iter().any(|&v| self.brep.vertices[v].freedom == Freedom::Intersection);
        let around: Vec<FacetId> = self.brep.topology.facets_around(edge).collect();
        let curve = self.add_curve(Curve::of_chain(&points, &supports, is_cut), &around);
        self.enter_chain(&chain, curve, is_closed);
    }

    /// Enters a curve beside some facets.
    pub fn add_curve(&mut self, curve: Curve, facets: &[FacetId]) -> CurveId {
        let bounds = facets.iter().map(|&f| self.bound_on(f));
        self.curve_bounds.push(bounds.reduce(Bound::stricter).unwrap_or(Bound::Fixed(f64::INFINITY)));
        self.curves.push(curve)
    }

    fn enter_chain(&mut self, chain: &[VertexId], curve: CurveId, is_closed: bool) {
        let inner = if is_closed { &chain[1..] } else { &chain[1..chain.len() - 1] };
        for v in inner {
            self.places[v.index()] = Place::Curve(curve);
        }
        if let &[a, b] = chain {
            self.lone_edges.insert(sorted([a, b]), curve);
        }
    }

    /// Vertices of the chain past `vertex`, that one left out, up to the next corner or around to the start.
    fn follow(&self, edge: EdgeId, vertex: VertexId, is_done: &mut [bool]) -> Vec<VertexId> {
        let (mut edge, mut vertex) = (edge, vertex);
        let mut found = Vec::new();
        while let Some(next) = self.next_of_chain(edge, vertex) {
            vertex = self.brep.topology.other_end(next, vertex);
            if is_done[next.index()] {
                break;
            }
            is_done[next.index()] = true;
            found.push(vertex);
            edge = next;
        }
        found
    }

    /// Supports of the facets around an edge, each direction once: surfaces that touch all along the chain count once.
    fn crossing_supports(&self, edge: EdgeId, chain: &[Vec3]) -> Vec<Arc<Support>> {
        let mut kept: Vec<Arc<Support>> = Vec::new();
        for facet in self.brep.topology.facets_around(edge) {
            let Some(support) = self.support_or_plane(facet) else { continue };
            let crosses = |other: &Arc<Support>| {
                let sine = |p: &Vec3| support.nearest(p).normal.cross(&other.nearest(p).normal).norm();
                chain.iter().map(sine).fold(0.0, f64::max) > PARALLEL_SINE
            };
            if kept.iter().all(crosses) {
                kept.push(support);
            }
        }
        kept
    }

    /// The support of a treated facet, the plane of any other.
    pub fn support_or_plane(&self, facet: FacetId) -> Option<Arc<Support>> {
        if self.is_treated(facet) {
            return self.supports[self.brep.facets[facet].surface].clone();
        }
        let area: Vec3 =
            self.brep.triangles(facet).map(|t| t.map(|v| self.point(v))).map(|[a, b, c]| (b - a).cross(&(c - a))).sum();
        let origin = self.brep.triangles(facet).next().map(|t| self.point(t[0]))?;
        Plane::new(origin, area).map(|p| Arc::new(Support::Plane(p)))
    }
}
