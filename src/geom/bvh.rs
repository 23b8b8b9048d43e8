//! A box tree over numbered boxes.
//!
//! Built by splitting at the median of the centres along the widest axis; the order is deterministic. Building costs
//! O(n log n), a query O(log n + hits) on well spread boxes.

use super::Vec3;
use super::aabb::Aabb;
use std::ops::ControlFlow;

/// Largest number of boxes in a tree leaf: below this, testing all is cheaper than descending.
const LEAF_SIZE: usize = 4;

/// Boxes in each half from which on both are built at once: fewer take no longer than to hand them out.
const PARALLEL_FROM: usize = 1 << 13;

/// More levels than any tree has: each halves up to 2^32 items.
const DEEPEST: usize = 40;

#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Aabb,
    /// First item (leaf) or index of the right child (inner node; the left child follows its parent).
    first: u32,
    /// Number of items; 0 for an inner node.
    count: u32,
}

/// A pair of subtrees whose items are to be paired; see [`Bvh::pair_tasks`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct PairTask(u32, u32);

/// A box tree. Item numbers are the positions in the slice that it was built from.
#[derive(Clone, Debug, Default)]
pub struct Bvh {
    nodes: Vec<Node>,
    /// Items with their boxes, those of a tree leaf side by side.
    items: Vec<Item>,
}

/// A box and its number.
#[derive(Clone, Copy, Debug)]
pub struct Item {
    /// The box.
    pub bounds: Aabb,
    /// Its position in the slice that the tree was built from, or what [`Bvh::renumber`] made of it.
    pub number: u32,
}

/// A box by its number and its centre, seen from that of the first one, as [`in_order`] has it.
type Keyed = (u32, [i32; 3]);

/// A number that is in the order of `x`, as `total_cmp` is: integers are compared in half the time.
fn in_order(x: f32) -> i32 {
    let bits = x.to_bits() as i32;
    bits ^ ((bits >> 31) as u32 >> 1) as i32
}

/// What [`in_order`] came from: it is its own inverse.
fn value_of(key: i32) -> f32 {
    f32::from_bits(in_order(f32::from_bits(key as u32)) as u32)
}

impl Bvh {
    /// The tree over `boxes`; empty ones, which nothing comes near, are left out.
    pub fn new(boxes: Vec<Aabb>) -> Self {
        // Single precision is enough to tell where to split, and half of it to move. Centres further than its range from the
        // first one are as far as any: a tree over these is slower, and as right.
        let origin = boxes.iter().find(|b| !b.is_empty()).map_or(Vec3::zeros(), Aabb::center);
        let center = |b: &Aabb| (b.center() - origin).map(|x| in_order(x as f32)).into();
        let mut keyed: Vec<Keyed> = Vec::with_capacity(boxes.len());
        keyed.extend(boxes.iter().zip(0..).filter(|b| !b.0.is_empty()).map(|(b, k)| (k, center(b))));
        let mut nodes = Vec::with_capacity(most_nodes(keyed.len()));
        if !keyed.is_empty() {
            split(&mut keyed, 0, &boxes, &mut nodes);
        }
        let item = |(number, _): Keyed| Item { bounds: boxes[number as usize], number };
        Self { nodes, items: keyed.into_iter().map(item).collect() }
    }

    /// Numbers the items anew in the order of the tree, so that what is near has near numbers; the old number of each.
    pub fn renumber(&mut self) -> Vec<u32> {
        let renumber = |(k, item): (usize, &mut Item)| std::mem::replace(&mut item.number, k as u32);
        self.items.iter_mut().enumerate().map(renumber).collect()
    }

    /// Calls `visit` with the number of every box that overlaps `query`.
    pub fn overlapping(&self, query: &Aabb, visit: impl FnMut(u32)) {
        self.search(|b| b.overlaps(query), visit);
    }

    /// Calls `visit` with the number of every box for which `accept` holds; `accept` must hold for a box whenever it holds
    /// for one inside it.
    pub fn search(&self, accept: impl Fn(&Aabb) -> bool, mut visit: impl FnMut(u32)) {
        if self.nodes.is_empty() {
            return;
        }
        let mut stack = vec![0u32];
        while let Some(n) = stack.pop() {
            let node = &self.nodes[n as usize];
            if !accept(&node.bounds) {
                continue;
            }
            if node.count == 0 {
                stack.push(node.first);
                stack.push(n + 1);
            } else {
                for item in self.items_of(node) {
                    if accept(&item.bounds) {
                        visit(item.number);
                    }
                }
            }
        }
    }

