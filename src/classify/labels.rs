//! Spreads labels over the shells.

use super::raycast::Rays;
use crate::arrangement::Arrangement;
use crate::contact::conforming::Owner;
use crate::cull::Fate;
use crate::diag::Diagnostic;
use crate::geom::hash::IndexMap;
use crate::geom::lists::Lists;

/// Distinct labels, each stored once.
#[derive(Default)]
struct Labels {
    sets: Vec<Vec<u32>>,
    numbers: IndexMap<Vec<u32>, u32>,
    /// Label reached from a label by entering or leaving one leaf.
    steps: IndexMap<(u32, u32, bool), u32>,
    /// The step taken last, which is most often the next one too.
    last: Option<((u32, u32, bool), u32)>,
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
            from = match self.last.filter(|l| l.0 == key).or_else(|| Some((key, *self.steps.get(&key)?))) {
                Some((_, to)) => to,
                None => {
                    let to = self.step(from, owner.leaf.0, enters)?;
                    self.steps.insert(key, to);
                    to
                }
            };
            self.last = Some((key, from));
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
pub fn spread(
    arrangement: &Arrangement,
    rays: &Rays,
    shells: &[[u32; 2]],
    count: usize,
) -> Result<(Vec<u32>, Vec<Vec<u32>>), Diagnostic> {
    let cells = &arrangement.cells;
    let by_shell: Vec<(u32, u32)> = shells.iter().flatten().zip(0..).map(|(&shell, side)| (shell, side)).collect();
    // Sides (twice the cell, plus one for the back) of each shell.
    let sides = Lists::new(count, &by_shell);
    let mut labels = Labels::default();
    let mut label_of = vec![u32::MAX; count];
    let mut stack = Vec::new();
    // The first piece of each component that a ray can start from.
    for cell in 0..shells.len() {
        let seed = shells[cell][0];
        if label_of[seed as usize] != u32::MAX || cells.fate_of(cell) != Fate::Live {
            continue;
        }
        let Some(set) = rays.label_in_front(cell)? else { continue };
        label_of[seed as usize] = labels.number(set);
        stack.push(seed);
        while let Some(shell) = stack.pop() {
            let label = label_of[shell as usize];
            for &side in sides.of(shell) {
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
    let has_label = |cell: usize| shells[cell].iter().all(|&s| label_of[s as usize] != u32::MAX);
    if !(0..shells.len()).all(|cell| cells.fate_of(cell) != Fate::Live || has_label(cell)) {
        return Err(Diagnostic::internal("no-inner-point", "no piece of a component has a place to cast a ray from"));
    }
    Ok((label_of, labels.sets))
}
