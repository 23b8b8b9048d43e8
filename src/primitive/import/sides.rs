//! The sides of polygons, by edges.

use super::Surface;
use crate::geom::lists::Lists;

/// A side of a polygon, at the lower end of its edge.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Debug)]
pub(super) struct Side {
    /// The upper end.
    upper: u32,
    /// Twice the polygon, plus one if it runs upwards.
    code: u32,
}

impl Side {
    pub fn polygon(self) -> u32 {
        self.code / 2
    }
    pub fn is_upwards(self) -> bool {
        self.code % 2 == 1
    }
}

/// The ends of an edge, lower first, and all sides there, by polygon.
pub(super) type Edge<'a> = ([u32; 2], &'a [Side]);

/// All sides, by the lower ends of their edges and then the upper ones.
pub(super) struct Sides(Lists<Side>);

impl Sides {
    /// O(n log n).
    pub fn new(surface: &Surface) -> Self {
        let walks = || surface.polygons.iter().zip(0u32..);
        let all = walks().flat_map(|(walk, polygon)| {
            let ends = (0..walk.len()).map(|k| (walk[k], walk[if k + 1 < walk.len() { k + 1 } else { 0 }]));
            ends.map(move |(a, b)| (a.min(b), Side { upper: a.max(b), code: 2 * polygon + u32::from(a < b) }))
        });
        let mut lists = Lists::from_iter(surface.points.len(), all);
        (0..lists.count() as u32).for_each(|v| lists.of_mut(v).sort_unstable());
        Self(lists)
    }

    /// All edges in the order of their ends.
    pub fn edges(&self) -> impl Iterator<Item = Edge<'_>> {
        self.0
            .iter()
            .zip(0u32..)
            .flat_map(|(list, lower)| list.chunk_by(|a, b| a.upper == b.upper).map(move |same| ([lower, same[0].upper], same)))
    }
}

/// Whether the directions of the sides at an edge are not matched.
pub(super) fn is_open((_, sides): &Edge) -> bool {
    2 * sides.iter().filter(|s| s.is_upwards()).count() != sides.len()
}
