//! Ruled surfaces that are cut into level curves (thesis 2.3.3.2) are cut alike, whoever wrote them and from where to where.
//!
//! The rule. Lines turned about an axis and arcs moved along one make cylinders and cones. Those that are one surface, within
//! the contact tolerance, form a group.
//! 1. If one of a group is to be triangulated, all are.
//! 2. *Hard* levels are the heights at which a surface of the group begins or ends; those that agree within the tolerance are
//!    one (the earliest leaf's).
//! 3. The gap between two neighbouring hard levels is divided into equal rows, as many as its chords ask for.
//! 4. A surface uses all levels between its ends.
//!
//! With the breakpoints of the axis ([`super::axis`]) a gap between hard angles and hard levels is a cell. Its triangles follow
//! from the cell alone ([`super::ruled`]), so that a magnet on a rotor and a shaft through it have the rotor's triangles.
//!
//! Surfaces of one leaf that share a line of their ends (an arc that follows an arc) have their levels in common as well.

use super::circle::Axis;
use super::rulings::Key;
use super::sweep::Sweep;
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use crate::geom::union_find::UnionFind;
use std::collections::{BTreeMap, HashMap};
use std::f64::consts::TAU;

/// Height of an equilateral triangle over its side.
pub(crate) const ROW_PER_CHORD: f64 = 0.866;
/// Hard levels that a group may share; beyond them every surface has only its own, as with breakpoints.
const MAX_SHARED: usize = 2000;
/// Cells of the look-up for surfaces, as a fraction of the model: far above the tolerance, far below real distances.
const CELL: f64 = 1e-6;

/// A ruled curved surface of a sweep.
#[derive(Clone, Debug)]
pub(crate) struct Ruled {
    /// Which it is.
    pub key: Key,
    /// The axis that it lies about.
    pub axis: Axis,
    /// Number of the axis among those of the scene, if its circles are divided with those of others.
    pub group: Option<usize>,
    /// Where it begins and ends, on the axis: in the order of the run if it was turned, of the stations if moved.
    pub ends: [Vec3; 2],
    /// Radii there, in the scene.
    pub radii: [f64; 2],
    /// Chords per full circle.
    pub segments: f64,
    /// Whether it is to be triangulated.
    pub is_triangulated: bool,
    /// Earlier surfaces of the leaf (numbers in its list) that share a line of their ends with it.
    pub neighbours: Vec<usize>,
}

/// How a ruled surface is cut; from its low end to its high one.
#[derive(Clone, Debug)]
pub(crate) struct Levels {
    /// Hard levels with both ends.
    pub levels: Vec<Level>,
    /// Number of rows of each gap between them.
    pub rows: Vec<u32>,
    /// Whether the low end is the first one.
    pub is_rising: bool,
    /// Whether the degrees of the axis rise in the common sense of turning.
    pub is_ccw: bool,
    /// Chords per full circle.
    pub segments: f64,
}

/// A hard level. Heights and radii are those of the group, so that what is decided by them is decided alike.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Level {
    /// Its part of the way from the low end to the high one of the surface at hand.
    pub share: f64,
    /// Along the axis.
    pub height: f64,
    /// Of the surface there.
    pub radius: f64,
}

/// A surface of the scene: a straight line in the half plane of an axis.
struct Surface {
    axis: Axis,
    group: Option<usize>,
    /// A point of it (radius, height) and its direction, for heights along the axis from its origin.
    point: [f64; 2],
    direction: [f64; 2],
    middle: Vec3,
}

impl Surface {
    fn new(ruled: &Ruled) -> Self {
        let [a, b] = profile(ruled, &ruled.axis);
        let d = [b[0] - a[0], b[1] - a[1]];
        let length = libm::hypot(d[0], d[1]);
        let middle = (ruled.ends[0] + ruled.ends[1]) * 0.5;
        Self { axis: ruled.axis.clone(), group: ruled.group, point: a, direction: [d[0] / length, d[1] / length], middle }
    }

    /// Distance of its line from a point of the half plane, signed.
    fn distance(&self, p: [f64; 2]) -> f64 {
        self.direction[0] * (p[1] - self.point[1]) - self.direction[1] * (p[0] - self.point[0])
    }

