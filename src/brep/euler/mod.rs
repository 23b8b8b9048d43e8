//! Euler operators (thesis 2.2.3.1, Table 2.1) on a model in which every facet has two sides.
//!
//! All counts are counts of *uses*, and a facet has two, so an operator acts on both sides at once. For every operator
//! V - E + F - L = 2 (R + S - H) holds for what it adds (k: fins around the edge, n: edges of the facet):
//!
//! | operator           | inverse  | V    | E    | F  | L  | R  | S  | H  | what it makes
//! |
//! |--------------------|----------|------|------|----|----|----|----|----|----------------------------------------------------|
//! | `mvfr`             | `kvfr`   | +2   |      | +2 |    | +1 | +1 |    | region of one vertex and one facet; the facet's
//! front is a new inner shell of the region around | | `mev`              | `kev`    | +2   | +2   |    |    |    |    |    |
//! spur: edge into a facet with a new vertex at its end | | `mev_in_edge`      | `kev`    | +k   | +k   |    |    |    |    |
//! | vertex inside an edge, for all k fins               |
//! | `mev_fan`          | `kev`    | +k   | +k   |    |    |    |    |    | vertex parted in two: some edges move to the new
//! one | | `mef`              | `kef`    |      | +2   | +2 |    |    |    |    | edge across a facet
//! |
//! | `mef_in_edge`      | `kef_digon` |   | +2   | +2 |    |    |    |    | edge parted in two with a facet of two edges
//! between | | `mekl`             | `keml`   |      | +2   |    | -2 |    |    |    | edge from a loop to an inner loop
//! |
//! | `mfklh`            | `kfmlh`  |      |      | +2 | -2 |    | +s | -h | inner loop becomes a facet; per side either a
//! handle goes (h) or the shell falls apart (s), s + h = 2 | | `mskr`             | `ksmr`   |      |      |    |    | -1 | +1
//! |    | region becomes part of another, its outer shell an inner one |
//! | `mffr`             | `kffr`   | +n   | +n   | +2 |    | +1 |    |    | double facet over a cycle of n half-edges parts a
//! region; (or H -1 if it does not) |
//!
//! V counts vertex uses, E edge uses (pairs of mates, so as many as fins), F face uses, L inner loops of face uses, R outer and
//! S inner shells, H handles (sum of the shells' genera); see `check` for how each is counted.
//!
//! Operators work on any legal model and leave a legal one; what they cannot do they refuse with a reason and change
//! nothing. Ids are reused last freed first, so an operator and its inverse restore ids too. No edge may join a vertex to
//! itself.

mod edge;
mod face;
mod region;
#[cfg(test)]
mod tests;
mod vertex;

pub use region::Apart;

/// Why an operator does not apply.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Illegal(pub &'static str);

/// Result of an operator.
pub type Legal<T> = Result<T, Illegal>;

/// `Err(Illegal(why))` unless `holds`.
fn require(holds: bool, why: &'static str) -> Legal<()> {
    if holds { Ok(()) } else { Err(Illegal(why)) }
}

/// Numbers of uses, as in the thesis' equation 2.1.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Tally {
    /// Vertex uses.
    pub v: i64,
    /// Edge uses.
    pub e: i64,
    /// Face uses.
    pub f: i64,
    /// Inner loops of face uses.
    pub l: i64,
    /// Outer shells: bounded regions.
    pub r: i64,
    /// Inner shells.
    pub s: i64,
    /// Handles.
    pub h: i64,
}

impl Tally {
    /// Whether V - E + F - L = 2 (R + S - H).
    pub fn is_balanced(&self) -> bool {
        self.v - self.e + self.f - self.l == 2 * (self.r + self.s - self.h)
    }
}

impl std::ops::AddAssign for Tally {
    fn add_assign(&mut self, b: Self) {
        let a = *self;
        *self = Tally { v: a.v + b.v, e: a.e + b.e, f: a.f + b.f, l: a.l + b.l, r: a.r + b.r, s: a.s + b.s, h: a.h + b.h };
    }
}

impl std::ops::Neg for Tally {
    type Output = Self;
    fn neg(self) -> Self {
        Tally { v: -self.v, e: -self.e, f: -self.f, l: -self.l, r: -self.r, s: -self.s, h: -self.h }
    }
}

impl super::store::Topology {
    /// What the operators have added since the topology was built: `check::tally` must have grown by it.
    pub fn ledger(&self) -> Tally {
        self.ledger
    }
    /// Enters what an operator adds.
    fn enter(&mut self, added: Tally) {
        debug_assert!(added.is_balanced(), "operator breaks the Euler count: {added:?}");
        self.ledger += added;
    }
    /// Enters what an operator removes.
    fn enter_inverse(&mut self, removed: Tally) {
        self.enter(-removed);
    }
}
