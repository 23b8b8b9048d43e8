//! The one sweep behind cylinders, cones, tori, extrusions, revolutions and path sweeps.
//!
//! A profile (divided chains) stands at every *station* of a motion; stations are grouped into straight and turning *pieces*.
//! Each run of the profile (one segment) makes with each piece the fewest planar facets that are exact:
//!
//! | run of the profile | straight piece | turning piece |
//! |---|---|---|
//! | line | one polygon | strips; one polygon for the whole motion if the line lies in the plane of the motion |
//! | arc | strips | triangles ([`super::panel`]) |
//!
//! Curved strips for which there are [`Levels`] become triangles too ([`super::ruled`]). Profile coordinates: x to the right of
//! the direction of travel, y up, so that a counter-clockwise profile faces backwards.

use super::circle::{Breakpoint, Circle};
use super::division::check_count;
use super::levels::Levels;
use super::outline::{OnCircle, Outline, OutlineVertex, Run};
use super::place::Place;
use super::rulings::Key;
use super::shell::Shell;
use super::solid::{Freedom, Shape, Solid};
use crate::diag::Diagnostic;
use crate::geom::Vec3;
use std::collections::BTreeMap;

/// A line of a profile is level if its ends differ in height by less than this fraction of its coordinates: rounding only.
const LEVEL: f64 = 4.0 * f64::EPSILON;
/// Four points are coplanar to rounding within this fraction of their coordinates.
const FLAT: f64 = 4.0 * f64::EPSILON;
const NO_VERTEX: u32 = u32::MAX;

/// A place where the profile stands.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Station {
    /// Profile in the place's x, y at height z (extrusion).
    Level(f64),
    /// Turned about a circle's axis: radius = `offset + sense * x`, height = y.
    OnCircle { circle: usize, degrees: f64, offset: f64, sense: f64 },
    /// On a straight path: (origin + right * x, y).
    Mitre { origin: [f64; 2], right: [f64; 2] },
}

/// Stations between which the motion is one line or one arc.
#[derive(Clone, Debug)]
pub(crate) struct Piece {
    /// First station.
    pub first: usize,
    /// Last station; the number of stations if it is the first again.
    pub last: usize,
    /// Arc, if it is one.
    pub turn: Option<Turn>,
}

/// A turning piece.
#[derive(Clone, Debug)]
pub(crate) struct Turn {
    /// Which circle.
    pub circle: usize,
    /// Radius = `offset + sense * x`.
    pub offset: f64,
    pub sense: f64,
    /// Breakpoints in the order of travel, one per station; `along` counts from the first.
    pub breakpoints: Vec<Breakpoint>,
    /// +1 if travel is the axis' positive turn.
    pub direction: f64,
}

/// A motion of a profile.
pub(crate) struct Sweep {
    pub place: Place,
    pub circles: Vec<Circle>,
    /// Profile: outer chain, then holes.
    pub loops: Vec<Outline>,
    pub stations: Vec<Station>,
    /// For each station, whether the direction of travel jumps there (also at open ends).
    pub is_corner: Vec<bool>,
    pub pieces: Vec<Piece>,
    pub is_closed: bool,
    /// Names of the two ends, if open.
    pub caps: [&'static str; 2],
    /// Whether x = 0 of the profile is the axis (revolution).
    pub has_axis: bool,
    /// Whether the profile faces forwards instead (extrusion).
    pub faces_forwards: bool,
    /// Whether its curved strips are to be triangles.
    pub is_triangulated: bool,
    /// How those that are triangles are cut, also because others are that share their surface.
    pub levels: BTreeMap<Key, Levels>,
}

/// A sweep while its facets are made.
pub(super) struct Maker<'a> {
    pub sweep: &'a Sweep,
    pub shell: Shell,
    /// Vertices by loop, profile vertex and station, as far as they are made.
    grid: Vec<Vec<u32>>,
}

