//! Vertices of different leaves within the tolerance become one point.

use super::body::Names;
use crate::diag::{Diagnostic, Outcome, Tally, short};
use crate::geom::Vec3;
use crate::geom::hash::IndexMap;
use crate::ids::LeafId;
use crate::primitive::solid::Solid;

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
    pub point: u32,
    tolerance: f64,
}

/// Points by place.
#[derive(Default)]
pub(super) struct PointGrid {
    cell: f64,
    /// Last entry of each cell; cells are told apart by a hash, distances decide.
    heads: IndexMap<u64, u32>,
    entries: Vec<Entry>,
    previous: Vec<u32>,
}

impl PointGrid {
    /// A grid for searches up to `reach`.
    pub fn new(reach: f64, capacity: usize) -> Self {
        let heads = IndexMap::with_capacity_and_hasher(capacity, Default::default());
        Self { cell: CELL * reach, heads, entries: Vec::with_capacity(capacity), previous: Vec::with_capacity(capacity) }
    }
    fn key(&self, index: [i64; 3]) -> u64 {
        index.iter().fold(0u64, |h, &i| (h.rotate_left(21) ^ i as u64).wrapping_mul(0xD6E8_FEB8_6659_FD93))
    }
    fn index(&self, p: &Vec3, shift: f64) -> [i64; 3] {
        [0, 1, 2].map(|k| ((p[k] + shift) / self.cell + OFFSET[k]).floor() as i64)
    }
    /// Adds a place of a point.
    pub fn add(&mut self, position: Vec3, point: u32, tolerance: f64) {
        let head = self.heads.entry(self.key(self.index(&position, 0.0))).or_insert(u32::MAX);
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
                    let mut k = self.heads.get(&self.key([x, y, z])).copied().unwrap_or(u32::MAX);
                    while let Some(entry) = self.entries.get(k as usize) {
                        let distance = (entry.position - p).norm();
                        if distance <= radius {
                            visit(entry, distance);
                        }
                        k = self.previous[k as usize];
                    }
                }
            }
        }
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
    let mut grid = PointGrid::new(reach, count);
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
            grid.near(&p, reach, |entry, distance| {
                if distance <= entry.tolerance.max(tolerances[leaf]) {
                    is_chain |= found.is_some_and(|f| f != entry.point);
                    is_chain |= (points[entry.point as usize] - p).norm() > entry.tolerance.max(tolerances[leaf]);
                    found = Some(found.map_or(entry.point, |f| f.min(entry.point)));
                }
            });
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
                grid.add(p, point, tolerances[leaf]);
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
