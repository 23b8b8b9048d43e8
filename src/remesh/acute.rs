//! Mends obtuse triangles that no single operation mends: an operation and what its neighbours make of it, kept if the angles
//! gain, else undone.
//!
//! Polishing stops where each operation by itself makes some triangle worse. What is left are a few dozen angles just over 90
//! degrees; yet each of them makes TetGen split some fifteen edges (see `bends`). So here a trial may begin with a step back: a
//! swap or split near the triangle, legal but bad, then moves and swaps around it, worst vertex first, as in polishing. Four in
//! five of these angles go so (reference scenes in Full at the deviations of their issue, 23 November; what a change does is
//! seen in the test below). Cost: a bounded number of trials per facet, each of bounded length.
//!
//! At the very end every edge and triangle in whose smallest sphere any vertex lies (`sight`) is tried: all vertices of a place
//! move in turn where the sum of squared flaws is least. Nine such edges left on three_cylinders made 15 tetrahedra above ratio
//! 2.0; without them there is none.

use super::quality::{cosine_of_degrees, flaw, is_obtuse, is_small};
use super::sight::Sight;
use super::trial::Trial;
use super::workpiece::Workpiece;
use crate::brep::store::EdgeId;
use crate::geom::Vec3;
use crate::ids::{FacetId, VertexId};
use std::collections::HashMap;

/// How often all obtuse triangles are looked at, and below how many degrees another angle may not get for it. Smaller ones leave
/// more room, but at once they lead astray: where a quarter of all triangles are obtuse at first, mends get into each other's
/// way. Over 21 scenes of cylinders and spheres 305 tetrahedra stay above ratio 2.0 in Full and 334 in Interfaces; with 38 degrees
/// three times 507 and 592, with 36 at once a thousand wide angles on sphere_grid from n = 6 on. What was tried in vain is tried
/// again, as moves further off may have helped: with one or two tries 465 and 533 stay in Full.
const PASSES: [f64; 6] = [39.0, 39.0, 38.0, 37.0, 36.0, 35.0];
/// Passes in which triangles on fitted surfaces are looked at: there trials cost ten times as much, and neighbouring patches do
/// not fit together well enough for angles to matter that much.
const FITTED_PASSES: usize = 2;
/// Trials at most in a pass, per treated facet: more than any reference scene takes (machine: one).
const TRIALS_PER_FACET: usize = 2;
/// Least gain for which a trial is kept: a quarter of the flaw of a right angle.
const LEAST_GAIN: f64 = 0.01;

/// What a trial begins with. Edges are told by their ends: a split that is undone may leave them with other ids.
#[derive(Clone, Copy, Debug)]
enum Start {
    /// Moves only.
    Nothing,
    Swap([VertexId; 2]),
    Split([VertexId; 2]),
}

/// What follows the beginning.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Means {
    /// The vertex with the worst angles goes where the smallest is largest; then the next.
    Worst,
    /// All vertices around, in turn, go where the strain is least.
    Ease,
}

impl Workpiece {
    /// Mends obtuse triangles, the worst first.
    pub fn make_acute(&mut self) {
        let most = TRIALS_PER_FACET * self.is_treated.iter().filter(|&&t| t).count();
        for (pass, degrees) in PASSES.into_iter().enumerate() {
            self.small = cosine_of_degrees(degrees);
            let mut budget = most;
            let is_worth = |f: FacetId| pass < FITTED_PASSES || self.support(f).is_none_or(|s| !s.is_fitted());
            let facets = self.brep.topology.facets().filter(|&f| self.is_treated(f) && self.is_obtuse(f) && is_worth(f));
            // By their corners: what is undone leaves triangles with other ids.
            let mut worst: Vec<(f64, [VertexId; 3])> =
                facets.filter_map(|f| Some((self.flaws(&[f]), in_order(self.corners(f)?)))).collect();
            worst.sort_by(|p, q| q.0.total_cmp(&p.0).then(p.1.cmp(&q.1)));
            for (_, corners) in worst {
                // Those before may have changed it.
                if let Some(facet) = self.triangle_of(corners).filter(|&f| self.is_treated(f) && self.is_obtuse(f)) {
                    self.make_triangle_acute(facet, &mut budget);
                }
            }
        }
    }

