//! The edges of all facets near a contact, each with the points inserted into it.

use super::body::Body;
use super::outline::sides;
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

/// Where a point is in a leaf: a leaf may have a point only once.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Place {
    Vertex,
    Edge(u32),
    Facet(u32),
}

/// Edges of the active facets: those that are in a pair of candidates. An edge that comes near a facet of another leaf has
/// only active facets, since the box of each contains the edge; so nothing is ever inserted into other facets.
pub(super) struct EdgeSet {
    pub edges: Vec<Edge>,
    /// For every facet, whether it is active.
    pub is_active: Vec<bool>,
    /// For every facet, the edges for which it is the first in its leaf that is compared with others, so that a contact is looked
    /// for once.
    pub own: Lists,
    /// Every use of an edge as (edge, leaf, facet), sorted.
    pub uses: Vec<(u32, u32, u32)>,
    /// Box of every edge.
    boxes: Vec<Aabb>,
    /// Box trees over the own edges of facets that have many.
    trees: IndexMap<u32, Bvh>,
    leaves: Lists,
    number: IndexMap<(u32, u32), u32>,
    places: IndexMap<(u32, u32), Place>,
}

impl EdgeSet {
    /// The edges of the facets in `pairs`.
    pub fn new(body: &Body, pairs: &[[u32; 2]]) -> Self {
        let mut is_active = vec![false; body.facet_count()];
        pairs.iter().flatten().for_each(|&f| is_active[f as usize] = true);
        // What is set aside is near nothing, but its neighbours are, and it shares their edges.
        (0..body.facet_count()).for_each(|f| is_active[f] |= body.fate(f as u32).is_aside());
        let active = is_active.iter().filter(|a| **a).count();
        let mut set = Self {
            edges: Vec::with_capacity(2 * active),
            own: Lists::default(),
            uses: Vec::new(),
            boxes: Vec::new(),
            trees: IndexMap::default(),
            leaves: Lists::default(),
            number: IndexMap::with_capacity_and_hasher(2 * active, Default::default()),
            places: IndexMap::with_capacity_and_hasher(2 * active, Default::default()),
            is_active,
        };
        let mut uses: Vec<(u32, u32, u32)> = Vec::with_capacity(4 * active);
        // Facets come by leaf: the last leaf that was found at each point tells whether this one is new there.
        let mut last_leaf = vec![u32::MAX; body.points.len()];
        for facet in (0..body.facet_count() as u32).filter(|&f| set.is_active[f as usize]) {
            let leaf = body.leaf_of_facet[facet as usize];
            let ids = body.points_of_leaf(leaf);
            for walk in body.own_loops(facet) {
                for (k, &v) in walk.iter().enumerate() {
                    let (a, b) = (ids[v as usize], ids[walk[(k + 1) % walk.len()] as usize]);
                    if std::mem::replace(&mut last_leaf[a as usize], leaf) != leaf {
                        set.places.insert((a, leaf), Place::Vertex);
                    }
                    let next = set.edges.len() as u32;
                    let edge = *set.number.entry((a.min(b), a.max(b))).or_insert(next);
                    if edge == next {
                        set.edges.push(Edge { ends: [a.min(b), a.max(b)], inserted: Vec::new() });
                    }
                    uses.push((edge, leaf, facet));
                }
            }
        }
        // Facets come by leaf, so that the uses of each edge are in order already.
        let numbered: Vec<(u32, u32)> = uses.iter().zip(0..).map(|(u, k)| (u.0, k)).collect();
        let by_number = Lists::new(set.edges.len(), &numbered);
        let uses: Vec<(u32, u32, u32)> =
            (0..set.edges.len() as u32).flat_map(|e| by_number.of(e)).map(|&k| uses[k as usize]).collect();
        let first = |same: &[(u32, u32, u32)]| same.iter().find(|u| !body.fate(u.2).is_aside()).copied();
        let firsts = || uses.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)).filter_map(first);
        let by_edge: Vec<(u32, u32)> = firsts().map(|u| (u.0, u.1)).collect();
        let by_facet: Vec<(u32, u32)> = firsts().map(|u| (u.2, u.0)).collect();
        set.leaves = Lists::new(set.edges.len(), &by_edge);
        set.own = Lists::new(body.facet_count(), &by_facet);
        set.uses = uses;
        set.boxes = (0..set.edges.len() as u32).map(|e| Aabb::around(&set.ends(e, &body.points))).collect();
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
    /// Calls `visit` with the own edges of a facet whose boxes overlap `bounds`, ascending.
    pub fn own_near(&self, facet: u32, bounds: &Aabb, visit: impl FnMut(u32)) {
        let own = self.own.of(facet);
        if !self.has_many(facet) {
            return own.iter().copied().filter(|&e| bounds.overlaps(self.bounds(e))).for_each(visit);
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
    /// Whether `point` may become a point of the edge: it is on it already, or nowhere in the edge's leaves.
    pub fn can_insert(&self, edge: u32, point: u32) -> bool {
        self.leaves(edge).iter().all(|&leaf| self.places.get(&(point, leaf)).is_none_or(|p| *p == Place::Edge(edge)))
    }
    /// Whether `point` is nowhere in the edge's leaves.
    pub fn lacks(&self, edge: u32, point: u32) -> bool {
        self.leaves(edge).iter().all(|&leaf| !self.places.contains_key(&(point, leaf)))
    }
    /// Puts `point` on the edge at parameter `s`, unless it is there; says whether it was put. Call [`Self::sort`] afterwards.
    pub fn insert(&mut self, edge: u32, s: f64, point: u32) -> bool {
        if !self.can_insert(edge, point) {
            return false;
        }
        let mut is_new = false;
        for k in 0..self.leaves(edge).len() {
            let leaf = self.leaves(edge)[k];
            is_new |= self.places.insert((point, leaf), Place::Edge(edge)).is_none();
        }
        if is_new {
            self.edges[edge as usize].inserted.push((s, point));
        }
        is_new
    }
    /// Whether `point` is a vertex or on an edge of `leaf`.
    pub fn is_elsewhere(&self, point: u32, leaf: u32) -> bool {
        self.places.contains_key(&(point, leaf))
    }
    /// Puts `point` inside a facet of `leaf`; says whether it is there now.
    pub fn put_into_facet(&mut self, facet: u32, leaf: u32, point: u32) -> bool {
        *self.places.entry((point, leaf)).or_insert(Place::Facet(facet)) == Place::Facet(facet)
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
    pub fn expand(&self, loops: &[Vec<u32>]) -> Option<Vec<Vec<u32>>> {
        let inserted = |a: u32, b: u32| {
            let edge = self.number.get(&(a.min(b), a.max(b)));
            edge.map_or(&[][..], |&e| &self.edges[e as usize].inserted)
        };
        if sides(loops).all(|[a, b]| inserted(a, b).is_empty()) {
            return None;
        }
        let expand = |walk: &Vec<u32>| {
            let mut full = Vec::with_capacity(walk.len() + 2);
            for (k, &a) in walk.iter().enumerate() {
                full.push(a);
                let b = walk[(k + 1) % walk.len()];
                let between = inserted(a, b).iter().map(|i| i.1);
                if a < b { full.extend(between) } else { full.extend(between.rev()) }
            }
            full
        };
        Some(loops.iter().map(expand).collect())
    }
}
