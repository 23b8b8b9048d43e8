//! Pairs of triangles of different leaves that meet.

use super::graph::Mesh;
use super::intersect::{Contact, intersect};
use super::rests::{Item, Level};
use crate::geom::aabb::Aabb;
use crate::geom::bvh::Bvh;
use rayon::prelude::*;
use std::ops::ControlFlow;

/// Triangles or pairs from which on the work is shared between threads: below, handing it out costs more than it saves.
const PARALLEL_FROM: usize = 4096;
/// Candidate pairs that are gathered before they are looked at: enough to share between threads. Of needles that lie nearly in one
/// plane there may be a thousand candidates to a contact, which should not all be kept.
const BATCH: usize = 1 << 16;

/// Pairs that meet, by first and then second triangle.
#[derive(Default)]
pub struct Contacts {
    /// First triangle, second triangle (larger number), where they meet.
    pub found: Vec<(u32, u32, Contact)>,
    /// Pairs that were looked at.
    pub candidates: u64,
}

impl Contacts {
    /// Looks at pairs, smaller number first, and forgets them.
    fn add(&mut self, mesh: &Mesh, pairs: &mut Vec<[u32; 2]>) {
        self.candidates += pairs.len() as u64;
        let meet = |&[t, u]: &[u32; 2]| intersect(&mesh.corners(t), &mesh.corners(u)).map(|c| (t, u, c));
        if pairs.len() < PARALLEL_FROM {
            self.found.extend(pairs.iter().filter_map(meet));
        } else {
            self.found.par_extend(pairs.par_iter().with_min_len(PARALLEL_FROM / 4).filter_map(meet));
        }
        pairs.clear();
    }

    fn append(mut self, mut other: Self) -> Self {
        self.found.append(&mut other.found);
        self.candidates += other.candidates;
        self
    }
}

/// The triangles of one leaf near another and their boxes.
type LeafTree = (Vec<Item>, Bvh);

/// Finds all contacts between triangles that have no leaf in common, since a leaf is valid in itself, nor a sheet, since contact
/// has made its cells conform.
pub fn contacts(mesh: &Mesh) -> Contacts {
    let is_parallel = mesh.near.len() >= PARALLEL_FROM;
    let trees = trees(mesh, is_parallel);
    let crowd = Bvh::new(trees.iter().map(|t| t.1.bounds()).collect());
    let mut near: Vec<[u32; 2]> = Vec::new();
    for task in crowd.pair_tasks(1) {
        crowd.overlapping_pairs(task, |a, b| {
            near.push([a.min(b), a.max(b)]);
            ControlFlow::Continue(())
        });
    }
    let join = |&[a, b]: &[u32; 2]| between(mesh, &trees[a as usize], &trees[b as usize]);
    let mut all = if is_parallel {
        near.par_iter().map(join).reduce(Contacts::default, Contacts::append)
    } else {
        near.iter().map(join).fold(Contacts::default(), Contacts::append)
    };
    all.found.sort_unstable_by_key(|c| (c.0, c.1));
    all
}

/// Every leaf has a tree of its own, so that the many neighbours within one leaf are never looked at.
fn trees(mesh: &Mesh, is_parallel: bool) -> Vec<LeafTree> {
    let points = &mesh.input.points;
    let compared: Vec<u32> = mesh.near.iter().copied().filter(|&t| !mesh.fate_of(t).is_aside()).collect();
    let level = Level::new(mesh, &compared);
    let mut leaves: Vec<(Vec<Item>, Vec<Aabb>)> = Vec::new();
    for t in compared {
        let leaf = mesh.leaf_of(t) as usize;
        if leaves.len() <= leaf {
            leaves.resize_with(leaf + 1, Default::default);
        }
        let bounds = Aabb::around(mesh.triangles[t as usize].map(|v| &points[v as usize]));
        leaves[leaf].0.push(level.item(mesh, t, &bounds));
        leaves[leaf].1.push(bounds);
    }
    if is_parallel {
        leaves.into_par_iter().map(|(triangles, boxes)| (triangles, Bvh::new(boxes))).collect()
    } else {
        leaves.into_iter().map(|(triangles, boxes)| (triangles, Bvh::new(boxes))).collect()
    }
}

/// Contacts between the triangles of two leaves, in any order.
fn between(mesh: &Mesh, (first, tree): &LeafTree, (second, other): &LeafTree) -> Contacts {
    let (mut found, mut pairs) = (Contacts::default(), Vec::new());
    tree.pairs(other, 0.0, |i, j| {
        let (mine, yours) = (&first[i as usize], &second[j as usize]);
        // The first leaf of each is that of its tree, so they differ.
        let may_have_common_leaf = mine.is_common || yours.is_common;
        let is_settled = mine.sheet == yours.sheet
            || mine.rests(yours)
            || may_have_common_leaf && mesh.has_common_leaf(mine.triangle, yours.triangle);
        if !is_settled {
            let (t, u) = (mine.triangle, yours.triangle);
            pairs.push([t.min(u), t.max(u)]);
            if pairs.len() == BATCH {
                found.add(mesh, &mut pairs);
            }
        }
        ControlFlow::Continue(())
    });
    found.add(mesh, &mut pairs);
    found
}
