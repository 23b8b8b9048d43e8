//! After contact every leaf must be what it was, within the tolerance.

use super::body::{Body, Names};
use super::conforming::Conforming;
use super::weld::MAX_MESSAGES;
use crate::diag::{Diagnostic, Outcome, short};
use crate::geom::Vec3;
use crate::geom::polygon::vector_area;
use crate::ids::LeafId;

/// Rounding error of a volume, relative to area times size.
const VOLUME_ERROR: f64 = 64.0 * f64::EPSILON;

/// Checks of every leaf: it is closed, and its volume changed by less than area times tolerance. O(n).
pub(super) fn verify(body: &Body, conforming: &Conforming, names: Names) -> Outcome<()> {
    let count = body.solids.len();
    let origins: Vec<Vec3> = body.solids.iter().map(|s| s.vertices.first().map_or(Vec3::zeros(), |v| v.point)).collect();
    let mut after = vec![0.0; count];
    // The vector areas of a closed surface cancel, and an edge that misses its partner shows.
    let mut open = vec![Vec3::zeros(); count];
    for (k, t) in conforming.triangles.iter().enumerate() {
        let [a, b, c] = t.map(|v| conforming.points[v as usize]);
        for owner in conforming.owners_of_triangle(k as u32) {
            let leaf = owner.leaf.0 as usize;
            let turn = if owner.is_flipped { -1.0 } else { 1.0 };
            let o = origins[leaf];
            after[leaf] += turn * (a - o).dot(&(b - o).cross(&(c - o))) / 6.0;
            open[leaf] += (b - a).cross(&(c - a)) * (0.5 * turn);
        }
    }
    let mut errors = Vec::new();
    for (leaf, solid) in body.solids.iter().enumerate() {
        let points: Vec<Vec3> = solid.vertices.iter().map(|v| v.point - origins[leaf]).collect();
        let (mut before, mut area) = (0.0, 0.0);
        for facet in solid.facets.iter() {
            let vector = vector_area(facet.loops.iter(), &points);
            area += vector.norm();
            before += facet.loops.outer().first().map_or(0.0, |&v| points[v as usize].dot(&vector) / 3.0);
        }
        let size = points.iter().fold(0.0, |m: f64, p| m.max(p.norm()));
        let slack = area * (body.tolerances.iter().fold(0.0, |m: f64, &t| m.max(t)) + VOLUME_ERROR * size);
        if (after[leaf] - before).abs() > slack || open[leaf].norm() * size > slack.max(area * size * VOLUME_ERROR) {
            let name = names(LeafId(leaf as u32));
            let message =
                format!("contact changes the volume of {name} by {}, more than the tolerance", short(after[leaf] - before));
            errors.push(
                Diagnostic::error("contact-changes-leaf", message)
                    .at(name.span)
                    .near(origins[leaf])
                    .hint("a part is thinner than the `tolerance` or its facets are not planar: choose a smaller one"),
            );
        }
        if errors.len() >= MAX_MESSAGES {
            break;
        }
    }
    if errors.is_empty() { Ok(()) } else { Err(errors) }
}
