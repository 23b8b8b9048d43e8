//! Supports of a complex: exact ones by shape, fitted ones from facets and their neighbours (thesis 4.2.1, 4.2.2, 6.2).

use super::analytic::support_of_shape;
use super::bspline::{BsplinePatch, Energy};
use super::plane::Plane;
use super::support::{Foot, Support};
use crate::brep::complex::Complex;
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use crate::geom::bvh::Bvh;
use crate::ids::{IdVec, LeafId, SurfaceId};
use crate::primitive::solid::{Freedom, Shape};
use crate::scene::model::PatchMode;
use rayon::prelude::*;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

/// A patch is dropped for its facet's plane if it errs by more than this fraction of its extent (thesis 4.2.2: 2 %).
const MAX_ERROR: f64 = 0.02;

/// Points that shape a patch: the thesis takes 15 by count; here neighbours are gathered until they also cover this many
/// times the facet's area (thesis 6.2), at most 30 of them, and as long as they turn from the facet by less than 45 degrees: a patch
/// is a height over the facet's plane, and nine strips of a cylinder would be more than half of it.
const POINTS: usize = 15;
const MOST_POINTS: usize = 30;
const AREA_FACTOR: f64 = 9.0;
const TURN_COSINE: f64 = 0.707;

/// Weight of vertices that an intersection made: they are on chords of the surface, and are taken only where the others do not reach
/// over this share of the neighbourhood.
const CUT_WEIGHT: f64 = 0.01;
const COVERED: f64 = 0.75;

/// Patches of neighbouring facets differ by about this fraction of the shortest edges.
const GRAIN: f64 = 1e-4;
/// Share by which a curvature may pass the largest turn between facets: these are taken across a third of their widths.
const CURVED_MORE: f64 = 1.5;

/// Neighbours across an edge that bends more than this (40 degrees) belong to another smooth piece.
const CREASE_COSINE: f64 = 0.766;

/// The support of every surface of the complex, in order; `None` for flat ones, whose facets carry their own planes.
/// Must run on the complex as evaluated: killed facets shape the patches. Linear up to the box trees' logarithm.
pub fn supports_of(complex: &Complex, patches: PatchMode) -> IdVec<SurfaceId, Option<Arc<Support>>> {
    let fitted = |surface: SurfaceId| Some(Arc::new(Support::Fitted(Box::new(FittedSurface::of(complex, surface)))));
    complex
        .surfaces
        .enumerate()
        .map(|(id, surface)| match (&surface.shape, patches) {
            (Shape::Plane, _) => None,
            (Shape::Sampled, _) | (_, PatchMode::BSpline) => fitted(id),
            (shape, PatchMode::Analytic) => support_of_shape(shape).map(Arc::new),
        })
        .collect()
}

/// A surface known by its facets: a patch or plane for each facet of the leaf.
#[derive(Clone, Debug)]
pub struct FittedSurface {
    triangles: Vec<[Vec3; 3]>,
    patch_of_triangle: Vec<u32>,
    tree: Bvh,
    patches: Vec<LocalPatch>,
    grain: f64,
    /// The triangle found last: the next question is mostly about a place beside. Answers do not depend on it.
    last: Arc<AtomicU32>,
}

#[derive(Clone, Debug)]
enum LocalPatch {
    Plane(Plane),
    Bspline {
        patch: BsplinePatch,
        /// The largest curvature that the facets show: what a patch has beyond is made up.
        most_curved: f64,
    },
}

impl FittedSurface {
    /// Fits all facets of a surface, from its retained and its killed facets.
    pub fn of(complex: &Complex, surface: SurfaceId) -> Self {
        Self::fit(&Sample::of(complex, surface))
    }

    fn fit(sample: &Sample) -> Self {
        let patches: Vec<LocalPatch> = sample.facets.par_iter().map(|facet| sample.fit_facet(facet)).collect();
        let triangles: Vec<[Vec3; 3]> = sample.triangles.iter().map(|t| t.0.map(|v| sample.points[v as usize])).collect();
        let boxes = triangles.iter().map(|t| Aabb::around(t.iter())).collect();
        let patch_of_triangle = sample.triangles.iter().map(|t| t.1).collect();
        let shortest = |[a, b, c]: &[Vec3; 3]| (b - a).norm().min((c - b).norm()).min((a - c).norm());
        let grain = GRAIN * triangles.iter().map(shortest).sum::<f64>() / triangles.len().max(1) as f64;
        Self { triangles, patch_of_triangle, tree: Bvh::new(boxes), patches, grain, last: Arc::default() }
    }

