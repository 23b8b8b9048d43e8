//! Angular breakpoints belong to the axis: all circles and arcs about one line are divided alike, whoever wrote them.
//!
//! The rule. Circles and arcs whose axes agree within the contact tolerance, in either direction, form a group; so do ellipses,
//! which unequal scales make of them, if they are parallel and similar.
//! 1. *Hard* breakpoints are the ends of all arcs and partial sweeps of the group, and the start of a full revolution that was
//!    written with one; those that agree within the tolerance are one (the earliest leaf's).
//! 2. The gap between two neighbouring hard breakpoints is divided into equal parts, the fewest that are no longer than the
//!    finest segment anybody in the group asked for.
//! 3. Without hard breakpoints the whole turn is divided so, from the first leaf's angle 0.
//! 4. A circle uses all breakpoints, an arc those between its ends.
//!
//! So two surfaces of a group that share a circle share its vertices, no chord is longer than asked for, and none is a sliver
//! unless somebody wrote two ends that close. Dividing the gaps replaces the regular division with dropped neighbours that
//! `design.md` proposes: on the reference machine (24 segments, slots of 14 degrees, magnets of 60) it needs 36 breakpoints
//! instead of 48 at the same chord error, and needs no rule for what is too close.
//!
//! Different axes never influence each other. A group with more than `MAX_SHARED` hard breakpoints is not shared: with k
//! arcs and m full circles it would have k m facets.

use super::angle;
use super::circle::{Axis, Breakpoint, Circle, CircleRequest};
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use std::collections::{BTreeMap, HashMap};

/// Hard breakpoints that a group may share: a machine with 500 slots has 1000.
const MAX_SHARED: usize = 2000;
/// Cells of the look-up for axes, as a fraction of the model: far above the tolerance, far below real distances.
const CELL: f64 = 1e-6;
/// Angles nearer than this (degrees) are one even if the tolerance is finer: it is what conversions lose.
const SAME_ANGLE: f64 = 1e-10;
/// Axes of ellipses that agree to this fraction agree if the tolerance is finer: some rotations and scales of rounding.
const SIMILAR: f64 = 1e-12;

/// A request in its group.
struct Member {
    request: usize,
    /// From local radii to lengths along the axis' x.
    scale: f64,
    /// Axis degrees of the leaf's local angle 0.
    phase: f64,
    sense: f64,
}

struct Group {
    axis: Axis,
    members: Vec<Member>,
}

/// A box that holds what is divided.
pub(crate) fn bounds<'a>(requests: impl Iterator<Item = &'a CircleRequest>) -> Aabb {
    requests.fold(Aabb::EMPTY, |b, r| {
        let reach = r.radius * r.place.axes[0].norm();
        r.axis_ends().iter().fold(b, |b, p| b.union(&Aabb { lo: *p, hi: *p }.inflated(reach)))
    })
}

/// Divides all requests, in order; `tolerance` is a fraction of `size`, the model's.
pub(crate) fn divide(requests: &[CircleRequest], tolerance: f64, size: f64) -> Vec<Circle> {
    let groups = find_groups(requests, tolerance, size, bounds(requests.iter()).center());
    let mut circles: Vec<Option<Circle>> = requests.iter().map(|_| None).collect();
    let mut number = 0;
    for group in &groups {
        let shares = group.members.iter().filter(|m| has_ends(&requests[m.request])).count() * 2 <= MAX_SHARED;
        let parts = group.members.chunks(if shares { group.members.len() } else { 1 });
        for members in parts {
            divide_group(&group.axis, number, members, requests, tolerance * size, &mut circles);
            number += 1;
        }
    }
    circles.into_iter().flatten().collect()
}

fn has_ends(request: &CircleRequest) -> bool {
    !request.is_full() || request.is_start_chosen
}

