//! Rows of vertices along the breakpoints of an axis, and the triangles between two rows.
//!
//! A *sector* reaches from one hard breakpoint to the next. Rows on a rim use its breakpoints; rows between are free: every
//! second one is shifted by half a chord, and their number of chords follows their length, so that triangles stay near 60
//! degrees. Every sector is divided and stitched on its own, in an order that is the axis', not the leaf's: leaves that have it
//! in common have its triangles in common.

use super::angle;
use super::shell::Shell;

/// Chords may be this much longer than rows are high: angles are then 53 and 74 degrees where rows are in step, and 34 at worst
/// where they are not.
const STRETCH: f64 = 1.5;
/// How fast chords may shrink with the distance from a rim, whose division is given.
const GRADING: f64 = 0.5;
/// A number of chords that is whole but for rounding is whole.
const WHOLE: f64 = 1.0 - 1e-9;

/// The vertices of a row in one sector, with their part of the way through it, rising.
pub(super) type Row = Vec<(f64, u32)>;

/// A breakpoint of a panel.
#[derive(Clone, Copy)]
pub(super) struct Column {
    /// The axis' degrees.
    pub degrees: f64,
    pub is_hard: bool,
    /// Which station or which vertex of the profile it is.
    pub index: usize,
}

/// The breakpoints of a panel in the axis' order.
pub(super) struct Columns {
    /// If they go all round, the first stands again at the end.
    all: Vec<Column>,
    pub is_closed: bool,
    /// +1 if degrees rise along them, else -1.
    sense: f64,
    sectors: Vec<Sector>,
}

/// Columns from one hard one to the next.
struct Sector {
    first: usize,
    last: usize,
    /// Degrees.
    sweep: f64,
    /// Whether it is a whole turn without a hard column.
    is_ring: bool,
}

impl Columns {
    /// From the columns in either order. Those of a closed panel, each given once, begin at the hard one of the least degrees.
    pub fn new(mut all: Vec<Column>, is_closed: bool, is_reversed: bool, sense: f64) -> Self {
        if is_reversed {
            all.reverse();
        }
        if is_closed {
            let first = (0..all.len())
                .min_by(|&a, &b| (!all[a].is_hard).cmp(&!all[b].is_hard).then(all[a].degrees.total_cmp(&all[b].degrees)));
            all.rotate_left(first.unwrap_or(0));
            all.extend(all.first().copied());
        }
        let last = all.len() - 1;
        let hard: Vec<usize> = (0..=last).filter(|&c| c == 0 || c == last || all[c].is_hard).collect();
        let is_ring = is_closed && hard.len() == 2 && !all[0].is_hard;
        let sweep = |w: &[usize]| match angle::canonical(sense * (all[w[1]].degrees - all[w[0]].degrees)) {
            0.0 => 360.0,
            sweep => sweep,
        };
        let sectors = hard.windows(2).map(|w| Sector { first: w[0], last: w[1], sweep: sweep(w), is_ring }).collect();
        Self { all, is_closed, sense, sectors }
    }

    /// The first and the last column.
    pub fn ends(&self) -> [Column; 2] {
        [self.all[0], self.all[self.all.len() - 1]]
    }

    /// Number of columns.
    pub fn len(&self) -> usize {
        self.all.len()
    }

    /// Degrees from the first to the last.
    pub fn sweep(&self) -> f64 {
        self.sectors.iter().map(|s| s.sweep).sum()
    }

    /// A row with a vertex on every column; a single one if all are the same, as at an apex.
    pub fn on_columns(&self, mut vertex: impl FnMut(&Column) -> u32) -> Vec<Row> {
        let mut ids: Vec<u32> = self.all[..self.all.len() - 1].iter().map(&mut vertex).collect();
        ids.push(if self.is_closed { ids[0] } else { vertex(&self.all[self.all.len() - 1]) });
        let row = |s: &Sector| {
            let parts = (s.last - s.first) as f64;
            (s.first..=s.last).map(|c| ((c - s.first) as f64 / parts, ids[c])).collect()
        };
        if ids[0] == ids[1] {
            return self.sectors.iter().map(|_| vec![(0.0, ids[0])]).collect();
        }
        self.sectors.iter().map(row).collect()
    }

