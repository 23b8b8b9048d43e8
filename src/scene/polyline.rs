//! Whether profiles and paths are simple: arcs are replaced by chords of at most one degree, and no two chords may touch but
//! neighbours at their common end. Signs are exact; O(n log n) for n chords in general position.

use super::model::{Arc2, Path2, Profile, Segment2};
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use crate::geom::bvh::Bvh;
use crate::geom::plane::distance;
use crate::geom::predicates::orient2d;
use std::f64::consts::{PI, TAU};

/// Chords of arcs for these tests: 1 degree, off the arc by 4e-5 of its radius.
const CHORD: f64 = PI / 180.0;
/// Sine of the bend between an arc of a path and its neighbour that still counts as smooth: what typed decimals leave.
const SMOOTH: f64 = 1e-4;

type Point = [f64; 2];

fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}
fn cross(a: Point, b: Point) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}
fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}
fn length(a: Point) -> f64 {
    libm::hypot(a[0], a[1])
}

/// First angle and signed sweep of an arc from `from` to `to`, in radians; ends that coincide make a full circle.
pub(super) fn arc_angles(from: Point, to: Point, arc: &Arc2) -> (f64, f64) {
    let (u, v) = (minus(from, arc.center), minus(to, arc.center));
    let first = libm::atan2(u[1], u[0]);
    let turn = libm::atan2(cross(u, v), dot(u, v));
    let positive = |angle: f64| if angle <= 0.0 { angle + TAU } else { angle };
    let sweep = match (from == to, arc.is_ccw) {
        (true, true) => TAU,
        (true, false) => -TAU,
        (false, true) => positive(turn),
        (false, false) => -positive(-turn),
    };
    (first, sweep)
}

/// The segments of a path with their first points.
pub(super) fn walk(path: &Path2) -> impl Iterator<Item = (Point, &Segment2)> {
    let starts = std::iter::once(path.start).chain(path.segments.iter().map(|s| s.end));
    starts.zip(&path.segments)
}

/// The points of a path with its arcs as chords; a closed one does not repeat its first point.
fn points(path: &Path2) -> Vec<Point> {
    let mut points = vec![path.start];
    for (from, segment) in walk(path) {
        if let Some(arc) = &segment.arc {
            let (first, sweep) = arc_angles(from, segment.end, arc);
            let radius = distance(from, arc.center);
            let chords = libm::ceil(sweep.abs() / CHORD).max(2.0) as usize;
            points.extend((1..chords).map(|k| {
                let (s, c) = libm::sincos(first + sweep * k as f64 / chords as f64);
                [arc.center[0] + radius * c, arc.center[1] + radius * s]
            }));
        }
        points.push(segment.end);
    }
    if path.is_closed {
        points.pop();
    }
    points
}

/// Smallest and largest coordinates of a path.
pub(super) fn bounds(path: &Path2) -> [Point; 2] {
    let mut all = vec![path.start];
    for (from, segment) in walk(path) {
        all.push(segment.end);
        let Some(arc) = &segment.arc else { continue };
        let (first, sweep) = arc_angles(from, segment.end, arc);
        let radius = distance(from, arc.center);
        for (k, [x, y]) in [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]].into_iter().enumerate() {
            // How far along the arc its extreme point lies.
            let along = libm::fmod((k as f64 * 0.5 * PI - first) * sweep.signum() + 2.0 * TAU, TAU);
            if along <= sweep.abs() {
                all.push([arc.center[0] + radius * x, arc.center[1] + radius * y]);
            }
        }
    }
    let fold = |pick: fn(f64, f64) -> f64| all.iter().fold(path.start, |m, p| [pick(m[0], p[0]), pick(m[1], p[1])]);
    [fold(f64::min), fold(f64::max)]
}

/// A closed or open polyline.
struct Polyline {
    points: Vec<Point>,
    is_closed: bool,
}

/// What makes polylines touch themselves or each other, and where.
fn touching(lines: &[Polyline]) -> Option<(String, Point)> {
    // Chords as (line, number, ends).
    let mut chords: Vec<(usize, usize, Point, Point)> = Vec::new();
    for (l, line) in lines.iter().enumerate() {
        let n = line.points.len();
        let count = if line.is_closed { n } else { n - 1 };
        chords.extend((0..count).map(|k| (l, k, line.points[k], line.points[(k + 1) % n])));
    }
    if let Some(flat) = chords.iter().find(|c| c.2 == c.3) {
        return Some(("two consecutive points are equal".into(), flat.2));
    }
    let space = |p: Point| Vec3::new(p[0], p[1], 0.0);
    let boxes: Vec<Aabb> = chords.iter().map(|c| Aabb::around([&space(c.2), &space(c.3)])).collect();
    let tree = Bvh::new(boxes.clone());
    for (i, one) in chords.iter().enumerate() {
        let mut first: Option<usize> = None;
        tree.overlapping(&boxes[i], |j| {
            let j = j as usize;
            if i < j && first.is_none_or(|f| j < f) && is_fault(one, &chords[j], lines) {
                first = Some(j);
            }
        });
        if let Some(other) = first.and_then(|j| chords.get(j)) {
            let what = if one.0 == other.0 { "it touches or crosses itself" } else { "two of its loops touch or cross" };
            return Some((what.into(), other.2));
        }
    }
    None
}

