//! Cuts the strings on each triangle where they meet.

use super::graph::{Along, Curve, Graph, Mesh, StringPiece};
use super::point::{Place, Points, Source};
use crate::geom::aabb::Aabb;
use crate::geom::predicates::orient3d;
use rayon::prelude::*;
use std::cmp::Ordering;

/// A cut to be entered.
enum Cut {
    /// A known point lies on a curve.
    Known(Curve, u32),
    /// Two curves cross in a new point.
    New([Curve; 2], Source),
}

/// Finds all cuts (in parallel) and enters them (in order of the triangles).
pub fn cut(mesh: &Mesh, graph: &mut Graph, points: &mut Points) {
    let todo: Vec<u32> = (0..mesh.triangles.len() as u32)
        .filter(|&t| graph.drawing(t).is_some_and(|d| !d.strings.is_empty() && d.strings.len() + d.points.len() > 1))
        .collect();
    let (g, p) = (&*graph, &*points);
    let cuts: Vec<Vec<Cut>> = if todo.len() < 256 {
        todo.iter().map(|&t| cuts_on(mesh, g, p, t)).collect()
    } else {
        todo.par_iter().with_min_len(16).map(|&t| cuts_on(mesh, g, p, t)).collect()
    };
    for cut in cuts.into_iter().flatten() {
        match cut {
            Cut::Known(curve, point) => graph.push(mesh, curve, point),
            Cut::New(curves, source) => {
                let point = points.intern(source);
                for curve in curves {
                    graph.push(mesh, curve, point);
                }
            }
        }
    }
}

/// A string with its box, which holds its exact points too.
struct Laid {
    piece: StringPiece,
    bounds: Aabb,
}

fn cuts_on(mesh: &Mesh, graph: &Graph, points: &Points, t: u32) -> Vec<Cut> {
    let Some(drawing) = graph.drawing(t) else { return Vec::new() };
    let bounds_of = |p: u32| {
        let place = points.place(p);
        Aabb { lo: place.at, hi: place.at }.inflated(place.error)
    };
    let mut strings: Vec<Laid> = drawing
        .strings
        .iter()
        .map(|&piece| Laid { piece, bounds: bounds_of(piece.ends[0]).union(&bounds_of(piece.ends[1])) })
        .collect();
    // Sweep along x: only strings whose intervals overlap are compared.
    strings.sort_by(|a, b| a.bounds.lo.x.total_cmp(&b.bounds.lo.x).then(a.piece.cmp(&b.piece)));
    let mut out = Vec::new();
    for (i, a) in strings.iter().enumerate() {
        for b in strings[i + 1..].iter().take_while(|b| b.bounds.lo.x <= a.bounds.hi.x) {
            if a.bounds.overlaps(&b.bounds) {
                cross(mesh, graph, points, t, a.piece, b.piece, &mut out);
            }
        }
    }
    let mut lone: Vec<u32> = drawing.points.clone();
    for s in &drawing.strings {
        if let Curve::Edge(_) = s.curve {
            lone.extend(graph.points_on(s.curve));
        }
    }
    lone.sort_unstable();
    lone.dedup();
    let mut lone: Vec<(u32, Place)> = lone.into_iter().map(|p| (p, points.place(p))).collect();
    lone.sort_by(|a, b| a.1.at.x.total_cmp(&b.1.at.x));
    let widest = lone.iter().fold(0.0, |m: f64, l| m.max(l.1.error));
    for string in &strings {
        let reach = string.bounds.inflated(widest);
        let first = lone.partition_point(|l| l.1.at.x < reach.lo.x);
        for (p, place) in lone[first..].iter().take_while(|l| l.1.at.x <= reach.hi.x) {
            if string.bounds.inflated(place.error).contains(&place.at) {
                touch(mesh, graph, points, t, *p, string.piece, &mut out);
            }
        }
    }
    out
}

/// Enters `p` in the string if it lies inside it.
fn touch(mesh: &Mesh, graph: &Graph, points: &Points, t: u32, p: u32, string: StringPiece, out: &mut Vec<Cut>) {
    if is_known(graph, mesh, p, string.curve) {
        return;
    }
    let [a, b] = string.ends;
    if points.orient2d(a, b, p, mesh.projection[t as usize]) == 0 && is_between(points, string, p) {
        out.push(Cut::Known(string.curve, p));
    }
}