fn find_groups(requests: &[CircleRequest], tolerance: f64, size: f64, center: Vec3) -> Vec<Group> {
    let cell = size * CELL.max(4.0 * tolerance);
    let mut groups: Vec<Group> = Vec::new();
    let mut lookup: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
    for (k, request) in requests.iter().enumerate() {
        let [x, y, z] = request.place.axes;
        let origin = request.place.point(request.center[0], request.center[1], 0.0);
        let direction = z.normalize();
        let nearest = origin + direction * (center - origin).dot(&direction);
        let slot: [i64; 3] = std::array::from_fn(|i| (nearest[i] / cell).floor() as i64);
        let found = neighbours(slot).find_map(|s| {
            let candidates = lookup.get(&s)?;
            let on_axis = candidates.iter().filter(|&&g| is_on_axis(request, &direction, &groups[g].axis, tolerance, size));
            on_axis.copied().find_map(|g| Some((g, place_in(&groups[g].axis, k, request, tolerance)?)))
        });
        match found {
            Some((g, member)) => groups[g].members.push(member),
            None => {
                lookup.entry(slot).or_default().push(groups.len());
                let (x, y, scale) = match request.place.circle_scale() {
                    Some(scale) => (x.normalize(), y.normalize(), scale),
                    None => (x, y, 1.0),
                };
                let axis = Axis { origin, z: direction, x, y };
                groups.push(Group { axis, members: vec![Member { request: k, scale, phase: 0.0, sense: 1.0 }] });
            }
        }
    }
    groups
}

fn neighbours(slot: [i64; 3]) -> impl Iterator<Item = [i64; 3]> {
    (0..27)
        .map(move |k| [k / 9 - 1, k / 3 % 3 - 1, k % 3 - 1])
        .map(move |d| std::array::from_fn(|i| slot[i].saturating_add(d[i])))
}

/// Whether the piece of axis that a request uses lies on the line, and its circles turn in the same planes.
fn is_on_axis(request: &CircleRequest, direction: &Vec3, axis: &Axis, tolerance: f64, size: f64) -> bool {
    direction.cross(&axis.z).norm() <= tolerance
        && request.axis_ends().iter().all(|p| {
            let away = p - axis.origin;
            (away - axis.z * away.dot(&axis.z)).norm() <= tolerance * size
        })
}

/// Where a request's circles lie in an axis; `None` if they are no circles there (of ellipses: similar and parallel ones).
fn place_in(axis: &Axis, number: usize, request: &CircleRequest, tolerance: f64) -> Option<Member> {
    let [x, y, _] = request.place.axes;
    let tolerance = tolerance.max(SIMILAR);
    // Images of the local directions in the coordinates of the axis.
    let (xx, xy, yy) = (axis.x.norm_squared(), axis.x.dot(&axis.y), axis.y.norm_squared());
    let determinant = xx * yy - xy * xy;
    let inner = |v: &Vec3| {
        let (a, b) = (v.dot(&axis.x), v.dot(&axis.y));
        [(a * yy - b * xy) / determinant, (b * xx - a * xy) / determinant]
    };
    let ([a, b], [c, d]) = (inner(&x), inner(&y));
    let scale = libm::hypot(a, b);
    let sense = if a * d - b * c >= 0.0 { 1.0 } else { -1.0 };
    let is_turned = (c + sense * b).abs() <= tolerance * scale && (d - sense * a).abs() <= tolerance * scale;
    let is_in_plane = |v: &Vec3, [a, b]: [f64; 2]| (v - (axis.x * a + axis.y * b)).norm() <= tolerance * v.norm();
    let is_alike = is_turned && is_in_plane(&x, [a, b]) && is_in_plane(&y, [c, d]);
    let scale = request.place.circle_scale().unwrap_or(scale);
    is_alike.then(|| Member { request: number, scale, phase: angle::of_direction(a, b), sense })
}

/// Ordered canonical degrees; non-negative numbers are ordered as their bits.
type Degrees = BTreeMap<u64, f64>;

/// The entry nearest to `degrees` within `reach`, also across 0.
fn find_near(known: &Degrees, degrees: f64, reach: f64) -> Option<f64> {
    let below = known.range(..=degrees.to_bits()).next_back().or_else(|| known.iter().next_back());
    let above = known.range(degrees.to_bits()..).next().or_else(|| known.iter().next());
    let distance = |d: f64| {
        let a = (d - degrees).abs();
        a.min(360.0 - a)
    };
    let nearest = [below, above].into_iter().flatten().map(|e| *e.1).min_by(|a, b| distance(*a).total_cmp(&distance(*b)));
    nearest.filter(|d| distance(*d) <= reach)
}

