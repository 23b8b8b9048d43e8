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
use super::store::EdgeId;
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

/* signatures, bodies follow:

impl Brep {
    /// Puts a vertex into an edge. Facets around it for which `divide` holds and which are single triangles are cut in two
    /// from the new vertex to the opposite corner (MEF); all others get one more corner, and their triangulation is cut
    /// instead. Always possible. Euler operators: one MEV, one MEF per divided facet.
    pub fn split_edge(&mut self, edge: EdgeId, vertex: ComplexVertex, divide: impl Fn(&Self, FacetId) -> bool) -> Touched;

    /// Whether `edge` can be contracted onto its other end so that `gone` disappears, and what that would do.
    pub fn plan_collapse(&self, edge: EdgeId, gone: VertexId) -> Result<Collapse, Refusal>;
    /// Contracts an edge: one KEV, one KEF per triangle at the edge. The kept vertex does not move.
    pub fn collapse(&mut self, plan: &Collapse) -> Touched;

    /// Whether the edge can be replaced by the other diagonal of its two triangles.
    pub fn plan_swap(&self, edge: EdgeId) -> Result<Swap, Refusal>;
    /// Swaps the edge: KEF, MEF.
    pub fn swap(&mut self, plan: &Swap) -> Touched;

    /// Cuts a polygon into the triangles kept beside it (MEF, MEKL): what a strip of a curved side needs before remeshing.
    pub fn divide_facet(&mut self, facet: FacetId) -> Touched;
    /// Triangles of `facet` if `gone` were replaced by `kept` (equal ids: as it is) and vertices were where `at` says.
    pub fn triangulation_if(&self, facet: FacetId, gone: VertexId, kept: VertexId, at: impl Fn(VertexId) -> Vec3)
        -> Result<Vec<[VertexId; 3]>, PolygonError>;
    /// Renews the triangulation kept beside a polygon from the present positions.
    pub fn retriangulate(&mut self, facet: FacetId) -> Result<(), PolygonError>;

    /// Whether an edge is part of a feature curve: not exactly two facets, or they differ in surface, marker or regions.
    pub fn is_feature(&self, edge: EdgeId) -> bool;
}
*/

/* navigation (walk.rs), on brep.topology:
   vertices() edges() facets() -> iterators of live ids;  ends(edge) -> [VertexId; 2];  edge_between(a, b) -> Option<EdgeId>
   edges_at(v) -> iter EdgeId;  facets_at(v) -> iter FacetId (a facet once per corner);  facets_around(edge) -> iter FacetId in
   radial order;  loops(facet) -> iter LoopId (outer first);  corners(loop) -> iter VertexId;  triangle(facet) -> Option<[VertexId; 3]>
   regions(facet) -> [RegionId; 2] (in front, behind)
   brep.triangles(facet) -> &[[VertexId; 3]]-like iterator;  brep.facets[f].{surface, marker, source, is_modified} */
