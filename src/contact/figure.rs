//! Planar figures of many sides, seen along a coordinate axis.

use crate::geom::lists::Lists;
use crate::geom::predicates::orient2d;

type Point = [f64; 2];

/// Corners from which on a facet is searched by a figure: most have three or four, and need no more than their loops.
pub(super) const MANY: usize = 12;

/// The sides of a figure by rows across the second axis, so that few are looked at for one height.
#[derive(Clone, Debug)]
pub(super) struct Figure {
    /// Height at which the rows begin, and their number over the height of all.
    origin: f64,
    scale: f64,
    rows: Lists<[Point; 2]>,
}

impl Figure {
    /// Of the sides of closed loops. O(n).
    pub fn new(sides: Vec<[Point; 2]>) -> Self {
        let heights = || sides.iter().flatten().map(|p| p[1]);
        let (lo, hi) = heights().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), y| (lo.min(y), hi.max(y)));
        // Where many sides pass every height there are fewer rows, so that there are only a few entries for each side.
        let passing = sides.iter().map(|[a, b]| (a[1] - b[1]).abs()).sum::<f64>() / (hi - lo);
        let count = (sides.len() as f64 / passing.max(1.0)).ceil();
        let mut figure = Self { origin: lo, scale: count / (hi - lo), rows: Lists::default() };
        let spans = sides.iter().flat_map(|side| {
            let [a, b] = side.map(|p| figure.row(p[1]));
            (a.min(b)..=a.max(b)).map(move |row| (row, *side))
        });
        figure.rows = Lists::from_iter(count as usize + 1, spans);
        figure
    }
    /// The row of a height; that of a higher one is none below.
    fn row(&self, y: f64) -> u32 {
        ((y - self.origin) * self.scale) as u32
    }
    /// The rows between two heights; none if those are beyond all.
    fn rows_between(&self, lo: f64, hi: f64) -> std::ops::Range<u32> {
        self.row(lo)..(self.rows.count() as u32).min(self.row(hi).saturating_add(1))
    }
    /// Whether a place that is on no side lies inside.
    pub fn encloses(&self, q: Point) -> bool {
        self.rows_between(q[1], q[1]).any(|row| is_enclosed(q, self.rows.of(row).iter().copied()))
    }
    /// Whether a rectangle overlaps the one around a side.
    pub fn has_side_near(&self, lo: Point, hi: Point) -> bool {
        let along = |[a, b]: &[Point; 2], k: usize| (a[k].min(b[k]) <= hi[k]) & (a[k].max(b[k]) >= lo[k]);
        let is_near = |side: &[Point; 2]| along(side, 0) & along(side, 1);
        self.rows_between(lo[1], hi[1]).any(|row| self.rows.of(row).iter().any(is_near))
    }
    /// Whether a rectangle may have a place in common with the figure: away from all sides it is inside or outside as a whole.
    pub fn may_meet(&self, lo: Point, hi: Point) -> bool {
        self.has_side_near(lo, hi) || self.encloses(lo)
    }
}

/// Whether a place that is on no side lies inside: the sides that a ray from it along the first axis crosses.
pub(super) fn is_enclosed(q: Point, sides: impl Iterator<Item = [Point; 2]>) -> bool {
    let is_crossed = |[a, b]: &[Point; 2]| (a[1] > q[1]) != (b[1] > q[1]) && (orient2d(*a, *b, q) > 0) == (b[1] > a[1]);
    sides.filter(is_crossed).count() % 2 == 1
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A comb of two teeth, whose sides pass nearly every height, about a rectangle for a hole.
    fn comb() -> Vec<[Point; 2]> {
        let walk = |places: &[Point]| {
            let next = places.iter().cycle().skip(1);
            places.iter().zip(next).map(|(a, b)| [*a, *b]).collect::<Vec<_>>()
        };
        let rim = [[0., 0.], [5., 0.], [5., 9.], [3., 9.], [3., 3.], [2., 3.], [2., 9.], [0., 9.]];
        [walk(&rim), walk(&[[1., 1.], [1., 2.], [4., 2.], [4., 1.]])].concat()
    }

    #[test]
    fn a_figure_encloses_what_its_sides_do() {
        // The second comb has teeth of all heights, which few rows have in common.
        let teeth = crate::contact::outline::tests::comb(40);
        let ends = teeth.iter().zip(teeth.iter().cycle().skip(1));
        for (sides, width) in [(comb(), 6.0), (ends.map(|(a, b)| [[a.x, a.y], [b.x, b.y]]).collect(), 40.0)] {
            let figure = Figure::new(sides.clone());
            let steps = (width * 10.0) as i32;
            let mut inside = 0;
            for (x, y) in (-1..steps).flat_map(|x| (-13..140).map(move |y| (x, y))) {
                let q = [f64::from(x) * 0.1 + 0.03, f64::from(y) * 0.1 + 0.04];
                assert_eq!(figure.encloses(q), is_enclosed(q, sides.iter().copied()), "{q:?}");
                inside += u32::from(figure.encloses(q));
            }
            assert!(inside > 1000);
        }
    }

    #[test]
    fn rectangles_between_teeth_and_in_the_hole_are_apart() {
        let figure = Figure::new(comb());
        let meets = |lo: Point, hi: Point| figure.may_meet(lo, hi);
        assert!(meets([0.2, 4.], [0.8, 8.]) && meets([1.5, 4.], [2.5, 8.]) && meets([-1., -1.], [6., 10.]));
        assert!(!meets([2.2, 4.], [2.8, 8.]) && !meets([1.8, 1.2], [2.2, 1.3]) && !meets([6., 0.], [7., 9.]));
        assert!(!meets([2.2, 9.5], [2.8, 12.]) && !meets([2.2, -3.], [2.8, -2.]) && meets([1., -3.], [2., 0.]));
    }
}
