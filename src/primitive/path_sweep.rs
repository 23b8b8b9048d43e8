//! A profile along a plane path of lines and arcs: racetrack coils, busbars.

use super::circle::{Breakpoint, Circle, CircleRequest};
use super::extrude;
use super::outline::{Outline, OutlineVertex, Rule, Run};
use super::place::Place;
use super::profile;
use super::revolve::bounds;
use super::sweep::{Piece, Station, Sweep, Turn};
use crate::diag::Diagnostic;
use crate::geom::Vec3;
use crate::geom::polygon::vector_area;
use crate::scene::model::{Frame, Leaf, Path2, Profile};
use std::collections::BTreeMap;

/// Mitres of sharper corners reach more than 10 times as far as the profile (cosine of the turn; 169 degrees).
const SHARPEST_MITRE: f64 = -0.98;

/// A profile to sweep.
pub(crate) struct PathSweep<'a> {
    pub leaf: &'a Leaf,
    pub frame: &'a Frame,
    pub profile: &'a Profile,
    pub path: &'a Path2,
}

impl PathSweep<'_> {
    /// The arcs of its path.
    pub fn requests(&self) -> Result<Vec<CircleRequest>, Diagnostic> {
        let place = Place::new(self.frame, &self.leaf.transform);
        let (lo, hi) = bounds(&self.profile.outer);
        let mut requests = Vec::new();
        let reach = lo[0].abs().max(hi[0].abs());
        extrude::arcs(self.path, &place, self.leaf, [lo[1], hi[1]], reach, &mut requests)?;
        Ok(requests)
    }

    /// The sweep, on its divided circles.
    ///
    /// # Errors
    /// If the path is not smooth where an arc begins or ends, turns back, or bends tighter than the profile allows; if the
    /// swept strip crosses itself.
    pub fn sweep(&self, circles: Vec<Circle>) -> Result<Sweep, Diagnostic> {
        let place = Place::new(self.frame, &self.leaf.transform);
        let path = Outline::new(self.path, |_| String::new(), &mut Rule::Shared { circles: &circles, next: 0 })?;
        let scale = place.axes[0].norm().max(place.axes[2].norm());
        let mut rule = Rule::Own { division: &self.leaf.division, scale, longest: f64::INFINITY };
        let loops = profile::divide(self.profile, &mut rule)?;
        let n = path.vertices.len();
        let stations = (0..n).map(|v| station(&path, &circles, v)).collect::<Result<Vec<_>, _>>()?;
        let mut pieces = Vec::new();
        for run in &path.runs {
            pieces.push(Piece { first: run.first, last: run.first + run.count, turn: turn(run, &circles) });
        }
        if !path.is_closed
            && let Some(last) = pieces.last_mut()
        {
            last.last = n - 1;
        }
        let sweep = Sweep {
            place,
            circles,
            loops,
            stations,
            is_corner: path.vertices.iter().map(|v| v.is_corner).collect(),
            pieces,
            is_closed: path.is_closed,
            caps: ["start", "end"],
            has_axis: false,
            faces_forwards: false,
            is_triangulated: self.leaf.is_triangulated,
            levels: BTreeMap::new(),
        };
        self.check(&sweep)?;
        Ok(sweep)
    }

    /// Seen along the normal of the path's plane, the sweep is a strip between two parallels of the path.
    fn check(&self, sweep: &Sweep) -> Result<(), Diagnostic> {
        let (lo, hi) = bounds(&self.profile.outer);
        for turn in sweep.pieces.iter().filter_map(|p| p.turn.as_ref()) {
            let inner = turn.offset + turn.sense * if turn.sense > 0.0 { lo[0] } else { hi[0] };
            if inner <= 0.0 {
                let message = format!("an arc of the path of radius {} is too tight for its profile", turn.offset);
                return Err(Diagnostic::error("bad-path", message).hint("make its radius larger than the profile's reach"));
            }
        }
        let parallel = |x: f64| -> Vec<Vec3> {
            let vertex = OutlineVertex { xy: [x, 0.0], on_circle: None, is_corner: false, is_hard: false };
            sweep.stations.iter().map(|s| sweep.point(&vertex, s)).collect()
        };
        let (mut right, mut left) = (parallel(hi[0]), parallel(lo[0]));
        left.reverse();
        let chains = if sweep.is_closed {
            vec![right, left]
        } else {
            right.append(&mut left);
            vec![right]
        };
        let up = sweep.place.axes[0].cross(&sweep.place.axes[1]).normalize();
        let area: f64 = chains.iter().map(|c| area_vector(c).dot(&up)).sum();
        profile::check_region(&chains, area).map_err(|_| {
            Diagnostic::error("bad-path", "the swept profile crosses itself, seen across the plane of its path")
                .hint("use a narrower profile, wider bends or longer straight runs")
        })
    }
}

