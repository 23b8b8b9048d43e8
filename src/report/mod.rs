//! What a run says: parts, interfaces, triangle quality, times; as text and as JSON from one value.

pub mod diagnostics;
pub mod distribution;
pub mod lanczos;
pub mod poor;
pub mod quality;
pub mod sharp;
pub mod stiffness;
pub mod tets;
pub mod text;
pub mod timing;
pub mod triangles;
pub mod volume;

use crate::arrangement::Statistics;
use crate::brep::complex::Complex;
use crate::io::manifest::{Counts, MarkerEntry, RegionEntry};
use crate::pipeline::Model;
use crate::round::Repairs;
use quality::Distribution;
use serde::Serialize;
use sharp::SharpAngle;
use timing::StageTime;

/// The result of `gsm build` for the terminal and, serialised, for `--json`.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Version of gsm.
    pub gsm: String,
    /// Name of the scene.
    pub scene: String,
    /// SHA-256 of the scene.
    pub scene_hash: String,
    /// Unit of length.
    pub unit: String,
    /// Where the .poly was written, if it was.
    pub output: Option<String>,
    /// Sizes of the .poly.
    pub counts: Counts,
    /// Triangles of all facets.
    pub triangles: usize,
    /// Parts in file order.
    pub parts: Vec<RegionEntry>,
    /// Interfaces and boundaries by marker.
    pub interfaces: Vec<MarkerEntry>,
    /// Quality of the facets that are single triangles.
    pub quality: Option<Distribution>,
    /// Their angles below 30 degrees.
    pub sharp_angles: Vec<SharpAngle>,
    /// What the exact arrangement did.
    pub arrangement: Statistics,
    /// How often rounding was repaired.
    pub repairs: Repairs,
    /// Stages in order.
    pub timings: Vec<StageTime>,
    /// Their sum.
    pub total: StageTime,
}

impl Report {
    /// The report on a model; `output` is where it was written.
    pub fn new(model: &Model, output: Option<String>) -> Self {
        let m = &model.manifest;
        Self {
            gsm: m.gsm.clone(),
            scene: m.scene.clone(),
            scene_hash: m.scene_hash.clone(),
            unit: m.unit.clone(),
            output,
            counts: m.counts,
            triangles: model.complex.facets.iter().map(|f| f.triangles.len()).sum(),
            parts: m.regions.clone(),
            interfaces: m.markers.clone(),
            quality: quality_of(&model.complex),
            sharp_angles: sharp::sharp_angles(&model.complex),
            arrangement: model.statistics,
            repairs: model.repairs.clone(),
            timings: model.timings.stages.clone(),
            total: model.timings.total(),
        }
    }
}

/// Quality of the facets that are single triangles: those that go into the volume mesh as they are.
fn quality_of(complex: &Complex) -> Option<Distribution> {
    let is_triangle = |loops: &[Vec<_>]| matches!(loops, [only] if only.len() == 3);
    let single = complex.facets.iter().filter(|f| is_triangle(&f.loops));
    quality::distribution(single.flat_map(|f| f.triangles.iter().map(|t| t.map(|v| complex.vertices[v].point))))
}
