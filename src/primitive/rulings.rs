//! Which surfaces of a sweep are cylinders and cones, where they lie, and how they are cut into level curves.

use super::angle;
use super::circle::Axis;
use super::levels::{Levels, Ruled};
use super::outline::{Outline, OutlineVertex, Run, RunArc};
use super::rows::{Column, Columns};
use super::ruled::{Ruling, Sheet};
use super::solid::Freedom;
use super::sweep::{Maker, Piece, Station, Sweep, Turn};
use crate::diag::Diagnostic;
use crate::geom::Vec3;
use crate::geom::plane::distance;
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Loop, run and piece of a sweep.
pub(crate) type Key = (usize, usize, usize);

impl Sweep {
    /// Its ruled curved surfaces.
    pub fn ruled(&self) -> Vec<Ruled> {
        let mut all: Vec<Ruled> = Vec::new();
        let mut numbers: BTreeMap<Key, usize> = BTreeMap::new();
        for (l, outline) in self.loops.iter().enumerate() {
            for (r, run) in outline.runs.iter().enumerate().filter(|(_, run)| !self.is_flat(outline, run)) {
                for (p, piece) in self.pieces.iter().enumerate() {
                    let (axis, group, ends, radii, segments) = match (&run.arc, &piece.turn) {
                        (None, Some(turn)) => self.turned_line(outline, run, turn),
                        (Some(arc), None) => self.moved_arc(outline, (run, arc), piece),
                        _ => continue,
                    };
                    let key = (l, r, p);
                    let near = if run.arc.is_some() {
                        let count = outline.runs.len();
                        [(r + count - 1) % count, (r + 1) % count].map(|r| (l, r, p))
                    } else {
                        let count = self.pieces.len();
                        [(p + count - 1) % count, (p + 1) % count].map(|p| (l, r, p))
                    };
                    let neighbours = near.iter().filter_map(|key| numbers.get(key)).copied().collect();
                    numbers.insert(key, all.len());
                    let is_triangulated = self.is_triangulated;
                    all.push(Ruled { key, axis, group, ends, radii, segments, is_triangulated, neighbours });
                }
            }
        }
        all
    }

    fn turned_line(&self, outline: &Outline, run: &Run, turn: &Turn) -> Place {
        let circle = &self.circles[turn.circle];
        let ends = super::sweep::ends(outline, run).map(|v| v.xy);
        let radii = ends.map(|p| (turn.offset + turn.sense * p[0]) * circle.length());
        let points = ends.map(|p| circle.axis_point(p[1]));
        (circle.axis.clone(), Some(circle.group), points, radii, f64::from(circle.segments))
    }

    fn moved_arc(&self, outline: &Outline, (run, arc): (&Run, &RunArc), piece: &Piece) -> Place {
        let stations = [piece.first, piece.last].map(|k| self.stations[k % self.stations.len()]);
        if let (Some(c), [Station::Level(a), Station::Level(b)]) = (arc.circle, stations) {
            let circle = &self.circles[c];
            let radius = arc.radius * circle.length();
            let ends = [a, b].map(|z| circle.axis_point(z));
            return (circle.axis.clone(), Some(circle.group), ends, [radius; 2], f64::from(circle.segments));
        }
        let center = OutlineVertex { xy: arc.center, on_circle: None, is_corner: false, is_hard: false };
        let ends = stations.map(|station| self.point(&center, &station));
        // Angles of a profile, x to the right and y up, turn about the direction of travel as screws go backwards.
        let z = (ends[0] - ends[1]).normalize() * if self.place.is_mirrored() { -1.0 } else { 1.0 };
        let axis = Axis { origin: ends[0], z, x: self.place.axes[2], y: self.place.axes[2].cross(&z) };
        let [a, b] = super::sweep::ends(outline, &Run { count: 1, ..run.clone() }).map(|v| v.xy);
        let half_sine = (distance(a, b) * 0.5 / arc.radius).min(1.0);
        (axis, None, ends, [arc.radius * self.place.axes[0].norm(); 2], PI / libm::asin(half_sine))
    }

    /// The point of an arc of the profile at `degrees`: the axis' if it is divided with others, else of the profile.
    pub fn arc_point(&self, arc: &RunArc, degrees: f64, station: &Station) -> Vec3 {
        match (arc.circle, station) {
            (Some(circle), Station::Level(z)) => self.circles[circle].point(degrees, arc.radius, *z),
            _ => {
                let (c, s) = angle::cos_sin(degrees);
                let xy = [arc.center[0] + arc.radius * c, arc.center[1] + arc.radius * s];
                self.point(&OutlineVertex { xy, on_circle: None, is_corner: false, is_hard: false }, station)
            }
        }
    }

