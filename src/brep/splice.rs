//! The links that Euler operators change: loops, rings, vertex cycles, shell lists. Each function keeps one kind of list sound
//! and knows nothing of the others.

use super::store::{
    Edge, EdgeId, End, EndId, FaceUse, FaceUseId, Fin, FinId, Loop, LoopId, Nil, Shell, ShellId, Side, Topology,
};
use crate::ids::{FacetId, RegionId, VertexId};

/// Loops.
impl Topology {
    /// A fin in no ring; the caller chains it into its loop.
    pub(super) fn new_fin(&mut self, vertex: VertexId, edge: EdgeId, owner: LoopId) -> FinId {
        let (n, none) = (FinId::NONE, FinId::NONE);
        self.fins.insert(Fin { vertex, edge, owner, next: n, prev: n, around_next: none, around_prev: none })
    }
    /// Lets `b` follow `a` in a loop.
    pub(super) fn link(&mut self, a: FinId, b: FinId) {
        self.fins[a].next = b;
        self.fins[b].prev = a;
    }
    pub(super) fn new_loop(&mut self, facet: FacetId, fin: FinId) -> LoopId {
        self.loops.insert(Loop { facet, fin, next: LoopId::NONE })
    }
    /// Makes the cycle of `fin` the loop `owner`.
    pub(super) fn own_cycle(&mut self, fin: FinId, owner: LoopId) {
        self.loops[owner].fin = fin;
        let mut at = fin;
        loop {
            self.fins[at].owner = owner;
            at = self.fins[at].next;
            if at == fin {
                return;
            }
        }
    }
    /// Appends a loop as an inner one.
    pub(super) fn attach_loop(&mut self, walk: LoopId, facet: FacetId) {
        let mut last = self.facets[facet].outer;
        while self.loops[last].next.is_some() {
            last = self.loops[last].next;
        }
        self.loops[last].next = walk;
        self.loops[walk] = Loop { facet, next: LoopId::NONE, ..self.loops[walk] };
    }
    /// Takes an inner loop out of its facet's list.
    pub(super) fn detach_loop(&mut self, walk: LoopId) {
        let mut before = self.facets[self.loops[walk].facet].outer;
        while self.loops[before].next != walk {
            before = self.loops[before].next;
        }
        self.loops[before].next = self.loops[walk].next;
    }
    pub(super) fn is_outer_loop(&self, walk: LoopId) -> bool {
        self.facets[self.loops[walk].facet].outer == walk
    }
    /// Turns `fin` into a lone vertex: a loop of its own, in the list of its vertex.
    pub(super) fn make_lone(&mut self, vertex: VertexId, owner: LoopId) -> FinId {
        let fin = self.new_fin(vertex, EdgeId::NONE, owner);
        self.link(fin, fin);
        self.loops[owner].fin = fin;
        self.list_lone(fin, vertex);
        fin
    }
    /// Enters a lone fin in the list of a vertex.
    pub(super) fn list_lone(&mut self, fin: FinId, vertex: VertexId) {
        let first = self.vertices[vertex].lone;
        self.fins[fin] = Fin { vertex, around_next: first, around_prev: FinId::NONE, ..self.fins[fin] };
        if first.is_some() {
            self.fins[first].around_prev = fin;
        }
        self.vertices[vertex].lone = fin;
    }
    /// Takes a lone fin out of the list of its vertex.
    pub(super) fn unlist_lone(&mut self, fin: FinId) {
        let Fin { vertex, around_next, around_prev, .. } = self.fins[fin];
        match around_prev.is_some() {
            true => self.fins[around_prev].around_next = around_next,
            false => self.vertices[vertex].lone = around_next,
        }
        if around_next.is_some() {
            self.fins[around_next].around_prev = around_prev;
        }
    }
}

/// Rings of edges.
impl Topology {
    /// Lets `b` follow `a` around an edge.
    pub(super) fn link_around(&mut self, a: FinId, b: FinId) {
        self.fins[a].around_next = b;
        self.fins[b].around_prev = a;
    }
    /// Enters `fin` after `after` in a ring.
    pub(super) fn enter_ring(&mut self, fin: FinId, after: FinId) {
        let next = self.fins[after].around_next;
        self.link_around(after, fin);
        self.link_around(fin, next);
    }
    /// Takes `fin` out of its ring, which keeps at least one other.
    pub(super) fn leave_ring(&mut self, fin: FinId) {
        let Fin { edge, around_next, around_prev, .. } = self.fins[fin];
        self.link_around(around_prev, around_next);
        if self.edges[edge].fin == fin {
            self.edges[edge].fin = around_next;
        }
    }
    /// Makes `fins` the whole ring of `edge`, in this order.
    pub(super) fn set_ring(&mut self, edge: EdgeId, fins: &[FinId]) {
        for (k, &fin) in fins.iter().enumerate() {
            self.fins[fin].edge = edge;
            self.link_around(fin, fins[(k + 1) % fins.len()]);
        }
        self.edges[edge].fin = fins[0];
    }
    /// Number of fins around an edge.
    pub fn ring_len(&self, edge: EdgeId) -> usize {
        self.fins_around(edge).count()
    }
}