    /// The item nearest to a point by a squared distance that is not below that of the item's box; the first of equally near
    /// ones. Nearer boxes are looked at first: cost O(log n) on well spread ones, and less if `guess` is one of the nearer
    /// items.
    pub fn nearest(&self, point: &Vec3, guess: Option<u32>, distance: impl Fn(u32) -> f64) -> Option<u32> {
        let gap = |b: &Aabb| (b.lo - point).sup(&(point - b.hi)).sup(&Vec3::zeros()).norm_squared();
        let mut best = guess.map_or((f64::INFINITY, u32::MAX), |i| (distance(i), i));
        // Of each level at most the farther child waits.
        let mut stack = [(0.0, 0); DEEPEST];
        let mut waiting = usize::from(!self.nodes.is_empty());
        while waiting > 0 {
            waiting -= 1;
            let (low, n) = stack[waiting];
            if low > best.0 {
                continue;
            }
            let node = &self.nodes[n as usize];
            if node.count == 0 {
                let child = |c: u32| (gap(&self.nodes[c as usize].bounds), c);
                let (left, right) = (child(n + 1), child(node.first));
                let (near, far) = if left.0 <= right.0 { (left, right) } else { (right, left) };
                for child in [far, near] {
                    if child.0 <= best.0 {
                        stack[waiting] = child;
                        waiting += 1;
                    }
                }
                continue;
            }
            for item in self.items_of(node) {
                if gap(&item.bounds) <= best.0 {
                    let here = (distance(item.number), item.number);
                    if here.0 < best.0 || (here.0 == best.0 && here.1 < best.1) {
                        best = here;
                    }
                }
            }
        }
        (best.1 != u32::MAX).then_some(best.1)
    }

    /// Pieces of the search for all overlapping pairs, for [`Bvh::overlapping_pairs`]: their number is at least `wanted` where
    /// the tree is large enough, their order and content depend on the boxes only.
    pub fn pair_tasks(&self, wanted: usize) -> Vec<PairTask> {
        let mut tasks: Vec<PairTask> = if self.nodes.is_empty() { Vec::new() } else { vec![PairTask(0, 0)] };
        loop {
            let mut finer = Vec::with_capacity(tasks.len() * 3);
            for &task in &tasks {
                if !self.expand(task, &mut finer) {
                    finer.push(task);
                }
            }
            if finer.len() >= wanted || finer.len() == tasks.len() {
                return finer;
            }
            tasks = finer;
        }
    }

    /// Calls `visit` once with every pair of items of this task whose closed boxes overlap, until it breaks. The tasks of
    /// [`Bvh::pair_tasks`] together give every overlapping pair once. Cost: O(n + pairs) on well spread boxes.
    pub fn overlapping_pairs(&self, task: PairTask, mut visit: impl FnMut(u32, u32) -> ControlFlow<()>) {
        let mut stack = vec![task];
        while let Some(task) = stack.pop() {
            if !self.expand(task, &mut stack) && self.visit_leaves(task, &mut visit).is_break() {
                return;
            }
        }
    }

    /// Replaces a task by the tasks of its children, dropping those whose boxes are apart; false for a pair of tree leaves.
    fn expand(&self, PairTask(n, m): PairTask, out: &mut Vec<PairTask>) -> bool {
        let children = |k: u32| {
            let node = &self.nodes[k as usize];
            (node.count == 0).then_some([k + 1, node.first])
        };
        let mut push = |a: u32, b: u32| {
            if a == b || self.nodes[a as usize].bounds.overlaps(&self.nodes[b as usize].bounds) {
                out.push(PairTask(a, b));
            }
        };
        match (children(n), children(m)) {
            (None, None) => return false,
            (Some([a, b]), _) if n == m => [(a, a), (a, b), (b, b)].into_iter().for_each(|(a, b)| push(a, b)),
            (Some([a, b]), None) => [a, b].into_iter().for_each(|a| push(a, m)),
            (None, Some([a, b])) => [a, b].into_iter().for_each(|b| push(n, b)),
            (Some([a, b]), Some([c, d])) => [(a, c), (a, d), (b, c), (b, d)].into_iter().for_each(|(a, b)| push(a, b)),
        }
        true
    }

