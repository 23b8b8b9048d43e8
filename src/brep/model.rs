//! The model: topology, and beside it what it means in space.

use super::complex::{ComplexSurface, ComplexVertex, KilledFacet, Marker, Region};
use super::store::{Nil, Topology};
use crate::geom::Vec3;
use crate::ids::{FacetId, IdVec, LeafId, MarkerId, RegionId, SurfaceId, VertexId};

/// A facetted non-manifold boundary representation with uses (thesis 2.2.3).
///
/// `vertices` and `facets` have a slot per id of the topology, removed ones included: go through
/// `topology.vertices()` and `topology.facets()`.
#[derive(Clone, Debug, Default)]
pub struct Brep {
    /// Who is next to whom.
    pub topology: Topology,
    /// Places of the vertices.
    pub vertices: IdVec<VertexId, ComplexVertex>,
    /// Where facets come from.
    pub facets: IdVec<FacetId, FacetData>,
    /// Regions; number 0 is the outside.
    pub regions: IdVec<RegionId, Region>,
    /// Source surfaces.
    pub surfaces: IdVec<SurfaceId, ComplexSurface>,
    /// Names of facets.
    pub markers: IdVec<MarkerId, Marker>,
    /// Facets that the selection dropped next to retained ones.
    pub killed: Vec<KilledFacet>,
}

/// What a facet is besides its place in the topology.
#[derive(Clone, PartialEq, Debug)]
pub struct FacetData {
    /// Source surface.
    pub surface: SurfaceId,
    /// The leaf's facet that it is a piece of.
    pub source: (LeafId, u32),
    /// Its name.
    pub marker: MarkerId,
    /// Whether the intersection cut it.
    pub is_modified: bool,
    /// Triangles of a facet that is not itself one; empty for a triangle. Read them with [`Brep::triangles`].
    pub(super) tiles: Vec<[VertexId; 3]>,
}

impl Brep {
    /// Where a vertex is.
    pub fn point(&self, vertex: VertexId) -> Vec3 {
        self.vertices[vertex].point
    }
    /// Triangulation of a facet over its own vertices, of its orientation.
    pub fn triangles(&self, facet: FacetId) -> impl Iterator<Item = [VertexId; 3]> + '_ {
        let whole = if self.facets[facet].tiles.is_empty() { self.topology.triangle(facet) } else { None };
        whole.into_iter().chain(self.facets[facet].tiles.iter().copied())
    }
    /// Enters what belongs to a new vertex; its slot may be a reused one.
    pub(super) fn set_vertex(&mut self, vertex: VertexId, data: ComplexVertex) {
        debug_assert!(vertex.is_some());
        match self.vertices.get(vertex) {
            Some(_) => self.vertices[vertex] = data,
            None => {
                let new = self.vertices.push(data);
                debug_assert_eq!(new, vertex);
            }
        }
    }
    /// Enters what belongs to a new facet.
    pub(super) fn set_facet(&mut self, facet: FacetId, data: FacetData) {
        match self.facets.get(facet) {
            Some(_) => self.facets[facet] = data,
            None => {
                let new = self.facets.push(data);
                debug_assert_eq!(new, facet);
            }
        }
    }
}
