//! Is it a valid PLC? Exact answers, one file per question.
//!
//! 1. `vertices`: no two at one place, none unused.
//! 2. `facets`: planar, simple, none twice.
//! 3. `contacts`, `loose`: triangles, and segments and vertices that facets list outside of their area, meet only in whole
//!    shared vertices and edges.
//! 4. `closed`: no edge of one facet only, two different volumes at each facet.
//! 5. `regions`: one seed in each volume.
//! 6. `count`: V - E + F - L = 2 (R + S - H).
//! 7. `sides` (models of our own only): the recorded regions are the volumes that the facets enclose.
//! 8. `names` (with a manifest): names, volumes, areas and numbers of the manifest are those of the complex.
//!
//! A question is only asked where the answers before it give it a meaning, so that one defect gives one kind of finding.
//! What TetGen meshes although gsm never writes it (segments and vertices by themselves, facets in several pieces, hole points
//! that do nothing) is a warning.
//!
//! Numbers of vertices and facets in messages count from 1.

mod closed;
mod contacts;
mod count;
mod faces;
mod facets;
mod loose;
mod names;
mod regions;
mod sides;
#[cfg(test)]
mod tests;
mod vertices;

use super::{Plc, build, facet, volumes};
use crate::brep::complex::Complex;
use crate::diag::{Diagnostic, Severity};
use crate::geom::Vec3;
use crate::geom::cast::Caster;
use crate::io::manifest::Manifest;

/// Findings of one kind that are reported before the rest is only counted: more of them help nobody.
const MAX_FINDINGS: usize = 20;

/// A PLC with its triangulation, as the checks see it.
struct Subject<'a> {
    plc: &'a Plc,
    manifest: Option<&'a Manifest>,
    triangles: Vec<[u32; 3]>,
    facet_of: Vec<u32>,
    /// What facets list outside of their area.
    loose: Vec<loose::Loose>,
    /// Diagonal of the box around it.
    size: f64,
}

/// Everything that is wrong with a PLC from a file; no errors if it is valid. Names come from the manifest, where there is one,
/// which must then agree with the PLC. Cost: O(n log n).
pub fn check(plc: &Plc, manifest: Option<&Manifest>) -> Vec<Diagnostic> {
    let mut subject =
        Subject { plc, manifest, triangles: Vec::new(), facet_of: Vec::new(), loose: Vec::new(), size: plc.size() };
    let mut findings = vertices::coincident(&subject);
    findings.extend(facets::malformed(&subject));
    for (k, f) in plc.facets.iter().enumerate() {
        let facet = k as u32;
        if !facets::has_outline(f) {
            subject.loose.extend(loose::of_lines(facet, f));
            continue;
        }
        match facet::area_of(f, &plc.vertices) {
            Ok(area) => {
                subject.loose.extend(loose::of_strays(facet, facet::strays(f, &area.triangles)));
                findings.extend(facets::wrong_holes(&subject, facet, &area));
                subject.facet_of.resize(subject.facet_of.len() + area.triangles.len(), facet);
                subject.triangles.extend(area.triangles);
            }
            Err(why) => findings.push(facets::no_triangulation(&subject, facet, why)),
        }
    }
    findings.extend(from_triangles(&subject, has_errors(&findings)).0);
    capped(findings)
}

fn has_errors(findings: &[Diagnostic]) -> bool {
    findings.iter().any(|f| f.severity > Severity::Warning)
}

/// Everything that is wrong with an evaluated model and the PLC built from it, with its own triangulation.
pub fn check_complex(complex: &Complex, plc: &Plc, manifest: &Manifest) -> Vec<Diagnostic> {
    let triangles = build::triangles_of(complex).0;
    let counts = complex.facets.iter().enumerate();
    let facet_of = counts.flat_map(|(k, f)| std::iter::repeat_n(k as u32, f.triangles.len())).collect();
    let subject = Subject { plc, manifest: Some(manifest), triangles, facet_of, loose: Vec::new(), size: plc.size() };
    let mut findings = vertices::coincident(&subject);
    findings.extend(facets::malformed(&subject));
    let (further, volumes) = from_triangles(&subject, has_errors(&findings));
    findings.extend(further);
    if let Some(volumes) = volumes {
        findings.extend(sides::differing(&subject, complex, &volumes));
    }
    capped(findings)
}

