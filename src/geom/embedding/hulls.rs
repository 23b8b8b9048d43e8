//! Pairs of things that may meet, of things of three corners: triangles, and segments.
//!
//! Boxes parallel to the axes tell nothing of needles beside each other, of oblique plates in a stack, of a fan around one vertex.
//! So a tree over such things keeps boxes of their first, their second and their third corners: all things lie in the hull
//! of the three boxes, which is as thin as the things themselves where these are alike. A plane between two such hulls separates
//! all their things. Coordinates are only compared with a margin for rounding, so no pair that meets is lost.

use super::apart::leaves_out_origin;
use super::twins::NONE;
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use std::ops::{ControlFlow, Range};

/// Things that a set is not divided further for.
const FEW: usize = 4;

/// Things of one terrain from which on they are kept by themselves.
const MANY: usize = 64;

/// Things in each half from which on both are divided at once: fewer take no longer than to hand them out.
const PARALLEL_FROM: usize = 1 << 12;

/// Extents of the boxes of the corners over that of all below which the hull is thin, if they are so along two axes: there may
/// be a plane where boxes overlap. Patches of well-shaped triangles are above, and needles along an axis: boxes alone serve them.
const THIN: f64 = 0.25;

/// What rounding may do to a difference of heights, over the sum of its terms' magnitudes: twelve operations, and a little more.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// A thing, or what some have in common.
#[derive(Clone, Copy)]
pub(super) struct Thing<T = Vec3> {
    /// In the hull of these it lies.
    pub corners: [T; 3],
    /// The vertex that is its first corner, where meeting others that begin there is no fault; or [`NONE`].
    pub hub: u32,
    /// Things of one terrain are proven to meet rightly; [`NONE`] for those of none.
    pub terrain: u32,
}

/// A set of things.
struct Hull {
    all: Thing<Aabb>,
    bounds: Aabb,
    /// Whether it is thinner than its box.
    is_thin: bool,
    /// Its things, by their places in the tree.
    range: Range<u32>,
    /// How far on the second half follows, the first being the next hull; 0 if it is not divided.
    second: u32,
}

/// A tree of hulls.
pub(super) struct Hulls {
    order: Vec<u32>,
    /// Boxes of the things, in the order of the tree.
    boxes: Vec<Aabb>,
    tree: Vec<Hull>,
}

/// Two hulls whose things are to be paired.
#[derive(Clone, Copy)]
pub(super) struct Task(u32, u32);

impl Hulls {
    /// The tree over things. Cost: O(n log n).
    pub fn new(things: &[Thing]) -> Self {
        let hull = |group: Vec<u32>| (Hull::around(things, &group, 0), group);
        let mut groups: Vec<_> = by_terrain(things).into_iter().map(hull).collect();
        let mut tree = Vec::with_capacity(things.len());
        if !groups.is_empty() {
            divide_groups(things, &mut groups, 0, &mut tree);
        }
        let order: Vec<u32> = groups.into_iter().flat_map(|g| g.1).collect();
        let boxes = order.iter().map(|&t| Aabb::around(&things[t as usize].corners)).collect();
        Self { order, boxes, tree }
    }

    /// The things in the order of the tree: what is near has near places.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Pieces of the search for pairs, at least `wanted` where there are enough things. They depend on the things only.
    pub fn tasks(&self, wanted: usize) -> Vec<Task> {
        let mut tasks = if self.tree.is_empty() { Vec::new() } else { vec![Task(0, 0)] };
        loop {
            let (mut finer, mut is_finer) = (Vec::with_capacity(3 * tasks.len()), false);
            for &task in &tasks {
                let is_divided = self.expand(task, &mut finer);
                is_finer |= is_divided;
                if !is_divided {
                    finer.push(task);
                }
            }
            if finer.len() >= wanted || !is_finer {
                return finer;
            }
            tasks = finer;
        }
    }

