//! Which facets are remeshed, and how strips are cut so that only their ends near an intersection are.
//!
//! A strip of a cylinder or cone is as long as its side. Where an intersection of facets cuts it, its end is a zigzag about the
//! true curve: corners where the *other* surface's rulings pass lie in the strip's plane, off the true surface. Only these
//! corners ask for work. A cut along a ruling, or across whole rulings, leaves planar strips with corners on the true surface.
//!
//! ```text
//! ruling ──────────┬───╲        ┬ new vertices, shared with the neighbouring strips, one width from the intersection:
//!   strip: stays   │ band ╲     │ the band becomes triangles, the rest of the strip stays a polygon
//! ruling ──────────┴───────╲
//! ```

use super::pieces::{Mark, Marks, cut_facet, edges_of};
use super::sizing::{NARROWEST, PER_STRIP, wanted_on};
use super::workpiece::sorted;
use crate::brep::complex::{Complex, ComplexFacet, ComplexVertex};
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use crate::geom::segment::distance_to;
use crate::ids::{FacetId, Id, IdVec, PartId, SurfaceId, VertexId};
use crate::patch::support::Support;
use crate::primitive::solid::Freedom;
use crate::scene::model::{Part, RemeshOptions};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Depth of a band in widths of its strip: a row of nearly equilateral triangles.
const DEPTH: f64 = 1.0;
/// Bands nearer than this many widths to each other or to the end of their ruling reach it: what lay between would be shorter
/// than wide.
const LEAST_REST: f64 = 1.0;
/// A corner nearer to a ruling than this many widths asks for work in the strip beyond, too.
const LEAST_SIDE: f64 = 0.5;
/// Length of a strip's rulings over its chords below which triangles of the smallest chords that a narrow strip may ask for
/// ([`NARROWEST`]) do not fit.
const SHORTEST_STRIP: f64 = NARROWEST / PER_STRIP;
/// Distance from the true surface, as a fraction of the model's size, past which a corner is off it: contact moves corners by
/// less.
const OFF: f64 = 1e-7;

type Edge = [VertexId; 2];
type Supports = IdVec<SurfaceId, Option<Arc<Support>>>;

/// What is to be remeshed.
#[derive(Clone, Debug, Default)]
pub(super) struct Choice {
    /// By facet.
    pub is_chosen: Vec<bool>,
    /// New vertices of rulings with the ruling's direction, along which they may slide.
    pub slides: Vec<(VertexId, Vec3)>,
}

impl Choice {
    /// All curved facets but the rims of sheets, where these are as the user wants them.
    pub fn all(complex: &Complex, supports: &Supports, options: &RemeshOptions, parts: &IdVec<PartId, Part>) -> Self {
        let allowed = options.max_deviation.unwrap_or(f64::INFINITY);
        let stays = |facet: &ComplexFacet, support: &Support| {
            chords_of_rim(facet, complex, support).is_some_and(|chords| {
                let longest = wanted_on(&complex.markers[facet.marker], parts);
                chords.iter().all(|[a, b]| (b - a).norm() <= longest && support.distance(&((a + b) * 0.5)) <= allowed)
            })
        };
        let is_chosen = complex.facets.iter().map(|f| supports[f.surface].as_ref().is_some_and(|s| !stays(f, s)));
        Self { is_chosen: is_chosen.collect(), slides: Vec::new() }
    }

    /// The facets at intersections, after the strips among them have been cut. Pieces keep what their facet had. Cost: linear
    /// but for sorting.
    pub fn near_intersections(complex: &mut Complex, supports: &Supports) -> Self {
        let strips = Strips::of(complex, supports);
        let reach = strips.reach;
        let is_off = strips.off_vertices();
        let hot = strips.hot_points(&is_off);
        let cuts = strips.cuts(&hot);
        let is_ruled: Vec<bool> = complex.facets.ids().map(|f| strips.is_ruled(f)).collect();
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
                let is_near =
                    || hot.get(&FacetId::new(k)).is_some_and(|h| h.iter().any(|p| is_on_border(&piece, p, &points, reach)));
                is_chosen.push(is_curved && if is_ruled[k] { is_near() } else { is_modified[k] });
                facets.push(piece);
            }
        }
        complex.facets = facets;
        Self { is_chosen, slides }
    }
}

