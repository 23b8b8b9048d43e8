//! The invariants of the model, one function each, and the Euler-Poincaré count.
//!
//! Each face use belongs to one shell, each shell is a closed oriented surface once its vertex uses are told apart, and for
//! each of them V - E + F - L = 2 (1 - H). Summed over the shells of all regions, the outside included, this is the thesis'
//! V - E + F - L = 2 (R + S - H) with
//! - V vertex uses: the orbits of half-edges turning about a vertex within a shell ([`Topology::rotate`]), and one per side of
//!   a lone vertex. A vertex where two cubes touch in a point has two uses in the air, one in each cube;
//! - E edge uses: pairs of mates, one per sector around an edge, so as many as fins;
//! - F face uses: two per facet; L their loops beyond the first;
//! - R outer shells, one per bounded region; S all others, those of the outside among them;
//! - H handles, counted without the formula (`genus`): from a polygon schema of the shell, by how its loops cross.

use super::euler::Tally;
use super::genus::{Surface, genus};
use super::model::Brep;
use super::store::{EndId, FaceUseId, FinId, HalfEdgeId, LoopId, Nil, ShellId, Side, Topology};
use crate::diag::Diagnostic;
use crate::ids::{Id, VertexId};

/// The count, with what would not be counted.
#[derive(Clone, PartialEq, Debug)]
pub struct Count {
    /// Sums over all shells.
    pub tally: Tally,
    /// One entry per shell.
    pub shells: Vec<ShellCount>,
}

/// Uses in one shell.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ShellCount {
    /// The shell.
    pub shell: ShellId,
    /// Its uses; `r` or `s` is 1.
    pub tally: Tally,
    /// What is wrong with it as a closed surface.
    pub fault: Option<&'static str>,
}

impl Topology {
    /// Counts uses and handles of every shell. Call it on a topology whose links are sound (`check_links`). Cost: linear, plus
    /// genus cubed / 64.
    pub fn count(&self) -> Count {
        let mut surface = Surface::new(self);
        let mut count = Count { tally: Tally::default(), shells: Vec::new() };
        for shell in self.shells() {
            let (handles, mut fault) = match genus(self, shell, &mut surface) {
                Ok(handles) => (handles, None),
                Err(fault) => (0, Some(fault)),
            };
            let mut tally = self.count_shell(shell, &mut surface);
            tally.h = handles;
            if fault.is_none() && !tally.is_balanced() {
                fault = Some("breaks V - E + F - L = 2 (1 - H)");
            }
            count.tally += tally;
            count.shells.push(ShellCount { shell, tally, fault });
        }
        count
    }

    /// Everything but the handles.
    fn count_shell(&self, shell: ShellId, surface: &mut Surface) -> Tally {
        let mut tally = Tally::default();
        for face_use in self.face_uses(shell) {
            tally.f += 1;
            tally.l += self.loops(face_use.facet()).count() as i64 - 1;
            for fin in self.fins_of_facet(face_use.facet()) {
                if !self.fins[fin].edge.is_some() {
                    tally.v += 1;
                    continue;
                }
                let half = fin.on(face_use.side());
                tally.e += i64::from(half < self.mate(half));
                if surface.mark(half) {
                    tally.v += 1;
                    for at in self.vertex_use(half) {
                        surface.mark(at);
                    }
                }
            }
        }
        if self.is_outer(shell) {
            tally.r = 1
        } else {
            tally.s = 1
        }
        tally
    }

    /// Number of uses of a vertex.
    pub fn vertex_uses(&self, vertex: VertexId) -> usize {
        let mut met: Vec<HalfEdgeId> = Vec::new();
        let mut uses = 2 * self.lone_fins(vertex).count();
        for half in self.half_edges_at(vertex) {
            if !met.contains(&half) {
                uses += 1;
                met.extend(self.vertex_use(half));
            }
        }
        uses
    }
}

/// Collects findings.
#[derive(Default)]
struct Findings(Vec<Diagnostic>);

impl Findings {
    fn expect(&mut self, holds: bool, code: &'static str, message: impl FnOnce() -> String) {
        if !holds {
            self.0.push(Diagnostic::internal(code, message()));
        }
    }
}

