//! The sub-cells around every edge, sorted by angle.

use crate::arrangement::projection_of_triangle;
use crate::arrangement::{Arrangement, SubCells};
use crate::cull::Fate;
use crate::diag::Diagnostic;
use crate::geom::Vec3;
use crate::geom::lists::Lists;
use crate::geom::predicates::{Sign, orient3d};
use crate::geom::union_find::UnionFind;
use rayon::prelude::*;
use std::cmp::Ordering;
use std::ops::Range;

/// Edges that one thread takes at once: nearly all of them have two pieces and take no time.
const SHARE: usize = 1 << 14;

/// Directed edges (corners of the sub-cells' loops) grouped by undirected edge; within a group counter-clockwise about the
/// direction from the smaller to the larger point number. Those of pieces that are set aside come last: they have no angle,
/// since they are spanned by any triangles.
pub struct EdgeUses {
    /// Corner numbers.
    pub uses: Vec<u32>,
    /// End of each group in `uses`.
    pub ends: Vec<u32>,
    /// Sub-cell of each corner.
    pub cell_of: Vec<u32>,
    /// Next corner in the same loop.
    pub next: Vec<u32>,
    /// Whether a corner's edge runs from the smaller to the larger point number.
    pub is_forward: Vec<bool>,
}

impl EdgeUses {
    /// Groups and sorts.
    pub fn new(arrangement: &Arrangement) -> Result<Self, Diagnostic> {
        let cells = &arrangement.cells;
        let corners = cells.corners();
        let (mut cell_of, mut next) = (vec![0u32; corners.len()], vec![0u32; corners.len()]);
        let mut is_forward = vec![false; corners.len()];
        // Corners by the smaller end of their edge: lists so short that sorting them costs little.
        let mut by_lower: Vec<(u32, u32)> = Vec::with_capacity(corners.len());
        for (range, cell) in cells.loop_ranges() {
            let (start, end) = (range.start, range.end);
            let is_copy = cells.fate_of(cell) == Fate::Copy;
            for k in range {
                cell_of[k] = cell as u32;
                next[k] = if k + 1 == end { start } else { k + 1 } as u32;
                let (a, b) = (corners[k], corners[next[k] as usize]);
                is_forward[k] = a < b;
                if a != b && !is_copy {
                    by_lower.push((a.min(b), k as u32));
                }
            }
        }
        let at = Lists::new(arrangement.points.len(), &by_lower);
        let upper = |k: u32| corners[k as usize].max(corners[next[k as usize] as usize]);
        let (mut uses, mut ends) = (Vec::with_capacity(by_lower.len()), Vec::with_capacity(by_lower.len() / 2));
        let mut keyed: Vec<u64> = Vec::new();
        for lower in 0..arrangement.points.len() as u32 {
            keyed.clear();
            keyed.extend(at.of(lower).iter().map(|&k| u64::from(upper(k)) << 32 | u64::from(k)));
            keyed.sort_unstable();
            for same in keyed.chunk_by(|a, b| a >> 32 == b >> 32) {
                uses.extend(same.iter().map(|&k| k as u32));
                ends.push(uses.len() as u32);
            }
        }
        let mut out = Self { uses, ends, cell_of, next, is_forward };
        out.sort_by_angle(arrangement)?;
        Ok(out)
    }

    /// Number of groups.
    pub fn count(&self) -> usize {
        self.ends.len()
    }

    /// Some of the groups.
    pub fn groups_in(&self, range: Range<usize>) -> impl Iterator<Item = &[u32]> {
        let first = range.start.checked_sub(1).map_or(0, |last| self.ends[last]);
        let starts = std::iter::once(first).chain(self.ends[range.clone()].iter().copied());
        starts.zip(&self.ends[range]).map(|(a, &b)| &self.uses[a as usize..b as usize])
    }

    /// The groups: corners of one undirected edge, by angle.
    pub fn groups(&self) -> impl Iterator<Item = &[u32]> {
        self.groups_in(0..self.count())
    }

    fn sort_by_angle(&mut self, arrangement: &Arrangement) -> Result<(), Diagnostic> {
        let mut uses = std::mem::take(&mut self.uses);
        let (mut rest, mut start) = (&mut uses[..], 0);
        let mut shares = Vec::with_capacity(self.ends.len().div_ceil(SHARE));
        for ends in self.ends.chunks(SHARE) {
            let end = ends[ends.len() - 1];
            let (own, others) = std::mem::take(&mut rest).split_at_mut((end - start) as usize);
            shares.push((start, ends, own));
            (rest, start) = (others, end);
        }
        let sort = |(mut start, ends, mut own): (u32, &[u32], &mut [u32])| {
            ends.iter().try_for_each(|&end| {
                let (group, others) = std::mem::take(&mut own).split_at_mut((end - start) as usize);
                (own, start) = (others, end);
                self.sort_group(arrangement, group)
            })
        };
        let sorted: Vec<Result<(), Diagnostic>> = shares.into_par_iter().map(sort).collect();
        self.uses = uses;
        // The first fault, whichever thread ended first.
        sorted.into_iter().collect()
    }

