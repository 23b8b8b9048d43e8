//! The volumes that triangles enclose, from the triangles alone.
//!
//! Each triangle has two sides (2t in front, 2t + 1 behind). Around every edge the sides that face each other belong to one
//! volume; the order around the edge comes from exact signs. Sides joined over edges are shells. A shell that encloses what is
//! inside it is an outer one; the others are joined to their volume along a line to the outside.

use super::measure::enclosed_volumes;
use crate::geom::Vec3;
use crate::geom::cast::{CastError, Caster};
use crate::geom::embedding::projection_of;
use crate::geom::predicates::{orient2d, orient3d};
use crate::geom::union_find::UnionFind;
use std::cmp::Ordering;
use std::collections::BTreeMap;

/// What the triangles enclose. Volume 0 is the unbounded one.
#[derive(Clone, Debug, Default)]
pub struct Volumes {
    /// Volume of each side: 2t in front of triangle t, 2t + 1 behind it.
    pub of_side: Vec<u32>,
    /// Number of volumes, with the outside.
    pub count: u32,
    /// Edges of one triangle only.
    pub open_edges: Vec<[u32; 2]>,
    /// Shells in order of their first side.
    pub shells: Vec<Shell>,
    /// Vertex uses: corners that are joined around a vertex on one shell.
    pub vertex_uses: u64,
    /// Shells that could not be joined to a volume (only if the triangles are no complex).
    pub lost: Vec<u32>,
    /// Each edge with the number of triangles at it, by vertex numbers.
    pub edges: Vec<([u32; 2], u32)>,
}

/// A connected set of sides.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Shell {
    /// A triangle of it: its largest.
    pub triangle: u32,
    /// The volume on its side.
    pub volume: u32,
    /// Whether it is the outer shell of its volume.
    pub is_outer: bool,
    /// Euler characteristic: 2 less twice the number of handles.
    pub characteristic: i64,
}

/// Finds the volumes. The triangles must be embedded (`geom::embedding`) and have area; otherwise the result is some
/// assignment. Cost: O(n log n).
pub fn find(points: &[Vec3], triangles: &[[u32; 3]], caster: &Caster) -> Volumes {
    let mut join = Joiner::new(triangles);
    let mut uses: Vec<([u32; 2], u32)> =
        triangles.iter().enumerate().flat_map(|(t, w)| [0, 1, 2].map(|k| (sorted([w[k], w[(k + 1) % 3]]), t as u32))).collect();
    uses.sort_unstable();
    let mut volumes = Volumes::default();
    for fan in uses.chunk_by(|x, y| x.0 == y.0) {
        let edge = fan[0].0;
        volumes.edges.push((edge, fan.len() as u32));
        if fan.len() == 1 {
            volumes.open_edges.push(edge);
        }
        let around = radial_order(edge, fan, points, triangles);
        for (k, &t) in around.iter().enumerate() {
            join.facing(edge, t, around[(k + 1) % around.len()]);
        }
    }
    assemble(&mut volumes, join, points, triangles, caster);
    volumes
}

fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// The triangles at an edge, counter-clockwise about its direction.
fn radial_order([a, b]: [u32; 2], fan: &[([u32; 2], u32)], points: &[Vec3], triangles: &[[u32; 3]]) -> Vec<u32> {
    let mut around: Vec<u32> = fan.iter().map(|u| u.1).collect();
    if around.len() <= 2 {
        return around;
    }
    let at = |v: u32| &points[v as usize];
    let apex = |t: u32| at(triangles[t as usize].into_iter().find(|&v| v != a && v != b).unwrap_or(a));
    let first = apex(around[0]);
    let projection = projection_of([*at(a), *at(b), *first]);
    // Quarter of the full turn from the first triangle: on it, before, on, and after the half turn.
    let quarter = |t: u32| match orient3d(at(a), at(b), first, apex(t)) {
        1 => 1,
        -1 => 3,
        _ => match projection {
            Some(q) if orient2d(q.apply(at(a)), q.apply(at(b)), q.apply(apex(t))) < 0 => 2,
            _ => 0,
        },
    };
    // Within an open half turn the sign orders exactly; equal angles keep their order.
    around.sort_by(|&s, &t| {
        quarter(s).cmp(&quarter(t)).then_with(|| match orient3d(at(a), at(b), apex(s), apex(t)) {
            1 if quarter(s) % 2 == 1 => Ordering::Less,
            -1 if quarter(s) % 2 == 1 => Ordering::Greater,
            _ => Ordering::Equal,
        })
    });
    around
}

