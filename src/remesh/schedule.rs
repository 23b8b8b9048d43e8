//! The order of the work: a queue picks the next edge (thesis 6.2) instead of the sweeps of Table 4.1.

use super::operators::Effect;
use super::quality::{MOST_OBTUSE, cosine_of_degrees};
use super::relocate::Aim;
use super::sizing::{Limits, NARROWEST};
use super::workpiece::{Place, Workpiece};
use crate::brep::local::Touched;
use crate::brep::store::EdgeId;
use crate::geom::Vec3;
use crate::ids::{FacetId, Id, VertexId};
use std::collections::{BinaryHeap, HashMap};

/// Edges longer than this many wanted lengths are split, shorter than that collapsed. Their ratio is two, so that neither
/// undoes the other.
pub(super) const LONG: f64 = 1.4;
pub(super) const SHORT: f64 = 0.7;

/// Urgency of an edge across the rulings of its surface, against one that is straight there: a diagonal of a long strip is
/// swapped to a short one once the rulings beside it are split, while splitting it first puts vertices inside the strip.
const ACROSS: f64 = 0.5;

/// How much longer than before an edge that is too long already may get by a collapse beside it.
const STRETCH: f64 = 1.1;

/// Rounds of split, collapse, swap and relocate; shape and size hardly change after four.
const ROUNDS: usize = 5;

/// Angles in degrees: what a collapse for size may leave, and what one that thins out must keep.
const ROUGH: f64 = 15.0;
const THIN_KEEPS: f64 = 40.0;

/// Deviation, as a multiple of the bound, that a collapse for size may leave behind: the swaps, moves and splits that follow
/// bring it down again.
const LOOSE: f64 = 1.5;
/// What rounding may add to a deviation of just the bound; and the length, in wanted lengths, below which an edge is not split
/// for its deviation: it cannot get better there.
const EXCESS_ROUNDING: f64 = 1e-9;
const LEAST_SPLIT: f64 = 0.5;
/// Wanted length over that of the chords of a curve which stay. The chord's relative length, 0.8, is in the middle of what is
/// neither split nor collapsed.
const PER_CHORD: f64 = 1.25;
/// Way home of a vertex, in lengths of its shortest chord, past which it is sent on after the vertices beside it have gone, and
/// how often: facets beside a chord whose ends go so far one after the other would stand upright.
const FAR: f64 = 0.5;
const SETTLE_SWEEPS: usize = 8;
/// How often the ends of the halves of a chord are moved to the middle of their neighbours; then little is left to be gained.
const EVEN_STEPS: usize = 4;
/// Least drop of such a deviation for which an edge is swapped.
const LEAST_DROP: f64 = 0.05;

/// Thinning out collapses edges below this many wanted lengths as long as none above that arises; so often at most.
const THIN_BELOW: f64 = 1.1;
const THIN_ROUNDS: usize = 3;
/// The longest edges, in wanted lengths, that thinning out and the clearing at the end may make: the largest that a user
/// allows.
const THIN_LONGEST: f64 = 1.5;

/// Weights of obtuse angles: in polishing and where obtuse triangles are mended at last; in the last polish and for bends.
/// TetGen cuts edges that see an obtuse angle. Without them in the last polish, the least angles are a degree larger, and a
/// tenth more tetrahedra are needed.
const OBTUSE: [f64; 2] = [MOST_OBTUSE, 0.25];

/// How often at most, when all else is done, edges and triangles are cleared of vertices in their spheres, and below how many
/// degrees an angle may not get for it.
const LAST_ROUNDS: [f64; 4] = [37.0, 36.0, 35.0, 34.0];

/// How many of those may be left for another round, as a share of those before, or in all: where surfaces nearly touch, moves
/// help one at the cost of the next.
const WORTHWHILE: f64 = 0.9;
const FEW: f64 = 30.0;

/// Rings of neighbours from which an edge or triangle is looked at.
const SIGHT_RINGS: usize = 2;

/// Operations per edge at most in one pass: passes end long before, this bounds them on any input.
const BUDGET_PER_EDGE: usize = 20;

/// A priority queue of ids: largest key first, then smallest id. Keys are not negative.
pub(super) struct Queue<I>(BinaryHeap<(u64, std::cmp::Reverse<I>)>);

