//! What a surface that is known by its facets shows: which points shape the patch of which facet (thesis 4.2.1, 4.2.2, 6.2).

use super::bspline::{BsplinePatch, Energy};
use super::fit::{LocalPatch, PatchShape};
use super::plane::Plane;
use crate::brep::complex::Complex;
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use crate::ids::{LeafId, SurfaceId};
use crate::primitive::solid::Freedom;
use std::collections::{BTreeMap, HashMap, HashSet, VecDeque};
use std::sync::Arc;

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

/// Share by which a curvature may pass the largest turn between facets: these are taken across a third of their widths.
const CURVED_MORE: f64 = 1.5;

/// Neighbours across an edge that bends more than this (40 degrees) belong to another smooth piece.
const CREASE_COSINE: f64 = 0.766;

/// The facets of a leaf, retained and killed, as triangles over common vertices.
#[derive(Clone, Debug, Default)]
pub(super) struct Sample {
    points: Vec<Vec3>,
    /// Whether the vertex was made by the intersection, on facets instead of the true surface.
    is_cut: Vec<bool>,
    triangles: Vec<Triangle>,
    /// Triangles of each facet of the leaf.
    facets: Vec<Vec<u32>>,
    neighbours: HashMap<[u32; 2], Vec<u32>>,
    /// Triangles at each vertex.
    around: Vec<Vec<u32>>,
}

#[derive(Clone, Copy, Debug)]
struct Triangle {
    corners: [u32; 3],
    facet: u32,
    /// Its surface; `None` if nothing of that is retained.
    owner: Option<SurfaceId>,
}

impl Sample {
    /// The samples of some leaves. Linear, up to the logarithm of ordered maps.
    pub fn of_leaves(complex: &Complex, leaves: impl Iterator<Item = LeafId>) -> BTreeMap<LeafId, Self> {
        let mut builders: BTreeMap<LeafId, Builder> = leaves.map(|l| (l, Builder::default())).collect();
        for facet in &complex.facets {
            let Some(builder) = builders.get_mut(&facet.source.0) else { continue };
            for t in &facet.triangles {
                let corner = |v| (complex.vertices[v].point, complex.vertices[v].freedom == Freedom::Intersection);
                builder.add(facet.source.1, Some(facet.surface), t.map(corner));
            }
        }
        for killed in &complex.killed {
            let Some(builder) = builders.get_mut(&killed.source.0) else { continue };
            let owner = builder.slot_of_facet.get(&killed.source.1).and_then(|f| builder.owner[*f as usize]);
            builder.add(killed.source.1, owner, killed.triangle.map(|p| (p, false)));
        }
        builders.into_iter().map(|(leaf, builder)| (leaf, builder.sample.linked().owned())).collect()
    }

    /// With what lies beside what.
    fn linked(mut self) -> Self {
        self.around = vec![Vec::new(); self.points.len()];
        for (t, triangle) in self.triangles.iter().enumerate() {
            self.facets[triangle.facet as usize].push(t as u32);
            triangle.corners.iter().for_each(|&v| self.around[v as usize].push(t as u32));
            for edge in edges_of(triangle.corners) {
                self.neighbours.entry(edge).or_default().push(t as u32);
            }
        }
        self
    }

    /// With owners for killed facets, which know their leaf only: the surface that they go on from, over smooth edges.
    fn owned(mut self) -> Self {
        let mut known: VecDeque<u32> = (0..self.triangles.len() as u32).filter(|&t| self.triangle(t).owner.is_some()).collect();
        while let Some(t) = known.pop_front() {
            for n in edges_of(self.triangle(t).corners).iter().flat_map(|edge| &self.neighbours[edge]) {
                if self.triangle(*n).owner.is_none() && is_within(&self.area_vector(*n), &self.area_vector(t), CREASE_COSINE) {
                    self.triangles[*n as usize].owner = self.triangle(t).owner;
                    known.push_back(*n);
                }
            }
        }
        self
    }

    fn triangle(&self, triangle: u32) -> &Triangle {
        &self.triangles[triangle as usize]
    }

    fn area_vector(&self, triangle: u32) -> Vec3 {
        let [a, b, c] = self.triangle(triangle).corners.map(|v| self.points[v as usize]);
        (b - a).cross(&(c - a)) * 0.5
    }
}

#[derive(Default)]
struct Builder {
    sample: Sample,
    slot_of_point: HashMap<[u64; 3], u32>,
    slot_of_facet: HashMap<u32, u32>,
    /// By facet: the surface of its retained pieces.
    owner: Vec<Option<SurfaceId>>,
}

impl Builder {
    fn add(&mut self, source: u32, owner: Option<SurfaceId>, corners: [(Vec3, bool); 3]) {
        let Self { sample, slot_of_point, slot_of_facet, owner: owners } = self;
        let facet = *slot_of_facet.entry(source).or_insert_with(|| {
            sample.facets.push(Vec::new());
            owners.push(owner);
            sample.facets.len() as u32 - 1
        });
        let corners = corners.map(|(point, is_cut)| {
            // Adding zero makes -0 and 0 one key.
            let key = [point.x, point.y, point.z].map(|x| (x + 0.0).to_bits());
            *slot_of_point.entry(key).or_insert_with(|| {
                sample.points.push(point);
                sample.is_cut.push(is_cut);
                sample.points.len() as u32 - 1
            })
        });
        sample.triangles.push(Triangle { corners, facet, owner });
    }
}

/// What a sample shows of one surface of its leaf.
#[derive(Clone, Debug)]
pub(super) struct SurfaceSample {
    leaf: Arc<Sample>,
    surface: SurfaceId,
}

impl SurfaceSample {
    pub fn new(leaf: Arc<Sample>, surface: SurfaceId) -> Self {
        Self { leaf, surface }
    }

