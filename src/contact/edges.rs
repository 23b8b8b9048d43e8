//! The edges of all facets near a contact, each with the points inserted into it.

use super::body::Body;
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use crate::geom::bvh::Bvh;
use crate::geom::hash::IndexMap;
use crate::geom::lists::Lists;

/// Edges of one facet from which on they go into a box tree.
const TREE_FROM: usize = 32;

/// An edge of one or several leaves, from its lower to its higher point number.
pub(super) struct Edge {
    pub ends: [u32; 2],
    /// Points on it by their parameter, ends excluded.
    pub inserted: Vec<(f64, u32)>,
}

/// Where a point that is no vertex is in a leaf: a leaf may have a point only once.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Place {
    Edge(u32),
    Facet(u32),
}

/// Edges of the active facets: those that are in a pair of candidates. An edge that comes near a facet of another leaf has
/// only active facets, since the box of each contains the edge; so nothing is ever inserted into other facets.
pub(super) struct EdgeSet {
    pub edges: Vec<Edge>,
    /// For every facet, whether it is active.
    pub is_active: Vec<bool>,
    /// For every facet, the edges for which it is the first in its leaf that is compared with others, so that a contact is
    /// looked for once.
    pub own: Lists,
    /// For every edge its uses as (leaf, facet), ascending.
    pub uses: Lists<(u32, u32)>,
    /// For every facet the edges of its sides, loop by loop.
    sides: Lists,
    /// Box of every edge.
    boxes: Vec<Aabb>,
    /// Box trees over the own edges of facets that have many.
    trees: IndexMap<u32, Bvh>,
    leaves: Lists,
    /// For every welded point the leaves of which it is a vertex, ascending.
    vertex_of: Lists,
    /// Number of welded points.
    welded: u32,
    inserted: IndexMap<(u32, u32), Place>,
}

impl EdgeSet {
    /// The edges of the facets in `pairs`.
    pub fn new(body: &Body, pairs: &[[u32; 2]]) -> Self {
        let is_active = active(body, pairs);
        let facets = || (0..body.facet_count() as u32).filter(|&f| is_active[f as usize]);
        let mut ends: Vec<[u32; 2]> = Vec::with_capacity(4 * facets().count());
        let mut facet_of_side: Vec<u32> = Vec::with_capacity(ends.capacity());
        let mut vertices: Vec<(u32, u32)> = Vec::with_capacity(facets().count());
        // Facets come by leaf: the last leaf that was found at each point tells whether this one is new there.
        let mut last_leaf = vec![u32::MAX; body.points.len()];
        for facet in facets() {
            let leaf = body.leaf_of_facet[facet as usize];
            let ids = body.points_of_leaf(leaf);
            for walk in body.own_loops(facet).iter() {
                for (k, &v) in walk.iter().enumerate() {
                    let (a, b) = (ids[v as usize], ids[walk[(k + 1) % walk.len()] as usize]);
                    if std::mem::replace(&mut last_leaf[a as usize], leaf) != leaf {
                        vertices.push((a, leaf));
                    }
                    ends.push([a.min(b), a.max(b)]);
                    facet_of_side.push(facet);
                }
            }
        }
        let (edge_of_side, edges) = numbered(&ends, body.points.len());
        let sides = || edge_of_side.iter().copied().zip(facet_of_side.iter().copied());
        // Facets come by leaf, so that the uses of each edge are in order already.
        let uses = Lists::from_iter(edges.len(), sides().map(|(e, f)| (e, (body.leaf_of_facet[f as usize], f))));
        let firsts = firsts(body, &uses, edges.len());
        let boxes = edges.iter().map(|e: &Edge| Aabb::around(e.ends.iter().map(|&v| &body.points[v as usize]))).collect();
        let mut set = Self {
            is_active,
            own: Lists::from_iter(body.facet_count(), firsts.iter().map(|u| (u.2, u.0))),
            leaves: Lists::from_iter(edges.len(), firsts.iter().map(|u| (u.0, u.1))),
            sides: Lists::from_iter(body.facet_count(), sides().map(|(e, f)| (f, e))),
            vertex_of: Lists::new(body.points.len(), &vertices),
            welded: body.points.len() as u32,
            inserted: IndexMap::default(),
            trees: IndexMap::default(),
            edges,
            uses,
            boxes,
        };
        for facet in (0..body.facet_count() as u32).filter(|&f| set.own.of(f).len() >= TREE_FROM) {
            set.trees.insert(facet, Bvh::new(set.own.of(facet).iter().map(|&e| *set.bounds(e)).collect()));
        }
        set
    }

