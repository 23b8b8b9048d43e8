//! Facets that cross along a line with common points on it get the pieces of the line between them as common edges.
//!
//! Everything prismatic along one axis crosses so: where the outlines of two prisms cross on their caps, the points are common,
//! and the walls below cross along the line from cap to cap. Without an edge there by identity, the exact stage would intersect
//! two walls whose rims are bent in the last digit, and find a line that wiggles about the true one.

use super::body::Body;
use super::edges::Lists;
use super::outline::Outline;

/// Sine of the angle between facets from which they count as crossing: below, the place of their common line within the
/// tolerance of both is arbitrary.
const CROSSING_SINE: f64 = 1e-6;
/// Smallest cosine between the common line and a piece of it: points that lie apart across the line are no ends of one.
const ALONG: f64 = 0.5;
/// Corners that a facet needs for two that no side joins.
const CHORD_CORNERS: usize = 4;

/// A piece of the line in which two facets cross, inside both.
pub(super) struct Chord {
    /// Slots of the facets, ascending.
    pub facets: [u32; 2],
    pub ends: [u32; 2],
}

/// All chords, in the order of their facets. `inside` are the points that lie inside facets, as (slot, point).
///
/// O(n log n) in the pairs of facets that share a point.
pub(super) fn find(body: &Body, outlines: &[Outline], sheet_of: &[u32], inside: &[(u32, u32)]) -> Vec<Chord> {
    let at = facets_at_points(body, outlines, inside);
    let may_hold = may_hold_chord(outlines, inside);
    let mut common: Vec<([u32; 2], u32)> = Vec::new();
    for point in 0..body.points.len() as u32 {
        let facets = at.of(point);
        for (k, &f) in facets.iter().enumerate().filter(|f| may_hold[*f.1 as usize]) {
            let [leaf, sheet] = [body.leaf_of_facet[outlines[f as usize].facet as usize], sheet_of[f as usize]];
            for &g in facets[k + 1..].iter().filter(|g| may_hold[**g as usize]) {
                if sheet != sheet_of[g as usize]
                    && leaf != body.leaf_of_facet[outlines[g as usize].facet as usize]
                    && outlines[f as usize].normal.cross(&outlines[g as usize].normal).norm() > CROSSING_SINE
                {
                    common.push(([f, g], point));
                }
            }
        }
    }
    common.sort_unstable();
    let mut chords = Vec::new();
    for pair in common.chunk_by(|a, b| a.0 == b.0).filter(|pair| pair.len() > 1) {
        chords_of_pair(body, outlines, pair, &mut chords);
    }
    chords
}

/// For every point in several leaves, the slots of the facets that it is on, ascending.
fn facets_at_points(body: &Body, outlines: &[Outline], inside: &[(u32, u32)]) -> Lists {
    const SEVERAL: u32 = u32::MAX - 1;
    let mut leaf_of = vec![u32::MAX; body.points.len()];
    let all = || {
        let corners = outlines.iter().zip(0..).flat_map(|(o, slot)| o.corners().iter().map(move |&v| (v, slot)));
        corners.chain(inside.iter().map(|&(slot, v)| (v, slot)))
    };
    for (v, slot) in all() {
        let leaf = body.leaf_of_facet[outlines[slot as usize].facet as usize];
        let known = &mut leaf_of[v as usize];
        *known = if *known == u32::MAX || *known == leaf { leaf } else { SEVERAL };
    }
    let mut uses: Vec<(u32, u32)> = all().filter(|u| leaf_of[u.0 as usize] == SEVERAL).collect();
    uses.sort_unstable();
    uses.dedup();
    Lists::new(body.points.len(), &uses)
}

/// Whether each facet has two points that no side joins.
fn may_hold_chord(outlines: &[Outline], inside: &[(u32, u32)]) -> Vec<bool> {
    let mut may_hold: Vec<bool> = outlines.iter().map(|o| o.corners().len() >= CHORD_CORNERS).collect();
    inside.iter().for_each(|i| may_hold[i.0 as usize] = true);
    may_hold
}

/// The pieces between the common points of two facets, which are in order of their numbers.
fn chords_of_pair(body: &Body, outlines: &[Outline], pair: &[([u32; 2], u32)], chords: &mut Vec<Chord>) {
    let facets = pair[0].0;
    let [f, g] = facets.map(|slot| &outlines[slot as usize]);
    let tolerance = body.tolerance(body.leaf_of_facet[f.facet as usize], body.leaf_of_facet[g.facet as usize]);
    let line = f.normal.cross(&g.normal).normalize();
    let at = |v: u32| body.points[v as usize];
    let mut along: Vec<(f64, u32)> = pair.iter().map(|p| ((at(p.1) - at(pair[0].1)).dot(&line), p.1)).collect();
    along.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    for step in along.windows(2) {
        let ends = [step[0].1.min(step[1].1), step[0].1.max(step[1].1)];
        let length = (at(ends[1]) - at(ends[0])).norm();
        if step[1].0 - step[0].0 > ALONG * length && [f, g].iter().all(|o| o.is_chord(ends, tolerance, &body.points)) {
            chords.push(Chord { facets, ends });
        }
    }
}
