//! Surfaces that are known by their facets: these as triangles over common vertices, with what lies beside what.

use crate::brep::complex::Complex;
use crate::geom::Vec3;
use crate::ids::{LeafId, SurfaceId};
use crate::primitive::solid::Freedom;
use std::collections::{BTreeMap, HashMap, VecDeque};
use std::sync::Arc;

/// Neighbours across an edge that bends more than this (40 degrees) belong to another smooth piece.
pub(super) const CREASE_COSINE: f64 = 0.766;

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
    pub fn beside(&self, edge: [u32; 2]) -> impl Iterator<Item = u32> + Clone + '_ {
        self.leaf.neighbours[&edge].iter().copied().filter(|&t| self.is_own(t))
    }

    pub fn corners(&self, triangle: u32) -> [u32; 3] {
        self.leaf.triangle(triangle).corners
    }

    pub fn area_vector(&self, triangle: u32) -> Vec3 {
        self.leaf.area_vector(triangle)
    }

    pub fn facet_of(&self, triangle: u32) -> u32 {
        self.leaf.triangle(triangle).facet
    }

    /// The surface's triangles of a facet.
    pub fn pieces_of(&self, facet: u32) -> Vec<u32> {
        self.leaf.facets[facet as usize].iter().copied().filter(|&t| self.is_own(t)).collect()
    }

    /// The surface's triangles at a vertex.
    pub fn around(&self, vertex: u32) -> impl Iterator<Item = u32> + '_ {
        self.leaf.around[vertex as usize].iter().copied().filter(|&t| self.is_own(t))
    }

    pub fn point(&self, vertex: u32) -> Vec3 {
        self.leaf.points[vertex as usize]
    }

    pub fn is_cut(&self, vertex: u32) -> bool {
        self.leaf.is_cut[vertex as usize]
    }
}

/// Edges of a triangle, smaller end first.
pub(super) fn edges_of([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a.min(b), a.max(b)], [b.min(c), b.max(c)], [c.min(a), c.max(a)]]
}

/// Whether the angle between two vectors has at least this cosine.
pub(super) fn is_within(a: &Vec3, b: &Vec3, cosine: f64) -> bool {
    a.dot(b) >= cosine * a.norm() * b.norm()
}