    /// Ends of an edge in space.
    pub fn ends(&self, edge: u32, points: &[Vec3]) -> [Vec3; 2] {
        self.edges[edge as usize].ends.map(|v| points[v as usize])
    }
    /// Box of an edge.
    pub fn bounds(&self, edge: u32) -> &Aabb {
        &self.boxes[edge as usize]
    }
    /// Whether a facet has so many own edges that not all should be looked at for each of its neighbours.
    pub fn has_many(&self, facet: u32) -> bool {
        self.own.of(facet).len() >= TREE_FROM
    }
    /// Box around the own edges of a facet.
    pub fn own_bounds(&self, facet: u32) -> Aabb {
        let around = || self.own.of(facet).iter().fold(Aabb::EMPTY, |all, &e| all.union(self.bounds(e)));
        self.trees.get(&facet).map_or_else(around, Bvh::bounds)
    }
    /// Calls `visit` with the own edges of a facet, ascending; if they are many, with those whose boxes overlap `bounds`.
    pub fn own_near(&self, facet: u32, bounds: &Aabb, visit: impl FnMut(u32)) {
        let own = self.own.of(facet);
        if !self.has_many(facet) {
            return own.iter().copied().for_each(visit);
        }
        let mut found = Vec::new();
        if let Some(tree) = self.trees.get(&facet) {
            tree.overlapping(bounds, |k| found.push(own[k as usize]));
        }
        found.sort_unstable();
        found.into_iter().for_each(visit);
    }
    /// The leaves that have an edge.
    pub fn leaves(&self, edge: u32) -> &[u32] {
        self.leaves.of(edge)
    }
    /// Whether a point is a vertex of a leaf.
    fn is_vertex(&self, point: u32, leaf: u32) -> bool {
        point < self.welded && self.vertex_of.of(point).binary_search(&leaf).is_ok()
    }
    /// Makes room for points that pairs of edges share.
    pub fn reserve(&mut self, points: usize) {
        self.inserted.reserve(2 * points);
    }
    /// Whether `point` may become a point of the edge: it is on it already, or nowhere in the edge's leaves.
    pub fn can_insert(&self, edge: u32, point: u32) -> bool {
        let is_free = |leaf| self.inserted.get(&(point, leaf)).is_none_or(|p| *p == Place::Edge(edge));
        self.leaves(edge).iter().all(|&leaf| !self.is_vertex(point, leaf) && is_free(leaf))
    }
    /// Whether `point` is nowhere in the edge's leaves.
    pub fn lacks(&self, edge: u32, point: u32) -> bool {
        self.leaves(edge).iter().all(|&leaf| !self.is_elsewhere(point, leaf))
    }
    /// Puts `point` on the edge at parameter `s`, unless it is there; says whether it was put. Call [`Self::sort`] afterwards.
    pub fn insert(&mut self, edge: u32, s: f64, point: u32) -> bool {
        if !self.can_insert(edge, point) {
            return false;
        }
        let mut is_new = false;
        for k in 0..self.leaves(edge).len() {
            let leaf = self.leaves(edge)[k];
            is_new |= self.inserted.insert((point, leaf), Place::Edge(edge)).is_none();
        }
        if is_new {
            self.edges[edge as usize].inserted.push((s, point));
        }
        is_new
    }
    /// Whether `point` is a vertex or on an edge of `leaf`.
    pub fn is_elsewhere(&self, point: u32, leaf: u32) -> bool {
        self.is_vertex(point, leaf) || self.inserted.contains_key(&(point, leaf))
    }
    /// Puts `point` inside a facet of `leaf`; says whether it is there now.
    pub fn put_into_facet(&mut self, facet: u32, leaf: u32, point: u32) -> bool {
        !self.is_vertex(point, leaf)
            && *self.inserted.entry((point, leaf)).or_insert(Place::Facet(facet)) == Place::Facet(facet)
    }
    /// Brings inserted points into order along their edges.
    pub fn sort(&mut self) {
        for edge in &mut self.edges {
            edge.inserted.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        }
    }
    /// The points of an edge, ends included, whose parameters are in a closed range.
    pub fn points_between(&self, edge: u32, [lo, hi]: [f64; 2]) -> impl Iterator<Item = u32> + '_ {
        let Edge { ends, inserted } = &self.edges[edge as usize];
        let first = inserted.partition_point(|i| i.0 < lo);
        let last = first + inserted[first..].partition_point(|i| i.0 <= hi);
        let start = (lo <= 0.0).then_some(ends[0]);
        start.into_iter().chain(inserted[first..last].iter().map(|i| i.1)).chain((hi >= 1.0).then_some(ends[1]))
    }
    /// The loops of an active facet with everything inserted; `None` if nothing is.
    pub fn expand(&self, facet: u32, loops: &[Vec<u32>]) -> Option<Vec<Vec<u32>>> {
        let mut sides = self.sides.of(facet).iter().map(|&e| &self.edges[e as usize].inserted);
        if sides.clone().all(|inserted| inserted.is_empty()) {
            return None;
        }
        let expand = |walk: &Vec<u32>| {
            let mut full = Vec::with_capacity(walk.len() + 2);
            for ((k, &a), inserted) in walk.iter().enumerate().zip(&mut sides) {
                full.push(a);
                let between = inserted.iter().map(|i| i.1);
                if a < walk[(k + 1) % walk.len()] { full.extend(between) } else { full.extend(between.rev()) }
            }
            full
        };
        Some(loops.iter().map(expand).collect())
    }
}

