//! The four local operators: each tests legality, applies, and reports what it touched (thesis Table 4.1).
//!
//! Common rules: no triangle flips or leaves the allowed deviation further than its predecessors did, planar facets stay
//! simple, freedoms are respected. What else an operation must improve is up to the caller.

use super::polygons::Change;
use super::quality::{WORST, is_sharper, sharpest_cosine};
use super::straight::TRACE;
use super::workpiece::{CurveId, Measure, Place, Workpiece, sorted};
use crate::brep::complex::ComplexVertex;
use crate::brep::local::{Collapse, Swap, Touched};
use crate::brep::store::EdgeId;
use crate::geom::Vec3;
use crate::ids::{FacetId, Id, VertexId};
use crate::patch::curve::Curve;
use crate::primitive::solid::Freedom;

/// Least gain, in the cosine of the smallest angle (a quarter of a degree), for which an angle is raised: without it, a patch
/// would creep towards its best shape in endless tiny steps. For needles, of less than 10 degrees, a tenth of the angle: then 1
/// - cosine grows by a fifth. The same for angles near 180 degrees, where shapes end at [`WORST`].
const LEAST_GAIN: f64 = 3e-3;
const NEEDLE_GAIN: f64 = 0.2;

/// Longest piece of an edge that a split may leave, so that splitting comes to an end: then no piece is shorter than a tenth,
/// either. Sites lie at a third to a half, and on the arc above them; but beside the end of a surface that is a guess, or of an
/// edge that stands away from its surface, the nearest point may be at an end or beyond, and the same edge would come back
/// again and again.
const LONGEST_PIECE: f64 = 0.9;

/// The cosine of the smallest angle past which an angle is raised.
pub(super) fn raised(cosine: f64) -> f64 {
    let end = if cosine < 1.0 { 1.0 } else { WORST };
    cosine - LEAST_GAIN.min(NEEDLE_GAIN * (end - cosine))
}

/// What an operation would do to quality.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Effect {
    /// The worst of the triangles there are.
    pub before: Measure,
    /// The worst of the triangles there would be.
    pub after: Measure,
}

impl Effect {
    /// Nothing flips, and the deviation is within the bound or not worse than it was.
    pub fn is_legal(&self) -> bool {
        !self.after.is_flipped && self.after.excess <= self.before.excess.max(1.0)
    }
    /// Legal, and the smallest angle rises.
    pub fn is_better(&self) -> bool {
        self.is_legal() && self.after.cosine < raised(self.before.cosine)
    }
}

/// Split.
impl Workpiece {
    /// Splits an edge near the middle, on its true curve or surface if it can, and says what was touched; `None` if it would
    /// harm a polygon or flip a triangle.
    pub fn split(&mut self, edge: EdgeId) -> Option<Touched> {
        let (place, at) = self.site_of_split(edge)?;
        self.split_at(edge, place, at)
    }

    /// Kind and place of the vertex that would split an edge.
    pub fn site_of_split(&mut self, edge: EdgeId) -> Option<(Place, Vec3)> {
        let ends = self.brep.topology.ends(edge);
        let [a, b] = ends.map(|v| self.point(v));
        let middle = a + (b - a) * self.share_of_split(edge);
        let around: Vec<FacetId> = self.brep.topology.facets_around(edge).collect();
        let treated: Vec<FacetId> = around.iter().copied().filter(|&f| self.is_treated(f)).collect();
        let surface = self.brep.facets[*treated.first()?].surface;
        let strip = around.iter().copied().find(|&f| self.is_strip(f));
        let curve = match strip {
            // Strips stay planar: only their rulings may be split.
            Some(strip) => Some(self.ruling_of(edge, strip)?),
            None => self.curve_of(edge),
        };
        let place = match curve {
            Some(c) => Place::Curve(c),
            None if self.brep.is_feature(edge) => return None,
            None => Place::Surface(surface),
        };
        let home = self.home_of(place, &middle);
        let allowed = |at: &Vec3| {
            treated.iter().all(|&f| self.split_keeps_sense(f, ends, at, *at == middle))
                && around
                    .iter()
                    .filter(|f| !treated.contains(f))
                    .all(|&f| self.polygon_stays_simple(f, Change::Insert { ends, at: *at }))
        };
        let longest = LONGEST_PIECE * (b - a).norm();
        let shortens = |at: &Vec3| (at - a).norm() < longest && (at - b).norm() < longest;
        let at = [home, middle].into_iter().find(|at| shortens(at) && allowed(at))?;
        Some((place, at))
    }

