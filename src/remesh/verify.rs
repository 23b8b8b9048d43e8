//! The last word on a remeshed model: planar facets triangulated again, and an exact test that nothing meets anything or is
//! turned inside out.
//!
//! Operators look at the triangles around them and at the polygons beside, not at surfaces across a gap. So the whole is proved
//! at the end, and where it fails the surfaces involved are remeshed closer to their true shape, or not at all there.

use super::quality::is_needle;
use super::workpiece::Workpiece;
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use crate::geom::embedding::violations;
use crate::ids::{FacetId, SurfaceId, VertexId};

/// Violations looked at; the rest shows in the next attempt.
const MANY: usize = 1000;

/// Sine of the smallest angle of a triangle that is worse than none (one degree): left as a strip, the surface has no needles
/// there.
const POOR_SINE: f64 = 0.0175;

/// A place where a remeshed model is no complex, or worse than the evaluated one.
pub(super) struct Fault {
    /// A remeshed surface there.
    pub surface: SurfaceId,
    /// The box of one of its facets there.
    pub place: Aabb,
    /// Whether facets meet there or are turned inside out; else the facet is a needle.
    pub is_contact: bool,
}

impl Workpiece {
    /// Triangulates planar facets again and tests everything; the remeshed facets at fault, none if all is well.
    pub fn faults(&mut self) -> Vec<Fault> {
        let mut corners = self.retriangulate();
        if corners.is_empty() {
            corners = self.colliding();
        }
        let topology = &self.brep.topology;
        let mut meeting: Vec<FacetId> = corners.into_iter().flat_map(|v| topology.facets_at(v)).chain(self.turned()).collect();
        meeting.sort_unstable();
        meeting.dedup();
        let fault = |f: FacetId, is_contact| {
            let corners = self.corners(f)?.map(|v| self.point(v));
            Some(Fault { surface: self.brep.facets[f].surface, place: Aabb::around(&corners), is_contact })
        };
        let meeting = meeting.into_iter().filter(|&f| self.is_treated(f)).filter_map(|f| fault(f, true));
        let needles = topology.facets().filter(|&f| self.is_treated(f) && self.is_poor(f)).filter_map(|f| fault(f, false));
        meeting.chain(needles).collect()
    }

    /// Facets around regions and voids that are turned inside out: two surfaces that nearly coincide have passed each other as
    /// a whole, and nothing meets.
    fn turned(&self) -> Vec<FacetId> {
        let topology = &self.brep.topology;
        let shells = topology.shells().filter(|&s| (self.brep.shell_volume6(s) > 0.0) != topology.is_outer(s));
        shells.flat_map(|s| topology.face_uses(s)).map(|face_use| face_use.facet()).collect()
    }

    fn is_poor(&self, facet: FacetId) -> bool {
        self.corners(facet).map(|t| t.map(|v| self.point(v))).is_some_and(|[a, b, c]| is_needle([&a, &b, &c], POOR_SINE))
    }

    /// New triangulations of the polygons; the corners of those that have none.
    fn retriangulate(&mut self) -> Vec<VertexId> {
        let polygons: Vec<FacetId> = self.brep.topology.facets().filter(|&f| self.corners(f).is_none()).collect();
        let faulty: Vec<FacetId> = polygons.into_iter().filter(|&f| self.brep.retriangulate(f).is_err()).collect();
        let fins = faulty.into_iter().flat_map(|f| self.brep.topology.fins_of_facet(f));
        fins.flat_map(|fin| self.brep.topology.fin_ends(fin)).collect()
    }

    /// Corners of triangles that meet others outside of shared vertices and edges.
    fn colliding(&self) -> Vec<VertexId> {
        let facets = self.brep.topology.facets();
        let triangles: Vec<[u32; 3]> = facets.flat_map(|f| self.brep.triangles(f)).map(|t| t.map(|v| v.0)).collect();
        let points: Vec<Vec3> = self.brep.vertices.iter().map(|v| v.point).collect();
        let found = violations(&points, &triangles, MANY);
        found.iter().flat_map(|v| v.triangles).flat_map(|t| triangles[t as usize]).map(VertexId).collect()
    }
}
