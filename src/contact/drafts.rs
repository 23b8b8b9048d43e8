//! Cells of all sheets before it is known which of them are the same.

use super::cells::Draft;
use super::conforming::Owner;
use crate::geom::Vec3;
use crate::geom::hash::IndexMap;
use crate::geom::polygon;

/// Cells in order, stored flat: there are many, and most are one triangle of one facet.
#[derive(Default)]
pub(super) struct Drafts {
    /// For each cell its sheet, and the ends of its owners and triangles.
    cells: Vec<[u32; 3]>,
    owners: Vec<Owner>,
    triangles: Vec<[u32; 3]>,
    /// Cells that other sheets may have too: the number and all that is known.
    common: Vec<(u32, Draft)>,
}

impl Drafts {
    /// Adds a cell of a sheet, which other sheets may have too if it `is_common`.
    pub fn push(&mut self, sheet: u32, draft: Draft, is_common: bool) {
        if is_common {
            self.common.push((self.cells.len() as u32, draft));
        } else {
            self.owners.extend(&draft.owners);
            self.triangles.extend(&draft.triangles);
        }
        self.cells.push([sheet, self.owners.len() as u32, self.triangles.len() as u32]);
    }
    /// Adds the cells of others.
    pub fn append(&mut self, others: Self) {
        let (cells, owners, triangles) = (self.cells.len() as u32, self.owners.len() as u32, self.triangles.len() as u32);
        self.cells.extend(others.cells.iter().map(|&[sheet, o, t]| [sheet, owners + o, triangles + t]));
        self.owners.extend(others.owners);
        self.triangles.extend(others.triangles);
        self.common.extend(others.common.into_iter().map(|(cell, draft)| (cells + cell, draft)));
    }
    /// Number of cells.
    pub fn len(&self) -> usize {
        self.cells.len()
    }
    /// Makes one cell of those with the same outline: the first has all owners then, the others none.
    pub fn join(&mut self, points: &[Vec3]) {
        let mut last: IndexMap<[u32; 4], u32> = IndexMap::default();
        let mut previous = vec![u32::MAX; self.common.len()];
        for k in 0..self.common.len() {
            let loops = &self.common[k].1.loops;
            let last = last.entry(short_key(loops)).or_insert(u32::MAX);
            let mut slot = *last;
            // Hardly any cells have the same short key and are not the same.
            while let Some((_, other)) = self.common.get(slot as usize)
                && outline_key(&other.loops).0 != outline_key(loops).0
            {
                slot = previous[slot as usize];
            }
            if slot == u32::MAX {
                previous[k] = std::mem::replace(last, k as u32);
                continue;
            }
            let same = std::mem::take(&mut self.common[k].1);
            join(&mut self.common[slot as usize].1, same, points);
        }
    }
    /// The sheet, owners and triangles of each cell that has an owner.
    pub fn iter(&self) -> impl Iterator<Item = (u32, &[Owner], &[[u32; 3]])> {
        let mut common = self.common.iter().peekable();
        let mut starts = [0, 0];
        let cells = self.cells.iter().zip(0..).map(move |(&[sheet, owners, triangles], number)| {
            let [first_owner, first_triangle] = std::mem::replace(&mut starts, [owners, triangles]).map(|k| k as usize);
            match common.next_if(|c| c.0 == number) {
                Some((_, draft)) => (sheet, &draft.owners[..], &draft.triangles[..]),
                None => {
                    (sheet, &self.owners[first_owner..owners as usize], &self.triangles[first_triangle..triangles as usize])
                }
            }
        });
        cells.filter(|c| !c.1.is_empty())
    }
}

/// Adds what is known of a cell to the one that has the same outline.
fn join(kept: &mut Draft, same: Draft, points: &[Vec3]) {
    let is_flipped = outline_key(&kept.loops).1 != outline_key(&same.loops).1;
    kept.owners.extend(same.owners.iter().map(|o| Owner { is_flipped: o.is_flipped != is_flipped, ..*o }));
    if same.chains == kept.chains && same.lone == kept.lone {
        return;
    }
    kept.chains.extend(same.chains);
    kept.chains.sort_unstable();
    kept.chains.dedup();
    kept.lone.extend(same.lone);
    kept.lone.sort_unstable();
    kept.lone.dedup();
    kept.lone.retain(|v| kept.chains.iter().all(|c| !c.contains(v)));
    let loops: Vec<&[u32]> = kept.loops.iter().map(Vec::as_slice).collect();
    if let Ok(triangles) = polygon::triangulate(&loops, &kept.chains, &kept.lone, points) {
        kept.triangles = triangles;
    }
}

/// What equal outlines have in common and others hardly: the lowest point of the outer loop between its neighbours, and the
/// number of points.
fn short_key(loops: &[Vec<u32>]) -> [u32; 4] {
    let Some(walk) = loops.first().filter(|w| !w.is_empty()) else { return [u32::MAX; 4] };
    let n = walk.len();
    let first = (0..n).min_by_key(|&k| walk[k]).unwrap_or(0);
    let (a, b) = (walk[(first + n - 1) % n], walk[(first + 1) % n]);
    [walk[first], a.min(b), a.max(b), loops.iter().map(Vec::len).sum::<usize>() as u32]
}

/// Loops from their lowest points towards the lower neighbour, holes sorted; and whether that turns the outer loop round.
fn outline_key(loops: &[Vec<u32>]) -> (Vec<u32>, bool) {
    let mut turned: Vec<(bool, Vec<u32>)> = loops
        .iter()
        .map(|walk| {
            let n = walk.len();
            let first = (0..n).min_by_key(|&k| walk[k]).unwrap_or(0);
            let is_reversed = walk[(first + n - 1) % n] < walk[(first + 1) % n];
            let step = if is_reversed { n - 1 } else { 1 };
            (is_reversed, (0..n).map(|k| walk[(first + k * step) % n]).collect())
        })
        .collect();
    let is_reversed = turned.first().is_some_and(|t| t.0);
    if let [_, holes @ ..] = &mut turned[..] {
        holes.sort_by(|a, b| a.1.cmp(&b.1));
    }
    let key = turned.into_iter().flat_map(|t| t.1.into_iter().chain([u32::MAX])).collect();
    (key, is_reversed)
}
