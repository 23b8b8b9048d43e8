//! Curved panels as level curves of triangles (thesis 2.3.3.2): rows of vertices, each row divided on its own, stitched.
//!
//! Rows on a rim use the stations, so that neighbours share them. Rows between are free: every second one is shifted by half
//! a chord, and their number of chords follows their length, so that triangles stay near 60 degrees (a cone has fewer per row
//! towards its apex, a torus towards its axis). Hard breakpoints are kept in every row: a partial sweep of the same surface
//! has the same triangles.

use super::angle;
use super::division::check_count;
use super::outline::{OnCircle, Outline, OutlineVertex, Run};
use super::solid::Freedom;
use super::sweep::{Maker, Piece, Station, Turn};
use crate::diag::Diagnostic;
use std::f64::consts::TAU;

/// Chords may be this much longer than rows are high: angles are then 53 and 74 degrees where rows are in step, and 34 at worst
/// where they are not.
const STRETCH: f64 = 1.5;
/// Height of an equilateral triangle over its side.
pub(crate) const ROW_PER_CHORD: f64 = 0.866;
/// How fast chords may shrink with the distance from a rim, whose division is given.
const GRADING: f64 = 0.5;

/// Number of rows of about the given height: even, so that shifted rows lie between rims that are not, or one.
pub(crate) fn rows(length: f64, height: f64) -> f64 {
    let rows = length / height;
    if rows < 1.5 { 1.0 } else { 2.0 * (rows * 0.5).round() }
}

/// A row: vertices with their position along it, rising.
type Row = Vec<(f64, u32)>;

/// Largest chords wanted in a panel.
struct Sizing {
    /// Length of the profile's edges.
    height: f64,
    /// Chord of the wanted division at the largest radius.
    chord: f64,
    /// That radius.
    radius: f64,
}

impl Sizing {
    /// Chord at a radius where the surface's normal is inclined to the axis (sine of the angle), at a distance from the rim.
    /// The deviation of a chord goes with its square times the curvature, sine / radius.
    fn chord_at(&self, radius: f64, sine: f64, from_rim: f64) -> f64 {
        let same_error = self.chord * (radius / (self.radius * sine.max(1e-3))).sqrt();
        same_error.min(STRETCH * self.height).max(self.chord - GRADING * from_rim)
    }
}

