//! Exact proof that triangles meet only in whole shared vertices and edges.
//!
//! Reads triangles with `f64` vertices from `round` or a .poly file; whatever else the triangles have in common is a
//! [`Violation`]. Candidate pairs come from a self-join of the box tree; the great majority are neighbours, which
//! [`contact`] settles by a few signs in a coordinate plane. Only the rest needs signs of volumes. Everything is decided by
//! `predicates`, so a penetration by one unit in the last place is found and a near miss is none.
//!
//! Example: two triangles over one edge are fine; with a vertex of a third in the middle of that edge, the third and each of
//! the two are a `VertexOnEdge`.

mod contact;
mod loose;
mod terrain;
#[cfg(test)]
mod tests;
mod twins;

pub(crate) use loose::is_inside;
pub use loose::{LooseViolation, Partner, loose_violations};

use super::Vec3;
use super::aabb::Aabb;
use super::bvh::Bvh;
use super::predicates::{Projection, orient2d};
use rayon::prelude::*;
use std::ops::ControlFlow;
use terrain::Terrains;
use twins::NONE;

/// Pieces that the search is cut into: enough to keep many threads busy, few enough to cost nothing on one. It is fixed,
/// so that the result does not depend on the number of threads.
const TASKS: usize = 512;

/// Triangles from which on [`terrain`] gains time.
const MANY: usize = 500;

/// Corners, projection and terrain of a triangle.
type Face = ([u32; 3], Option<Projection>, u32);

/// What two triangles have in common that they must not, the mildest first. Where several apply, the worst is reported.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// Two vertices with different numbers at one position.
    CoincidentVertices,
    /// A vertex of one lies inside an edge of the other (a T-junction).
    VertexOnEdge,
    /// A vertex of one lies inside the other.
    VertexOnFacet,
    /// Two edges cross in a point inside both.
    EdgesCross,
    /// An edge of one passes through the inside of the other.
    Penetration,
    /// They are coplanar and share area.
    Overlap,
    /// They have the same three vertices.
    Duplicate,
    /// The triangle has no area (both numbers of the violation are its own).
    Degenerate,
}

/// One pair of triangles that meet where they must not.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Violation {
    /// The triangles, the smaller number first.
    pub triangles: [u32; 2],
    /// How they meet.
    pub kind: Kind,
    /// A point of the meeting, to rounding.
    pub point: Vec3,
}

/// All pairs of triangles that meet anywhere but in whole shared vertices and edges, and all triangles without area, by
/// triangle numbers; at most `limit`.
///
/// `triangles` holds indices into `points`, either orientation; coordinates are finite. Vertices are shared by number, not by
/// position. A triangle without area is reported once and not paired. If there are more than `limit` violations, which of them
/// are given depends on the arguments only, not on the number of threads. Cost: O(n log n + candidate pairs).
pub fn violations(points: &[Vec3], triangles: &[[u32; 3]], limit: usize) -> Vec<Violation> {
    let projections: Vec<Option<Projection>> =
        triangles.par_iter().with_min_len(1024).map(|t| projection_of(t.map(|v| points[v as usize]))).collect();
    let mut found: Vec<Violation> = (0..triangles.len() as u32)
        .filter(|&t| projections[t as usize].is_none())
        .map(|t| Violation { triangles: [t, t], kind: Kind::Degenerate, point: points[triangles[t as usize][0] as usize] })
        .take(limit)
        .collect();
    let (of, live) = if triangles.len() < MANY {
        (vec![NONE; triangles.len()], (0..triangles.len() as u32).collect())
    } else {
        let Terrains { of, live } = Terrains::new(points, triangles, &projections);
        (of, live)
    };
    let corners = |t: u32| triangles[t as usize];
    let mut tree = Bvh::new(live.iter().map(|&t| Aabb::around(corners(t).iter().map(|&v| &points[v as usize]))).collect());
    let number: Vec<u32> = tree.renumber().into_iter().map(|k| live[k as usize]).collect();
    // Triangles in the order of the tree: pairs then lie side by side in memory.
    let faces: Vec<Face> = number.iter().map(|&t| (corners(t), projections[t as usize], of[t as usize])).collect();
    let search = |task| {
        let mut local = Vec::new();
        tree.overlapping_pairs(task, |s, t| {
            let [first, second] = if number[s as usize] < number[t as usize] { [s, t] } else { [t, s] };
            let [(s, Some(p), terrain), (t, Some(q), other)] = [first, second].map(|k| faces[k as usize]) else {
                return ControlFlow::Continue(());
            };
            if terrain == other && terrain != NONE {
                return ControlFlow::Continue(());
            }
            let pair = contact::Pair { points, triangles: [s, t], projections: [p, q] };
            if let Some((kind, point)) = pair.forbidden_contact() {
                local.push(Violation { triangles: [first, second].map(|k| number[k as usize]), kind, point });
            }
            if local.len() < limit { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        });
        local
    };
    let pieces: Vec<Vec<Violation>> = tree.pair_tasks(TASKS).into_par_iter().map(search).collect();
    found.extend(pieces.into_iter().flatten());
    found.sort_unstable_by_key(|v| v.triangles);
    found.truncate(limit);
    found
}

/// The coordinate plane in which the triangle is counter-clockwise with, as far as floats tell, the largest area; `None` if it
/// has no area in any, exactly.
pub(crate) fn projection_of(corners: [Vec3; 3]) -> Option<Projection> {
    let [a, b, c] = corners;
    let normal = (b - a).cross(&(c - a));
    let turn = |q: Projection| orient2d(q.apply(&a), q.apply(&b), q.apply(&c));
    let best = Projection::along(&normal);
    if turn(best) > 0 {
        return Some(best);
    }
    (0..3u8)
        .flat_map(|k| {
            let (u, v) = ((k + 1) % 3, (k + 2) % 3);
            [Projection { u, v }, Projection { u: v, v: u }]
        })
        .find(|&q| turn(q) > 0)
}
