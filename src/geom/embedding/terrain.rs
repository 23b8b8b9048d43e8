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
//!
//! Terrains grow in eight blocks of space, at once where there are threads.

use super::growth::{Disks, Growth};
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

/// Triangles from which on terrains grow in blocks of space: their borders cost more than threads gain on fewer.
const BLOCKS_FROM: usize = 1 << 15;

/// Pieces that searches for pairs of chunks are cut into.
const TASKS: usize = 64;

/// Triangles and their neighbours.
pub(super) struct Mesh<'a> {
    pub points: &'a [Vec3],
    pub triangles: &'a [[u32; 3]],
    /// In which each is counter-clockwise, if it has area.
    pub projections: &'a [Option<Projection>],
    /// For every side the one beyond; see [`super::twins`].
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
        let blocks = Blocks::new(mesh);
        let grow = |block: u8| Growth::new(mesh, blocks.lists.of(block.into()), |t| blocks.slot(block, t)).disks();
        let grown: Vec<Disks> = (0..blocks.lists.count() as u8).into_par_iter().map(grow).collect();
        let (mut of, mut count) = (vec![NONE; mesh.triangles.len()], 0);
        for disks in &grown {
            for (members, disk) in disks.all() {
                if disk.is_simple {
                    members.iter().for_each(|&t| of[t as usize] = count);
                }
                count += 1;
            }
        }
        let live = live(mesh, &grown);
        Self { of, live }
    }
}

/// Triangles by the octant of the model that they lie in.
struct Blocks {
    lists: Lists,
    /// For every triangle its block and its place there; empty if there is one block only.
    slots: Vec<(u8, u32)>,
}

impl Blocks {
    fn new(mesh: &Mesh) -> Self {
        let all = 0..mesh.triangles.len() as u32;
        if mesh.triangles.len() < BLOCKS_FROM {
            return Self { lists: Lists::from_iter(1, all.map(|t| (0, t))), slots: Vec::new() };
        }
        let middle = Aabb::around(mesh.points).center();
        let octant = |corners: &[u32; 3]| {
            let p = &mesh.points[corners[0] as usize];
            (0..3).fold(0, |o, k| 2 * o + u8::from(p[k] > middle[k]))
        };
        let octants: Vec<u8> = mesh.triangles.par_iter().with_min_len(1024).map(octant).collect();
        let lists = Lists::from_iter(8, octants.iter().zip(all).map(|(&o, t)| (o.into(), t)));
        let mut next = [0; 8];
        let slot = |o: u8| {
            let place = next[usize::from(o)];
            next[usize::from(o)] += 1;
            (o, place)
        };
        let slots = octants.into_iter().map(slot).collect();
        Self { lists, slots }
    }

    /// The place of a triangle in a block, if it is there.
    fn slot(&self, block: u8, t: u32) -> Option<usize> {
        if self.slots.is_empty() {
            return Some(t as usize);
        }
        let (own, place) = self.slots[t as usize];
        (own == block).then_some(place as usize)
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
fn live(mesh: &Mesh, grown: &[Disks]) -> Vec<u32> {
    let firsts = grown.iter().scan(0, |next, disks| Some(std::mem::replace(next, *next + disks.all().count() as u32)));
    let parts: Vec<_> = grown.iter().zip(firsts).collect();
    let parts: Vec<(Vec<u32>, Vec<Chunk>)> = parts.into_par_iter().map(|(disks, first)| chunks(mesh, disks, first)).collect();
    let chunks: Vec<&Chunk> = parts.iter().flat_map(|p| &p.1).collect();
    let is_live: Vec<AtomicBool> = chunks.iter().map(|c| AtomicBool::new(!c.is_simple)).collect();
    let tree = Bvh::new(chunks.iter().map(|c| c.bounds).collect());
    tree.pair_tasks(TASKS).into_par_iter().for_each(|task| {
        tree.overlapping_pairs(task, |a, b| {
            if chunks[a as usize].terrain != chunks[b as usize].terrain {
                [a, b].map(|c| is_live[c as usize].store(true, Ordering::Relaxed));
            }
            ControlFlow::Continue(())
        });
    });
    let all = parts.iter().flat_map(|(members, chunks)| chunks.iter().map(|c| &members[c.members.clone()]));
    all.zip(is_live).filter(|c| c.1.load(Ordering::Relaxed)).flat_map(|c| c.0).copied().collect()
}

/// The members of disks chunk by chunk; `first` is the number of the first disk's terrain.
fn chunks(mesh: &Mesh, disks: &Disks, first: u32) -> (Vec<u32>, Vec<Chunk>) {
    let (mut members, mut chunks) = (Vec::new(), Vec::new());
    for ((own, disk), terrain) in disks.all().zip(first..) {
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
