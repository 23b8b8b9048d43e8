//! Axis-parallel boxes.

use super::Vec3;

/// A closed axis-parallel box; empty when `lo > hi`.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Aabb {
    /// Smallest coordinates.
    pub lo: Vec3,
    /// Largest coordinates.
    pub hi: Vec3,
}

impl Default for Aabb {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl Aabb {
    /// The box that holds nothing.
    pub const EMPTY: Self = Self {
        lo: Vec3::new(f64::INFINITY, f64::INFINITY, f64::INFINITY),
        hi: Vec3::new(f64::NEG_INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY),
    };
    /// The smallest box around the points.
    pub fn around<'a>(points: impl IntoIterator<Item = &'a Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| b.with(p))
    }
    /// The smallest box around this one and a point.
    pub fn with(self, p: &Vec3) -> Self {
        Self { lo: smaller(&self.lo, p), hi: larger(&self.hi, p) }
    }
    /// The smallest box around both.
    pub fn union(self, other: &Self) -> Self {
        Self { lo: smaller(&self.lo, &other.lo), hi: larger(&self.hi, &other.hi) }
    }
    /// Whether the closed boxes share a point.
    pub fn overlaps(&self, other: &Self) -> bool {
        // Without branches: boxes that reach this test are apart along any axis, and a processor cannot guess which.
        let along = |k: usize| (self.lo[k] <= other.hi[k]) & (other.lo[k] <= self.hi[k]);
        along(0) & along(1) & along(2)
    }
    /// Whether the distance along every axis is at most `margin`.
    pub fn is_near(&self, other: &Self, margin: f64) -> bool {
        let along = |k: usize| (self.lo[k] - other.hi[k] <= margin) & (other.lo[k] - self.hi[k] <= margin);
        along(0) & along(1) & along(2)
    }
    /// Whether the point is in the closed box.
    pub fn contains(&self, p: &Vec3) -> bool {
        (0..3).all(|k| self.lo[k] <= p[k] && p[k] <= self.hi[k])
    }
    /// The box moved outwards by `margin` on every side.
    pub fn inflated(&self, margin: f64) -> Self {
        let m = Vec3::repeat(margin);
        Self { lo: self.lo - m, hi: self.hi + m }
    }
    /// Length of the diagonal; 0 if empty.
    pub fn diagonal(&self) -> f64 {
        if self.is_empty() { 0.0 } else { (self.hi - self.lo).norm() }
    }
    /// Centre.
    pub fn center(&self) -> Vec3 {
        (self.lo + self.hi) * 0.5
    }
    /// Whether it holds nothing.
    pub fn is_empty(&self) -> bool {
        (0..3).any(|k| self.lo[k] > self.hi[k])
    }
}

/// The smaller coordinates of two points, without what `f64::min` does for NaN, which takes twice the time.
fn smaller(a: &Vec3, b: &Vec3) -> Vec3 {
    a.zip_map(b, |a, b| if b < a { b } else { a })
}

/// The larger coordinates of two points.
fn larger(a: &Vec3, b: &Vec3) -> Vec3 {
    a.zip_map(b, |a, b| if b > a { b } else { a })
}

/// A segment, prepared for tests against many boxes.
#[derive(Clone, Copy, Debug)]
pub struct Segment {
    from: Vec3,
    step: Vec3,
    inverse: Vec3,
    /// Rounding error of a distance along an axis.
    slack: f64,
}

impl Segment {
    /// Between two points, for boxes within `bounds`.
    pub fn new(from: &Vec3, to: &Vec3, bounds: &Aabb) -> Self {
        let step = to - from;
        // A few units in the last place of the largest number involved.
        let size = from.amax() + to.amax() + bounds.lo.amax().max(bounds.hi.amax());
        Self { from: *from, step, inverse: step.map(|d| 1.0 / d), slack: 8.0 * f64::EPSILON * size }
    }
    /// Whether the part up to the parameter `until` (1 is the end) may meet a box: slabs, enlarged by the rounding of the test.
    pub fn may_meet(&self, bounds: &Aabb, until: f64) -> bool {
        let (mut lo, mut hi) = (0.0f64, until);
        for k in 0..3 {
            let (below, above) = (bounds.lo[k] - self.slack - self.from[k], bounds.hi[k] + self.slack - self.from[k]);
            if self.step[k] == 0.0 {
                if below > 0.0 || above < 0.0 {
                    return false;
                }
                continue;
            }
            let (near, far) = if self.step[k] > 0.0 { (below, above) } else { (above, below) };
            let (first, last) = (near * self.inverse[k] - 4.0 * f64::EPSILON, far * self.inverse[k] + 4.0 * f64::EPSILON);
            // Comparisons take half the time of `f64::max`, which looks for NaN.
            lo = if first > lo { first } else { lo };
            hi = if last < hi { last } else { hi };
        }
        lo <= hi
    }
}