    /// Visits every pair of things, by their places in the order of the tree, that may meet elsewhere than in a common hub and
    /// are not of one terrain, once in all tasks, until the visitor breaks off.
    pub fn pairs(&self, task: Task, mut visit: impl FnMut(u32, u32) -> ControlFlow<()>) {
        let mut stack = vec![task];
        while let Some(task) = stack.pop() {
            if !self.expand(task, &mut stack) && self.visit_ends(task, &mut visit).is_break() {
                return;
            }
        }
    }

    /// Replaces a task by those of the halves, dropping what cannot meet; false if there are no halves.
    fn expand(&self, Task(a, b): Task, out: &mut Vec<Task>) -> bool {
        let [one, other] = [a, b].map(|k| &self.tree[k as usize]);
        if one.all.terrain == other.all.terrain && one.all.terrain != NONE || a != b && one.is_apart(other) {
            return true;
        }
        let halves = |k: u32, hull: &Hull| (hull.second > 0).then_some([k + 1, k + hull.second]);
        match [halves(a, one), halves(b, other)] {
            [None, None] => return false,
            [Some([p, q]), _] if a == b => out.extend([Task(p, p), Task(q, q), Task(p, q)]),
            [Some([p, q]), Some(_)] if one.range.len() >= other.range.len() => out.extend([Task(p, b), Task(q, b)]),
            [_, Some([p, q])] => out.extend([Task(a, p), Task(a, q)]),
            [Some([p, q]), None] => out.extend([Task(p, b), Task(q, b)]),
        }
        true
    }

    fn visit_ends(&self, Task(a, b): Task, visit: &mut impl FnMut(u32, u32) -> ControlFlow<()>) -> ControlFlow<()> {
        let [one, other] = [a, b].map(|k| &self.tree[k as usize]);
        for i in one.range.clone().filter(|&i| a == b || self.boxes[i as usize].overlaps(&other.bounds)) {
            for j in if a == b { i + 1..one.range.end } else { other.range.clone() } {
                if self.boxes[i as usize].overlaps(&self.boxes[j as usize]) {
                    visit(i, j)?;
                }
            }
        }
        ControlFlow::Continue(())
    }
}

/// The things of each terrain that has many, and all others: what is of one terrain is no pair.
fn by_terrain(things: &[Thing]) -> Vec<Vec<u32>> {
    let mut sorted: Vec<u32> = (0..things.len() as u32).collect();
    sorted.sort_unstable_by_key(|&t| (things[t as usize].terrain, t));
    let (mut groups, mut others) = (Vec::new(), Vec::new());
    for group in sorted.chunk_by(|&s, &t| things[s as usize].terrain == things[t as usize].terrain) {
        if group.len() < MANY || things[group[0] as usize].terrain == NONE {
            others.extend_from_slice(group);
        } else {
            groups.push(group.to_vec());
        }
    }
    groups.extend(Some(others).filter(|o| !o.is_empty()));
    groups
}

/// Adds the tree over groups, which it brings into its order, and whose hulls are known.
fn divide_groups(things: &[Thing], groups: &mut [(Hull, Vec<u32>)], offset: usize, tree: &mut Vec<Hull>) {
    if let [(_, group)] = groups {
        return divide(things, group, offset, tree);
    }
    let centers = Aabb::around(&groups.iter().map(|g| g.0.bounds.center()).collect::<Vec<_>>());
    let axis = (centers.hi - centers.lo).imax();
    // The sort is stable.
    groups.sort_by(|g, h| g.0.bounds.center()[axis].total_cmp(&h.0.bounds.center()[axis]));
    let all = groups[1..].iter().fold(groups[0].0.all, |all, g| all.union(&g.0.all));
    let count = |some: &[(Hull, Vec<u32>)]| some.iter().map(|g| g.1.len()).sum::<usize>();
    let me = tree.len();
    tree.push(Hull::new(all, offset..offset + count(groups)));
    let (low, high) = groups.split_at_mut(groups.len() / 2);
    let next = offset + count(low);
    halves(
        me,
        tree,
        next - offset,
        |tree| divide_groups(things, low, offset, tree),
        |tree| divide_groups(things, high, next, tree),
    );
}