    /// The edges and triangles around some vertices that any vertex near sees under 90 degrees or more, however little.
    pub fn sights_around(&self, vertices: &[VertexId]) -> Vec<Sight> {
        let mut facets: Vec<FacetId> = vertices.iter().flat_map(|&v| self.star(v)).collect();
        facets.sort_unstable();
        facets.dedup();
        let mut edges = self.edges_of(&facets);
        edges.sort_unstable();
        edges.dedup();
        let seen_edges = edges.into_iter().filter_map(|e| self.sight_of_edge(e));
        seen_edges.chain(facets.into_iter().filter_map(|f| self.sight_of_facet(f))).collect()
    }

    /// Mends what is seen too wide at the end; whether anything was done. What was tried in vain before is in `failed`, with
    /// the places of all vertices around.
    pub fn clear_sights(&mut self, sights: Vec<Sight>, failed: &mut HashMap<Sight, Vec<Vec3>>) -> bool {
        let mut is_changed = false;
        for sight in sights {
            let around = self.places_around(&sight.vertices());
            // Those before may have mended it.
            if !self.is_sight(&sight) || failed.get(&sight) == Some(&around) {
                continue;
            }
            let starts = [Start::Nothing, Start::Split(sight.base), Start::Swap(sight.base)];
            if starts.into_iter().any(|start| self.attempt(start, Means::Ease, &sight.vertices(), Some(sight))) {
                is_changed = true;
            } else {
                failed.insert(sight, around);
            }
        }
        is_changed
    }

    /// Where the neighbours of some vertices are, in order.
    fn places_around(&self, vertices: &[VertexId]) -> Vec<Vec3> {
        let mut around: Vec<VertexId> = vertices.iter().flat_map(|&v| self.brep.topology.neighbours(v)).collect();
        around.sort_unstable();
        around.into_iter().map(|v| self.point(v)).collect()
    }

    /// Tries one beginning after the other, until one helps.
    fn make_triangle_acute(&mut self, facet: FacetId, budget: &mut usize) {
        let Some(corners) = self.corners(facet).map(in_order) else { return };
        for start in self.starts(facet, corners) {
            if *budget == 0 {
                return;
            }
            *budget -= 1;
            if self.attempt(start, Means::Worst, &corners, None) {
                return;
            }
        }
    }

    /// What to begin with, most promising first. What helps in less than one case of thirty is left out: the shorter edges of
    /// the triangle, edges at the obtuse corner, swaps farther away.
    fn starts(&self, facet: FacetId, corners: [VertexId; 3]) -> Vec<Start> {
        let own = self.edges_of(&[facet]);
        let Some(&longest) = own.iter().max_by(|&&e, &&f| self.length(e).total_cmp(&self.length(f))) else { return Vec::new() };
        let base = self.brep.topology.ends(longest);
        let stars: Vec<FacetId> = corners.iter().flat_map(|&v| self.star(v)).collect();
        let mut edges: Vec<(f64, EdgeId)> = self.edges_of(&stars).into_iter().map(|e| (-self.length(e), e)).collect();
        edges.sort_by(|p, q| p.0.total_cmp(&q.0).then(p.1.cmp(&q.1)));
        edges.dedup();
        edges.retain(|e| !own.contains(&e.1));
        let touches = |e: EdgeId, corners: &[VertexId]| self.brep.topology.ends(e).iter().any(|v| corners.contains(v));
        let ends = |e: &(f64, EdgeId)| self.brep.topology.ends(e.1);
        let spokes: Vec<[VertexId; 2]> = edges.iter().filter(|e| touches(e.1, &base)).map(ends).collect();
        let rim = edges.iter().filter(|e| !touches(e.1, &corners)).map(ends);
        let at_triangle = [Start::Nothing, Start::Swap(base), Start::Split(base)].into_iter();
        let at_spokes = spokes.iter().map(|&e| Start::Split(e)).chain(spokes.iter().map(|&e| Start::Swap(e)));
        at_triangle.chain(at_spokes).chain(rim.map(Start::Split)).collect()
    }