fn divide_group(
    axis: &Axis,
    group: usize,
    members: &[Member],
    requests: &[CircleRequest],
    tolerance: f64,
    circles: &mut [Option<Circle>],
) {
    let of = |m: &Member| &requests[m.request];
    let radius = members.iter().map(|m| of(m).radius * of(m).place.axes[0].norm()).fold(0.0, f64::max);
    let segments = members.iter().map(|m| of(m).segments).max().unwrap_or(3);
    let reach = (tolerance / radius).to_degrees().max(SAME_ANGLE);
    let absolute = |m: &Member, local: f64| angle::canonical(angle::tidy(m.phase + m.sense * local));
    let ends = |m: &Member| [of(m).start, of(m).start + of(m).sweep].map(|local| absolute(m, local));
    let mut hard = Degrees::new();
    for end in members.iter().filter(|m| has_ends(of(m))).flat_map(ends) {
        if find_near(&hard, end, reach).is_none() {
            hard.insert(end.to_bits(), end);
        }
    }
    let first = members.first().map_or(0.0, |m| absolute(m, if of(m).is_full() { of(m).start } else { 0.0 }));
    let all = fill_gaps(&hard, first, segments);
    for member in members {
        let request = of(member);
        let [from, to] = ends(member).map(|e| find_near(&hard, e, reach).unwrap_or(e));
        let breakpoints = if request.is_full() {
            walk(&all, if hard.is_empty() { first } else { all[0].0 }, None, member.sense)
        } else if from == to && request.sweep < 180.0 {
            // An arc below the tolerance stays what it is, for the contact step to refuse by name; it is no full circle.
            let [from, to] = ends(member);
            let end = |degrees, along| Breakpoint { degrees, along, is_hard: true };
            vec![end(from, 0.0), end(to, request.sweep)]
        } else {
            walk(&all, from, Some(to), member.sense)
        };
        circles[member.request] = Some(place_circle((axis, group), member, request, breakpoints, segments));
    }
}

fn place_circle(
    (axis, group): (&Axis, usize),
    member: &Member,
    request: &CircleRequest,
    breakpoints: Vec<Breakpoint>,
    segments: u32,
) -> Circle {
    let own = request.place.point(request.center[0], request.center[1], 0.0);
    let z = request.place.axes[2].normalize();
    let begin = breakpoints.first().map_or(0.0, |b| angle::canonical(member.sense * (b.degrees - member.phase)));
    Circle {
        place: request.place.clone(),
        center: request.center,
        axis: axis.clone(),
        group,
        scale: member.scale,
        is_own_axis: own == axis.origin && (z == axis.z || z == -axis.z),
        sense: member.sense,
        start: if request.is_full() { angle::tidy(begin) } else { request.start },
        breakpoints,
        is_full: request.is_full(),
        segments,
    }
}

/// All breakpoints of a group in rising order with whether they are hard; steps 2 and 3 of the rule.
fn fill_gaps(hard: &Degrees, first: f64, segments: u32) -> Vec<(f64, bool)> {
    let starts: Vec<f64> = if hard.is_empty() { vec![first] } else { hard.values().copied().collect() };
    let mut all = Vec::new();
    for (k, &a) in starts.iter().enumerate() {
        let b = starts.get(k + 1).copied().unwrap_or(starts[0] + 360.0);
        let gap = b - a;
        // A gap that is a whole number of segments must not get one more by rounding.
        let parts = (gap * f64::from(segments) / 360.0 * (1.0 - 1e-12)).ceil().max(1.0);
        all.push((a, !hard.is_empty()));
        all.extend((1..parts as u32).map(|i| (angle::canonical(angle::tidy(a + gap * f64::from(i) / parts)), false)));
    }
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all
}

/// The breakpoints from one to another (all round if there is no other) in the leaf's order.
fn walk(all: &[(f64, bool)], from: f64, to: Option<f64>, sense: f64) -> Vec<Breakpoint> {
    let n = all.len();
    let begin = all.partition_point(|b| b.0 < from).min(n - 1);
    let mut found = Vec::new();
    for step in 0..n + 1 {
        let k = if sense > 0.0 { (begin + step) % n } else { (begin + n - step % n) % n };
        let (degrees, is_hard) = all[k];
        if to.is_none() && step == n {
            break;
        }
        let along = if step == 0 { 0.0 } else { angle::canonical(sense * (degrees - from)) };
        let along = if step > 0 && along == 0.0 { 360.0 } else { along };
        found.push(Breakpoint { degrees, along, is_hard });
        if step > 0 && to == Some(degrees) {
            break;
        }
    }
    found
}

#[cfg(test)]
#[path = "axis_tests.rs"]
mod tests;