/// The chords of a planar strip of a ruled surface that is so short along its rulings that its triangles would be needles, as at
/// the rim of a sheet; none of other facets.
fn chords_of_rim(facet: &ComplexFacet, complex: &Complex, support: &Support) -> Option<[[Vec3; 2]; 2]> {
    let &[a, b, c, d] = facet.loops[0].as_slice() else { return None };
    let [a, b, c, d] = [a, b, c, d].map(|v| complex.vertices[v].point);
    let length = |[p, q]: &[Vec3; 2]| (q - p).norm();
    let is_ruling = |[p, q]: &[Vec3; 2]| support.closest(&((p + q) * 0.5)).is_straight_along(&(q - p));
    let is_rim = |rulings: &[[Vec3; 2]; 2], chords: &[[Vec3; 2]; 2]| {
        let least = chords.iter().map(length).fold(f64::INFINITY, f64::min);
        rulings.iter().all(|r| length(r) < SHORTEST_STRIP * least && is_ruling(r))
    };
    let (across, along) = ([[a, b], [c, d]], [[b, c], [d, a]]);
    if is_rim(&across, &along) { Some(along) } else { is_rim(&along, &across).then_some(across) }
}

/// Whether a point lies on the border of a facet.
fn is_on_border(facet: &ComplexFacet, point: &Vec3, points: &[Vec3], reach: f64) -> bool {
    let mut edges = edges_of(&facet.loops).map(|e| e.map(|v| &points[v.index()]));
    edges.any(|edge| distance_to(point, edge) <= reach)
}

/// Facets that an intersection cut, and triangles that share a corner with one.
fn modified_or_beside(complex: &Complex) -> Vec<bool> {
    let mut is_near = vec![false; complex.vertices.len()];
    for v in complex.facets.iter().filter(|f| f.is_modified).flat_map(|f| f.loops.iter().flatten()) {
        is_near[v.index()] = true;
    }
    let is_beside = |f: &ComplexFacet| f.triangles.len() == 1 && f.loops[0].iter().any(|v| is_near[v.index()]);
    complex.facets.iter().map(|f| f.is_modified || is_beside(f)).collect()
}

/// A new vertex of a ruling.
struct Cut {
    at: Vec3,
    along: Vec3,
    is_hot_beyond: bool,
}

struct Strips<'a> {
    complex: &'a Complex,
    supports: &'a Supports,
    /// Every edge with its facets, sorted.
    facets_of_edge: Vec<(Edge, FacetId)>,
    /// What counts as no distance.
    reach: f64,
    /// By facet: whether an intersection cut it or a triangle beside it.
    is_modified: Vec<bool>,
}

impl<'a> Strips<'a> {
    fn of(complex: &'a Complex, supports: &'a Supports) -> Self {
        let mut facets_of_edge: Vec<(Edge, FacetId)> = Vec::new();
        for (id, facet) in complex.facets.enumerate() {
            facets_of_edge.extend(edges_of(&facet.loops).map(|e| (sorted(e), id)));
        }
        facets_of_edge.sort_unstable();
        let reach = OFF * Aabb::around(complex.vertices.iter().map(|v| &v.point)).diagonal();
        Self { complex, supports, facets_of_edge, reach, is_modified: modified_or_beside(complex) }
    }