    /// Where to split an edge: in the middle, but a chord of a curved feature so that, split again, its pieces become equal and
    /// as long as wanted. Straight ones are halved as the rulings beside them are: their vertices make rows.
    fn share_of_split(&self, edge: EdgeId) -> f64 {
        let is_bent = self.curve_of(edge).is_some_and(|c| !matches!(self.curves[c], Curve::Line { .. }));
        let pieces = if is_bent { self.relative_length(edge).round().max(2.0) } else { 2.0 };
        (pieces * 0.5).floor() / pieces
    }

    /// Splits an edge at such a site.
    pub fn split_at(&mut self, edge: EdgeId, place: Place, at: Vec3) -> Option<Touched> {
        let freedom = if matches!(place, Place::Curve(_)) { Freedom::Edge } else { Freedom::Surface };
        let ends = self.brep.topology.ends(edge);
        let treated: Vec<FacetId> = self.brep.topology.facets_around(edge).filter(|&f| self.is_treated(f)).collect();
        let senses: Vec<f64> = treated.iter().map(|f| self.sense[f.index()]).collect();
        let sources: Vec<_> = treated.iter().map(|&f| self.brep.facets[f].surface).collect();
        let flags = &self.is_treated;
        let touched = self
            .brep
            .split_edge(edge, ComplexVertex { point: at, freedom }, |_, f| flags.get(f.index()).copied().unwrap_or(false));
        let vertex = touched.vertex?;
        self.register(&[], 1.0);
        // Pieces of treated triangles are the triangles at the new vertex.
        for &facet in &touched.facets {
            if !self.corners(facet).is_some_and(|t| t.contains(&vertex)) {
                continue;
            }
            let surface = self.brep.facets[facet].surface;
            let alike = treated.iter().position(|&t| t == facet).or_else(|| sources.iter().position(|&s| s == surface));
            let sense = self.visible_sense(facet).or(alike.map(|k| senses[k]));
            self.register(&[facet], sense.unwrap_or(1.0));
        }
        if self.places.len() <= vertex.index() {
            self.places.resize(vertex.index() + 1, Place::Corner);
            self.sizes.resize(vertex.index() + 1, f64::INFINITY);
        }
        self.places[vertex.index()] = place;
        self.mark(&touched.facets);
        self.sizes[vertex.index()] = 0.5 * (self.sizes[ends[0].index()] + self.sizes[ends[1].index()]);
        Some(touched)
    }

    /// The line for vertices of an edge that is straight on the surface of a strip beside it: out of the strip by a trace, so
    /// that the strip gets no corners that are straight but for rounding. On lines along an axis there is no rounding.
    fn ruling_of(&mut self, edge: EdgeId, strip: FacetId) -> Option<CurveId> {
        let topology = &self.brep.topology;
        let fin = topology.fins_around(edge).find(|&fin| topology.facet_of(fin) == strip)?;
        let [a, b] = topology.fin_ends(fin).map(|v| self.point(v));
        let support = self.support(strip)?;
        let foot = support.closest(&((a + b) * 0.5));
        let direction = (b - a).try_normalize(0.0)?;
        if !support.is_straight_along(&foot, &direction) || self.brep.is_feature(edge) {
            return None;
        }
        let is_exact = direction.iter().filter(|&&x| x == 0.0).count() == 2;
        let out = if is_exact { 0.0 } else { TRACE * (b - a).norm() };
        let origin = a + direction.cross(&self.normal(strip)) * out;
        Some(self.add_curve(Curve::Line { origin, direction }, &[strip]))
    }

    /// Whether the pieces of a triangle face the way their surface does; where it does not do so itself, they may face with it
    /// if they stay in its plane.
    fn split_keeps_sense(&self, facet: FacetId, [a, b]: [VertexId; 2], at: &Vec3, is_within: bool) -> bool {
        let Some(corners) = self.corners(facet) else { return false };
        let may_flip = is_within && self.measure_facet(facet).is_flipped;
        [a, b].iter().all(|gone| {
            let piece = corners.map(|v| if v == *gone { *at } else { self.point(v) });
            may_flip || !self.measure(facet, &piece).is_flipped
        })
    }
}