    /// A free row of about so many chords per degree, or as many as there are columns. `vertex` makes the vertex at the axis'
    /// degrees; it is told if that is on the first (0) or the last column (1) of those that are not closed.
    pub fn free(&self, chords: Option<f64>, is_shifted: bool, mut vertex: impl FnMut(f64, Option<usize>) -> u32) -> Vec<Row> {
        let shift = if is_shifted { 0.5 } else { 0.0 };
        let is_open = !self.is_closed;
        let mut rows: Vec<Row> = Vec::with_capacity(self.sectors.len());
        for (s, sector) in self.sectors.iter().enumerate() {
            let from = self.all[sector.first].degrees;
            let least = if sector.is_ring { 3.0 } else { 1.0 };
            let parts = match chords {
                Some(chords) => (sector.sweep * chords * WHOLE).ceil().max(least),
                None => (sector.last - sector.first) as f64,
            };
            let mut row = Row::new();
            if !sector.is_ring {
                let before = rows.last().and_then(|r| r.last()).map(|v| v.1);
                row.push((0.0, before.unwrap_or_else(|| vertex(from, is_open.then_some(0)))));
            }
            // The first point of an unshifted row is the sector's beginning, pushed above.
            for q in u32::from(!is_shifted && !sector.is_ring)..parts as u32 {
                let along = f64::from(q) + shift;
                let degrees = angle::canonical(from + self.sense * (sector.sweep / parts * along));
                row.push((along / parts, vertex(degrees, None)));
            }
            let is_last = s + 1 == self.sectors.len();
            if sector.is_ring {
                row.push((row[0].0 + 1.0, row[0].1));
            } else if is_last && self.is_closed {
                let first = rows.first().unwrap_or(&row)[0].1;
                row.push((1.0, first));
            } else {
                row.push((1.0, vertex(self.all[sector.last].degrees, is_last.then_some(1))));
            }
            rows.push(row);
        }
        rows
    }
}

/// Largest chords wanted in a panel.
pub(super) struct Sizing {
    /// Height of the rows.
    pub height: f64,
    /// Chord of the wanted division at the largest radius.
    pub chord: f64,
    /// That radius.
    pub radius: f64,
}

impl Sizing {
    /// Chord at a radius where the surface's normal is inclined to the axis (sine of the angle), at a distance from the rim.
    /// The deviation of a chord goes with its square times the curvature, sine / radius.
    pub fn chord_at(&self, radius: f64, sine: f64, from_rim: f64) -> f64 {
        let same_error = self.chord * (radius / (self.radius * sine.max(1e-3))).sqrt();
        same_error.min(STRETCH * self.height).max(self.chord - GRADING * from_rim)
    }
}

/// Triangles between two rows, sector by sector: along `below`, then to `above`, unless they are to be turned over.
pub(super) fn stitch(shell: &mut Shell, surface: u32, below: &[Row], above: &[Row], is_flipped: bool) {
    for (below, above) in below.iter().zip(above) {
        let (mut i, mut j) = (0, 0);
        while i + 1 < below.len() || j + 1 < above.len() {
            // The side whose next edge has its middle first goes on.
            let middle = |row: &Row, k: usize| row.get(k + 1).map_or(f64::INFINITY, |next| row[k].0 + next.0);
            let triangle = if middle(below, i) <= middle(above, j) {
                i += 1;
                let (a, b) = (below[i - 1].1, below[i].1);
                if is_flipped { vec![b, a, above[j].1] } else { vec![a, b, above[j].1] }
            } else {
                j += 1;
                let (a, b) = (above[j - 1].1, above[j].1);
                if is_flipped { vec![a, b, below[i].1] } else { vec![b, a, below[i].1] }
            };
            shell.facet(surface, vec![triangle]);
        }
    }
}

/// Planar strips between two rows that stand on the same columns; triangles at a pole.
pub(super) fn strips(shell: &mut Shell, surface: u32, below: &[Row], above: &[Row], is_flipped: bool) {
    for (below, above) in below.iter().zip(above) {
        for k in 1..below.len().max(above.len()) {
            let edge = |row: &Row| [k - 1, k].map(|k| row.get(k).unwrap_or(&row[0]).1);
            let ([a, b], [d, c]) = (edge(below), edge(above));
            let mut corners = if is_flipped { vec![d, c, b, a] } else { vec![a, b, c, d] };
            corners.dedup();
            shell.facet(surface, vec![corners]);
        }
    }
}
