//! Terrains: disks of triangles that, seen along a coordinate axis, lie beside each other.
//!
//! If all triangles of a disk are counter-clockwise in a projection, every place there is covered as often as the rim of the
//! disk winds around it. If the rim is a simple polygon, that is once inside and never outside. Two triangles of such a disk
//! then have nothing in common but whole vertices and edges: around an inner vertex or edge its own triangles cover all, so no
//! other triangle comes near; and what meets at the rim shares the vertex there, since the rim meets itself nowhere else.
//!
//! So most pairs of neighbours, which are most of the pairs that an exact test has to look at, need not be tested: it takes one
//! sign for each triangle and a test of the rims. What is left are triangles near the borders of terrains. A surface of many
//! folds has many small terrains, and less is gained.

use super::twins::{NONE, twins};
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use crate::geom::bvh::Bvh;
use crate::geom::lists::Lists;
use crate::geom::predicates::{Projection, orient2d};
use rayon::prelude::*;
use std::collections::VecDeque;
use std::ops::ControlFlow;

/// Least part of a triangle's normal along the axis, of its largest coordinate. Steeper triangles would be seen too, but rims
/// on steep places cross more easily.
const STEEPEST: f64 = 0.4;

/// Least cosine to the normal of the first triangle where a terrain has to be flat.
const FLAT: f64 = 0.95;

/// Triangles whose boxes are compared as one. (16 and 64 took a tenth longer on a sphere of a million.)
const CHUNK: usize = 32;

/// Which triangles need not be tested against which.
pub(super) struct Terrains {
    /// For every triangle the proven terrain that it belongs to, or [`NONE`].
    pub of: Vec<u32>,
    /// Triangles near others than those of their own terrain, in groups of neighbours.
    pub live: Vec<u32>,
}

impl Terrains {
    /// The terrains of all triangles that have a projection in which they are counter-clockwise. O(n log n).
    pub fn new(points: &[Vec3], triangles: &[[u32; 3]], projections: &[Option<Projection>]) -> Self {
        let twins = twins(points.len(), triangles);
        let mut all = Growth {
            points,
            triangles,
            twins,
            of: vec![NONE; triangles.len()],
            seen_by: vec![NONE; points.len()],
            members: Vec::with_capacity(triangles.len()),
            ends: Vec::new(),
        };
        let mut terrains = all.grow_from(0..triangles.len() as u32, projections, None);
        // What covers itself may be a polygon and walls around it that are seen as well: each by itself does not.
        let folded: Vec<u32> = (0..terrains.len() as u32).filter(|&k| !terrains[k as usize].is_simple).collect();
        let members: Vec<u32> = folded.iter().flat_map(|&k| all.members(k)).copied().collect();
        members.iter().for_each(|&t| all.of[t as usize] = NONE);
        folded.iter().for_each(|&k| terrains[k as usize].is_replaced = true);
        terrains.extend(all.grow_from(members.into_iter(), projections, Some(FLAT)));
        let live = all.live(&terrains);
        let mut of = all.of;
        of.iter_mut().filter(|k| **k != NONE && !terrains[**k as usize].is_simple).for_each(|k| *k = NONE);
        Self { of, live }
    }
}

/// What is known of a terrain.
struct Terrain {
    seen_along: Projection,
    /// Whether its rim is a simple polygon.
    is_simple: bool,
    /// Whether its members became those of others.
    is_replaced: bool,
}

struct Growth<'a> {
    points: &'a [Vec3],
    triangles: &'a [[u32; 3]],
    twins: Vec<u32>,
    /// For every triangle its terrain.
    of: Vec<u32>,
    /// For every vertex the last terrain that has it.
    seen_by: Vec<u32>,
    /// Triangles of one terrain after the other, and where each ends.
    members: Vec<u32>,
    ends: Vec<u32>,
}

