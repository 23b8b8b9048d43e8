//! The leaves under one numbering of facets, over welded points.

use super::conforming::Owner;
use super::outline::sides;
use super::weld::{self, PointGrid, Welded};
use crate::cull::{Fate, Piece};
use crate::diag::{Name, Outcome};
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use crate::ids::LeafId;
use crate::primitive::solid::{Solid, Walks};

/// Smallest tolerance in units in the last place of the largest coordinate: below this, the vertices that a primitive computes
/// for one place need not agree.
const SMALLEST_TOLERANCE_ULPS: f64 = 4.0;

/// How leaves are called in messages.
pub(super) type Names<'a> = &'a dyn Fn(LeafId) -> Name;

/// All leaves: facet f of leaf l has the number `first_facet[l] + f`.
pub(super) struct Body<'a> {
    pub solids: &'a [Solid],
    /// Tolerance of every leaf, absolute.
    pub tolerances: Vec<f64>,
    /// First facet of every leaf, and the number of all.
    pub first_facet: Vec<u32>,
    pub leaf_of_facet: Vec<u32>,
    /// First entry of every leaf in `point_of_vertex`.
    pub first_vertex: Vec<u32>,
    /// For every vertex of every leaf, its point.
    pub point_of_vertex: Vec<u32>,
    pub points: Vec<Vec3>,
    pub grid: PointGrid,
    /// What is known to become of every facet; empty if nothing is.
    fates: Vec<Fate>,
}

impl<'a> Body<'a> {
    /// Numbers facets and welds vertices.
    pub fn new(
        solids: &'a [Solid],
        pieces: &[Vec<Piece>],
        tolerance: f64,
        own: &[Option<f64>],
        bounds: &Aabb,
        names: Names,
    ) -> Outcome<Self> {
        let reach = solids.iter().map(|s| reach(s, bounds)).fold(f64::MIN_POSITIVE, f64::max);
        let floor = SMALLEST_TOLERANCE_ULPS * f64::EPSILON * reach;
        let tolerances: Vec<f64> =
            (0..solids.len()).map(|k| own.get(k).copied().flatten().unwrap_or(tolerance).max(floor)).collect();
        let welded = weld::weld(solids, &tolerances, names)?;
        let fates = pieces.iter().flatten().map(|p| p.fate).collect();
        Ok(Self { fates, ..Self::with(solids, tolerances, welded) })
    }
    /// Numbers facets; every vertex stays a point of its own.
    pub fn apart(solids: &'a [Solid], tolerance: f64) -> Self {
        let points: Vec<Vec3> = solids.iter().flat_map(|s| &s.vertices).map(|v| v.point).collect();
        let point_of_vertex = (0..points.len() as u32).collect();
        Self::with(solids, vec![tolerance; solids.len()], Welded { points, point_of_vertex, grid: PointGrid::default() })
    }
    fn with(solids: &'a [Solid], tolerances: Vec<f64>, welded: Welded) -> Self {
        let (mut first_facet, mut first_vertex) = (vec![0], vec![0]);
        let mut leaf_of_facet = Vec::with_capacity(solids.iter().map(|s| s.facets.len()).sum());
        for (k, solid) in solids.iter().enumerate() {
            leaf_of_facet.resize(leaf_of_facet.len() + solid.facets.len(), k as u32);
            first_facet.push(leaf_of_facet.len() as u32);
            first_vertex.push(first_vertex[k] + solid.vertices.len() as u32);
        }
        let Welded { points, point_of_vertex, grid } = welded;
        Self { solids, tolerances, first_facet, leaf_of_facet, first_vertex, point_of_vertex, points, grid, fates: Vec::new() }
    }

