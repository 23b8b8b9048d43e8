//! The last word on a remeshed model: planar facets triangulated again, and an exact test that nothing meets anything or is
//! turned inside out.
//!
//! Operators look at the triangles around them and at the polygons beside, not at surfaces across a gap. So the whole is proved
//! at the end, and where it fails the surfaces involved are remeshed closer to their true shape, or not at all there.

use super::quality::is_needle;
use super::sizing::Limits;
use super::workpiece::Workpiece;
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use crate::geom::embedding::violations;
use crate::ids::{FacetId, Id, SurfaceId, VertexId};

/// Violations looked at; the rest shows in the next attempt.
const MANY: usize = 1000;

/// Sine of the smallest angle of a triangle that is worse than none (one degree): left as a strip, the surface has no needles
/// there.
const POOR_SINE: f64 = 0.0175;

/// Share of the triangles that may meet others before they are polished. Where it was 2 % at most, later steps parted them in
/// some scenes; from 10 % on in none.
const PARTING: f64 = 0.05;
/// The same on any one surface, if that is more than a few triangles: a large model must not hide that one of its gaps is thinner
/// than the chords beside it. 33 of 43 triangles of a small surface were parted later; 222 of 1394 were not.
const PARTING_ON_ONE: f64 = 0.1;
const FEW_ON_ONE: usize = 100;

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

    /// Whether facets meet and it is no use to go on: where surfaces are a guess, or at so many places that surfaces are nearer
    /// to each other than their chords.
    pub fn is_hopeless(&mut self, limits: &Limits) -> bool {
        if !self.is_guess() && !limits.is_cramped.get() {
            return false;
        }
        let faults = self.faults();
        let meeting: Vec<SurfaceId> = faults.iter().filter(|f| f.is_contact).map(|f| f.surface).collect();
        if self.is_guess() {
            return !meeting.is_empty();
        }
        let treated =
            self.brep.topology.facets().filter(|&f| self.is_treated(f)).map(|f| self.brep.facets[f].surface).collect();
        are_too_many(&self.by_surface(meeting), &self.by_surface(treated))
    }

    /// By surface: how often it is among some.
    fn by_surface(&self, of: Vec<SurfaceId>) -> Vec<usize> {
        let mut counts = vec![0; self.supports.len()];
        of.into_iter().for_each(|s| counts[s.index()] += 1);
        counts
    }

    /// Whether a surface is known by its facets only.
    fn is_guess(&self) -> bool {
        self.supports.iter().flatten().any(|s| s.is_fitted())
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

/// Whether more triangles meet others than later steps part, of the treated ones: of all, or of one surface, by which they are
/// counted.
fn are_too_many(meeting: &[usize], treated: &[usize]) -> bool {
    let is_most = |meeting: usize, all: usize, share: f64| meeting as f64 > share * all as f64;
    let on_one = |(&meeting, &all): (&usize, &usize)| meeting > FEW_ON_ONE && is_most(meeting, all, PARTING_ON_ONE);
    is_most(meeting.iter().sum(), treated.iter().sum(), PARTING) || meeting.iter().zip(treated).any(on_one)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An attempt on the loudspeaker among the users' scenes went on for a minute, since its large surfaces hid the gap of the
    /// voice coil.
    #[test]
    fn one_hopeless_gap_ends_an_attempt_of_a_large_model() {
        assert!(!are_too_many(&[0, 0], &[1000, 0]));
        assert!(are_too_many(&[60, 0], &[1000, 0]), "everywhere");
        assert!(are_too_many(&[222, 0], &[1394, 100_000]), "on one surface");
        assert!(!are_too_many(&[33, 0], &[43, 100_000]), "few on a small surface");
        assert!(!are_too_many(&[222, 0], &[5000, 100_000]), "few of a large surface");
    }
}