/// Edges about vertices.
impl Topology {
    /// An edge without fins.
    pub(super) fn new_edge(&mut self, a: VertexId, b: VertexId) -> EdgeId {
        let bare = |vertex| End { vertex, next: EndId::NONE, prev: EndId::NONE };
        let edge = self.edges.insert(Edge { ends: [bare(a), bare(b)], fin: FinId::NONE });
        self.enter_cycle(EndId::new_of(edge, 0), a);
        self.enter_cycle(EndId::new_of(edge, 1), b);
        edge
    }
    /// Removes an edge that has no fins any more.
    pub(super) fn drop_edge(&mut self, edge: EdgeId) {
        self.leave_cycle(EndId::new_of(edge, 0));
        self.leave_cycle(EndId::new_of(edge, 1));
        self.edges.remove(edge);
    }
    fn end_mut(&mut self, end: EndId) -> &mut End {
        &mut self.edges[end.edge()].ends[end.end()]
    }
    fn link_ends(&mut self, a: EndId, b: EndId) {
        self.end_mut(a).next = b;
        self.end_mut(b).prev = a;
    }
    /// Enters an end as the last of its vertex.
    pub(super) fn enter_cycle(&mut self, end: EndId, vertex: VertexId) {
        self.end_mut(end).vertex = vertex;
        let first = self.vertices[vertex].end;
        if first.is_some() {
            let last = self.edges[first.edge()].ends[first.end()].prev;
            self.link_ends(last, end);
            self.link_ends(end, first);
        } else {
            self.vertices[vertex].end = end;
            self.link_ends(end, end);
        }
    }
    pub(super) fn leave_cycle(&mut self, end: EndId) {
        let End { vertex, next, prev } = self.edges[end.edge()].ends[end.end()];
        self.link_ends(prev, next);
        if self.vertices[vertex].end == end {
            self.vertices[vertex].end = if next == end { EndId::NONE } else { next };
        }
    }
}

/// Shells and face uses.
impl Topology {
    /// Enters both uses of a new facet in shells.
    pub(super) fn list_uses(&mut self, facet: FacetId, shells: [ShellId; 2]) {
        for side in Side::BOTH {
            self.list_use(FaceUseId::new_on(facet, side), shells[side as usize]);
        }
    }
    fn use_mut(&mut self, face_use: FaceUseId) -> &mut FaceUse {
        &mut self.facets[face_use.facet()].uses[face_use.side() as usize]
    }
    pub(super) fn list_use(&mut self, face_use: FaceUseId, shell: ShellId) {
        let first = self.shells[shell].first;
        *self.use_mut(face_use) = FaceUse { shell, next: first, prev: FaceUseId::NONE };
        if first.is_some() {
            self.use_mut(first).prev = face_use;
        }
        self.shells[shell].first = face_use;
    }
    pub(super) fn unlist_use(&mut self, face_use: FaceUseId) {
        let FaceUse { shell, next, prev } = *self.use_mut(face_use);
        match prev.is_some() {
            true => self.use_mut(prev).next = next,
            false => self.shells[shell].first = next,
        }
        if next.is_some() {
            self.use_mut(next).prev = prev;
        }
    }
    /// Removes a facet: its uses leave their shells.
    pub(super) fn drop_facet(&mut self, facet: FacetId) {
        for side in Side::BOTH {
            self.unlist_use(FaceUseId::new_on(facet, side));
        }
        self.facets.remove(facet);
    }
    /// A shell without uses, the first of its region.
    pub(super) fn new_shell(&mut self, region: RegionId, is_outer: bool) -> ShellId {
        let none = ShellId::NONE;
        let shell = self.shells.insert(Shell { region, first: FaceUseId::NONE, is_outer, next: none, prev: none });
        self.list_shell(shell, region);
        shell
    }
    /// Enters a shell as the first of a region.
    pub(super) fn list_shell(&mut self, shell: ShellId, region: RegionId) {
        let first = self.regions[region].first;
        self.shells[shell] = Shell { region, next: first, prev: ShellId::NONE, ..self.shells[shell] };
        if first.is_some() {
            self.shells[first].prev = shell;
        }
        self.regions[region].first = shell;
    }
    pub(super) fn unlist_shell(&mut self, shell: ShellId) {
        let Shell { region, next, prev, .. } = self.shells[shell];
        match prev.is_some() {
            true => self.shells[prev].next = next,
            false => self.regions[region].first = next,
        }
        if next.is_some() {
            self.shells[next].prev = prev;
        }
    }
    pub(super) fn drop_shell(&mut self, shell: ShellId) {
        self.unlist_shell(shell);
        self.shells.remove(shell);
    }
    /// Moves all uses of a shell to another and removes it.
    pub(super) fn merge_shell(&mut self, gone: ShellId, kept: ShellId) {
        while self.shells[gone].first.is_some() {
            let face_use = self.shells[gone].first;
            self.unlist_use(face_use);
            self.list_use(face_use, kept);
        }
        self.drop_shell(gone);
    }
}
