//! Navigation: from any element to its neighbours, without coordinates and without allocation.
//!
//! Iterators borrow the topology; collect them before changing it.

use super::store::{EdgeId, EndId, FaceUseId, FinId, HalfEdgeId, LoopId, Nil, ShellId, Side, Topology};
use crate::ids::{FacetId, RegionId, VertexId};
use std::iter::successors;

/// A cycle: starts at `first` (nothing if `None`), ends before it comes again.
#[inline]
fn cycle<T: Copy + Eq>(first: Option<T>, next: impl Fn(T) -> T) -> impl Iterator<Item = T> {
    successors(first, move |&at| Some(next(at)).filter(|&at| Some(at) != first))
}

/// A chain that ends at `NONE`.
#[inline]
fn chain<T: Nil>(first: T, next: impl Fn(T) -> T) -> impl Iterator<Item = T> {
    successors(first.is_some().then_some(first), move |&at| Some(next(at)).filter(|at| at.is_some()))
}

#[inline]
fn some<T: Nil>(id: T) -> Option<T> {
    id.is_some().then_some(id)
}

/// Whole model.
impl Topology {
    /// All vertices.
    #[inline]
    pub fn vertices(&self) -> impl Iterator<Item = VertexId> + '_ {
        self.vertices.ids()
    }
    /// All edges.
    #[inline]
    pub fn edges(&self) -> impl Iterator<Item = EdgeId> + '_ {
        self.edges.ids()
    }
    /// All facets.
    #[inline]
    pub fn facets(&self) -> impl Iterator<Item = FacetId> + '_ {
        self.facets.ids()
    }
    /// All fins.
    #[inline]
    pub fn fins(&self) -> impl Iterator<Item = FinId> + '_ {
        self.fins.ids()
    }
    /// All shells.
    #[inline]
    pub fn shells(&self) -> impl Iterator<Item = ShellId> + '_ {
        self.shells.ids()
    }
    /// All regions, the outside first.
    #[inline]
    pub fn regions(&self) -> impl Iterator<Item = RegionId> + '_ {
        self.regions.ids()
    }
    /// Whether the vertex exists (ids of removed ones may come again).
    #[inline]
    pub fn has_vertex(&self, vertex: VertexId) -> bool {
        self.vertices.is_live(vertex)
    }
    /// Whether the edge exists.
    #[inline]
    pub fn has_edge(&self, edge: EdgeId) -> bool {
        self.edges.is_live(edge)
    }
    /// Whether the facet exists.
    #[inline]
    pub fn has_facet(&self, facet: FacetId) -> bool {
        self.facets.is_live(facet)
    }
    /// Number of vertices, edges and facets that exist.
    #[inline]
    pub fn counts(&self) -> [usize; 3] {
        [self.vertices.count(), self.edges.count(), self.facets.count()]
    }
    /// All vertex, edge and facet ids are below these.
    #[inline]
    pub fn bounds(&self) -> [usize; 3] {
        [self.vertices.bound(), self.edges.bound(), self.facets.bound()]
    }
}

/// Facets, loops, fins.
impl Topology {
    /// The loops of a facet, the outer one first.
    #[inline]
    pub fn loops(&self, facet: FacetId) -> impl Iterator<Item = LoopId> + '_ {
        chain(self.facets[facet].outer, |at| self.loops[at].next)
    }
    /// The fins of a loop as the front side walks it.
    #[inline]
    pub fn fins_of(&self, walk: LoopId) -> impl Iterator<Item = FinId> + '_ {
        self.fins_from(self.loops[walk].fin)
    }
    /// The fins of the loop of `first`, beginning there.
    #[inline]
    pub fn fins_from(&self, first: FinId) -> impl Iterator<Item = FinId> + '_ {
        cycle(Some(first), |at| self.fins[at].next)
    }
    /// The vertices of a loop as the front side walks it.
    #[inline]
    pub fn corners(&self, walk: LoopId) -> impl Iterator<Item = VertexId> + '_ {
        self.fins_of(walk).map(|fin| self.fins[fin].vertex)
    }
    /// The fins of all loops of a facet.
    #[inline]
    pub fn fins_of_facet(&self, facet: FacetId) -> impl Iterator<Item = FinId> + '_ {
        self.loops(facet).flat_map(|walk| self.fins_of(walk))
    }
    /// The corners of a facet that is one loop of three.
    #[inline]
    pub fn triangle(&self, facet: FacetId) -> Option<[VertexId; 3]> {
        let walk = self.loops[self.facets[facet].outer];
        let [a, b, c] = [walk.fin, self.fins[walk.fin].next, self.fins[walk.fin].prev];
        let is_triangle = !walk.next.is_some() && self.fins[b].next == c && a != b && b != c;
        is_triangle.then(|| [self.fins[a].vertex, self.fins[b].vertex, self.fins[c].vertex])
    }
    /// Edge of a fin; `None` for a lone vertex.
    #[inline]
    pub fn edge_of(&self, fin: FinId) -> Option<EdgeId> {
        some(self.fins[fin].edge)
    }
    /// Loop of a fin.
    #[inline]
    pub fn loop_of(&self, fin: FinId) -> LoopId {
        self.fins[fin].owner
    }
    /// Facet of a fin.
    #[inline]
    pub fn facet_of(&self, fin: FinId) -> FacetId {
        self.loops[self.fins[fin].owner].facet
    }
    /// Start and end of a fin, as the front side walks it.
    #[inline]
    pub fn fin_ends(&self, fin: FinId) -> [VertexId; 2] {
        [self.fins[fin].vertex, self.fins[self.fins[fin].next].vertex]
    }
    /// The next fin of the loop.
    #[inline]
    pub fn next_fin(&self, fin: FinId) -> FinId {
        self.fins[fin].next
    }
    /// The previous fin of the loop.
    #[inline]
    pub fn prev_fin(&self, fin: FinId) -> FinId {
        self.fins[fin].prev
    }
}

