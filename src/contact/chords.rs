//! Facets that cross along a line with common points on it get the pieces of the line between them as common edges.
//!
//! Everything prismatic along one axis crosses so: where the outlines of two prisms cross on their caps, the points are common,
//! and the walls below cross along the line from cap to cap. Without an edge there by identity, the exact stage would intersect
//! two walls whose rims are bent in the last digit, and find a line that wiggles about the true one.
//!
//! [`join_walls`] does it for walls that came in several facets, [`find`] for facets.

use super::body::Body;
use super::candidates::PARALLEL_FROM;
use super::crossings::{across, cross};
use super::edges::EdgeSet;
use super::outline::Outline;
use super::walls::Walls;
use crate::geom::Vec3;
use crate::geom::lists::Lists;
use rayon::prelude::*;

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
    let mut may_hold: Vec<bool> = outlines.iter().map(|o| o.corners().count() >= CHORD_CORNERS).collect();
    inside.iter().for_each(|i| may_hold[i.0 as usize] = true);
    outlines.iter().zip(&mut may_hold).for_each(|(o, may)| *may &= !body.fate(o.facet).is_aside());
    let corners = outlines.iter().zip(0..).filter(|o| may_hold[o.1 as usize]);
    let mut uses: Vec<(u32, u32)> = corners.flat_map(|(o, slot)| o.corners().map(move |v| (v, slot))).collect();
    uses.extend(inside.iter().map(|&(slot, v)| (v, slot)));
    let leaf_of = |slot: u32| body.leaf_of_facet[outlines[slot as usize].facet as usize];
    let may_cross = |f: u32, g: u32| {
        sheet_of[f as usize] != sheet_of[g as usize] && are_crossing(&outlines[f as usize].normal, &outlines[g as usize].normal)
    };
    let common = common_points(body.points.len(), uses, leaf_of, may_cross);
    let pairs: Vec<&[Common]> = common.chunk_by(|a, b| a.pair == b.pair).filter(|pair| pair.len() > 1).collect();
    let chords = |pair: &&[Common]| {
        let facets = pair[0].facets();
        let [f, g] = facets.map(|slot| &outlines[slot as usize]);
        let tolerance = body.tolerance(leaf_of(facets[0]), leaf_of(facets[1]));
        let is_chord = move |ends: &[u32; 2]| [f, g].iter().all(|o| o.is_chord(*ends, tolerance, &body.points));
        let pieces = pieces(pair, &f.normal.cross(&g.normal), &body.points).into_iter();
        pieces.filter(is_chord).map(move |ends| Chord { facets, ends })
    };
    pairs.par_iter().with_min_len(PARALLEL_FROM).flat_map_iter(chords).collect()
}

/// Where walls cross between common points, the edges that divide them get common points too, so that [`find`] can join them.
pub(super) fn join_walls(body: &mut Body, set: &mut EdgeSet) {
    let walls = Walls::new(body, set);
    if walls.is_empty() {
        return;
    }
    let leaf_of = |wall: u32| body.leaf_of_facet[wall as usize];
    let may_cross =
        |f: u32, g: u32| (walls.is_divided(f) || walls.is_divided(g)) && are_crossing(&walls.normal(f), &walls.normal(g));
    let common = common_points(body.points.len(), walls.points(set), leaf_of, may_cross);
    for pair in common.chunk_by(|a, b| a.pair == b.pair) {
        let [f, g] = pair[0].facets();
        let tolerance = body.tolerance(body.leaf_of_facet[f as usize], body.leaf_of_facet[g as usize]);
        for ends in pieces(pair, &walls.normal(f).cross(&walls.normal(g)), &body.points) {
            let chord = ends.map(|v| body.points[v as usize]);
            let middle = (chord[0] + chord[1]) * 0.5;
            if !walls.enclose(f, &middle, body) || !walls.enclose(g, &middle, body) {
                continue;
            }
            for &edge in walls.divisions(f).iter().chain(walls.divisions(g)) {
                let line = set.ends(edge, &body.points);
                if let Some(x) = across(&line, &chord, tolerance) {
                    cross(body, set, &[edge], &[line, chord], tolerance, x);
                }
            }
        }
    }
    set.sort();
}

fn are_crossing(a: &Vec3, b: &Vec3) -> bool {
    a.cross(b).norm_squared() > CROSSING_SINE * CROSSING_SINE
}

/// A point that two facets have; in the order of the facets.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Common {
    /// The facets, ascending, as one number: those are sorted in half the time.
    pair: u64,
    point: u32,
}

impl Common {
    fn facets(&self) -> [u32; 2] {
        [(self.pair >> 32) as u32, self.pair as u32]
    }
}

/// The common points of pairs that have at least two, sorted, from what each point is on: (point, facet).
fn common_points(
    count: usize,
    uses: Vec<(u32, u32)>,
    leaf_of: impl Fn(u32) -> u32,
    may_cross: impl Fn(u32, u32) -> bool,
) -> Vec<Common> {
    // A point of one leaf is common to nothing.
    const SEVERAL: u32 = u32::MAX - 1;
    let mut leaves = vec![u32::MAX; count];
    for &(v, facet) in &uses {
        let (leaf, known) = (leaf_of(facet), &mut leaves[v as usize]);
        *known = if *known == u32::MAX || *known == leaf { leaf } else { SEVERAL };
    }
    let facets_at = Lists::from_iter(count, uses.iter().copied().filter(|u| leaves[u.0 as usize] == SEVERAL));
    let (mut common, mut at): (Vec<Common>, Vec<u32>) = Default::default();
    for point in 0..count as u32 {
        at.clear();
        at.extend_from_slice(facets_at.of(point));
        at.sort_unstable();
        at.dedup();
        for (k, &f) in at.iter().enumerate() {
            let crossing = at[k + 1..].iter().filter(|&&g| leaf_of(f) != leaf_of(g) && may_cross(f, g));
            common.extend(crossing.map(|&g| Common { pair: u64::from(f) << 32 | u64::from(g), point }));
        }
    }
    common.par_sort_unstable();
    common
}

/// The pieces between the common points of two facets that cross along `line`, lower point first.
fn pieces(pair: &[Common], line: &Vec3, points: &[Vec3]) -> Vec<[u32; 2]> {
    if pair.len() < 2 {
        return Vec::new();
    }
    let (at, line) = (|v: u32| points[v as usize], line.normalize());
    let mut along: Vec<(f64, u32)> = pair.iter().map(|p| ((at(p.point) - at(pair[0].point)).dot(&line), p.point)).collect();
    along.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let is_along = |s: &&[(f64, u32)]| s[1].0 - s[0].0 > ALONG * (at(s[1].1) - at(s[0].1)).norm();
    along.windows(2).filter(is_along).map(|s| [s[0].1.min(s[1].1), s[0].1.max(s[1].1)]).collect()
}
