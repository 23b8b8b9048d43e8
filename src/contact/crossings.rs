//! Contacts between edges: end on edge, edge across edge, edge along edge.

use super::body::{Body, Names};
use super::candidates::PARALLEL_FROM;
use super::edges::EdgeSet;
use crate::diag::{Diagnostic, Name, Outcome};
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use rayon::prelude::*;

/// Rounds in which points inserted into one edge may reach the next. Every round carries a point over one more edge, and a
/// point is on few edges; more means a chain of nearly parallel edges that creeps beyond the tolerance.
const MAX_ROUNDS: usize = 16;

/// Relative error of a cross product of two differences, generously.
const NORMAL_ERROR: f64 = 16.0 * f64::EPSILON;

/// Tolerances that are more than one whatever the rounding: the smallest is of four units in the last place.
const CLEARLY: f64 = 4.0;

/// Two edges within the tolerance.
struct Meeting {
    edges: [u32; 2],
    tolerance: f64,
    /// For each edge, the parameters between which it is within the tolerance of the other, and somewhat more.
    windows: [[f64; 2]; 2],
    touch: Touch,
    /// A point that both got.
    common: u32,
}

enum Touch {
    /// Ends on the other edge: (edge 0 or 1 that receives, parameter, point).
    Ends(Vec<(usize, f64, u32)>),
    /// Both cross inside, at this place on the first.
    Across(Vec3),
}

/// Gives all edges of different leaves that come within the tolerance common points, up to a fixpoint.
pub(super) fn connect(body: &mut Body, set: &mut EdgeSet, pairs: &[[u32; 2]], names: Names) -> Outcome<()> {
    let mut meetings = meetings(body, set, pairs);
    set.reserve(meetings.len());
    for meeting in &mut meetings {
        if let Touch::Ends(ends) = &meeting.touch {
            for &(k, s, point) in ends {
                set.insert(meeting.edges[k], s, point);
                meeting.common = point;
            }
        }
    }
    for meeting in &mut meetings {
        if let Touch::Across(x) = meeting.touch {
            let lines = meeting.edges.map(|e| set.ends(e, &body.points));
            meeting.common = cross(body, set, &meeting.edges, &lines, meeting.tolerance, x);
        }
    }
    set.sort();
    // Edges with points that those which they meet may lack.
    let mut is_new = vec![true; set.edges.len()];
    for _ in 0..MAX_ROUNDS {
        let search = |m: &Meeting| carried(body, set, m, &is_new);
        let found: Vec<(u32, f64, u32)> = if meetings.len() >= PARALLEL_FROM {
            meetings.par_iter().flat_map_iter(search).collect()
        } else {
            meetings.iter().flat_map(search).collect()
        };
        is_new.fill(false);
        for (edge, s, point) in found {
            is_new[edge as usize] |= set.insert(edge, s, point);
        }
        if !is_new.contains(&true) {
            return Ok(());
        }
        set.sort();
    }
    let [a, b] = meetings.first().map_or(Default::default(), |m| m.edges.map(|e| body_name(set, e, names)));
    Err(vec![
        Diagnostic::error("contact-unresolved", format!("contacts spread without end, beginning at {a} and {b}"))
            .at(a.span)
            .hint("edges lie nearly along each other at about the tolerance: choose another `tolerance`"),
    ])
}

fn body_name(set: &EdgeSet, edge: u32, names: Names) -> Name {
    set.leaves(edge).first().map_or(Name::default(), |&l| names(crate::ids::LeafId(l)))
}

fn meetings(body: &Body, set: &EdgeSet, pairs: &[[u32; 2]]) -> Vec<Meeting> {
    let search = |chunk: &[[u32; 2]]| {
        let mut found = Vec::new();
        chunk.iter().for_each(|&pair| meetings_of_pair(body, set, pair, &mut found));
        found
    };
    if pairs.len() >= PARALLEL_FROM {
        let lists: Vec<Vec<Meeting>> = pairs.par_chunks(pairs.len().div_ceil(256)).map(search).collect();
        lists.into_iter().flatten().collect()
    } else {
        search(pairs)
    }
}

