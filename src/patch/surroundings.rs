//! Which points shape the patch of which facet (thesis 4.2.1, 4.2.2, 6.2).

use super::bspline::{BsplinePatch, Energy};
use super::fit::{LocalPatch, PatchShape, closest_on_triangle};
use super::plane::Plane;
use super::sample::{CREASE_COSINE, SurfaceSample, edges_of, is_within};
use super::support::any_normal_to;
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use std::collections::HashSet;

/// A patch is dropped for its facet's plane if it errs by more than this fraction of its extent (thesis 4.2.2: 2 %).
const MAX_ERROR: f64 = 0.02;

/// Points that shape a patch: the thesis takes 15 by count; here neighbours are gathered until they also cover this many
/// times the facet's area (thesis 6.2), at most 30 of them, and, but for the facet's own neighbours, as long as they turn from
/// it by less than 30 degrees: a patch is a height over the facet's plane, and nine strips of a cylinder would be more than
/// half of it.
const POINTS: usize = 15;
const MOST_POINTS: usize = 30;
const AREA_FACTOR: f64 = 9.0;
const TURN_COSINE: f64 = 0.866;

/// Weight of vertices that an intersection made: they are on chords of the surface, and matter where there are no others.
const CUT_WEIGHT: f64 = 0.01;

/// Points along one edge at most, besides its ends: one for every width of the facet.
const MOST_ALONG: f64 = 7.0;

/// Facets whose normals have an angle of at least this cosine (0.1 degrees) are in one plane.
const FLAT_COSINE: f64 = 1.0 - 1.5e-6;

/// Share by which a curvature may pass the largest turn between facets: these are taken across a third of their widths.
const CURVED_MORE: f64 = 1.5;

/// What is around a facet.
struct Surroundings {
    /// Points of the surface with their weights.
    points: Vec<(Vec3, f64)>,
    /// The largest curvature.
    most_curved: f64,
    /// The direction in which the facets turn most.
    across: Vec3,
}

impl SurfaceSample {
    /// The patch of one facet, or its plane (2 % rule).
    pub fn fit_facet(&self, facet: u32) -> LocalPatch {
        let facet = self.pieces_of(facet);
        let normal: Vec3 = facet.iter().map(|&t| self.area_vector(t)).sum();
        let corners: Vec<Vec3> = facet.iter().flat_map(|&t| self.corners(t)).map(|v| self.point(v)).collect();
        let center = corners.iter().sum::<Vec3>() / corners.len() as f64;
        let plane = Plane::new(center, normal).unwrap_or(Plane { origin: center, normal: Vec3::z() });
        // A facet's area, spread along its largest extent: the height of a triangle.
        let width = normal.norm() * 2.0 / Aabb::around(&corners).diagonal().max(f64::MIN_POSITIVE);
        let Surroundings { points, most_curved, across } = self.surroundings(&facet, &plane, width);
        let size = Aabb::around(points.iter().map(|p| &p.0)).diagonal();
        let shape = match BsplinePatch::fit(plane, &across, &points, Energy::ThinPlate) {
            Some(patch) if points.len() > 3 && patch.error() <= MAX_ERROR * size => {
                PatchShape::Bspline { patch: Box::new(patch), most_curved: CURVED_MORE * most_curved }
            }
            _ => PatchShape::Plane(plane),
        };
        LocalPatch { shape, width }
    }

    /// What is around a facet of a plane and a width: vertices of the triangles near, and points of the curved edges between
    /// them.
    fn surroundings(&self, facet: &[u32], plane: &Plane, width: f64) -> Surroundings {
        let triangles = self.near(facet);
        let mut vertices: Vec<u32> = triangles.iter().flat_map(|&t| self.corners(t)).collect();
        let mut edges: Vec<[u32; 2]> = triangles.iter().flat_map(|&t| edges_of(self.corners(t))).collect();
        vertices.sort_unstable();
        vertices.dedup();
        edges.sort_unstable();
        edges.dedup();
        let weight = |v: u32| if self.is_cut(v) { CUT_WEIGHT } else { 1.0 };
        let corners = vertices.iter().map(|&v| (self.point(v), weight(v)));
        let lighter = |[a, b]: [u32; 2]| weight(a).min(weight(b));
        let between = edges.iter().flat_map(|&e| self.points_along(e, width).into_iter().map(move |p| (p, lighter(e))));
        Surroundings {
            points: corners.chain(between).map(|(p, weight)| (p, weight * self.nearness(&p, facet, width))).collect(),
            most_curved: edges.iter().map(|&e| self.turn(e)).fold(0.0, f64::max),
            across: self.turning(&triangles, plane),
        }
    }

    /// Triangles around a facet, ring by ring over smooth edges, until their vertices are enough and they cover enough area.
    fn near(&self, facet: &[u32]) -> Vec<u32> {
        let own: Vec3 = facet.iter().map(|&t| self.area_vector(t)).sum();
        let mut triangles: Vec<u32> = facet.to_vec();
        let mut seen: HashSet<u32> = facet.iter().copied().collect();
        let mut vertices: Vec<u32> = Vec::new();
        let (mut next, mut area) = (0, 0.0);
        while next < triangles.len() {
            let t = triangles[next];
            let corners = self.corners(t);
            let normal = self.area_vector(t);
            corners.iter().for_each(|v| {
                if !vertices.contains(v) {
                    vertices.push(*v)
                }
            });
            area += normal.norm();
            next += 1;
            let is_enough = vertices.len() >= POINTS && area >= AREA_FACTOR * own.norm();
            if next >= facet.len() && (is_enough || vertices.len() >= MOST_POINTS) {
                break;
            }
            for n in edges_of(corners).into_iter().flat_map(|edge| self.beside(edge)) {
                let other = self.area_vector(n);
                let is_beside = next <= facet.len() || is_within(&other, &own, TURN_COSINE);
                let is_smooth = is_beside && is_within(&other, &normal, CREASE_COSINE);
                if is_smooth && seen.insert(n) {
                    triangles.push(n);
                }
            }
        }
        triangles.truncate(next);
        triangles
    }