impl<I: Id> Queue<I> {
    pub fn new() -> Self {
        Self(BinaryHeap::new())
    }
    pub fn push(&mut self, id: I, key: f64) {
        self.0.push((key.max(0.0).to_bits(), std::cmp::Reverse(id)));
    }
    pub fn pop(&mut self) -> Option<(I, f64)> {
        self.0.pop().map(|(key, id)| (id.0, f64::from_bits(key)))
    }
}

impl Workpiece {
    /// The whole remeshing of the treated facets; false if it was broken off, because facets meet where their surfaces are a
    /// guess.
    pub fn run(&mut self, limits: &Limits) -> bool {
        self.settle();
        self.settle_chains();
        for round in 0..ROUNDS {
            self.renew_sizes(limits);
            // Curves first: what lies between them adapts, and needles that still span a strip do not hold its rims.
            self.collapse_short(Reach::Curves);
            if round > 0 {
                self.fit_sizes_to_chords();
            }
            self.split_long(limits);
            self.collapse_short(Reach::All);
            self.settle();
            let edges = self.active_edges();
            self.swap_all(&edges);
            self.smooth();
            let is_early = round == 0 || round + 1 == ROUNDS;
            if is_early && self.is_hopeless(limits) {
                return false;
            }
            if round + 1 == ROUNDS {
                self.smooth();
            }
        }
        self.weigh_obtuse(OBTUSE[0]);
        self.polish();
        for _ in 0..THIN_ROUNDS {
            self.thin_out();
            self.polish();
            if self.split_deviating() == 0 {
                break;
            }
            self.polish();
        }
        // Half of the time is still to come, and longer edges may have met across a gap.
        if self.is_hopeless(limits) {
            return false;
        }
        self.weigh_obtuse(OBTUSE[1]);
        self.polish();
        self.weigh_obtuse(OBTUSE[0]);
        self.make_acute();
        self.weigh_obtuse(OBTUSE[1]);
        true
    }

    /// Clears edges and triangles of what is in their smallest spheres, and bends again.
    pub fn clear_spheres(&mut self, limits: &Limits) {
        let mut failed = HashMap::new();
        let mut around = self.active_vertices();
        let mut most = f64::INFINITY;
        for degrees in LAST_ROUNDS {
            self.small = cosine_of_degrees(degrees);
            let sights = self.sights_around(&around);
            if sights.len() as f64 > most {
                break;
            }
            most = FEW.max(WORTHWHILE * sights.len() as f64);
            let before = self.places_of_all();
            self.weigh_obtuse(OBTUSE[0]);
            let is_changed = self.clear_sights(sights, &mut failed);
            self.weigh_obtuse(OBTUSE[1]);
            if !is_changed {
                break;
            }
            // Splits may have put corners into straight edges of polygons.
            self.clear_straight_corners();
            let edges = self.moved_since(&before).into_iter().flat_map(|v| self.edges_of_star(v)).collect();
            self.clear_bends(limits, edges);
            around = self.moved_since(&before);
            for _ in 0..SIGHT_RINGS {
                let next: Vec<VertexId> = around.iter().flat_map(|&v| self.brep.topology.neighbours(v)).collect();
                around.extend(next);
                around.sort_unstable();
                around.dedup();
            }
        }
    }

    /// Where all vertices are, by number.
    fn places_of_all(&self) -> Vec<Vec3> {
        let mut places = vec![Vec3::zeros(); self.brep.topology.bounds()[0]];
        self.brep.topology.vertices().for_each(|v| places[v.index()] = self.point(v));
        places
    }

    /// Vertices that are new or somewhere else.
    fn moved_since(&self, before: &[Vec3]) -> Vec<VertexId> {
        self.brep.topology.vertices().filter(|v| before.get(v.index()) != Some(&self.point(*v))).collect()
    }

    /// Obtuse triangles count as sharp ones from here on; all measures change.
    fn weigh_obtuse(&mut self, weight: f64) {
        self.obtuse = weight;
        self.measures.iter().for_each(|m| m.set(None));
        self.history.forget();
    }

    pub fn active_edges(&self) -> Vec<EdgeId> {
        self.brep.topology.edges().filter(|&e| self.is_active(e)).collect()
    }

    /// Vertices of treated facets.
    pub fn active_vertices(&self) -> Vec<VertexId> {
        self.brep.topology.vertices().filter(|&v| self.brep.topology.facets_at(v).any(|f| self.is_treated(f))).collect()
    }

    fn renew_sizes(&mut self, limits: &Limits) {
        self.sizes = vec![f64::INFINITY; self.brep.topology.bounds()[0]];
        for v in self.active_vertices() {
            self.sizes[v.index()] = self.own_size(v, limits);
        }
        self.grade_sizes();
    }