impl Maker<'_> {
    /// A run along an arc of the motion as rows at its vertices.
    pub(super) fn turned_panel(
        &mut self,
        l: usize,
        run: &Run,
        piece: &Piece,
        turn: &Turn,
        surface: u32,
    ) -> Result<(), Diagnostic> {
        let sweep = self.sweep;
        let outline = &sweep.loops[l];
        let n = outline.vertices.len();
        let radius = |i: usize| (turn.offset + turn.sense * outline.vertices[i % n].xy[0]).abs();
        let largest = (run.first..=run.first + run.count).map(radius).fold(0.0, f64::max);
        let [a, b] = [run.first, run.first + 1].map(|i| outline.vertices[i % n].xy);
        let segments = f64::from(sweep.circles[turn.circle].segments);
        let sizing = Sizing { height: super::outline::distance(a, b), chord: TAU * largest / segments, radius: largest };
        let is_ring = run.count == n;
        let chords = |i: usize| {
            let rows = (i - run.first).min(run.first + run.count - i) as f64;
            let from_rim = if is_ring { f64::INFINITY } else { rows * sizing.height };
            sizing.chord_at(radius(i), sine_of_normal(outline, run, i), from_rim)
        };
        let sectors = sectors(piece, turn);
        let length = |i: usize| sectors.iter().map(|s| s.sweep).sum::<f64>().to_radians() * radius(i);
        check_count((run.first..run.first + run.count).map(|i| 2.0 * length(i) / chords(i)).sum())?;
        let mut below = Row::new();
        let mut first = Row::new();
        for i in run.first..=run.first + run.count {
            let row = if i == run.first + run.count && is_ring {
                std::mem::take(&mut first)
            } else if !is_ring && (i == run.first || i == run.first + run.count) {
                self.rim_row(l, i, piece, turn)
            } else {
                self.free_row(l, i, piece, turn, &sectors, radius(i) / chords(i), (i - run.first) % 2 == 1)
            };
            if i == run.first {
                first.clone_from(&row);
            } else {
                self.stitch(surface, &below, &row, false);
            }
            below = row;
        }
        Ok(())
    }

    fn rim_row(&mut self, l: usize, i: usize, piece: &Piece, turn: &Turn) -> Row {
        let id = self.vertex(l, i, piece.first);
        if id == self.vertex(l, i, piece.first + 1) {
            return vec![(0.0, id)];
        }
        (piece.first..=piece.last).map(|k| (along(piece, turn, k), self.vertex(l, i, k))).collect()
    }

    /// A row between rims: each sector in equal chords, about `per_radian` chords per radian.
    #[allow(clippy::too_many_arguments)]
    fn free_row(
        &mut self,
        l: usize,
        i: usize,
        piece: &Piece,
        turn: &Turn,
        sectors: &[Sector],
        per_radian: f64,
        is_shifted: bool,
    ) -> Row {
        let sweep = self.sweep;
        let profile = sweep.loops[l].vertices[i % sweep.loops[l].vertices.len()];
        if sweep.has_axis && profile.xy[0] == 0.0 {
            return vec![(0.0, self.vertex(l, i, 0))];
        }
        let mut row = Row::new();
        for sector in sectors {
            let parts =
                (sector.sweep.to_radians() * per_radian * (1.0 - 1e-9)).ceil().max(if sector.is_ring { 3.0 } else { 1.0 });
            let width = sector.sweep / parts;
            let from = turn.breakpoints[sector.station - piece.first];
            if !sector.is_ring {
                row.push((from.along, self.vertex(l, i, sector.station)));
            }
            // The first point of an unshifted row is the sector's beginning, pushed above.
            for q in u32::from(!is_shifted && !sector.is_ring)..parts as u32 {
                let by = width * (f64::from(q) + if is_shifted { 0.5 } else { 0.0 });
                let degrees = angle::canonical(from.degrees + turn.direction * by);
                let station = Station::OnCircle { circle: turn.circle, degrees, offset: turn.offset, sense: turn.sense };
                row.push((from.along + by, self.shell.vertex(sweep.point(&profile, &station), Freedom::Surface)));
            }
        }
        let is_closed = piece.last - piece.first == turn.breakpoints.len();
        match row.first() {
            Some(&(t, id)) if is_closed => row.push((t + 360.0, id)),
            _ => {
                let end = self.vertex(l, i, piece.last);
                row.push((along(piece, turn, piece.last), end));
            }
        }
        row
    }

    /// Triangles between two rows. Seen from outside, `below` runs to the right of `above` unless `is_flipped`.
    fn stitch(&mut self, surface: u32, below: &Row, above: &Row, is_flipped: bool) {
        let (mut i, mut j) = (0, 0);
        while i + 1 < below.len() || j + 1 < above.len() {
            // The side whose next edge has its middle first goes on.
            let middle = |row: &Row, k: usize| row.get(k + 1).map_or(f64::INFINITY, |next| row[k].0 + next.0);
            let mut triangle = if middle(below, i) <= middle(above, j) {
                i += 1;
                vec![below[i - 1].1, below[i].1, above[j].1]
            } else {
                j += 1;
                vec![above[j].1, above[j - 1].1, below[i].1]
            };
            if is_flipped {
                triangle.reverse();
            }
            self.shell.facet(surface, vec![triangle]);
        }
    }

    /// An arc of the profile along a straight piece as rows at levels between its stations.
    pub(super) fn straight_panel(&mut self, l: usize, run: &Run, piece: &Piece, surface: u32) -> Result<(), Diagnostic> {
        let outline = &self.sweep.loops[l];
        let n = outline.vertices.len();
        let k = piece.first;
        let is_ring = run.count == n;
        let rows = self.levels_of(outline, k);
        check_count(2.0 * f64::from(rows) * run.count as f64)?;
        let (left, right) = (self.column(l, run.first, k, k + 1), self.column(l, run.first + run.count, k, k + 1));
        let mut below = Row::new();
        for r in 0..=rows {
            let is_shifted = r % 2 == 1 && r < rows;
            let mut row = Row::new();
            if !(is_ring && is_shifted) {
                row.push((0.0, left[r as usize]));
            }
            for e in 0..run.count {
                let is_even_point = e > 0 && !is_shifted;
                if !is_even_point && !is_shifted {
                    continue;
                }
                let id = if is_even_point && (r == 0 || r == rows) {
                    self.vertex(l, run.first + e, k + usize::from(r > 0))
                } else {
                    let profile = self.between_vertices(outline, run, e, is_shifted);
                    self.level_point(&profile, k, r, rows, Freedom::Surface)
                };
                row.push((e as f64 + if is_shifted { 0.5 } else { 0.0 }, id));
            }
            match row.first() {
                Some(&(t, id)) if is_ring => row.push((t + n as f64, id)),
                _ => row.push((run.count as f64, right[r as usize])),
            }
            if r > 0 {
                self.stitch(surface, &below, &row, true);
            }
            below = row;
        }
        Ok(())
    }

    /// The profile vertex at the beginning or in the middle of an edge of an arc.
    fn between_vertices(&self, outline: &Outline, run: &Run, edge: usize, is_middle: bool) -> OutlineVertex {
        let n = outline.vertices.len();
        let [a, b] = [run.first + edge, run.first + edge + 1].map(|i| outline.vertices[i % n]);
        let Some(arc) = run.arc.filter(|_| is_middle) else { return a };
        let local = |p: [f64; 2]| angle::of_direction(p[0] - arc.center[0], p[1] - arc.center[1]);
        let from = local(a.xy);
        let half = angle::canonical(local(b.xy) - from);
        let half = if arc.is_ccw { half } else { half - 360.0 } * 0.5;
        let (c, s) = angle::cos_sin(from + half);
        let on_circle = arc.circle.map(|circle| {
            let c = &self.sweep.circles[circle];
            let degrees = c.degrees_after(&c.breakpoints[0], from + half - c.start);
            OnCircle { circle, degrees, radius: arc.radius }
        });
        let xy = [arc.center[0] + arc.radius * c, arc.center[1] + arc.radius * s];
        OutlineVertex { xy, on_circle, is_corner: false }
    }

    fn level_point(&mut self, profile: &OutlineVertex, k: usize, row: u32, rows: u32, freedom: Freedom) -> u32 {
        let sweep = self.sweep;
        let t = f64::from(row) / f64::from(rows);
        let ends = [k, (k + 1) % sweep.stations.len()].map(|k| sweep.point(profile, &sweep.stations[k]));
        let point = match [k, k + 1].map(|k| sweep.stations[k % sweep.stations.len()]) {
            [Station::Level(a), Station::Level(b)] => sweep.point(profile, &Station::Level(a + (b - a) * t)),
            _ => ends[0] + (ends[1] - ends[0]) * t,
        };
        self.shell.vertex(point, freedom)
    }

    /// Inner vertices of the line that a profile vertex draws from station `k` to the next: levels of adjacent arc panels.
    pub(super) fn levels(&mut self, l: usize, i: usize, k: usize) -> Vec<u32> {
        let sweep = self.sweep;
        let outline = &sweep.loops[l];
        let n = outline.vertices.len();
        let is_straight = sweep.pieces.iter().any(|p| p.turn.is_none() && p.first == k);
        let is_end = |r: &Run| r.arc.is_some() && (r.first == i || (r.first + r.count) % n == i);
        if !is_straight || !outline.runs.iter().any(is_end) {
            return Vec::new();
        }
        let rows = self.levels_of(outline, k);
        let profile = outline.vertices[i];
        let freedom = if profile.is_corner { Freedom::Edge } else { Freedom::Surface };
        (1..rows).map(|r| self.level_point(&profile, k, r, rows, freedom)).collect()
    }

    /// Number of rows on a straight piece: all arcs of a chain agree on one, by the mean chord.
    fn levels_of(&self, outline: &Outline, k: usize) -> u32 {
        let n = outline.vertices.len();
        let (mut sum, mut count) = (0.0, 0.0);
        for run in outline.runs.iter().filter(|r| r.arc.is_some()) {
            for e in run.first..run.first + run.count {
                sum += super::outline::distance(outline.vertices[e % n].xy, outline.vertices[(e + 1) % n].xy);
                count += 1.0;
            }
        }
        let sweep = self.sweep;
        let v = &outline.vertices[0];
        let [a, b] = [k, (k + 1) % sweep.stations.len()].map(|k| sweep.point(v, &sweep.stations[k]));
        let scale = sweep.place.axes[0].norm();
        let rows = rows((b - a).norm(), ROW_PER_CHORD * scale * sum / count);
        rows.min(f64::from(super::division::MAX_SEGMENTS)) as u32
    }
}