fn is_fault(one: &(usize, usize, Point, Point), other: &(usize, usize, Point, Point), lines: &[Polyline]) -> bool {
    let count = lines[one.0].points.len();
    let is_next = |k: usize, m: usize| k + 1 == m || (lines[one.0].is_closed && k + 1 == count && m == 0);
    let (a, b, c, d) = (one.2, one.3, other.2, other.3);
    let folds = |p: Point, q: Point, r: Point| orient2d(p, q, r) == 0 && dot(minus(p, q), minus(r, q)) > 0.0;
    if one.0 == other.0 && (is_next(one.1, other.1) || is_next(other.1, one.1)) {
        let after = is_next(one.1, other.1) && folds(a, b, d);
        let before = is_next(other.1, one.1) && folds(c, d, b);
        return after || before;
    }
    let (s, t) = (orient2d(a, b, c), orient2d(a, b, d));
    let (u, v) = (orient2d(c, d, a), orient2d(c, d, b));
    // On one line, chords whose boxes overlap touch; else each must not lie to one side of the other.
    s * t <= 0 && u * v <= 0 && boxes_touch(a, b, c, d)
}

fn boxes_touch(a: Point, b: Point, c: Point, d: Point) -> bool {
    (0..2).all(|k| a[k].min(b[k]) <= c[k].max(d[k]) && c[k].min(d[k]) <= a[k].max(b[k]))
}

fn is_inside(p: Point, polygon: &[Point]) -> bool {
    let mut inside = false;
    for (k, &b) in polygon.iter().enumerate() {
        let a = polygon[(k + polygon.len() - 1) % polygon.len()];
        if (a[1] > p[1]) != (b[1] > p[1]) {
            let (lower, upper) = if a[1] < b[1] { (a, b) } else { (b, a) };
            inside ^= orient2d(lower, upper, p) > 0;
        }
    }
    inside
}

/// What is wrong with a profile, and near which point: a loop that touches itself or another, a hole outside or in a hole.
pub(super) fn profile_fault(profile: &Profile) -> Option<(String, Point)> {
    let loops: Vec<&Path2> = std::iter::once(&profile.outer).chain(&profile.holes).collect();
    if let Some(circles) = loops.iter().map(|l| full_circle(l)).collect::<Option<Vec<_>>>() {
        return circles_fault(&circles);
    }
    let lines: Vec<Polyline> = loops.iter().map(|l| Polyline { points: points(l), is_closed: true }).collect();
    if let Some(short) = lines.iter().find(|l| l.points.len() < 3) {
        return Some(("a loop needs three sides or an arc".into(), short.points[0]));
    }
    touching(&lines).or_else(|| misplaced_hole(&lines))
}

/// A hole outside of the first loop or in another hole; the loops do not touch.
fn misplaced_hole(lines: &[Polyline]) -> Option<(String, Point)> {
    let (outer, holes) = lines.split_first()?;
    let space = |p: &Point| Vec3::new(p[0], p[1], 0.0);
    let around = |hole: &Polyline| Aabb::around(&hole.points.iter().map(space).collect::<Vec<_>>());
    let tree = Bvh::new(holes.iter().map(around).collect());
    holes.iter().enumerate().find_map(|(k, hole)| {
        let p = hole.points[0];
        if !is_inside(p, &outer.points) {
            return Some(("a hole lies outside of the outer loop".into(), p));
        }
        let mut is_in_another = false;
        tree.overlapping(&Aabb::around([&space(&p)]), |m| {
            is_in_another |= m as usize != k && is_inside(p, &holes[m as usize].points);
        });
        is_in_another.then(|| ("a hole lies in another hole".into(), p))
    })
}

/// Centre and radius, if the path is one full circle.
pub(super) fn full_circle(path: &Path2) -> Option<(Point, f64)> {
    match path.segments.as_slice() {
        [Segment2 { end, arc: Some(arc), .. }] if *end == path.start => Some((arc.center, distance(path.start, arc.center))),
        _ => None,
    }
}

