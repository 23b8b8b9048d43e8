//! Storage of the topology: arenas of vertices, edges, fins, loops, facets, shells and regions, linked by `u32` ids.
//!
//! Every facet has two sides (its two face uses), and both walk the same loops, the back one in the opposite sense. So what is
//! stored is one *fin* per edge of a loop; its two half-edges (edge uses), one per side, are the fin's id and one bit:
//!
//! ```text
//! region ── shell ── face use (facet, side) ── loop ── half-edge (fin, side) ── edge ── vertex
//! ```
//!
//! Around an edge the fins form a ring, counter-clockwise seen against the edge's direction (the edge points at the viewer).
//! Two fins that follow each other in the ring bound one sector of space: the half-edges that face it are *mates*, belong to
//! the same shell and run in opposite directions. A fin *along* the edge has its facet's normal turned counter-clockwise, so
//! its front half-edge faces the next fin; for a fin *against* the edge it is the back one. Around a vertex the edges form a
//! cycle without geometric meaning. A loop of one lone vertex is one fin without edge.
//!
//! No coordinates here. About 150 bytes per triangle of a closed triangle mesh.

use crate::declare_ids;
use crate::ids::{FacetId, Id, IdVec, RegionId, VertexId};
use std::ops::{Index, IndexMut};

declare_ids! {
    /// An edge: two vertices and the ring of fins around it.
    EdgeId;
    /// An edge of a loop (or its lone vertex), both sides.
    FinId;
    /// One side of a fin: an edge as walked by one face use. `2 * fin + side`.
    HalfEdgeId;
    /// A loop of a facet, both sides.
    LoopId;
    /// A closed connected set of face uses.
    ShellId;
    /// One side of a facet. `2 * facet + side`.
    FaceUseId;
    /// One end of an edge. `2 * edge + end`.
    EndId;
}

/// "No such element".
pub trait Nil: Id {
    /// The id that no element has.
    const NONE: Self;
    /// Whether there is such an element.
    fn is_some(self) -> bool {
        self != Self::NONE
    }
}

macro_rules! nil {
    ($($name:ident),*) => {$( impl Nil for $name { const NONE: Self = $name(u32::MAX); } )*};
}
nil!(VertexId, EdgeId, FinId, LoopId, ShellId, FaceUseId, EndId, FacetId);

/// A side of a facet.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Side {
    /// Where the normal points.
    Front = 0,
    /// The other.
    Back = 1,
}

impl Side {
    /// Both sides.
    pub const BOTH: [Side; 2] = [Side::Front, Side::Back];
    fn from_bit(bit: u32) -> Self {
        if bit & 1 == 0 { Side::Front } else { Side::Back }
    }
}

impl FinId {
    /// The half-edge on one side.
    #[inline]
    pub fn on(self, side: Side) -> HalfEdgeId {
        HalfEdgeId(2 * self.0 + side as u32)
    }
}

impl HalfEdgeId {
    /// Its fin.
    #[inline]
    pub fn fin(self) -> FinId {
        FinId(self.0 / 2)
    }
    /// Its side.
    #[inline]
    pub fn side(self) -> Side {
        Side::from_bit(self.0)
    }
    /// The other half-edge of the fin, on the other side of the facet.
    #[inline]
    pub fn opposite(self) -> HalfEdgeId {
        HalfEdgeId(self.0 ^ 1)
    }
}

impl FaceUseId {
    /// The use of a facet on one side.
    #[inline]
    pub fn new_on(facet: FacetId, side: Side) -> Self {
        FaceUseId(2 * facet.0 + side as u32)
    }
    /// Its facet.
    #[inline]
    pub fn facet(self) -> FacetId {
        FacetId(self.0 / 2)
    }
    /// Its side.
    #[inline]
    pub fn side(self) -> Side {
        Side::from_bit(self.0)
    }
}

impl EndId {
    #[inline]
    pub(super) fn new_of(edge: EdgeId, end: usize) -> Self {
        EndId(2 * edge.0 + end as u32)
    }
    #[inline]
    pub(super) fn edge(self) -> EdgeId {
        EdgeId(self.0 / 2)
    }
    #[inline]
    pub(super) fn end(self) -> usize {
        (self.0 & 1) as usize
    }
}

/// First of the edge ends and of the lone fins at a vertex.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Vertex {
    pub end: EndId,
    pub lone: FinId,
}

