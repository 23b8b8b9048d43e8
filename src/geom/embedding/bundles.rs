//! Pairs of long thin things beside each other, of which boxes parallel to the axes tell nothing: segments in rows, triangles
//! of a fan.
//!
//! Each thing lies in the hull of two boxes, for a segment its two ends. A [`Bundle`] holds things whose first boxes lie near
//! each other and whose second boxes do, so that the hull of all is as thin as the things themselves; a plane between two such
//! hulls separates all their things. Coordinates are only compared with a margin for rounding, so no pair that meets is lost.

use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use std::ops::{ControlFlow, Range};

/// Things that a bundle is not divided further for.
const FEW: usize = 4;

/// What rounding may do to a projection, over the sum of its terms' magnitudes: twelve operations, and a little more.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// A long thin thing.
#[derive(Clone, Copy)]
pub(super) struct Thing {
    /// In the hull of both it lies.
    pub ends: [Aabb; 2],
    /// The vertex that is its first end, where meeting others that begin there is no fault.
    pub hub: Option<u32>,
}

/// A set of things and its halves.
struct Bundle {
    ends: [Aabb; 2],
    /// The vertex at which all its things begin.
    hub: Option<u32>,
    /// Its things, in `Bundles::order`.
    range: Range<usize>,
    /// The second half; the first is the next bundle.
    second: Option<usize>,
}

/// A tree of bundles.
pub(super) struct Bundles {
    order: Vec<u32>,
    tree: Vec<Bundle>,
}

impl Bundles {
    /// The tree over things. Cost: O(n log² n).
    pub fn new(things: &[Thing]) -> Self {
        let mut bundles = Self { order: (0..things.len() as u32).collect(), tree: Vec::new() };
        if !things.is_empty() {
            bundles.divide(things, 0..things.len());
        }
        bundles
    }

    fn divide(&mut self, things: &[Thing], range: Range<usize>) -> usize {
        let mine = &mut self.order[range.clone()];
        let first = things[mine[0] as usize];
        let ends = mine.iter().fold(first.ends, |[p, q], &t| {
            let [r, s] = &things[t as usize].ends;
            [p.union(r), q.union(s)]
        });
        let hub = first.hub.filter(|_| mine.iter().all(|&t| things[t as usize].hub == first.hub));
        let index = self.tree.len();
        self.tree.push(Bundle { ends, hub, range: range.clone(), second: None });
        if mine.len() > FEW {
            let sizes = ends.map(|b| b.hi - b.lo);
            let (end, axis) = [0, 1]
                .map(|e| (e, sizes[e].imax()))
                .into_iter()
                .fold((0, 0), |best, (e, k)| if sizes[e][k] > sizes[best.0][best.1] { (e, k) } else { best });
            let middle = |t: &u32| {
                let at = &things[*t as usize].ends[end];
                at.lo[axis] + at.hi[axis]
            };
            mine.sort_by(|s, t| middle(s).total_cmp(&middle(t)).then(s.cmp(t)));
            let half = range.start + range.len() / 2;
            self.divide(things, range.start..half);
            self.tree[index].second = Some(self.divide(things, half..range.end));
        }
        index
    }

    /// Visits every pair of things that may meet elsewhere than in a common hub, once, until the visitor breaks off. The order
    /// depends on the things only.
    pub fn pairs(&self, mut visit: impl FnMut(u32, u32) -> ControlFlow<()>) {
        let mut stack: Vec<[usize; 2]> = if self.tree.is_empty() { Vec::new() } else { vec![[0, 0]] };
        while let Some([a, b]) = stack.pop() {
            let (one, other) = (&self.tree[a], &self.tree[b]);
            if a != b && one.is_apart(other) {
                continue;
            }
            match (one.second, other.second) {
                (Some(second), _) if a == b => stack.extend([[a + 1, a + 1], [second, second], [a + 1, second]]),
                (Some(second), None) => stack.extend([[a + 1, b], [second, b]]),
                (Some(second), Some(_)) if one.width() >= other.width() => stack.extend([[a + 1, b], [second, b]]),
                (_, Some(second)) => stack.extend([[a, b + 1], [a, second]]),
                (None, None) => {
                    for i in one.range.clone() {
                        for j in if a == b { i + 1..one.range.end } else { other.range.clone() } {
                            if visit(self.order[i], self.order[j]).is_break() {
                                return;
                            }
                        }
                    }
                }
            }
        }
    }
}

impl Bundle {
    /// Largest extent of one of its ends.
    fn width(&self) -> f64 {
        self.ends.iter().map(|b| (b.hi - b.lo).max()).fold(0.0, f64::max)
    }

    /// Whether a plane is found between the two, or one through their common hub with the other ends on its two sides.
    fn is_apart(&self, other: &Self) -> bool {
        let [[p, q], [r, s]] = [self, other].map(|b| b.ends.map(|e| (e.lo + e.hi) * 0.5));
        let unit = |v: Vec3| v.try_normalize(0.0).unwrap_or_default();
        let (along, across, way) = (unit(q - p), unit(s - r), ((r + s) - (p + q)) * 0.5);
        if self.hub.is_some() && self.hub == other.hub {
            let beyond = |n: Vec3| {
                let [[_, low], [high, _]] = [other, self].map(|b| range(&b.ends[1..], p, n));
                low < 0.0 && 0.0 < high
            };
            return [along - across, along.cross(&across).cross(&(along + across))].into_iter().any(beyond);
        }
        let between = |n: Vec3| {
            let [[a, b], [c, d]] = [self, other].map(|x| range(&x.ends, p, n));
            b < c || d < a
        };
        let square_to = |d: Vec3| unit(way) - d * d.dot(&unit(way));
        let slanted = || [square_to(along), square_to(across), along.cross(&across), along.cross(&way)];
        [Vec3::x(), Vec3::y(), Vec3::z()].into_iter().any(between) || slanted().into_iter().any(between)
    }
}

/// Least and largest height over the plane through `origin` with normal `n`, of boxes, with a margin for rounding.
fn range(boxes: &[Aabb], origin: Vec3, n: Vec3) -> [f64; 2] {
    let size = n.abs();
    boxes.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], b| {
        let (middle, half) = ((b.lo + b.hi) * 0.5, (b.hi - b.lo) * 0.5);
        let margin = ROUNDING * size.dot(&(b.lo.abs().sup(&b.hi.abs()) + origin.abs()));
        let (height, reach) = (n.dot(&(middle - origin)), size.dot(&half) + margin);
        [low.min(height - reach), high.max(height + reach)]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(count: u32, end: impl Fn(f64) -> [Vec3; 2]) -> Vec<Thing> {
        (0..count).map(|k| Thing { ends: end(f64::from(k)).map(|p| Aabb::around([&p])), hub: None }).collect()
    }

    fn visited(things: &[Thing]) -> Vec<[u32; 2]> {
        let mut pairs = Vec::new();
        Bundles::new(things).pairs(|i, j| {
            pairs.push([i.min(j), i.max(j)]);
            ControlFlow::Continue(())
        });
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
        .map(|thing| Thing { hub: Some(7), ..thing })
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