    fn radius_at(&self, point: &Vec3) -> f64 {
        let height = (point - self.axis.origin).dot(&self.axis.z);
        (self.point[0] + (height - self.point[1]) * self.direction[0] / self.direction[1]).max(0.0)
    }

    /// Whether a surface lies in this one. Those without an axis of the scene must be the same from end to end.
    fn contains(&self, ruled: &Ruled, reach: f64) -> bool {
        let is_same = self.group == ruled.group && profile(ruled, &self.axis).iter().all(|p| self.distance(*p).abs() <= reach);
        is_same && (self.group.is_some() || (self.middle - (ruled.ends[0] + ruled.ends[1]) * 0.5).norm() <= reach)
    }

    /// Cells of the look-up near it.
    fn slot(&self, center: Vec3, cell: f64) -> [i64; 2] {
        let height = (center - self.axis.origin).dot(&self.axis.z);
        let place = if self.group.is_some() { self.distance([0.0, height]).abs() } else { (self.middle - center).norm() };
        [self.group.map_or(-1, |g| g as i64), (place / cell).floor() as i64]
    }
}

/// (radius, height) of both ends.
fn profile(ruled: &Ruled, axis: &Axis) -> [[f64; 2]; 2] {
    std::array::from_fn(|k| [ruled.radii[k], (ruled.ends[k] - axis.origin).dot(&axis.z)])
}

/// Tells all sweeps how their ruled surfaces are cut; `reach` is the contact tolerance, a length.
///
/// O(n log n) in surfaces and levels.
pub(crate) fn divide(sweeps: &mut [&mut Sweep], reach: f64) {
    let mut owners = Vec::new();
    let (mut all, mut joined) = (Vec::new(), Vec::new());
    for (s, sweep) in sweeps.iter().enumerate() {
        let first = all.len();
        for ruled in sweep.ruled() {
            joined.extend(ruled.neighbours.iter().map(|n| (first + n, all.len())));
            owners.push((s, ruled.key));
            all.push(ruled);
        }
    }
    if all.iter().all(|r| !r.is_triangulated) {
        return;
    }
    let bounds = all
        .iter()
        .fold(Aabb::EMPTY, |b, r| (0..2).fold(b, |b, k| b.union(&Aabb { lo: r.ends[k], hi: r.ends[k] }.inflated(r.radii[k]))));
    let (surfaces, of) = find_surfaces(&all, reach, bounds.center(), (bounds.diagonal() * CELL).max(4.0 * reach));
    let mut sets = UnionFind::new(surfaces.len());
    for (a, b) in joined {
        sets.join(of[a] as u32, of[b] as u32);
    }
    let mut groups: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for (k, &surface) in of.iter().enumerate() {
        groups.entry(sets.find(surface as u32)).or_default().push(k);
    }
    for members in groups.values().filter(|m| m.iter().any(|&k| all[k].is_triangulated)) {
        let is_shared = 2 * members.len() <= MAX_SHARED;
        for part in members.chunk_by(|&a, &b| is_shared || owners[a].0 == owners[b].0) {
            for (k, levels) in divide_group(part, &all, &surfaces, &of, reach) {
                let (sweep, key) = owners[k];
                sweeps[sweep].levels.insert(key, levels);
            }
        }
    }
}

/// The surfaces of the scene, and which each ruled surface lies in.
fn find_surfaces(all: &[Ruled], reach: f64, center: Vec3, cell: f64) -> (Vec<Surface>, Vec<usize>) {
    let mut surfaces: Vec<Surface> = Vec::new();
    let mut lookup: HashMap<[i64; 2], Vec<usize>> = HashMap::new();
    let mut of = Vec::with_capacity(all.len());
    for ruled in all {
        let own = Surface::new(ruled);
        let [group, place] = own.slot(center, cell);
        let near = [0, -1, 1].into_iter().filter_map(|d| lookup.get(&[group, place.saturating_add(d)])).flatten();
        let found = near.copied().filter(|&s| surfaces[s].contains(ruled, reach)).min();
        of.push(found.unwrap_or(surfaces.len()));
        if found.is_none() {
            lookup.entry([group, place]).or_default().push(surfaces.len());
            surfaces.push(own);
        }
    }
    (surfaces, of)
}

