//! V - E + F - L = 2 (R + S - H) over uses (thesis 2.2.3.1, Eq. 2.1).
//!
//! Each side of a face is a facet use; a facet is one face unless its segments divide it. V counts vertices once per place
//! where a shell passes them, E edges once per pair of facet uses that meet there, L the further boundary pieces of facet uses,
//! R outer shells, S the others (those of the unbounded volume among them), H handles. V, E, F, L come from the polygons, the
//! handles from the triangles: the count fails if the two do not describe the same surface.

use super::Subject;
use super::faces::Faces;
use crate::diag::Diagnostic;
use crate::plc::facet::segments_of;
use crate::plc::volumes::Volumes;
use std::collections::BTreeSet;

/// A finding if the count does not balance.
pub fn unbalanced(subject: &Subject, volumes: &Volumes, faces: &Faces) -> Option<Diagnostic> {
    let polygons = subject.plc.facets.iter().flat_map(|f| &f.polygons);
    let listed: BTreeSet<[u32; 2]> = polygons.flat_map(|p| segments_of(p)).collect();
    let v = volumes.vertex_uses as i64;
    let e: i64 = volumes.edges.iter().filter(|(edge, _)| listed.contains(edge)).map(|&(_, n)| i64::from(n)).sum();
    let f = 2 * faces.boundaries.len() as i64;
    let l: i64 = faces.boundaries.iter().map(|&b| 2 * (i64::from(b) - 1)).sum();
    let outer = volumes.shells.iter().filter(|s| s.is_outer).count() as i64;
    let inner = volumes.shells.len() as i64 - outer;
    let twice_handles: i64 = volumes.shells.iter().map(|s| 2 - s.characteristic).sum();
    let (left, right) = (v - e + f - l, 2 * (outer + inner) - twice_handles);
    let is_surface = volumes.shells.iter().all(|s| s.characteristic <= 2 && s.characteristic % 2 == 0);
    (left != right || !is_surface).then(|| {
        let message = format!(
            "the B-rep count does not balance: V {v} - E {e} + F {f} - L {l} = {left}, \
             2 (R {outer} + S {inner}) - 2 H {twice_handles} = {right}"
        );
        Diagnostic::error("unbalanced-count", message)
            .hint("a polygon and its triangulation differ: divide the facets near sharp corners into triangles")
    })
}