    /// Weight of a point: the patch is looked at over its facet only, and is to be right there.
    fn nearness(&self, point: &Vec3, facet: &[u32], width: f64) -> f64 {
        let distance = |t: &u32| (closest_on_triangle(&self.corners(*t).map(|v| self.point(v)), point) - point).norm_squared();
        let square = facet.iter().map(distance).fold(f64::INFINITY, f64::min) / (width * width).max(f64::MIN_POSITIVE);
        1.0 / ((1.0 + square) * (1.0 + square))
    }

    /// The direction in a plane in which the normals of some triangles differ most: across the rulings of a cylinder.
    fn turning(&self, triangles: &[u32], plane: &Plane) -> Vec3 {
        let u = any_normal_to(&plane.normal);
        let v = plane.normal.cross(&u);
        let normals =
            triangles.iter().filter_map(|&t| Some((self.area_vector(t).try_normalize(0.0)?, self.area_vector(t).norm())));
        let [a, b, c] = normals
            .map(|(n, area)| [u.dot(&n), v.dot(&n), area])
            .fold([0.0; 3], |[a, b, c], [x, y, w]| [a + w * x * x, b + w * x * y, c + w * y * y]);
        let angle = 0.5 * libm::atan2(2.0 * b, a - c);
        u * libm::cos(angle) + v * libm::sin(angle)
    }

    /// Curvature across an edge between two facets: the sine of their angle over the distance of their centres from the edge.
    fn turn(&self, edge: [u32; 2]) -> f64 {
        let [a, b] = edge.map(|v| self.point(v));
        let mut beside = self.beside(edge);
        let (Some(t), Some(u), None) = (beside.next(), beside.next(), beside.next()) else { return 0.0 };
        let (m, n) = (self.area_vector(t), self.area_vector(u));
        if !is_within(&m, &n, CREASE_COSINE) {
            return 0.0;
        }
        // A third of the height of each triangle: two thirds of its area over the edge's length.
        let across = (m.norm() + n.norm()) * 2.0 / 3.0 / (b - a).norm();
        m.cross(&n).norm() / (m.norm() * n.norm() * across)
    }

    /// Where the surface passes between the ends of an edge: on a cubic curve with the tangents that the facets around its ends
    /// show (Vlachos and others, *Curved PN triangles*, 2001), one point for every `width`. None inside a facet, whose edges
    /// are chords.
    fn points_along(&self, edge: [u32; 2], width: f64) -> Vec<Vec3> {
        let mut facets = self.beside(edge).map(|t| self.facet_of(t));
        let is_inner = matches!((facets.next(), facets.next(), facets.next()), (Some(f), Some(g), None) if f == g);
        if is_inner {
            return Vec::new();
        }
        let mean: Vec3 = self.beside(edge).map(|t| self.area_vector(t)).sum();
        let [a, b] = edge.map(|v| self.point(v));
        let d = b - a;
        // Bezier's points are a, a + (d - m d.m) / 3, b - (d - n d.n) / 3, b. An end that shows nothing bends as the other
        // does.
        let [m, n] = edge.map(|v| self.normal_at(v, &mean).map(|n| n * d.dot(&n)));
        let (m, n) = match (m, n) {
            (Some(m), n) => (m, n.unwrap_or(-m)),
            (None, Some(n)) => (-n, n),
            (None, None) => (Vec3::zeros(), Vec3::zeros()),
        };
        let count = (d.norm() / width).clamp(1.0, MOST_ALONG) as usize;
        let at = |k: usize| {
            let t = (k + 1) as f64 / (count + 1) as f64;
            a + d * t - (m * (1.0 - t) - n * t) * (t * (1.0 - t))
        };
        (0..count).map(at).collect()
    }

    /// Normal at a vertex of the facets that face about the same way, by their angles; `None` if these are in one plane, or an
    /// intersection made the vertex.
    fn normal_at(&self, vertex: u32, way: &Vec3) -> Option<Vec3> {
        let around = self.around(vertex).map(|t| (t, self.area_vector(t))).filter(|(_, n)| is_within(n, way, CREASE_COSINE));
        let around: Vec<(u32, Vec3)> = around.filter_map(|(t, n)| Some((t, n.try_normalize(0.0)?))).collect();
        let is_flat = around.iter().all(|(_, n)| is_within(n, &around[0].1, FLAT_COSINE));
        let sum: Vec3 = around.iter().map(|(t, n)| n * self.angle_at(vertex, *t)).sum();
        if is_flat || self.is_cut(vertex) { None } else { sum.try_normalize(0.0) }
    }

    fn angle_at(&self, vertex: u32, triangle: u32) -> f64 {
        let at = self.point(vertex);
        let others = self.corners(triangle).into_iter().filter(|&v| v != vertex);
        let mut ways = others.map(|v| self.point(v) - at);
        let (Some(u), Some(v)) = (ways.next(), ways.next()) else { return 0.0 };
        libm::atan2(u.cross(&v).norm(), u.dot(&v))
    }
}