impl Sweep {
    /// The solid.
    ///
    /// # Errors
    /// If it would have too many facets.
    pub fn build(&self) -> Result<Solid, Diagnostic> {
        let edges: usize = self.loops.iter().map(|l| l.vertices.len()).sum();
        check_count(edges as f64 * self.stations.len() as f64)?;
        let grid = self.loops.iter().map(|l| vec![NO_VERTEX; l.vertices.len() * self.stations.len()]).collect();
        let shell = Shell::new(self.faces_forwards != self.place.is_mirrored());
        let mut maker = Maker { sweep: self, shell, grid };
        for l in 0..self.loops.len() {
            for r in 0..self.loops[l].runs.len() {
                maker.side(l, r)?;
            }
        }
        if !self.is_closed {
            maker.cap(0, self.caps[0]);
            maker.cap(self.stations.len() - 1, self.caps[1]);
        }
        Ok(maker.shell.finish())
    }

    /// The scene point of a profile vertex at a station.
    pub fn point(&self, vertex: &OutlineVertex, station: &Station) -> Vec3 {
        let [x, y] = vertex.xy;
        match *station {
            Station::Level(z) => match vertex.on_circle {
                Some(OnCircle { circle, degrees, radius }) => self.circles[circle].point(degrees, radius, z),
                None => self.place.point(x, y, z),
            },
            Station::OnCircle { circle, degrees, offset, sense } => self.circles[circle].point(degrees, offset + sense * x, y),
            Station::Mitre { origin, right } => self.place.point(origin[0] + right[0] * x, origin[1] + right[1] * x, y),
        }
    }

    /// Whether a run sweeps a plane, all round, or nothing.
    pub fn is_flat(&self, outline: &Outline, run: &Run) -> bool {
        self.is_on_axis(outline, run) || self.is_level(outline, run)
    }

    /// Whether a run lies on the axis of revolution.
    fn is_on_axis(&self, outline: &Outline, run: &Run) -> bool {
        self.has_axis && run.arc.is_none() && ends(outline, run).iter().all(|v| v.xy[0] == 0.0)
    }

    /// Whether the line of a run lies in the plane of the motion.
    fn is_level(&self, outline: &Outline, run: &Run) -> bool {
        let [a, b] = ends(outline, run).map(|v| v.xy);
        let is_extrusion = matches!(self.stations[0], Station::Level(_));
        run.arc.is_none() && !is_extrusion && (a[1] - b[1]).abs() <= LEVEL * (a[0] - b[0]).abs().max(a[1].abs())
    }

    /// The exact surface that a run makes along a piece.
    fn shape(&self, outline: &Outline, run: &Run, piece: &Piece) -> Shape {
        let [a, b] = ends(outline, run).map(|v| v.xy);
        match (&run.arc, &piece.turn) {
            (None, None) => Shape::Plane,
            (None, Some(turn)) => {
                let slope = turn.sense * (b[0] - a[0]) / (b[1] - a[1]);
                let radius = turn.offset + turn.sense * a[0] - slope * a[1];
                self.place.cone(self.circles[turn.circle].center, radius, slope)
            }
            (Some(arc), None) => {
                let [cx, cy] = arc.center;
                match self.stations[piece.first] {
                    Station::Level(_) => self.place.cone(arc.center, arc.radius, 0.0),
                    // A straight piece of a path may begin where an arc ends.
                    Station::Mitre { .. } | Station::OnCircle { .. } => {
                        let ([ox, oy], [dx, dy]) = self.straight(piece);
                        // Right of the travel direction d is (dy, -dx).
                        let (origin, up) = ([ox + dy * cx, oy - dx * cx, cy], [0.0, 0.0, 1.0]);
                        let axes = [[-dy, dx, 0.0], up, [dx, dy, 0.0]];
                        self.place.inner(origin, axes).cone([0.0, 0.0], arc.radius, 0.0)
                    }
                }
            }
            (Some(arc), Some(turn)) => {
                let [x, y] = self.circles[turn.circle].center;
                let major = turn.offset + turn.sense * arc.center[0];
                if major == 0.0 {
                    self.place.ellipsoid(Vec3::new(x, y, arc.center[1]), Vec3::repeat(arc.radius))
                } else {
                    self.place.torus([x, y, arc.center[1]], major, arc.radius)
                }
            }
        }
    }

