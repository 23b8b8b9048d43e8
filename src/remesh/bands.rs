//! Which facets are remeshed, and how strips are cut so that only their ends near an intersection are.
//!
//! A strip of a cylinder or cone is as long as its side. Where an intersection of facets cuts it, its end is a zigzag about the
//! true curve: corners where the *other* surface's rulings pass lie in the strip's plane, off the true surface. Only these
//! corners ask for work. A cut along a ruling, or across whole rulings, leaves planar strips with corners on the true surface.
//! Where a thin rod crosses coarse facets, corners belong several widths off, and bands reach there.
//!
//! ```text
//! ruling ──────────┬───╲        ┬ new vertices, shared with the neighbouring strips, one width from the intersection:
//!   strip: stays   │ band ╲     │ the band becomes triangles, the rest of the strip stays a polygon
//! ruling ──────────┴───────╲
//! ```

use super::Supports;
use super::pieces::{Mark, Marks, cut_facet, edges_of};
use super::strips::{Edge, Strips};
use crate::brep::complex::{Complex, ComplexFacet, ComplexVertex};
use crate::geom::Vec3;
use crate::geom::segment::distance_to;
use crate::ids::{FacetId, Id, IdVec, SurfaceId, VertexId};
use crate::patch::curve::project_on_all;
use crate::patch::support::Support;
use crate::primitive::solid::Freedom;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Depth of a band in widths of its strip: a row of nearly equilateral triangles.
const DEPTH: f64 = 1.0;
/// Bands nearer than this many widths to each other or to the end of their ruling reach it: what lay between would be shorter
/// than wide.
const LEAST_REST: f64 = 1.0;
/// Room in a band beyond the true place of its corner, in widths of its strip: where a thin rod crosses a coarse surface, corners
/// move by more than the rod's strips are wide, and would meet the strips that stay.
const ROOM: f64 = 0.5;
/// A corner nearer to a ruling than this many widths asks for work in the strip beyond, too.
const LEAST_SIDE: f64 = 0.5;

/// What is to be remeshed.
#[derive(Clone, Debug, Default)]
pub(super) struct Choice {
    /// By facet.
    pub is_chosen: Vec<bool>,
    /// New vertices of rulings with the ruling's direction, along which they may slide.
    pub slides: Vec<(VertexId, Vec3)>,
}

impl Choice {
    /// The facets at intersections, after the strips among them have been cut. Pieces keep what their facet had. Cost: linear
    /// but for sorting.
    pub fn near_intersections(complex: &mut Complex, supports: &Supports) -> Self {
        let strips = Strips::of(complex, supports);
        let reach = strips.reach;
        let is_off = strips.off_vertices();
        let hot = strips.hot_points(&is_off);
        let cuts = strips.cuts(&hot);
        let is_strip: Vec<bool> = complex.facets.ids().map(|f| strips.is_strip(f)).collect();
        let Strips { is_modified, .. } = strips;
        let mut slides = Vec::new();
        let mut marks = Marks::new();
        for (edge, list) in cuts {
            for cut in list {
                let vertex = complex.vertices.push(ComplexVertex { point: cut.at, freedom: Freedom::Surface });
                marks.entry(edge).or_default().push(Mark { vertex, is_hot_beyond: cut.is_hot_beyond });
                slides.push((vertex, cut.along));
            }
        }
        let points: Vec<Vec3> = complex.vertices.iter().map(|v| v.point).collect();
        let mut is_chosen = Vec::new();
        let mut facets = IdVec::new();
        for (k, facet) in std::mem::take(&mut complex.facets).into_iter().enumerate() {
            let is_curved = supports[facet.surface].is_some();
            for piece in cut_facet(facet, &marks, &points) {
                let is_near = || {
                    hot.get(&FacetId::new(k)).is_some_and(|h| h.iter().any(|p| is_on_border(&piece, &p.now, &points, reach)))
                };
                is_chosen.push(is_curved && if is_strip[k] { is_near() } else { is_modified[k] });
                facets.push(piece);
            }
        }
        complex.facets = facets;
        Self { is_chosen, slides }
    }
}

/// Whether a point lies on the border of a facet.
fn is_on_border(facet: &ComplexFacet, point: &Vec3, points: &[Vec3], reach: f64) -> bool {
    let mut edges = edges_of(&facet.loops).map(|e| e.map(|v| &points[v.index()]));
    edges.any(|edge| distance_to(point, edge) <= reach)
}

/// A point around which a strip is remeshed, and where it belongs.
#[derive(Clone, Copy)]
struct Hot {
    now: Vec3,
    home: Vec3,
}

/// A new vertex of a ruling.
struct Cut {
    at: Vec3,
    along: Vec3,
    is_hot_beyond: bool,
}

