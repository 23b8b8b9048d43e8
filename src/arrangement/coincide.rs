//! Pieces of coplanar triangles with the same loops become one piece with several owners.

use super::SubCells;
use crate::contact::conforming::Owner;
use crate::geom::hash::{IndexMap, IndexSet};

/// Merges coinciding pieces; of each set the first stays, with all owners.
pub fn merge(cells: &mut SubCells, is_coplanar: &IndexSet<u32>) {
    if is_coplanar.is_empty() {
        return;
    }
    let mut first: IndexMap<Vec<u32>, (usize, Vec<u32>)> = IndexMap::default();
    let mut extra: IndexMap<usize, Vec<Owner>> = IndexMap::default();
    let mut is_gone = vec![false; cells.len()];
    for (cell, is_gone) in is_gone.iter_mut().enumerate() {
        if !is_coplanar.contains(&cells.triangle[cell]) {
            continue;
        }
        let mut key: Vec<u32> = cells.loops(cell).flatten().copied().collect();
        key.sort_unstable();
        let outer = cells.loops(cell).next().unwrap_or(&[]).to_vec();
        let Some((kept, walk)) = first.get(&key) else {
            first.insert(key, (cell, outer));
            continue;
        };
        let Some(is_turned) = compare_loops(walk, &outer) else { continue };
        *is_gone = true;
        let owners = extra.entry(*kept).or_insert_with(|| cells.owners_of(*kept).to_vec());
        owners.extend(cells.owners_of(cell).iter().map(|o| Owner { is_flipped: o.is_flipped ^ is_turned, ..*o }));
    }
    rebuild(cells, &is_gone, &mut extra);
}

/// Whether two loops over the same points run against each other; `None` if they are not the same loop.
fn compare_loops(a: &[u32], b: &[u32]) -> Option<bool> {
    let n = a.len();
    if n != b.len() {
        return None;
    }
    (0..n).filter(|&s| b[s] == a[0]).find_map(|start| {
        let forward = (0..n).all(|k| a[k] == b[(start + k) % n]);
        let backward = (0..n).all(|k| a[k] == b[(start + n - k) % n]);
        if forward { Some(false) } else { backward.then_some(true) }
    })
}

fn rebuild(cells: &mut SubCells, is_gone: &[bool], extra: &mut IndexMap<usize, Vec<Owner>>) {
    let mut kept = SubCells::new(cells.input);
    for cell in (0..cells.len()).filter(|&c| !is_gone[c]) {
        let list = match extra.remove(&cell) {
            Some(mut owners) => {
                owners.sort_unstable();
                owners.dedup();
                kept.coinciding.push(owners);
                (cells.input.cells.len() + kept.coinciding.len() - 1) as u32
            }
            None => cells.owners[cell],
        };
        kept.push(cells.triangle[cell], list, cells.loops(cell));
    }
    *cells = kept;
}
