//! Curves of the plane as they are written, to [`Path2`].

use super::ast;
use super::model::{Arc2, Path2, Segment2};
use super::motion::sin_cos;
use super::primitives::MAX_SIDES;
use super::reader::{MIN_SIZE, Owner, Reader};
use super::source::{Field, Raw};
use crate::geom::plane::distance;

/// Distance, relative to a path's extent, below which its end counts as its start.
const CLOSED: f64 = 1e-12;

fn line(end: [f64; 2]) -> Segment2 {
    Segment2 { end, arc: None, name: None }
}

pub(super) fn arc(end: [f64; 2], center: [f64; 2], is_ccw: bool) -> Segment2 {
    Segment2 { end, arc: Some(Arc2 { center, is_ccw }), name: None }
}

/// A full circle that begins at `start` degrees.
pub(super) fn circle(center: [f64; 2], radius: f64, start: f64, name: Option<String>) -> Path2 {
    let (s, c) = sin_cos(start);
    let start = [center[0] + radius * c, center[1] + radius * s];
    Path2 { start, segments: vec![Segment2 { name, ..arc(start, center, true) }], is_closed: true }
}

/// Corners of a regular polygon, the first at `start` degrees.
pub(super) fn regular_polygon(sides: u32, radius: f64, center: [f64; 2], start: f64) -> Vec<[f64; 2]> {
    let corner = |k: u32| {
        let (s, c) = sin_cos(start + 360.0 * f64::from(k) / f64::from(sides));
        [center[0] + radius * c, center[1] + radius * s]
    };
    (0..sides).map(corner).collect()
}

/// The closed chain of lines through `points`.
pub(super) fn closed_polyline(points: &[[f64; 2]]) -> Path2 {
    let start = points.first().copied().unwrap_or([0.0; 2]);
    let segments = points.iter().skip(1).copied().chain([start]).map(line).collect();
    Path2 { start, segments, is_closed: true }
}

/// A rectangle with rounded corners, counter-clockwise from the lower left; straight sides of no length are left out.
fn rounded_rectangle(lo: [f64; 2], hi: [f64; 2], r: f64) -> Path2 {
    let start = [lo[0] + r, lo[1]];
    let corners = [
        ([hi[0] - r, lo[1]], [hi[0], lo[1] + r], [hi[0] - r, lo[1] + r]),
        ([hi[0], hi[1] - r], [hi[0] - r, hi[1]], [hi[0] - r, hi[1] - r]),
        ([lo[0] + r, hi[1]], [lo[0], hi[1] - r], [lo[0] + r, hi[1] - r]),
        ([lo[0], lo[1] + r], start, [lo[0] + r, lo[1] + r]),
    ];
    let mut segments: Vec<Segment2> = Vec::new();
    for (line_end, arc_end, center) in corners {
        let from = segments.last().map_or(start, |s| s.end);
        if from != line_end {
            segments.push(line(line_end));
        }
        segments.push(arc(arc_end, center, true));
    }
    Path2 { start, segments, is_closed: true }
}

impl<'a> Reader<'a> {
    /// A curve.
    pub fn curve(&mut self, raw: Raw<'a>) -> Option<Path2> {
        let owner = |kind| Owner { kind, raw };
        match self.read::<ast::Curve>(raw)? {
            ast::Curve::Circle(node) => {
                let radius = self.radius(owner("Circle"), node.radius, node.diameter);
                let center = self.point2_or_origin("center", node.center);
                let start = node.start.0.map_or(Some(0.0), |raw| self.degrees("start", raw));
                Some(circle(center?, radius?, start?, None))
            }
            ast::Curve::Rectangle(node) => {
                let fields = [node.min, node.max, node.size, node.center, node.at];
                let (lo, hi) = self.rectangle(owner("Rectangle"), fields)?;
                Some(closed_polyline(&[lo, [hi[0], lo[1]], hi, [lo[0], hi[1]]]))
            }
            ast::Curve::RoundedRectangle(node) => {
                let fields = [node.min, node.max, node.size, node.center, node.at];
                let corners = self.rectangle(owner("RoundedRectangle"), fields);
                let radius = self.needed_size(owner("RoundedRectangle"), "radius", node.radius);
                let ((lo, hi), radius) = (corners?, radius?);
                // Half the shorter side, and what rounding may add to it.
                let most = 0.5 * (hi[0] - lo[0]).min(hi[1] - lo[1]);
                if radius > most {
                    let at = node.radius.0.unwrap_or(raw);
                    return self.fail(
                        at,
                        "out-of-range",
                        format!("`radius` {radius} is larger than half the shorter side, {most}"),
                        "make the radius smaller or the rectangle larger",
                    );
                }
                Some(rounded_rectangle(lo, hi, radius))
            }
            ast::Curve::RegularPolygon(node) => {
                let owner = owner("RegularPolygon");
                let sides = self.need(owner, "sides", node.sides).and_then(|raw| self.count("sides", raw, 3, MAX_SIDES));
                let radius = self.needed_size(owner, "radius", node.radius);
                let center = self.point2_or_origin("center", node.center);
                let start = node.start.0.map_or(Some(0.0), |raw| self.degrees("start", raw));
                Some(closed_polyline(&regular_polygon(sides?, radius?, center?, start?)))
            }
            ast::Curve::Polygon(list) => Some(closed_polyline(&self.points(raw, &list)?)),
            ast::Curve::Path(node) => self.path(owner("Path"), &node),
        }
    }

