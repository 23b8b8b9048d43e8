//! The evaluated model as plain data: what `round` yields, the kernel is built from, and `plc` writes.

use crate::geom::Vec3;
use crate::ids::{FacetId, IdVec, LeafId, MarkerId, PartId, RegionId, SurfaceId, VertexId};
use crate::primitive::solid::{Freedom, Shape};

/// A piecewise linear complex with its names and lineage.
///
/// Invariants: triangles of different facets meet only in shared vertices and edges, exactly, in these coordinates; every
/// directed edge of a region's facet sides is matched in the same region; no vertex lies on a facet or edge that does not list
/// it.
#[derive(Clone, Debug, Default)]
pub struct Complex {
    /// Vertices.
    pub vertices: IdVec<VertexId, ComplexVertex>,
    /// Facets.
    pub facets: IdVec<FacetId, ComplexFacet>,
    /// Region 0 is the unbounded outside; then connected volumes, by part and then by smallest vertex; voids (part `None`)
    /// last.
    pub regions: IdVec<RegionId, Region>,
    /// Source surfaces of facets.
    pub surfaces: IdVec<SurfaceId, ComplexSurface>,
    /// Interfaces and boundaries: names of facets.
    pub markers: IdVec<MarkerId, Marker>,
    /// Facets that the selection dropped next to retained ones: they still shape the patches.
    pub killed: Vec<KilledFacet>,
}

/// A vertex of the complex.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ComplexVertex {
    /// Position, in the scene's unit.
    pub point: Vec3,
    /// How it may move.
    pub freedom: Freedom,
}

/// A planar facet with two sides.
#[derive(Clone, PartialEq, Debug)]
pub struct ComplexFacet {
    /// Outer loop first, counter-clockwise about the facet's normal, then holes, clockwise. A loop of one vertex is a vertex of
    /// something else that touches the facet inside; a loop of two is an edge that does.
    pub loops: Vec<Vec<VertexId>>,
    /// Triangulation over the same vertices, of the same orientation.
    pub triangles: Vec<[VertexId; 3]>,
    /// Regions in front (where the normal points) and behind.
    pub sides: [RegionId; 2],
    /// Source surface.
    pub surface: SurfaceId,
    /// The leaf's facet that it is a piece of.
    pub source: (LeafId, u32),
    /// Its name.
    pub marker: MarkerId,
    /// Whether the intersection cut it, so that it is not a whole facet of its leaf.
    pub is_modified: bool,
}

impl ComplexFacet {
    /// A facet for each of its triangles.
    pub fn divided(&self) -> impl Iterator<Item = Self> + '_ {
        self.triangles.iter().map(|&t| Self { loops: vec![t.to_vec()], triangles: vec![t], ..self.clone() })
    }
}

impl Complex {
    /// The corners of all triangles, facet by facet.
    pub fn triangles(&self) -> Vec<[u32; 3]> {
        let mut triangles = Vec::with_capacity(self.facets.iter().map(|f| f.triangles.len()).sum());
        triangles.extend(self.facets.iter().flat_map(|f| f.triangles.iter().map(|t| t.map(|v| v.0))));
        triangles
    }
}

/// A connected volume.
#[derive(Clone, PartialEq, Debug)]
pub struct Region {
    /// The part that claims it; `None` for the outside and for voids.
    pub part: Option<PartId>,
}

/// A source surface.
#[derive(Clone, PartialEq, Debug)]
pub struct ComplexSurface {
    /// The leaf that it belongs to.
    pub leaf: LeafId,
    /// Name of the side.
    pub side: String,
    /// Its exact shape.
    pub shape: Shape,
}

/// The name of a set of facets.
#[derive(Clone, PartialEq, Debug)]
pub struct Marker {
    /// `A|B` in file order, `A|outer` towards the outside, or the boundary's own name.
    pub name: String,
    /// The two parts in file order; `None` is the outside or a void.
    pub parts: [Option<PartId>; 2],
    /// The interface that a named boundary is a piece of; itself for an interface.
    pub interface: MarkerId,
    /// Largest edge length that the scene asks for on this interface.
    pub max_edge: Option<f64>,
}

/// A dropped facet.
#[derive(Clone, PartialEq, Debug)]
pub struct KilledFacet {
    /// The leaf's facet that it is a piece of.
    pub source: (LeafId, u32),
    /// Its corners.
    pub triangle: [Vec3; 3],
}
