//! Operations on the triangles of a small place, kept together if their angles gain, else undone.

use super::quality::of_flawed;
use super::sight::Sight;
use super::workpiece::Workpiece;
use crate::brep::store::EdgeId;
use crate::geom::Vec3;
use crate::ids::{FacetId, VertexId};

/// Vertices looked at in a trial.
const STEPS: usize = 20;
/// Flaws by which a trial may exceed those before; after `GRACE` steps, less by the factor e every `PATIENCE` steps. Giving up
/// earlier saves a third of the time, and loses one in twenty of the trials that succeed.
const LARGEST_LOSS: f64 = 1.0;
const GRACE: usize = 3;
const PATIENCE: f64 = 4.0;
/// Splitting an edge shorter than this many wanted lengths makes triangles that are too small (with 0.9 half more wide angles
/// stay, with 0.5 it is no better).
const SHORTEST_SPLIT: f64 = 0.7;

/// Rings around an edge in which strain is lessened, and how often at most the vertices there are looked at.
const EASED_RINGS: usize = 2;
const SWEEPS: usize = 12;
/// The sweep, counted from 0, from whose end on something has to be gained: what helps at all does so soon (with 5 the results
/// are the same).
const HOPEFUL: usize = 1;

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
pub(super) struct Trial<'a> {
    pub work: &'a mut Workpiece,
    done: Vec<Done>,
    /// Sum of the flaws done away with.
    pub gain: f64,
    /// An edge or triangle that a vertex sees too wide, which is a flaw, too, as long as it is there.
    sight: Option<Sight>,
}

impl<'a> Trial<'a> {
    pub fn new(work: &'a mut Workpiece, sight: Option<Sight>) -> Self {
        Self { work, done: Vec::new(), gain: 0.0, sight }
    }

    /// Moves vertices, the one with the worst angles first, and swaps edges, as long as that raises angles; then those around.
    pub fn settle(&mut self, vertices: Vec<VertexId>) {
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
        self.relocate(vertex, to);
        true
    }

    /// Lessens the strain around some vertices: each in turn goes where it is least.
    pub fn ease(&mut self, vertices: Vec<VertexId>) {
        let mut around = vertices;
        for _ in 0..EASED_RINGS {
            let next: Vec<VertexId> = around.iter().flat_map(|&v| self.work.brep.topology.neighbours(v)).collect();
            around.extend(next);
            around.sort_unstable();
            around.dedup();
        }
        // Where nothing around has moved since, a vertex stays.
        let mut is_waiting = vec![true; around.len()];
        for sweep in 0..SWEEPS {
            for k in 0..around.len() {
                if !std::mem::take(&mut is_waiting[k]) {
                    continue;
                }
                let vertex = around[k];
                let sight = self.sight.filter(|s| s.vertices().contains(&vertex));
                let place = |to: &Vec3, v: VertexId| if v == vertex { *to } else { self.work.point(v) };
                let more = |to: &Vec3| sight.map_or(0.0, |s| s.strain(|v| place(to, v)));
                let Some(to) = self.work.ring(vertex).easiest_place(more) else { continue };
                self.relocate(vertex, to);
                is_waiting[k] = true;
                let seen = sight.map_or(Vec::new(), |s| s.vertices());
                for v in self.work.brep.topology.neighbours(vertex).chain(seen) {
                    around.binary_search(&v).into_iter().for_each(|n| is_waiting[n] = true);
                }
            }
            let is_done = !is_waiting.contains(&true);
            if is_done || sweep >= HOPEFUL && self.gain <= 0.0 {
                return;
            }
        }
    }

    fn relocate(&mut self, vertex: VertexId, to: Vec3) {
        let star = self.work.star(vertex);
        let before = self.flaws(&star);
        self.done.push(Done::Move(vertex, self.work.point(vertex)));
        self.work.relocate(vertex, to);
        self.gain += before - self.flaws(&star);
    }

    /// Sum of the flaws of some facets, and of what is in sight.
    fn flaws(&self, facets: &[FacetId]) -> f64 {
        self.work.flaws(facets) + self.sight.map_or(0.0, |s| s.flaw(|v| self.work.point(v)))
    }

    /// Swaps an edge if it is legal, and good for the angles unless it is `forced`; gives the vertices around.
    pub fn swap(&mut self, edge: EdgeId, is_forced: bool) -> Option<Vec<VertexId>> {
        let plan = if is_forced { self.work.plan_any_swap(edge) } else { self.work.plan_swap(edge) };
        let (plan, _) = plan.filter(|(_, effect)| if is_forced { effect.is_legal() } else { effect.is_better() })?;
        if !self.is_regular(edge) || self.work.would_lengthen(edge, plan.opposite) {
            return None;
        }
        let before = self.work.flaws(&plan.facets);
        self.work.swap(&plan);
        self.gain += before - self.work.flaws(&plan.facets);
        self.done.push(Done::Swap(edge, plan.ends));
        Some([plan.ends, plan.opposite].concat())
    }

    /// Splits an edge; gives the new vertex and those around.
    pub fn split(&mut self, edge: EdgeId) -> Option<Vec<VertexId>> {
        if self.work.relative_length(edge) < SHORTEST_SPLIT || !self.is_regular(edge) {
            return None;
        }
        let (place, at) = self.work.site_of_split(edge)?;
        let facets: Vec<FacetId> = self.work.brep.topology.facets_around(edge).collect();
        let before = self.work.flaws(&facets);
        let ends = self.work.brep.topology.ends(edge);
        let vertex = self.work.split_at(edge, place, at)?.vertex?;
        self.gain += before - self.work.flaws(&self.work.star(vertex));
        if let Some(sight) = self.sight.take_if(|s| s.base.iter().all(|v| ends.contains(v))) {
            self.gain += sight.flaw(|v| self.work.point(v));
        }
        self.done.push(Done::Split(vertex, ends[0]));
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
    pub fn undo(self) {
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