/// A stretch between fixed breakpoints.
struct Sector {
    /// Station where it begins.
    station: usize,
    /// Degrees.
    sweep: f64,
    /// Whether it is a whole turn without fixed breakpoints.
    is_ring: bool,
}

fn sectors(piece: &Piece, turn: &Turn) -> Vec<Sector> {
    let is_closed = piece.last - piece.first == turn.breakpoints.len();
    let is_fixed = |k: &usize| turn.breakpoints.get(k - piece.first).is_some_and(|b| b.is_hard);
    let mut stations: Vec<usize> = (piece.first..piece.last).filter(|k| is_fixed(k) || *k == piece.first).collect();
    let is_ring = is_closed && stations.len() == 1 && !is_fixed(&piece.first);
    stations.push(piece.last);
    let width = |w: &[usize]| along(piece, turn, w[1]) - along(piece, turn, w[0]);
    stations.windows(2).map(|w| Sector { station: w[0], sweep: width(w), is_ring }).collect()
}

/// Degrees from the piece's first station.
fn along(piece: &Piece, turn: &Turn, station: usize) -> f64 {
    turn.breakpoints.get(station - piece.first).map_or(360.0, |b| b.along)
}

/// Sine of the angle between a swept surface's normal and the axis.
fn sine_of_normal(outline: &Outline, run: &Run, vertex: usize) -> f64 {
    outline.direction(run, vertex)[1].abs()
}