    fn visit_leaves(&self, PairTask(n, m): PairTask, visit: &mut impl FnMut(u32, u32) -> ControlFlow<()>) -> ControlFlow<()> {
        let [own, other] = [n, m].map(|k| &self.nodes[k as usize]);
        // Of two leaves that overlap, most items do not reach the other one.
        for (i, a) in self.items_of(own).iter().enumerate().filter(|a| n == m || a.1.bounds.overlaps(&other.bounds)) {
            for b in &self.items_of(other)[if n == m { i + 1 } else { 0 }..] {
                if a.bounds.overlaps(&b.bounds) {
                    visit(a.number, b.number)?;
                }
            }
        }
        ControlFlow::Continue(())
    }

    /// Calls `visit` with every pair (item of this tree, item of `other`) whose boxes come nearer than `margin` along every
    /// axis, until it breaks. Descends both trees together, so that pairs far apart cost nothing.
    pub fn pairs(&self, other: &Self, margin: f64, mut visit: impl FnMut(&Item, &Item) -> ControlFlow<()>) {
        if self.nodes.is_empty() || other.nodes.is_empty() {
            return;
        }
        let mut stack = vec![(0u32, 0u32)];
        while let Some((m, n)) = stack.pop() {
            let (a, b) = (&self.nodes[m as usize], &other.nodes[n as usize]);
            if !a.bounds.is_near(&b.bounds, margin) {
                continue;
            }
            // The larger one is split, so that both shrink to what is near.
            let is_smaller = || (a.bounds.hi - a.bounds.lo).norm_squared() < (b.bounds.hi - b.bounds.lo).norm_squared();
            match (a.count, b.count) {
                (0, 0) if is_smaller() => stack.extend([(m, b.first), (m, n + 1)]),
                (0, _) => stack.extend([(a.first, n), (m + 1, n)]),
                (_, 0) => stack.extend([(m, b.first), (m, n + 1)]),
                _ => {
                    for own in self.items_of(a).iter().filter(|own| own.bounds.is_near(&b.bounds, margin)) {
                        for its in other.items_of(b).iter().filter(|its| own.bounds.is_near(&its.bounds, margin)) {
                            if visit(own, its).is_break() {
                                return;
                            }
                        }
                    }
                }
            }
        }
    }

    fn items_of(&self, node: &Node) -> &[Item] {
        &self.items[node.first as usize..(node.first + node.count) as usize]
    }

    /// The box of everything; empty if there is nothing.
    pub fn bounds(&self) -> Aabb {
        self.nodes.first().map_or(Aabb::EMPTY, |n| n.bounds)
    }
}

fn split(keyed: &mut [Keyed], offset: usize, boxes: &[Aabb], nodes: &mut Vec<Node>) {
    let me = nodes.len();
    nodes.push(Node { bounds: Aabb::EMPTY, first: offset as u32, count: keyed.len() as u32 });
    if keyed.len() <= LEAF_SIZE {
        nodes[me].bounds = keyed.iter().fold(Aabb::EMPTY, |b, k| b.union(&boxes[k.0 as usize]));
        return;
    }
    let (mut lo, mut hi) = ([i32::MAX; 3], [i32::MIN; 3]);
    for (_, c) in keyed.iter() {
        for k in 0..3 {
            lo[k] = lo[k].min(c[k]);
            hi[k] = hi[k].max(c[k]);
        }
    }
    let extent = |k: usize| value_of(hi[k]) - value_of(lo[k]);
    let axis = (0..3).fold(0, |a, k| if extent(k) > extent(a) { k } else { a });
    let middle = keyed.len() / 2;
    keyed.select_nth_unstable_by_key(middle, |k| (k.1[axis], k.0));
    let (left, right) = keyed.split_at_mut(middle);
    let next;
    if left.len() < PARALLEL_FROM {
        split(left, offset, boxes, nodes);
        next = nodes.len();
        split(right, offset + middle, boxes, nodes);
    } else {
        let [mut first, mut second] = [&left, &right].map(|half| Vec::with_capacity(most_nodes(half.len())));
        rayon::join(|| split(left, offset, boxes, &mut first), || split(right, offset + middle, boxes, &mut second));
        append(nodes, first);
        next = nodes.len();
        append(nodes, second);
    }
    nodes[me] = Node { bounds: nodes[me + 1].bounds.union(&nodes[next].bounds), first: next as u32, count: 0 };
}