fn area_vector(chain: &[Vec3]) -> Vec3 {
    let walk: Vec<u32> = (0..chain.len() as u32).collect();
    vector_area([&walk[..]], chain)
}

/// The runs that end and begin at a vertex.
fn runs_at(path: &Outline, vertex: usize) -> [Option<&Run>; 2] {
    let n = path.vertices.len();
    let ends = |r: &&Run| (r.first + 1..=r.first + r.count).any(|i| (if path.is_closed { i % n } else { i }) == vertex);
    let begins = |r: &&Run| (r.first..r.first + r.count).contains(&vertex);
    let last_vertex = !path.is_closed && vertex + 1 == n;
    [path.runs.iter().find(ends), path.runs.iter().find(begins).filter(|_| !last_vertex)]
}

fn station(path: &Outline, circles: &[Circle], vertex: usize) -> Result<Station, Diagnostic> {
    let [before, after] = runs_at(path, vertex);
    let v = &path.vertices[vertex];
    if let Some(run) = [before, after].into_iter().flatten().find(|r| r.arc.is_some()) {
        let is_inside = before.is_some() && after.is_some();
        if v.is_corner && is_inside {
            let message = format!("the path has a corner at an arc, at ({}, {}) in its plane", v.xy[0], v.xy[1]);
            return Err(Diagnostic::error("bad-path", message).hint("let lines and arcs join tangentially"));
        }
        if let Some(t) = turn(run, circles) {
            let k = vertex.wrapping_sub(run.first).min(t.breakpoints.len() - 1);
            return Ok(Station::OnCircle {
                circle: t.circle,
                degrees: t.breakpoints[k].degrees,
                offset: t.offset,
                sense: t.sense,
            });
        }
    }
    let normal = |r: &Run| {
        let [dx, dy] = path.direction(r, vertex);
        [dy, -dx]
    };
    let right = match (before.map(normal), after.map(normal)) {
        (Some(a), Some(b)) => {
            let cosine = a[0] * b[0] + a[1] * b[1];
            if cosine < SHARPEST_MITRE {
                let message = format!("the path turns back at ({}, {}) in its plane", v.xy[0], v.xy[1]);
                return Err(Diagnostic::error("bad-path", message).hint("round the corner with an arc"));
            }
            [(a[0] + b[0]) / (1.0 + cosine), (a[1] + b[1]) / (1.0 + cosine)]
        }
        (Some(a), None) | (None, Some(a)) => a,
        (None, None) => [1.0, 0.0],
    };
    Ok(Station::Mitre { origin: v.xy, right })
}

/// The turning of an arc of the path, in the order of travel.
fn turn(run: &Run, circles: &[Circle]) -> Option<Turn> {
    let arc = run.arc?;
    let circle = arc.circle?;
    let c = &circles[circle];
    let mut breakpoints = c.breakpoints.clone();
    if !arc.is_ccw {
        breakpoints.reverse();
        let last = breakpoints.first().map_or(0.0, |b: &Breakpoint| b.along);
        for b in &mut breakpoints {
            b.along = last - b.along;
        }
    }
    let sense = if arc.is_ccw { 1.0 } else { -1.0 };
    Some(Turn { circle, offset: arc.radius, sense, breakpoints, direction: c.sense * sense })
}