impl Strips<'_> {
    /// By facet: the points around which it is remeshed. Corners off the true surface; where one is near a ruling, its foot
    /// there for the strip beyond.
    fn hot_points(&self, is_off: &[bool]) -> BTreeMap<FacetId, Vec<Hot>> {
        let mut hot: BTreeMap<FacetId, Vec<Hot>> = BTreeMap::new();
        let homes = self.homes(is_off);
        for (id, facet) in self.complex.facets.enumerate() {
            let off = facet.loops.iter().flatten().filter(|v| is_off[v.index()]);
            let off: Vec<Hot> = off.map(|v| Hot { now: self.point(*v), home: homes[v] }).collect();
            if off.is_empty() || !self.is_strip(id) {
                continue;
            }
            for ruling in self.rulings(id) {
                let (start, along, _) = self.line(ruling);
                let foot = |p: &Vec3| start + along * along.dot(&(p - start));
                let feet = off.iter().map(|p| Hot { now: foot(&p.now), home: foot(&p.home) });
                let near = self.width(id, ruling) * LEAST_SIDE;
                let feet: Vec<Hot> = feet.zip(&off).filter(|(foot, p)| (foot.now - p.now).norm() < near).map(|f| f.0).collect();
                for beyond in self.around(ruling).filter(|&f| f != id && self.is_strip(f)) {
                    hot.entry(beyond).or_default().extend(&feet);
                }
            }
            hot.entry(id).or_default().extend(off);
        }
        hot
    }

    /// Where corners off the true surface belong: on all curved surfaces there.
    fn homes(&self, is_off: &[bool]) -> BTreeMap<VertexId, Vec3> {
        let mut surfaces: BTreeMap<VertexId, BTreeSet<SurfaceId>> = BTreeMap::new();
        for facet in self.complex.facets.iter() {
            for &v in facet.loops.iter().flatten().filter(|v| is_off[v.index()]) {
                surfaces.entry(v).or_default().insert(facet.surface);
            }
        }
        let home = |(v, surfaces): (VertexId, BTreeSet<SurfaceId>)| {
            let supports: Vec<Arc<Support>> = surfaces.into_iter().filter_map(|s| self.supports[s].clone()).collect();
            // Fitted patches know no place that far away.
            let is_exact = supports.iter().all(|s| !s.is_fitted());
            let home = is_exact.then(|| project_on_all(&self.point(v), &supports)).flatten();
            (v, home.unwrap_or(self.point(v)))
        };
        surfaces.into_iter().map(home).collect()
    }

    /// New vertices of the rulings, in their order from the ruling's smaller end.
    fn cuts(&self, hot: &BTreeMap<FacetId, Vec<Hot>>) -> BTreeMap<Edge, Vec<Cut>> {
        let mut bands: BTreeMap<Edge, (f64, Vec<[f64; 2]>)> = BTreeMap::new();
        for (&facet, points) in hot {
            for ruling in self.rulings(facet) {
                let (start, along, length) = self.line(ruling);
                let depth = DEPTH * self.width(facet, ruling);
                let around = |p: &Vec3| along.dot(&(p - start));
                let (deepest, list) = bands.entry(ruling).or_default();
                *deepest = deepest.max(depth);
                let band = |p: &Hot| {
                    let (now, home) = (around(&p.now), around(&p.home));
                    [(now - depth).min(home - ROOM * depth), (now + depth).max(home + ROOM * depth)]
                };
                let bands = points.iter().map(band);
                list.extend(bands.filter(|b| b[1] > 0.0 && b[0] < length));
            }
        }
        bands
            .into_iter()
            .map(|(ruling, (depth, list))| (ruling, self.ends_of_bands(ruling, list, LEAST_REST * depth)))
            .collect()
    }

    /// The ends of the union of some bands that leave at least `rest` of a ruling.
    fn ends_of_bands(&self, ruling: Edge, mut bands: Vec<[f64; 2]>, rest: f64) -> Vec<Cut> {
        let (start, along, length) = self.line(ruling);
        bands.sort_unstable_by(|p, q| p[0].total_cmp(&q[0]));
        let mut union: Vec<[f64; 2]> = Vec::new();
        for [lo, hi] in bands {
            match union.last_mut() {
                Some(last) if lo < last[1] + rest => last[1] = last[1].max(hi),
                _ => union.push([lo, hi]),
            }
        }
        // A band at the ruling's end is half as long at least; so is what stays between two, else they become one.
        let mut ends: Vec<(f64, bool)> = Vec::new();
        for [lo, hi] in union {
            let lo = (lo >= rest).then(|| lo.min(length - 0.5 * rest));
            match (lo, ends.last()) {
                (Some(lo), Some(last)) if lo < last.0 + 0.5 * rest => drop(ends.pop()),
                (Some(lo), _) => ends.push((lo, true)),
                (None, _) => {}
            }
            if hi <= length - rest {
                ends.push((hi.max(0.5 * rest), false));
            }
        }
        ends.into_iter().map(|(s, is_hot_beyond)| Cut { at: start + along * s, along, is_hot_beyond }).collect()
    }
}
