//! The regions recorded on the facets of our own model are the volumes that the facets enclose.

use super::Subject;
use crate::brep::complex::Complex;
use crate::diag::Diagnostic;
use crate::ids::Id;
use crate::plc::volumes::Volumes;

/// Facet sides whose region is not the volume they face: regions and volumes must match one to one.
pub fn differing(subject: &Subject, complex: &Complex, volumes: &Volumes) -> Vec<Diagnostic> {
    let mut region_of: Vec<Option<usize>> = vec![None; volumes.count as usize];
    let mut volume_of: Vec<Option<u32>> = vec![None; complex.regions.len()];
    let mut findings = Vec::new();
    for (t, &facet) in subject.facet_of.iter().enumerate() {
        let sides = complex.facets.as_slice()[facet as usize].sides;
        for (k, region) in sides.into_iter().enumerate() {
            let volume = volumes.of_side[2 * t + k];
            let expected_region = *region_of[volume as usize].get_or_insert(region.index());
            let expected_volume = *volume_of[region.index()].get_or_insert(volume);
            if expected_region != region.index() || expected_volume != volume {
                let message = format!(
                    "{}: its side faces volume {volume} but is recorded for region {} of the model",
                    subject.facet_name(facet),
                    region.0
                );
                findings.push(Diagnostic::internal("wrong-side", message).near(subject.point(subject.triangles[t][0])));
            }
        }
    }
    findings
}
