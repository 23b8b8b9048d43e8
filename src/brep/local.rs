//! Local changes for the remesher as short sequences of Euler operators: split, collapse, swap (thesis 4.2.2, Table 4.1).
//!
//! Topology here decides only what is *possible* (link condition, no doubled edge or facet, feature curves kept, regions kept);
//! whether a change is *good* (angles, deviation, no new contact) is the remesher's to judge beforehand, from a plan:
//!
//! ```text
//! let plan = brep.plan_collapse(edge, gone)?;      // nothing has changed yet; Err says why it is impossible
//! for &facet in &plan.changed { .. }               // these get `plan.kept` for `plan.gone`; plan.removed disappear
//! let touched = brep.collapse(&plan);              // cannot fail
//! ```
//!
//! A plan is void as soon as anything around it has changed. `relocate` needs no topology: write `brep.vertices[v].point`.
//! Facets that are not single triangles carry a triangulation beside them: `split_edge` keeps it up to date, `collapse` of a
//! border edge and a moved vertex may spoil it; then [`Brep::retriangulate`] makes it anew.

use super::complex::ComplexVertex;
use super::model::Brep;
use super::store::{EdgeId, FinId};
use crate::ids::{FacetId, VertexId};

/// Why a local change is impossible.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Refusal {
    /// The vertex that would go is a corner of feature curves, or the edge leaves the curve it lies on.
    Feature,
    /// The two ends have more in common than the edge (link condition): edges or facets would coincide or pinch.
    Link,
    /// A facet would have fewer than three corners.
    TooSmall,
    /// Swap: the two facets at the edge are not two triangles of one surface, marker and pair of regions.
    NotTriangles,
    /// Swap: the other diagonal is an edge already.
    EdgeExists,
}

/// What a local change touched. Ids of removed elements may be reused by later changes.
#[derive(Clone, Debug, Default)]
pub struct Touched {
    /// The new vertex (split) or the kept one (collapse).
    pub vertex: Option<VertexId>,
    /// Facets that exist and changed or are new.
    pub facets: Vec<FacetId>,
    /// Edges that are new or whose ends or facets changed (their queue entries are stale).
    pub edges: Vec<EdgeId>,
    /// Facets that are gone.
    pub removed_facets: Vec<FacetId>,
    /// Edges that are gone.
    pub removed_edges: Vec<EdgeId>,
}

/// A collapse that is topologically legal.
#[derive(Clone, Debug)]
pub struct Collapse {
    /// The edge.
    pub edge: EdgeId,
    /// The end that goes.
    pub gone: VertexId,
    /// The end that stays; all edges of `gone` now end here.
    pub kept: VertexId,
    /// Triangles at the edge: they disappear.
    pub removed: Vec<FacetId>,
    /// All other facets at `gone`: they get `kept` instead (a polygon at the edge just loses a corner).
    pub changed: Vec<FacetId>,
}

/// A swap that is topologically legal: triangles (a, b, c) and (b, a, d) become (c, d, b) and (d, c, a).
#[derive(Clone, Copy, Debug)]
pub struct Swap {
    /// The edge a b.
    pub edge: EdgeId,
    /// Its ends, as the first facet walks them.
    pub ends: [VertexId; 2],
    /// The corners opposite to it, in the first and the second facet.
    pub opposite: [VertexId; 2],
    /// The facets at the edge.
    pub facets: [FacetId; 2],
}

impl Brep {
    /// Whether an edge is part of a feature curve: it has not exactly two facets, or they differ in surface, marker or regions.
    pub fn is_feature(&self, edge: EdgeId) -> bool {
        let mut ring = self.topology.fins_around(edge);
        let (Some(f), Some(g), None) = (ring.next(), ring.next(), ring.next()) else { return true };
        let (a, b) = (self.topology.facet_of(f), self.topology.facet_of(g));
        let (mut here, there) = (self.topology.sides(a), self.topology.sides(b));
        if self.topology.is_along(f) == self.topology.is_along(g) {
            here.reverse();
        }
        let [da, db] = [&self.facets[a], &self.facets[b]];
        a == b || here != there || da.surface != db.surface || da.marker != db.marker
    }

