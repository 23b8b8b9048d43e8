//! Triangles meet only in whole shared vertices and edges.

use super::Subject;
use crate::diag::Diagnostic;
use crate::geom::embedding::{self, Kind};
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
        let [a, b] = facets.map(|f| subject.facet_name(f));
        let (code, message, hint) = match v.kind {
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
        findings.push(Diagnostic::error(code, message).near(v.point).hint(hint));
    }
    findings
}