/// An end of an edge in the cycle of ends about its vertex.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct End {
    pub vertex: VertexId,
    pub next: EndId,
    pub prev: EndId,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Edge {
    pub ends: [End; 2],
    pub fin: FinId,
}

/// Start vertex; neighbours in the loop, as the front side walks it; neighbours in the edge's ring. A lone fin has no edge and
/// is its own neighbour in the loop; `around_*` then chain the lone fins of its vertex.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Fin {
    pub vertex: VertexId,
    pub edge: EdgeId,
    pub owner: LoopId,
    pub next: FinId,
    pub prev: FinId,
    pub around_next: FinId,
    pub around_prev: FinId,
}

/// A loop: its facet, one of its fins, and the next loop of the facet.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Loop {
    pub facet: FacetId,
    pub fin: FinId,
    pub next: LoopId,
}

/// A face use in the list of its shell.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct FaceUse {
    pub shell: ShellId,
    pub next: FaceUseId,
    pub prev: FaceUseId,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Facet {
    /// The outer loop; inner ones follow.
    pub outer: LoopId,
    pub uses: [FaceUse; 2],
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Shell {
    pub region: RegionId,
    pub first: FaceUseId,
    /// Whether it bounds its region from outside.
    pub is_outer: bool,
    pub next: ShellId,
    pub prev: ShellId,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Region {
    pub first: ShellId,
}

/// Slots that are reused last freed first, so that an operator's inverse restores even the ids.
#[derive(Clone, Debug)]
pub(super) struct Arena<I, T> {
    slots: IdVec<I, T>,
    is_live: Vec<bool>,
    free: Vec<I>,
}

impl<I, T> Default for Arena<I, T>
where
    I: Id,
{
    fn default() -> Self {
        Self { slots: IdVec::new(), is_live: Vec::new(), free: Vec::new() }
    }
}

impl<I: Id, T> Arena<I, T> {
    pub fn with_capacity(capacity: usize) -> Self {
        Self { slots: Vec::with_capacity(capacity).into(), is_live: Vec::with_capacity(capacity), free: Vec::new() }
    }
    pub fn insert(&mut self, item: T) -> I {
        match self.free.pop() {
            Some(id) => {
                self.slots[id] = item;
                self.is_live[id.index()] = true;
                id
            }
            None => {
                self.is_live.push(true);
                self.slots.push(item)
            }
        }
    }
    pub fn remove(&mut self, id: I) {
        debug_assert!(self.is_live[id.index()]);
        self.is_live[id.index()] = false;
        self.free.push(id);
    }
    #[inline]
    pub fn is_live(&self, id: I) -> bool {
        self.is_live.get(id.index()).copied().unwrap_or(false)
    }
    /// Number of live items.
    pub fn count(&self) -> usize {
        self.slots.len() - self.free.len()
    }
    /// Number of slots: every id is below.
    pub fn bound(&self) -> usize {
        self.slots.len()
    }
    pub fn ids(&self) -> impl Iterator<Item = I> + '_ {
        self.slots.ids().filter(|&id| self.is_live[id.index()])
    }
}

impl<I: Id, T> Index<I> for Arena<I, T> {
    type Output = T;
    #[inline]
    fn index(&self, id: I) -> &T {
        &self.slots[id]
    }
}

impl<I: Id, T> IndexMut<I> for Arena<I, T> {
    #[inline]
    fn index_mut(&mut self, id: I) -> &mut T {
        &mut self.slots[id]
    }
}

/// The topology of a model. Read it with `walk`, change it with `euler`.
#[derive(Clone, Debug, Default)]
pub struct Topology {
    pub(super) vertices: Arena<VertexId, Vertex>,
    pub(super) edges: Arena<EdgeId, Edge>,
    pub(super) fins: Arena<FinId, Fin>,
    pub(super) loops: Arena<LoopId, Loop>,
    pub(super) facets: Arena<FacetId, Facet>,
    pub(super) shells: Arena<ShellId, Shell>,
    pub(super) regions: Arena<RegionId, Region>,
    /// What the Euler operators have added since the topology was built.
    pub(super) ledger: super::euler::Tally,
}

impl Topology {
    /// One region, the unbounded outside, and nothing in it.
    pub fn new() -> Self {
        let mut topology = Self::default();
        topology.regions.insert(Region { first: ShellId::NONE });
        topology
    }
}
