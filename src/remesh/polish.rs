//! Polish: the worst triangles first, each by the operator that helps it most.

use super::operators::{Effect, raised};
use super::quality::cosine_of_degrees;
use super::schedule::{LONG, Queue, SHORT};
use super::workpiece::Workpiece;
use crate::brep::local::{Collapse, Swap};
use crate::geom::Vec3;
use crate::ids::{FacetId, VertexId};

/// Angle in degrees that polishing aims at.
const GOAL: f64 = 41.0;

/// Repairs of one triangle at most, on average, in one polish.
const MENDS_PER_FACET: usize = 8;

/// How a triangle can be mended.
enum Mend {
    Swap(Swap),
    Collapse(Collapse),
    Move(VertexId, Vec3),
}

impl Workpiece {
    /// Improves the worst triangles, worst first, by whichever operator raises their smallest angle most.
    pub fn polish(&mut self) {
        let goal = cosine_of_degrees(GOAL);
        let mut queue = Queue::new();
        let facets: Vec<FacetId> = self.brep.topology.facets().filter(|&f| self.is_treated(f)).collect();
        let mut budget = MENDS_PER_FACET * facets.len() + 100;
        for f in facets {
            let is_new = self.corners(f).is_some_and(|t| t.iter().any(|&v| self.history.is_new(v)));
            if is_new {
                self.enqueue_poor(&mut queue, f, goal);
            }
        }
        self.history.start_polish();
        while let Some((facet, key)) = queue.pop() {
            let is_stale = !self.brep.topology.has_facet(facet) || !self.is_treated(facet) || self.sharpest(facet) != key;
            if is_stale || budget == 0 {
                continue;
            }
            if self.corners(facet).is_some_and(|t| self.history.is_hopeless(facet, t)) {
                continue;
            }
            budget -= 1;
            let changed = self.mend(facet);
            if changed.is_empty() {
                self.history.give_up(facet);
            }
            for f in changed {
                if self.brep.topology.has_facet(f) && self.is_treated(f) {
                    self.enqueue_poor(&mut queue, f, goal);
                }
            }
        }
    }

    fn enqueue_poor(&self, queue: &mut Queue<FacetId>, facet: FacetId, goal: f64) {
        let cosine = self.sharpest(facet);
        if cosine > goal {
            queue.push(facet, cosine);
        }
    }

    /// Improves one triangle; gives the facets around if it did.
    fn mend(&mut self, facet: FacetId) -> Vec<FacetId> {
        let Some(corners) = self.corners(facet) else { return Vec::new() };
        let edges = self.edges_of(&[facet]);
        let sharpest = corners.map(|v| self.sharpest_at(v));
        let mut still = Vec::new();
        let mut best: Option<(f64, Mend)> = None;
        let mut consider = |effect: &Effect, what: Mend| {
            if effect.is_better() && best.as_ref().is_none_or(|b| effect.after.cosine < b.0) {
                best = Some((effect.after.cosine, what));
            }
        };
        for &edge in &edges {
            if let Some((plan, effect)) = self.plan_swap(edge) {
                consider(&effect, Mend::Swap(plan));
            }
            for gone in self.brep.topology.ends(edge) {
                let limit = corners.iter().position(|&v| v == gone).map_or(0.0, |k| raised(sharpest[k]));
                if let Some((plan, effect)) = self.plan_collapse(edge, gone, limit)
                    && !self.would_stretch(plan.gone, plan.kept, LONG)
                {
                    consider(&effect, Mend::Collapse(plan));
                }
            }
        }
        for vertex in corners {
            if self.history.is_kept(vertex) {
                continue;
            }
            match self.ring(vertex).best_place() {
                Some((to, effect)) => consider(&effect, Mend::Move(vertex, to)),
                None => still.push(vertex),
            }
        }
        for vertex in still {
            self.history.keep(vertex);
        }
        match best {
            None => self.try_split(facet),
            Some((_, Mend::Swap(plan))) => self.swap(&plan).facets,
            Some((_, Mend::Collapse(plan))) => self.collapse(&plan).facets,
            Some((_, Mend::Move(vertex, to))) => {
                self.relocate(vertex, to);
                self.star(vertex)
            }
        }
    }

    /// Splits the longest edge of a triangle if the new vertex finds a place where all triangles around are better than those
    /// before.
    fn try_split(&mut self, facet: FacetId) -> Vec<FacetId> {
        let longest = self.edges_of(&[facet]).into_iter().max_by(|&a, &b| self.length(a).total_cmp(&self.length(b)));
        let Some(edge) = longest.filter(|&e| self.relative_length(e) > SHORT) else { return Vec::new() };
        let Some((place, at)) = self.site_of_split(edge) else { return Vec::new() };
        let around: Vec<FacetId> = self.brep.topology.facets_around(edge).filter(|&f| self.is_treated(f)).collect();
        let before = self.worst(&around);
        let ring = self.ring_of_split(edge, place, at);
        let (at, after) = ring.best_place().map_or((at, ring.before), |(to, effect)| (to, effect.after));
        drop(ring);
        if !(Effect { before, after }).is_better() {
            return Vec::new();
        }
        let vertex = self.split_at(edge, place, at).and_then(|t| t.vertex);
        vertex.map_or_else(Vec::new, |v| self.star(v))
    }
}