    /// Tries one beginning; whether that helped, else all is as before.
    fn attempt(&mut self, start: Start, means: Means, corners: &[VertexId], sight: Option<Sight>) -> bool {
        let mut trial = Trial::new(self, sight);
        let begun = match start {
            Start::Nothing => Some(corners.to_vec()),
            Start::Swap([a, b]) => trial.work.brep.topology.edge_between(a, b).and_then(|e| trial.swap(e, true)),
            Start::Split([a, b]) => trial.work.brep.topology.edge_between(a, b).and_then(|e| trial.split(e)),
        };
        let around = begun.clone().unwrap_or_default();
        match (begun, means) {
            (Some(vertices), Means::Worst) => trial.settle(vertices),
            (Some(vertices), Means::Ease) => trial.ease(vertices),
            (None, _) => {}
        }
        // Moves that ease leave no small angle, but a swap or split before them may.
        let is_narrow = means == Means::Ease && !matches!(start, Start::Nothing) && trial.work.has_small_angle(&around);
        if trial.gain > LEAST_GAIN && !is_narrow {
            return true;
        }
        trial.undo();
        false
    }

    /// The facet with these corners.
    fn triangle_of(&self, corners: [VertexId; 3]) -> Option<FacetId> {
        let edge = self.brep.topology.edge_between(corners[0], corners[1])?;
        self.brep.topology.facets_around(edge).find(|&f| self.corners(f).is_some_and(|t| in_order(t) == corners))
    }

    fn is_obtuse(&self, facet: FacetId) -> bool {
        self.corners(facet).is_some_and(|t| is_obtuse(&self.points(t)))
    }

    /// Whether a treated facet at some vertices has a small angle.
    fn has_small_angle(&self, vertices: &[VertexId]) -> bool {
        let facets = vertices.iter().flat_map(|&v| self.star(v));
        facets.filter_map(|f| self.corners(f)).map(|t| self.points(t)).any(|[a, b, c]| is_small([&a, &b, &c], self.small))
    }

    /// Sum of the flaws of those of some facets that are treated.
    pub fn flaws(&self, facets: &[FacetId]) -> f64 {
        let treated = facets.iter().filter(|&&f| self.brep.topology.has_facet(f) && self.is_treated(f));
        treated.filter_map(|&f| self.corners(f)).map(|t| self.points(t)).map(|[a, b, c]| flaw([&a, &b, &c], self.small)).sum()
    }
}

fn in_order(mut corners: [VertexId; 3]) -> [VertexId; 3] {
    corners.sort_unstable();
    corners
}

#[cfg(test)]
mod tests {
    use super::super::tests::{cone, cylinder, polished};
    use super::*;
    use crate::ids::Id;

    /// The places of its corners, in order, whether it is treated, its sense.
    type Told = (Vec<[u64; 3]>, bool, u64);

    /// All triangles, in order.
    fn triangles(work: &Workpiece) -> Vec<Told> {
        let facets = work.brep.topology.facets().filter_map(|f| Some((f, work.corners(f)?)));
        let mut all: Vec<Told> = facets
            .map(|(f, t)| {
                let mut corners: Vec<[u64; 3]> = work.points(t).map(|p| [p.x, p.y, p.z].map(f64::to_bits)).to_vec();
                corners.sort_unstable();
                (corners, work.is_treated(f), work.sense[f.index()].to_bits())
            })
            .collect();
        all.sort_unstable();
        all
    }

    #[test]
    fn a_trial_in_vain_leaves_no_trace() {
        let mut work = polished(cylinder(50.0, 200.0, 24), 1.0);
        let facets: Vec<FacetId> = work.brep.topology.facets().filter(|&f| work.is_treated(f)).collect();
        let (mut kept, mut undone) = (0, 0);
        for facet in facets.into_iter().step_by(20) {
            let Some(corners) = work.corners(facet) else { continue };
            for start in work.starts(facet, corners) {
                let before = triangles(&work);
                if work.attempt(start, Means::Worst, &corners, None) {
                    kept += 1;
                    break;
                }
                undone += 1;
                assert_eq!(triangles(&work), before, "{start:?}");
            }
        }
        assert!(undone > 100, "{undone} undone, {kept} kept");
    }

    #[test]
    fn hardly_any_angle_is_obtuse() {
        for complex in [cylinder(50.0, 200.0, 24), cone(50.0, 100.0, 24)] {
            let work = polished(complex, 0.7);
            let obtuse = work.brep.topology.facets().filter(|&f| work.is_treated(f) && work.is_obtuse(f)).count();
            let all = work.brep.topology.facets().filter(|&f| work.is_treated(f)).count();
            assert!(all > 300 && 100 * obtuse <= all, "{obtuse} of {all}");
        }
    }
}