/// Nodes of a tree over so many boxes at most: tree leaves are of one depth or the one above.
fn most_nodes(boxes: usize) -> usize {
    2 * boxes.div_ceil(LEAF_SIZE).next_power_of_two()
}

/// Adds a subtree that was built by itself.
fn append(nodes: &mut Vec<Node>, subtree: Vec<Node>) {
    let before = nodes.len() as u32;
    nodes.extend(
        subtree.into_iter().map(|node| if node.count == 0 { Node { first: before + node.first, ..node } } else { node }),
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_is_the_nearest() {
        let boxes = scattered();
        let tree = Bvh::new(boxes.clone());
        for k in 0..50 {
            let point = boxes[k * 7].hi * 1.1 - Vec3::new(0.3, 0.2, 0.1);
            let distance = |i: u32| (boxes[i as usize].center() - point).norm_squared();
            let all = (0..boxes.len() as u32).min_by(|&i, &j| distance(i).total_cmp(&distance(j)));
            assert_eq!(tree.nearest(&point, None, distance), all);
            assert!((0..3).all(|guess| tree.nearest(&point, Some(guess), distance) == all));
        }
        assert_eq!(Bvh::new(Vec::new()).nearest(&Vec3::zeros(), None, |_| 0.0), None);
    }

    #[test]
    fn large_trees_built_in_halves_find_all() {
        let boxes: Vec<Aabb> = scattered().into_iter().cycle().take(3 * PARALLEL_FROM).collect();
        let tree = Bvh::new(boxes.clone());
        let query = boxes[7].inflated(0.5);
        let mut found = Vec::new();
        tree.overlapping(&query, |i| found.push(i));
        found.sort_unstable();
        let all: Vec<u32> = (0..boxes.len() as u32).filter(|&i| boxes[i as usize].overlaps(&query)).collect();
        assert!(!all.is_empty() && found == all);
        assert!(tree.nodes.iter().zip(0..).all(|(node, k)| node.count > 0 || node.first > k + 1));
        assert!(tree.nodes.len() > most_nodes(boxes.len()) / 2 && tree.nodes.len() < most_nodes(boxes.len()));
    }

    fn scattered() -> Vec<Aabb> {
        (0..500)
            .map(|k| {
                let f = |m: u64| ((k as u64 * 7919 + m * 104_729) % 1000) as f64 / 100.0;
                let lo = Vec3::new(f(1), f(2), f(3));
                Aabb { lo, hi: lo + Vec3::new(f(4), f(5), f(6)) * 0.1 }
            })
            .collect()
    }

    #[test]
    fn tasks_give_every_overlapping_pair_once() {
        let boxes = scattered();
        let tree = Bvh::new(boxes.clone());
        let mut found = Vec::new();
        for task in tree.pair_tasks(50) {
            tree.overlapping_pairs(task, |a, b| {
                found.push([a.min(b), a.max(b)]);
                ControlFlow::Continue(())
            });
        }
        found.sort_unstable();
        let mut all = Vec::new();
        for a in 0..500 {
            all.extend((a + 1..500).filter(|&b| boxes[a as usize].overlaps(&boxes[b as usize])).map(|b| [a, b]));
        }
        assert!(all.len() > 500);
        assert_eq!(found, all);
    }

    #[test]
    fn finds_what_a_full_search_finds() {
        let boxes = scattered();
        let tree = Bvh::new(boxes.clone());
        for query in boxes.iter().step_by(17) {
            let mut found = Vec::new();
            tree.overlapping(query, |i| found.push(i));
            found.sort_unstable();
            let all: Vec<u32> = (0..500).filter(|&i| boxes[i as usize].overlaps(query)).collect();
            assert_eq!(found, all);
        }
        let (left, right) = (Bvh::new(boxes[..200].to_vec()), Bvh::new(boxes[200..].to_vec()));
        let mut found = Vec::new();
        left.pairs(&right, 0.1003, |i, j| {
            found.push((i.number, j.number));
            ControlFlow::Continue(())
        });
        found.sort_unstable();
        let near = |i: usize, j: usize| boxes[i].inflated(0.1003).overlaps(&boxes[200 + j]);
        let all: Vec<(u32, u32)> = (0..200)
            .flat_map(|i| (0..300).map(move |j| (i, j)))
            .filter(|&(i, j)| near(i, j))
            .map(|(i, j)| (i as u32, j as u32))
            .collect();
        assert_eq!(found, all);
    }
}
