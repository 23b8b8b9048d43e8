//! Triangles meet only in whole shared vertices and edges.

use super::Subject;
use crate::diag::Diagnostic;
use crate::geom::Vec3;
use crate::geom::embedding::{self, Kind};
use crate::plc::facet::segments_of;
use std::collections::BTreeSet;

/// Pairs of triangles looked at; what they have in common with others is mostly the same defect.
const MAX_PAIRS: usize = 10_000;

/// Forbidden contacts, one finding per defect: per vertex where it is a vertex, else per pair of facets.
pub fn forbidden(subject: &Subject) -> Vec<Diagnostic> {
    let pairs = embedding::violations(&subject.plc.vertices, &subject.triangles, MAX_PAIRS);
    let mut seen = BTreeSet::new();
    let mut findings = Vec::new();
    for v in pairs {
        let facets = v.triangles.map(|t| subject.facet_of[t as usize]);
        let place: [u64; 3] = match v.kind {
            Kind::CoincidentVertices | Kind::VertexOnEdge | Kind::VertexOnFacet | Kind::EdgesCross => {
                v.point.map(f64::to_bits).into()
            }
            _ => [u64::from(facets[0].min(facets[1])), u64::from(facets[0].max(facets[1])), 0],
        };
        if !seen.insert((v.kind, place)) {
            continue;
        }
        findings.push(finding(subject, v.kind, v.point, facets));
    }
    findings
}

/// What is told of a contact of two facets.
pub(super) fn finding(subject: &Subject, kind: Kind, point: Vec3, facets: [u32; 2]) -> Diagnostic {
    let [a, b] = facets.map(|f| subject.facet_name(f));
    let (code, message, hint) = match kind {
        Kind::CoincidentVertices => {
            ("duplicate-vertex", format!("{a} and {b} have different vertices at one place"), "use one vertex")
        }
        Kind::VertexOnEdge => (
            "t-junction",
            format!("a vertex of one lies on an edge of the other: {a}, {b}"),
            "list the vertex in every polygon along that edge",
        ),
        Kind::VertexOnFacet => (
            "vertex-on-facet",
            format!("a vertex of one lies inside the other: {a}, {b}"),
            "list the vertex in the facet as a polygon of one vertex",
        ),
        Kind::EdgesCross => (
            "edges-cross",
            format!("an edge of one crosses an edge of the other: {a}, {b}"),
            "divide both edges where they cross",
        ),
        Kind::Penetration => (
            "penetration",
            format!("an edge of one passes through the other: {a}, {b}"),
            "evaluate the parts together, so that they are cut along their intersection",
        ),
        Kind::Overlap | Kind::Duplicate => (
            "overlap",
            format!("they share area in one plane: {a}, {b}"),
            "make one facet of the common area and cut it out of the others",
        ),
        Kind::Degenerate => (
            "degenerate",
            format!("a triangle of it has no area: {a}"),
            "remove vertices that lie on one line with their neighbours and bound nothing",
        ),
    };
    Diagnostic::error(code, message).near(point).hint(hint)
}

/// Segments that one facet lists and that lie in another, between two of its vertices, without being listed there.
pub(super) fn unlisted_edges(subject: &Subject) -> Vec<Diagnostic> {
    let listed_by = |k: usize| subject.plc.facets[k].polygons.iter().flat_map(|p| segments_of(p));
    let facets = 0..subject.plc.facets.len();
    let mut listed: Vec<([u32; 2], u32)> = facets.flat_map(|k| listed_by(k).map(move |s| (s, k as u32))).collect();
    listed.sort_unstable();
    let mut seen = BTreeSet::new();
    let mut findings = Vec::new();
    for (triangle, &facet) in subject.triangles.iter().zip(&subject.facet_of) {
        for edge in segments_of(triangle) {
            let from = listed.partition_point(|l| l.0 < edge);
            let Some(&(_, other)) = listed.get(from).filter(|l| l.0 == edge) else { continue };
            let is_own = listed.binary_search(&(edge, facet)).is_ok();
            if !is_own && seen.insert((edge, facet)) {
                let [a, b] = edge.map(|v| subject.point(v));
                let [name, other] = [facet, other].map(|f| subject.facet_name(f));
                let message = format!("an edge of {other} lies in {name}, which does not list it");
                let finding = Diagnostic::error("unlisted-edge", message).near((a + b) * 0.5);
                findings.push(finding.hint("list the edge in the facet as a polygon of two vertices"));
            }
        }
    }
    findings
}