impl Brep {
    /// All invariants of the topology; empty if it is sound. The count is looked at only if the links are sound.
    pub fn check(&self) -> Vec<Diagnostic> {
        let links = self.topology.check_links();
        if !links.is_empty() {
            return links;
        }
        let mut findings = self.topology.check_shells();
        findings.extend(self.check_tiles());
        findings
    }

    /// Each facet's triangles use its vertices, and every edge of a loop is an edge of one of them, in the same direction.
    fn check_tiles(&self) -> Vec<Diagnostic> {
        let mut findings = Findings::default();
        let mut directed = Vec::new();
        for facet in self.topology.facets() {
            directed.clear();
            directed.extend(self.triangles(facet).flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]]));
            directed.sort_unstable();
            let mut corners: Vec<VertexId> =
                self.topology.fins_of_facet(facet).map(|fin| self.topology.fin_ends(fin)[0]).collect();
            corners.sort_unstable();
            let known = directed.iter().all(|e| corners.binary_search(&e[0]).is_ok());
            findings.expect(known, "brep-tiles", || format!("a triangle of facet {} has a foreign corner", facet.0));
            let rim = self.topology.fins_of_facet(facet).filter(|&fin| self.topology.edge_of(fin).is_some());
            let covered = rim.map(|fin| self.topology.fin_ends(fin)).all(|e| directed.binary_search(&e).is_ok());
            findings.expect(covered, "brep-tiles", || format!("the triangles of facet {} leave an edge of it", facet.0));
        }
        findings.0
    }
}

impl Topology {
    /// Whether all lists are what they claim to be.
    pub fn check_links(&self) -> Vec<Diagnostic> {
        let mut findings = Findings::default();
        self.check_loops(&mut findings);
        self.check_rings(&mut findings);
        self.check_vertices(&mut findings);
        self.check_use_lists(&mut findings);
        findings.0
    }

    /// Loops are cycles of live fins of their own, every fin is in one, every loop in one facet; fins without edge are alone.
    fn check_loops(&self, findings: &mut Findings) {
        let mut fins = 0;
        let mut loops = 0;
        for facet in self.facets() {
            let walks: Vec<LoopId> = self.loops(facet).take(self.loops.count() + 1).collect();
            findings.expect(!walks.is_empty(), "brep-loop", || format!("facet {} has no loop", facet.0));
            for walk in walks {
                loops += 1;
                let is_own = self.loops.is_live(walk) && self.loops[walk].facet == facet;
                findings.expect(is_own, "brep-loop", || format!("loop {} is not of facet {}", walk.0, facet.0));
                for fin in self.fins_of(walk).take(self.fins.count() + 1) {
                    fins += 1;
                    let f = self.fins[fin];
                    let is_linked = self.fins.is_live(fin) && f.owner == walk && self.fins[f.next].prev == fin;
                    let is_alone = f.edge.is_some() || f.next == fin;
                    findings.expect(is_linked && is_alone, "brep-loop", || format!("fin {} is badly linked", fin.0));
                }
            }
        }
        let all = [self.fins.count(), self.loops.count()];
        findings.expect(all == [fins, loops], "brep-loop", || format!("{all:?} fins and loops, {:?} in facets", [fins, loops]));
    }

    /// Rings hold exactly the fins of their edge, which run between its ends; every edge has at least one.
    fn check_rings(&self, findings: &mut Findings) {
        let mut in_rings = 0;
        for edge in self.edges() {
            let [a, b] = self.ends(edge);
            findings.expect(a != b, "brep-ring", || format!("edge {} joins a vertex to itself", edge.0));
            let ring: Vec<FinId> = self.fins_around(edge).take(self.fins.count() + 1).collect();
            in_rings += ring.len();
            findings.expect(!ring.is_empty(), "brep-ring", || format!("edge {} has no facet", edge.0));
            for fin in ring {
                let f = self.fins[fin];
                let ends = self.fin_ends(fin);
                let fits = f.edge == edge && (ends == [a, b] || ends == [b, a]) && self.fins[f.around_next].around_prev == fin;
                findings.expect(fits, "brep-ring", || format!("fin {} does not fit edge {}", fin.0, edge.0));
            }
        }
        let with_edge = self.fins().filter(|&fin| self.fins[fin].edge.is_some()).count();
        findings.expect(in_rings == with_edge, "brep-ring", || format!("{with_edge} fins, {in_rings} in rings"));
    }

