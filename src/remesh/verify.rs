//! The last word on a remeshed model: planar facets triangulated again, and an exact test that nothing meets anything.
//!
//! Operators look at the triangles around them and at the polygons beside, not at surfaces across a gap. So the whole is proved at
//! the end, and where it fails the surfaces involved are remeshed closer to their true shape, or not at all.

use super::workpiece::Workpiece;
use crate::geom::Vec3;
use crate::geom::embedding::violations;
use crate::ids::{FacetId, Id, SurfaceId};

/// Violations looked at; a few are enough to name the surfaces, the rest shows in the next attempt.
const MANY: usize = 1000;

impl Workpiece {
    /// Triangulates planar facets again and tests everything; the curved surfaces at fault, sorted, none if all is well. An error
    /// without a curved surface near gives all of them.
    pub fn faulty_surfaces(&mut self) -> Vec<SurfaceId> {
        let mut faulty = self.retriangulate();
        if faulty.is_empty() {
            faulty = self.colliding();
        }
        if faulty.is_empty() {
            return Vec::new();
        }
        let topology = &self.brep.topology;
        let around = faulty.iter().flat_map(|&f| topology.fins_of_facet(f)).flat_map(|fin| topology.fin_ends(fin));
        let mut surfaces: Vec<SurfaceId> = around
            .flat_map(|v| topology.facets_at(v))
            .filter(|&f| self.is_treated(f))
            .map(|f| self.brep.facets[f].surface)
            .collect();
        if surfaces.is_empty() {
            surfaces = self.supports.ids().filter(|&s| self.supports[s].is_some()).collect();
        }
        surfaces.sort_unstable();
        surfaces.dedup();
        surfaces
    }

    /// New triangulations of the polygons; those that have none.
    fn retriangulate(&mut self) -> Vec<FacetId> {
        let polygons: Vec<FacetId> = self.brep.topology.facets().filter(|&f| self.corners(f).is_none()).collect();
        polygons.into_iter().filter(|&f| self.brep.retriangulate(f).is_err()).collect()
    }

    /// Facets whose triangles meet others outside of shared vertices and edges.
    fn colliding(&self) -> Vec<FacetId> {
        let mut triangles = Vec::new();
        let mut owners = Vec::new();
        for facet in self.brep.topology.facets() {
            for t in self.brep.triangles(facet) {
                triangles.push(t.map(|v| v.0));
                owners.push(facet);
            }
        }
        let points: Vec<Vec3> = self.brep.vertices.iter().map(|v| v.point).collect();
        let found = violations(&points, &triangles, MANY);
        let mut facets: Vec<FacetId> = found.iter().flat_map(|v| v.triangles).map(|t| owners[t as usize]).collect();
        facets.sort_unstable_by_key(|f| f.index());
        facets.dedup();
        facets
    }
}
