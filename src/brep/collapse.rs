//! Collapse of an edge: the link condition for facets of any number of corners, feature curves and several regions (after Dey,
//! Edelsbrunner, Guha and Nekhayev, *Topology preserving edge contraction*, 1999), and the contraction itself.

use super::local::{Collapse, Refusal, Touched};
use super::model::Brep;
use super::store::{EdgeId, FinId};
use crate::ids::{FacetId, VertexId};

impl Brep {
    /// Whether `edge` can be contracted onto its other end so that `gone` disappears, and what that would do. `gone` may lie on
    /// one feature curve if the edge does, too; never on a corner.
    ///
    /// # Errors
    /// `Feature`, `Link`, `TooSmall`.
    pub fn plan_collapse(&self, edge: EdgeId, gone: VertexId) -> Result<Collapse, Refusal> {
        let topology = &self.topology;
        let kept = topology.other_end(edge, gone);
        self.check_curve(edge, gone)?;
        let mut plan = Collapse { edge, gone, kept, removed: Vec::new(), changed: Vec::new() };
        let mut apexes = Vec::new();
        for fin in topology.fins_around(edge) {
            let facet = topology.facet_of(fin);
            if topology.triangle(facet).is_some() {
                apexes.push(topology.fin_ends(topology.prev_fin(fin))[0]);
                plan.removed.push(facet);
            } else if topology.fins_from(fin).nth(3).is_none() {
                return Err(Refusal::TooSmall);
            }
        }
        apexes.sort_unstable();
        self.check_common(edge, gone, kept)?;
        self.check_link(gone, kept, &apexes)?;
        for &apex in &apexes {
            let both = [gone, kept].map(|v| topology.edge_between(v, apex));
            let is_thin = |e: &Option<EdgeId>| e.is_none_or(|e| topology.ring_len(e) < 2);
            if both.iter().any(is_thin) {
                return Err(Refusal::Link);
            }
            if both.iter().flatten().all(|&e| self.is_feature(e)) {
                return Err(Refusal::Feature);
            }
        }
        if topology.would_pinch(edge) {
            return Err(Refusal::Link);
        }
        plan.changed = topology.facets_at(gone).filter(|facet| !plan.removed.contains(facet)).collect();
        plan.changed.sort_unstable();
        plan.changed.dedup();
        Ok(plan)
    }

    /// A vertex of a feature curve goes only along it.
    fn check_curve(&self, edge: EdgeId, gone: VertexId) -> Result<(), Refusal> {
        let curves: Vec<EdgeId> = self.topology.edges_at(gone).filter(|&at| self.is_feature(at)).collect();
        let is_free = match curves.len() {
            0 => true,
            2 => curves.contains(&edge),
            _ => false,
        };
        if is_free && self.topology.lone_fins(gone).next().is_none() { Ok(()) } else { Err(Refusal::Feature) }
    }

    /// A facet at both ends must be at the edge, and touch itself no more often afterwards: of its corners at the two ends,
    /// those joined by the edge become one. (It is at the edge twice if the edge, or a chain that it belongs to, lies inside
    /// it.)
    fn check_common(&self, edge: EdgeId, gone: VertexId, kept: VertexId) -> Result<(), Refusal> {
        let sorted = |iter: &mut dyn Iterator<Item = FacetId>| {
            let mut facets: Vec<FacetId> = iter.collect();
            facets.sort_unstable();
            facets
        };
        let [here, there] = [gone, kept].map(|v| sorted(&mut self.topology.facets_at(v)));
        let around = sorted(&mut self.topology.facets_around(edge));
        let times = |list: &[FacetId], facet| list.partition_point(|&f| f <= facet) - list.partition_point(|&f| f < facet);
        let is_fine = here.iter().all(|&facet| {
            let (h, t, joined) = (times(&here, facet), times(&there, facet), times(&around, facet));
            t == 0 || joined > 0 && h + t <= joined + h.max(t)
        });
        if is_fine { Ok(()) } else { Err(Refusal::Link) }
    }

    /// Common neighbours are exactly the triangles' third corners, and no two facets, one at each end, lie between the same two
    /// of them.
    fn check_link(&self, gone: VertexId, kept: VertexId, apexes: &[VertexId]) -> Result<(), Refusal> {
        let topology = &self.topology;
        let mut here: Vec<VertexId> = topology.neighbours(gone).collect();
        here.sort_unstable();
        let mut common: Vec<VertexId> = topology.neighbours(kept).filter(|v| here.binary_search(v).is_ok()).collect();
        common.sort_unstable();
        if common != apexes {
            return Err(Refusal::Link);
        }
        let wedges = |vertex: VertexId| {
            let ends = topology.fins_at(vertex).map(|fin| [topology.prev_fin(fin), fin]);
            let between = ends.map(|[p, f]| [topology.fin_ends(p)[0], topology.fin_ends(f)[1]]);
            let mut wedges: Vec<[VertexId; 2]> = between
                .filter(|w| w.iter().all(|v| apexes.binary_search(v).is_ok()))
                .map(|[a, b]| if a < b { [a, b] } else { [b, a] })
                .collect();
            wedges.sort_unstable();
            wedges
        };
        let [here, there] = [gone, kept].map(wedges);
        if here.iter().any(|w| there.binary_search(w).is_ok()) { Err(Refusal::Link) } else { Ok(()) }
    }

    /// Contracts an edge: one KEV, one KEF per triangle at the edge. The kept vertex does not move; of the two edges of a
    /// triangle that become one, that of the kept vertex stays.
    pub fn collapse(&mut self, plan: &Collapse) -> Touched {
        let topology = &mut self.topology;
        let &Collapse { edge, gone, kept, .. } = plan;
        let mut touched = Touched { vertex: Some(kept), removed_facets: plan.removed.clone(), ..Touched::default() };
        touched.removed_edges.push(edge);
        let mut keep: Vec<FinId> = Vec::with_capacity(plan.removed.len());
        for fin in topology.fins_around(edge) {
            if !plan.removed.contains(&topology.facet_of(fin)) {
                continue;
            }
            let [next, prev] = [topology.next_fin(fin), topology.prev_fin(fin)];
            let [stays, goes] = if topology.fin_ends(fin)[1] == kept { [next, prev] } else { [prev, next] };
            keep.push(stays);
            touched.removed_edges.extend(topology.edge_of(goes));
        }
        let mut done = topology.kev(edge, kept);
        for fin in keep {
            done = done.and_then(|()| topology.kef_digon(fin));
        }
        debug_assert_eq!(done, Ok(()), "stale plan");
        for &facet in &plan.changed {
            self.rename_tiles(facet, gone, kept);
        }
        touched.edges = self.topology.edges_at(kept).collect();
        touched.facets.clone_from(&plan.changed);
        touched
    }

    fn rename_tiles(&mut self, facet: FacetId, gone: VertexId, kept: VertexId) {
        let is_triangle = self.topology.triangle(facet).is_some();
        let tiles = &mut self.facets[facet].tiles;
        if is_triangle {
            *tiles = Vec::new();
            return;
        }
        tiles.retain(|tile| !(tile.contains(&gone) && tile.contains(&kept)));
        for vertex in tiles.iter_mut().flatten() {
            if *vertex == gone {
                *vertex = kept;
            }
        }
    }
}
