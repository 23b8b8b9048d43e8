//! Operators that make and kill an edge with a facet, or an edge with an inner loop: MEF, MEKL and inverses.

use super::super::store::{EdgeId, FinId, LoopId, Nil, Side, Topology};
use super::{Legal, Tally, require};
use crate::ids::FacetId;

const FACET: Tally = Tally { v: 0, e: 2, f: 2, l: 0, r: 0, s: 0, h: 0 };
const JOINT: Tally = Tally { v: 0, e: 2, f: 0, l: -2, r: 0, s: 0, h: 0 };

impl Topology {
    /// MEF: an edge across a facet from the start of `from` to the start of `to`, in the same loop. The new facet gets the part
    /// from `from` up to `to`; the rest, and inner loops (`move_loop`), stay. The edge runs from the start of `from`.
    pub fn mef(&mut self, from: FinId, to: FinId) -> Legal<(EdgeId, FacetId)> {
        let [owner, other] = [from, to].map(|fin| self.fins[fin].owner);
        let [a, b] = [from, to].map(|fin| self.fins[fin].vertex);
        require(owner == other, "the corners are in different loops")?;
        require(a != b, "the edge would join a vertex to itself")?;
        let old = self.loops[owner].facet;
        let (before_from, before_to) = (self.fins[from].prev, self.fins[to].prev);
        let facet = self.new_facet();
        let edge = self.new_edge(a, b);
        let walk = self.new_loop(facet, from);
        let rest = self.new_fin(a, edge, owner);
        let closing = self.new_fin(b, edge, walk);
        self.link(before_from, rest);
        self.link(rest, to);
        self.link(before_to, closing);
        self.link(closing, from);
        self.set_ring(edge, &[rest, closing]);
        self.facets[facet].outer = walk;
        self.own_cycle(from, walk);
        self.loops[owner].fin = rest;
        self.list_uses(facet, self.shells_beside(old));
        self.enter(FACET);
        Ok((edge, facet))
    }

    /// Gives an inner loop to another facet between the same shells; changes no count. For holes that `mef` leaves in the wrong
    /// half.
    pub fn move_loop(&mut self, walk: LoopId, facet: FacetId) -> Legal<()> {
        require(!self.is_outer_loop(walk), "the loop is the outer one")?;
        let same = self.shells_beside(facet) == self.shells_beside(self.loops[walk].facet);
        require(same, "the facets lie between different shells")?;
        self.detach_loop(walk);
        self.attach_loop(walk, facet);
        Ok(())
    }

    /// KEF: removes the edge of `gone` and its facet, of which it must be in the outer loop; the facet across, of equal
    /// orientation, takes over. The edge must have these two fins only.
    pub fn kef(&mut self, gone: FinId) -> Legal<()> {
        let edge = self.fins[gone].edge;
        require(edge.is_some() && self.ring_len(edge) == 2, "the edge does not have two fins")?;
        let kept = self.fins[gone].around_next;
        let [facet, heir] = [gone, kept].map(|fin| self.facet_of(fin));
        require(facet != heir, "both sides of the edge are one facet")?;
        require(self.is_along(gone) != self.is_along(kept), "the facets are turned against each other")?;
        let (walk, owner) = (self.fins[gone].owner, self.fins[kept].owner);
        require(self.is_outer_loop(walk), "the edge is in an inner loop of the facet that would go")?;
        let [before, after] = [self.fins[kept].prev, self.fins[kept].next];
        let [first, last] = [self.fins[gone].next, self.fins[gone].prev];
        self.link(before, first);
        self.link(last, after);
        self.own_cycle(first, owner);
        while self.loops[walk].next.is_some() {
            let inner = self.loops[walk].next;
            self.detach_loop(inner);
            self.attach_loop(inner, heir);
        }
        self.drop_edge(edge);
        self.fins.remove(gone);
        self.fins.remove(kept);
        self.loops.remove(walk);
        self.drop_facet(facet);
        self.enter_inverse(FACET);
        Ok(())
    }

    /// MEF in an edge: the fins of its ring from `first` on up to `last` move to a new edge with the same ends and direction; a
    /// facet of these two edges closes the gap. Its front faces what follows `last`.
    pub fn mef_in_edge(&mut self, first: FinId, last: FinId) -> Legal<(EdgeId, FacetId)> {
        let edge = self.fins[first].edge;
        require(edge.is_some() && self.fins[last].edge == edge, "the fins are not of one edge")?;
        let (before, after) = (self.fins[first].around_prev, self.fins[last].around_next);
        require(after != first, "no fin would stay at the edge")?;
        let [front, back] = [self.facing(last, true), self.facing(first, false)].map(|h| self.shell(self.face_use(h)));
        let moved: Vec<FinId> = self.fins_around_from(first, last);
        let [a, c] = self.ends(edge);
        let facet = self.new_facet();
        let twin = self.new_edge(a, c);
        let walk = self.new_loop(facet, FinId::NONE);
        self.facets[facet].outer = walk;
        let out = self.new_fin(a, edge, walk);
        let home = self.new_fin(c, twin, walk);
        self.link(out, home);
        self.link(home, out);
        self.loops[walk].fin = out;
        self.link_around(before, out);
        self.link_around(out, after);
        self.edges[edge].fin = out;
        self.set_ring(twin, &[moved, vec![home]].concat());
        self.list_uses(facet, [front, back]);
        self.enter(FACET);
        Ok((twin, facet))
    }

