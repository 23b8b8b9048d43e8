//! After contact every leaf must be what it was, within the tolerance.

use super::body::{Body, Names};
use super::candidates::PARALLEL_FROM;
use super::conforming::Conforming;
use super::weld::MAX_MESSAGES;
use crate::diag::{Diagnostic, Outcome, short};
use crate::geom::Vec3;
use crate::geom::parallel::both;
use crate::geom::polygon::vector_area;
use crate::ids::LeafId;
use crate::primitive::solid::Solid;
use rayon::prelude::*;

/// Rounding error of a volume, relative to area times size.
const VOLUME_ERROR: f64 = 64.0 * f64::EPSILON;

/// Checks of every leaf: it is closed, and its volume changed by less than area times tolerance. O(n).
pub(super) fn verify(body: &Body, conforming: &Conforming, names: Names) -> Outcome<()> {
    let origins: Vec<Vec3> = body.solids.iter().map(|s| s.vertices.first().map_or(Vec3::zeros(), |v| v.point)).collect();
    let measure = || body.solids.par_iter().zip(&origins).map(|(solid, origin)| Before::of(solid, origin)).collect::<Vec<_>>();
    let ((after, open), before) = both(body.facet_count() >= PARALLEL_FROM, || sums(conforming, &origins), measure);
    let widest = body.tolerances.iter().fold(0.0, |m: f64, &t| m.max(t));
    let mut errors = Vec::new();
    for (leaf, Before { volume, area, size }) in before.into_iter().enumerate() {
        let slack = area * (widest + VOLUME_ERROR * size);
        if (after[leaf] - volume).abs() > slack || open[leaf].norm() * size > slack.max(area * size * VOLUME_ERROR) {
            let name = names(LeafId(leaf as u32));
            let message =
                format!("contact changes the volume of {name} by {}, more than the tolerance", short(after[leaf] - volume));
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

/// The volume of every leaf, and the sum of the vector areas of its cells.
fn sums(conforming: &Conforming, origins: &[Vec3]) -> (Vec<f64>, Vec<Vec3>) {
    let count = origins.len();
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
    (after, open)
}

/// A leaf as it came.
struct Before {
    volume: f64,
    area: f64,
    /// Largest distance of a vertex from the origin that counts.
    size: f64,
}

impl Before {
    fn of(solid: &Solid, origin: &Vec3) -> Self {
        let points: Vec<Vec3> = solid.vertices.iter().map(|v| v.point - origin).collect();
        let (mut volume, mut area) = (0.0, 0.0);
        for facet in solid.facets.iter() {
            let vector = vector_area(facet.loops.iter(), &points);
            area += vector.norm();
            volume += facet.loops.outer().first().map_or(0.0, |&v| points[v as usize].dot(&vector) / 3.0);
        }
        Self { volume, area, size: points.iter().fold(0.0, |m: f64, p| m.max(p.norm())) }
    }
}