    fn around(&self, edge: Edge) -> impl Iterator<Item = FacetId> + '_ {
        let first = self.facets_of_edge.partition_point(|e| e.0 < edge);
        self.facets_of_edge[first..].iter().take_while(move |e| e.0 == edge).map(|e| e.1)
    }

    fn point(&self, vertex: VertexId) -> Vec3 {
        self.complex.vertices[vertex].point
    }

    /// The support of a facet; fitted ones only where they are needed, for there is one patch to be fitted for every facet.
    fn support(&self, facet: FacetId) -> Option<&'a Support> {
        let support = self.supports[self.complex.facets[facet].surface].as_deref()?;
        (!support.is_fitted() || self.is_modified[facet.index()]).then_some(support)
    }

    fn is_flat(&self, facet: FacetId) -> bool {
        self.supports[self.complex.facets[facet].surface].is_none()
    }

    /// Whether the surface of a facet is straight in one direction.
    fn is_ruled(&self, facet: FacetId) -> bool {
        let Some(support) = self.support(facet) else { return false };
        let [a, b, c] = self.complex.facets[facet].triangles[0].map(|v| self.point(v));
        let foot = support.closest(&((a + b + c) / 3.0));
        foot.is_straight_along(&foot.principal()[1].1)
    }

    /// Whether an edge is straight on the surface of a facet.
    fn is_straight_on(&self, [a, b]: Edge, facet: FacetId) -> bool {
        let Some(support) = self.support(facet) else { return self.is_flat(facet) };
        let (a, b) = (self.point(a), self.point(b));
        let foot = support.closest(&((a + b) * 0.5));
        foot.is_straight_along(&(b - a))
    }

    /// Whether an edge lies inside a surface and is straight there.
    fn is_ruling(&self, edge: Edge) -> bool {
        let mut facets = self.around(edge);
        let (Some(f), Some(g), None) = (facets.next(), facets.next(), facets.next()) else { return false };
        self.complex.facets[f].surface == self.complex.facets[g].surface && self.is_straight_on(edge, f)
    }

    /// By vertex: whether an intersection of facets put it off one of its surfaces. Not so the ends of a line that is straight
    /// on all its surfaces: it cuts strips along, and they stay planar if it moves to the true surface.
    fn off_vertices(&self) -> Vec<bool> {
        let mut straight: Vec<(VertexId, SurfaceId)> = Vec::new();
        for run in self.facets_of_edge.chunk_by(|a, b| a.0 == b.0) {
            let edge = run[0].0;
            if run.iter().all(|e| self.is_straight_on(edge, e.1)) {
                let surfaces = run.iter().map(|e| self.complex.facets[e.1].surface);
                straight.extend(surfaces.flat_map(|s| edge.map(|v| (v, s))));
            }
        }
        straight.sort_unstable();
        let mut is_off = vec![false; self.complex.vertices.len()];
        for (id, facet) in self.complex.facets.enumerate() {
            let Some(support) = self.support(id) else { continue };
            for &v in facet.loops.iter().flatten() {
                is_off[v.index()] |=
                    support.distance(&self.point(v)) > self.reach && straight.binary_search(&(v, facet.surface)).is_err();
            }
        }
        is_off
    }

    /// By facet: the points around which it is remeshed. Corners off the true surface; where one is near a ruling, its foot
    /// there for the strip beyond.
    fn hot_points(&self, is_off: &[bool]) -> BTreeMap<FacetId, Vec<Vec3>> {
        let mut hot: BTreeMap<FacetId, Vec<Vec3>> = BTreeMap::new();
        for (id, facet) in self.complex.facets.enumerate() {
            let off: Vec<Vec3> = facet.loops.iter().flatten().filter(|v| is_off[v.index()]).map(|&v| self.point(v)).collect();
            if off.is_empty() || !self.is_ruled(id) {
                continue;
            }
            for ruling in self.rulings(id) {
                let (start, along, _) = self.line(ruling);
                let feet = off.iter().map(|p| start + along * along.dot(&(p - start)));
                let near = self.width(id, ruling) * LEAST_SIDE;
                let feet: Vec<Vec3> = feet.zip(&off).filter(|(foot, p)| (foot - *p).norm() < near).map(|f| f.0).collect();
                for beyond in self.around(ruling).filter(|&f| f != id) {
                    hot.entry(beyond).or_default().extend(&feet);
                }
            }
            hot.entry(id).or_default().extend(off);
        }
        hot
    }

    fn rulings(&self, facet: FacetId) -> Vec<Edge> {
        edges_of(&self.complex.facets[facet].loops).map(sorted).filter(|&e| self.is_ruling(e)).collect()
    }

    /// Start, direction and length of a ruling.
    fn line(&self, ruling: Edge) -> (Vec3, Vec3, f64) {
        let [a, b] = ruling.map(|v| self.point(v));
        let length = (b - a).norm();
        (a, (b - a) / length, length)
    }

    /// How far a facet reaches from one of its rulings.
    fn width(&self, facet: FacetId, ruling: Edge) -> f64 {
        let (start, along, _) = self.line(ruling);
        let corners = self.complex.facets[facet].loops.iter().flatten();
        corners.map(|&v| (self.point(v) - start).cross(&along).norm()).fold(0.0, f64::max)
    }

    /// New vertices of the rulings, in their order from the ruling's smaller end.
    fn cuts(&self, hot: &BTreeMap<FacetId, Vec<Vec3>>) -> BTreeMap<Edge, Vec<Cut>> {
        let mut bands: BTreeMap<Edge, (f64, Vec<[f64; 2]>)> = BTreeMap::new();
        for (&facet, points) in hot {
            for ruling in self.rulings(facet) {
                let (start, along, length) = self.line(ruling);
                let depth = DEPTH * self.width(facet, ruling);
                let around = |p: &Vec3| along.dot(&(p - start));
                let (deepest, list) = bands.entry(ruling).or_default();
                *deepest = deepest.max(depth);
                let bands = points.iter().map(around).map(|s| [s - depth, s + depth]);
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
