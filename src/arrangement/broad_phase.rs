//! Pairs of triangles of different leaves that meet.

use super::graph::Mesh;
use super::intersect::{Contact, intersect};
use super::rests::{Item, Level};
use crate::geom::aabb::Aabb;
use crate::geom::bvh::Bvh;
use crate::geom::hash::IndexMap;
use crate::geom::lists::Lists;
use rayon::prelude::*;
use std::ops::Range;

/// Triangles or pairs from which on the work is shared between threads: below, handing it out costs more than it saves.
pub(super) const PARALLEL_FROM: usize = 4096;
/// Candidate pairs that are gathered before they are looked at: enough to share between threads. Of needles that lie nearly in
/// one plane there may be a thousand candidates to a contact, which should not all be kept.
const BATCH: usize = 1 << 16;
/// Triangles of one facet from which on they go into a box tree.
const TREE_FROM: usize = 32;

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

/// Triangles that may meet others, with their boxes, facet by facet.
struct Facets {
    items: Vec<Item>,
    boxes: Vec<Aabb>,
    /// The triangles of every facet.
    of: Lists,
    /// The sheet of all items of every facet, if it is one.
    sheets: Vec<Option<u32>>,
    /// Box trees over the items of facets that have many.
    trees: IndexMap<u32, Bvh>,
}

impl Facets {
    fn new(mesh: &Mesh) -> Self {
        let input = mesh.input;
        let facet = |t: u32| input.cells[input.cell_of_triangle[t as usize] as usize].facet;
        let compared: Vec<u32> = mesh.near.iter().copied().filter(|&t| !mesh.fate_of(t).is_aside()).collect();
        let count = input.pairs.iter().flatten().copied().chain(compared.iter().map(|&t| facet(t))).max().map_or(0, |f| f + 1);
        let of = Lists::from_iter(count as usize, compared.iter().map(|&t| (facet(t), t)));
        let level = Level::new(mesh, &compared);
        let item = |&t: &u32| {
            let bounds = Aabb::around(mesh.triangles[t as usize].map(|v| &input.points[v as usize]));
            (level.item(mesh, t, &bounds), bounds)
        };
        let (items, boxes): (Vec<Item>, Vec<Aabb>) = of.items().par_iter().with_min_len(PARALLEL_FROM).map(item).unzip();
        let one_sheet = |f: u32| {
            let mut sheets = items[of.range(f)].iter().map(|item| item.sheet);
            sheets.next().filter(|&sheet| sheets.all(|other| other == sheet))
        };
        let sheets = (0..count).map(one_sheet).collect();
        let large: Vec<u32> = (0..count).filter(|&f| of.of(f).len() >= TREE_FROM).collect();
        let trees: Vec<Bvh> = large.par_iter().map(|&f| Bvh::new(boxes[of.range(f)].to_vec())).collect();
        Self { items, boxes, of, sheets, trees: large.into_iter().zip(trees).collect() }
    }

    fn of(&self, facet: u32) -> Range<usize> {
        self.of.range(facet)
    }

    /// Calls `visit` with the triangles of two facets whose boxes overlap, unless all are of one sheet or the one of the
    /// smaller facet rests on the sheet of the larger.
    fn visit(&self, [f, g]: [u32; 2], mut visit: impl FnMut(&Item, &Item)) {
        if self.sheets[f as usize].is_some() && self.sheets[f as usize] == self.sheets[g as usize] {
            return;
        }
        let (few, many) = if self.of(f).len() <= self.of(g).len() { (f, g) } else { (g, f) };
        let (tree, first, boxes) = (self.trees.get(&many), self.of(many).start, &self.boxes[self.of(many)]);
        // If those of the larger facet are of one sheet, what rests on one of them rests on all.
        let sheet = self.sheets[many as usize].map(|_| &self.items[first]);
        for i in self.of(few).filter(|&i| !sheet.is_some_and(|sheet| self.items[i].rests_on(sheet))) {
            let own = &self.boxes[i];
            let mut meet = |k: usize| visit(&self.items[i], &self.items[first + k]);
            match tree {
                Some(tree) => tree.overlapping(own, |k| meet(k as usize)),
                None => boxes.iter().enumerate().filter(|(_, its)| own.overlaps(its)).for_each(|(k, _)| meet(k)),
            }
        }
    }
}

/// Finds all contacts between triangles that have no leaf in common, since a leaf is valid in itself, nor a sheet, since
/// contact has made its cells conform.
pub fn contacts(mesh: &Mesh) -> Contacts {
    let (facets, pairs) = (Facets::new(mesh), &mesh.input.pairs);
    let mut all = if pairs.len() >= PARALLEL_FROM {
        let chunks = pairs.par_chunks(PARALLEL_FROM / 4);
        chunks.map(|chunk| between(mesh, &facets, chunk)).reduce(Contacts::default, Contacts::append)
    } else {
        between(mesh, &facets, pairs)
    };
    all.found.sort_unstable_by_key(|c| (c.0, c.1));
    all
}

/// Contacts between the triangles of pairs of facets, in any order.
fn between(mesh: &Mesh, facets: &Facets, pairs: &[[u32; 2]]) -> Contacts {
    let (mut found, mut near) = (Contacts::default(), Vec::new());
    for &pair in pairs {
        facets.visit(pair, |mine, yours| {
            // The first leaves of both are those of the facets, so they differ.
            let may_have_common_leaf = mine.is_common || yours.is_common;
            let is_settled = mine.sheet == yours.sheet
                || mine.rests(yours)
                || may_have_common_leaf && mesh.has_common_leaf(mine.triangle, yours.triangle);
            if !is_settled {
                let (t, u) = (mine.triangle, yours.triangle);
                near.push([t.min(u), t.max(u)]);
                if near.len() == BATCH {
                    found.add(mesh, &mut near);
                }
            }
        });
    }
    found.add(mesh, &mut near);
    found
}
