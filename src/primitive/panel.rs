//! Doubly curved panels as level curves of triangles (thesis 2.3.3.2): an arc of the profile along an arc of the motion, with
//! rows at the vertices of the profile. Rows on a rim and at hard vertices use the stations, so that neighbours, and leaves
//! with only a part of the arc, share them; rows between are free ([`super::rows`]): a torus has fewer chords per row towards
//! its axis.

use super::division::check_count;
use super::outline::{Outline, Run, RunArc};
use super::rows::{Column, Columns, Row, Sizing, stitch, strips};
use super::solid::Freedom;
use super::sweep::{Maker, Piece, Station, Turn};
use crate::diag::Diagnostic;
use crate::geom::plane::distance;
use std::f64::consts::TAU;

/// Chords longer than rows are high by this factor have thin triangles beside them: 27 degrees, where the apex is over an end.
const FLATTEST: f64 = 2.0;
/// Panels with more than this part of their width so near to rims that chords are longer than that, fillets mostly, stay planar
/// strips.
const NARROW: f64 = 0.5;

impl Turn {
    /// The breakpoints of its piece, in the order of the axis' degrees.
    pub fn columns(&self, piece: &Piece, sense: f64) -> Columns {
        let is_closed = piece.last - piece.first == self.breakpoints.len();
        let column = |(k, b): (usize, &super::circle::Breakpoint)| Column {
            degrees: b.degrees,
            is_hard: b.is_hard,
            index: piece.first + k,
        };
        Columns::new(self.breakpoints.iter().enumerate().map(column).collect(), is_closed, self.direction != sense, sense)
    }
}

impl Maker<'_> {
    /// Cuts what an arc of the profile sweeps along an arc of the motion into triangles.
    ///
    /// # Errors
    /// If they are too many.
    pub(super) fn turned_arc(
        &mut self,
        l: usize,
        (run, arc): (&Run, &RunArc),
        (piece, turn): (&Piece, &Turn),
        surface: u32,
    ) -> Result<(), Diagnostic> {
        let outline = &self.sweep.loops[l];
        let n = outline.vertices.len();
        let is_closed = run.count == n;
        let is_inner =
            |i: &usize| outline.vertices[i % n].is_hard && (is_closed || (*i != run.first && *i != run.first + run.count));
        let mut hard: Vec<usize> = (run.first..run.first + run.count).filter(is_inner).collect();
        if is_closed {
            hard.extend(hard.first().map(|i| i + n));
        } else {
            hard.insert(0, run.first);
            hard.push(run.first + run.count);
        }
        if hard.is_empty() {
            return self.turned_cell(l, (run, arc), [run.first, run.first + n], (piece, turn), surface);
        }
        hard.windows(2).try_for_each(|ends| self.turned_cell(l, (run, arc), [ends[0], ends[1]], (piece, turn), surface))
    }

    /// A cell between two hard vertices of the profile; all of a circle without any if they are the same.
    fn turned_cell(
        &mut self,
        l: usize,
        (run, arc): (&Run, &RunArc),
        [from, to]: [usize; 2],
        (piece, turn): (&Piece, &Turn),
        surface: u32,
    ) -> Result<(), Diagnostic> {
        let sweep = self.sweep;
        let outline = &sweep.loops[l];
        let n = outline.vertices.len();
        let radius = |i: usize| (turn.offset + turn.sense * outline.vertices[i % n].xy[0]).abs();
        let largest = (from..=to).map(radius).fold(0.0, f64::max);
        let [a, b] = [from, from + 1].map(|i| outline.vertices[i % n].xy);
        let segments = f64::from(sweep.circles[turn.circle].segments);
        let sizing = Sizing { height: distance(a, b), chord: TAU * largest / segments, radius: largest };
        let is_ring = to - from == n && !outline.vertices[from % n].is_hard;
        let chords = |i: usize| {
            let rows = (i - from).min(to - i) as f64;
            let from_rim = if is_ring { f64::INFINITY } else { rows * sizing.height };
            sizing.chord_at(radius(i), sine_of_normal(outline, run, i), from_rim)
        };
        let columns = turn.columns(piece, 1.0);
        let length = |i: usize| columns.sweep().to_radians() * radius(i);
        // A vertex on the axis is one vertex, with no row of chords.
        let row = |i: usize| if radius(i) > 0.0 { 2.0 * length(i) / chords(i) } else { 0.0 };
        check_count((from..to).map(row).sum())?;
        // Rows in the sense that is counter-clockwise in the half plane of the axis, whatever the leaf's.
        let circle = &sweep.circles[turn.circle];
        let is_rising = arc.is_ccw == ((circle.place.axes[2].dot(&circle.axis.z) > 0.0) == (turn.sense > 0.0));
        let is_flipped = is_rising != (turn.direction > 0.0);
        let is_flat = |i: &usize| !is_ring && chords(*i) > FLATTEST * sizing.height;
        let is_narrow = (from..=to).filter(is_flat).count() as f64 > NARROW * (to - from + 1) as f64;
        let mut below: Vec<Row> = Vec::new();
        let mut first: Vec<Row> = Vec::new();
        for r in 0..=to - from {
            let i = if is_rising { from + r } else { to - r };
            let is_end = r == 0 || r == to - from;
            let row = if is_ring && r == to - from {
                std::mem::take(&mut first)
            } else if is_narrow || (is_end && !is_ring) {
                columns.on_columns(|c| self.vertex(l, i, c.index))
            } else {
                self.free_row(l, i, (piece, turn), &columns, radius(i) / chords(i), r % 2 == 1)
            };
            if r == 0 {
                first.clone_from(&row);
            } else if is_narrow {
                strips(&mut self.shell, surface, &below, &row, is_flipped);
            } else {
                stitch(&mut self.shell, surface, &below, &row, is_flipped);
            }
            below = row;
        }
        Ok(())
    }

    /// A row between rims: each sector in equal chords, about `per_radian` chords per radian.
    fn free_row(
        &mut self,
        l: usize,
        i: usize,
        (piece, turn): (&Piece, &Turn),
        columns: &Columns,
        per_radian: f64,
        is_shifted: bool,
    ) -> Vec<Row> {
        let sweep = self.sweep;
        let profile = sweep.loops[l].vertices[i % sweep.loops[l].vertices.len()];
        if sweep.has_axis && profile.xy[0] == 0.0 {
            let pole = self.vertex(l, i, piece.first);
            return columns.on_columns(|_| pole);
        }
        let ends = columns.ends();
        columns.free(Some(per_radian.to_radians()), is_shifted, |degrees, end| match end {
            Some(end) => self.vertex(l, i, ends[end].index),
            None => {
                let station = Station::OnCircle { circle: turn.circle, degrees, offset: turn.offset, sense: turn.sense };
                self.shell.vertex(sweep.point(&profile, &station), Freedom::Surface)
            }
        })
    }
}

/// Sine of the angle between a swept surface's normal and the axis.
fn sine_of_normal(outline: &Outline, run: &Run, vertex: usize) -> f64 {
    outline.direction(run, vertex)[1].abs()
}