    fn sort_group(&self, arrangement: &Arrangement, group: &mut [u32]) -> Result<(), Diagnostic> {
        match *group {
            [] | [_, _] => {}
            [corner] if !self.may_end(arrangement, corner) => return Err(self.open_edge(arrangement, corner)),
            [_] => {}
            _ => {
                let compared = self.put_aside(arrangement, group);
                if compared > 2 {
                    let mut fans: Vec<Fan> = group[..compared].iter().map(|&c| self.fan(arrangement, c)).collect();
                    sort_fans(arrangement, &mut fans)?;
                    group.iter_mut().zip(&fans).for_each(|(slot, fan)| *slot = fan.corner);
                }
            }
        }
        Ok(())
    }

    /// Moves those of a group that are set aside to its end; the number of the others.
    fn put_aside(&self, arrangement: &Arrangement, group: &mut [u32]) -> usize {
        if !arrangement.cells.has_fates() {
            return group.len();
        }
        let is_aside = |c: &u32| arrangement.cells.fate_of(self.cell_of[*c as usize] as usize).is_aside();
        group.sort_by_key(is_aside);
        group.partition_point(|c| !is_aside(c))
    }

    /// Whether a piece need not go on beyond its edge: facets that coincide end it together, or it does not matter.
    fn may_end(&self, arrangement: &Arrangement, corner: u32) -> bool {
        let cell = self.cell_of[corner as usize] as usize;
        arrangement.cells.owners_of(cell).len() > 1 || arrangement.cells.fate_of(cell) != Fate::Live
    }

    fn open_edge(&self, arrangement: &Arrangement, corner: u32) -> Diagnostic {
        let at = arrangement.points.at(arrangement.cells.corners()[corner as usize]);
        Diagnostic::internal("open-edge", "an edge of the arrangement has one piece only").near(at)
    }

    fn fan(&self, arrangement: &Arrangement, corner: u32) -> Fan {
        let corners = arrangement.cells.corners();
        let (a, b) = (corners[corner as usize], corners[self.next[corner as usize] as usize]);
        let triangle = arrangement.input.triangles[arrangement.cells.triangle[self.cell_of[corner as usize] as usize] as usize];
        let place_of = |p: u32| triangle.iter().position(|&v| v == p);
        let (apex, side) = match (place_of(a), place_of(b)) {
            // Triangles turn counter-clockwise.
            (Some(i), Some(j)) => (triangle[3 - i - j], if (i + 1) % 3 == j { 1 } else { -1 }),
            _ => apex(arrangement, [a, b], triangle),
        };
        let is_forward = self.is_forward[corner as usize];
        // The piece lies to the left of its own directed edge.
        let line = if is_forward { [a, b] } else { [b, a] };
        let is_live = arrangement.cells.fate_of(self.cell_of[corner as usize] as usize) == Fate::Live;
        Fan { corner, is_forward, triangle, line, apex, side, is_live }
    }

    /// The pairs of sides (twice the sub-cell, plus one for its back) that face each other at one edge, of a group or some of
    /// its corners in its order.
    pub fn facing_in(&self, group: &[u32]) -> impl Iterator<Item = [u32; 2]> {
        (0..group.len()).map(move |k| {
            let (i, j) = (group[k] as usize, group[(k + 1) % group.len()] as usize);
            // Turning counter-clockwise one leaves a forward piece at its front, and meets a forward piece at its back.
            let leaves = 2 * self.cell_of[i] + u32::from(!self.is_forward[i]);
            let meets = 2 * self.cell_of[j] + u32::from(self.is_forward[j]);
            [leaves, meets]
        })
    }

    /// Shells on the front and back of each sub-cell, and the number of shells. Only live pieces share shells, and not at edges
    /// where a piece that is set aside may stand between them.
    pub fn shells(&self, cells: &SubCells) -> (Vec<[u32; 2]>, usize) {
        let mut sets = UnionFind::new(2 * cells.len());
        let is_live = |side: u32| cells.fate_of(side as usize / 2) == Fate::Live;
        for compared in self.groups().filter_map(|group| self.compared(group, cells)) {
            for [a, b] in self.facing_in(compared).filter(|pair| pair.iter().all(|&side| is_live(side))) {
                sets.join(a, b);
            }
        }
        let (set, total) = sets.number();
        (set.chunks_exact(2).map(|s| [s[0], s[1]]).collect(), total)
    }

