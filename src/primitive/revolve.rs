//! Cylinders, cones, tori and other revolutions: a profile turned about an axis.

use super::angle;
use super::circle::{Circle, CircleRequest};
use super::division;
use super::outline::{Outline, Rule};
use super::place::Place;
use super::profile;
use super::sweep::{Piece, Station, Sweep, Turn};
use crate::diag::Diagnostic;
use crate::geom::plane::distance;
use crate::geom::{Affine, Vec3};
use crate::scene::model::{Arc2, Frame, Leaf, Path2, Profile, Segment2};
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// Profile points nearer to the axis than this fraction of the largest radius lie on it: rounding only.
const ON_AXIS: f64 = 1e-14;
/// Chords along the profile may be longer than those around the axis by this factor, before triangles get thin.
const TALLEST: f64 = 1.25;

/// A profile to turn.
pub(crate) struct Revolution<'a> {
    pub leaf: &'a Leaf,
    pub frame: &'a Frame,
    pub profile: Profile,
    /// First angle, degrees.
    pub start: f64,
    /// Swept angle, degrees.
    pub sweep: f64,
}

/// The profile of a cylinder, cone or frustum.
pub(crate) fn cone_profile(bottom: f64, top: f64, height: f64) -> Profile {
    let segment = |end, name: &str| Segment2 { end, arc: None, name: Some(name.into()) };
    let corners = [([bottom, 0.0], "bottom"), ([top, height], "side"), ([0.0, height], "top"), ([0.0, 0.0], "axis")];
    let mut segments: Vec<Segment2> = Vec::new();
    let mut from = [0.0, 0.0];
    for (end, name) in corners {
        if end != from {
            segments.push(segment(end, name));
            from = end;
        }
    }
    Profile { outer: Path2 { start: [0.0, 0.0], segments, is_closed: true }, holes: Vec::new() }
}

/// The profile of a torus; its first vertex is on the outer equator.
pub(crate) fn torus_profile(major: f64, minor: f64) -> Profile {
    let start = [major + minor, 0.0];
    let arc = Some(Arc2 { center: [major, 0.0], is_ccw: true });
    let segments = vec![Segment2 { end: start, arc, name: Some("side".into()) }];
    Profile { outer: Path2 { start, segments, is_closed: true }, holes: Vec::new() }
}

impl Revolution<'_> {
    /// The circle that it is turned along.
    pub fn request(&self) -> Result<CircleRequest, Diagnostic> {
        let place = Place::new(self.frame, &self.leaf.transform);
        let (lo, hi) = bounds(&self.profile.outer);
        if lo[0] < -ON_AXIS * hi[0] || hi[0] <= 0.0 {
            let message = format!("the profile reaches x = {}, across the axis of revolution", lo[0]);
            return Err(Diagnostic::error("bad-profile", message).hint("move it to x >= 0"));
        }
        let scale = place.axes[0].norm().max(place.axes[1].norm());
        Ok(CircleRequest {
            segments: division::segments(&self.leaf.division, hi[0] * scale)?,
            place,
            center: [0.0, 0.0],
            start: self.start,
            sweep: self.sweep,
            is_start_chosen: self.start != 0.0,
            radius: hi[0],
            heights: [lo[1], hi[1]],
        })
    }

    /// The arcs of its profile, outer chain first, in the half plane of the axis: x is the distance from it, y the height along
    /// it.
    pub fn meridians(&self, circle: &Circle) -> Result<Vec<CircleRequest>, Diagnostic> {
        let place = &circle.place;
        let along = |v: Vec3| v.dot(&circle.axis.z);
        let origin = Vec3::new(0.0, along(place.origin - circle.axis.origin), 0.0);
        let (x, y) = (Vec3::x() * circle.length(), Vec3::y() * along(place.axes[2]));
        let half_plane = Place::new(&Frame { origin, x, y, z: Vec3::z() }, &Affine::identity());
        let chord = TAU * bounds(&self.profile.outer).1[0] / f64::from(circle.segments);
        let mut requests = Vec::new();
        for path in std::iter::once(&self.profile.outer).chain(&self.profile.holes) {
            super::extrude::arcs(path, &half_plane, self.leaf, [0.0, 0.0], 0.0, &mut requests)?;
        }
        for request in &mut requests {
            let chords = (TAU * request.radius / (TALLEST * chord) * (1.0 - 1e-12)).ceil();
            request.segments = request.segments.max(chords.min(f64::from(division::MAX_SEGMENTS)) as u32);
        }
        Ok(requests)
    }

    /// The sweep, on its divided circle, with the divided arcs of its profile.
    pub fn sweep(&self, circle: Circle, meridians: &[Circle]) -> Result<Sweep, Diagnostic> {
        let place = circle.place.clone();
        let radius = bounds(&self.profile.outer).1[0];
        let mut loops = profile::divide(&self.profile, &mut Rule::Shared { circles: meridians, next: 0 })?;
        for vertex in loops.iter_mut().flat_map(|l: &mut Outline| &mut l.vertices) {
            if vertex.xy[0] <= ON_AXIS * radius {
                vertex.xy[0] = 0.0;
            }
        }
        let on_circle = |degrees| Station::OnCircle { circle: 0, degrees, offset: 0.0, sense: 1.0 };
        let stations: Vec<Station> = circle.breakpoints.iter().map(|b| on_circle(b.degrees)).collect();
        let n = stations.len();
        let is_closed = circle.is_full;
        let breakpoints = circle.breakpoints.clone();
        let turn = Turn { circle: 0, offset: 0.0, sense: 1.0, breakpoints, direction: circle.sense };
        Ok(Sweep {
            place,
            loops,
            is_corner: (0..n).map(|k| !is_closed && (k == 0 || k == n - 1)).collect(),
            pieces: vec![Piece { first: 0, last: if is_closed { n } else { n - 1 }, turn: Some(turn) }],
            stations,
            circles: vec![circle],
            is_closed,
            caps: ["start", "end"],
            has_axis: true,
            faces_forwards: false,
            is_triangulated: self.leaf.is_triangulated,
            levels: BTreeMap::new(),
        })
    }
}

/// Start and sweep in degrees from radians; a sweep of a full turn but for rounding is one.
pub(crate) fn range(start: f64, sweep: f64) -> (f64, f64) {
    (angle::from_radians(start), angle::from_radians(sweep).min(360.0))
}

/// The box around a chain, arcs included.
pub(crate) fn bounds(path: &Path2) -> ([f64; 2], [f64; 2]) {
    let (mut lo, mut hi) = (path.start, path.start);
    let mut from = path.start;
    let mut grow = |p: [f64; 2]| {
        for k in 0..2 {
            lo[k] = lo[k].min(p[k]);
            hi[k] = hi[k].max(p[k]);
        }
    };
    for segment in &path.segments {
        grow(segment.end);
        if let Some(arc) = &segment.arc {
            let (start, sweep) = super::outline::range_of(arc, from, segment.end);
            let radius = distance(arc.center, from);
            for quarter in [0.0, 90.0, 180.0, 270.0] {
                if angle::canonical(quarter - start) < sweep {
                    let (c, s) = angle::cos_sin(quarter);
                    grow([arc.center[0] + radius * c, arc.center[1] + radius * s]);
                }
            }
        }
        from = segment.end;
    }
    (lo, hi)
}
