//! Triangles that touch a sheet in a coordinate plane only where the sheet has vertices and edges.
//!
//! Contact leaves the rim of a wall that stands on a cap as edges of both, and such caps lie exactly in a coordinate plane.
//! Then no triangle of the wall meets one of the cap anywhere else, and none of their pairs need be looked at: of needles there
//! may be a thousand times as many pairs as contacts.

use super::broad_phase::PARALLEL_FROM;
use super::graph::Mesh;
use crate::geom::aabb::Aabb;
use crate::geom::hash::IndexMap;
use crate::geom::parallel::both;

const NONE: u32 = u32::MAX;

/// A triangle of a box tree.
#[derive(Clone, Copy, Debug)]
pub struct Item {
    /// Number of the triangle.
    pub triangle: u32,
    /// Its sheet.
    pub sheet: u32,
    /// Whether it belongs to several leaves.
    pub is_common: bool,
    /// The axis across which all of the sheet is level; 3 if there is none.
    level: u8,
    /// For the lower and upper side of its box along each axis: the sheet in that plane of which all its corners there are
    /// vertices, and two of them the ends of an edge.
    rests: [u32; 6],
}

impl Item {
    /// Whether two triangles touch in common vertices and edges only, since one rests on the other's sheet.
    pub fn rests(&self, other: &Self) -> bool {
        self.rests_on(other) || other.rests_on(self)
    }

    /// The same since this one rests on the sheet of the other.
    pub fn rests_on(&self, other: &Self) -> bool {
        let k = usize::from(other.level);
        k < 3 && (self.rests[2 * k] == other.sheet || self.rests[2 * k + 1] == other.sheet)
    }
}

/// Sheets that lie exactly in coordinate planes, with their vertices and edges.
pub struct Level {
    /// By sheet: bits of the axes across which it is level.
    axes: Vec<u8>,
    /// By axis.
    across: [Across; 3],
}

/// The sheets that are level across one axis.
#[derive(Default)]
struct Across {
    /// By point: one that has it; empty if there is no such sheet.
    at_point: Vec<u32>,
    /// By edge, smaller number first, as one number: one that has it.
    at_edge: IndexMap<u64, u32>,
}

fn key(a: u32, b: u32) -> u64 {
    u64::from(a.min(b)) << 32 | u64::from(a.max(b))
}

impl Level {
    /// Those of `triangles`. O(n).
    pub fn new(mesh: &Mesh, triangles: &[u32]) -> Self {
        let points = &mesh.input.points;
        let count = triangles.iter().map(|&t| mesh.sheet_of(t) as usize + 1).max().unwrap_or(0);
        let (mut axes, mut first) = (vec![0b111u8; count], vec![NONE; count]);
        for &t in triangles {
            let sheet = mesh.sheet_of(t) as usize;
            let corners = mesh.triangles[t as usize];
            if first[sheet] == NONE {
                first[sheet] = corners[0];
            }
            let at = &points[first[sheet] as usize];
            for k in 0..3 {
                let is_level = corners.iter().all(|&v| points[v as usize][k] == at[k]);
                axes[sheet] &= !(u8::from(!is_level) << k);
            }
        }
        let across = |axis: u8| {
            let mut across = Across::default();
            let is_level = |sheet: &u32, first: &u32| *first != NONE && axis_of(&axes, *sheet) == axis;
            if !(0u32..).zip(&first).any(|(sheet, first)| is_level(&sheet, first)) {
                return across;
            }
            across.at_point.resize(points.len(), NONE);
            for &t in triangles {
                let sheet = mesh.sheet_of(t);
                if axis_of(&axes, sheet) != axis {
                    continue;
                }
                let [a, b, c] = mesh.triangles[t as usize];
                for (a, b) in [(a, b), (b, c), (c, a)] {
                    across.at_point[a as usize] = sheet;
                    across.at_edge.insert(key(a, b), sheet);
                }
            }
            across
        };
        let is_much = triangles.len() >= PARALLEL_FROM;
        let (x, (y, z)) = both(is_much, || across(0), || both(is_much, || across(1), || across(2)));
        Self { axes, across: [x, y, z] }
    }

    /// A sheet in the plane across an axis that has a point.
    fn of_point(&self, v: u32, axis: usize) -> u32 {
        self.across[axis].at_point.get(v as usize).copied().unwrap_or(NONE)
    }

    /// A triangle with its box.
    pub fn item(&self, mesh: &Mesh, triangle: u32, bounds: &Aabb) -> Item {
        let corners = mesh.triangles[triangle as usize];
        let sheet = mesh.sheet_of(triangle);
        let is_common = mesh.owners(triangle).len() > 1;
        let is_level = |v: &u32| (0..3).any(|axis| self.of_point(*v, axis) != NONE);
        if !corners.iter().any(is_level) {
            return Item { triangle, sheet, is_common, level: axis_of(&self.axes, sheet), rests: [NONE; 6] };
        }
        let rests = std::array::from_fn(|side| {
            let (axis, limit) = (side / 2, if side % 2 == 0 { &bounds.lo } else { &bounds.hi });
            let is_there = |v: u32| mesh.input.points[v as usize][axis] == limit[axis];
            match corners.map(is_there) {
                [true, false, false] => self.of_point(corners[0], axis),
                [false, true, false] => self.of_point(corners[1], axis),
                [false, false, true] => self.of_point(corners[2], axis),
                [true, true, false] => self.of_edge(corners[0], corners[1], axis),
                [false, true, true] => self.of_edge(corners[1], corners[2], axis),
                [true, false, true] => self.of_edge(corners[2], corners[0], axis),
                _ => NONE,
            }
        });
        Item { triangle, sheet, is_common, level: axis_of(&self.axes, sheet), rests }
    }

    fn of_edge(&self, a: u32, b: u32, axis: usize) -> u32 {
        self.across[axis].at_edge.get(&key(a, b)).copied().unwrap_or(NONE)
    }
}

/// The first axis across which a sheet is level; 3 if there is none.
fn axis_of(axes: &[u8], sheet: u32) -> u8 {
    axes[sheet as usize].trailing_zeros().min(3) as u8
}
