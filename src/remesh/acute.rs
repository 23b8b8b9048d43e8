//! Mends obtuse triangles that no single operation mends: an operation and what its neighbours make of it, kept if the angles
//! gain, else undone.
//!
//! Polishing stops where each operation by itself makes some triangle worse. What is left are a few dozen angles just over 90
//! degrees; yet each of them makes TetGen split some fifteen edges (see `bends`). So here a trial may begin with a step back: a
//! swap or split near the triangle, legal but bad, then moves and swaps around it, worst vertex first, as in polishing. Four in
//! five of these angles go so (reference scenes in Full at the deviations of their issue, 23 November; what a change does is
//! seen in the test below). Cost: a bounded number of trials per facet, each of bounded length.

use super::quality::{flaw, is_obtuse, of_flawed};
use super::workpiece::Workpiece;
use crate::brep::store::EdgeId;
use crate::geom::Vec3;
use crate::ids::{FacetId, VertexId};
use std::collections::HashMap;

/// How often all obtuse triangles are looked at.
const PASSES: usize = 3;
/// Trials at most, per treated facet: more than any reference scene takes (machine: one).
const TRIALS_PER_FACET: usize = 2;
/// Vertices looked at in a trial.
const STEPS: usize = 20;
/// Least gain for which a trial is kept: a quarter of the flaw of a right angle.
const LEAST_GAIN: f64 = 0.01;
/// Flaws by which a trial may exceed those before; after `GRACE` steps, less by the factor e every `PATIENCE` steps. Giving up
/// earlier saves a third of the time, and loses one in twenty of the trials that succeed.
const LARGEST_LOSS: f64 = 1.0;
const GRACE: usize = 3;
const PATIENCE: f64 = 4.0;
/// Splitting an edge shorter than this many wanted lengths makes triangles that are too small.
const SHORTEST_SPLIT: f64 = 0.9;

/// What a trial begins with. Edges are told by their ends: a split that is undone may leave them with other ids.
#[derive(Clone, Copy, Debug)]
enum Start {
    /// Moves only.
    Nothing,
    Swap([VertexId; 2]),
    Split([VertexId; 2]),
}

/// What has been done in a trial, and is undone with.
enum Done {
    /// The vertex was there.
    Move(VertexId, Vec3),
    /// The edge, which had these ends.
    Swap(EdgeId, [VertexId; 2]),
    /// A vertex was put in an edge of the other.
    Split(VertexId, VertexId),
}

/// Operations that are kept together, or undone.
struct Trial<'a> {
    work: &'a mut Workpiece,
    done: Vec<Done>,
    /// Sum of the flaws done away with.
    gain: f64,
}

/// Triangles that were tried in vain, by their corners in order, with the places of all vertices around; only looked up.
type Failed = HashMap<[VertexId; 3], Vec<Vec3>>;

impl Workpiece {
    /// Mends obtuse triangles, the worst first.
    pub fn make_acute(&mut self) {
        let facets: Vec<FacetId> = self.brep.topology.facets().filter(|&f| self.is_treated(f)).collect();
        let mut budget = TRIALS_PER_FACET * facets.len();
        let mut failed = Failed::new();
        for _ in 0..PASSES {
            let facets = self.brep.topology.facets().filter(|&f| self.is_treated(f) && self.is_obtuse(f));
            // By their corners: what is undone leaves triangles with other ids.
            let mut worst: Vec<(f64, [VertexId; 3])> =
                facets.filter_map(|f| Some((self.flaws(&[f]), in_order(self.corners(f)?)))).collect();
            worst.sort_by(|p, q| q.0.total_cmp(&p.0).then(p.1.cmp(&q.1)));
            let mut is_changed = false;
            for (_, corners) in worst {
                is_changed |= self.make_triangle_acute(corners, &mut failed, &mut budget);
            }
            if !is_changed {
                break;
            }
        }
    }

