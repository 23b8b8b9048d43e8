//! Operators that make and kill a vertex with an edge: MEV in its three forms, KEV.

use super::super::store::{Edge, EdgeId, EndId, FinId, HalfEdgeId, Nil, Side, Topology};
use super::{Legal, Tally, require};
use crate::ids::VertexId;

fn grown(fins: usize) -> Tally {
    Tally { v: fins as i64, e: fins as i64, ..Tally::default() }
}

impl Topology {
    /// MEV: a spur into the facet from the corner where `fin` starts; `fin` may be a lone vertex. The new edge starts there.
    pub fn mev(&mut self, fin: FinId) -> (EdgeId, VertexId) {
        let (start, owner) = (self.fins[fin].vertex, self.fins[fin].owner);
        let vertex = self.new_vertex();
        let edge = self.new_edge(start, vertex);
        let there = self.new_fin(start, edge, owner);
        let back = self.new_fin(vertex, edge, owner);
        if self.fins[fin].edge.is_some() {
            let before = self.fins[fin].prev;
            self.link(before, there);
            self.link(back, fin);
        } else {
            self.unlist_lone(fin);
            self.fins.remove(fin);
            self.link(back, there);
            self.loops[owner].fin = there;
        }
        self.link(there, back);
        self.set_ring(edge, &[there, back]);
        self.enter(grown(2));
        (edge, vertex)
    }

    /// MEV inside an edge a b: `edge` becomes a n, the new edge is n b, with as many fins.
    pub fn mev_in_edge(&mut self, edge: EdgeId) -> (EdgeId, VertexId) {
        let [_, b] = self.ends(edge);
        let vertex = self.new_vertex();
        let fins: Vec<FinId> = self.fins_around(edge).collect();
        let is_along: Vec<bool> = fins.iter().map(|&fin| self.is_along(fin)).collect();
        self.leave_cycle(EndId::new_of(edge, 1));
        self.enter_cycle(EndId::new_of(edge, 1), vertex);
        let half = self.new_edge(vertex, b);
        let mut ring = Vec::with_capacity(fins.len());
        for (&fin, along) in fins.iter().zip(is_along) {
            let (start, owner) = if along { (vertex, self.fins[fin].owner) } else { (b, self.fins[fin].owner) };
            let piece = self.new_fin(start, half, owner);
            if along {
                let next = self.fins[fin].next;
                self.link(piece, next);
                self.link(fin, piece);
            } else {
                let prev = self.fins[fin].prev;
                self.link(prev, piece);
                self.link(piece, fin);
                self.fins[fin].vertex = vertex;
            }
            ring.push(piece);
        }
        self.set_ring(half, &ring);
        self.enter(grown(ring.len()));
        (half, vertex)
    }

    /// MEV in general: the edges `moved` leave `vertex` for a new one, joined to it by a new edge (from `vertex` to the new
    /// one) that lies in every facet with a corner between a moved and an unmoved edge. Lone vertices stay.
    /// Each vertex use must be parted into at most one moved and one unmoved sector. Cost: the edges at `vertex`, squared.
    pub fn mev_fan(&mut self, vertex: VertexId, moved: &[EdgeId]) -> Legal<(EdgeId, VertexId)> {
        let ring = self.fan_ring(vertex, moved)?;
        let new = self.new_vertex();
        for &edge in moved {
            self.move_end(edge, vertex, new);
        }
        let edge = self.new_edge(vertex, new);
        let mut fins = Vec::with_capacity(ring.len());
        for &corner in &ring {
            let is_along = moved.contains(&self.fins[corner].edge);
            let (before, owner) = (self.fins[corner].prev, self.fins[corner].owner);
            let fin = self.new_fin(if is_along { vertex } else { new }, edge, owner);
            self.link(before, fin);
            self.link(fin, corner);
            fins.push(fin);
        }
        self.set_ring(edge, &fins);
        self.enter(grown(fins.len()));
        Ok((edge, new))
    }

