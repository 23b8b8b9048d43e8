//! Vertices of different leaves within the tolerance become one point.

use super::body::Names;
use super::candidates::PARALLEL_FROM;
use crate::diag::{Diagnostic, Outcome, Tally, short};
use crate::geom::Vec3;
use crate::geom::hash::IndexMap;
use crate::ids::LeafId;
use crate::primitive::solid::{Solid, SolidVertex};
use rayon::prelude::*;

/// Edge of a grid cell in tolerances: most searches then see one cell, and a cell holds one point in all but tiny features.
const CELL: f64 = 64.0;
/// Offset of the grid in cells, so that round coordinates do not lie on its lines.
const OFFSET: [f64; 3] = [0.371, 0.433, 0.289];
/// Messages of one kind after which a stage stops telling more of the same.
pub(super) const MAX_MESSAGES: usize = 20;

/// An entry of the grid: where a vertex was, and the point that it became.
#[derive(Clone, Copy)]
pub(super) struct Entry {
    pub position: Vec3,
    /// `NONE` until it is entered.
    pub point: u32,
    tolerance: f64,
}

const NONE: u32 = u32::MAX;

/// Vertices to a bucket of cells, about.
const PER_BUCKET: usize = 4;

/// The one of `buckets`, a power of two, that a cell is in, by its leading bits.
fn bucket(cell: u64, buckets: usize) -> usize {
    (cell >> (u64::BITS - buckets.trailing_zeros())) as usize
}

/// Points by place: vertices sorted by their cells, which threads share, and a table of what comes later, which is little.
#[derive(Default)]
pub(super) struct PointGrid {
    cell: f64,
    /// All vertices, and behind them what came later.
    entries: Vec<Entry>,
    /// Cell and number of each vertex, ascending; cells are told apart by a hash, distances decide.
    vertices: Vec<(u64, u32)>,
    /// For every value of the leading bits of a cell the first of its vertices, and the number of all: a look-up takes one step.
    starts: Vec<u32>,
    /// Last later entry of each cell.
    heads: IndexMap<u64, u32>,
    /// For each later entry the one before it in its cell.
    previous: Vec<u32>,
}

impl PointGrid {
    /// A grid for searches up to `reach`, with all vertices, none of which is entered. O(n log n).
    fn new(solids: &[Solid], tolerances: &[f64], reach: f64) -> Self {
        let of_leaf = |(solid, &tolerance): (&Solid, &f64)| {
            let entry = move |v: &SolidVertex| Entry { position: v.point, point: NONE, tolerance };
            solid.vertices.iter().map(entry).collect::<Vec<_>>()
        };
        let entries: Vec<Entry> = solids.iter().zip(tolerances).flat_map(of_leaf).collect();
        let mut grid = Self { cell: CELL * reach, entries, ..Self::default() };
        let keyed = |(k, entry): (usize, &Entry)| (grid.key(grid.index(&entry.position, 0.0)), k as u32);
        let mut vertices: Vec<(u64, u32)> =
            grid.entries.par_iter().with_min_len(PARALLEL_FROM).enumerate().map(keyed).collect();
        vertices.par_sort_unstable();
        let buckets = (vertices.len() / PER_BUCKET).next_power_of_two().max(2);
        grid.starts = vec![0; buckets + 1];
        vertices.iter().for_each(|v| grid.starts[bucket(v.0, buckets) + 1] += 1);
        (0..buckets).for_each(|k| grid.starts[k + 1] += grid.starts[k]);
        grid.vertices = vertices;
        grid
    }
    /// For every vertex whether it is the only one in its cell.
    fn singles(&self) -> Vec<bool> {
        let mut is_single = vec![false; self.entries.len()];
        for cell in self.vertices.chunk_by(|a, b| a.0 == b.0) {
            is_single[cell[0].1 as usize] = cell.len() == 1;
        }
        is_single
    }
    /// Whether all that lies within `radius` of a place lies in one cell.
    fn is_in_one_cell(&self, p: &Vec3, radius: f64) -> bool {
        self.index(p, -radius) == self.index(p, radius)
    }
    fn key(&self, index: [i64; 3]) -> u64 {
        index.iter().fold(0u64, |h, &i| (h.rotate_left(21) ^ i as u64).wrapping_mul(0xD6E8_FEB8_6659_FD93))
    }
    fn index(&self, p: &Vec3, shift: f64) -> [i64; 3] {
        [0, 1, 2].map(|k| ((p[k] + shift) / self.cell + OFFSET[k]).floor() as i64)
    }
    /// Adds a place of a point.
    pub fn add(&mut self, position: Vec3, point: u32, tolerance: f64) {
        let head = self.heads.entry(self.key(self.index(&position, 0.0))).or_insert(NONE);
        self.previous.push(*head);
        *head = self.entries.len() as u32;
        self.entries.push(Entry { position, point, tolerance });
    }
    /// Calls `visit` with all entries that may lie within `radius`, and the distance.
    pub fn near(&self, p: &Vec3, radius: f64, mut visit: impl FnMut(&Entry, f64)) {
        let (lo, hi) = (self.index(p, -radius), self.index(p, radius));
        for x in lo[0]..=hi[0] {
            for y in lo[1]..=hi[1] {
                for z in lo[2]..=hi[2] {
                    self.in_cell(self.key([x, y, z]), |entry| {
                        let distance = (entry.position - p).norm();
                        if distance <= radius {
                            visit(entry, distance);
                        }
                    });
                }
            }
        }
    }
    /// Calls `visit` with the entries of a cell, the last ones first.
    fn in_cell(&self, cell: u64, mut visit: impl FnMut(&Entry)) {
        let mut k = self.heads.get(&cell).copied().unwrap_or(NONE);
        while let Some(entry) = self.entries.get(k as usize) {
            visit(entry);
            k = self.previous[k as usize - self.vertices.len()];
        }
        let Some(buckets) = self.starts.len().checked_sub(1) else { return };
        let k = bucket(cell, buckets);
        let near = &self.vertices[self.starts[k] as usize..self.starts[k + 1] as usize];
        let vertices = near.iter().rev().skip_while(|v| v.0 > cell).take_while(|v| v.0 == cell);
        vertices.map(|v| &self.entries[v.1 as usize]).filter(|entry| entry.point != NONE).for_each(visit);
    }
}