    fn fins_around_from(&self, first: FinId, last: FinId) -> Vec<FinId> {
        let mut fins = vec![first];
        while fins[fins.len() - 1] != last && fins.len() <= self.fins.count() {
            fins.push(self.fins[fins[fins.len() - 1]].around_next);
        }
        fins
    }

    /// KEF of a facet of two edges: they become one, that of `kept` (a fin of the facet); the other edge goes.
    pub fn kef_digon(&mut self, kept: FinId) -> Legal<()> {
        let (facet, walk, gone) = (self.facet_of(kept), self.fins[kept].owner, self.fins[kept].next);
        require(gone != kept && self.fins[gone].next == kept, "the facet has not two edges")?;
        require(self.is_outer_loop(walk) && !self.loops[walk].next.is_some(), "the facet has inner loops")?;
        let (edge, twin) = (self.fins[kept].edge, self.fins[gone].edge);
        require(edge != twin, "the facet is a single edge")?;
        let is_thin = |fin: FinId| self.fins[fin].around_next == fin;
        require(!is_thin(kept) && !is_thin(gone), "an edge of the facet has no other facet")?;
        let beside = Side::BOTH.map(|side| self.face_uses(self.shells_beside(facet)[side as usize]).nth(1).is_some());
        require(beside == [true; 2], "a region would vanish")?;
        let (first, last) = (self.fins[gone].around_next, self.fins[gone].around_prev);
        // The twin edge's ring replaces `kept`; it is turned round if the edges run against each other.
        let moved = self.fins_around_from(first, last);
        let is_reversed = self.ends(edge) != self.ends(twin);
        debug_assert!(!is_reversed || self.ends(twin) == [self.ends(edge)[1], self.ends(edge)[0]]);
        let (before, after) = (self.fins[kept].around_prev, self.fins[kept].around_next);
        let mut at = before;
        for k in 0..moved.len() {
            let fin = if is_reversed { moved[moved.len() - 1 - k] } else { moved[k] };
            self.fins[fin].edge = edge;
            self.link_around(at, fin);
            at = fin;
        }
        self.link_around(at, after);
        self.edges[edge].fin = after;
        self.drop_edge(twin);
        self.fins.remove(gone);
        self.fins.remove(kept);
        self.loops.remove(walk);
        self.drop_facet(facet);
        self.enter_inverse(FACET);
        Ok(())
    }

    /// MEKL: an edge from the start of `from` to the start of `to`, in another loop of the same facet; the two become one. Lone
    /// vertices are loops too.
    pub fn mekl(&mut self, from: FinId, to: FinId) -> Legal<EdgeId> {
        let [mut kept, mut gone] = [from, to].map(|fin| self.fins[fin].owner);
        let [a, b] = [from, to].map(|fin| self.fins[fin].vertex);
        require(kept != gone, "the corners are in one loop")?;
        require(self.loops[kept].facet == self.loops[gone].facet, "the loops are of different facets")?;
        require(a != b, "the edge would join a vertex to itself")?;
        if self.is_outer_loop(gone) {
            std::mem::swap(&mut kept, &mut gone);
        }
        let edge = self.new_edge(a, b);
        let out = self.new_fin(a, edge, kept);
        let home = self.new_fin(b, edge, kept);
        self.join(out, to, home);
        self.join(home, from, out);
        self.set_ring(edge, &[out, home]);
        self.detach_loop(gone);
        self.loops.remove(gone);
        self.own_cycle(out, kept);
        self.enter(JOINT);
        Ok(edge)
    }

    /// Lets the loop of `at` run from `arriving` through `at` all round to `leaving`; a lone vertex is used up.
    fn join(&mut self, arriving: FinId, at: FinId, leaving: FinId) {
        if self.fins[at].edge.is_some() {
            let last = self.fins[at].prev;
            self.link(arriving, at);
            self.link(last, leaving);
        } else {
            self.unlist_lone(at);
            self.fins.remove(at);
            self.link(arriving, leaving);
        }
    }

    /// KEML: removes an edge whose two fins are in one loop, which falls apart. What `fin` of the edge leads to becomes a new
    /// inner loop, maybe a lone vertex; what it comes from stays.
    pub fn keml(&mut self, fin: FinId) -> Legal<LoopId> {
        let edge = self.fins[fin].edge;
        require(edge.is_some() && self.ring_len(edge) == 2, "the edge does not have two fins")?;
        let home = self.fins[fin].around_next;
        let owner = self.fins[fin].owner;
        require(self.fins[home].owner == owner, "the edge is between two loops")?;
        let [a, b] = [self.fins[fin].vertex, self.fins[home].vertex];
        let facet = self.loops[owner].facet;
        let walk = self.new_loop(facet, FinId::NONE);
        let [far, near] = [[fin, home], [home, fin]].map(|[x, y]| (self.fins[x].next, self.fins[y].prev, x, y));
        for ((first, last, _, end), vertex, owner) in [(near, a, owner), (far, b, walk)] {
            if first == end {
                self.make_lone(vertex, owner);
            } else {
                self.link(last, first);
                self.own_cycle(first, owner);
            }
        }
        self.attach_loop(walk, facet);
        self.drop_edge(edge);
        self.fins.remove(home);
        self.fins.remove(fin);
        self.enter_inverse(JOINT);
        Ok(walk)
    }
}