fn circles_fault(circles: &[(Point, f64)]) -> Option<(String, Point)> {
    let (outer, holes) = circles.split_first()?;
    for (k, hole) in holes.iter().enumerate() {
        if distance(hole.0, outer.0) + hole.1 >= outer.1 {
            return Some(("a hole touches the outer loop or lies outside of it".into(), hole.0));
        }
        if holes[..k].iter().any(|other| distance(hole.0, other.0) <= hole.1 + other.1) {
            return Some(("two holes touch".into(), hole.0));
        }
    }
    None
}

/// Where a path touches itself.
pub(super) fn path_fault(path: &Path2) -> Option<(String, Point)> {
    if full_circle(path).is_some() {
        return None;
    }
    touching(&[Polyline { points: points(path), is_closed: path.is_closed }])
}

/// Directions at the start and the end of a segment.
fn directions(from: Point, segment: &Segment2) -> [Point; 2] {
    let unit = |v: Point| [v[0] / length(v), v[1] / length(v)];
    match &segment.arc {
        None => [unit(minus(segment.end, from)); 2],
        Some(arc) => [from, segment.end].map(|p| {
            let [x, y] = unit(minus(p, arc.center));
            if arc.is_ccw { [-y, x] } else { [y, -x] }
        }),
    }
}

/// The joints of a path: numbers of the two segments, point, directions before and after.
fn joints(path: &Path2) -> impl Iterator<Item = (usize, usize, Point, Point, Point)> {
    let all: Vec<[Point; 2]> = walk(path).map(|(from, s)| directions(from, s)).collect();
    let n = all.len();
    let count = if path.is_closed && full_circle(path).is_none() { n } else { n.saturating_sub(1) };
    (0..count).map(move |k| (k, (k + 1) % n, path.segments[k].end, all[k][1], all[(k + 1) % n][0]))
}

/// Where an arc of a path meets its neighbour with a bend, as a mitre has no meaning there, and whether it turns right back,
/// as arcs do that run the wrong way round.
pub(super) fn tangent_fault(path: &Path2) -> Option<(Point, bool)> {
    let is_arc = |k: usize| path.segments[k].arc.is_some();
    joints(path).filter(|&(k, m, ..)| is_arc(k) || is_arc(m)).find_map(|(_, _, p, d, e)| {
        let (is_straight, is_back) = (cross(d, e).abs() <= SMOOTH, dot(d, e) < 0.0);
        (is_back || !is_straight).then_some((p, is_back && is_straight))
    })
}

/// Where a profile from x = `lo` to `hi` (to the right of the path) does not pass: on the inner side of an arc, between two
/// mitres, or because the sweep meets itself.
pub(super) fn is_swept_clear(path: &Path2, lo: f64, hi: f64) -> Option<Point> {
    // Change of a segment's length per unit of x, from the mitres at its ends.
    let mut shift = vec![0.0; path.segments.len()];
    for (k, m, _, d, e) in joints(path) {
        let half = libm::tan(0.5 * libm::atan2(cross(d, e), dot(d, e)));
        shift[k] += half;
        shift[m] += half;
    }
    for ((from, segment), shift) in walk(path).zip(shift) {
        let is_good = match &segment.arc {
            Some(arc) if arc.is_ccw => distance(from, arc.center) + lo > 0.0,
            Some(arc) => distance(from, arc.center) - hi > 0.0,
            None => [lo, hi].iter().all(|x| distance(segment.end, from) + x * shift > 0.0),
        };
        if !is_good {
            return Some(from);
        }
    }
    let (right, mut left) = (offset(path, hi), offset(path, lo));
    let outline = if path.is_closed {
        vec![Polyline { points: right, is_closed: true }, Polyline { points: left, is_closed: true }]
    } else {
        left.reverse();
        vec![Polyline { points: [right, left].concat(), is_closed: true }]
    };
    touching(&outline).map(|(_, p)| p)
}

/// The path moved by `x` to its right, with mitred corners.
fn offset(path: &Path2, x: f64) -> Vec<Point> {
    let points = points(path);
    let n = points.len();
    let direction = |k: usize| {
        let v = minus(points[(k + 1) % n], points[k % n]);
        [v[0] / length(v), v[1] / length(v)]
    };
    (0..n)
        .map(|k| {
            let before = if k > 0 || path.is_closed { direction(k + n - 1) } else { direction(0) };
            let after = if k + 1 < n || path.is_closed { direction(k) } else { before };
            // The mitre: perpendicular to the sum of the directions, its length so that both sides keep the distance.
            let sum = [before[0] + after[0], before[1] + after[1]];
            let scale = 2.0 * x / dot(sum, sum);
            [points[k][0] + sum[1] * scale, points[k][1] - sum[0] * scale]
        })
        .collect()
}
