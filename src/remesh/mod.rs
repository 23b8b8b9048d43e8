//! Remesher: from the evaluated [`Complex`] to one whose curved facets are well-shaped triangles on their true surfaces
//! (thesis 4.2, Table 4.1).
//!
//! Reads the complex of `round` (while it still has its killed facets) and gives `plc` a complex with the same regions,
//! surfaces, markers and interfaces. Planar facets stay polygons.
//!
//! 1. Supports: `patch` gives every curved surface its true shape, before anything changes.
//! 2. What is remeshed: all curved facets but strips beside thin gaps (`kept`), or those near curves that an intersection made;
//!    strips are cut across there (`bands`). These facets are divided into triangles (`Brep::divide_facet`).
//! 3. Feature edges (`features`) are chained between corners; every chain gets its true curve, every vertex its place: corner,
//!    on a curve, on a surface. A vertex of an intersection is projected on all surfaces at once; where its way home is longer
//!    than its chords, it goes there together with its neighbours. Facets between curves that coincide on the true surfaces stay
//!    as evaluated (`pinches`).
//! 4. Sizes (`sizing`): the edge length whose chord has the allowed deviation, limited by parts and thin gaps, graded.
//! 5. Rounds (`schedule`): collapse chords of curves that are too short; split what is too long, longest first and rulings
//!    before what crosses them, with swaps around each new vertex; collapse what is too short, shortest first; bring vertices
//!    home onto their curves and surfaces; swap; move vertices to the middle. From the second round on, lengths beside curves
//!    fit the chords that had to stay.
//! 6. Polish (`polish`), worst triangle first: the one of swap, collapse and relocation (`ring`: a pattern search) that raises
//!    the smallest angle around most.
//! 7. Thin out: collapse what shape and deviation do not need; split what still deviates too far, the halves of a chord evened
//!    out with its neighbours; polish.
//! 8. Obtuse triangles that are left: trials that begin with a step back, kept if the angles gain (`acute`); passes allow ever
//!    smaller angles for it.
//! 9. Neighbouring facets almost in one plane are brought into it, or turned clear of it (`bends`), and become polygons.
//! 10. Planar facets get new triangulations, and an exact test proves that nothing meets anything (`verify`). Surfaces at fault
//!     are remeshed again with half the deviation, then (at once if the attempt had to be broken off) without their facets
//!     there, as where needles are left; if nothing helps, the complex stays as evaluated.
//! 11. On a copy from before it had polygons, edges and triangles with a vertex in their smallest sphere, which TetGen would
//!     split, are cleared of it (`sight`). The copy is taken if nothing is at fault that was not before.
//!     Polygons get no corners that are straight but for rounding, of which TetGen would die: these are moved out by a trace,
//!     or the polygon is cut (`straight`).
//!
//! Every operation (`operators`) is a short sequence of Euler operators of the kernel (`brep::local`), planned and judged
//! before it is applied: nothing flips against the support, no deviation grows past the bound, planar facets beside stay simple
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

mod acute;
mod bands;
mod bends;
pub mod change;
mod creases;
mod features;
pub mod forecast;
mod gaps;
mod history;
mod kept;
mod operators;
mod pieces;
mod pinches;
mod polish;
mod polygons;
mod quality;
mod relocate;
mod ring;
mod schedule;
mod sight;
mod sizing;
mod straight;
mod strips;
mod trial;
mod verify;
mod workpiece;

use crate::brep::complex::Complex;
use crate::brep::model::Brep;
use crate::diag::Outcome;
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use crate::ids::{FacetId, Id, IdVec, PartId, SurfaceId, VertexId};
use crate::patch::fit::supports_of;
use crate::patch::support::Support;
use crate::scene::model::{Part, RemeshMode, RemeshOptions};
use bands::Choice;
use gaps::Gaps;
use history::History;
use sizing::{Bound, Bounds, Limits};
use std::collections::HashMap;
use std::sync::Arc;
use verify::Fault;
use workpiece::Workpiece;

type Supports = IdVec<SurfaceId, Option<Arc<Support>>>;

/// Attempts at most; each one gives up something where facets met in the one before. An import with many grazing cuts took
/// eight, most of them broken off early.
const ATTEMPTS: usize = 13;
/// Share of the deviation bound of surfaces on which facets met.
const CLOSER_SHARE: f64 = 0.5;