/// Edges and vertices.
impl Topology {
    /// The ends of an edge.
    #[inline]
    pub fn ends(&self, edge: EdgeId) -> [VertexId; 2] {
        let [a, b] = &self.edges[edge].ends;
        [a.vertex, b.vertex]
    }
    /// The other end of an edge.
    #[inline]
    pub fn other_end(&self, edge: EdgeId, vertex: VertexId) -> VertexId {
        let [a, b] = self.ends(edge);
        if a == vertex { b } else { a }
    }
    /// The fins around an edge in radial order, counter-clockwise seen against the edge.
    #[inline]
    pub fn fins_around(&self, edge: EdgeId) -> impl Iterator<Item = FinId> + '_ {
        cycle(some(self.edges[edge].fin), |at| self.fins[at].around_next)
    }
    /// The facets around an edge in radial order; one that touches it twice comes twice.
    #[inline]
    pub fn facets_around(&self, edge: EdgeId) -> impl Iterator<Item = FacetId> + '_ {
        self.fins_around(edge).map(|fin| self.facet_of(fin))
    }
    /// The edges at a vertex, in no geometric order.
    #[inline]
    pub fn edges_at(&self, vertex: VertexId) -> impl Iterator<Item = EdgeId> + '_ {
        self.ends_at(vertex).map(EndId::edge)
    }
    #[inline]
    pub(super) fn ends_at(&self, vertex: VertexId) -> impl Iterator<Item = EndId> + '_ {
        cycle(some(self.vertices[vertex].end), |at| self.edges[at.edge()].ends[at.end()].next)
    }
    /// The vertices that share an edge with `vertex`.
    #[inline]
    pub fn neighbours(&self, vertex: VertexId) -> impl Iterator<Item = VertexId> + '_ {
        self.edges_at(vertex).map(move |edge| self.other_end(edge, vertex))
    }
    /// The edge between two vertices. Cost: the number of edges at `a`.
    #[inline]
    pub fn edge_between(&self, a: VertexId, b: VertexId) -> Option<EdgeId> {
        self.edges_at(a).find(|&edge| self.other_end(edge, a) == b)
    }
    /// The fins that start at a vertex, lone ones included: the corners of facets there, one each.
    #[inline]
    pub fn fins_at(&self, vertex: VertexId) -> impl Iterator<Item = FinId> + '_ {
        let starting = move |&fin: &FinId| self.fins[fin].vertex == vertex;
        self.edges_at(vertex).flat_map(|edge| self.fins_around(edge)).filter(starting).chain(self.lone_fins(vertex))
    }
    #[inline]
    pub(super) fn lone_fins(&self, vertex: VertexId) -> impl Iterator<Item = FinId> + '_ {
        chain(self.vertices[vertex].lone, |at| self.fins[at].around_next)
    }
    /// The facets at a vertex, each once per corner there.
    #[inline]
    pub fn facets_at(&self, vertex: VertexId) -> impl Iterator<Item = FacetId> + '_ {
        self.fins_at(vertex).map(|fin| self.facet_of(fin))
    }
}