impl Growth<'_> {
    /// The terrains around triangles that have none yet; see [`Growth::grow`].
    fn grow_from(
        &mut self,
        seeds: impl Iterator<Item = u32>,
        projections: &[Option<Projection>],
        likeness: Option<f64>,
    ) -> Vec<Terrain> {
        let (first, mut seen_along) = (self.ends.len() as u32, Vec::new());
        for t in seeds {
            if let (Some(projection), NONE) = (projections[t as usize], self.of[t as usize]) {
                self.grow(t, projection, likeness);
                seen_along.push(projection);
            }
        }
        let points = self.points;
        let terrain = |(k, &seen_along): (usize, &Projection)| Terrain {
            seen_along,
            is_simple: is_simple(&self.rim(first + k as u32), |v| seen_along.apply(&points[v as usize])),
            is_replaced: false,
        };
        seen_along.par_iter().enumerate().map(terrain).collect()
    }

    /// The terrain around a triangle: neighbours are added while it stays a disk. With a likeness, only those whose normals
    /// have at least this cosine to that of the triangle.
    fn grow(&mut self, seed: u32, projection: Projection, likeness: Option<f64>) {
        let is_like = |all: &Self, t: u32| likeness.is_none_or(|cosine| all.cosine(seed, t) >= cosine);
        let own = self.ends.len() as u32;
        let mut waiting = VecDeque::from([seed]);
        let begin = self.members.len();
        while let Some(t) = waiting.pop_front() {
            let is_first = self.members.len() == begin;
            if self.of[t as usize] == NONE
                && (is_first || self.keeps_a_disk(t, own) && self.is_seen(t, projection) && is_like(self, t))
            {
                self.of[t as usize] = own;
                self.members.push(t);
                self.triangles[t as usize].iter().for_each(|v| self.seen_by[*v as usize] = own);
                let beyond = (0..3).filter_map(|k| self.beyond(t, k));
                waiting.extend(beyond.filter(|&n| self.of[n as usize] == NONE));
            }
        }
        self.ends.push(self.members.len() as u32);
    }

    /// The triangle beyond a side.
    fn beyond(&self, t: u32, k: u32) -> Option<u32> {
        let twin = self.twins[(3 * t + k) as usize];
        (twin != NONE).then_some(twin / 3)
    }

    /// Whether a terrain, a disk, is one with a further triangle: it has two sides in common with it, or one side and not the
    /// corner opposite.
    fn keeps_a_disk(&self, t: u32, own: u32) -> bool {
        let is_common = |k: u32| self.beyond(t, k).is_some_and(|n| self.of[n as usize] == own);
        let is_known = |k: u32| self.seen_by[self.triangles[t as usize][k as usize] as usize] == own;
        match [0, 1, 2].map(is_common) {
            [true, false, false] => !is_known(2),
            [false, true, false] => !is_known(0),
            [false, false, true] => !is_known(1),
            sides => sides.iter().filter(|s| **s).count() == 2,
        }
    }

    /// Whether a triangle is counter-clockwise in a projection, and not steep.
    fn is_seen(&self, t: u32, projection: Projection) -> bool {
        let [a, b, c] = self.triangles[t as usize].map(|v| &self.points[v as usize]);
        let normal = self.normal(t);
        let axis = 3 - projection.u - projection.v;
        normal[axis as usize].abs() >= STEEPEST * normal.amax()
            && orient2d(projection.apply(a), projection.apply(b), projection.apply(c)) > 0
    }

    fn normal(&self, t: u32) -> Vec3 {
        let [a, b, c] = self.triangles[t as usize].map(|v| &self.points[v as usize]);
        (b - a).cross(&(c - a))
    }

    /// Of the angle between the normals of two triangles.
    fn cosine(&self, s: u32, t: u32) -> f64 {
        let [m, n] = [s, t].map(|t| self.normal(t));
        m.dot(&n) / (m.norm() * n.norm())
    }

    fn members(&self, terrain: u32) -> &[u32] {
        let begin = if terrain == 0 { 0 } else { self.ends[terrain as usize - 1] };
        &self.members[begin as usize..self.ends[terrain as usize] as usize]
    }

    /// The sides of a terrain's triangles that are not between two of them.
    fn rim(&self, terrain: u32) -> Vec<[u32; 2]> {
        let sides = self.members(terrain).iter().flat_map(|&t| (0..3).map(move |k| (t, k)));
        let is_rim = |&(t, k): &(u32, u32)| self.beyond(t, k).is_none_or(|n| self.of[n as usize] != terrain);
        let ends = |(t, k): (u32, u32)| [k, (k + 1) % 3].map(|k| self.triangles[t as usize][k as usize]);
        sides.filter(is_rim).map(ends).collect()
    }

    /// All triangles near others than those of their own terrain, if that is simple.
    fn live(&self, terrains: &[Terrain]) -> Vec<u32> {
        // Members in an order of neighbours, and where each chunk ends.
        let (mut members, mut ends, mut boxes) = (Vec::with_capacity(self.members.len()), vec![0], Vec::new());
        for (number, terrain) in (0..).zip(terrains).filter(|t| !t.1.is_replaced) {
            let chunks = self.chunks(number, terrain.seen_along);
            for chunk in (0..chunks.count() as u32).map(|k| chunks.of(k)).filter(|c| !c.is_empty()) {
                let corners = chunk.iter().flat_map(|t| &self.triangles[*t as usize]);
                boxes.push(Aabb::around(corners.map(|v| &self.points[*v as usize])));
                members.extend_from_slice(chunk);
                ends.push(members.len());
            }
        }
        let terrain = |chunk: u32| self.of[members[ends[chunk as usize]] as usize];
        let mut is_live: Vec<bool> = (0..boxes.len() as u32).map(|k| !terrains[terrain(k) as usize].is_simple).collect();
        let tree = Bvh::new(boxes);
        for task in tree.pair_tasks(1) {
            tree.overlapping_pairs(task, |a, b| {
                if terrain(a) != terrain(b) {
                    (is_live[a as usize], is_live[b as usize]) = (true, true);
                }
                ControlFlow::Continue(())
            });
        }
        let live = ends.windows(2).zip(is_live).filter(|chunk| chunk.1);
        live.flat_map(|(ends, _)| &members[ends[0]..ends[1]]).copied().collect()
    }

    /// The members of a terrain by squares of a grid over its projection.
    fn chunks(&self, terrain: u32, projection: Projection) -> Lists {
        let members = self.members(terrain);
        let place = |t: u32| projection.apply(&self.points[self.triangles[t as usize][0] as usize]);
        let (mut lo, mut hi) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for p in members.iter().map(|&t| place(t)) {
            (lo, hi) = ([lo[0].min(p[0]), lo[1].min(p[1])], [hi[0].max(p[0]), hi[1].max(p[1])]);
        }
        let count = ((members.len() / CHUNK) as f64).sqrt().ceil().max(1.0);
        // Without width all are in one column: the smaller of a number and of none is the number.
        let step = |x: f64, k: usize| ((x - lo[k]) / (hi[k] - lo[k]) * count).min(count - 1.0) as u32;
        let square = |t: u32| {
            let [x, y] = place(t);
            step(x, 0) * count as u32 + step(y, 1)
        };
        let squares: Vec<(u32, u32)> = members.iter().map(|&t| (square(t), t)).collect();
        Lists::new((count * count) as usize, &squares)
    }
}

