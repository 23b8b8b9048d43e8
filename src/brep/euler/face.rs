//! MFKLH and KFMLH: an inner loop becomes a facet of its own, and back.

use super::super::store::{FaceUseId, LoopId, Nil, ShellId, Side, Topology};
use super::super::walk::Flood;
use super::{Legal, Tally, require};
use crate::ids::FacetId;

impl Topology {
    /// MFKLH: an inner loop becomes the outer loop of a new facet, whose front and back join those of the old one. On each side
    /// either a handle goes, or the shell falls apart; the part at the new facet is then a new inner shell of the same region
    /// (`ksmr` makes a region of it). Cost: the size of the shells.
    pub fn mfklh(&mut self, walk: LoopId) -> Legal<FacetId> {
        require(!self.is_outer_loop(walk), "the loop is the outer one")?;
        let old = self.loops[walk].facet;
        self.detach_loop(walk);
        let facet = self.new_facet();
        self.loops[walk].facet = facet;
        self.loops[walk].next = LoopId::NONE;
        self.facets[facet].outer = walk;
        self.list_uses(facet, self.shells_beside(old));
        let mut added = Tally { f: 2, l: -2, ..Tally::default() };
        for side in Side::BOTH {
            let [from, to] = [facet, old].map(|f| FaceUseId::new_on(f, side));
            // Where both sides are one shell the first round may have parted it; then the second cut opens a handle.
            if self.shell(from) != self.shell(to) {
                added.h -= 1;
                continue;
            }
            match self.flood(from, to) {
                Flood::Reached => added.h -= 1,
                Flood::Closed(uses) => {
                    let parted = self.new_shell(self.region(self.shell(from)), false);
                    for face_use in uses {
                        self.unlist_use(face_use);
                        self.list_use(face_use, parted);
                    }
                    added.s += 1;
                }
            }
        }
        self.enter(added);
        Ok(facet)
    }

    /// KFMLH: a facet of one loop becomes an inner loop of `heir`, front to front. On each side either two shells of one region
    /// become one (an inner one goes), or a shell gets a handle.
    pub fn kfmlh(&mut self, facet: FacetId, heir: FacetId) -> Legal<LoopId> {
        require(facet != heir, "the facets are the same")?;
        let walk = self.facets[facet].outer;
        require(!self.loops[walk].next.is_some(), "the facet has inner loops")?;
        let [gone, kept] = [facet, heir].map(|f| self.shells_beside(f));
        let same_regions = Side::BOTH.iter().all(|&s| self.region(gone[s as usize]) == self.region(kept[s as usize]));
        require(same_regions, "the facets lie between different regions")?;
        self.drop_facet(facet);
        self.attach_loop(walk, heir);
        let mut removed = Tally { f: 2, l: -2, ..Tally::default() };
        for side in Side::BOTH {
            let [gone, kept]: [ShellId; 2] = [gone[side as usize], self.shells_beside(heir)[side as usize]];
            if gone == kept || !self.shells.is_live(gone) {
                removed.h -= 1;
                continue;
            }
            self.shells[kept].is_outer |= self.shells[gone].is_outer;
            self.merge_shell(gone, kept);
            removed.s += 1;
        }
        self.enter_inverse(removed);
        Ok(walk)
    }
}