    pub(super) fn closest(&self, point: &Vec3) -> Foot {
        let nearest = self.nearest_triangle(point);
        match nearest.map(|t| &self.patches[self.patch_of_triangle[t as usize] as usize]) {
            Some(LocalPatch::Plane(plane)) => plane.closest(point),
            Some(LocalPatch::Bspline { patch, most_curved }) => {
                let mut foot = patch.closest(point);
                foot.bending *= (most_curved / foot.largest_curvature()).min(1.0);
                foot
            }
            None => Foot { point: *point, normal: Vec3::z(), bending: nalgebra::Matrix3::zeros() },
        }
    }

    /// Nearest triangle, the first of equally near ones.
    fn nearest_triangle(&self, point: &Vec3) -> Option<u32> {
        let distance = |t: u32| (closest_on_triangle(&self.triangles[t as usize], point) - point).norm_squared();
        let last = self.last.load(Ordering::Relaxed);
        let found = self.tree.nearest(point, ((last as usize) < self.triangles.len()).then_some(last), distance)?;
        self.last.store(found, Ordering::Relaxed);
        Some(found)
    }

    /// Steps from patch to patch below this are no steps.
    pub(super) fn grain(&self) -> f64 {
        self.grain
    }

    /// How many facets fell back to their plane, and how many there are.
    pub fn plane_count(&self) -> (usize, usize) {
        (self.patches.iter().filter(|p| matches!(p, LocalPatch::Plane(_))).count(), self.patches.len())
    }
}