/// Numbers each shell and adds up what is known of it; then joins inner shells to their volumes.
fn assemble(volumes: &mut Volumes, mut join: Joiner, points: &[Vec3], triangles: &[[u32; 3]], caster: &Caster) {
    let sides = 2 * triangles.len() as u32;
    let (shell_of, shells) = std::mem::replace(&mut join.sides, UnionFind::new(0)).number();
    let corners = |t: usize| triangles[t].map(|v| points[v as usize]);
    let walls = || (0..triangles.len()).map(|t| (corners(t), [shell_of[2 * t], shell_of[2 * t + 1]]));
    let content = enclosed_volumes(shells, walls);
    let mut largest = vec![(-1.0f64, 0u32); shells];
    let mut characteristic = vec![0i64; shells];
    for (s, &shell) in shell_of.iter().enumerate() {
        let [a, b, c] = corners(s / 2);
        let area = (b - a).cross(&(c - a)).norm_squared();
        if area > largest[shell as usize].0 {
            largest[shell as usize] = (area, (s / 2) as u32);
        }
        characteristic[shell as usize] += 1;
    }
    for &s in &join.joins {
        characteristic[shell_of[s as usize] as usize] -= 1;
    }
    for corner in 0..3 * sides {
        if join.corners.find(corner) == corner {
            characteristic[shell_of[(corner / 3) as usize] as usize] += 1;
            volumes.vertex_uses += 1;
        }
    }
    // Shells and, in the last slot, the outside.
    let outside = shells as u32;
    let mut same = UnionFind::new(shells + 1);
    for shell in 0..outside {
        if content[shell as usize] <= 0.0 {
            let done = join_along_line(largest[shell as usize].1, outside, &shell_of, &mut same, caster);
            if done.is_err() {
                volumes.lost.push(shell);
            }
        }
    }
    let mut volume = BTreeMap::from([(same.find(outside), 0)]);
    for shell in 0..outside {
        let next = volume.len() as u32;
        let volume = *volume.entry(same.find(shell)).or_insert(next);
        let k = shell as usize;
        let is_outer = content[k] > 0.0;
        volumes.shells.push(Shell { triangle: largest[k].1, volume, is_outer, characteristic: characteristic[k] });
    }
    volumes.count = volume.len() as u32;
    volumes.of_side = shell_of.iter().map(|&s| volumes.shells[s as usize].volume).collect();
}

/// Between two crossings that follow each other on a line there is one volume. Doing this for a line through each inner shell
/// joins all of them: beyond the last crossing of any set of inner shells lies what does not belong to the set.
fn join_along_line(
    triangle: u32,
    outside: u32,
    shell_of: &[u32],
    same: &mut UnionFind,
    caster: &Caster,
) -> Result<(), CastError> {
    let mut before = outside;
    for c in caster.line_through(triangle)? {
        let (entered, left) = if c.from_front { (0, 1) } else { (1, 0) };
        same.join(before, shell_of[(2 * c.triangle + entered) as usize]);
        before = shell_of[(2 * c.triangle + left) as usize];
    }
    same.join(before, outside);
    Ok(())
}

impl Volumes {
    /// The volume that a point lies in.
    ///
    /// # Errors
    /// If it lies on a triangle, or no ray from it was free of edges.
    pub fn at(&self, point: &Vec3, caster: &Caster) -> Result<u32, CastError> {
        // Going in from the outside, each crossing changes the volume: what is entered once more than left is the answer.
        let mut entered: BTreeMap<u32, bool> = BTreeMap::new();
        for c in caster.cast(point)? {
            for side in [0, 1] {
                *entered.entry(self.of_side[(2 * c.triangle + side) as usize]).or_default() ^= true;
            }
        }
        Ok(entered.into_iter().find(|&(volume, is_odd)| is_odd && volume != 0).map_or(0, |e| e.0))
    }
}

/// Joins sides over edges, and their corners around vertices.
struct Joiner<'a> {
    triangles: &'a [[u32; 3]],
    sides: UnionFind,
    corners: UnionFind,
    /// One side of each pair.
    joins: Vec<u32>,
}

impl<'a> Joiner<'a> {
    fn new(triangles: &'a [[u32; 3]]) -> Self {
        let n = triangles.len();
        Self { triangles, sides: UnionFind::new(2 * n), corners: UnionFind::new(6 * n), joins: Vec::with_capacity(3 * n) }
    }

    /// Joins the side of `s` that looks counter-clockwise around the edge with the side of the next triangle that looks back.
    fn facing(&mut self, [a, b]: [u32; 2], s: u32, t: u32) {
        let runs_along = |t: u32| {
            let w = self.triangles[t as usize];
            (0..3).any(|k| w[k] == a && w[(k + 1) % 3] == b)
        };
        let x = 2 * s + u32::from(!runs_along(s));
        let y = 2 * t + u32::from(runs_along(t));
        self.sides.join(x, y);
        self.joins.push(x);
        for v in [a, b] {
            let corner = |side: u32| {
                let w = self.triangles[(side / 2) as usize];
                3 * side + w.iter().position(|&u| u == v).unwrap_or(0) as u32
            };
            self.corners.join(corner(x), corner(y));
        }
    }
}
