//! The triangles around a vertex, laid out for trying many places for it.

use super::operators::Effect;
use super::polygons::Change;
use super::quality::sharpest_cosine;
use super::workpiece::{Area, CurveId, Measure, Place, Workpiece};
use crate::geom::Vec3;
use crate::ids::{FacetId, VertexId};

/// What a move of a vertex changes. Triangles come with the sharpest first: it tells soonest that a place is no better.
pub(super) struct Ring<'a> {
    work: &'a Workpiece,
    vertex: VertexId,
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
        spokes.sort_by(|p, q| q.sharpest.total_cmp(&p.sharpest));
        polygons.sort_unstable();
        polygons.dedup();
        let curve = match self.place(vertex) {
            Place::Curve(c) => {
                let features = self.brep.topology.edges_at(vertex).filter(|&e| self.brep.is_feature(e));
                let arms: Vec<Vec3> = features.map(|e| self.point(self.brep.topology.other_end(e, vertex))).collect();
                let excess = arms.iter().map(|p| self.curve_excess(c, p, &self.point(vertex)));
                before.excess = excess.fold(before.excess, f64::max);
                Some((c, arms))
            }
            _ => None,
        };
        Ring { work: self, vertex, spokes, curve, polygons, before }
    }
}

impl Ring<'_> {
    /// The triangles.
    pub fn facets(&self) -> Vec<FacetId> {
        self.spokes.iter().map(|s| s.facet).collect()
    }

    /// Cosine of the smallest angle if the vertex were elsewhere; `None` if it passes `limit`.
    pub fn sharpest(&self, to: &Vec3, limit: f64) -> Option<f64> {
        let mut sharpest = Measure::BEST.cosine;
        for spoke in &self.spokes {
            let [a, b, c] = spoke.moved(to);
            let cosine = sharpest_cosine([&a, &b, &c], self.work.obtuse);
            if cosine > limit {
                return None;
            }
            sharpest = sharpest.max(cosine);
        }
        Some(sharpest)
    }

    /// What moving the vertex would do; `None` if polygons forbid it, a triangle turns over, the deviation passes `excess`, or an
    /// angle gets so small that its cosine passes `limit`.
    pub fn plan(&self, to: &Vec3, limit: f64, excess: f64) -> Option<Effect> {
        // Shapes first: they cost a tenth of a look at the supports.
        let cosine = self.sharpest(to, limit)?;
        let mut after = Measure { cosine, ..Measure::BEST };
        if let Some((curve, arms)) = &self.curve {
            let excess = arms.iter().map(|p| self.work.curve_excess(*curve, p, to));
            after.excess = excess.fold(after.excess, f64::max);
        }
        for spoke in &self.spokes {
            let Some(area) = &spoke.area else { continue };
            // Of the edges only the one that follows the vertex is looked at: around it each edge follows it in one triangle, and
            // the others do not change.
            let next = spoke.corners[(spoke.at + 1) % 3];
            let (deviation, is_flipped) = area.deviation(&self.work.bound, &spoke.moved(to), &[(to + next) * 0.5]);
            after.excess = after.excess.max(deviation);
            after.is_flipped |= is_flipped;
            if after.is_flipped && !self.before.is_flipped || after.excess > excess {
                return None;
            }
        }
        let change = Change::Move { vertex: self.vertex, to: *to };
        let is_clear = self.polygons.iter().all(|&f| self.work.polygon_stays_simple(f, change));
        (is_clear && after.excess <= excess).then_some(Effect { before: self.before, after })
    }
}
