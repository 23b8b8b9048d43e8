//! Operators that make and kill regions: MVFR, MSKR, MFFR and inverses.

use super::super::store::{FaceUse, FaceUseId, Facet, FinId, HalfEdgeId, LoopId, Nil, Region, ShellId, Side, Topology, Vertex};
use super::super::walk::Flood;
use super::{Legal, Tally, require};
use crate::ids::{FacetId, RegionId, VertexId};

const SEED: Tally = Tally { v: 2, e: 0, f: 2, l: 0, r: 1, s: 1, h: 0 };
const INNER_SHELL: Tally = Tally { v: 0, e: 0, f: 0, l: 0, r: -1, s: 1, h: 0 };

/// Whether a facet parts what is on its two sides.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Apart {
    /// It does: the region in front is a new one.
    Region(RegionId),
    /// It does not: a handle less.
    Handle,
}

impl Topology {
    /// A vertex without anything.
    pub(in super::super) fn new_vertex(&mut self) -> VertexId {
        self.vertices.insert(Vertex { end: super::super::store::EndId::NONE, lone: FinId::NONE })
    }
    /// A facet without loops and shells.
    pub(in super::super) fn new_facet(&mut self) -> FacetId {
        let unused = FaceUse { shell: ShellId::NONE, next: FaceUseId::NONE, prev: FaceUseId::NONE };
        self.facets.insert(Facet { outer: LoopId::NONE, uses: [unused; 2] })
    }

    /// MVFR: a region within `around`, bounded by one facet over one lone vertex. The facet's front is turned to `around`.
    pub fn mvfr(&mut self, around: RegionId) -> (VertexId, FacetId, RegionId) {
        let vertex = self.new_vertex();
        let facet = self.new_facet();
        let walk = self.new_loop(facet, FinId::NONE);
        self.facets[facet].outer = walk;
        self.make_lone(vertex, walk);
        let region = self.regions.insert(Region { first: ShellId::NONE });
        let shells = [self.new_shell(around, false), self.new_shell(region, true)];
        self.list_uses(facet, shells);
        self.enter(SEED);
        (vertex, facet, region)
    }

    /// KVFR: removes a region that is one facet over one lone vertex.
    pub fn kvfr(&mut self, facet: FacetId) -> Legal<()> {
        let walk = self.facets[facet].outer;
        let fin = self.loops[walk].fin;
        let vertex = self.fins[fin].vertex;
        let is_lone = !self.fins[fin].edge.is_some() && !self.loops[walk].next.is_some();
        require(is_lone, "the facet is more than a lone vertex")?;
        let has_more = self.vertices[vertex].end.is_some() || self.lone_fins(vertex).count() > 1;
        require(!has_more, "the vertex has other uses")?;
        let [front, back] = self.shells_beside(facet);
        let is_seed = self.shells[back].is_outer && !self.shells[front].is_outer;
        require(is_seed, "the back of the facet is not an outer shell of its own")?;
        let region = self.shells[back].region;
        require(self.shells_of(region).count() == 1, "the region has other shells")?;
        self.drop_facet(facet);
        self.drop_shell(back);
        self.drop_shell(front);
        self.regions.remove(region);
        self.loops.remove(walk);
        self.fins.remove(fin);
        self.vertices.remove(vertex);
        self.enter_inverse(SEED);
        Ok(())
    }

    /// MSKR: region `gone` becomes part of `kept`; its outer shell becomes an inner shell of `kept`, as do its inner ones.
    pub fn mskr(&mut self, gone: RegionId, kept: RegionId) -> Legal<()> {
        require(gone != kept && gone.0 != 0, "only a bounded region can become part of another")?;
        while self.regions[gone].first.is_some() {
            let shell = self.regions[gone].first;
            self.unlist_shell(shell);
            self.list_shell(shell, kept);
            if std::mem::take(&mut self.shells[shell].is_outer) {
                self.enter(INNER_SHELL);
            }
        }
        self.regions.remove(gone);
        Ok(())
    }

    /// KSMR: an inner shell becomes the outer shell of a new region.
    pub fn ksmr(&mut self, shell: ShellId) -> Legal<RegionId> {
        require(!self.shells[shell].is_outer, "the shell is an outer one")?;
        let region = self.regions.insert(Region { first: ShellId::NONE });
        self.move_shell(shell, region);
        self.shells[shell].is_outer = true;
        self.enter_inverse(INNER_SHELL);
        Ok(region)
    }

    /// Gives an inner shell to another region; changes no count. For cavities that an operator leaves in the wrong half.
    pub fn move_shell(&mut self, shell: ShellId, region: RegionId) {
        self.unlist_shell(shell);
        self.list_shell(shell, region);
    }