    /// Lowers the sizes at curves whose chords are shorter than wanted, but cannot be collapsed: triangles beside them are to
    /// be as long as these are wide, as far as that makes sense: where an almost tangent cut left chords of nearly nothing, all
    /// around would be divided without end.
    fn fit_sizes_to_chords(&mut self) {
        for v in self.active_vertices() {
            if let (Place::Curve(_), Some(chord)) = (self.place(v), self.chord_near(v)) {
                let size = self.sizes[v.index()];
                self.sizes[v.index()] = size.min((PER_CHORD * chord).max(NARROWEST * size));
            }
        }
        self.grade_sizes();
    }

    /// Length of the chords about a vertex of a curve: of its longer one, or the mean with the next ones on both sides if that
    /// is more. Halves of a chord among whole ones would keep their size for themselves, and two triangles beside the vertex
    /// between them one right angle each.
    fn chord_near(&self, vertex: VertexId) -> Option<f64> {
        let own: Vec<EdgeId> = self.chords_at(vertex).collect();
        let ends = own.iter().map(|&e| self.brep.topology.other_end(e, vertex));
        let next = ends.filter(|&v| matches!(self.place(v), Place::Curve(_))).flat_map(|v| self.chords_at(v));
        let mut all: Vec<EdgeId> = own.iter().copied().chain(next).collect();
        all.sort_unstable();
        all.dedup();
        let longest = own.iter().map(|&e| self.length(e)).reduce(f64::max)?;
        Some(longest.max(all.iter().map(|&e| self.length(e)).sum::<f64>() / all.len() as f64))
    }