/// The facets whose edges matter.
fn active(body: &Body, pairs: &[[u32; 2]]) -> Vec<bool> {
    let mut is_active = vec![false; body.facet_count()];
    pairs.iter().flatten().for_each(|&f| is_active[f as usize] = true);
    // What is set aside is near nothing, but its neighbours are, and it shares their edges.
    (0..body.facet_count()).for_each(|f| is_active[f] |= body.fate(f as u32).is_aside());
    is_active
}

/// The edge of each side, by the side's ends, lower one first; edges in the order in which they come first.
fn numbered(ends: &[[u32; 2]], points: usize) -> (Vec<u32>, Vec<Edge>) {
    let mut at = Lists::from_iter(points, ends.iter().zip(0u32..).map(|(e, side)| (e[0], (e[1], side))));
    // For each side at first the first one of the same edge.
    let mut edge_of = vec![0; ends.len()];
    for lower in 0..points as u32 {
        let sides = at.of_mut(lower);
        sides.sort_unstable();
        for same in sides.chunk_by(|a, b| a.0 == b.0) {
            same.iter().for_each(|s| edge_of[s.1 as usize] = same[0].1);
        }
    }
    let mut edges = Vec::with_capacity(ends.len() / 2);
    for side in 0..ends.len() {
        let first = edge_of[side] as usize;
        if first == side {
            edge_of[side] = edges.len() as u32;
            edges.push(Edge { ends: ends[side], inserted: Vec::new() });
        } else {
            edge_of[side] = edge_of[first];
        }
    }
    (edge_of, edges)
}

/// For every edge and leaf the first facet that is compared with others: (edge, leaf, facet), ascending.
fn firsts(body: &Body, uses: &Lists<(u32, u32)>, edges: usize) -> Vec<(u32, u32, u32)> {
    let mut firsts = Vec::with_capacity(edges);
    for edge in 0..edges as u32 {
        for same in uses.of(edge).chunk_by(|a, b| a.0 == b.0) {
            let compared = same.iter().find(|u| !body.fate(u.1).is_aside());
            firsts.extend(compared.map(|&(leaf, facet)| (edge, leaf, facet)));
        }
    }
    firsts
}
