//! What is drawn on the triangles: points on edges, points inside, segments and pieces of edges.

use super::intersect::{Contact, Corners, Hit, Meeting, Spot};
use super::point::{Points, Source};
use crate::contact::conforming::{Conforming, Owner};
use crate::cull::Fate;
use crate::geom::hash::{IndexMap, IndexSet};
use crate::geom::predicates::Projection;
use rayon::prelude::*;
use std::cmp::Ordering;

/// Stands for the edges of triangles that nothing comes near.
const NO_EDGE: u32 = u32::MAX;

/// The input's triangles with their edges.
pub struct Mesh<'a> {
    /// The cells.
    pub input: &'a Conforming,
    /// Triangles.
    pub triangles: &'a [[u32; 3]],
    /// Triangles of the cells that something comes near; only these have projections and edges.
    pub near: Vec<u32>,
    /// Projection of each triangle in which it turns counter-clockwise.
    pub projection: Vec<Projection>,
    /// Edge k of each triangle, from corner k to corner k + 1.
    edges_of: Vec<[u32; 3]>,
    /// Ends of each edge, smaller number first.
    pub edges: Vec<[u32; 2]>,
}

impl<'a> Mesh<'a> {
    /// Chooses the triangles that matter and their projections.
    pub fn new(input: &'a Conforming) -> Self {
        let triangles = &input.triangles[..];
        let is_near = |&t: &u32| input.cells[input.cell_of_triangle[t as usize] as usize].is_near;
        let near: Vec<u32> = (0..triangles.len() as u32).filter(is_near).collect();
        let mut projection = vec![Projection { u: 0, v: 1 }; triangles.len()];
        for &t in &near {
            projection[t as usize] = super::projection_of_triangle(input, triangles[t as usize]);
        }
        Self { input, triangles, near, projection, edges_of: Vec::new(), edges: Vec::new() }
    }

    /// Numbers the edges.
    pub fn number_edges(&mut self) {
        let mut keys: Vec<(u64, u32)> = Vec::with_capacity(3 * self.near.len());
        for &t in &self.near {
            let corners = self.triangles[t as usize];
            for k in 0..3 {
                let (a, b) = (corners[k], corners[(k + 1) % 3]);
                keys.push((u64::from(a.min(b)) << 32 | u64::from(a.max(b)), 3 * t + k as u32));
            }
        }
        keys.par_sort_unstable();
        self.edges_of = vec![[NO_EDGE; 3]; self.triangles.len()];
        let mut last = u64::MAX;
        for (key, slot) in keys {
            if key != last {
                self.edges.push([(key >> 32) as u32, key as u32]);
                last = key;
            }
            self.edges_of[slot as usize / 3][slot as usize % 3] = self.edges.len() as u32 - 1;
        }
    }

    /// Edge k of a near triangle, from corner k to corner k + 1.
    pub fn edge_of(&self, t: u32, k: u8) -> u32 {
        self.edges_of[t as usize][k as usize]
    }

    /// Owners of a triangle's cell.
    pub fn owners(&self, t: u32) -> &'a [Owner] {
        self.input.owners_of_triangle(t)
    }

    /// Sheet of a triangle's cell.
    pub fn sheet_of(&self, t: u32) -> u32 {
        self.input.cells[self.input.cell_of_triangle[t as usize] as usize].sheet
    }

    /// What is known to become of a triangle's cell.
    pub fn fate_of(&self, t: u32) -> Fate {
        self.input.cells[self.input.cell_of_triangle[t as usize] as usize].fate
    }

    /// Whether two triangles belong to a common leaf.
    pub fn has_common_leaf(&self, t: u32, u: u32) -> bool {
        let (a, b) = (self.owners(t), self.owners(u));
        a.iter().any(|x| b.iter().any(|y| x.leaf == y.leaf))
    }

    /// A triangle with its corners.
    pub fn corners(&self, t: u32) -> Corners<'a> {
        let ids = self.triangles[t as usize];
        Corners { ids, at: ids.map(|v| &self.input.points[v as usize]), projection: self.projection[t as usize] }
    }
}

/// A curve that is cut into pieces.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub enum Curve {
    /// An edge of the input.
    Edge(u32),
    /// A segment in which two triangles cross.
    Segment(u32),
}

/// A stretch of a curve on a triangle.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub struct StringPiece {
    /// The curve.
    pub curve: Curve,
    /// First and last point.
    pub ends: [u32; 2],
}

/// A segment in which two triangles cross.
#[derive(Clone, Debug)]
pub struct Segment {
    /// Its ends.
    pub ends: [u32; 2],
    /// The two triangles.
    pub triangles: [u32; 2],
    /// Further points on it.
    pub points: Vec<u32>,
}