/// Points of all leaves.
pub(super) struct Welded {
    pub points: Vec<Vec3>,
    pub point_of_vertex: Vec<u32>,
    pub grid: PointGrid,
}

/// Welds: the earlier vertex in scene order represents. Errors: two vertices of one leaf within its tolerance, and chains of
/// vertices each within the tolerance of the next but not of the one that represents them.
pub(super) fn weld(solids: &[Solid], tolerances: &[f64], names: Names) -> Outcome<Welded> {
    let count = solids.iter().map(|s| s.vertices.len()).sum();
    let reach = tolerances.iter().fold(f64::MIN_POSITIVE, |m, &t| m.max(t));
    let mut grid = PointGrid::new(solids, tolerances, reach);
    let is_single = grid.singles();
    let mut points: Vec<Vec3> = Vec::with_capacity(count);
    let mut point_of_vertex = Vec::with_capacity(count);
    // Last leaf with a vertex at each point: leaves come in order, so it tells whether this leaf has one already.
    let mut last_leaf: Vec<u32> = Vec::with_capacity(count);
    let mut errors = Tally::default();
    for (leaf, solid) in solids.iter().enumerate() {
        for vertex in &solid.vertices {
            let p = vertex.point;
            let mut found: Option<u32> = None;
            let mut is_chain = false;
            let vertex = point_of_vertex.len();
            // Most are: whatever comes near searches its cell.
            let is_lone = is_single[vertex] && grid.is_in_one_cell(&p, reach);
            let mut compare = |entry: &Entry, distance: f64| {
                if distance <= entry.tolerance.max(tolerances[leaf]) {
                    is_chain |= found.is_some_and(|f| f != entry.point);
                    is_chain |= (points[entry.point as usize] - p).norm() > entry.tolerance.max(tolerances[leaf]);
                    found = Some(found.map_or(entry.point, |f| f.min(entry.point)));
                }
            };
            if !is_lone {
                grid.near(&p, reach, &mut compare);
            }
            let point = found.unwrap_or(points.len() as u32);
            if found.is_none() {
                points.push(p);
                last_leaf.push(leaf as u32);
            } else if last_leaf[point as usize] == leaf as u32 {
                errors.add([leaf, leaf], || small_feature(leaf, &p, &points[point as usize], tolerances[leaf], names));
            } else if is_chain {
                let other = last_leaf[point as usize] as usize;
                errors.add([leaf, other], || chain([leaf, other], &[p, points[point as usize]], names));
            } else {
                last_leaf[point as usize] = leaf as u32;
            }
            if found.is_none() || points[point as usize] != p {
                grid.entries[vertex].point = point;
            }
            point_of_vertex.push(point);
            if errors.len() >= MAX_MESSAGES {
                return Err(errors.finish());
            }
        }
    }
    if errors.is_empty() { Ok(Welded { points, point_of_vertex, grid }) } else { Err(errors.finish()) }
}

fn small_feature(leaf: usize, p: &Vec3, q: &Vec3, tolerance: f64, names: Names) -> Diagnostic {
    let name = names(LeafId(leaf as u32));
    let distance = (p - q).norm();
    Diagnostic::error(
        "feature-below-tolerance",
        format!("two vertices of {name} are {} apart, less than the tolerance {}", short(distance), short(tolerance)),
    )
    .at(name.span)
    .near(*q)
    .near(*p)
    .hint("remove the feature or choose a smaller `tolerance`")
}

/// Contacts that hang together but reach further than the tolerance.
pub(super) fn chain(leaves: [usize; 2], places: &[Vec3], names: Names) -> Diagnostic {
    let [a, b] = leaves.map(|l| names(LeafId(l as u32)));
    let message = format!("{a} and {b} belong to a chain of contacts that is longer than the tolerance");
    places
        .iter()
        .fold(Diagnostic::error("contact-chain", message).at(a.span), |d, p| d.near(*p))
        .hint("move the parts so that they touch or stay clearly apart, or choose another `tolerance`")
}