    /// Corners from `[min, max, size, center, at]`.
    fn rectangle(&mut self, owner: Owner<'a>, fields: [Field<'a>; 5]) -> Option<([f64; 2], [f64; 2])> {
        let [min, max, size, center, at] = fields;
        let (lo, hi) = if let Some(raw) = size.0 {
            if let Some(other) = min.0.or(max.0) {
                let message = format!("{} has `size` as well as `min` or `max`", owner.kind);
                return self.fail(other, "conflict", message, "leave out one of them");
            }
            let size = self.point2("size", raw)?;
            let lo = match (center.0, at.0) {
                (Some(_), Some(raw)) => {
                    let message = format!("{} has both `center` and `at`", owner.kind);
                    return self.fail(raw, "conflict", message, "leave out one of them: `at` is the lowest corner");
                }
                (Some(raw), None) => self.point2("center", raw).map(|c| [c[0] - 0.5 * size[0], c[1] - 0.5 * size[1]]),
                _ => self.point2_or_origin("at", at),
            }?;
            (lo, [lo[0] + size[0], lo[1] + size[1]])
        } else {
            let lo = self.need(owner, "min", min).and_then(|raw| self.point2("min", raw));
            let hi = self.need(owner, "max", max).and_then(|raw| self.point2("max", raw));
            (lo?, hi?)
        };
        if (hi[0] - lo[0]).min(hi[1] - lo[1]) < MIN_SIZE {
            let message =
                format!("both sides of the {} must be positive; they are {} and {}", owner.kind, hi[0] - lo[0], hi[1] - lo[1]);
            return self.fail(owner.raw, "not-positive", message, "exchange the coordinates, or check the parameters");
        }
        Some((lo, hi))
    }

    fn path(&mut self, owner: Owner<'a>, node: &ast::PathNode<'a>) -> Option<Path2> {
        let start = self.need(owner, "start", node.start).and_then(|raw| self.point2("start", raw));
        let list = self.need(owner, "segments", node.segments).and_then(|raw| self.read::<Vec<Raw>>(raw));
        let is_closed = self.read_or(node.closed, true);
        let (start, is_closed) = (start?, is_closed?);
        let mut path = Path2 { start, segments: Vec::new(), is_closed };
        for raw in list? {
            let from = path.segments.last().map_or(start, |s| s.end);
            let segment = self.segment(raw, from)?;
            if segment.arc.is_none() && segment.end == from {
                let message = format!("this line has no length: it starts at ({}, {}) already", from[0], from[1]);
                return self.fail(raw, "not-positive", message, "take it out; a closed path ends at its start by itself");
            }
            path.segments.push(segment);
        }
        let extent = path.segments.iter().map(|s| distance(s.end, start)).fold(0.0, f64::max);
        match path.segments.last_mut() {
            None => {
                let hint = "write segments: [Line(to: (x, y)), Arc(to: (x, y), center: (x, y))]";
                return self.fail(owner.raw, "wrong-length", "a path needs segments", hint);
            }
            Some(last) if is_closed && distance(last.end, start) <= CLOSED * extent => last.end = start,
            Some(_) if is_closed => path.segments.push(line(start)),
            Some(_) => {}
        }
        Some(path)
    }

    fn segment(&mut self, raw: Raw<'a>, from: [f64; 2]) -> Option<Segment2> {
        match self.read::<ast::Segment>(raw)? {
            ast::Segment::Line(node) => {
                let to = self.need(Owner { kind: "Line", raw }, "to", node.to).and_then(|raw| self.point2("to", raw));
                let name = self.maybe(node.name, |r, raw| r.name("name of a side", raw));
                Some(Segment2 { name: name?, ..line(to?) })
            }
            ast::Segment::Arc(node) => {
                let name = self.maybe(node.name, |r, raw| r.name("name of a side", raw));
                let segment = self.arc(Owner { kind: "Arc", raw }, &node, from);
                Some(Segment2 { name: name?, ..segment? })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stadium_has_no_sides_of_length_zero() {
        let stadium = rounded_rectangle([0.0, 0.0], [4.0, 2.0], 1.0);
        assert_eq!(stadium.segments.len(), 6);
        assert_eq!(stadium.segments.last().map(|s| s.end), Some(stadium.start));
    }
}