    /// Every edge end and every lone fin is listed at its vertex, and no vertex is without.
    fn check_vertices(&self, findings: &mut Findings) {
        let mut listed = [0, 0];
        for vertex in self.vertices() {
            let ends: Vec<EndId> = self.ends_at(vertex).take(2 * self.edges.count() + 1).collect();
            let lone: Vec<FinId> = self.lone_fins(vertex).take(self.fins.count() + 1).collect();
            listed[0] += ends.len();
            listed[1] += lone.len();
            let own = ends.iter().all(|end| self.edges[end.edge()].ends[end.end()].vertex == vertex)
                && lone.iter().all(|&fin| self.fins[fin].vertex == vertex && !self.fins[fin].edge.is_some());
            findings.expect(own, "brep-vertex", || format!("vertex {} lists what is not its own", vertex.0));
            let is_used = !ends.is_empty() || !lone.is_empty();
            findings.expect(is_used, "brep-vertex", || format!("vertex {} belongs to nothing", vertex.0));
        }
        let lone = self.fins().filter(|&fin| !self.fins[fin].edge.is_some()).count();
        let all = [2 * self.edges.count(), lone];
        findings.expect(listed == all, "brep-vertex", || format!("{all:?} edge ends and lone fins, {listed:?} at vertices"));
    }

    /// Every face use is in the list of its shell, every shell in that of its region.
    fn check_use_lists(&self, findings: &mut Findings) {
        let (mut uses, mut shells) = (0, 0);
        for region in self.regions() {
            let of_region: Vec<ShellId> = self.shells_of(region).take(self.shells.count() + 1).collect();
            shells += of_region.len();
            let outer = of_region.iter().filter(|&&shell| self.is_outer(shell)).count();
            let wanted = usize::from(region.index() != 0);
            findings.expect(outer == wanted, "brep-region", || format!("region {} has {outer} outer shells", region.0));
            for shell in of_region {
                let listed: Vec<FaceUseId> = self.face_uses(shell).take(2 * self.facets.count() + 1).collect();
                uses += listed.len();
                let own = listed.iter().all(|&at| self.has_facet(at.facet()) && self.shell(at) == shell);
                let fits = own && !listed.is_empty() && self.region(shell) == region;
                findings.expect(fits, "brep-shell", || format!("shell {} is badly listed", shell.0));
            }
        }
        let all = [2 * self.facets.count(), self.shells.count()];
        findings
            .expect(all == [uses, shells], "brep-shell", || format!("{all:?} uses and shells, {:?} listed", [uses, shells]));
    }

    /// Mates are of one shell and run against each other; shells are connected, and the Euler count holds for each.
    fn check_shells(&self) -> Vec<Diagnostic> {
        let mut findings = Findings::default();
        for half in self.fins().filter(|&fin| self.fins[fin].edge.is_some()).flat_map(|fin| Side::BOTH.map(|s| fin.on(s))) {
            let mate = self.mate(half);
            let is_pair = self.mate(mate) == half && self.start(mate) == self.start(self.next(half));
            findings.expect(is_pair, "brep-mates", || format!("half-edge {} has no mate", half.0));
            let [here, there] = [half, mate].map(|h| self.shell(self.face_use(h)));
            findings.expect(here == there, "brep-mates", || format!("shells {} and {} share a sector", here.0, there.0));
        }
        if findings.0.is_empty() {
            for ShellCount { shell, tally, fault } in self.count().shells {
                let name = |fault| format!("shell {} of region {} {fault}: {tally:?}", shell.0, self.region(shell).0);
                findings.expect(fault.is_none(), "brep-euler", || name(fault.unwrap_or_default()));
            }
        }
        findings.0
    }
}