    /// MFFR: a double facet over a closed walk of half-edges (each ends where the next starts, within one vertex use). It lies
    /// in their sectors, its front facing them. What is in front becomes a new region if the facet parts the shell; other
    /// inner shells stay where they were (`move_shell`). Cost: the size of the shell.
    pub fn mffr(&mut self, walk: &[HalfEdgeId]) -> Legal<(FacetId, Apart)> {
        self.require_closed(walk)?;
        let shell = self.shell(self.face_use(walk[0]));
        let facet = self.new_facet();
        let outer = self.new_loop(facet, FinId::NONE);
        self.facets[facet].outer = outer;
        let mut fins = Vec::with_capacity(walk.len());
        for &half in walk {
            let faces_next = self.facing(half.fin(), true) == half;
            let end = self.start(self.next(half));
            let fin = self.new_fin(end, self.fins[half.fin()].edge, outer);
            let after = if faces_next { half.fin() } else { self.fins[half.fin()].around_prev };
            self.enter_ring(fin, after);
            fins.push(fin);
        }
        // The front walks against the half-edges that it faces.
        for (k, &fin) in fins.iter().enumerate() {
            self.link(fins[(k + 1) % fins.len()], fin);
        }
        self.loops[outer].fin = fins[0];
        self.list_uses(facet, [shell; 2]);
        let n = fins.len() as i64;
        let (front, back) = (FaceUseId::new_on(facet, Side::Front), FaceUseId::new_on(facet, Side::Back));
        match self.flood(front, back) {
            Flood::Reached => {
                self.enter(Tally { v: n, e: n, f: 2, h: -1, ..Tally::default() });
                Ok((facet, Apart::Handle))
            }
            Flood::Closed(uses) => {
                let region = self.regions.insert(Region { first: ShellId::NONE });
                let parted = self.new_shell(region, true);
                for face_use in uses {
                    self.unlist_use(face_use);
                    self.list_use(face_use, parted);
                }
                self.enter(Tally { v: n, e: n, f: 2, r: 1, ..Tally::default() });
                Ok((facet, Apart::Region(region)))
            }
        }
    }

    /// What MFFR needs: a walk of at least two different sectors that stays within one vertex use at each corner.
    fn require_closed(&self, walk: &[HalfEdgeId]) -> Legal<()> {
        require(walk.len() >= 2, "a facet needs two edges")?;
        let mut sectors: Vec<HalfEdgeId> = walk.iter().map(|&half| half.min(self.mate(half))).collect();
        sectors.sort_unstable();
        require(sectors.windows(2).all(|w| w[0] != w[1]), "the walk comes twice through one sector")?;
        let mut corners: Vec<HalfEdgeId> = Vec::with_capacity(walk.len());
        for (k, &half) in walk.iter().enumerate() {
            let next = walk[(k + 1) % walk.len()];
            let arrives = self.vertex_use(next).any(|at| at == self.next(half));
            require(arrives, "the walk leaves the vertex use")?;
            corners.push(self.vertex_use(next).min().unwrap_or(next));
        }
        corners.sort_unstable();
        require(corners.windows(2).all(|w| w[0] != w[1]), "the walk comes twice through one vertex use")
    }

    /// KFFR: removes a facet of one loop. If it parts two shells, the region on its side `dying` becomes part of the region on
    /// the other; otherwise a handle comes back.
    pub fn kffr(&mut self, facet: FacetId, dying: Side) -> Legal<()> {
        let outer = self.facets[facet].outer;
        require(!self.loops[outer].next.is_some(), "the facet has inner loops")?;
        let fins: Vec<FinId> = self.fins_of(outer).collect();
        for &fin in &fins {
            let edge = self.edge_of(fin);
            require(edge.is_some_and(|edge| self.ring_len(edge) > 1), "an edge would be left without facet")?;
            let (front, back) = (fin.on(Side::Front), self.fins[fin].prev.on(Side::Back));
            require(!self.vertex_use(front).any(|at| at == back), "both sides meet around a vertex")?;
        }
        let n = fins.len() as i64;
        let shells = self.shells_beside(facet);
        let (gone, kept) = (shells[dying as usize], shells[1 - dying as usize]);
        let mut removed = Tally { v: n, e: n, f: 2, ..Tally::default() };
        let (region, heir) = (self.shells[gone].region, self.shells[kept].region);
        if gone == kept {
            removed.h = -1;
        } else if region == heir {
            require(!self.shells[gone].is_outer, "the outer shell of a region would go")?;
            removed.s = 1;
        } else {
            require(self.shells[gone].is_outer, "the dying region is around the other")?;
            removed.r = 1;
        }
        for &fin in &fins {
            self.leave_ring(fin);
            self.fins.remove(fin);
        }
        self.drop_facet(facet);
        self.loops.remove(outer);
        if gone != kept {
            self.merge_shell(gone, kept);
        }
        if region != heir {
            while self.regions[region].first.is_some() {
                self.move_shell(self.regions[region].first, heir);
            }
            self.regions.remove(region);
        }
        self.enter_inverse(removed);
        Ok(())
    }
}
