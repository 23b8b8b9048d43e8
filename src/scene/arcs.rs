//! Arcs as they are written: by centre, by a third point, by radius or by angle.

use super::ast;
use super::curves::arc;
use super::model::Segment2;
use super::motion::sin_cos;
use super::reader::{MIN_SIZE, Owner, Reader};
use crate::diag::short;
use crate::geom::plane::distance;

/// How far the ends of an arc may differ in their distance from its centre, relative to it: what typed decimals leave.
const ARC_AGREEMENT: f64 = 1e-6;

impl<'a> Reader<'a> {
    /// An arc by `to` and `center`, `to` and `via`, `to` and `radius`, or `center` and `angle`.
    pub fn arc(&mut self, owner: Owner<'a>, node: &ast::Arc<'a>, from: [f64; 2]) -> Option<Segment2> {
        let to = self.maybe(node.to, |r, raw| r.point2("to", raw));
        let center = self.maybe(node.center, |r, raw| r.point2("center", raw));
        let via = self.maybe(node.via, |r, raw| r.point2("via", raw));
        let radius = self.maybe(node.radius, |r, raw| r.size("radius", raw));
        let angle = self.maybe(node.angle, |r, raw| r.degrees("angle", raw));
        let is_ccw = self.read_or(node.ccw, true);
        let is_large = self.read_or(node.large, false);
        let (is_ccw, is_large) = (is_ccw?, is_large?);
        let made = match (to?, center?, via?, radius?, angle?) {
            (Some(to), Some(center), None, None, None) => by_center(from, to, center, is_ccw),
            (Some(to), None, Some(via), None, None) => by_point(from, to, via),
            (Some(to), None, None, Some(radius), None) => by_radius(from, to, radius, is_ccw, is_large),
            (None, Some(center), None, None, Some(angle)) => by_angle(from, center, angle),
            _ => {
                let ways = "`to` and `center`, `to` and `via`, `to` and `radius`, or `center` and `angle`";
                let message = format!("an Arc needs either of {ways}");
                return self.fail(owner.raw, "missing-field", message, "give one of these pairs, and no more");
            }
        };
        made.map_err(|[message, hint]| self.fail::<()>(owner.raw, "bad-arc", message, hint)).ok()
    }
}

/// An arc, or what is wrong and what to do.
type Made = Result<Segment2, [String; 2]>;

fn by_center(from: [f64; 2], to: [f64; 2], center: [f64; 2], is_ccw: bool) -> Made {
    let (r, s) = (distance(center, from), distance(center, to));
    if r < MIN_SIZE || (r - s).abs() > ARC_AGREEMENT * r {
        let hint = "correct `to` or `center`, or give `to` and `radius`, from which the centre follows";
        return Err([format!("the ends of the arc lie {r} and {s} from its centre"), hint.into()]);
    }
    Ok(arc(to, center, is_ccw))
}

fn by_point(from: [f64; 2], to: [f64; 2], via: [f64; 2]) -> Made {
    let (center, is_ccw) = circumcenter(from, via, to)
        .ok_or_else(|| ["the three points of the arc lie on one line".to_owned(), "move `via`, or write a Line".to_owned()])?;
    Ok(arc(to, center, is_ccw))
}

fn by_radius(from: [f64; 2], to: [f64; 2], radius: f64, is_ccw: bool, is_large: bool) -> Made {
    let half = 0.5 * distance(from, to);
    if half < MIN_SIZE || half > radius {
        let hint = format!("the radius is half of the distance of its ends at least, {}, and not 0", short(half));
        return Err([format!("an arc of radius {radius} cannot span {}", short(2.0 * half)), hint]);
    }
    let height = libm::sqrt((radius - half) * (radius + half));
    // A small counter-clockwise arc has its centre to the left of its chord.
    let side = if is_ccw != is_large { height } else { -height };
    let along = [(to[0] - from[0]) / (2.0 * half), (to[1] - from[1]) / (2.0 * half)];
    let middle = [0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1])];
    Ok(arc(to, [middle[0] - side * along[1], middle[1] + side * along[0]], is_ccw))
}

fn by_angle(from: [f64; 2], center: [f64; 2], angle: f64) -> Made {
    let arm = [from[0] - center[0], from[1] - center[1]];
    if !(0.0 < angle.abs() && angle.abs() <= 360.0) || libm::hypot(arm[0], arm[1]) < MIN_SIZE {
        let message = "an arc needs a radius, and an angle up to 360 degrees other than 0";
        return Err([message.into(), "move `center` off the start of the arc, or correct `angle`".into()]);
    }
    let (s, c) = sin_cos(angle);
    let turned = [center[0] + arm[0] * c - arm[1] * s, center[1] + arm[0] * s + arm[1] * c];
    Ok(arc(if angle.abs() == 360.0 { from } else { turned }, center, angle > 0.0))
}

/// The centre of the circle through three points, and whether they run counter-clockwise.
fn circumcenter(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> Option<([f64; 2], bool)> {
    let (u, v) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]);
    let turn = crate::geom::predicates::orient2d(a, b, c);
    let twice = 2.0 * (u[0] * v[1] - u[1] * v[0]);
    let (uu, vv) = (u[0] * u[0] + u[1] * u[1], v[0] * v[0] + v[1] * v[1]);
    let center = [a[0] + (v[1] * uu - u[1] * vv) / twice, a[1] + (u[0] * vv - v[0] * uu) / twice];
    // A flatter arc than this is a line.
    let is_flat = twice.abs() <= 1e-12 * libm::sqrt(uu * vv);
    (turn != 0 && !is_flat).then_some((center, turn > 0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_points_make_an_arc() {
        let (center, is_ccw) = circumcenter([1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]).unwrap();
        assert_eq!((center, is_ccw), ([0.0, 0.0], true));
        assert!(circumcenter([0.0, 0.0], [1.0, 1.0], [2.0, 2.0]).is_none());
    }
}