/// Remeshes a complex.
///
/// Input: an evaluated complex, valid as its type says, with killed facets. On return: regions, surfaces and markers have kept
/// their numbers; vertices and facets are new; with [`RemeshMode::Off`] nothing has changed.
///
/// # Errors
/// Internal ones if the complex breaks its invariants.
pub fn remesh(complex: Complex, options: &RemeshOptions, parts: &IdVec<PartId, Part>) -> Outcome<Complex> {
    if options.mode == RemeshMode::Off {
        return Ok(complex);
    }
    let evaluated = complex.clone();
    let mut complex = complex;
    let original = creases::divide(&mut complex);
    let supports = supports_of(&complex, options.patches);
    let gaps = Gaps::of(&complex, &supports);
    let choice = match options.mode {
        RemeshMode::Interfaces => Choice::near_intersections(&mut complex, &supports),
        _ => Choice::all(&complex, &supports, &gaps, options, parts),
    };
    if !choice.is_chosen.contains(&true) {
        return Ok(evaluated);
    }
    let mut retreat = Retreat { shares: vec![1.0; complex.surfaces.len()], choice, round: 0.0 };
    for left in (0..ATTEMPTS).rev() {
        let (mut work, limits) = retreat.begin(&complex, &supports, &gaps, options, parts)?;
        let is_done = work.remesh(&limits);
        let rough = is_done.then(|| work.clone());
        if is_done {
            work.make_polygons();
        }
        let mut faults = work.faults();
        // Half done, it has needles that would go.
        faults.retain(|f| is_done || f.is_contact);
        let is_last = !retreat.give_up(&faults, is_done, &complex, &supports) || left == 0;
        if is_last && faults.iter().all(|f| !f.is_contact) {
            let cleared = rough.and_then(|rough| rough.cleared(&limits, faults.len()));
            let work = cleared.unwrap_or(work);
            let mut done = work.brep.to_complex();
            straight::cut_unsound(&mut done, &evaluated);
            creases::restore(&mut done, &original, &evaluated.surfaces);
            return Ok(done);
        }
        if is_last {
            break;
        }
    }
    Ok(evaluated)
}

/// What is given up where remeshing made facets meet.
struct Retreat {
    /// By surface: share of the deviation bound that it may use.
    shares: Vec<f64>,
    choice: Choice,
    /// How far from the places facets are given up, in sizes of the place: each time twice as far, so that it comes to an end
    /// soon.
    round: f64,
}

impl Retreat {
    /// The model ready for work, with the facets that have to stay left out.
    fn begin<'a>(
        &mut self,
        complex: &Complex,
        supports: &Supports,
        gaps: &'a Gaps,
        options: &RemeshOptions,
        parts: &IdVec<PartId, Part>,
    ) -> Outcome<(Workpiece, Limits<'a>)> {
        loop {
            let mut work = Workpiece::new(complex.clone(), supports.clone(), self.shares.clone(), self.choice.clone())?;
            let limits = work.prepare(gaps, options, parts);
            if !self.leave(&work.pinched(), complex) {
                return Ok((work, limits));
            }
        }
    }

    /// Leaves the facets at some vertices as they are; whether any was chosen.
    fn leave(&mut self, vertices: &[VertexId], complex: &Complex) -> bool {
        let mut is_less = false;
        for (facet, is_chosen) in complex.facets.iter().zip(&mut self.choice.is_chosen).filter(|f| *f.1) {
            if facet.loops.iter().flatten().any(|v| vertices.binary_search(v).is_ok()) {
                *is_chosen = false;
                is_less = true;
            }
        }
        is_less
    }

    /// A surface whose facets meet others for the first time is to keep closer to its true shape, if that is known; after that,
    /// where there are needles, or where an attempt was not done because too many met, its facets stay as they are: chords of half
    /// the deviation are hardly shorter than those that were far too long. Whether anything was given up.
    fn give_up(&mut self, faults: &[Fault], is_done: bool, complex: &Complex, supports: &Supports) -> bool {
        let is_exact = |s: SurfaceId| supports[s].as_ref().is_some_and(|s| !s.is_fitted());
        let is_new = |f: &&Fault| is_done && f.is_contact && self.shares[f.surface.index()] == 1.0 && is_exact(f.surface);
        let (new, again): (Vec<&Fault>, Vec<&Fault>) = faults.iter().partition(is_new);
        for fault in &new {
            self.shares[fault.surface.index()] = CLOSER_SHARE;
        }
        let mut is_less = !new.is_empty();
        self.round = (2.0 * self.round).max(1.0);
        if again.is_empty() {
            return is_less;
        }
        for (facet, is_chosen) in complex.facets.iter().zip(&mut self.choice.is_chosen).filter(|f| *f.1) {
            let place = Aabb::around(facet.loops.iter().flatten().map(|&v| &complex.vertices[v].point));
            let is_at =
                |f: &&Fault| f.surface == facet.surface && f.place.inflated(f.place.diagonal() * self.round).overlaps(&place);
            if again.iter().any(is_at) {
                *is_chosen = false;
                is_less = true;
            }
        }
        is_less
    }
}