    /// The corners of a group that are not set aside, unless a piece that is stands at the edge, too.
    fn compared<'a>(&self, group: &'a [u32], cells: &SubCells) -> Option<&'a [u32]> {
        if !cells.has_fates() {
            return Some(group);
        }
        let cell = |corner: &u32| self.cell_of[*corner as usize] as usize;
        let (compared, aside) = group.split_at(group.partition_point(|c| !cells.fate_of(cell(c)).is_aside()));
        // Where two triangles that span one piece meet, it does not end: the edge may lie outside of it.
        let is_spanned = |c: &u32| {
            let is_back = |d: &u32| self.is_forward[*d as usize] != self.is_forward[*c as usize];
            aside.iter().any(|d| is_back(d) && cells.owners[cell(d)] == cells.owners[cell(c)])
        };
        aside.iter().all(is_spanned).then_some(compared)
    }
}

/// One piece at an edge.
#[derive(Clone, Copy)]
struct Fan {
    corner: u32,
    is_forward: bool,
    triangle: [u32; 3],
    /// Points of the edge, smaller number first.
    line: [u32; 2],
    /// A vertex of the triangle off the edge's line.
    apex: u32,
    /// +1 if the apex is on the same side of the line as the piece.
    side: Sign,
    /// Whether it matters if another coincides with it.
    is_live: bool,
}

/// A corner of the triangle off the line through two points of it, and its side: the one farthest from the line, whose side is
/// certain for the filter.
fn apex(arrangement: &Arrangement, [a, b]: [u32; 2], triangle: [u32; 3]) -> (u32, Sign) {
    let (points, projection) = (&arrangement.points, projection_of_triangle(arrangement.input, triangle));
    let (pa, pb) = (projection.apply(&points.at(a)), projection.apply(&points.at(b)));
    let distance = |v: u32| {
        let q = projection.apply(&points.at(v));
        ((pb[0] - pa[0]) * (q[1] - pa[1]) - (pb[1] - pa[1]) * (q[0] - pa[0])).abs()
    };
    let mut order = triangle.map(|v| (distance(v), v));
    order.sort_by(|v, w| w.0.total_cmp(&v.0));
    let off = order.into_iter().find_map(|(_, v)| match points.orient2d(a, b, v, projection) {
        0 => None,
        side => Some((v, side)),
    });
    off.unwrap_or((order[0].1, 1))
}

/// Sign of the turn about the edge from piece `i` to piece `j`: +1 if j is less than half a turn counter-clockwise; 0 if both
/// lie in one plane.
fn turn(arrangement: &Arrangement, i: &Fan, j: &Fan) -> Sign {
    // Pieces of one triangle on both sides of an edge are the most frequent ones in one plane.
    if i.triangle.contains(&j.apex) {
        return 0;
    }
    let at = |v: u32| &arrangement.input.points[v as usize];
    let [a, b, c] = i.triangle.map(at);
    let forward = if i.is_forward { 1 } else { -1 };
    forward * j.side * orient3d(a, b, c, at(j.apex))
}

/// For two pieces in one plane: +1 if they lie on the same side of the edge.
fn alike(arrangement: &Arrangement, i: &Fan, j: &Fan) -> Sign {
    let projection = projection_of_triangle(arrangement.input, i.triangle);
    let left = arrangement.points.orient2d(i.line[0], i.line[1], j.apex, projection);
    (if i.is_forward { 1 } else { -1 }) * left * j.side
}

fn sort_fans(arrangement: &Arrangement, fans: &mut [Fan]) -> Result<(), Diagnostic> {
    let reference = fans[0];
    let mut is_broken = false;
    // Half turn of each piece seen from the first: 0 itself, 1 less than half a turn, 2 opposite, 3 more.
    let mut keyed: Vec<(u8, Fan)> = Vec::with_capacity(fans.len());
    for (k, fan) in fans.iter().enumerate() {
        let half = match turn(arrangement, &reference, fan) {
            _ if k == 0 => 0,
            1 => 1,
            -1 => 3,
            _ => {
                // A piece that touches the edge from both sides (the edge ends inside it) is there twice, on opposite sides.
                is_broken |= reference.is_live && fan.is_live && alike(arrangement, &reference, fan) > 0;
                2
            }
        };
        keyed.push((half, *fan));
    }
    keyed.sort_by(|a, b| {
        a.0.cmp(&b.0).then_with(|| match turn(arrangement, &a.1, &b.1) {
            1 => Ordering::Less,
            -1 => Ordering::Greater,
            _ => Ordering::Equal,
        })
    });
    for pair in keyed.windows(2) {
        let [(p, a), (q, b)] = [pair[0], pair[1]];
        is_broken |= a.is_live && b.is_live && p == q && turn(arrangement, &a, &b) == 0;
    }
    if is_broken {
        let at: Vec3 = arrangement.points.at(reference.line[0]);
        return Err(Diagnostic::internal("coinciding-pieces", "two pieces of the arrangement coincide").near(at));
    }
    for (slot, (_, fan)) in fans.iter_mut().zip(keyed) {
        *slot = fan;
    }
    Ok(())
}
