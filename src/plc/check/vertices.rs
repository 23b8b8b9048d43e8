//! No two vertices at one place, none that nothing uses.

use super::Subject;
use crate::diag::Diagnostic;
use crate::geom::cast::{CastError, Caster};

/// Vertices at the position of an earlier one.
pub fn coincident(subject: &Subject) -> Vec<Diagnostic> {
    let points = &subject.plc.vertices;
    // Adding zero makes one number of both zeros.
    let key = |v: u32| points[v as usize].map(|x| x + 0.0);
    let order = |a: u32, b: u32| {
        let (p, q) = (key(a), key(b));
        (0..3).map(|k| p[k].total_cmp(&q[k])).find(|o| o.is_ne()).unwrap_or(std::cmp::Ordering::Equal)
    };
    let mut sorted: Vec<u32> = (0..points.len() as u32).collect();
    sorted.sort_unstable_by(|&a, &b| order(a, b).then(a.cmp(&b)));
    sorted
        .windows(2)
        .filter(|w| order(w[0], w[1]).is_eq())
        .map(|w| {
            let message = format!("vertices {} and {} are at one place", w[0] + 1, w[1] + 1);
            Diagnostic::error("duplicate-vertex", message)
                .near(subject.point(w[0]))
                .hint("use one vertex for both, so that the facets at it are joined")
        })
        .collect()
}

/// Vertices that no facet lists, and whether they lie on one.
pub fn unused(subject: &Subject, caster: &Caster) -> Vec<Diagnostic> {
    let mut is_used = vec![false; subject.plc.vertices.len()];
    for &v in subject.plc.facets.iter().flat_map(|f| f.polygons.iter().flatten()) {
        is_used[v as usize] = true;
    }
    (0..is_used.len() as u32)
        .filter(|&v| !is_used[v as usize])
        .map(|v| {
            let p = subject.point(v);
            match caster.cast(&p) {
                Err(CastError::On(t)) => Diagnostic::error(
                    "unlisted-vertex",
                    format!("vertex {} lies on {}, which does not list it", v + 1, subject.facet_of_name(t)),
                )
                .hint("list the vertex in the facet as a polygon of one vertex, or take it out"),
                _ => Diagnostic::error("orphan-vertex", format!("vertex {} is used by no facet", v + 1))
                    .hint("take it out and number the others anew, or list it in the facets that it belongs to"),
            }
            .near(p)
        })
        .collect()
}

impl Subject<'_> {
    /// Name of the facet of a triangle.
    pub(super) fn facet_of_name(&self, triangle: u32) -> String {
        self.facet_name(self.facet_of[triangle as usize])
    }
}