fn meetings_of_pair(body: &Body, set: &EdgeSet, [f, g]: [u32; 2], found: &mut Vec<Meeting>) {
    let tolerance = body.tolerance(body.leaf_of_facet[f as usize], body.leaf_of_facet[g as usize]);
    let (mine, yours) = (set.own.of(f), set.own.of(g));
    let mut test = |a: u32, near: &Aabb, b: u32| {
        if a != b
            && near.overlaps(set.bounds(b))
            && let Some(m) = meet(body, set, [a, b], tolerance)
        {
            found.push(m);
        }
    };
    if !set.has_many(f) && !set.has_many(g) {
        for &a in mine {
            let near = set.bounds(a).inflated(tolerance);
            yours.iter().for_each(|&b| test(a, &near, b));
        }
        return;
    }
    set.own_near(f, &set.own_bounds(g).inflated(tolerance), |a| {
        let near = set.bounds(a).inflated(tolerance);
        set.own_near(g, &near, |b| test(a, &near, b));
    });
}

/// Parameter of the point of the line through `p` nearest to `x`, and the distance from the line.
pub(super) fn onto_line(p: &[Vec3; 2], x: &Vec3) -> (f64, f64) {
    let d = p[1] - p[0];
    let s = (x - p[0]).dot(&d) / d.norm_squared();
    // From the nearer end, so that long edges lose no digits.
    let from = if s > 0.5 { p[1] } else { p[0] };
    (s, (x - from).cross(&d).norm() / d.norm())
}

/// Parameter at which `x` lies on the inside of segment `p`, if it does within the tolerance. Next to an end that is itself
/// just beyond the tolerance, a new point would be a feature below it.
fn inside_of(p: &[Vec3; 2], x: &Vec3, tolerance: f64) -> Option<f64> {
    let (s, distance) = onto_line(p, x);
    let is_on = distance <= tolerance && s > 0.0 && s < 1.0 && p.iter().all(|c| (c - x).norm() > tolerance);
    is_on.then_some(s)
}

/// How two edges meet within the tolerance, if they do other than in a common end.
fn meet(body: &Body, set: &EdgeSet, edges: [u32; 2], tolerance: f64) -> Option<Meeting> {
    let ids = edges.map(|e| set.edges[e as usize].ends);
    let [p, q] = edges.map(|e| set.ends(e, &body.points));
    let (d, e, between) = (p[1] - p[0], q[1] - q[0], q[0] - p[0]);
    let normal = d.cross(&e);
    let (area, lengths) = (normal.norm(), [d.norm(), e.norm()]);
    let sides = lengths[0] * lengths[1];
    // The most frequent case: two edges with a common end, whose other ends are well beside the other edge.
    let is_joined = ids[0].iter().any(|v| ids[1].contains(v));
    if is_joined && area > CLEARLY * tolerance * lengths[0].max(lengths[1]) {
        return None;
    }
    // Cheapest rejection: their lines stay apart. The second term is the rounding error of the normal, which decides when they
    // are nearly parallel.
    if between.dot(&normal).abs() > tolerance * area + NORMAL_ERROR * between.norm() * sides {
        return None;
    }
    if set.leaves(edges[0]).iter().any(|l| set.leaves(edges[1]).contains(l)) {
        return None;
    }
    let width = 2.0 * tolerance * (1.0 + sides / area.max(f64::MIN_POSITIVE));
    let window = |line: &[Vec3; 2], other: &[Vec3; 2], x: &Vec3| {
        let along = line[1] - line[0];
        let length = along.norm();
        let at = |x: &Vec3| (x - line[0]).dot(&along) / (length * length);
        let (s, t, reach) = (at(&other[0]), at(&other[1]), 2.0 * tolerance / length);
        let (at, w) = (onto_line(line, x).0, width / length);
        [(at - w).max(s.min(t) - reach), (at + w).min(s.max(t) + reach)]
    };
    let mut ends = Vec::new();
    for (receiver, line) in [(0, &p), (1, &q)] {
        for &v in ids[1 - receiver].iter().filter(|v| !ids[receiver].contains(v)) {
            if let Some(s) = inside_of(line, &body.points[v as usize], tolerance) {
                ends.push((receiver, s, v));
            }
        }
    }
    if let Some(end) = ends.first() {
        let x = body.points[end.2 as usize];
        return Some(Meeting {
            edges,
            tolerance,
            windows: [window(&p, &q, &x), window(&q, &p, &x)],
            touch: Touch::Ends(ends),
            common: u32::MAX,
        });
    }
    // Two straight edges with a common end do not cross elsewhere.
    if is_joined {
        return None;
    }
    let x = across(&p, &q, tolerance)?;
    Some(Meeting {
        edges,
        tolerance,
        windows: [window(&p, &q, &x), window(&q, &p, &x)],
        touch: Touch::Across(x),
        common: u32::MAX,
    })
}

