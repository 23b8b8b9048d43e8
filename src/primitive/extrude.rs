//! Extrusions: a profile moved along its normal.

use super::circle::{Circle, CircleRequest};
use super::division;
use super::outline::{Rule, range_of};
use super::place::Place;
use super::profile;
use super::sweep::{Piece, Station, Sweep};
use crate::diag::Diagnostic;
use crate::geom::plane::distance;
use crate::scene::model::{Frame, Leaf, Path2, Profile};
use std::collections::BTreeMap;

/// A profile to extrude.
pub(crate) struct Extrusion<'a> {
    pub leaf: &'a Leaf,
    pub frame: &'a Frame,
    pub profile: &'a Profile,
    pub length: f64,
}

impl Extrusion<'_> {
    /// The arcs of its profile, outer chain first.
    pub fn requests(&self) -> Result<Vec<CircleRequest>, Diagnostic> {
        let place = Place::new(self.frame, &self.leaf.transform);
        let mut requests = Vec::new();
        for path in std::iter::once(&self.profile.outer).chain(&self.profile.holes) {
            arcs(path, &place, self.leaf, [0.0, self.length], 0.0, &mut requests)?;
        }
        Ok(requests)
    }

    /// The sweep, on its divided circles.
    pub fn sweep(&self, circles: Vec<Circle>) -> Result<Sweep, Diagnostic> {
        let loops = profile::divide(self.profile, &mut Rule::Shared { circles: &circles, next: 0 })?;
        Ok(Sweep {
            place: Place::new(self.frame, &self.leaf.transform),
            circles,
            loops,
            stations: vec![Station::Level(0.0), Station::Level(self.length)],
            is_corner: vec![true, true],
            pieces: vec![Piece { first: 0, last: 1, turn: None }],
            is_closed: false,
            caps: ["bottom", "top"],
            has_axis: false,
            faces_forwards: true,
            is_triangulated: self.leaf.is_triangulated,
            levels: BTreeMap::new(),
        })
    }
}

/// Requests for the arcs of a chain; `reach` is how far beyond their radius the solid goes.
pub(crate) fn arcs(
    path: &Path2,
    place: &Place,
    leaf: &Leaf,
    heights: [f64; 2],
    reach: f64,
    requests: &mut Vec<CircleRequest>,
) -> Result<(), Diagnostic> {
    let scale = place.axes[0].norm().max(place.axes[1].norm());
    let mut from = path.start;
    for segment in &path.segments {
        if let Some(arc) = &segment.arc {
            let radius = distance(arc.center, from);
            if radius <= 0.0 {
                return Err(Diagnostic::error("bad-profile", "an arc has radius 0").hint("move its centre off its start"));
            }
            let (start, sweep) = range_of(arc, from, segment.end);
            requests.push(CircleRequest {
                place: place.clone(),
                center: arc.center,
                start,
                sweep,
                is_start_chosen: false,
                segments: division::segments(&leaf.division, (radius + reach) * scale)?,
                radius: radius + reach,
                heights,
            });
        }
        from = segment.end;
    }
    Ok(())
}
