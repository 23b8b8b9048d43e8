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

use super::growth::{Disk, Disks, Growth};
use super::twins::NONE;
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use crate::geom::bvh::Bvh;
use crate::geom::lists::Lists;
use crate::geom::predicates::Projection;
use rayon::prelude::*;
use std::ops::{ControlFlow, Range};
use std::sync::atomic::{AtomicBool, Ordering};

/// Triangles whose boxes are compared as one. (16 and 64 took a tenth longer on a sphere of a million.)
const CHUNK: usize = 32;

/// Terrains that are divided into chunks together.
const DISKS: usize = 64;

/// Pieces that searches for pairs of chunks are cut into.
const TASKS: usize = 64;

/// Triangles and their neighbours.
pub(super) struct Mesh<'a> {
    pub points: &'a [Vec3],
    pub triangles: &'a [[u32; 3]],
    /// In which each is counter-clockwise, if it has area.
    pub projections: &'a [Option<Projection>],
    /// For every side the one beyond; see [`super::twins()`].
    pub twins: &'a [u32],
}

/// Which triangles need not be tested against which.
pub(super) struct Terrains {
    /// For every triangle the proven terrain that it belongs to, or [`NONE`].
    pub of: Vec<u32>,
    /// Triangles near others than those of their own terrain, in groups of neighbours.
    pub live: Vec<u32>,
}

impl Terrains {
    /// The terrains of all triangles that have a projection in which they are counter-clockwise. O(n log n).
    pub fn new(mesh: &Mesh) -> Self {
        let (mut of, disks) = Growth::new(mesh).disks();
        let live = live(mesh, &disks);
        for (members, _) in disks.all().filter(|d| !d.1.is_simple) {
            members.iter().for_each(|&t| of[t as usize] = NONE);
        }
        Self { of, live }
    }
}

/// Some neighbours of one terrain.
struct Chunk {
    members: Range<usize>,
    bounds: Aabb,
    terrain: u32,
    is_simple: bool,
}

/// All triangles near others than those of their own terrain, if that is simple.
fn live(mesh: &Mesh, disks: &Disks) -> Vec<u32> {
    let (members, chunks) = chunks(mesh, disks);
    let is_live: Vec<AtomicBool> = chunks.iter().map(|c| AtomicBool::new(!c.is_simple)).collect();
    let tree = Bvh::new(chunks.iter().map(|c| c.bounds).collect());
    tree.pair_tasks(TASKS).into_par_iter().for_each(|task| {
        tree.overlapping_pairs(task, |a, b| {
            if chunks[a as usize].terrain != chunks[b as usize].terrain {
                [a, b].into_iter().for_each(|c| is_live[c as usize].store(true, Ordering::Relaxed));
            }
            ControlFlow::Continue(())
        });
    });
    let near = chunks.iter().zip(is_live).filter(|c| c.1.load(Ordering::Relaxed));
    near.flat_map(|(chunk, _)| &members[chunk.members.clone()]).copied().collect()
}

/// The members of disks chunk by chunk, and the chunks.
fn chunks(mesh: &Mesh, disks: &Disks) -> (Vec<u32>, Vec<Chunk>) {
    let all: Vec<_> = disks.all().zip(0..).collect();
    let few = |some: &[((&[u32], &Disk), u32)]| {
        let (mut members, mut chunks) = (Vec::new(), Vec::new());
        for &((own, disk), terrain) in some {
            let squares = squares(mesh, own, disk.seen_along);
            for square in (0..squares.count() as u32).map(|k| squares.of(k)).filter(|s| !s.is_empty()) {
                let corners = square.iter().flat_map(|t| &mesh.triangles[*t as usize]);
                let bounds = Aabb::around(corners.map(|v| &mesh.points[*v as usize]));
                let range = members.len()..members.len() + square.len();
                chunks.push(Chunk { members: range, bounds, terrain, is_simple: disk.is_simple });
                members.extend_from_slice(square);
            }
        }
        (members, chunks)
    };
    let parts: Vec<(Vec<u32>, Vec<Chunk>)> = all.par_chunks(DISKS).map(few).collect();
    let (mut members, mut chunks) = (Vec::with_capacity(mesh.triangles.len()), Vec::new());
    for (some, own) in parts {
        let moved =
            |chunk: Chunk| Chunk { members: members.len() + chunk.members.start..members.len() + chunk.members.end, ..chunk };
        chunks.extend(own.into_iter().map(moved));
        members.extend(some);
    }
    (members, chunks)
}

/// The members of a terrain by squares of a grid over its projection.
fn squares(mesh: &Mesh, members: &[u32], projection: Projection) -> Lists {
    let place = |t: u32| projection.apply(&mesh.points[mesh.triangles[t as usize][0] as usize]);
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
