//! V - E + F - L = 2 (R + S - H) over uses (thesis 2.2.3.1, Eq. 2.1).
//!
//! Each side of a facet is a facet use. V counts vertices once per place where a shell passes them, E edges once per pair of
//! facet uses that meet there, L the further boundary pieces of facet uses, R outer shells, S the others (those of the unbounded
//! volume among them), H handles. V, E, F, L come from the polygons, the handles from the triangles: the count fails if the two
//! do not describe the same surface.

use super::Subject;
use crate::diag::Diagnostic;
use crate::geom::union_find::UnionFind;
use crate::plc::volumes::Volumes;
use std::collections::{BTreeMap, BTreeSet};

/// A finding if the count does not balance.
pub fn unbalanced(subject: &Subject, volumes: &Volumes) -> Option<Diagnostic> {
    let listed: BTreeSet<[u32; 2]> = subject
        .plc
        .facets
        .iter()
        .flat_map(|f| &f.polygons)
        .flat_map(|p| (0..p.len()).map(move |k| [p[k], p[(k + 1) % p.len()]]))
        .map(|[a, b]| [a.min(b), a.max(b)])
        .collect();
    let v = volumes.vertex_uses as i64;
    let e: i64 = volumes.edges.iter().filter(|(edge, _)| listed.contains(edge)).map(|&(_, n)| i64::from(n)).sum();
    let f = 2 * subject.plc.facets.len() as i64;
    let several = subject.plc.facets.iter().filter(|f| f.polygons.len() > 1);
    let l: i64 = several.map(|f| 2 * (boundary_pieces(&f.polygons) - 1)).sum();
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
            .hint("a polygon and its triangulation differ, or a facet falls into several pieces")
    })
}

/// Number of connected pieces of a facet's boundary: loops that share a vertex are one.
fn boundary_pieces(polygons: &[Vec<u32>]) -> i64 {
    let mut first: BTreeMap<u32, u32> = BTreeMap::new();
    let mut union = UnionFind::new(polygons.len());
    for (k, polygon) in polygons.iter().enumerate() {
        for &v in polygon {
            union.join(k as u32, *first.entry(v).or_insert(k as u32));
        }
    }
    (0..polygons.len() as u32).filter(|&k| union.find(k) == k).count() as i64
}
