//! Segments and vertices that a facet lists outside of its area: spikes, segments and vertices by themselves.
//!
//! TetGen takes segments and vertices that stand free in a volume as constraints; outside of all volumes it crashes on
//! segments (1.5.0), and on a closed polygon that leads out of its area and back it aborts anywhere.

use super::{Subject, contacts};
use crate::diag::{Diagnostic, Severity};
use crate::geom::cast::Caster;
use crate::geom::embedding::{Kind, LooseViolation, Partner, is_inside, loose_violations};
use crate::geom::predicates::orient3d;
use crate::plc::PlcFacet;
use crate::plc::facet::{Strays, segments_of};
use crate::plc::volumes::Volumes;
use std::collections::BTreeSet;

/// Contacts looked at.
const MAX_CONTACTS: usize = 10_000;

/// A segment, or a vertex as a segment of length 0.
#[derive(Clone, Copy)]
pub(super) struct Loose {
    ends: [u32; 2],
    facet: u32,
    origin: Origin,
}

/// Where it is listed.
#[derive(Clone, Copy, PartialEq)]
enum Origin {
    /// In a closed polygon.
    Spike,
    /// By itself, in a facet that has an area.
    BesideArea,
    /// In a facet that has none, which is told already.
    NoArea,
}

/// What a facet lists outside of its area.
pub(super) fn of_strays(facet: u32, strays: Strays) -> impl Iterator<Item = Loose> {
    let loose = move |ends, origin| Loose { ends, facet, origin };
    let spikes = strays.spikes.into_iter().map(move |s| loose(s, Origin::Spike));
    let segments = strays.segments.into_iter().chain(strays.vertices.into_iter().map(|v| [v, v]));
    spikes.chain(segments.map(move |s| loose(s, Origin::BesideArea)))
}

/// What a facet without outline lists.
pub(super) fn of_lines(facet: u32, f: &PlcFacet) -> Vec<Loose> {
    let segments: BTreeSet<[u32; 2]> = f.polygons.iter().flat_map(|p| segments_of(p)).collect();
    let vertices = f.polygons.iter().filter(|p| p.len() == 1).map(|p| [p[0], p[0]]);
    segments.into_iter().chain(vertices).map(|ends| Loose { ends, facet, origin: Origin::NoArea }).collect()
}

/// Closed polygons that lead out of their area.
pub(super) fn spikes(subject: &Subject) -> Vec<Diagnostic> {
    let spikes = subject.loose.iter().filter(|l| l.origin == Origin::Spike);
    spikes
        .map(|l| {
            let [a, b] = l.ends;
            let name = subject.facet_name(l.facet);
            let message = format!("{name}: its polygon runs from vertex {} to {} and back, outside of its area", a + 1, b + 1);
            Diagnostic::error("spike", message)
                .near((subject.point(a) + subject.point(b)) * 0.5)
                .hint("take the end of the spike out of the polygon; if TetGen shall keep the segment, list it by itself")
        })
        .collect()
}

/// Contacts of loose segments and vertices with facets and with each other, one finding per kind and pair of facets.
pub(super) fn forbidden(subject: &Subject) -> Vec<Diagnostic> {
    let segments: Vec<[u32; 2]> = subject.loose.iter().map(|l| l.ends).collect();
    let found = loose_violations(&subject.plc.vertices, &subject.triangles, &segments, MAX_CONTACTS);
    let listed = listed_segments(subject, &found);
    let mut seen = BTreeSet::new();
    let mut findings = Vec::new();
    for v in found {
        let one = subject.loose[v.segment as usize];
        let (other, kind) = match v.with {
            Partner::Triangle(t) => (subject.facet_of[t as usize], told(subject, &listed, &v, t)),
            Partner::Segment(s) => (subject.loose[s as usize].facet, v.kind),
        };
        if seen.insert((kind, v.segment, other)) {
            findings.push(contacts::finding(subject, kind, v.point, [one.facet, other]));
        }
    }
    findings
}

/// The segments that the facets of these contacts list, by facet.
fn listed_segments(subject: &Subject, found: &[LooseViolation]) -> BTreeSet<(u32, [u32; 2])> {
    let met = found.iter().filter_map(|v| match v.with {
        Partner::Triangle(t) => Some(subject.facet_of[t as usize]),
        Partner::Segment(_) => None,
    });
    let facets: BTreeSet<u32> = met.collect();
    let polygons = facets.into_iter().flat_map(|f| subject.plc.facets[f as usize].polygons.iter().map(move |p| (f, p)));
    polygons.flat_map(|(f, p)| segments_of(p).map(move |s| (f, s))).collect()
}

/// What users see: an edge of a triangle that the facet does not list is no edge to them.
fn told(subject: &Subject, listed: &BTreeSet<(u32, [u32; 2])>, violation: &LooseViolation, triangle: u32) -> Kind {
    let facet = subject.facet_of[triangle as usize];
    let is_listed = |edge: &[u32; 2]| listed.contains(&(facet, *edge));
    let [p, q] = subject.loose[violation.segment as usize].ends.map(|v| subject.point(v));
    let is_met = |edge: &[u32; 2]| {
        let [a, b] = edge.map(|v| subject.point(v));
        match violation.kind {
            Kind::VertexOnEdge => is_inside(&violation.point, &a, &b),
            _ => orient3d(&p, &q, &a, &b) == 0,
        }
    };
    let corners = subject.triangles[triangle as usize];
    let inner = |kind| {
        let met: Vec<[u32; 2]> = segments_of(&corners).filter(is_met).collect();
        if !met.is_empty() && !met.iter().any(is_listed) { kind } else { violation.kind }
    };
    match violation.kind {
        Kind::VertexOnEdge => inner(Kind::VertexOnFacet),
        Kind::EdgesCross => inner(Kind::Penetration),
        other => other,
    }
}

/// Segments and vertices by themselves, which meet nothing: an error where TetGen cannot keep them.
pub(super) fn places(subject: &Subject, volumes: &Volumes, caster: &Caster) -> Vec<Diagnostic> {
    let mut findings = Vec::new();
    for l in subject.loose.iter().filter(|l| l.origin != Origin::Spike) {
        let name = subject.facet_name(l.facet);
        let [a, b] = l.ends;
        let middle = (subject.point(a) + subject.point(b)) * 0.5;
        let (code, what) = match a == b {
            true => ("loose-vertex", format!("{name} lists vertex {}, which is outside of its area", a + 1)),
            false => {
                ("loose-segment", format!("{name} lists a segment from vertex {} to {} outside of its area", a + 1, b + 1))
            }
        };
        let is_lost = a != b && volumes.at(&middle, caster) == Ok(0);
        if l.origin == Origin::NoArea && !is_lost {
            continue;
        }
        findings.push(
            match is_lost {
                true => Diagnostic::error(code, format!("{what} and of every volume"))
                    .hint("TetGen crashes on it: take it out of the file"),
                false => Diagnostic { severity: Severity::Warning, ..Diagnostic::error(code, what) }
                    .hint("TetGen keeps it as a constraint of the mesh; take it out if it bounds nothing"),
            }
            .near(middle),
        );
    }
    findings
}