    /// Whether anything was done about a triangle.
    fn make_triangle_acute(&mut self, corners: [VertexId; 3], failed: &mut Failed, budget: &mut usize) -> bool {
        // Those before may have changed it.
        let Some(facet) = self.triangle_of(corners).filter(|&f| self.is_treated(f) && self.is_obtuse(f)) else { return false };
        let mut around: Vec<VertexId> = corners.iter().flat_map(|&v| self.brep.topology.neighbours(v)).collect();
        around.sort_unstable();
        let around: Vec<Vec3> = around.into_iter().map(|v| self.point(v)).collect();
        if failed.get(&corners) == Some(&around) {
            return false;
        }
        for start in self.starts(facet, corners) {
            if *budget == 0 {
                return false;
            }
            *budget -= 1;
            if self.attempt(start, corners) {
                return true;
            }
        }
        failed.insert(corners, around);
        false
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
    fn attempt(&mut self, start: Start, corners: [VertexId; 3]) -> bool {
        let mut trial = Trial { work: self, done: Vec::new(), gain: 0.0 };
        let begun = match start {
            Start::Nothing => Some(corners.to_vec()),
            Start::Swap([a, b]) => trial.work.brep.topology.edge_between(a, b).and_then(|e| trial.swap(e, true)),
            Start::Split([a, b]) => trial.work.brep.topology.edge_between(a, b).and_then(|e| trial.split(e)),
        };
        if let Some(vertices) = begun {
            trial.settle(vertices);
        }
        if trial.gain > LEAST_GAIN {
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

    /// Sum of the flaws of those of some facets that are treated.
    fn flaws(&self, facets: &[FacetId]) -> f64 {
        let treated = facets.iter().filter(|&&f| self.brep.topology.has_facet(f) && self.is_treated(f));
        treated.filter_map(|&f| self.corners(f)).map(|t| flaw(&self.points(t))).sum()
    }
}

impl Trial<'_> {
    /// Moves vertices, the one with the worst angles first, and swaps edges, as long as that raises angles; then those around.
    fn settle(&mut self, vertices: Vec<VertexId>) {
        let mut waiting = vertices;
        for step in 0..STEPS {
            let patience = (step.saturating_sub(GRACE) as f64) / PATIENCE;
            if step >= GRACE && self.gain < -LARGEST_LOSS * libm::exp(-patience) {
                return;
            }
            let sharpest = waiting.iter().map(|&v| self.work.sharpest_at(v)).enumerate();
            let Some((next, worst)) = sharpest.max_by(|p, q| p.1.total_cmp(&q.1).then(q.0.cmp(&p.0))) else { return };
            if worst <= of_flawed(self.work.obtuse) {
                return;
            }
            let vertex = waiting.swap_remove(next);
            if !self.relax(vertex) {
                continue;
            }
            let mut around: Vec<VertexId> = self.work.brep.topology.neighbours(vertex).collect();
            for edge in self.work.edges_of_star(vertex) {
                if self.work.brep.topology.has_edge(edge) {
                    around.extend(self.swap(edge, false).into_iter().flatten());
                }
            }
            if self.is_undone() {
                return;
            }
            around.retain(|v| !waiting.contains(v));
            around.sort_unstable();
            around.dedup();
            waiting.extend(around);
        }
    }

    /// Whether the swap that it began with has been taken back.
    fn is_undone(&self) -> bool {
        let Some(Done::Swap(edge, [a, b])) = self.done.first() else { return false };
        self.work.brep.topology.edge_between(*a, *b) == Some(*edge)
    }

    /// Moves a vertex to the best place; whether it moved.
    fn relax(&mut self, vertex: VertexId) -> bool {
        let Some((to, _)) = self.work.ring(vertex).best_place() else { return false };
        let star = self.work.star(vertex);
        let before = self.work.flaws(&star);
        self.done.push(Done::Move(vertex, self.work.point(vertex)));
        self.work.relocate(vertex, to);
        self.gain += before - self.work.flaws(&star);
        true
    }

    /// Swaps an edge if it is legal, and good for the angles unless it is `forced`; gives the vertices around.
    fn swap(&mut self, edge: EdgeId, is_forced: bool) -> Option<Vec<VertexId>> {
        let plan = if is_forced { self.work.plan_any_swap(edge) } else { self.work.plan_swap(edge) };
        let (plan, _) = plan.filter(|(_, effect)| if is_forced { effect.is_legal() } else { effect.is_better() })?;
        if !self.is_regular(edge) {
            return None;
        }
        let before = self.work.flaws(&plan.facets);
        self.work.swap(&plan);
        self.gain += before - self.work.flaws(&plan.facets);
        self.done.push(Done::Swap(edge, plan.ends));
        Some([plan.ends, plan.opposite].concat())
    }

    /// Splits an edge; gives the new vertex and those around.
    fn split(&mut self, edge: EdgeId) -> Option<Vec<VertexId>> {
        if self.work.relative_length(edge) < SHORTEST_SPLIT || !self.is_regular(edge) {
            return None;
        }
        let (place, at) = self.work.site_of_split(edge)?;
        let facets: Vec<FacetId> = self.work.brep.topology.facets_around(edge).collect();
        let before = self.work.flaws(&facets);
        let end = self.work.brep.topology.ends(edge)[0];
        let vertex = self.work.split_at(edge, place, at)?.vertex?;
        self.gain += before - self.work.flaws(&self.work.star(vertex));
        self.done.push(Done::Split(vertex, end));
        Some(std::iter::once(vertex).chain(self.work.brep.topology.neighbours(vertex)).collect())
    }

    /// Whether the triangles at an edge face the way their surface does, so that all pieces of them have the same sense, and
    /// have it again when they are undone.
    fn is_regular(&self, edge: EdgeId) -> bool {
        let work = &self.work;
        let mut facets = work.brep.topology.facets_around(edge).filter(|&f| work.is_treated(f));
        facets.all(|f| !work.measure_facet(f).is_flipped)
    }

    /// Takes everything back, last first.
    fn undo(self) {
        for done in self.done.into_iter().rev() {
            match done {
                Done::Move(vertex, from) => self.work.relocate(vertex, from),
                Done::Swap(edge, _) => {
                    let plan = self.work.brep.plan_swap(edge);
                    debug_assert!(plan.is_ok(), "a swap can be undone");
                    plan.into_iter().for_each(|plan| _ = self.work.swap(&plan));
                }
                Done::Split(vertex, end) => {
                    let edge = self.work.brep.topology.edge_between(vertex, end);
                    let plan = edge.and_then(|e| self.work.brep.plan_collapse(e, vertex).ok());
                    debug_assert!(plan.is_some(), "a split can be undone");
                    plan.into_iter().for_each(|plan| _ = self.work.collapse(&plan));
                }
            }
        }
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
                if work.attempt(start, corners) {
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
