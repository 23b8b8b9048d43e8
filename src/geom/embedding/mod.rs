//! Exact proof that triangles meet only in whole shared vertices and edges.
//!
//! Reads triangles with `f64` vertices from `round` or a .poly file; whatever else the triangles have in common is a
//! [`Violation`]. Candidate pairs come from a self-join of a tree of boxes, or of hulls where boxes part too little; the great
//! majority are neighbours, which [`contact`] settles by a few signs in a coordinate plane. Only the rest needs signs of volumes.
//! Everything is decided by `predicates`, so a penetration by one unit in the last place is found and a near miss is none.
//!
//! Example: two triangles over one edge are fine; with a vertex of a third in the middle of that edge, the third and each of
//! the two are a `VertexOnEdge`.

mod apart;
mod contact;
mod growth;
mod hulls;
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
use hulls::{Hulls, Thing};
use rayon::prelude::*;
use std::ops::ControlFlow;
use terrain::{Mesh, Terrains};
use twins::{NONE, twins};

/// Pieces that the search is cut into: enough to keep many threads busy, few enough to cost nothing on one. It is fixed,
/// so that the result does not depend on the number of threads.
const TASKS: usize = 512;

/// Pairs of overlapping boxes per triangle, in one of the pieces, from which on hulls are sought instead: surfaces of well-shaped
/// triangles have some ten in all, fans and oblique needles as many as there are triangles. Hulls take half as long again.
const PAIRS_PER_TRIANGLE: usize = 200;

/// Triangles at a vertex from which on it is their hub: they hardly meet elsewhere.
const FAN: u32 = 128;

/// Triangles that one thread takes at once: each takes a few memory accesses.
const SHARE: usize = 1024;

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
/// are given depends on the arguments only, not on the number of threads. Cost: O(n log n + pairs that no plane is found between +
/// pairs of edges of terrains' rims whose boxes overlap).
pub fn violations(points: &[Vec3], triangles: &[[u32; 3]], limit: usize) -> Vec<Violation> {
    let projection = |t: &[u32; 3]| projection_of(t.map(|v| points[v as usize]));
    let projections = || triangles.par_iter().with_min_len(SHARE).map(projection).collect::<Vec<_>>();
    let beside = || if triangles.len() < MANY { Vec::new() } else { twins(points.len(), triangles) };
    let (projections, twins) = rayon::join(projections, beside);
    let mut found: Vec<Violation> = (0..triangles.len() as u32)
        .filter(|&t| projections[t as usize].is_none())
        .map(|t| Violation { triangles: [t, t], kind: Kind::Degenerate, point: points[triangles[t as usize][0] as usize] })
        .take(limit)
        .collect();
    let live = Live::new(points, triangles, &projections, &twins);
    found.extend(live.meeting_by_boxes(points, limit).unwrap_or_else(|| live.meeting_by_hulls(points, limit)));
    found.sort_unstable_by_key(|v| v.triangles);
    found.truncate(limit);
    found
}

/// The triangles with area that may meet others wrongly.
struct Live(Vec<Face>);

impl Live {
    fn new(points: &[Vec3], triangles: &[[u32; 3]], projections: &[Option<Projection>], twins: &[u32]) -> Self {
        let Terrains { of, live } = if triangles.len() >= MANY {
            Terrains::new(&Mesh { points, triangles, projections, twins })
        } else {
            let has_area = (0..triangles.len() as u32).filter(|&t| projections[t as usize].is_some());
            Terrains { of: vec![NONE; triangles.len()], live: has_area.collect() }
        };
        let face = |&t: &u32| {
            let k = t as usize;
            Face { number: t, corners: triangles[k], projection: projections[k], terrain: of[k] }
        };
        Self(live.par_iter().with_min_len(SHARE).map(face).collect())
    }

    /// What is wrong between pairs whose boxes overlap; `None` if these are too many.
    fn meeting_by_boxes(&self, points: &[Vec3], limit: usize) -> Option<Vec<Violation>> {
        let around = |face: &Face| Aabb::around(face.corners.iter().map(|&v| &points[v as usize]));
        let mut tree = Bvh::new(self.0.par_iter().with_min_len(SHARE).map(around).collect());
        let faces = self.in_order(&tree.renumber());
        let most = PAIRS_PER_TRIANGLE * (faces.len() / TASKS + 1);
        let search = |task| {
            let (mut local, mut count) = (Vec::new(), 0);
            tree.overlapping_pairs(task, |s, t| {
                count += 1;
                local.extend(violation(points, &faces[s as usize], &faces[t as usize]));
                if count < most && local.len() < limit { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
            });
            (count < most).then_some(local)
        };
        let found: Option<Vec<Vec<Violation>>> = tree.pair_tasks(TASKS).into_par_iter().map(search).collect();
        Some(found?.into_iter().flatten().collect())
    }

    /// The same of pairs between whose hulls no plane is found.
    fn meeting_by_hulls(&self, points: &[Vec3], limit: usize) -> Vec<Violation> {
        let hulls = self.hulls(points);
        let faces = self.in_order(hulls.order());
        let search = |task| {
            let mut local = Vec::new();
            hulls.pairs(task, |s, t| {
                local.extend(violation(points, &faces[s as usize], &faces[t as usize]));
                if local.len() < limit { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
            });
            local
        };
        hulls.tasks(TASKS).into_par_iter().flat_map_iter(search).collect()
    }

    fn hulls(&self, points: &[Vec3]) -> Hulls {
        let mut degree = vec![0u32; points.len()];
        for &v in self.0.iter().flat_map(|f| &f.corners) {
            degree[v as usize] += 1;
        }
        let thing = |face: &Face| {
            let corners = from_hub(face.corners, points, &degree);
            Thing { corners: corners.map(|v| points[v as usize]), hub: corners[0], terrain: face.terrain }
        };
        Hulls::new(&self.0.par_iter().with_min_len(SHARE).map(thing).collect::<Vec<_>>())
    }

    /// The faces in the order of a tree: pairs then lie side by side in memory.
    fn in_order(&self, order: &[u32]) -> Vec<Face> {
        order.par_iter().with_min_len(SHARE).map(|&k| self.0[k as usize]).collect()
    }
}

/// Corners in an order that is alike for triangles that are alike: first the one where most triangles meet, if very many do,
/// else that of the sharpest angle.
fn from_hub(corners: [u32; 3], points: &[Vec3], degree: &[u32]) -> [u32; 3] {
    let hub = (1..3).fold(0, |h, k| if degree[corners[k] as usize] > degree[corners[h] as usize] { k } else { h });
    let [a, b, c] = corners.map(|v| points[v as usize]);
    let first = if degree[corners[hub] as usize] >= FAN {
        hub
    } else {
        let opposite = [c - b, a - c, b - a].map(|e| e.norm_squared());
        (1..3).fold(0, |h, k| if opposite[k] < opposite[h] { k } else { h })
    };
    [0, 1, 2].map(|k| corners[(first + k) % 3])
}

/// A triangle.
#[derive(Clone, Copy)]
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