/// Adds the trees over the halves of a hull.
fn halves(
    me: usize,
    tree: &mut Vec<Hull>,
    size: usize,
    first: impl FnOnce(&mut Vec<Hull>) + Send,
    second: impl FnOnce(&mut Vec<Hull>) + Send,
) {
    if size < PARALLEL_FROM {
        first(tree);
        tree[me].second = (tree.len() - me) as u32;
        return second(tree);
    }
    let mut rest = Vec::new();
    rayon::join(|| first(tree), || second(&mut rest));
    tree[me].second = (tree.len() - me) as u32;
    tree.append(&mut rest);
}

/// Adds the tree over some things, which it brings into its order; `offset` of them are before these.
fn divide(things: &[Thing], mine: &mut [u32], offset: usize, tree: &mut Vec<Hull>) {
    let me = tree.len();
    let hull = Hull::around(things, mine, offset);
    let sizes = hull.all.corners.map(|b| b.hi - b.lo);
    tree.push(hull);
    if mine.len() <= FEW {
        return;
    }
    let widest = sizes.map(|s| s.imax());
    let corner = (1..3).fold(0, |best, k| if sizes[k][widest[k]] > sizes[best][widest[best]] { k } else { best });
    let place = |t: &u32| things[*t as usize].corners[corner][widest[corner]];
    let half = mine.len() / 2;
    mine.select_nth_unstable_by(half, |s, t| place(s).total_cmp(&place(t)).then(s.cmp(t)));
    let (low, high) = mine.split_at_mut(half);
    halves(me, tree, half, |tree| divide(things, low, offset, tree), |tree| divide(things, high, offset + half, tree));
}

impl Thing<Aabb> {
    /// What both have in common.
    fn union(&self, other: &Self) -> Self {
        Self {
            corners: [0, 1, 2].map(|k| self.corners[k].union(&other.corners[k])),
            hub: if self.hub == other.hub { self.hub } else { NONE },
            terrain: if self.terrain == other.terrain { self.terrain } else { NONE },
        }
    }
}

impl Hull {
    /// The hull of some things.
    fn around(things: &[Thing], mine: &[u32], offset: usize) -> Self {
        let first = things[mine[0] as usize];
        let mut all = Thing { corners: [Aabb::EMPTY; 3], hub: first.hub, terrain: first.terrain };
        for thing in mine.iter().map(|&t| &things[t as usize]) {
            for (bounds, corner) in all.corners.iter_mut().zip(&thing.corners) {
                *bounds = bounds.with(corner);
            }
            all.hub = if thing.hub == all.hub { all.hub } else { NONE };
            all.terrain = if thing.terrain == all.terrain { all.terrain } else { NONE };
        }
        Self::new(all, offset..offset + mine.len())
    }

    fn new(all: Thing<Aabb>, range: Range<usize>) -> Self {
        let bounds = all.corners.iter().fold(Aabb::EMPTY, |all, b| all.union(b));
        // Along an axis where the corners fill it the hull is as good as its box.
        let is_short = |k: &usize| {
            let extent = |b: &Aabb| b.hi[*k] - b.lo[*k];
            all.corners.iter().all(|b| extent(b) < THIN * extent(&bounds))
        };
        let is_thin = (0..3).filter(is_short).count() > 1;
        Self { all, bounds, is_thin, range: range.start as u32..range.end as u32, second: 0 }
    }

    /// Whether a plane is found between the two, or one through their common hub with the other corners on its two sides.
    fn is_apart(&self, other: &Self) -> bool {
        if !self.bounds.overlaps(&other.bounds) {
            return true;
        }
        if !self.is_thin && !other.is_thin {
            return false;
        }
        let reach = |hull: &Self| hull.bounds.lo.amax().max(hull.bounds.hi.amax());
        let error = ROUNDING * (reach(self) + reach(other));
        let [mine, its] = [self, other].map(|hull| &hull.all.corners);
        if self.all.hub == other.all.hub && self.all.hub != NONE {
            let hub = mine[0].lo;
            let start = ends_center(mine) - ends_center(its);
            return leaves_out_origin(start, error, |n| {
                let [low, high] = [lowest(&mine[1..], n) - hub, hub - lowest(&its[1..], &-n)];
                if n.dot(&low) < n.dot(&high) { low } else { high }
            });
        }
        leaves_out_origin(other.bounds.center() - self.bounds.center(), error, |n| lowest(its, n) - lowest(mine, &-n))
    }
}

