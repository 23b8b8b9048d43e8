//! The triangles around a vertex, laid out for trying many places for it: one that there is, or one that a split would make.

use super::operators::Effect;
use super::polygons::Change;
use super::quality::{cosine_of_degrees, is_sharper, sharpest_cosine, strain};
use super::workpiece::{Area, CurveId, Measure, Place, Workpiece};
use crate::brep::store::EdgeId;
use crate::geom::Vec3;
use crate::ids::{FacetId, VertexId};

/// Shares of the shortest edge at a vertex: the first step of the search for its best place.
const FIRST_STEP: f64 = 0.4;
/// The first step of the search for the place of least strain; smallest angle, in degrees, that it may leave where it was
/// larger.
const FIRST_EASE: f64 = 0.1;
const EASE_KEEPS: f64 = 40.0;
/// And a step that tells where the smallest angle grows: less than the last one of the search.
const LEAST_STEP: f64 = 0.005;
/// Steps of the pattern search for the best place.
const SEARCH_STEPS: usize = 6;

/// The vertex of a ring.
#[derive(Clone, Copy, Debug)]
enum Hub {
    Vertex(VertexId),
    /// To be put into the edge between these.
    Split([VertexId; 2]),
}

/// What a move of a vertex changes. Triangles come with the sharpest first: it tells soonest that a place is no better.
pub(super) struct Ring<'a> {
    work: &'a Workpiece,
    hub: Hub,
    place: Place,
    here: Vec3,
    spokes: Vec<Spoke<'a>>,
    /// The vertex' curve, if it is on one, and the other ends of its edges there.
    curve: Option<(CurveId, Vec<Vec3>)>,
    /// Planar facets at the vertex.
    polygons: Vec<FacetId>,
    /// The worst of the triangles as they are, feature edges included.
    pub before: Measure,
}

/// A triangle at the vertex.
struct Spoke<'a> {
    facet: FacetId,
    area: Option<Area<'a>>,
    /// Its corners, the vertex at place `at`.
    corners: [Vec3; 3],
    at: usize,
    sharpest: f64,
}

impl Spoke<'_> {
    /// The corners, in no certain order, with the vertex elsewhere.
    #[inline]
    fn around<'b>(&'b self, to: &'b Vec3) -> [&'b Vec3; 3] {
        [to, &self.corners[(self.at + 1) % 3], &self.corners[(self.at + 2) % 3]]
    }

    fn moved(&self, to: &Vec3) -> [Vec3; 3] {
        let mut corners = self.corners;
        corners[self.at] = *to;
        corners
    }
}

impl Workpiece {
    /// The ring of a vertex.
    pub fn ring(&self, vertex: VertexId) -> Ring<'_> {
        let mut spokes = Vec::with_capacity(8);
        let mut polygons = Vec::new();
        let mut before = Measure::BEST;
        for facet in self.brep.topology.facets_at(vertex) {
            match self.corners(facet) {
                Some(corners) if self.is_treated(facet) => {
                    let Some(at) = corners.iter().position(|&v| v == vertex) else { continue };
                    let measure = self.measure_facet(facet);
                    before = before.worse_of(measure);
                    let corners = self.points(corners);
                    spokes.push(Spoke { facet, area: self.area_of(facet), corners, at, sharpest: measure.cosine });
                }
                _ => polygons.push(facet),
            }
        }
        polygons.sort_unstable();
        polygons.dedup();
        let curve = match self.place(vertex) {
            Place::Curve(c) => {
                let features = self.brep.topology.edges_at(vertex).filter(|&e| self.brep.is_feature(e));
                Some((c, features.map(|e| self.point(self.brep.topology.other_end(e, vertex))).collect()))
            }
            _ => None,
        };
        let (place, here) = (self.place(vertex), self.point(vertex));
        Ring { work: self, hub: Hub::Vertex(vertex), place, here, spokes, curve, polygons, before }.finished()
    }

    /// The ring of the vertex that splitting an edge would put there; every facet around that is not treated counts as a
    /// polygon.
    pub fn ring_of_split(&self, edge: EdgeId, place: Place, here: Vec3) -> Ring<'_> {
        let ends = self.brep.topology.ends(edge);
        let (mut spokes, mut polygons) = (Vec::with_capacity(4), Vec::new());
        let mut before = Measure::BEST;
        for facet in self.brep.topology.facets_around(edge) {
            let Some(whole) = self.corners(facet).filter(|_| self.is_treated(facet)) else {
                polygons.push(facet);
                continue;
            };
            let area = self.area_of(facet);
            for at in (0..3).filter(|&k| ends.contains(&whole[k])) {
                let mut corners = self.points(whole);
                corners[at] = here;
                let measure = self.measure(facet, &corners);
                before = before.worse_of(measure);
                spokes.push(Spoke { facet, area, corners, at, sharpest: measure.cosine });
            }
        }
        let curve = match place {
            Place::Curve(c) if self.brep.is_feature(edge) => Some((c, ends.map(|v| self.point(v)).to_vec())),
            _ => None,
        };
        Ring { work: self, hub: Hub::Split(ends), place, here, spokes, curve, polygons, before }.finished()
    }
}

