//! Facets of one leaf that lie in one plane and hang together, as the triangles of an import do: walls.

use super::body::Body;
use super::edges::EdgeSet;
use super::outline::Outline;
use crate::geom::Vec3;
use crate::geom::lists::Lists;
use crate::geom::union_find::UnionFind;

/// Sine of the angle between two facets up to which they are one wall: rounding of an import in single precision, no more than
/// what a point on the edge between them may be off by.
const FLAT_SINE: f64 = 1e-7;

/// Walls, called by their first facet; nothing at all if none has several.
#[derive(Default)]
pub(super) struct Walls {
    of_facet: Vec<u32>,
    /// For every wall, the edges inside.
    divisions: Lists,
    /// For every wall of several facets, those.
    facets: Lists,
    /// Outlines of active facets as they came.
    outlines: Vec<Option<Outline>>,
}

impl Walls {
    /// Walls of active facets. O(n) in them.
    pub fn new(body: &Body, set: &EdgeSet) -> Self {
        let normals: Vec<Vec3> = (0..body.facet_count() as u32)
            .map(|f| if set.is_active[f as usize] { body.normal(f) } else { Vec3::zeros() })
            .collect();
        let is_flat = |f: u32, g: u32| {
            let [a, b] = [f, g].map(|f| normals[f as usize]);
            a.dot(&b) > 0.0 && a.cross(&b).norm() <= FLAT_SINE
        };
        let mut sets = UnionFind::new(body.facet_count());
        let mut inner: Vec<(u32, u32)> = Vec::new();
        let by_leaf = |edge: u32| set.uses.of(edge).chunk_by(|a, b| a.0 == b.0).map(move |uses| (edge, uses));
        for (edge, uses) in (0..set.edges.len() as u32).flat_map(by_leaf) {
            if let &[(_, f), (_, g)] = uses
                && !body.fate(f).is_aside()
                && !body.fate(g).is_aside()
                && is_flat(f, g)
            {
                sets.join(f, g);
                inner.push((f, edge));
            }
        }
        if inner.is_empty() {
            return Self::default();
        }
        let is_compared = |f: u32| set.is_active[f as usize] && !body.fate(f).is_aside();
        let outline = |f: u32| is_compared(f).then(|| Outline::new(f, body.loops(f), None, &body.points));
        let outlines: Vec<Option<Outline>> = (0..body.facet_count() as u32).map(outline).collect();
        let of_facet: Vec<u32> = (0..body.facet_count() as u32).map(|f| sets.find(f)).collect();
        inner.iter_mut().for_each(|i| i.0 = of_facet[i.0 as usize]);
        let facets: Vec<(u32, u32)> = of_facet.iter().zip(0..).map(|(&wall, f)| (wall, f)).collect();
        Self {
            divisions: Lists::new(body.facet_count(), &inner),
            facets: Lists::new(body.facet_count(), &facets),
            of_facet,
            outlines,
        }
    }
    /// Whether every wall is one facet.
    pub fn is_empty(&self) -> bool {
        self.divisions.is_empty()
    }
    /// Edges inside a wall.
    pub fn divisions(&self, wall: u32) -> &[u32] {
        self.divisions.of(wall)
    }
    /// Whether a wall has several facets.
    pub fn is_divided(&self, wall: u32) -> bool {
        !self.divisions(wall).is_empty()
    }
    /// Unit normal.
    pub fn normal(&self, wall: u32) -> Vec3 {
        self.outlines[wall as usize].as_ref().map_or(Vec3::zeros(), |o| o.normal)
    }
    /// Whether a place in the plane of the wall lies inside it.
    pub fn enclose(&self, wall: u32, p: &Vec3, body: &Body) -> bool {
        let outlines = self.facets.of(wall).iter().filter_map(|&f| self.outlines[f as usize].as_ref());
        outlines.filter(|o| o.encloses(p, &body.points)).count() % 2 == 1
    }
    /// The points on edges of walls: (point, wall).
    pub fn points(&self, set: &EdgeSet) -> Vec<(u32, u32)> {
        let mut points = Vec::new();
        for edge in 0..set.edges.len() as u32 {
            for &(_, facet) in set.uses.of(edge).iter().filter(|u| self.outlines[u.1 as usize].is_some()) {
                let wall = self.of_facet[facet as usize];
                points.extend(set.points_between(edge, [0.0, 1.0]).map(|v| (v, wall)));
            }
        }
        points
    }
}