/// The middle of the corners that are no hub.
fn ends_center(corners: &[Aabb; 3]) -> Vec3 {
    (corners[1].center() + corners[2].center()) * 0.5
}

/// The point of boxes that is lowest along a direction.
fn lowest(boxes: &[Aabb], n: &Vec3) -> Vec3 {
    let of = |b: &Aabb| n.zip_zip_map(&b.lo, &b.hi, |n, lo, hi| if n > 0.0 { lo } else { hi });
    boxes[1..].iter().map(of).fold(of(&boxes[0]), |low, p| if n.dot(&p) < n.dot(&low) { p } else { low })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn thing([a, b]: [Vec3; 2]) -> Thing {
        Thing { corners: [a, b, b], hub: NONE, terrain: NONE }
    }

    fn row(count: u32, end: impl Fn(f64) -> [Vec3; 2]) -> Vec<Thing> {
        (0..count).map(|k| thing(end(f64::from(k)))).collect()
    }

    fn visited(things: &[Thing]) -> Vec<[u32; 2]> {
        let mut pairs = Vec::new();
        let hulls = Hulls::new(things);
        for task in hulls.tasks(7) {
            hulls.pairs(task, |i, j| {
                let [i, j] = [i, j].map(|k| hulls.order()[k as usize]);
                pairs.push([i.min(j), i.max(j)]);
                ControlFlow::Continue(())
            });
        }
        pairs.sort_unstable();
        pairs
    }

    #[test]
    fn of_a_row_only_neighbours_are_looked_at() {
        let v = Vec3::new;
        let n = 3000;
        let oblique = row(n, |k| [v(0.02 * k, 0.0, 0.007 * k), v(700.0 + 0.02 * k, 700.0, 700.0 + 0.007 * k)]);
        let grid = row(n, |k| {
            [
                v((k / 50.0).floor(), 0.3 * (k % 50.0), k % 50.0),
                v((k / 50.0).floor() + 500.0, 0.3 * (k % 50.0) + 400.0, k % 50.0 + 300.0),
            ]
        });
        let twisted = row(n, |k| {
            let a = k * std::f64::consts::TAU / f64::from(n);
            [v(a.cos(), a.sin(), -1.0), v((a + 1.0).cos(), (a + 1.0).sin(), 1.0)]
        });
        let fan: Vec<Thing> = row(n, |k| {
            let a = k * std::f64::consts::TAU / f64::from(n);
            [v(1.0, 2.0, 3.0), v(1.0 + a.cos(), 2.0 + a.sin(), 3.0 + (5.0 * a).cos())]
        })
        .into_iter()
        .map(|thing| Thing { hub: 7, ..thing })
        .collect();
        for (name, things) in [("oblique", oblique), ("grid", grid), ("twisted", twisted), ("fan", fan)] {
            let pairs = visited(&things);
            assert!(pairs.len() < 30 * n as usize, "{name}: {}", pairs.len());
            assert!(pairs.windows(2).all(|w| w[0] != w[1]), "{name}");
        }
    }

    #[test]
    fn what_meets_is_always_looked_at() {
        // Each segment of one row crosses or touches all of the other; ends on one place, and copies.
        let v = Vec3::new;
        let one = row(60, |k| [v(0.1 * k, 0.0, 0.3), v(0.1 * k, 6.0, 0.3)]);
        let other = row(60, |k| [v(0.0, 0.1 * k, 0.3), v(6.0, 0.1 * k, 0.3)]);
        let pairs = visited(&[one.clone(), other, one].concat());
        for i in 0..60 {
            assert!((60..120).all(|j| pairs.binary_search(&[i, j]).is_ok()));
            assert!(pairs.binary_search(&[i, i + 120]).is_ok());
        }
    }
}
