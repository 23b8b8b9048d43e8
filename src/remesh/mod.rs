//! Remesher: from the evaluated [`Complex`] to one whose curved facets are well-shaped triangles on their true surfaces
//! (thesis 4.2, Table 4.1).
//!
//! Reads the complex of `round` (while it still has its killed facets) and gives `plc` a complex with the same regions,
//! surfaces, markers and interfaces. Planar facets stay polygons.
//!
//! 1. Supports: `patch` gives every curved surface its true shape, before anything changes.
//! 2. Strips of the treated surfaces are divided into triangles (`Brep::divide_facet`).
//! 3. Feature edges (`features`) are chained between corners; every chain gets its true curve, every vertex its place: corner,
//!    on a curve, on a surface. A vertex of an intersection is projected on all surfaces at once.
//! 4. Sizes (`sizing`): the edge length whose chord has the allowed deviation, limited by parts and thin gaps, graded.
//! 5. Rounds (`schedule`): split what is too long, longest first, with swaps around each new vertex; collapse what is too
//!    short, shortest first; bring vertices home onto their curves and surfaces; swap; move vertices to the middle.
//! 6. Polish, worst triangle first: the one of swap, collapse and relocation (`relocate`: a pattern search) that raises the
//!    smallest angle around most.
//! 7. Thin out: collapse what shape and deviation do not need; split what still deviates too far; polish.
//! 8. Planar facets get new triangulations.
//!
//! Every operation (`operators`) is a short sequence of Euler operators of the kernel (`brep::local`), planned and judged before
//! it is applied: nothing flips against the support, no deviation grows past the bound, planar facets beside stay simple
//! (`polygons`, exact signs), freedoms are kept. Cost: linear in the number of edges, up to the queues' logarithm.
//!
//! Departures from the thesis, and why:
//! - A priority queue instead of sweeps over all edges (its own future work, 6.2): fewer operations, and independent of the
//!   order of edges.
//! - Supports are exact where the primitive is known: projection does not drift.
//! - Feature edges are known from the topology, so that an edge between two vertices of features may be swapped if it is not
//!   a feature itself.
//! - Deviation is measured at the middle of edges and at barycentres; a feature edge also against its true curve.
//! - Sizes come first and angles last: raising angles alone keeps the needles of long strips alive.
//!
//! ```text
//! strip 300 x 26 of a cylinder -> split along its length at the wanted size, swapped to triangles, 24 segments kept or not
//! ```

mod features;
mod operators;
mod polygons;
mod quality;
mod relocate;
mod schedule;
mod sizing;
mod workpiece;

use crate::brep::complex::Complex;
use crate::brep::model::Brep;
use crate::diag::{Diagnostic, Outcome};
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use crate::ids::{FacetId, Id};
use crate::ids::{IdVec, PartId};
use crate::patch::fit::supports_of;
use crate::scene::model::{Part, RemeshMode, RemeshOptions};
use sizing::{Bound, Limits};
use std::collections::HashMap;
use workpiece::Workpiece;

/// Remeshes a complex.
///
/// Input: an evaluated complex, valid as its type says, with killed facets. On return: regions, surfaces and markers have kept
/// their numbers; vertices and facets are new; with [`RemeshMode::Off`] nothing has changed.
///
/// # Errors
/// Internal ones if the complex breaks its invariants or a planar facet cannot be triangulated again.
pub fn remesh(complex: Complex, options: &RemeshOptions, parts: &IdVec<PartId, Part>) -> Outcome<Complex> {
    if options.mode == RemeshMode::Off {
        return Ok(complex);
    }
    let supports = supports_of(&complex, options.patches);
    let size = Aabb::around(complex.vertices.iter().map(|v| &v.point)).diagonal();
    let brep = Brep::from_complex(complex)?;
    let mut work = Workpiece {
        brep,
        supports,
        curves: Default::default(),
        lone_edges: HashMap::new(),
        is_treated: Vec::new(),
        sense: Vec::new(),
        places: Vec::new(),
        sizes: Vec::new(),
        bound: Bound::Fixed(size),
    };
    let treated = work.choose(options.mode);
    work.bound = match options.max_deviation {
        Some(d) => Bound::Fixed(d),
        None => work.present_bound(&treated, size),
    };
    let limits = Limits::of(&work, size, parts);
    work.divide(&treated);
    work.find_features();
    work.run(&limits);
    work.retriangulate()?;
    Ok(work.brep.to_complex())
}

impl Workpiece {
    /// The facets to be remeshed.
    fn choose(&self, mode: RemeshMode) -> Vec<FacetId> {
        let topology = &self.brep.topology;
        let is_curved = |f: &FacetId| self.supports[self.brep.facets[*f].surface].is_some();
        let is_modified = |f: FacetId| self.brep.facets[f].is_modified;
        // Strips are as long as their side: only the cut ones. Triangles: also those beside cut ones.
        let is_beside =
            |f: FacetId| topology.triangle(f).is_some_and(|t| t.iter().any(|&v| topology.facets_at(v).any(is_modified)));
        topology.facets().filter(is_curved).filter(|&f| mode == RemeshMode::Full || is_modified(f) || is_beside(f)).collect()
    }

    /// The default bound (equation 4.1).
    fn present_bound(&self, treated: &[FacetId], size: f64) -> Bound {
        let triangles = treated.iter().filter_map(|&f| self.support(f).map(|s| (f, s)));
        Bound::of_facets(triangles.flat_map(|(f, s)| self.brep.triangles(f).map(move |t| (s, t.map(|v| self.point(v))))), size)
    }

    /// Cuts the treated polygons into triangles and enters all treated triangles.
    fn divide(&mut self, treated: &[FacetId]) {
        for &facet in treated {
            let sense = self.sense_of_polygon(facet);
            let pieces = match self.brep.topology.triangle(facet) {
                Some(_) => vec![facet],
                None => self.brep.divide_facet(facet).facets,
            };
            self.register(&pieces, sense);
        }
        self.register(&[], 1.0);
    }

    /// Sense of a whole facet against its support: taken from its largest triangle, never from a sliver.
    fn sense_of_polygon(&self, facet: FacetId) -> f64 {
        let Some(support) = self.support(facet) else { return 1.0 };
        let mut largest = (0.0, 1.0);
        for [a, b, c] in self.brep.triangles(facet).map(|t| t.map(|v| self.point(v))) {
            let normal: Vec3 = (b - a).cross(&(c - a));
            if normal.norm() > largest.0 {
                let along = normal.dot(&support.closest(&((a + b + c) / 3.0)).normal);
                largest = (normal.norm(), if along < 0.0 { -1.0 } else { 1.0 });
            }
        }
        largest.1
    }

    /// New triangulations of the planar facets beside treated ones.
    fn retriangulate(&mut self) -> Outcome<()> {
        let mut failed = Vec::new();
        let flat: Vec<FacetId> = self.brep.topology.facets().filter(|&f| !self.is_treated(f)).collect();
        for facet in flat {
            if self.brep.topology.triangle(facet).is_none() && self.brep.retriangulate(facet).is_err() {
                let corner = self.brep.triangles(facet).next().map_or(Vec3::zeros(), |t| self.point(t[0]));
                let message = format!("planar facet {} is not simple after remeshing", facet.index());
                failed.push(Diagnostic::internal("remesh-polygon", message).near(corner));
            }
        }
        if failed.is_empty() { Ok(()) } else { Err(failed) }
    }
}

#[cfg(test)]
mod tests;