impl Ring<'_> {
    fn finished(mut self) -> Self {
        self.spokes.sort_by(|p, q| q.sharpest.total_cmp(&p.sharpest));
        self.before.excess = self.before.excess.max(self.curve_excess(&self.here));
        self
    }

    /// Deviation of the feature edges if the vertex were elsewhere.
    fn curve_excess(&self, to: &Vec3) -> f64 {
        let arms = self.curve.iter().flat_map(|(c, arms)| arms.iter().map(|p| self.work.curve_excess(*c, p, to)));
        arms.fold(0.0, f64::max)
    }

    /// The triangles.
    pub fn facets(&self) -> impl Iterator<Item = FacetId> + '_ {
        self.spokes.iter().map(|s| s.facet)
    }

    /// Whether the cosine of an angle would pass `limit` if the vertex were elsewhere.
    fn is_sharper(&self, to: &Vec3, limit: f64) -> bool {
        self.spokes.iter().any(|s| is_sharper(s.around(to), self.work.obtuse, limit))
    }

    /// Cosine of the smallest angle if the vertex were elsewhere.
    fn sharpest(&self, to: &Vec3) -> f64 {
        let cosines = self.spokes.iter().map(|s| sharpest_cosine(s.around(to), self.work.obtuse));
        cosines.fold(Measure::BEST.cosine, f64::max)
    }

    /// What moving the vertex would do; `None` if polygons forbid it, a triangle turns over, the deviation passes `excess`, or
    /// an angle gets so small that its cosine passes `limit`.
    pub fn plan(&self, to: &Vec3, limit: f64, excess: f64) -> Option<Effect> {
        // Shapes first: they cost a tenth of a look at the supports.
        if self.is_sharper(to, limit) {
            return None;
        }
        self.plan_shaped(to, self.sharpest(to), excess)
    }

    /// The same for a place where the cosine of the smallest angle is known.
    fn plan_shaped(&self, to: &Vec3, cosine: f64, excess: f64) -> Option<Effect> {
        let mut after = Measure { cosine, ..Measure::BEST };
        for spoke in &self.spokes {
            let Some(area) = &spoke.area else { continue };
            // Of the edges only the one that follows the vertex is looked at: around it each edge follows it in one triangle,
            // and the others do not change.
            let next = spoke.corners[(spoke.at + 1) % 3];
            let (deviation, is_flipped) = area.deviation(&spoke.moved(to), &[(to + next) * 0.5]);
            after.excess = after.excess.max(deviation);
            after.is_flipped |= is_flipped;
            if after.is_flipped && !self.before.is_flipped || after.excess > excess {
                return None;
            }
        }
        after.excess = after.excess.max(self.curve_excess(to));
        let change = match self.hub {
            Hub::Vertex(vertex) => Change::Move { vertex, to: *to },
            Hub::Split(ends) => Change::Insert { ends, at: *to },
        };
        let is_clear = after.excess <= excess && self.polygons.iter().all(|&f| self.work.polygon_stays_simple(f, change));
        is_clear.then_some(Effect { before: self.before, after })
    }

    /// The directions in which the smallest angle does not fall at once from a place. As a function of the place it is
    /// quasi-concave: in the others it is no larger farther away either. With obtuse angles counted that is nearly so; what is
    /// missed is little.
    fn promising(&self, directions: &[Vec3], shortest: f64, (here, effect): &(Vec3, Effect)) -> Vec<Vec3> {
        let step = LEAST_STEP * shortest;
        directions.iter().filter(|d| !self.is_sharper(&(here + *d * step), effect.after.cosine)).copied().collect()
    }

    /// The place near the vertex where the triangles around, and what `more` says of a place, are strained least, by pattern
    /// search like [`Self::best_place`]; `None` if nothing is better than here.
    pub fn easiest_place(&self, more: impl Fn(&Vec3) -> f64) -> Option<Vec3> {
        let strain = |to: &Vec3| more(to) + self.spokes.iter().map(|s| strain(s.around(to))).sum::<f64>();
        let mut best = self.here;
        let mut least = strain(&best);
        if least == 0.0 {
            return None;
        }
        let directions = self.work.directions(self.place, &self.here)?;
        let excess = self.before.excess.max(1.0);
        let floor = self.before.cosine.max(cosine_of_degrees(EASE_KEEPS));
        let mut step = FIRST_EASE * self.shortest();
        for _ in 0..SEARCH_STEPS {
            // Shapes first, as there.
            let near = directions.iter().map(|d| best + d * step).filter(|near| strain(near) < least);
            let places = near.map(|near| self.work.home_of(self.place, &near));
            let mut places: Vec<(f64, Vec3)> = places.map(|p| (strain(&p), p)).filter(|p| p.0 < least).collect();
            places.sort_by(|p, q| p.0.total_cmp(&q.0));
            let is_legal = |to: &Vec3| {
                let cosine = self.sharpest(to);
                cosine <= floor && self.plan_shaped(to, cosine, excess).is_some_and(|e| e.is_legal())
            };
            match places.into_iter().find(|(_, to)| is_legal(to)) {
                Some(next) => (least, best) = next,
                None => step *= 0.5,
            }
        }
        (best != self.here).then_some(best)
    }

    /// Length of the shortest edge at the vertex.
    fn shortest(&self) -> f64 {
        let spans = self.spokes.iter().flat_map(|s| s.corners.iter().map(|p| (p - self.here).norm_squared()));
        spans.filter(|&d| d > 0.0).fold(f64::INFINITY, f64::min).sqrt()
    }

    /// The place near the vertex where the smallest angle around it is largest, by pattern search along its curve or in its
    /// tangent plane; `None` if nothing is better than here.
    pub fn best_place(&self) -> Option<(Vec3, Effect)> {
        let directions = self.work.directions(self.place, &self.here)?;
        let excess = self.before.excess.max(1.0);
        let shortest = self.shortest();
        let mut step = FIRST_STEP * shortest;
        let mut best = (self.here, Effect { before: self.before, after: self.before });
        let mut promising = self.promising(&directions, shortest, &best);
        let mut places: Vec<(f64, Vec3)> = Vec::with_capacity(directions.len());
        for _ in 0..SEARCH_STEPS {
            let least = best.1.after.cosine;
            places.clear();
            places.extend(promising.iter().filter_map(|d| {
                let near = best.0 + d * step;
                (!self.is_sharper(&near, least)).then(|| (self.sharpest(&near), near))
            }));
            // Best shape first: few places have to be projected and held against the supports.
            places.sort_by(|p, q| p.0.total_cmp(&q.0));
            let mut legal = places.iter().filter_map(|(_, near)| {
                let to = self.work.home_of(self.place, near);
                let cosine = self.sharpest(&to);
                let effect = if cosine < least { self.plan_shaped(&to, cosine, excess) } else { None };
                effect.filter(Effect::is_legal).map(|e| (to, e))
            });
            match legal.next() {
                Some(next) => {
                    best = next;
                    promising = self.promising(&directions, shortest, &best);
                }
                None => step *= 0.5,
            }
        }
        best.1.is_better().then_some(best)
    }
}