/// What is drawn on one triangle besides points on its edges.
#[derive(Clone, Debug, Default)]
pub struct Drawing {
    /// Points inside.
    pub points: Vec<u32>,
    /// Strings.
    pub strings: Vec<StringPiece>,
}

/// All drawings, and the points on the curves that they share.
pub struct Graph {
    /// Further points on each edge.
    pub edge_points: Vec<Vec<u32>>,
    /// Segments.
    pub segments: Vec<Segment>,
    /// Drawing of each triangle that has one.
    pub drawings: Vec<Drawing>,
    /// For each triangle, its drawing, or `u32::MAX`.
    pub drawing_of: Vec<u32>,
    /// Triangles with a coplanar partner that they touch.
    pub is_coplanar: IndexSet<u32>,
}

impl Graph {
    /// Enters all contacts, in order.
    pub fn new(mesh: &Mesh, contacts: &[(u32, u32, Contact)], points: &mut Points) -> Self {
        let mut graph = Self {
            edge_points: vec![Vec::new(); mesh.edges.len()],
            segments: Vec::new(),
            drawings: Vec::new(),
            drawing_of: vec![u32::MAX; mesh.triangles.len()],
            is_coplanar: IndexSet::default(),
        };
        // On closed curves there are as many points as pairs of triangles.
        points.reserve(contacts.len());
        let mut seen = vec![false; points.explicit_len()];
        for &(t, u, _) in contacts {
            for v in mesh.triangles[t as usize].into_iter().chain(mesh.triangles[u as usize]) {
                if !std::mem::replace(&mut seen[v as usize], true) {
                    points.register(v);
                }
            }
        }
        let mut made = Made::default();
        for (t, u, contact) in contacts {
            graph.enter(mesh, [*t, *u], contact, points, &mut made);
        }
        for list in &mut graph.edge_points {
            list.sort_unstable();
            list.dedup();
        }
        for drawing in &mut graph.drawings {
            drawing.points.sort_unstable();
            drawing.points.dedup();
            drawing.strings.sort_unstable();
            drawing.strings.dedup();
        }
        graph
    }

    /// The drawing of a triangle.
    pub fn drawing(&self, t: u32) -> Option<&Drawing> {
        self.drawings.get(self.drawing_of[t as usize] as usize)
    }

    fn drawing_mut(&mut self, t: u32) -> &mut Drawing {
        let slot = &mut self.drawing_of[t as usize];
        if *slot == u32::MAX {
            *slot = self.drawings.len() as u32;
            self.drawings.push(Drawing::default());
        }
        &mut self.drawings[*slot as usize]
    }

    fn enter(&mut self, mesh: &Mesh, pair: [u32; 2], contact: &Contact, points: &mut Points, made: &mut Made) {
        let mut hits: Vec<(u32, [Spot; 2])> = Vec::with_capacity(contact.hits.len());
        for hit in &contact.hits {
            let id = made.point(mesh, pair, hit, points);
            if !hits.iter().any(|h| h.0 == id) {
                hits.push((id, hit.spots));
            }
        }
        for &(id, spots) in &hits {
            for (side, spot) in spots.into_iter().enumerate() {
                let t = pair[side];
                match spot {
                    Spot::Corner(_) => {}
                    Spot::Edge(k) => self.edge_points[mesh.edge_of(t, k) as usize].push(id),
                    Spot::Face => self.drawing_mut(t).points.push(id),
                }
            }
        }
        if contact.is_coplanar {
            self.is_coplanar.extend(pair);
            for side in 0..2 {
                self.enter_edges(mesh, pair, side, &hits);
            }
        } else if let [a, b] = hits[..] {
            self.enter_segment(mesh, pair, a, b);
        }
    }

    /// Coplanar triangles: stretches of the edges of `pair[side]` that lie on the other triangle.
    fn enter_edges(&mut self, mesh: &Mesh, pair: [u32; 2], side: usize, hits: &[(u32, [Spot; 2])]) {
        for k in 0..3u8 {
            let on: Vec<_> = hits.iter().filter(|h| h.1[side].is_on_edge(k)).collect();
            let [a, b] = on[..] else { continue };
            let other = 1 - side;
            if (0..3).any(|l| a.1[other].is_on_edge(l) && b.1[other].is_on_edge(l)) {
                continue;
            }
            let curve = Curve::Edge(mesh.edge_of(pair[side], k));
            self.drawing_mut(pair[other]).strings.push(StringPiece { curve, ends: ordered(a.0, b.0) });
        }
    }