    fn is_own(&self, triangle: u32) -> bool {
        self.leaf.triangle(triangle).owner == Some(self.surface)
    }

    /// The triangles of the surface with their facets.
    pub fn triangles(&self) -> impl Iterator<Item = ([Vec3; 3], u32)> + '_ {
        let own = self.leaf.triangles.iter().filter(|t| t.owner == Some(self.surface));
        own.map(|t| (t.corners.map(|v| self.leaf.points[v as usize]), t.facet))
    }

    /// The surface's triangles at an edge.
    fn beside(&self, edge: [u32; 2]) -> impl Iterator<Item = u32> + Clone + '_ {
        self.leaf.neighbours[&edge].iter().copied().filter(|&t| self.is_own(t))
    }

    fn corners(&self, triangle: u32) -> [u32; 3] {
        self.leaf.triangle(triangle).corners
    }

    fn area_vector(&self, triangle: u32) -> Vec3 {
        self.leaf.area_vector(triangle)
    }

    fn point(&self, vertex: u32) -> Vec3 {
        self.leaf.points[vertex as usize]
    }

    fn is_cut(&self, vertex: u32) -> bool {
        self.leaf.is_cut[vertex as usize]
    }

    /// How wide a facet is: its area, spread along its largest extent, for a triangle its height.
    fn width(&self, facet: &[u32]) -> f64 {
        let corners: Vec<Vec3> = facet.iter().flat_map(|&t| self.corners(t)).map(|v| self.point(v)).collect();
        let extent = Aabb::around(&corners).diagonal();
        2.0 * facet.iter().map(|&t| self.area_vector(t).norm()).sum::<f64>() / extent.max(f64::MIN_POSITIVE)
    }

    /// The patch of one facet, or its plane (2 % rule).
    pub fn fit_facet(&self, facet: u32) -> LocalPatch {
        let facet: Vec<u32> = self.leaf.facets[facet as usize].iter().copied().filter(|&t| self.is_own(t)).collect();
        let normal: Vec3 = facet.iter().map(|&t| self.area_vector(t)).sum();
        let corners: Vec<Vec3> = facet.iter().flat_map(|&t| self.corners(t)).map(|v| self.point(v)).collect();
        let center = corners.iter().sum::<Vec3>() / corners.len() as f64;
        let plane = Plane::new(center, normal).unwrap_or(Plane { origin: center, normal: Vec3::z() });
        let (points, most_curved) = self.neighbourhood(&facet, &normal);
        let size = Aabb::around(points.iter().map(|p| &p.0)).diagonal();
        let shape = match BsplinePatch::fit(plane, &points, Energy::ThinPlate) {
            Some(patch) if points.len() > 3 && patch.error() <= MAX_ERROR * size => {
                PatchShape::Bspline { patch, most_curved: CURVED_MORE * most_curved }
            }
            _ => PatchShape::Plane(plane),
        };
        LocalPatch { shape, width: self.width(&facet) }
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
            let corners = self.corners(t);
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
                for n in self.beside(edge) {
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
            vertices.iter().filter(|v| is_wanted(**v)).map(|&v| self.point(v)).collect()
        };
        let mut exact = points(&|v| !self.is_cut(v));
        let reach = |points: &[Vec3]| Aabb::around(points.iter()).diagonal();
        let is_covered = exact.len() > 5 && reach(&exact) >= COVERED * reach(&points(&|_| true));
        let cut = if is_covered { Vec::new() } else { points(&|v| self.is_cut(v)) };
        exact.extend(edges.iter().filter_map(|&e| self.middle(e)));
        let weighted = |points: Vec<Vec3>, weight: f64| points.into_iter().map(move |p| (p, weight));
        (weighted(exact, 1.0).chain(weighted(cut, CUT_WEIGHT)).collect(), most_curved)
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

    /// Where the surface passes the middle of an edge: that of a cubic curve with the tangents that the facets around its ends show
    /// (Vlachos and others, *Curved PN triangles*, 2001). None inside a facet, whose edges are chords, and where an intersection made
    /// an end.
    fn middle(&self, edge: [u32; 2]) -> Option<Vec3> {
        let mut facets = self.beside(edge).map(|t| self.leaf.triangle(t).facet);
        let is_inner = matches!((facets.next(), facets.next(), facets.next()), (Some(f), Some(g), None) if f == g);
        if is_inner || edge.iter().any(|&v| self.is_cut(v)) {
            return None;
        }
        let mean: Vec3 = self.beside(edge).map(|t| self.area_vector(t)).sum();
        let [a, b] = edge.map(|v| self.point(v));
        let [m, n] = [self.normal_at(edge[0], &mean)?, self.normal_at(edge[1], &mean)?];
        let d = b - a;
        Some((a + b) * 0.5 - (m * d.dot(&m) - n * d.dot(&n)) / 8.0)
    }

    /// Normal at a vertex of the facets that face about the same way, by their angles.
    fn normal_at(&self, vertex: u32, way: &Vec3) -> Option<Vec3> {
        let around = self.leaf.around[vertex as usize].iter().copied().filter(|&t| self.is_own(t));
        let sum: Vec3 = around
            .map(|t| (t, self.area_vector(t)))
            .filter(|(_, n)| is_within(n, way, CREASE_COSINE))
            .filter_map(|(t, n)| Some(n.try_normalize(0.0)? * self.angle_at(vertex, t)))
            .sum();
        sum.try_normalize(0.0)
    }

    fn angle_at(&self, vertex: u32, triangle: u32) -> f64 {
        let at = self.point(vertex);
        let others = self.corners(triangle).into_iter().filter(|&v| v != vertex);
        let mut ways = others.map(|v| self.point(v) - at);
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