/// Where heights are measured along: across the rings of an axis of the scene, to which it is oblique in a sheared leaf.
fn across_rings(surface: &Surface) -> Vec3 {
    let axis = &surface.axis;
    if surface.group.is_none() {
        return axis.z;
    }
    let normal = axis.x.cross(&axis.y).normalize();
    if normal.dot(&axis.z) < 0.0 { -normal } else { normal }
}

/// Height of a level that surfaces end at, and a point there.
type HardLevel = (f64, Vec3);

/// One level for all ends (height, ruled surface, point) that lie within `reach` of the next, from below.
fn hard_levels(mut ends: Vec<(f64, usize, Vec3)>, reach: f64) -> Vec<HardLevel> {
    ends.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let near = ends.chunk_by(|a, b| b.0 - a.0 <= reach);
    // Of those that agree, the earliest leaf's.
    near.filter_map(|near| near.iter().min_by_key(|e| e.1)).map(|e| (e.0, e.2)).collect()
}

/// The levels of the surfaces of one group.
fn divide_group(members: &[usize], all: &[Ruled], surfaces: &[Surface], of: &[usize], reach: f64) -> Vec<(usize, Levels)> {
    let first = &surfaces[of[members[0]]];
    let up = across_rings(first);
    let own = |k: usize| all[k].ends.map(|p| p.dot(&up));
    // A mitre ends the arcs of a profile at heights of their own. Where no axis is shared, all of a group run from end to end.
    let [a, b] = own(members[0]);
    let heights = |k: usize| match own(k) {
        ends if first.group.is_some() => ends,
        [p, q] if p < q => [a.min(b), a.max(b)],
        _ => [a.max(b), a.min(b)],
    };
    let ends = members.iter().flat_map(|&k| [0, 1].map(|e| (heights(k)[e], k, all[k].ends[e])));
    let hard = hard_levels(ends.collect(), reach);
    let index = |h: f64| {
        let above = hard.partition_point(|level| level.0 < h).min(hard.len() - 1);
        if above > 0 && h - hard[above - 1].0 < hard[above].0 - h { above - 1 } else { above }
    };
    let span = |k: usize| {
        let [a, b] = heights(k).map(index);
        (a.min(b), a.max(b))
    };
    let radius = |k: usize, level: &HardLevel| surfaces[of[k]].radius_at(&level.1);
    let mut rows = vec![1u32; hard.len()];
    for &k in members {
        let (low, high) = span(k);
        for gap in low..high {
            let [a, b] = [&hard[gap], &hard[gap + 1]];
            let [ra, rb] = [a, b].map(|level| radius(k, level));
            let chord = TAU * ra.max(rb) / all[k].segments;
            rows[gap] = rows[gap].max(count(libm::hypot(b.0 - a.0, rb - ra), ROW_PER_CHORD * chord));
        }
    }
    let plan = |&k: &usize| {
        let (low, high) = span(k);
        let [first, last] = heights(k);
        let [own_low, own_high] = [first.min(last), first.max(last)];
        let levels = (low..=high).map(|n| {
            let share = match n {
                _ if n == low => 0.0,
                _ if n == high => 1.0,
                _ => ((hard[n].0 - own_low) / (own_high - own_low)).clamp(0.0, 1.0),
            };
            Level { share, height: hard[n].0, radius: radius(k, &hard[n]) }
        });
        let levels = Levels {
            levels: levels.collect(),
            rows: rows[low..high].to_vec(),
            is_rising: first < last,
            is_ccw: all[k].axis.z.dot(&up) > 0.0,
            segments: all[k].segments,
        };
        (k, levels)
    };
    // What is thinner than the tolerance has no levels.
    members.iter().filter(|&&k| span(k).0 < span(k).1).map(plan).collect()
}

/// Number of rows of about the given height: even, so that shifted rows lie between rims that are not, or one.
fn count(length: f64, height: f64) -> u32 {
    let rows = length / height;
    let even = if rows < 1.5 { 1.0 } else { 2.0 * (rows * 0.5).round() };
    even.min(f64::from(super::division::MAX_SEGMENTS)) as u32
}
