//! How many triangles remeshing will make, before the work: very many are told, more than memory holds are refused.

use super::sizing::{LEAST_SIZE, length_on, wanted_on};
use crate::brep::complex::{Complex, ComplexFacet};
use crate::diag::{Diagnostic, Outcome, short};
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use crate::ids::{IdVec, MarkerId, SurfaceId};
use crate::patch::analytic::support_of_shape;
use crate::patch::support::Support;
use crate::scene::model::{RemeshMode, Scene};

/// Triangles from which on a user should know beforehand: about half a minute's work.
const MANY: f64 = 200_000.0;
/// Memory of one triangle under work, with its share of edges, vertices and history.
const BYTES_PER_TRIANGLE: f64 = 1500.0;

/// A warning if remeshing will make very many triangles. The number is that of equilateral triangles with the largest deviation
/// (√3 / (6 r d) per area on a cylinder of radius r at deviation d) or the largest edge that the scene allows; the default
/// deviation makes about as many as there are. Cost: linear in the triangles of curved facets, a projection each.
///
/// # Errors
/// If they need more than `memory` bytes.
pub fn forecast(complex: &Complex, scene: &Scene, memory: f64) -> Outcome<Option<Diagnostic>> {
    let counts = counts(complex, scene);
    let total: f64 = counts.iter().sum();
    let Some((most, &largest)) = counts.enumerate().max_by(|a, b| a.1.total_cmp(b.1)).filter(|_| total >= MANY) else {
        return Ok(None);
    };
    let name = &complex.markers[complex.markers[most].interface].name;
    let numbers = match largest >= 0.99 * total {
        true => format!("about {} triangles on `{name}`", rounded(total)),
        false => format!("about {} triangles, {} of them on `{name}`", rounded(total), rounded(largest)),
    };
    let leaf = complex.facets.iter().find(|f| f.marker == most).map(|f| complex.surfaces[f.surface].leaf);
    let place = |d: Diagnostic| leaf.and_then(|l| scene.leaves.get(l)).map_or(d.clone(), |l| d.at(l.span));
    let raise = match scene.remesh.max_deviation {
        Some(d) => {
            let limits = if asks_for_short_edges(scene) { ", and check `max_edge`" } else { "" };
            format!("raise `max_deviation`: {:.1e} makes about {}{limits}", d * total / MANY, rounded(MANY))
        }
        None => "raise `max_edge` of the parts and interfaces".to_owned(),
    };
    let hint = format!("{raise}; or leave the facets as they are by `remesh: Off`");
    if total * BYTES_PER_TRIANGLE > memory {
        let message = format!("remeshing would need more than {:.1} GB of memory: {numbers}", memory / 1e9);
        return Err(vec![place(Diagnostic::error("too-many-triangles", message)).hint(hint)]);
    }
    Ok(Some(place(Diagnostic::warning("many-triangles", format!("remeshing takes long: {numbers}"))).hint(hint)))
}

/// Whether edges are limited anywhere.
fn asks_for_short_edges(scene: &Scene) -> bool {
    !scene.interfaces.is_empty() || scene.parts.iter().any(|p| p.max_edge.is_some())
}

/// Triangles by marker.
fn counts(complex: &Complex, scene: &Scene) -> IdVec<MarkerId, f64> {
    let mut counts: IdVec<MarkerId, f64> = complex.markers.iter().map(|_| 0.0).collect();
    if scene.remesh.mode == RemeshMode::Off {
        return counts;
    }
    let least = LEAST_SIZE * Aabb::around(complex.vertices.iter().map(|v| &v.point)).diagonal();
    if scene.remesh.max_deviation.is_none() && !asks_for_short_edges(scene) {
        return counts;
    }
    let wanted: IdVec<MarkerId, f64> = complex.markers.iter().map(|m| wanted_on(m, &scene.parts)).collect();
    let supports: IdVec<SurfaceId, Option<Support>> = complex.surfaces.iter().map(|s| support_of_shape(&s.shape)).collect();
    let is_treated = |f: &&ComplexFacet| f.is_modified || scene.remesh.mode == RemeshMode::Full;
    for facet in complex.facets.iter().filter(is_treated) {
        let Some(support) = &supports[facet.surface] else { continue };
        for corners in &facet.triangles {
            let [a, b, c] = corners.map(|v| complex.vertices[v].point);
            let middle: Vec3 = (a + b + c) / 3.0;
            let by_deviation = scene.remesh.max_deviation.map_or(f64::INFINITY, |d| length_on(&support.closest(&middle), d));
            let length = by_deviation.min(wanted[facet.marker]).max(least);
            counts[facet.marker] += 0.5 * (b - a).cross(&(c - a)).norm() / (0.25 * 3f64.sqrt() * length * length);
        }
    }
    counts
}

/// A number in words, with two digits.
fn rounded(number: f64) -> String {
    let step = libm::exp10(libm::floor(libm::log10(number.max(1.0))) - 1.0).max(1.0);
    let number = (number / step).round() * step;
    if number < 1e6 { format!("{number}") } else { format!("{} million", short(number / 1e6)) }
}