    /// The feature edges at a vertex.
    fn chords_at(&self, vertex: VertexId) -> impl Iterator<Item = EdgeId> + '_ {
        self.brep.topology.edges_at(vertex).filter(|&e| self.brep.is_feature(e))
    }

    /// All edges of some facets.
    pub fn edges_of(&self, facets: &[FacetId]) -> Vec<EdgeId> {
        let topology = &self.brep.topology;
        let live = facets.iter().filter(|&&f| topology.has_facet(f) && self.is_treated(f));
        live.flat_map(|&f| topology.fins_of_facet(f)).filter_map(|fin| topology.edge_of(fin)).collect()
    }

    fn split_long(&mut self, limits: &Limits) {
        let mut queue = Queue::new();
        let edges = self.active_edges();
        let mut budget = BUDGET_PER_EDGE * edges.len() + 100_000;
        for e in edges {
            self.enqueue_long(&mut queue, e);
        }
        while let Some((edge, key)) = queue.pop() {
            if !self.brep.topology.has_edge(edge) || self.urgency(edge) != key || budget == 0 {
                continue;
            }
            budget -= 1;
            let Some(touched) = self.split(edge) else { continue };
            if let Some(v) = touched.vertex {
                let size = self.own_size(v, limits);
                self.sizes[v.index()] = self.sizes[v.index()].min(size);
            }
            let around = self.swap_around(&touched);
            for e in around {
                self.enqueue_long(&mut queue, e);
            }
        }
    }

    fn enqueue_long(&self, queue: &mut Queue<EdgeId>, edge: EdgeId) {
        if self.relative_length(edge) > LONG && self.is_active(edge) {
            queue.push(edge, self.urgency(edge));
        }
    }

    /// How much a long edge asks to be split.
    fn urgency(&self, edge: EdgeId) -> f64 {
        let length = self.relative_length(edge);
        if self.brep.is_feature(edge) {
            return length;
        }
        let [a, b] = self.brep.topology.ends(edge).map(|v| self.point(v));
        let support = self.brep.topology.facets_around(edge).find(|&f| self.is_treated(f)).and_then(|f| self.support(f));
        let is_straight = support.is_none_or(|s| s.is_straight_along(&s.closest(&((a + b) * 0.5)), &(b - a)));
        if is_straight { length } else { ACROSS * length }
    }

    /// Swaps what an operation made swappable; gives all edges around.
    fn swap_around(&mut self, touched: &Touched) -> Vec<EdgeId> {
        let edges = self.edges_of(&touched.facets);
        let mut all = self.swap_all(&edges);
        all.extend(edges);
        all.sort_unstable();
        all.dedup();
        all.retain(|&e| self.brep.topology.has_edge(e));
        all
    }

    /// Swaps edges as long as that raises the smallest angle or the deviation shrinks to the bound; gives the edges changed.
    pub fn swap_all(&mut self, edges: &[EdgeId]) -> Vec<EdgeId> {
        let rough = cosine_of_degrees(ROUGH);
        let mut stack: Vec<EdgeId> = edges.to_vec();
        let mut budget = BUDGET_PER_EDGE * stack.len() + 100;
        let mut changed = Vec::new();
        while let Some(edge) = stack.pop() {
            if !self.brep.topology.has_edge(edge) || budget == 0 {
                continue;
            }
            let Some((plan, effect)) = self.plan_swap(edge) else { continue };
            let rescues = effect.before.is_flipped && !effect.after.is_flipped;
            let flattens = effect.before.excess > 1.0
                && !effect.after.is_flipped
                && effect.after.excess < effect.before.excess - LEAST_DROP
                && effect.after.cosine <= effect.before.cosine.max(rough);
            if effect.is_better() || rescues || flattens {
                budget -= 1;
                let touched = self.swap(&plan);
                let around = self.edges_of(&touched.facets);
                changed.extend(around.iter().copied());
                stack.extend(around);
            }
        }
        changed
    }

    /// Collapses edges that are too short, shortest first.
    fn collapse_short(&mut self, reach: Reach) {
        let rough = cosine_of_degrees(ROUGH);
        let limit = |me: &Self, gone| me.sharpest_at(gone).max(rough);
        self.collapse_while(SHORT, LONG, reach, limit, |effect, is_inner| {
            let allowed = if is_inner { LOOSE } else { 1.0 };
            !effect.after.is_flipped
                && effect.after.excess <= effect.before.excess.max(allowed)
                && effect.after.cosine <= effect.before.cosine.max(rough)
        });
    }

    /// Collapses edges, shortest first, as long as shape and deviation stay good: no more triangles than needed.
    fn thin_out(&mut self) {
        let keep = cosine_of_degrees(THIN_KEEPS);
        self.collapse_while(
            THIN_BELOW,
            THIN_LONGEST,
            Reach::All,
            |_, _| keep,
            |effect, _| effect.is_legal() && effect.after.excess <= 1.0 && effect.after.cosine <= keep,
        );
    }

    /// Collapses edges shorter than `below` wanted lengths, unless an edge longer than `longest` or an angle with a cosine past
    /// `limit` would arise.
    fn collapse_while(
        &mut self,
        below: f64,
        longest: f64,
        reach: Reach,
        limit: impl Fn(&Self, VertexId) -> f64,
        accept: impl Fn(&Effect, bool) -> bool,
    ) {
        let mut queue = Queue::new();
        let edges = self.active_edges();
        let mut budget = BUDGET_PER_EDGE * edges.len() + 100;
        let enqueue = |me: &Self, queue: &mut Queue<EdgeId>, e: EdgeId| {
            let length = me.relative_length(e);
            if length < below && me.is_active(e) && (reach == Reach::All || me.brep.is_feature(e)) {
                queue.push(e, below - length);
            }
        };
        for e in edges {
            enqueue(self, &mut queue, e);
        }
        while let Some((edge, key)) = queue.pop() {
            let is_stale = !self.brep.topology.has_edge(edge) || below - self.relative_length(edge) != key;
            if is_stale || budget == 0 {
                continue;
            }
            budget -= 1;
            let [a, b] = self.brep.topology.ends(edge);
            let is_inner = |v| matches!(self.place(v), Place::Surface(_));
            let plans =
                [a, b].map(|gone| self.plan_collapse(edge, gone, limit(self, gone)).filter(|p| accept(&p.1, is_inner(gone))));
            let best = plans.into_iter().flatten().min_by(|p, q| p.1.after.cosine.total_cmp(&q.1.after.cosine));
            let Some((plan, _)) = best else { continue };
            if self.would_stretch(plan.gone, plan.kept, longest) {
                continue;
            }
            let touched = self.collapse(&plan);
            for e in self.swap_around(&touched) {
                enqueue(self, &mut queue, e);
            }
        }
    }

    /// Whether merging a vertex into another makes an edge longer than `longest` wanted lengths and than those before.
    pub fn would_stretch(&self, gone: VertexId, kept: VertexId, longest: f64) -> bool {
        let (from, to) = (self.point(gone), self.point(kept));
        self.brep.topology.neighbours(gone).filter(|&n| n != kept).any(|n| {
            let size = 0.5 * (self.sizes[n.index()] + self.sizes[kept.index()]);
            let length = (self.point(n) - to).norm();
            length > longest * size && length > STRETCH * (self.point(n) - from).norm()
        })
    }

    /// Whether an edge between two vertices would be longer than one that it replaces, and than any should be.
    pub fn would_lengthen(&self, replaced: EdgeId, [a, b]: [VertexId; 2]) -> bool {
        let length = (self.point(a) - self.point(b)).norm();
        let size = 0.5 * (self.sizes[a.index()] + self.sizes[b.index()]);
        length > THIN_LONGEST * size && length > self.length(replaced)
    }

    /// Brings every vertex onto its curve or surface, as far as nothing flips.
    fn settle(&mut self) {
        for v in self.active_vertices() {
            self.relocate_towards(v, Aim::Home);
        }
    }

    /// Brings vertices home that the chords beside them held back.
    fn settle_chains(&mut self) {
        let mut left = self.active_vertices();
        for _ in 0..SETTLE_SWEEPS {
            left.retain(|&v| self.is_far(v) && self.relocate_towards(v, Aim::Home));
        }
    }

    /// Whether a vertex of features is further from home than its chords are long.
    fn is_far(&self, vertex: VertexId) -> bool {
        let shortest = self.chords_at(vertex).map(|e| self.length(e)).fold(f64::INFINITY, f64::min);
        self.true_place(vertex).is_some_and(|home| (home - self.point(vertex)).norm() > FAR * shortest)
    }

    /// Moves every vertex to the middle of its neighbours.
    fn smooth(&mut self) {
        for v in self.active_vertices() {
            self.relocate_towards(v, Aim::Middle);
        }
    }

    /// Splits edges that are further from their curve or surface than allowed, and the longest ones of triangles that are; how
    /// many.
    fn split_deviating(&mut self) -> usize {
        let mut count = 0;
        for edge in self.active_edges() {
            let deviates = self.brep.topology.has_edge(edge)
                && self.relative_length(edge) > LEAST_SPLIT
                && (self.edge_excess(edge) > 1.0 + EXCESS_ROUNDING || self.is_longest_of_deviating(edge));
            if let Some(touched) = deviates.then(|| self.split(edge)).flatten() {
                touched.vertex.into_iter().for_each(|v| self.even_out(v));
                self.swap_around(&touched);
                count += 1;
            }
        }
        count
    }

    /// Makes the chords about a new vertex of a curve about as long as their neighbours are.
    fn even_out(&mut self, vertex: VertexId) {
        if !matches!(self.place(vertex), Place::Curve(_)) {
            return;
        }
        let ends: Vec<VertexId> = self.chords_at(vertex).map(|e| self.brep.topology.other_end(e, vertex)).collect();
        for v in (0..EVEN_STEPS).flat_map(|_| ends.iter().copied().chain([vertex])) {
            self.relocate_towards(v, Aim::Middle);
        }
    }

    /// Whether a triangle of which this is the longest edge is further from its surface than allowed.
    fn is_longest_of_deviating(&self, edge: EdgeId) -> bool {
        let length = self.length(edge);
        let mut facets = self.brep.topology.facets_around(edge).filter(|&f| self.is_treated(f));
        facets.any(|f| {
            self.measure_facet(f).excess > 1.0 + EXCESS_ROUNDING
                && self.edges_of(&[f]).iter().all(|&e| self.length(e) <= length)
        })
    }

    /// Deviation of the middle of an edge from its curve, or from its surface, as a fraction of the bound.
    pub fn edge_excess(&self, edge: EdgeId) -> f64 {
        let [a, b] = self.brep.topology.ends(edge).map(|v| self.point(v));
        if let Some(c) = self.curve_of(edge) {
            return self.curve_excess(c, &a, &b);
        }
        let middle = (a + b) * 0.5;
        let facet = self.brep.topology.facets_around(edge).find(|&f| self.is_treated(f));
        facet.and_then(|f| Some((f, self.support(f)?))).map_or(0.0, |(f, support)| {
            let foot = support.nearest(&middle);
            (foot.point - middle).norm() / (self.bound_on(f).along(foot.curvature) * self.share(f))
        })
    }

    /// Whether a vertex may move at all.
    pub fn is_movable(&self, vertex: VertexId) -> bool {
        self.place(vertex) != Place::Corner
    }
}

/// Which edges are collapsed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Reach {
    Curves,
    All,
}