/// Where the insides of two segments come within the tolerance of each other, on the first.
pub(super) fn across(p: &[Vec3; 2], q: &[Vec3; 2], tolerance: f64) -> Option<Vec3> {
    let (d, e) = (p[1] - p[0], q[1] - q[0]);
    let normal = d.cross(&e);
    let x = p[0] + d * ((q[0] - p[0]).cross(&e).dot(&normal) / normal.norm_squared());
    inside_of(p, &x, tolerance)?;
    inside_of(q, &x, tolerance)?;
    Some(x)
}

/// Gives edges that cross `x`, on the first of the lines, a common point: one that is there already within the tolerance of all
/// lines, else a new one. The first lines are those of the edges. Yields the point.
pub(super) fn cross(body: &mut Body, set: &mut EdgeSet, edges: &[u32], lines: &[[Vec3; 2]], tolerance: f64, x: Vec3) -> u32 {
    let mut nearest: Option<(f64, u32)> = None;
    body.grid.near(&x, tolerance, |entry, distance| {
        let better = nearest.is_none_or(|(d, v)| (distance, entry.point) < (d, v));
        let is_itself = body.points[entry.point as usize] == entry.position;
        if better
            && is_itself
            && lines.iter().all(|line| onto_line(line, &entry.position).1 <= tolerance)
            && edges.iter().all(|&edge| set.can_insert(edge, entry.point))
        {
            nearest = Some((distance, entry.point));
        }
    });
    let point = nearest.map_or(body.points.len() as u32, |n| n.1);
    if nearest.is_none() {
        body.points.push(x);
        body.grid.add(x, point, tolerance);
    }
    let place = body.points[point as usize];
    for (&edge, line) in edges.iter().zip(lines) {
        set.insert(edge, onto_line(line, &place).0, point);
    }
    point
}

/// Whether two edges have the same points, in order, where they are near each other: edges along each other may have many.
fn agree(set: &EdgeSet, meeting: &Meeting) -> bool {
    let [a, b] = [0, 1].map(|k| {
        let edge = &set.edges[meeting.edges[k] as usize];
        let (inserted, [lo, hi]) = (&edge.inserted, meeting.windows[k]);
        let first = inserted.partition_point(|i| i.0 < lo);
        let other = set.edges[meeting.edges[1 - k] as usize].ends;
        let near = &inserted[first..first + inserted[first..].partition_point(|i| i.0 <= hi)];
        // An end of the one is no point between the ends of the other.
        let is_end = |i: &(f64, u32)| other.contains(&i.1);
        let near = &near[usize::from(near.first().is_some_and(is_end))..];
        &near[..near.len() - usize::from(near.last().is_some_and(is_end))]
    });
    a.len() == b.len() && (a.iter().zip(b).all(|(x, y)| x.1 == y.1) || a.iter().zip(b.iter().rev()).all(|(x, y)| x.1 == y.1))
}

/// Points of one of two edges, if it has new ones, that belong on the other as well.
fn carried(body: &Body, set: &EdgeSet, meeting: &Meeting, is_new: &[bool]) -> Vec<(u32, f64, u32)> {
    let mut found = Vec::new();
    if meeting.edges.iter().all(|&e| !is_new[e as usize]) || agree(set, meeting) {
        return found;
    }
    for k in [0, 1] {
        let (from, to) = (meeting.edges[k], meeting.edges[1 - k]);
        if !is_new[from as usize] {
            continue;
        }
        let [lo, hi] = meeting.windows[k];
        let inserted = &set.edges[from as usize].inserted;
        let first = inserted.partition_point(|i| i.0 < lo);
        let line = set.ends(to, &body.points);
        let between = inserted[first..].iter().take_while(|i| i.0 <= hi).map(|i| i.1);
        for point in between.filter(|&point| point != meeting.common) {
            let inside = inside_of(&line, &body.points[point as usize], meeting.tolerance);
            if let Some(s) = inside.filter(|_| set.lacks(to, point)) {
                found.push((to, s, point));
            }
        }
    }
    found
}