    fn enter_segment(&mut self, mesh: &Mesh, pair: [u32; 2], a: (u32, [Spot; 2]), b: (u32, [Spot; 2])) {
        let along = |side: usize| (0..3u8).find(|&k| a.1[side].is_on_edge(k) && b.1[side].is_on_edge(k));
        let ends = ordered(a.0, b.0);
        let edge = |side: usize, k: u8| Curve::Edge(mesh.edge_of(pair[side], k));
        match (along(0), along(1)) {
            (Some(_), Some(_)) => {}
            (Some(k), None) => self.drawing_mut(pair[1]).strings.push(StringPiece { curve: edge(0, k), ends }),
            (None, Some(k)) => self.drawing_mut(pair[0]).strings.push(StringPiece { curve: edge(1, k), ends }),
            (None, None) => {
                let curve = Curve::Segment(self.segments.len() as u32);
                self.segments.push(Segment { ends, triangles: pair, points: Vec::new() });
                for t in pair {
                    self.drawing_mut(t).strings.push(StringPiece { curve, ends });
                }
            }
        }
    }

    /// The points entered in a curve, ends excluded.
    pub fn points_on(&self, curve: Curve) -> &[u32] {
        match curve {
            Curve::Edge(e) => &self.edge_points[e as usize],
            Curve::Segment(s) => &self.segments[s as usize].points,
        }
    }

    /// First and last point of a whole curve.
    pub fn ends_of(&self, mesh: &Mesh, curve: Curve) -> [u32; 2] {
        match curve {
            Curve::Edge(e) => mesh.edges[e as usize],
            Curve::Segment(s) => self.segments[s as usize].ends,
        }
    }

    /// Enters a point in a curve.
    pub fn push(&mut self, mesh: &Mesh, curve: Curve, point: u32) {
        if self.ends_of(mesh, curve).contains(&point) {
            return;
        }
        let list = match curve {
            Curve::Edge(e) => &mut self.edge_points[e as usize],
            Curve::Segment(s) => &mut self.segments[s as usize].points,
        };
        if !list.contains(&point) {
            list.push(point);
        }
    }

    /// Sorts the points on every curve from its first to its last end.
    pub fn sort_curves(&mut self, mesh: &Mesh, points: &Points) {
        for (e, list) in self.edge_points.iter_mut().enumerate() {
            sort_along(list, mesh.edges[e], points);
        }
        for segment in &mut self.segments {
            sort_along(&mut segment.points, segment.ends, points);
        }
    }
}

fn sort_along(list: &mut [u32], ends: [u32; 2], points: &Points) {
    if list.len() > 1 {
        let order = Along::new(ends, points);
        list.sort_by(|&a, &b| order.compare(a, b, points));
    }
}

/// The order of points along a line.
#[derive(Clone, Copy)]
pub struct Along {
    axis: usize,
    is_falling: bool,
}

impl Along {
    /// From the first to the second of two points.
    pub fn new(ends: [u32; 2], points: &Points) -> Self {
        let axis = (points.at(ends[1]) - points.at(ends[0])).iamax();
        Self { axis, is_falling: points.compare(ends[0], ends[1], axis) == Ordering::Greater }
    }
    /// Order of two points on the line.
    pub fn compare(&self, a: u32, b: u32, points: &Points) -> Ordering {
        let order = points.compare(a, b, self.axis);
        if self.is_falling { order.reverse() } else { order }
    }
}

fn ordered(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// Points made so far, by what made them: neighbours meet an edge in the same point.
#[derive(Default)]
struct Made {
    edge_face: IndexMap<(u32, u32), u32>,
    edge_edge: IndexMap<(u32, u32), u32>,
}

impl Made {
    fn point(&mut self, mesh: &Mesh, [t, u]: [u32; 2], hit: &Hit, points: &mut Points) -> u32 {
        let edge = |t: u32, k: u8| mesh.edge_of(t, k);
        let (of, k, face) = match hit.meeting {
            Meeting::Vertex(v) => return v,
            Meeting::EdgeOfFirst(k) => (t, k, u),
            Meeting::EdgeOfSecond(k) => (u, k, t),
            Meeting::EdgeEdge(k, l) => {
                let pair = ordered(edge(t, k), edge(u, l));
                return *self.edge_edge.entry((pair[0], pair[1])).or_insert_with(|| {
                    let [line, other] = pair.map(|e| mesh.edges[e as usize]);
                    points.intern(Source::LineLine { line, other, projection: mesh.projection[t as usize] })
                });
            }
        };
        *self.edge_face.entry((edge(of, k), face)).or_insert_with(|| {
            let line = mesh.edges[edge(of, k) as usize];
            points.intern(Source::LinePlane { line, plane: mesh.triangles[face as usize] })
        })
    }
}