    /// Puts a vertex into an edge. Facets around it for which `divide` holds and which are single triangles are cut in two from
    /// the new vertex to the opposite corner; all others get one more corner, and their triangulation is cut instead. Always
    /// possible. Euler operators: one MEV, one MEF per divided facet.
    pub fn split_edge(&mut self, edge: EdgeId, vertex: ComplexVertex, divide: impl Fn(&Self, FacetId) -> bool) -> Touched {
        let (half, new) = self.topology.mev_in_edge(edge);
        self.set_vertex(new, vertex);
        let mut touched = Touched { vertex: Some(new), edges: vec![edge, half], ..Touched::default() };
        let pieces: Vec<FinId> = self.topology.fins_around(half).collect();
        for piece in pieces {
            let facet = self.topology.facet_of(piece);
            touched.facets.push(facet);
            // The corner at the new vertex.
            let along = self.topology.is_along(piece);
            let corner = if along { piece } else { self.topology.next_fin(piece) };
            let opposite = self.topology.next_fin(self.topology.next_fin(corner));
            let is_whole = self.facets[facet].tiles.is_empty();
            if is_whole && divide(self, facet) {
                if let Ok((cut, part)) = self.topology.mef(corner, opposite) {
                    self.set_facet(part, self.facets[facet].clone());
                    touched.edges.push(cut);
                    touched.facets.push(part);
                }
                continue;
            }
            let [from, to] = [self.topology.prev_fin(corner), corner];
            let ends = [self.topology.fin_ends(from)[0], self.topology.fin_ends(to)[1]];
            if is_whole {
                let apex = self.topology.fin_ends(opposite)[0];
                self.facets[facet].tiles.push([ends[0], ends[1], apex]);
            }
            split_tile(&mut self.facets[facet].tiles, ends, new);
        }
        touched
    }

    /// Whether the edge can be replaced by the other diagonal of its two triangles.
    ///
    /// # Errors
    /// `Feature`, `NotTriangles`, `EdgeExists`.
    pub fn plan_swap(&self, edge: EdgeId) -> Result<Swap, Refusal> {
        if self.is_feature(edge) {
            return Err(Refusal::Feature);
        }
        let topology = &self.topology;
        let fins: Vec<FinId> = topology.fins_around(edge).collect();
        let facets = [fins[0], fins[1]].map(|fin| topology.facet_of(fin));
        let is_turned = topology.is_along(fins[0]) == topology.is_along(fins[1]);
        if is_turned || facets.iter().any(|&facet| topology.triangle(facet).is_none()) {
            return Err(Refusal::NotTriangles);
        }
        let opposite = [fins[0], fins[1]].map(|fin| topology.fin_ends(topology.prev_fin(fin))[0]);
        if opposite[0] == opposite[1] || topology.edge_between(opposite[0], opposite[1]).is_some() {
            return Err(Refusal::EdgeExists);
        }
        Ok(Swap { edge, ends: topology.fin_ends(fins[0]), opposite, facets })
    }

    /// Swaps the edge: KEF, MEF. Edge and facets keep their ids.
    pub fn swap(&mut self, plan: &Swap) -> Touched {
        let topology = &mut self.topology;
        let fins: Vec<FinId> = topology.fins_around(plan.edge).collect();
        let [kept, gone] = [fins[0], fins[1]];
        let [at_c, at_d] = [kept, gone].map(|fin| topology.prev_fin(fin));
        let done = topology.kef(gone).and_then(|()| topology.mef(at_c, at_d));
        debug_assert_eq!(done, Ok((plan.edge, plan.facets[1])), "stale plan");
        Touched { facets: plan.facets.to_vec(), edges: vec![plan.edge], ..Touched::default() }
    }
}

/// Cuts the triangle at the directed edge `ends` in two at `vertex`.
fn split_tile(tiles: &mut Vec<[VertexId; 3]>, ends: [VertexId; 2], vertex: VertexId) {
    for k in 0..tiles.len() {
        let [a, b, c] = tiles[k];
        if let Some([a, b, c]) = [[a, b, c], [b, c, a], [c, a, b]].into_iter().find(|t| t[..2] == ends) {
            tiles[k] = [a, vertex, c];
            tiles.push([vertex, b, c]);
            return;
        }
    }
}