/// The closest point of a triangle (Ericson, Real-Time Collision Detection, 5.1.5).
pub fn closest_on_triangle([a, b, c]: &[Vec3; 3], p: &Vec3) -> Vec3 {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(&ap), ac.dot(&ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return *a;
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(&bp), ac.dot(&bp));
    if d3 >= 0.0 && d4 <= d3 {
        return *b;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 && d1 > d3 {
        return a + ab * (d1 / (d1 - d3));
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(&cp), ac.dot(&cp));
    if d6 >= 0.0 && d5 <= d6 {
        return *c;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 && d2 > d6 {
        return a + ac * (d2 / (d2 - d6));
    }
    let va = d3 * d6 - d5 * d4;
    let (e, f) = (d4 - d3, d5 - d6);
    if va <= 0.0 && e >= 0.0 && f >= 0.0 && e + f > 0.0 {
        return b + (c - b) * (e / (e + f));
    }
    let sum = va + vb + vc;
    if sum > 0.0 { a + ab * (vb / sum) + ac * (vc / sum) } else { *a }
}

/// The facets of a surface as triangles over common vertices.
struct Sample {
    points: Vec<Vec3>,
    /// Whether the vertex was made by the intersection, on facets instead of the true surface.
    is_cut: Vec<bool>,
    /// Corners and facet.
    triangles: Vec<([u32; 3], u32)>,
    /// Triangles of each facet of the leaf.
    facets: Vec<Vec<u32>>,
    neighbours: HashMap<[u32; 2], Vec<u32>>,
    /// Triangles at each vertex.
    around: Vec<Vec<u32>>,
}

impl Sample {
    fn of(complex: &Complex, surface: SurfaceId) -> Self {
        let mut sample = Self {
            points: Vec::new(),
            is_cut: Vec::new(),
            triangles: Vec::new(),
            facets: Vec::new(),
            neighbours: HashMap::new(),
            around: Vec::new(),
        };
        let mut slot_of_point: HashMap<[u64; 3], u32> = HashMap::new();
        let mut slot_of_facet: BTreeMap<(LeafId, u32), u32> = BTreeMap::new();
        let mut add = |source: (LeafId, u32), corners: [(Vec3, bool); 3]| {
            let next = slot_of_facet.len() as u32;
            let facet = *slot_of_facet.entry(source).or_insert(next);
            let triangle = corners.map(|(point, is_cut)| {
                // Adding zero makes -0 and 0 one key.
                let key = [point.x, point.y, point.z].map(|x| (x + 0.0).to_bits());
                *slot_of_point.entry(key).or_insert_with(|| {
                    sample.points.push(point);
                    sample.is_cut.push(is_cut);
                    sample.points.len() as u32 - 1
                })
            });
            sample.triangles.push((triangle, facet));
        };
        for facet in complex.facets.iter().filter(|f| f.surface == surface) {
            for t in &facet.triangles {
                let corner = |v| (complex.vertices[v].point, complex.vertices[v].freedom == Freedom::Intersection);
                add(facet.source, t.map(corner));
            }
        }
        // Killed facets know their leaf only. One that is not part of a retained facet may belong to any surface of it; if not to
        // this one, sharp edges keep it out of the neighbourhoods.
        let leaf = complex.surfaces[surface].leaf;
        let owner: BTreeMap<(LeafId, u32), SurfaceId> =
            complex.facets.iter().filter(|f| f.source.0 == leaf).map(|f| (f.source, f.surface)).collect();
        for killed in complex.killed.iter().filter(|k| k.source.0 == leaf) {
            if owner.get(&killed.source).is_none_or(|s| *s == surface) {
                add(killed.source, killed.triangle.map(|p| (p, false)));
            }
        }
        sample.facets = vec![Vec::new(); slot_of_facet.len()];
        sample.around = vec![Vec::new(); sample.points.len()];
        for (t, (corners, facet)) in sample.triangles.iter().enumerate() {
            sample.facets[*facet as usize].push(t as u32);
            corners.iter().for_each(|&v| sample.around[v as usize].push(t as u32));
            for edge in edges_of(*corners) {
                sample.neighbours.entry(edge).or_default().push(t as u32);
            }
        }
        sample
    }

    fn area_vector(&self, triangle: u32) -> Vec3 {
        let [a, b, c] = self.triangles[triangle as usize].0.map(|v| self.points[v as usize]);
        (b - a).cross(&(c - a)) * 0.5
    }

    /// The patch of one facet, or its plane (2 % rule).
    fn fit_facet(&self, facet: &[u32]) -> LocalPatch {
        let normal: Vec3 = facet.iter().map(|&t| self.area_vector(t)).sum();
        let corners: Vec<Vec3> =
            facet.iter().flat_map(|&t| self.triangles[t as usize].0).map(|v| self.points[v as usize]).collect();
        let center = corners.iter().sum::<Vec3>() / corners.len() as f64;
        let plane = Plane::new(center, normal).unwrap_or(Plane { origin: center, normal: Vec3::z() });
        let (points, most_curved) = self.neighbourhood(facet, &normal);
        let size = Aabb::around(points.iter().map(|p| &p.0)).diagonal();
        match BsplinePatch::fit(plane, &points, Energy::ThinPlate) {
            Some(patch) if points.len() > 3 && patch.error() <= MAX_ERROR * size => {
                LocalPatch::Bspline { patch, most_curved: CURVED_MORE * most_curved }
            }
            _ => LocalPatch::Plane(plane),
        }
    }

    /// Points around a facet with their weights, and the largest curvature there: vertices ring by ring over smooth edges, until there are enough of them
    /// and they cover enough area, and the middles of the curved edges between them.
    fn neighbourhood(&self, facet: &[u32], own: &Vec3) -> (Vec<(Vec3, f64)>, f64) {
        let mut triangles: Vec<u32> = facet.to_vec();
        let mut seen: HashSet<u32> = facet.iter().copied().collect();
        let mut vertices: Vec<u32> = Vec::new();
        let mut edges: Vec<[u32; 2]> = Vec::new();
        let (mut next, mut area) = (0, 0.0);
        while next < triangles.len() {
            let t = triangles[next];
            let corners = self.triangles[t as usize].0;
            let normal = self.area_vector(t);
            vertices.extend(corners.iter().filter(|v| !vertices.contains(v)).copied().collect::<Vec<_>>());
            area += normal.norm();
            next += 1;
            edges.extend(edges_of(corners));
            let is_enough = vertices.len() >= POINTS && area >= AREA_FACTOR * own.norm();
            if next >= facet.len() && (is_enough || vertices.len() >= MOST_POINTS) {
                break;
            }
            for edge in edges_of(corners) {
                for &n in &self.neighbours[&edge] {
                    let other = self.area_vector(n);
                    let is_smooth = is_within(&other, &normal, CREASE_COSINE) && is_within(&other, own, TURN_COSINE);
                    if is_smooth && seen.insert(n) {
                        triangles.push(n);
                    }
                }
            }
        }
        edges.sort_unstable();
        edges.dedup();
        let most_curved = edges.iter().map(|&e| self.turn(e)).fold(0.0, f64::max);
        let points = |is_wanted: &dyn Fn(u32) -> bool| -> Vec<Vec3> {
            vertices.iter().filter(|v| is_wanted(**v)).map(|&v| self.points[v as usize]).collect()
        };
        let is_cut = |v: u32| self.is_cut[v as usize];
        let mut exact = points(&|v| !is_cut(v));
        let reach = |points: &[Vec3]| Aabb::around(points.iter()).diagonal();
        let is_covered = exact.len() > 5 && reach(&exact) >= COVERED * reach(&points(&|_| true));
        let cut = if is_covered { Vec::new() } else { points(&is_cut) };
        exact.extend(edges.iter().filter_map(|&e| self.middle(e)));
        let weighted = |points: Vec<Vec3>, weight: f64| points.into_iter().map(move |p| (p, weight));
        (weighted(exact, 1.0).chain(weighted(cut, CUT_WEIGHT)).collect(), most_curved)
    }

    /// Curvature across an edge between two facets: the sine of their angle over the distance of their centres from the edge.
    fn turn(&self, edge: [u32; 2]) -> f64 {
        let [a, b] = edge.map(|v| self.points[v as usize]);
        let [t, u] = self.neighbours[&edge][..] else { return 0.0 };
        let (m, n) = (self.area_vector(t), self.area_vector(u));
        if !is_within(&m, &n, CREASE_COSINE) {
            return 0.0;
        }
        // A third of the height of each triangle: two thirds of its area over the edge's length.
        let across = (m.norm() + n.norm()) * 2.0 / 3.0 / (b - a).norm();
        m.cross(&n).norm() / (m.norm() * n.norm() * across)
    }

    /// Where the surface passes the middle of an edge: that of a cubic curve with the tangents that the facets around its ends show
    /// (Vlachos and others, *Curved PN triangles*, 2001). None inside a facet, whose edges are chords, and where an intersection made
    /// an end.
    fn middle(&self, edge: [u32; 2]) -> Option<Vec3> {
        let beside = &self.neighbours[&edge];
        let is_inner = matches!(beside[..], [t, u] if self.triangles[t as usize].1 == self.triangles[u as usize].1);
        if is_inner || edge.iter().any(|&v| self.is_cut[v as usize]) {
            return None;
        }
        let mean: Vec3 = beside.iter().map(|&t| self.area_vector(t)).sum();
        let [a, b] = edge.map(|v| self.points[v as usize]);
        let [m, n] = [self.normal_at(edge[0], &mean)?, self.normal_at(edge[1], &mean)?];
        let d = b - a;
        Some((a + b) * 0.5 - (m * d.dot(&m) - n * d.dot(&n)) / 8.0)
    }

    /// Normal at a vertex of the facets that face about the same way, by their angles.
    fn normal_at(&self, vertex: u32, way: &Vec3) -> Option<Vec3> {
        let around = self.around[vertex as usize].iter().copied();
        let sum: Vec3 = around
            .map(|t| (t, self.area_vector(t)))
            .filter(|(_, n)| is_within(n, way, CREASE_COSINE))
            .filter_map(|(t, n)| Some(n.try_normalize(0.0)? * self.angle_at(vertex, t)))
            .sum();
        sum.try_normalize(0.0)
    }

    fn angle_at(&self, vertex: u32, triangle: u32) -> f64 {
        let at = self.points[vertex as usize];
        let others = self.triangles[triangle as usize].0.into_iter().filter(|&v| v != vertex);
        let mut ways = others.map(|v| self.points[v as usize] - at);
        let (Some(u), Some(v)) = (ways.next(), ways.next()) else { return 0.0 };
        libm::atan2(u.cross(&v).norm(), u.dot(&v))
    }
}

/// Edges of a triangle, smaller end first.
fn edges_of([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a.min(b), a.max(b)], [b.min(c), b.max(c)], [c.min(a), c.max(a)]]
}

/// Whether the angle between two vectors has at least this cosine.
fn is_within(a: &Vec3, b: &Vec3, cosine: f64) -> bool {
    a.dot(b) >= cosine * a.norm() * b.norm()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closest_on_triangle_in_all_zones() {
        let t = [Vec3::zeros(), Vec3::new(4.0, 0.0, 0.0), Vec3::new(0.0, 4.0, 0.0)];
        let foot = |x, y| closest_on_triangle(&t, &Vec3::new(x, y, 1.0));
        assert_eq!(foot(1.0, 1.0), Vec3::new(1.0, 1.0, 0.0));
        assert_eq!(foot(-1.0, -1.0), Vec3::zeros());
        assert_eq!(foot(2.0, -3.0), Vec3::new(2.0, 0.0, 0.0));
        assert_eq!(foot(9.0, 0.0), Vec3::new(4.0, 0.0, 0.0));
        assert_eq!(foot(4.0, 4.0), Vec3::new(2.0, 2.0, 0.0));
    }
}
