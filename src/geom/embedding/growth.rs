//! Growth of terrains, and whether their rims are simple.

use super::terrain::Mesh;
use super::twins::NONE;
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use crate::geom::bvh::Bvh;
use crate::geom::predicates::{Projection, orient2d};
use rayon::prelude::*;
use std::collections::VecDeque;
use std::ops::{ControlFlow, Range};

/// Least part of a triangle's normal along the axis, of its largest coordinate. Steeper triangles would be seen too, but rims
/// on steep places cross more easily.
const STEEPEST: f64 = 0.4;

/// Least cosine to the normal of the first triangle where a terrain has to be flat.
const FLAT: f64 = 0.95;

/// Disks of triangles that are counter-clockwise in a projection.
pub(super) struct Disks {
    members: Vec<u32>,
    all: Vec<Disk>,
}

/// One of them.
pub(super) struct Disk {
    range: Range<usize>,
    pub seen_along: Projection,
    /// Whether its rim is a simple polygon.
    pub is_simple: bool,
}

impl Disks {
    /// All disks with their members.
    pub fn all(&self) -> impl Iterator<Item = (&[u32], &Disk)> {
        self.all.iter().map(|d| (&self.members[d.range.clone()], d))
    }
}

/// Disks that grow.
pub(super) struct Growth<'a> {
    mesh: &'a Mesh<'a>,
    /// For every triangle the disk.
    of: Vec<u32>,
    /// For every vertex the last disk that has it.
    seen_by: Vec<u32>,
    /// Triangles of one disk after the other.
    members: Vec<u32>,
    count: u32,
}

impl<'a> Growth<'a> {
    pub fn new(mesh: &'a Mesh<'a>) -> Self {
        let (of, seen_by) = (vec![NONE; mesh.triangles.len()], vec![NONE; mesh.points.len()]);
        Self { mesh, of, seen_by, members: Vec::with_capacity(mesh.triangles.len()), count: 0 }
    }

    /// The disks of all triangles that have a projection: their numbers by triangle, and the disks.
    pub fn disks(mut self) -> (Vec<u32>, Disks) {
        let mut all = self.grow_from(0..self.mesh.triangles.len() as u32, None);
        // What covers itself may be a polygon and walls around it that are seen as well: each by itself does not.
        let folded: Vec<u32> =
            all.iter().filter(|d| !d.is_simple).flat_map(|d| &self.members[d.range.clone()]).copied().collect();
        folded.iter().for_each(|&t| self.of[t as usize] = NONE);
        all.retain(|d| d.is_simple);
        all.extend(self.grow_from(folded.into_iter(), Some(FLAT)));
        (self.of, Disks { members: self.members, all })
    }

    /// The disks around triangles that are in none yet; see [`Growth::grow`].
    fn grow_from(&mut self, seeds: impl Iterator<Item = u32>, likeness: Option<f64>) -> Vec<Disk> {
        let first = self.count;
        let mut disks = Vec::new();
        for t in seeds {
            if let Some(seen_along) = self.mesh.projections[t as usize]
                && self.of[t as usize] == NONE
            {
                disks.push(Disk { range: self.grow(t, seen_along, likeness), seen_along, is_simple: false });
            }
        }
        let points = self.mesh.points;
        disks.par_iter_mut().enumerate().with_min_len(16).for_each(|(k, disk)| {
            let rim = self.rim(first + k as u32, disk.range.clone());
            disk.is_simple = is_simple(&rim, |v| disk.seen_along.apply(&points[v as usize]));
        });
        disks
    }

    /// The disk around a triangle: neighbours are added while it stays one. With a likeness, only those whose normals have at
    /// least this cosine to that of the triangle.
    fn grow(&mut self, seed: u32, projection: Projection, likeness: Option<f64>) -> Range<usize> {
        let (begin, own) = (self.members.len(), self.count);
        let mut waiting = VecDeque::from([seed]);
        while let Some(t) = waiting.pop_front() {
            let fits = |all: &Self| {
                all.keeps_a_disk(t, own)
                    && all.mesh.is_seen(t, projection)
                    && likeness.is_none_or(|cosine| all.mesh.cosine(seed, t) >= cosine)
            };
            if self.of[t as usize] == NONE && (t == seed || fits(self)) {
                self.of[t as usize] = own;
                self.members.push(t);
                self.mesh.triangles[t as usize].iter().for_each(|v| self.seen_by[*v as usize] = own);
                let beyond = (0..3).filter_map(|k| self.mesh.beyond(t, k));
                waiting.extend(beyond.filter(|&n| self.of[n as usize] == NONE));
            }
        }
        self.count += 1;
        begin..self.members.len()
    }

    /// Whether a disk is one with a further triangle: it has two sides in common with it, or one side and not the corner
    /// opposite.
    fn keeps_a_disk(&self, t: u32, own: u32) -> bool {
        let is_common = |k: u32| self.mesh.beyond(t, k).is_some_and(|n| self.of[n as usize] == own);
        let is_known = |k: u32| self.seen_by[self.mesh.triangles[t as usize][k as usize] as usize] == own;
        match [0, 1, 2].map(is_common) {
            [true, false, false] => !is_known(2),
            [false, true, false] => !is_known(0),
            [false, false, true] => !is_known(1),
            sides => sides.iter().filter(|s| **s).count() == 2,
        }
    }

    /// The sides of a disk's triangles that are not between two of them.
    fn rim(&self, disk: u32, members: Range<usize>) -> Vec<[u32; 2]> {
        let sides = self.members[members].iter().flat_map(|&t| (0..3).map(move |k| (t, k)));
        let is_rim = |&(t, k): &(u32, u32)| self.mesh.beyond(t, k).is_none_or(|n| self.of[n as usize] != disk);
        let ends = |(t, k): (u32, u32)| [k, (k + 1) % 3].map(|k| self.mesh.triangles[t as usize][k as usize]);
        sides.filter(is_rim).map(ends).collect()
    }
}

impl Mesh<'_> {
    /// The triangle beyond a side.
    fn beyond(&self, t: u32, k: u32) -> Option<u32> {
        let twin = self.twins[(3 * t + k) as usize];
        (twin != NONE).then_some(twin / 3)
    }

    /// Whether a triangle is counter-clockwise in a projection, and not steep.
    fn is_seen(&self, t: u32, projection: Projection) -> bool {
        let [a, b, c] = self.triangles[t as usize].map(|v| &self.points[v as usize]);
        let normal = (b - a).cross(&(c - a));
        let axis = 3 - projection.u - projection.v;
        normal[axis as usize].abs() >= STEEPEST * normal.amax()
            && orient2d(projection.apply(a), projection.apply(b), projection.apply(c)) > 0
    }

    /// Of the angle between the normals of two triangles.
    fn cosine(&self, s: u32, t: u32) -> f64 {
        let [m, n] = [s, t].map(|t| {
            let [a, b, c] = self.triangles[t as usize].map(|v| &self.points[v as usize]);
            (b - a).cross(&(c - a))
        });
        m.dot(&n) / (m.norm() * n.norm())
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