    /// The corners (by the fin that starts there) into which `mev_fan` puts a fin, in radial order about the new edge.
    fn fan_ring(&self, vertex: VertexId, moved: &[EdgeId]) -> Legal<Vec<FinId>> {
        require(moved.iter().all(|&edge| self.ends(edge).contains(&vertex)), "an edge to move is not at the vertex")?;
        let is_moved = |fin: FinId| moved.contains(&self.fins[fin].edge);
        let parts = |corner: FinId| is_moved(corner) != is_moved(self.fins[corner].prev);
        let corner_of = |half: HalfEdgeId| match half.side() {
            Side::Front => half.fin(),
            Side::Back => self.fins[half.fin()].next,
        };
        let corners: Vec<FinId> = self.fins_at(vertex).filter(|&fin| self.fins[fin].edge.is_some() && parts(fin)).collect();
        require(!corners.is_empty(), "no corner lies between moved and other edges")?;
        let mut ring = vec![corners[0]];
        loop {
            let at = ring[ring.len() - 1];
            // The half-edge of the new fin that will face the next one runs towards the new vertex.
            let half = if is_moved(at) { at.on(Side::Front) } else { self.fins[at].prev.on(Side::Back) };
            let mut across = self.vertex_use(half).skip(1).filter(|&h| parts(corner_of(h)));
            let next = across.next().map(corner_of);
            require(across.next().is_none(), "a vertex use would be parted more than once")?;
            match next {
                Some(next) if next == ring[0] => break,
                Some(next) if ring.len() < corners.len() => ring.push(next),
                _ => require(false, "the moved edges are not one side of a surface")?,
            }
        }
        require(ring.len() == corners.len(), "the moved edges fall apart")?;
        Ok(ring)
    }

    /// Moves the end of an edge and the start of its fins from one vertex to another.
    fn move_end(&mut self, edge: EdgeId, from: VertexId, to: VertexId) {
        let which = usize::from(self.edges[edge].ends[0].vertex != from);
        let end = EndId::new_of(edge, which);
        self.leave_cycle(end);
        self.enter_cycle(end, to);
        let Edge { fin: first, .. } = self.edges[edge];
        let mut fin = first;
        loop {
            if self.fins[fin].vertex == from {
                self.fins[fin].vertex = to;
            }
            fin = self.fins[fin].around_next;
            if fin == first {
                return;
            }
        }
    }

    /// KEV: contracts an edge; everything at its other end comes to `kept`. Facets lose the edge and may be left with two edges
    /// (`kef_digon` removes them). The ends must have no other edge in common, and no vertex use may get pinched.
    pub fn kev(&mut self, edge: EdgeId, kept: VertexId) -> Legal<()> {
        require(self.ends(edge).contains(&kept), "the vertex is not an end of the edge")?;
        let gone = self.other_end(edge, kept);
        let shared = self.neighbours(gone).filter(|&v| v == kept).count();
        require(shared == 1, "the ends have another edge in common")?;
        require(!self.would_pinch(edge), "the ends meet around something else")?;
        let fins: Vec<FinId> = self.fins_around(edge).collect();
        for &fin in &fins {
            self.leave_loop(fin, kept);
        }
        self.drop_edge(edge);
        while self.vertices[gone].end.is_some() {
            self.move_end(self.vertices[gone].end.edge(), gone, kept);
        }
        while self.vertices[gone].lone.is_some() {
            let lone = self.vertices[gone].lone;
            self.unlist_lone(lone);
            self.list_lone(lone, kept);
        }
        self.vertices.remove(gone);
        // In reverse, so that the inverse takes the ids in the order of the ring.
        for &fin in fins.iter().rev() {
            self.fins.remove(fin);
        }
        self.enter_inverse(grown(fins.len()));
        Ok(())
    }

    /// Takes a fin out of its loop; a loop that would be empty becomes the lone vertex `kept`.
    fn leave_loop(&mut self, fin: FinId, kept: VertexId) {
        let (next, prev, owner) = (self.fins[fin].next, self.fins[fin].prev, self.fins[fin].owner);
        if next == fin {
            self.make_lone(kept, owner);
            return;
        }
        self.link(prev, next);
        if self.loops[owner].fin == fin {
            self.loops[owner].fin = next;
        }
    }

    /// Whether contracting an edge would join two vertex uses in more than one way: the uses at both ends, joined by the
    /// sectors around the edge, must form a forest.
    pub(in super::super) fn would_pinch(&self, edge: EdgeId) -> bool {
        let name = |half| self.vertex_use(half).min().unwrap_or(half);
        let mut uses: Vec<[HalfEdgeId; 2]> =
            self.fins_around(edge).map(|fin| self.facing(fin, true)).map(|half| [name(half), name(self.next(half))]).collect();
        for k in 0..uses.len() {
            let [a, b] = uses[k];
            if a == b {
                return true;
            }
            for later in &mut uses[k + 1..] {
                *later = later.map(|at| if at == b { a } else { at });
            }
        }
        false
    }
}