fn is_known(graph: &Graph, mesh: &Mesh, p: u32, curve: Curve) -> bool {
    graph.ends_of(mesh, curve).contains(&p) || graph.points_on(curve).contains(&p)
}

/// Whether a point of the string's line lies strictly between its ends.
fn is_between(points: &Points, string: StringPiece, p: u32) -> bool {
    let [a, b] = string.ends;
    let order = Along::new(string.ends, points);
    order.compare(a, p, points) == Ordering::Less && order.compare(p, b, points) == Ordering::Less
}

fn cross(mesh: &Mesh, graph: &Graph, points: &Points, t: u32, s: StringPiece, r: StringPiece, out: &mut Vec<Cut>) {
    if s.curve == r.curve {
        return;
    }
    let projection = mesh.projection[t as usize];
    let side = |line: StringPiece, p: u32| {
        if line.ends.contains(&p) || is_known(graph, mesh, p, line.curve) {
            0
        } else {
            points.orient2d(line.ends[0], line.ends[1], p, projection)
        }
    };
    let sides = || {
        // All on one line: exact signs of that cost most.
        if are_of_one_plane(mesh, graph, t, s.curve, r.curve) {
            return Some([[0; 2]; 2]);
        }
        let ends = r.ends.map(|p| side(s, p));
        let others = || s.ends.map(|p| side(r, p));
        (ends[0] * ends[1] <= 0).then(|| [others(), ends]).filter(|[[a, b], _]| a * b <= 0)
    };
    let Some([[a, b], [c, d]]) = sides() else { return };
    if a * b < 0 && c * d < 0 {
        out.push(Cut::New([s.curve, r.curve], crossing(mesh, graph, t, s.curve, r.curve)));
        return;
    }
    // An end of one lies on the line of the other: known points, at most entered.
    for (line, ends, signs) in [(s, r.ends, [c, d]), (r, s.ends, [a, b])] {
        for (p, sign) in ends.into_iter().zip(signs) {
            if sign == 0 && !is_known(graph, mesh, p, line.curve) && is_between(points, line, p) {
                out.push(Cut::Known(line.curve, p));
            }
        }
    }
}

/// The triangle that crosses triangle `t` along a segment.
fn other(graph: &Graph, segment: u32, t: u32) -> u32 {
    let [a, b] = graph.segments[segment as usize].triangles;
    if a == t { b } else { a }
}

/// Whether two strings on triangle `t` are where triangles of one cell, exactly in one plane, cross it.
fn are_of_one_plane(mesh: &Mesh, graph: &Graph, t: u32, s: Curve, r: Curve) -> bool {
    let (Curve::Segment(s), Curve::Segment(r)) = (s, r) else { return false };
    let [u, v] = [s, r].map(|segment| other(graph, segment, t));
    let cells = &mesh.input.cell_of_triangle;
    let [mine, yours] = [u, v].map(|t| mesh.triangles[t as usize]);
    let at = |p: u32| &mesh.input.points[p as usize];
    let [a, b, c] = mine.map(at);
    let is_on = |p: u32| mine.contains(&p) || orient3d(a, b, c, at(p)) == 0;
    cells[u as usize] == cells[v as usize] && yours.into_iter().all(is_on)
}

/// How the point in which two strings on triangle `t` cross is made.
fn crossing(mesh: &Mesh, graph: &Graph, t: u32, s: Curve, r: Curve) -> Source {
    let plane = |t: u32| mesh.triangles[t as usize];
    let other = |segment: u32| other(graph, segment, t);
    match (s, r) {
        (Curve::Segment(s), Curve::Segment(r)) => {
            let mut planes = [t, other(s), other(r)];
            planes.sort_unstable();
            Source::ThreePlanes(planes.map(plane))
        }
        (Curve::Edge(e), Curve::Segment(s)) | (Curve::Segment(s), Curve::Edge(e)) => {
            Source::LinePlane { line: mesh.edges[e as usize], plane: plane(other(s)) }
        }
        (Curve::Edge(e), Curve::Edge(f)) => {
            let [line, other] = [e.min(f), e.max(f)].map(|e| mesh.edges[e as usize]);
            Source::LineLine { line, other, projection: mesh.projection[t as usize] }
        }
    }
}