/// Collapse.
impl Workpiece {
    /// What contracting an edge onto its other end would do; `None` if topology, freedoms or polygons forbid it or an angle
    /// gets so small that its cosine passes `limit`.
    pub fn plan_collapse(&self, edge: EdgeId, gone: VertexId, limit: f64) -> Option<(Collapse, Effect)> {
        let kept = self.brep.topology.other_end(edge, gone);
        match self.place(gone) {
            Place::Corner => return None,
            Place::Curve(_) if !self.brep.is_feature(edge) || !self.is_active(edge) => return None,
            _ => {}
        }
        let at = self.point(kept);
        let moved = |t: [VertexId; 3]| {
            let point = |v| if v == gone { at } else { self.point(v) };
            [point(t[0]), point(t[1]), point(t[2])]
        };
        // Shapes first: they cost a tenth of what topology and supports do.
        for facet in self.brep.topology.facets_at(gone).filter(|&f| self.is_treated(f)) {
            let corners = self.corners(facet)?;
            if !corners.contains(&kept) {
                let [a, b, c] = moved(corners);
                if is_sharper([&a, &b, &c], self.obtuse, limit) {
                    return None;
                }
            }
        }
        let plan = self.brep.plan_collapse(edge, gone).ok()?;
        let mut effect = Effect { before: self.worst(&self.star(gone)), after: Measure::BEST };
        for &facet in &plan.changed {
            if self.is_treated(facet) {
                let corners = moved(self.corners(facet)?);
                effect.after = effect.after.worse_of(self.measure(facet, &corners));
            } else if !self.polygon_stays_simple(facet, Change::Merge { gone, kept }) {
                return None;
            }
        }
        if let Place::Curve(c) = self.place(gone) {
            let beyond = self.next_on_curve(gone, edge)?;
            let old = self.curve_excess(c, &self.point(gone), &at);
            let old = old.max(self.curve_excess(c, &self.point(gone), &self.point(beyond)));
            effect.before.excess = effect.before.excess.max(old);
            effect.after.excess = effect.after.excess.max(self.curve_excess(c, &at, &self.point(beyond)));
        }
        Some((plan, effect))
    }

    /// The other neighbour of a vertex along its curve.
    fn next_on_curve(&self, vertex: VertexId, edge: EdgeId) -> Option<VertexId> {
        let next = self.brep.topology.edges_at(vertex).find(|&e| e != edge && self.brep.is_feature(e))?;
        Some(self.brep.topology.other_end(next, vertex))
    }

    /// Contracts an edge.
    pub fn collapse(&mut self, plan: &Collapse) -> Touched {
        if let Place::Curve(c) = self.place(plan.gone)
            && self.place(plan.kept) == Place::Corner
            && let Some(beyond) = self.next_on_curve(plan.gone, plan.edge)
            && self.place(beyond) == Place::Corner
        {
            self.lone_edges.insert(sorted([plan.kept, beyond]), c);
        }
        let touched = self.brep.collapse(plan);
        self.mark(&touched.facets);
        for f in &touched.removed_facets {
            self.is_treated[f.index()] = false;
        }
        touched
    }
}

/// Swap.
impl Workpiece {
    /// What replacing an edge by the other diagonal would do; `None` if topology forbids it or it helps neither shape nor
    /// deviation.
    pub fn plan_swap(&self, edge: EdgeId) -> Option<(Swap, Effect)> {
        self.plan_swap_if(edge, true)
    }

    /// The same, also if it helps nothing.
    pub fn plan_any_swap(&self, edge: EdgeId) -> Option<(Swap, Effect)> {
        self.plan_swap_if(edge, false)
    }

    fn plan_swap_if(&self, edge: EdgeId, must_help: bool) -> Option<(Swap, Effect)> {
        let topology = &self.brep.topology;
        let mut ring = topology.fins_around(edge);
        let (Some(at_f), Some(at_g), None) = (ring.next(), ring.next(), ring.next()) else { return None };
        let [f, g] = [at_f, at_g].map(|fin| topology.facet_of(fin));
        if !self.is_treated(f) || !self.is_treated(g) {
            return None;
        }
        let before = self.measure_facet(f).worse_of(self.measure_facet(g));
        let [a, b] = topology.fin_ends(at_f).map(|v| self.point(v));
        let [c, d] = [at_f, at_g].map(|fin| self.point(topology.fin_ends(topology.prev_fin(fin))[0]));
        // Shapes first: they cost a tenth of what topology and supports do.
        if must_help && !before.is_flipped && before.excess <= 1.0 {
            let limit = raised(before.cosine);
            let is_poor = |[p, q, r]: [&Vec3; 3]| sharpest_cosine([p, q, r], self.obtuse) >= limit;
            if is_poor([&c, &d, &b]) || is_poor([&d, &c, &a]) {
                return None;
            }
        }
        let plan = self.brep.plan_swap(edge).ok()?;
        let after = self.measure(f, &[c, d, b]).worse_of(self.measure(f, &[d, c, a]));
        Some((plan, Effect { before, after }))
    }

    /// Swaps an edge.
    pub fn swap(&mut self, plan: &Swap) -> Touched {
        let sense = self.sense[plan.facets[0].index()];
        for f in plan.facets {
            self.is_treated[f.index()] = false;
        }
        let touched = self.brep.swap(plan);
        self.register(&touched.facets, sense);
        self.mark(&touched.facets);
        touched
    }
}

/// Relocate.
impl Workpiece {
    /// Moves a vertex.
    pub fn relocate(&mut self, vertex: VertexId, to: Vec3) {
        self.brep.vertices[vertex].point = to;
        let star = self.star(vertex);
        self.mark(&star);
    }
}
