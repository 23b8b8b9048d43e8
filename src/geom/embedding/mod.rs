//! Exact proof that triangles meet only in whole shared vertices and edges.
//!
//! Reads triangles with `f64` vertices from `round` or a .poly file; whatever else the triangles have in common is a
//! [`Violation`]. Candidate pairs come from a self-join of the box tree; the great majority are neighbours, which
//! [`contact`] settles by a few signs in a coordinate plane. Only the rest needs signs of volumes. Everything is decided by
//! `predicates`, so a penetration by one unit in the last place is found and a near miss is none.
//!
//! Example: two triangles over one edge are fine; with a vertex of a third in the middle of that edge, the third and each of
//! the two are a `VertexOnEdge`.

mod bundles;
mod contact;
mod fans;
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
/// are given depends on the arguments only, not on the number of threads. Cost: O(n log n + pairs whose boxes overlap), and of
/// triangles around vertices that very many share O(n log² n + pairs that no plane is found between), and pairs of edges of
/// terrains' rims whose boxes overlap.
pub fn violations(points: &[Vec3], triangles: &[[u32; 3]], limit: usize) -> Vec<Violation> {
    let projections: Vec<Option<Projection>> =
        triangles.par_iter().with_min_len(1024).map(|t| projection_of(t.map(|v| points[v as usize]))).collect();
    let mut found: Vec<Violation> = (0..triangles.len() as u32)
        .filter(|&t| projections[t as usize].is_none())
        .map(|t| Violation { triangles: [t, t], kind: Kind::Degenerate, point: points[triangles[t as usize][0] as usize] })
        .take(limit)
        .collect();
    let (mut plain, fans) = fans::split(points, triangles, &projections);
    let mut terrain_of = vec![NONE; triangles.len()];
    if triangles.len() >= MANY {
        let Terrains { of, live } = Terrains::new(points, triangles, &projections);
        let mut is_plain = vec![false; triangles.len()];
        plain.iter().for_each(|&t| is_plain[t as usize] = true);
        plain = live.into_iter().filter(|&t| is_plain[t as usize]).collect();
        terrain_of = of;
    }
    let around = |t: u32| Aabb::around(triangles[t as usize].iter().map(|&v| &points[v as usize]));
    let mut tree = Bvh::new(plain.iter().map(|&t| around(t)).collect());
    let number: Vec<u32> = tree.renumber().into_iter().map(|k| plain[k as usize]).collect();
    // Triangles in the order of the tree: pairs then lie side by side in memory.
    let face = |number: u32| {
        let t = number as usize;
        Face { number, corners: triangles[t], projection: projections[t], terrain: terrain_of[t] }
    };
    let faces: Vec<Face> = number.iter().map(|&t| face(t)).collect();
    let search = |task| {
        let mut local = Vec::new();
        tree.overlapping_pairs(task, |s, t| {
            local.extend(violation(points, &faces[s as usize], &faces[t as usize]));
            if local.len() < limit { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        });
        local
    };
    let pieces: Vec<Vec<Violation>> = tree.pair_tasks(TASKS).into_par_iter().map(search).collect();
    found.extend(pieces.into_iter().flatten());
    let before = found.len();
    for &t in &fans.triangles {
        if found.len() - before >= limit {
            break;
        }
        tree.overlapping(&around(t), |s| found.extend(violation(points, &faces[s as usize], &face(t))));
    }
    let before = found.len();
    fans.pairs(|s, t| {
        found.extend(violation(points, &face(s), &face(t)));
        if found.len() - before < limit { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    });
    found.sort_unstable_by_key(|v| v.triangles);
    found.truncate(limit);
    found
}

/// A triangle.
struct Face {
    number: u32,
    corners: [u32; 3],
    /// If it has area.
    projection: Option<Projection>,
    /// The proven terrain that it belongs to, or [`NONE`].
    terrain: u32,
}

/// What is wrong between two triangles with area.
fn violation(points: &[Vec3], one: &Face, other: &Face) -> Option<Violation> {
    if one.terrain == other.terrain && one.terrain != NONE {
        return None;
    }
    let [first, second] = if one.number < other.number { [one, other] } else { [other, one] };
    let pair = contact::Pair {
        points,
        triangles: [first.corners, second.corners],
        projections: [first.projection?, second.projection?],
    };
    let (kind, point) = pair.forbidden_contact()?;
    Some(Violation { triangles: [first.number, second.number], kind, point })
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