impl Workpiece {
    fn new(complex: Complex, supports: Supports, shares: Vec<f64>, choice: Choice) -> Outcome<Self> {
        let size = Aabb::around(complex.vertices.iter().map(|v| &v.point)).diagonal();
        let extent = complex.vertices.iter().fold(size, |m, v| m.max(v.point.amax()));
        Ok(Self {
            extent,
            brep: Brep::from_complex(complex)?,
            supports,
            curves: IdVec::new(),
            lone_edges: HashMap::new(),
            is_treated: Vec::new(),
            sense: Vec::new(),
            places: Vec::new(),
            sizes: Vec::new(),
            bounds: Bounds::Given(size),
            curve_bounds: IdVec::new(),
            shares,
            choice,
            obtuse: 0.0,
            small: 1.0,
            measures: Vec::new(),
            history: History::default(),
        })
    }

    /// Finds bound, sizes and features.
    fn prepare<'a>(&mut self, gaps: &'a Gaps, options: &RemeshOptions, parts: &IdVec<PartId, Part>) -> Limits<'a> {
        let size = Aabb::around(self.brep.vertices.iter().map(|v| &v.point)).diagonal();
        let treated = self.chosen();
        self.bounds = match options.max_deviation {
            Some(d) => Bounds::Given(d),
            None => self.present_bounds(&treated, size),
        };
        let limits = Limits::new(gaps, size, &self.brep.markers, parts);
        self.divide(&treated);
        self.find_features();
        limits
    }

    /// False if it was broken off, because facets meet.
    fn remesh(&mut self, limits: &Limits) -> bool {
        let is_done = self.run(limits);
        if is_done {
            // Before facets become polygons, which could not follow.
            self.clear_straight_corners();
            self.clear_bends(limits, self.active_edges());
        }
        is_done
    }

    /// The same with edges and triangles cleared of vertices in their spheres, if nothing meets anything for that and no more
    /// than `needles` are left: all else stands without.
    fn cleared(mut self, limits: &Limits, needles: usize) -> Option<Self> {
        self.clear_spheres(limits);
        self.make_polygons();
        let faults = self.faults();
        (faults.len() <= needles && !faults.iter().any(|f| f.is_contact)).then_some(self)
    }

    /// Makes polygons of facets in one plane, and mends what slid back.
    fn make_polygons(&mut self) {
        self.merge_flat();
        self.clear_straight_corners();
    }

    /// The facets to be remeshed.
    fn chosen(&self) -> Vec<FacetId> {
        let facets = self.brep.topology.facets();
        facets.filter(|&f| self.choice.is_chosen[f.index()]).collect()
    }

    /// The default bounds (equation 4.1).
    fn present_bounds(&self, treated: &[FacetId], size: f64) -> Bounds {
        let mut facets: IdVec<SurfaceId, Vec<FacetId>> = self.supports.iter().map(|_| Vec::new()).collect();
        treated.iter().for_each(|&f| facets[self.brep.facets[f].surface].push(f));
        let triangles = |f: &FacetId| self.brep.triangles(*f).map(|t| t.map(|v| self.point(v)));
        let bound = |(support, facets): (&Option<Arc<Support>>, &Vec<FacetId>)| match support {
            Some(support) => Bound::of_facets(support, facets.iter().flat_map(triangles), size),
            None => Bound::Fixed(size),
        };
        Bounds::Present(self.supports.iter().zip(facets.iter()).map(bound).collect())
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
                let along = normal.dot(&support.nearest(&((a + b + c) / 3.0)).normal);
                largest = (normal.norm(), if along < 0.0 { -1.0 } else { 1.0 });
            }
        }
        largest.1
    }
}

#[cfg(test)]
mod tests;