    /// Path point and unit direction of a straight piece.
    fn straight(&self, piece: &Piece) -> ([f64; 2], [f64; 2]) {
        let ends = [piece.first, piece.last % self.stations.len()].map(|k| self.path_point(k));
        let d = [ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]];
        let length = libm::hypot(d[0], d[1]);
        (ends[0], [d[0] / length, d[1] / length])
    }

    /// Where the path is at a station, in the place's plane.
    fn path_point(&self, station: usize) -> [f64; 2] {
        match self.stations[station] {
            Station::Level(_) => [0.0, 0.0],
            Station::Mitre { origin, .. } => origin,
            Station::OnCircle { circle, degrees, offset, .. } => {
                let c = &self.circles[circle];
                let first = c.breakpoints.iter().find(|b| b.degrees == degrees).map_or(0.0, |b| b.along);
                let (cos, sin) = super::angle::cos_sin(c.start + first);
                [c.center[0] + offset * cos, c.center[1] + offset * sin]
            }
        }
    }
}

/// The first and the last vertex of a run.
pub(super) fn ends<'a>(outline: &'a Outline, run: &Run) -> [&'a OutlineVertex; 2] {
    let n = outline.vertices.len();
    [&outline.vertices[run.first], &outline.vertices[(run.first + run.count) % n]]
}