/// Whether the edges of a closed walk meet in common ends only.
fn is_simple(rim: &[[u32; 2]], flat: impl Fn(u32) -> [f64; 2]) -> bool {
    let corner = |v: u32| {
        let [x, y] = flat(v);
        Vec3::new(x, y, 0.0)
    };
    let boxes = rim.iter().map(|e| Aabb::around(&e.map(corner))).collect();
    let tree = Bvh::new(boxes);
    let mut is_simple = true;
    for task in tree.pair_tasks(1) {
        tree.overlapping_pairs(task, |e, f| {
            is_simple &= is_apart(rim[e as usize], rim[f as usize], &flat);
            if is_simple { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        });
    }
    is_simple
}

/// Whether two edges of a closed walk certainly have nothing in common but an end of one that the other begins with.
fn is_apart(e: [u32; 2], f: [u32; 2], flat: impl Fn(u32) -> [f64; 2]) -> bool {
    let ([a, b], [c, d]) = (e, f);
    let turn = |a: u32, b: u32, c: u32| orient2d(flat(a), flat(b), flat(c));
    match (b == c, a == d) {
        (true, true) => false,
        (true, false) => is_onward([a, b, d], flat),
        (false, true) => is_onward([c, a, b], flat),
        (false, false) => turn(a, b, c) * turn(a, b, d) > 0 || turn(c, d, a) * turn(c, d, b) > 0,
    }
}

/// Whether a walk turns at its middle corner or goes straight on there, but not back.
fn is_onward(walk: [u32; 3], flat: impl Fn(u32) -> [f64; 2]) -> bool {
    let [a, b, c] = walk.map(flat);
    let is_between = |k: usize| (a[k] < b[k] && b[k] < c[k]) || (a[k] > b[k] && b[k] > c[k]);
    orient2d(a, b, c) != 0 || is_between(0) || is_between(1)
}