    /// The tolerance between two leaves: the coarser of theirs.
    pub fn tolerance(&self, a: u32, b: u32) -> f64 {
        self.tolerances[a as usize].max(self.tolerances[b as usize])
    }
    /// What is known to become of a facet.
    pub fn fate(&self, facet: u32) -> Fate {
        self.fates.get(facet as usize).copied().unwrap_or_default()
    }
    /// Number of facets of all leaves.
    pub fn facet_count(&self) -> usize {
        self.leaf_of_facet.len()
    }
    /// The loops of a facet as vertices of its leaf.
    pub fn own_loops(&self, facet: u32) -> Walks<'a> {
        let leaf = self.leaf_of_facet[facet as usize];
        self.solids[leaf as usize].facets.of(facet - self.first_facet[leaf as usize]).loops
    }
    /// Whether a facet is one triangle.
    pub fn is_triangle(&self, facet: u32) -> bool {
        self.own_loops(facet).count() == 1 && self.own_loops(facet).outer().len() == 3
    }
    /// The corners of a facet that is one triangle, as points.
    pub fn triangle(&self, facet: u32) -> [u32; 3] {
        let ids = self.points_of_leaf(self.leaf_of_facet[facet as usize]);
        let walk = self.own_loops(facet).outer();
        [0, 1, 2].map(|k| ids[walk[k] as usize])
    }
    /// The point of each vertex of the facet's leaf.
    pub fn points_of_leaf(&self, leaf: u32) -> &[u32] {
        &self.point_of_vertex[self.first_vertex[leaf as usize] as usize..self.first_vertex[leaf as usize + 1] as usize]
    }
    /// The loops of a facet as points.
    pub fn loops(&self, facet: u32) -> Vec<Vec<u32>> {
        let ids = self.points_of_leaf(self.leaf_of_facet[facet as usize]);
        self.own_loops(facet).iter().map(|w| w.iter().map(|&v| ids[v as usize]).collect()).collect()
    }
    /// Unit normal of a facet before the weld, outwards.
    pub fn normal(&self, facet: u32) -> Vec3 {
        let vertices = &self.solids[self.leaf_of_facet[facet as usize] as usize].vertices;
        unit_normal(self.own_loops(facet), |v| vertices[v as usize].point)
    }
    /// The box of a facet before the weld.
    pub fn bounds(&self, facet: u32) -> Aabb {
        let vertices = &self.solids[self.leaf_of_facet[facet as usize] as usize].vertices;
        Aabb::around(self.own_loops(facet).outer().iter().map(|&v| &vertices[v as usize].point))
    }
    /// A facet as the owner of a cell.
    pub fn owner(&self, facet: u32, is_flipped: bool) -> Owner {
        let leaf = self.leaf(facet);
        Owner { leaf, facet: facet - self.first_facet[leaf.0 as usize], is_flipped }
    }
    /// Leaf of a facet as an id.
    pub fn leaf(&self, facet: u32) -> LeafId {
        LeafId(self.leaf_of_facet[facet as usize])
    }
}

/// The largest coordinate that says where a solid is within the bounds of the model: those of vertices there, and of facets
/// that come there the part along their normals. A tool that is much larger is known no better far out, but that decides
/// nothing.
fn reach(solid: &Solid, bounds: &Aabb) -> f64 {
    let at = |v: &u32| &solid.vertices[*v as usize].point;
    let own = Aabb::around(solid.vertices.iter().map(|v| &v.point));
    if own.is_empty() || bounds.contains(&own.lo) && bounds.contains(&own.hi) {
        return solid.vertices.iter().fold(0.0, |m, v| m.max(v.point.amax()));
    }
    let inside = solid.vertices.iter().filter(|v| bounds.contains(&v.point)).fold(0.0, |m: f64, v| m.max(v.point.amax()));
    let across = solid.facets.iter().filter(|f| Aabb::around(f.loops.outer().iter().map(at)).overlaps(bounds)).map(|f| {
        let normal = unit_normal(f.loops, |v| *at(&v));
        f.loops.corners().fold(0.0, |m: f64, v| m.max(at(&v).component_mul(&normal).amax()))
    });
    across.fold(inside, f64::max)
}

/// Unit normal of loops, outwards.
fn unit_normal(loops: Walks, at: impl Fn(u32) -> Vec3) -> Vec3 {
    let Some(&first) = loops.outer().first() else { return Vec3::zeros() };
    let side = |[a, b]: [u32; 2]| (at(a) - at(first)).cross(&(at(b) - at(first)));
    sides(loops.iter()).map(side).sum::<Vec3>().try_normalize(0.0).unwrap_or(Vec3::zeros())
}