/// The checks that need a triangulation, and the volumes if they have a meaning.
fn from_triangles(subject: &Subject, is_broken: bool) -> (Vec<Diagnostic>, Option<volumes::Volumes>) {
    let points = &subject.plc.vertices;
    let caster = Caster::new(points, &subject.triangles);
    let mut findings = vertices::unused(subject, &caster);
    findings.extend(facets::bent(subject));
    let doubled = facets::doubled(subject);
    if is_broken || !doubled.is_empty() {
        findings.extend(doubled);
        return (findings, None);
    }
    findings.extend(loose::spikes(subject));
    let contacts = [contacts::forbidden(subject), loose::forbidden(subject), contacts::unlisted_edges(subject)].concat();
    if !contacts.is_empty() {
        findings.extend(contacts);
        return (findings, None);
    }
    let volumes = volumes::find(points, &subject.triangles, &caster);
    let open = closed::open_edges(subject, &volumes);
    if !open.is_empty() {
        findings.extend(open);
        return (findings, None);
    }
    let faces = faces::find(subject);
    findings.extend(closed::sheets(subject, &volumes, &faces));
    findings.extend(loose::places(subject, &volumes, &caster));
    findings.extend(regions::misplaced_seeds(subject, &volumes, &caster));
    findings.extend(count::unbalanced(subject, &volumes, &faces));
    if let Some(manifest) = subject.manifest.filter(|_| !has_errors(&findings)) {
        findings.extend(names::differing(subject, manifest, &volumes, &caster));
    }
    (findings, Some(volumes))
}

/// Keeps the first findings of each kind and counts the rest.
fn capped(findings: Vec<Diagnostic>) -> Vec<Diagnostic> {
    let mut codes: Vec<((&'static str, Severity), usize)> = Vec::new();
    let mut kept = Vec::new();
    for f in findings {
        let kind = (f.code, f.severity);
        let slot = codes.iter().position(|c| c.0 == kind).unwrap_or_else(|| {
            codes.push((kind, 0));
            codes.len() - 1
        });
        codes[slot].1 += 1;
        if codes[slot].1 <= MAX_FINDINGS {
            kept.push(f);
        }
    }
    for ((code, severity), count) in codes {
        if count > MAX_FINDINGS {
            let more = format!("and {} more of this kind", count - MAX_FINDINGS);
            kept.push(Diagnostic { severity, ..Diagnostic::error(code, more) }.hint("mend those above, then check again"));
        }
    }
    kept
}

impl Subject<'_> {
    /// Size that roundings are relative to: far from the origin the coordinates themselves are coarser than the model's size.
    fn scale(&self) -> f64 {
        self.plc.vertices.iter().fold(self.size, |m, p| m.max(p.amax()))
    }

    fn point(&self, vertex: u32) -> Vec3 {
        self.plc.vertices[vertex as usize]
    }

    /// `facet 12 (core|air)`.
    fn facet_name(&self, facet: u32) -> String {
        let marker = self.plc.facets[facet as usize].marker;
        match self.manifest.and_then(|m| m.marker_name(marker)) {
            Some(name) => format!("facet {} ({name})", facet + 1),
            None => format!("facet {} (marker {marker})", facet + 1),
        }
    }

    /// `region 3 (core)`.
    fn region_name(&self, region: i64) -> String {
        match self.manifest.and_then(|m| m.part_name(region)) {
            Some(name) => format!("region {region} ({name})"),
            None => format!("region {region}"),
        }
    }
}