impl Maker<'_> {
    /// All facets that one run of the profile sweeps.
    fn side(&mut self, l: usize, r: usize) -> Result<(), Diagnostic> {
        let sweep = self.sweep;
        let outline = &sweep.loops[l];
        let run = &outline.runs[r];
        if sweep.is_on_axis(outline, run) {
            return Ok(());
        }
        if sweep.is_level(outline, run) {
            self.level(l, run);
            return Ok(());
        }
        for (p, piece) in sweep.pieces.iter().enumerate() {
            let shape = sweep.shape(outline, run, piece);
            let surface = self.shell.surface(&run.name, shape);
            match (&run.arc, &piece.turn, sweep.levels.get(&(l, r, p))) {
                (None, None, _) => self.planar(l, run, piece, surface),
                (Some(arc), Some(turn), _) => self.turned_arc(l, (run, arc), (piece, turn), surface)?,
                (_, _, Some(levels)) => self.level_curves((l, run), piece, surface, levels)?,
                (_, _, None) => self.strips(l, run, piece, surface),
            }
        }
        Ok(())
    }

    /// The vertex of a profile vertex at a station, made on first use.
    pub fn vertex(&mut self, l: usize, i: usize, k: usize) -> u32 {
        let sweep = self.sweep;
        let outline = &sweep.loops[l];
        let (n, m) = (outline.vertices.len(), sweep.stations.len());
        let profile = &outline.vertices[i % n];
        let is_on_axis = sweep.has_axis && profile.xy[0] == 0.0;
        let k = if is_on_axis { 0 } else { k % m };
        let slot = (i % n) * m + k;
        if self.grid[l][slot] == NO_VERTEX {
            let freedom = match (profile.is_corner, sweep.is_corner[k]) {
                _ if is_on_axis => self.freedom_on_axis(outline, i % n),
                (true, true) => Freedom::Fixed,
                (false, false) => Freedom::Surface,
                _ => Freedom::Edge,
            };
            self.grid[l][slot] = self.shell.vertex(sweep.point(profile, &sweep.stations[k]), freedom);
        }
        self.grid[l][slot]
    }

    /// A pole is smooth where an arc about a point of the axis ends there, all round.
    fn freedom_on_axis(&self, outline: &Outline, i: usize) -> Freedom {
        let n = outline.vertices.len();
        let is_end = |r: &Run| r.first == i || (r.first + r.count) % n == i;
        let is_smooth =
            self.sweep.is_closed && outline.runs.iter().any(|r| is_end(r) && r.arc.is_some_and(|a| a.center[0] == 0.0));
        if is_smooth { Freedom::Surface } else { Freedom::Fixed }
    }

    /// The line of a vertex past stations `first` to `last`.
    fn column(&mut self, l: usize, i: usize, first: usize, last: usize) -> Vec<u32> {
        (first..=last).map(|k| self.vertex(l, i, k)).collect()
    }

    /// One polygon for the whole motion: the run is level.
    fn level(&mut self, l: usize, run: &Run) {
        let sweep = self.sweep;
        let surface = self.shell.surface(&run.name, Shape::Plane);
        let stations = if sweep.is_closed { sweep.stations.len() } else { sweep.stations.len() - 1 };
        let near = self.column(l, run.first, 0, stations);
        let mut far = self.column(l, run.first + run.count, 0, stations);
        far.reverse();
        if !sweep.is_closed {
            self.shell.facet(surface, vec![near.into_iter().chain(far).collect()]);
            return;
        }
        // The longer way round is outside: further right when turning left.
        let (near_length, far_length) = (self.length(&near), self.length(&far));
        let loops = if near_length > far_length { vec![near, far] } else { vec![far, near] };
        self.shell.facet(surface, loops);
    }

    fn length(&self, walk: &[u32]) -> f64 {
        (1..walk.len()).map(|k| (self.shell.point(walk[k]) - self.shell.point(walk[k - 1])).norm()).sum()
    }

    /// One polygon: a line along a line.
    fn planar(&mut self, l: usize, run: &Run, piece: &Piece, surface: u32) {
        let edge = |maker: &mut Self, k| (0..=run.count).map(|e| maker.vertex(l, run.first + e, k)).collect::<Vec<_>>();
        let mut walk = edge(self, piece.first);
        walk.reverse();
        walk.extend(self.column(l, run.first, piece.first, piece.last));
        walk.extend(edge(self, piece.last));
        walk.extend(self.column(l, run.first + run.count, piece.first, piece.last).into_iter().rev());
        walk.dedup();
        match walk[..] {
            [a, b, c, d, e] if a == e && !self.is_planar([a, b, c, d]) => {
                self.shell.facet(surface, vec![vec![a, b, c]]);
                self.shell.facet(surface, vec![vec![a, c, d]]);
            }
            _ => self.shell.facet(surface, vec![walk]),
        }
    }

    /// Whether four points are coplanar to rounding: arcs may join lines with an angle of rounded numbers.
    fn is_planar(&self, quad: [u32; 4]) -> bool {
        let [a, b, c, d] = quad.map(|v| self.shell.point(v));
        let normal = (c - a).cross(&(d - b)).normalize();
        (b - a).dot(&normal).abs() <= FLAT * a.amax().max(b.amax()).max(c.amax()).max(d.amax())
    }

    /// Planar strips: an arc along a line, or a line along an arc.
    fn strips(&mut self, l: usize, run: &Run, piece: &Piece, surface: u32) {
        for e in run.first..run.first + run.count {
            for k in piece.first..piece.last {
                let corners = [(e + 1, k), (e, k), (e, k + 1), (e + 1, k + 1)];
                let walk = corners.map(|(i, k)| self.vertex(l, i, k));
                self.shell.facet(surface, vec![walk.to_vec()]);
            }
        }
    }

    /// The end of an open motion: the profile itself.
    fn cap(&mut self, k: usize, name: &str) {
        let surface = self.shell.surface(name, Shape::Plane);
        let mut loops = Vec::with_capacity(self.sweep.loops.len());
        for l in 0..self.sweep.loops.len() {
            let mut walk: Vec<u32> = (0..self.sweep.loops[l].vertices.len()).map(|i| self.vertex(l, i, k)).collect();
            if k > 0 {
                walk.reverse();
            }
            loops.push(walk);
        }
        self.shell.facet(surface, loops);
    }
}
