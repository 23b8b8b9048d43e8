//! Cylinders and cones as level curves of triangles (thesis 2.3.3.2), cell by cell.
//!
//! A cell lies between two neighbouring hard angles and two neighbouring hard levels ([`super::levels`]). On its rims stand the
//! breakpoints of the axis; its rows between are free ([`super::rows`]): a cylinder has the same number of chords in each, a
//! cone fewer towards its apex. All is decided in the common sense of the axis and with the common heights and radii, never by
//! where a leaf begins or how it is turned.

use super::division::check_count;
use super::levels::{Level, Levels};
use super::outline::RunArc;
use super::rows::{Column, Columns, Row, Sizing, stitch};
use super::solid::Freedom;
use super::sweep::{Maker, Station, Turn};
use crate::diag::Diagnostic;
use std::f64::consts::TAU;

/// Radii that change by less than this part from level to level make a cylinder.
const STRAIGHT: f64 = 1e-6;

/// Where the points of a ruled surface are.
#[derive(Clone, Copy)]
pub(super) enum Ruling<'a> {
    /// A line, given by its low and its high end in the profile, turned.
    Turned { ends: [[f64; 2]; 2], turn: &'a Turn },
    /// An arc moved from one station to another, the low one first.
    Moved { arc: RunArc, stations: [Station; 2] },
}

/// A ruled surface to be cut.
pub(super) struct Sheet<'a> {
    pub columns: Columns,
    pub ruling: Ruling<'a>,
    pub levels: &'a Levels,
    /// Whether triangles that run along the columns and then upwards must be turned over.
    pub is_flipped: bool,
    pub surface: u32,
}

impl Maker<'_> {
    /// Cuts a ruled surface into triangles; `rim` gives the vertex of a column at the low (0) or the high end (1), `freedom`
    /// that of vertices between them on the first and the last column.
    ///
    /// # Errors
    /// If they are too many.
    pub(super) fn ruled(
        &mut self,
        sheet: &Sheet,
        rim: impl Fn(&mut Self, &Column, usize) -> u32,
        freedom: impl Fn(&Column) -> Freedom,
    ) -> Result<(), Diagnostic> {
        let Sheet { columns, levels: Levels { levels, rows, is_rising, .. }, surface, .. } = sheet;
        check_count(rows.iter().map(|n| f64::from(*n)).sum::<f64>() * 2.0 * columns.len() as f64)?;
        // Gap and number in it of every row but the lowest.
        let all: Vec<(usize, u32)> = rows.iter().enumerate().flat_map(|(gap, &n)| (1..=n).map(move |r| (gap, r))).collect();
        // Vertices between the rims on the first and the last column: a neighbour may have made them.
        let sides = columns.ends().map(|c| (c, [0, 1].map(|end| rim(self, &c, end))));
        let known = sides.map(|(_, rims)| self.shell.cuts(rims));
        let mut made: [Vec<u32>; 2] = Default::default();
        let mut last: Vec<Row> = Vec::new();
        for step in 0..=all.len() {
            let n = if *is_rising { step } else { all.len() - step };
            let row: Vec<Row> = if n == 0 || n == all.len() {
                columns.on_columns(|c| rim(self, c, usize::from(n > 0)))
            } else {
                let (gap, r) = all[n - 1];
                let ends = &levels[gap..gap + 2];
                let at = between([&ends[0], &ends[1]], f64::from(r) / f64::from(rows[gap]));
                let mut on_side = |maker: &mut Self, side: usize| {
                    let (column, _) = &sides[side];
                    let known = known[side].as_ref().and_then(|k| k.get(n - 1).copied());
                    let id = known.unwrap_or_else(|| maker.point(sheet, column.degrees, &at, freedom(column)));
                    made[side].push(id);
                    id
                };
                if r == rows[gap] {
                    let side = |c: &Column| (0..2).find(|&s| !columns.is_closed && c.index == sides[s].0.index);
                    columns.on_columns(|c| match side(c) {
                        Some(side) => on_side(self, side),
                        None => self.point(sheet, c.degrees, &at, Freedom::Surface),
                    })
                } else {
                    let chords = chords_per_degree(sheet.levels.segments, ends, [r, rows[gap]], at.radius);
                    columns.free(chords, r % 2 == 1, |degrees, end| match end {
                        Some(side) => on_side(self, side),
                        None => self.point(sheet, degrees, &at, Freedom::Surface),
                    })
                }
            };
            if step > 0 {
                let (low, high) = if *is_rising { (&last, &row) } else { (&row, &last) };
                stitch(&mut self.shell, *surface, low, high, sheet.is_flipped);
            }
            last = row;
        }
        for ((_, rims), mut made) in sides.into_iter().zip(made) {
            if !*is_rising {
                made.reverse();
            }
            self.shell.cut(rims, made);
        }
        Ok(())
    }

    fn point(&mut self, sheet: &Sheet, degrees: f64, level: &Level, freedom: Freedom) -> u32 {
        let sweep = self.sweep;
        let mix = |a: f64, b: f64| a + (b - a) * level.share;
        let point = match &sheet.ruling {
            Ruling::Turned { ends: [a, b], turn } => {
                let radius = turn.offset + turn.sense * mix(a[0], b[0]);
                sweep.circles[turn.circle].point(degrees, radius, mix(a[1], b[1]))
            }
            Ruling::Moved { arc, stations } => {
                let [a, b] = stations.map(|station| sweep.arc_point(arc, degrees, &station));
                a + (b - a) * level.share
            }
        };
        self.shell.vertex(point, freedom)
    }
}

/// The level at a part of the way between two.
fn between([a, b]: [&Level; 2], part: f64) -> Level {
    let mix = |a: f64, b: f64| if part == 1.0 { b } else { a + (b - a) * part };
    Level { share: mix(a.share, b.share), height: mix(a.height, b.height), radius: mix(a.radius, b.radius) }
}

/// Chords of a row between two levels; none if they are those of the rims, as on a cylinder.
fn chords_per_degree(segments: f64, ends: &[Level], [r, rows]: [u32; 2], radius: f64) -> Option<f64> {
    let (a, b) = (&ends[0], &ends[1]);
    let largest = a.radius.max(b.radius);
    if (a.radius - b.radius).abs() <= STRAIGHT * largest {
        return None;
    }
    let length = libm::hypot(b.height - a.height, b.radius - a.radius);
    let height = length / f64::from(rows);
    let sizing = Sizing { height, chord: TAU * largest / segments, radius: largest };
    let chord = sizing.chord_at(radius, (b.height - a.height) / length, f64::from(r.min(rows - r)) * height);
    Some((radius / chord).to_radians())
}