/// Uses, shells, regions.
impl Topology {
    /// Whether a fin runs along its edge (from the first end to the second).
    #[inline]
    pub fn is_along(&self, fin: FinId) -> bool {
        self.edges[self.fins[fin].edge].ends[0].vertex == self.fins[fin].vertex
    }
    /// The side of `fin` that faces the next fin of the ring (`towards_next`) or the previous one.
    #[inline]
    pub(super) fn facing(&self, fin: FinId, towards_next: bool) -> HalfEdgeId {
        fin.on(if self.is_along(fin) == towards_next { Side::Front } else { Side::Back })
    }
    /// The half-edge across the sector that `half` faces: same shell, opposite direction. `half` must have an edge.
    #[inline]
    pub fn mate(&self, half: HalfEdgeId) -> HalfEdgeId {
        let fin = half.fin();
        if self.facing(fin, true) == half {
            self.facing(self.fins[fin].around_next, false)
        } else {
            self.facing(self.fins[fin].around_prev, true)
        }
    }
    /// The next half-edge of the loop as its side walks it.
    #[inline]
    pub fn next(&self, half: HalfEdgeId) -> HalfEdgeId {
        let fin = &self.fins[half.fin()];
        match half.side() {
            Side::Front => fin.next.on(Side::Front),
            Side::Back => fin.prev.on(Side::Back),
        }
    }
    /// Where a half-edge starts.
    #[inline]
    pub fn start(&self, half: HalfEdgeId) -> VertexId {
        let fin = &self.fins[half.fin()];
        match half.side() {
            Side::Front => fin.vertex,
            Side::Back => self.fins[fin.next].vertex,
        }
    }
    /// The face use of a half-edge.
    #[inline]
    pub fn face_use(&self, half: HalfEdgeId) -> FaceUseId {
        FaceUseId::new_on(self.facet_of(half.fin()), half.side())
    }
    /// The next half-edge that starts at the same vertex use; the orbits are the vertex uses. `half` must have an edge.
    #[inline]
    pub fn rotate(&self, half: HalfEdgeId) -> HalfEdgeId {
        self.next(self.mate(half))
    }
    /// The half-edges of one vertex use, beginning with `half`.
    #[inline]
    pub fn vertex_use(&self, half: HalfEdgeId) -> impl Iterator<Item = HalfEdgeId> + '_ {
        cycle(Some(half), |at| self.rotate(at))
    }
    /// The half-edges that start at a vertex (lone fins left out).
    #[inline]
    pub fn half_edges_at(&self, vertex: VertexId) -> impl Iterator<Item = HalfEdgeId> + '_ {
        self.edges_at(vertex).flat_map(|edge| self.fins_around(edge)).map(move |fin| {
            let side = if self.fins[fin].vertex == vertex { Side::Front } else { Side::Back };
            fin.on(side)
        })
    }
    /// Shell of a face use.
    #[inline]
    pub fn shell(&self, face_use: FaceUseId) -> ShellId {
        self.facets[face_use.facet()].uses[face_use.side() as usize].shell
    }
    /// Shells in front of and behind a facet.
    #[inline]
    pub fn shells_beside(&self, facet: FacetId) -> [ShellId; 2] {
        let [front, back] = &self.facets[facet].uses;
        [front.shell, back.shell]
    }
    /// Regions in front of and behind a facet.
    #[inline]
    pub fn sides(&self, facet: FacetId) -> [RegionId; 2] {
        let [front, back] = self.shells_beside(facet);
        [self.shells[front].region, self.shells[back].region]
    }
    /// The shells of a region; the outer one is not always first.
    #[inline]
    pub fn shells_of(&self, region: RegionId) -> impl Iterator<Item = ShellId> + '_ {
        chain(self.regions[region].first, |at| self.shells[at].next)
    }
    /// Region of a shell.
    #[inline]
    pub fn region(&self, shell: ShellId) -> RegionId {
        self.shells[shell].region
    }
    /// Whether a shell bounds its region from outside.
    #[inline]
    pub fn is_outer(&self, shell: ShellId) -> bool {
        self.shells[shell].is_outer
    }
    /// The face uses of a shell.
    #[inline]
    pub fn face_uses(&self, shell: ShellId) -> impl Iterator<Item = FaceUseId> + '_ {
        chain(self.shells[shell].first, |at| self.facets[at.facet()].uses[at.side() as usize].next)
    }
    /// The half-edges of a face use, all loops, lone fins left out.
    #[inline]
    pub fn half_edges_of(&self, face_use: FaceUseId) -> impl Iterator<Item = HalfEdgeId> + '_ {
        self.fins_of_facet(face_use.facet())
            .filter(|&fin| self.fins[fin].edge.is_some())
            .map(move |fin| fin.on(face_use.side()))
    }
    /// Whether walking from `from` across mates comes to `to`; the face uses met. Cost: the size of the shell.
    pub(super) fn flood(&self, from: FaceUseId, to: FaceUseId) -> Flood {
        let mut is_met = vec![false; 2 * self.facets.bound()];
        is_met[from.0 as usize] = true;
        let mut met = vec![from];
        let mut done = 0;
        while done < met.len() {
            for half in self.half_edges_of(met[done]) {
                let beyond = self.face_use(self.mate(half));
                if beyond == to {
                    return Flood::Reached;
                }
                if !std::mem::replace(&mut is_met[beyond.0 as usize], true) {
                    met.push(beyond);
                }
            }
            done += 1;
        }
        Flood::Closed(met)
    }
}

/// Result of [`Topology::flood`].
pub(super) enum Flood {
    /// The target is connected.
    Reached,
    /// It is not; these are.
    Closed(Vec<FaceUseId>),
}
