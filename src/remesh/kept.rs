//! What stays when all curved facets are remeshed: strips at the rims of sheets, and beside thin gaps and walls.
//!
//! Tetrahedra span what is thinner than triangles are long, so that the edges of either side show on the other, and TetGen must
//! keep them all; a strip it divides as it needs to. In Full at a deviation of 1.15 mm, transformer3 has 33900 tetrahedra so, 2
//! of them above ratio 2.0; of triangles alone 60500, 743 of them above.

use super::Supports;
use super::bands::Choice;
use super::gaps::Gaps;
use super::sizing::{EASE, NARROWEST, PER_STRIP, wanted_for, wanted_on};
use super::strips::{Edge, Strips};
use super::workpiece::sorted;
use crate::brep::complex::Complex;
use crate::geom::Vec3;
use crate::ids::{FacetId, Id, IdVec, PartId, SurfaceId};
use crate::scene::model::{Part, RemeshOptions};

/// Length of a strip's rulings over its chords below which triangles of the smallest chords that a narrow strip may ask for
/// ([`NARROWEST`]) do not fit.
const SHORTEST_STRIP: f64 = NARROWEST / PER_STRIP;

/// How far two sides of a gap may come towards each other, in allowed deviations: from their facets to their true surfaces, and
/// from there.
const MEETING: f64 = 2.0;

/// A facet between two rulings.
struct Strip {
    facet: FacetId,
    rulings: [Edge; 2],
    chords: [Edge; 2],
    /// Distance of the chords from the true surface.
    sag: f64,
}

/// A strip that stays, with the facets across a gap that might meet it on their way to their true surfaces.
type Kept = (Strip, Vec<FacetId>);

impl Choice {
    /// All curved facets, but for strips that stay where they are as the user wants them.
    pub fn all(
        complex: &Complex,
        supports: &Supports,
        gaps: &Gaps,
        options: &RemeshOptions,
        parts: &IdVec<PartId, Part>,
    ) -> Self {
        let strips = Strips::of(complex, supports);
        let is_off = strips.off_vertices();
        let is_true = |facet: FacetId| !complex.facets[facet].loops.iter().flatten().any(|v| is_off[v.index()]);
        let candidates: Vec<Strip> = complex.facets.ids().filter_map(|f| strips.strip(f)).collect();
        let allowed = strips.allowed(&candidates, options);
        let mut is_chosen: Vec<bool> = complex.facets.iter().map(|f| supports[f.surface].is_some()).collect();
        let mut faced: Vec<Kept> = Vec::new();
        for strip in candidates {
            let facet = &complex.facets[strip.facet];
            let (allowed, longest) = (allowed[facet.surface], wanted_on(&complex.markers[facet.marker], parts));
            if strip.sag > allowed || strips.widest(&strip) > longest {
                continue;
            }
            if strips.is_rim(&strip) {
                is_chosen[strip.facet.index()] = false;
            } else if strips.with_neighbours(&strip).all(is_true) {
                let reach = strips.wanted(&strip, allowed).min(longest);
                if let Some(near) = gaps.facing(facet, complex, [MEETING * allowed, reach]) {
                    is_chosen[strip.facet.index()] = false;
                    faced.push((strip, near));
                }
            }
        }
        strips.drop_beside_treated(&mut faced, &mut is_chosen);
        Self { is_chosen, slides: Vec::new() }
    }
}

impl Strips<'_> {
    fn strip(&self, facet: FacetId) -> Option<Strip> {
        let &[a, b, c, d] = self.complex.facets[facet].loops[0].as_slice() else { return None };
        let support = self.support(facet)?;
        let (across, along) = ([[a, b], [c, d]], [[b, c], [d, a]]);
        let is_straight = |edges: &[Edge; 2]| edges.iter().all(|&e| self.is_straight_on(e, facet));
        let (rulings, chords) =
            if is_straight(&across) { (across, along) } else { is_straight(&along).then_some((along, across))? };
        let sags = chords.map(|[a, b]| support.distance(&((self.point(a) + self.point(b)) * 0.5)));
        Some(Strip { facet, rulings, chords, sag: sags[0].max(sags[1]) })
    }

    /// By surface: the allowed deviation.
    fn allowed(&self, strips: &[Strip], options: &RemeshOptions) -> IdVec<SurfaceId, f64> {
        let mut allowed: IdVec<SurfaceId, f64> = self.complex.surfaces.iter().map(|_| 0.0).collect();
        for strip in strips {
            let allowed = &mut allowed[self.complex.facets[strip.facet].surface];
            *allowed = options.max_deviation.unwrap_or(allowed.max(EASE * strip.sag));
        }
        allowed
    }

    /// Edge length of the triangles that there would be.
    fn wanted(&self, strip: &Strip, allowed: f64) -> f64 {
        let middle = strip.rulings.iter().flatten().map(|&v| self.point(v)).sum::<Vec3>() / 4.0;
        self.support(strip.facet).map_or(0.0, |support| wanted_for(support, &middle, allowed))
    }

    /// The facets at the rulings of a strip, itself among them. Where a ruling ends at an intersection, or passes near one, the
    /// triangles beyond must be free to pass it.
    fn with_neighbours(&self, strip: &Strip) -> impl Iterator<Item = FacetId> {
        strip.rulings.map(sorted).into_iter().flat_map(|ruling| self.around(ruling))
    }

    fn length(&self, [a, b]: Edge) -> f64 {
        (self.point(b) - self.point(a)).norm()
    }

    fn widest(&self, strip: &Strip) -> f64 {
        strip.chords.map(|e| self.length(e)).into_iter().fold(0.0, f64::max)
    }

    /// Whether it is so short along its rulings that its triangles would be needles, as at the rim of a sheet.
    fn is_rim(&self, strip: &Strip) -> bool {
        let least = strip.chords.map(|e| self.length(e)).into_iter().fold(f64::INFINITY, f64::min);
        strip.rulings.iter().all(|&r| self.length(r) < SHORTEST_STRIP * least)
    }

    /// Whether more than one surface has an edge.
    fn is_meeting(&self, edge: Edge) -> bool {
        let surfaces: Vec<SurfaceId> = self.around(edge).map(|f| self.complex.facets[f].surface).collect();
        surfaces.len() != 2 || surfaces[0] != surfaces[1]
    }

    /// Has strips treated after all that share a chord with a treated facet, which may need smaller chords than a strip that
    /// stays would give it; or a ruling where other surfaces meet, whose vertices could not leave the line as those inside of a
    /// surface do, so that it would not be split; or that a treated facet might meet. Rows of strips go in one or two passes,
    /// as they are turned.
    fn drop_beside_treated(&self, strips: &mut [Kept], is_chosen: &mut [bool]) {
        let mut is_changed = true;
        while std::mem::take(&mut is_changed) {
            for (strip, near) in strips.iter() {
                let meeting = strip.rulings.iter().filter(|&&r| self.is_meeting(sorted(r)));
                let edges = strip.chords.iter().chain(meeting);
                let mut beside = edges.flat_map(|&e| self.around(sorted(e))).chain(near.iter().copied());
                if !is_chosen[strip.facet.index()] && beside.any(|f| is_chosen[f.index()]) {
                    is_chosen[strip.facet.index()] = true;
                    is_changed = true;
                }
            }
            strips.reverse();
        }
    }
}