    /// The vertices of an arc of the profile as columns, and whether their degrees rise.
    fn arc_columns(&self, outline: &Outline, run: &Run, arc: &RunArc) -> (Vec<Column>, bool) {
        let n = outline.vertices.len();
        let last = if run.count == n { run.count - 1 } else { run.count };
        let vertices = (0..=last).map(|e| (e, run.first + e, &outline.vertices[(run.first + e) % n]));
        let Some(circle) = arc.circle.map(|c| &self.circles[c]) else {
            let degrees =
                |v: &OutlineVertex| angle::canonical(angle::of_direction(v.xy[0] - arc.center[0], v.xy[1] - arc.center[1]));
            let columns = vertices.map(|(_, index, v)| Column { degrees: degrees(v), is_hard: false, index });
            return (columns.collect(), arc.is_ccw);
        };
        let is_hard: BTreeMap<u64, bool> = circle.breakpoints.iter().map(|b| (b.degrees.to_bits(), b.is_hard)).collect();
        let breakpoint = |e: usize| circle.breakpoints.get(if arc.is_ccw { e } else { last - e }).map_or(0.0, |b| b.degrees);
        let columns = vertices.map(|(e, index, v)| {
            // The ends of an arc belong to its neighbours as well and do not know the circle.
            let degrees = v.on_circle.filter(|on| Some(on.circle) == arc.circle).map_or_else(|| breakpoint(e), |on| on.degrees);
            Column { degrees, is_hard: is_hard.get(&degrees.to_bits()).copied().unwrap_or(false), index }
        });
        (columns.collect(), arc.is_ccw == (circle.sense > 0.0))
    }
}

/// Axis, its number, the ends on it, the radii there, chords per circle.
type Place = (Axis, Option<usize>, [Vec3; 2], [f64; 2], f64);

impl Maker<'_> {
    /// Cuts a ruled surface into level curves.
    ///
    /// # Errors
    /// If they have too many triangles.
    pub(super) fn level_curves(
        &mut self,
        (l, run): (usize, &Run),
        piece: &Piece,
        surface: u32,
        levels: &Levels,
    ) -> Result<(), Diagnostic> {
        let sweep = self.sweep;
        let outline = &sweep.loops[l];
        let n = outline.vertices.len();
        let sense = if levels.is_ccw { 1.0 } else { -1.0 };
        let freedom = |is_corner: bool| if is_corner { Freedom::Edge } else { Freedom::Surface };
        let low_first = |ends: [usize; 2]| if levels.is_rising { ends } else { [ends[1], ends[0]] };
        match (&run.arc, &piece.turn) {
            (None, Some(turn)) => {
                let ends = low_first([run.first, run.first + run.count]);
                let ruling = Ruling::Turned { ends: ends.map(|i| outline.vertices[i % n].xy), turn };
                let is_flipped = (turn.direction == sense) != levels.is_rising;
                let sheet = Sheet { columns: turn.columns(piece, sense), ruling, levels, is_flipped, surface };
                let is_corner = |c: &Column| sweep.is_corner[c.index % sweep.stations.len()];
                self.ruled(&sheet, |maker, c, end| maker.vertex(l, ends[end], c.index), |c| freedom(is_corner(c)))
            }
            (Some(arc), None) => {
                let ends = low_first([piece.first, piece.last]);
                let stations = ends.map(|k| sweep.stations[k % sweep.stations.len()]);
                let (columns, is_rising) = sweep.arc_columns(outline, run, arc);
                let is_reversed = is_rising != levels.is_ccw;
                let is_flipped = is_reversed != levels.is_rising;
                let columns = Columns::new(columns, run.count == n, is_reversed, sense);
                let sheet = Sheet { columns, ruling: Ruling::Moved { arc: *arc, stations }, levels, is_flipped, surface };
                let is_corner = |c: &Column| outline.vertices[c.index % n].is_corner;
                self.ruled(&sheet, |maker, c, end| maker.vertex(l, c.index, ends[end]), |c| freedom(is_corner(c)))
            }
            _ => Ok(()),
        }
    }
}
