//! Spreads labels over the shells.

use super::raycast::Rays;
use crate::arrangement::Arrangement;
use crate::contact::conforming::Owner;
use crate::diag::Diagnostic;
use crate::geom::hash::IndexMap;

/// Distinct labels, each stored once.
#[derive(Default)]
struct Labels {
    sets: Vec<Vec<u32>>,
    numbers: IndexMap<Vec<u32>, u32>,
    /// Label reached from a label by entering or leaving one leaf.
    steps: IndexMap<(u32, u32, bool), u32>,
}

impl Labels {
    fn number(&mut self, set: Vec<u32>) -> u32 {
        if let Some(&n) = self.numbers.get(&set) {
            return n;
        }
        let n = self.sets.len() as u32;
        self.sets.push(set.clone());
        self.numbers.insert(set, n);
        n
    }

    /// The label behind a piece whose front has label `from` (or the other way round). `None` if it cannot be.
    fn cross(&mut self, mut from: u32, owners: &[Owner], is_from_front: bool) -> Option<u32> {
        for owner in owners {
            // Unflipped owners are inside behind the piece.
            let enters = is_from_front != owner.is_flipped;
            let key = (from, owner.leaf.0, enters);
            from = match self.steps.get(&key) {
                Some(&to) => to,
                None => {
                    let to = self.step(from, owner.leaf.0, enters)?;
                    self.steps.insert(key, to);
                    to
                }
            };
        }
        Some(from)
    }

    fn step(&mut self, from: u32, leaf: u32, enters: bool) -> Option<u32> {
        let mut set = self.sets[from as usize].clone();
        match (set.binary_search(&leaf), enters) {
            (Err(k), true) => set.insert(k, leaf),
            (Ok(k), false) => drop(set.remove(k)),
            _ => return None,
        }
        Some(self.number(set))
    }
}

/// Label of every shell, and the distinct labels.
pub fn spread(arrangement: &Arrangement, shells: &[[u32; 2]], count: usize) -> Result<(Vec<u32>, Vec<Vec<u32>>), Diagnostic> {
    let cells = &arrangement.cells;
    let around = Around::new(shells, count);
    let mut labels = Labels::default();
    let mut label_of = vec![u32::MAX; count];
    let mut rays = Rays::new(arrangement);
    let mut stack = Vec::new();
    for start in 0..count as u32 {
        if label_of[start as usize] != u32::MAX {
            continue;
        }
        let (cell, set) = rays.label_in_front(component(&around, shells, start))?;
        let seed = shells[cell as usize][0];
        label_of[seed as usize] = labels.number(set);
        stack.push(seed);
        while let Some(shell) = stack.pop() {
            let label = label_of[shell as usize];
            for &side in around.of(shell) {
                let (cell, is_front) = (side as usize / 2, side % 2 == 0);
                let beyond = labels.cross(label, cells.owners_of(cell), is_front);
                let other = shells[cell][usize::from(is_front)] as usize;
                match beyond {
                    Some(l) if label_of[other] == u32::MAX => {
                        label_of[other] = l;
                        stack.push(other as u32);
                    }
                    Some(l) if label_of[other] == l => {}
                    _ => {
                        let corner = cells.loops(cell).next().map_or(0, |l| l[0]);
                        let text = "the two sides of a piece contradict each other";
                        return Err(Diagnostic::internal("label-conflict", text).near(arrangement.points.at(corner)));
                    }
                }
            }
        }
    }
    Ok((label_of, labels.sets))
}

/// All sub-cells of the component that a shell belongs to, sorted.
fn component(around: &Around, shells: &[[u32; 2]], start: u32) -> Vec<u32> {
    let mut seen = std::collections::BTreeSet::from([start]);
    let (mut stack, mut cells) = (vec![start], Vec::new());
    while let Some(shell) = stack.pop() {
        for &side in around.of(shell) {
            cells.push(side / 2);
            let other = shells[side as usize / 2][usize::from(side % 2 == 0)];
            if seen.insert(other) {
                stack.push(other);
            }
        }
    }
    cells.sort_unstable();
    cells.dedup();
    cells
}

/// Sides (twice the cell, plus one for the back) of each shell.
struct Around {
    sides: Vec<u32>,
    ends: Vec<u32>,
}

impl Around {
    fn new(shells: &[[u32; 2]], count: usize) -> Self {
        let mut ends = vec![0u32; count + 1];
        for &s in shells.iter().flatten() {
            ends[s as usize + 1] += 1;
        }
        for k in 0..count {
            ends[k + 1] += ends[k];
        }
        let mut sides = vec![0u32; 2 * shells.len()];
        let mut fill = ends.clone();
        for (side, &s) in shells.iter().flatten().enumerate() {
            sides[fill[s as usize] as usize] = side as u32;
            fill[s as usize] += 1;
        }
        Self { sides, ends }
    }

    fn of(&self, shell: u32) -> &[u32] {
        &self.sides[self.ends[shell as usize] as usize..self.ends[shell as usize + 1] as usize]
    }
}
