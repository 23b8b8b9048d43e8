//! The usual sheet without a triangulation of the whole: one convex facet that is cut from side to side.

use super::body::Body;
use super::cells::{Draft, plain};
use super::outline::{Outline, passes};
use super::sheets::Sheet;

/// Cuts above which the triangulation, which looks for nothing twice, is cheaper.
const MAX_CUTS: usize = 16;

/// The cells of a sheet of one convex facet that only segments from side to side lie on; `None` if it is another.
pub(super) fn cut(sheet: &Sheet, outlines: &[Outline], body: &Body, tolerance: f64) -> Option<Vec<Draft>> {
    let points = &body.points;
    let outline = &outlines[sheet.reference as usize];
    let is_simple = sheet.members.len() == 1 && sheet.lone.is_empty();
    if !is_simple || sheet.segments.len() + sheet.chords.len() > MAX_CUTS || !outline.is_convex(points) {
        return None;
    }
    let mut walks = outline.loops.clone();
    if !sheet.segments.iter().all(|&ends| divide(&mut walks, ends)) {
        return None;
    }
    let mut chords = sheet.chords.to_vec();
    while let Some([a, b]) = chords.pop() {
        let line = [a, b].map(|v| points[v as usize]);
        let is_passed = |v: &&u32| passes(&line, &points[**v as usize], tolerance);
        // A chord past a corner goes through that corner: beside it, a needle would be left that rounding turns over.
        let walk = walks.iter().find(|w| w.contains(&a) && w.contains(&b));
        match walk.and_then(|w| w.iter().find(is_passed)) {
            Some(&v) => chords.extend([[a, v], [v, b]]),
            None => drop(divide(&mut walks, [a, b])),
        }
    }
    walks.into_iter().map(|walk| plain(outline.facet, vec![walk], body).ok()).collect()
}

/// Cuts the walk that has both points; false if none has, since another cut lies between them.
fn divide(walks: &mut Vec<Vec<u32>>, [a, b]: [u32; 2]) -> bool {
    for walk in walks.iter_mut() {
        let at = |v: u32| walk.iter().position(|&w| w == v);
        if let (Some(i), Some(j)) = (at(a), at(b)) {
            let (i, j) = (i.min(j), i.max(j));
            let is_side = j - i == 1 || j - i == walk.len() - 1;
            if !is_side {
                let part = walk[i..=j].to_vec();
                walk.drain(i + 1..j);
                walks.push(part);
            }
            return true;
        }
    }
    false
}
