//! How many facets a leaf will have: an estimate that keeps a scene from taking all memory.

use super::model::{Division, Leaf, Path2, Primitive, Profile};
use super::polyline::{arc_angles, walk};
use crate::geom::plane::distance;
use std::f64::consts::{PI, TAU};
use std::fs::File;
use std::io::Read as _;
use std::path::Path;

/// Bytes of a file for each facet, about: triangles in STL as text; others, where each point serves six triangles.
const STL_TEXT_FACET: f64 = 200.0;
const TEXT_FACET: f64 = 40.0;
/// Bytes of an STL file before its triangles, and of each, if it is binary.
const STL_HEADER: usize = 84;
const STL_FACET: u64 = 50;

/// Facets of the leaf once it is divided, within a small factor.
pub(super) fn facet_estimate(leaf: &Leaf) -> f64 {
    // A matrix may enlarge the primitive; the chord error counts in the scene.
    let scale = leaf.transform.matrix().fixed_view::<3, 3>(0, 0).norm() / 3f64.sqrt();
    let division = &leaf.division;
    let circle = |radius: f64| segments(division, radius * scale);
    match &leaf.primitive {
        Primitive::Block { .. } => 6.0,
        Primitive::Pyramid { base, .. } => 1.0 + base.len() as f64,
        Primitive::Cone { bottom_radius, top_radius, height, .. } => {
            let radius = bottom_radius.max(*top_radius);
            triangulated(leaf, circle(radius), radius, *height) + 2.0
        }
        // Eight triangles of n^2 each, n a quarter of the segments.
        Primitive::Ellipsoid { radii, .. } => 0.5 * circle(radii.max()) * circle(radii.max()),
        Primitive::Torus { major_radius, minor_radius, .. } => {
            2.0 * circle(major_radius + minor_radius) * circle(*minor_radius)
        }
        Primitive::Extrusion { profile, length, .. } => {
            let (chords, radius) = chords(profile, &circle);
            triangulated(leaf, chords, radius, *length) + 2.0
        }
        Primitive::Revolution { profile, angle, .. } => {
            let (chords, _) = chords(profile, &circle);
            let reach = super::polyline::bounds(&profile.outer)[1][0];
            2.0 * chords * (circle(reach) * angle / TAU).max(1.0)
        }
        Primitive::PathSweep { profile, path, .. } => 2.0 * chords(profile, &circle).0 * path_chords(path, &circle).0,
        Primitive::Import { path, .. } => facets_of_file(path).unwrap_or(1.0),
    }
}

/// Facets of a surface file, by its length; what is wrong with it is told when it is read.
fn facets_of_file(path: &Path) -> Option<f64> {
    let mut file = File::open(path).ok()?;
    let bytes = file.metadata().ok()?.len();
    if !path.extension()?.eq_ignore_ascii_case("stl") {
        return Some(bytes as f64 / TEXT_FACET);
    }
    let mut header = [0; STL_HEADER];
    let is_short = file.read_exact(&mut header).is_err();
    let count = u64::from(u32::from_le_bytes([header[80], header[81], header[82], header[83]]));
    let is_binary = !is_short && bytes == STL_HEADER as u64 + STL_FACET * count;
    Some(if is_binary { count as f64 } else { bytes as f64 / STL_TEXT_FACET })
}

/// Chords of a full circle.
fn segments(division: &Division, radius: f64) -> f64 {
    let by_angle = division.max_angle.map_or(0.0, |angle| TAU / angle);
    let by_error = division.max_chord_error.map_or(0.0, |error| {
        let cosine = 1.0 - (error / radius).min(0.5);
        PI / libm::acos(cosine).max(1e-12)
    });
    f64::from(division.segments.unwrap_or(3)).max(by_angle).max(by_error)
}

/// Facets of a side of `chords` strips, which level curves divide as finely along it as across.
fn triangulated(leaf: &Leaf, chords: f64, radius: f64, height: f64) -> f64 {
    if !leaf.is_triangulated || radius <= 0.0 {
        return chords;
    }
    let levels = (height * chords / (TAU * radius)).clamp(1.0, 1e9);
    2.0 * chords * levels
}

fn chords(profile: &Profile, circle: &impl Fn(f64) -> f64) -> (f64, f64) {
    let loops = std::iter::once(&profile.outer).chain(&profile.holes);
    loops.map(|path| path_chords(path, circle)).fold((0.0, 0.0), |(n, r), (m, s)| (n + m, f64::max(r, s)))
}

/// Chords of a path, and its largest radius.
fn path_chords(path: &Path2, circle: &impl Fn(f64) -> f64) -> (f64, f64) {
    walk(path).fold((0.0, 0.0), |(count, largest), (from, segment)| match &segment.arc {
        None => (count + 1.0, largest),
        Some(arc) => {
            let radius = distance(arc.center, from);
            let sweep = arc_angles(from, segment.end, arc).1.abs();
            (count + (circle(radius) * sweep / TAU).max(1.0), f64::max(largest, radius))
        }
    })
}
