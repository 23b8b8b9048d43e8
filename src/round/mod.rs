//! Exact facets to `f64` coordinates, verified: a [`Complex`].
//!
//! Reads the [`Selected`] facets, gives `brep` and `remesh` a [`Complex`] that is proved to be an embedding.
//!
//! # Steps
//! 1. `dissolve`: vertices left in the middle of a straight edge go.
//! 2. Every point is rounded once, to the nearest `f64`; intersection points within 4 units in the last place of the model's size
//!    of another vertex become that vertex, and facets that collapse go (`collapse`).
//! 3. `facets`: every polygon is triangulated over its vertices; a polygon that is not planar to rounding (contact moved its
//!    vertices within the tolerance) is written as its triangles.
//! 4. The triangles are tested exactly against each other (`geom::embedding`). What fails is reported to the caller, which repairs
//!    it (`crate::evaluate`): a broken complex is never returned.
//! 5. `regions`: volumes are joined across nested components by exact rays, and numbered.

mod collapse;
mod dissolve;
mod facets;
mod freedom;
mod regions;

use crate::arrangement::Arrangement;
use crate::brep::complex::{Complex, ComplexFacet, ComplexSurface, ComplexVertex, KilledFacet};
use crate::diag::Diagnostic;
use crate::geom::Vec3;
use crate::geom::embedding::{self, Violation};
use crate::ids::{Id, IdVec, LeafId, SurfaceId, VertexId};
use crate::primitive::solid::{Freedom, Solid};
use crate::select::Selected;

/// Units in the last place of the model's size (or of its distance from the origin, if that is larger: nothing finer can be
/// written) within which a polygon's vertices lie in its plane.
pub const PLANAR_ULPS: f64 = 4.0;

/// Violations listed before giving up counting.
const VIOLATION_LIMIT: usize = 64;

/// A complex, or where rounding broke it.
pub enum Rounded {
    /// Proved to be an embedding.
    Valid(Complex),
    /// Facets meet where they must not.
    Broken {
        /// Polygons with rounded vertices that make the broken complex.
        complex: Complex,
        /// Some of the places.
        violations: Vec<Violation>,
    },
}

/// Rounds, triangulates, verifies and numbers.
///
/// `tolerance`: that of the contact step, in the scene's unit; `size`: that of the model.
pub fn round(
    mut selected: Selected,
    arrangement: &Arrangement,
    solids: &[Solid],
    tolerance: f64,
    size: f64,
) -> Result<Rounded, Diagnostic> {
    let mut loops: Vec<Vec<Vec<u32>>> = selected.facets.iter_mut().map(|f| std::mem::take(&mut f.loops)).collect();
    let places: Vec<Vec3> = (0..arrangement.points.len() as u32).map(|p| arrangement.points.at(p)).collect();
    let reach = PLANAR_ULPS * f64::EPSILON * places.iter().fold(size, |m, p| m.max(p.amax()));
    dissolve::dissolve(&mut loops, &places, tolerance.max(reach));
    let (points, loops) = collapse::weld(loops, &places, arrangement.points.explicit_len(), reach);
    let pieces = facets::triangulate(loops, &points, reach)?;
    let (surfaces, surface_of) = surface_table(solids);
    let mut complex = Complex { surfaces, markers: std::mem::take(&mut selected.markers), ..Default::default() };
    let mut volumes = Vec::with_capacity(pieces.len());
    for piece in pieces {
        let facet = &selected.facets[piece.facet];
        let solid_facet = &solids[facet.source.0.index()].facets[facet.source.1 as usize];
        let corners = |l: &[Vec<u32>]| l.iter().map(Vec::len).sum::<usize>();
        let is_modified = facet.is_partial || corners(&piece.loops) != corners(&solid_facet.loops);
        complex.facets.push(ComplexFacet {
            loops: piece.loops.into_iter().map(|l| l.into_iter().map(VertexId).collect()).collect(),
            triangles: piece.triangles.into_iter().map(|t| t.map(VertexId)).collect(),
            sides: [crate::ids::RegionId(0); 2],
            surface: surface_of(facet.source),
            source: facet.source,
            marker: facet.marker,
            is_modified,
        });
        volumes.push(facet.volumes);
    }
    complex.vertices = points.iter().map(|&point| ComplexVertex { point, freedom: Freedom::Fixed }).collect();
    let flat: Vec<[u32; 3]> = complex.facets.iter().flat_map(|f| f.triangles.iter().map(|t| t.map(|v| v.0))).collect();
    let violations = embedding::violations(&points, &flat, VIOLATION_LIMIT);
    regions::number(&mut complex, &volumes, &selected.part_of_volume)?;
    if !violations.is_empty() {
        return Ok(Rounded::Broken { complex, violations });
    }
    freedom::assign(&mut complex, arrangement, solids, &places);
    complex.killed = killed(&selected, arrangement, &places);
    Ok(Rounded::Valid(complex))
}

/// All surfaces of all leaves in order, and the surface of a leaf's facet.
fn surface_table(solids: &[Solid]) -> (IdVec<SurfaceId, ComplexSurface>, impl Fn((LeafId, u32)) -> SurfaceId) {
    let mut surfaces = IdVec::new();
    let mut first = Vec::with_capacity(solids.len());
    for (leaf, solid) in solids.iter().enumerate() {
        first.push(surfaces.len() as u32);
        for s in &solid.surfaces {
            surfaces.push(ComplexSurface { leaf: LeafId::new(leaf), side: s.side.clone(), shape: s.shape.clone() });
        }
    }
    let of: Vec<Vec<u32>> = solids.iter().map(|s| s.facets.iter().map(|f| f.surface).collect()).collect();
    (surfaces, move |(leaf, facet): (LeafId, u32)| SurfaceId(first[leaf.index()] + of[leaf.index()][facet as usize]))
}

/// Dropped pieces of sampled surfaces (their supports are fitted): the triangles that they lay on.
fn killed(selected: &Selected, arrangement: &Arrangement, places: &[Vec3]) -> Vec<KilledFacet> {
    let mut out = Vec::new();
    let mut last = u32::MAX;
    for &cell in &selected.killed {
        let triangle = arrangement.cells.triangle[cell as usize];
        if std::mem::replace(&mut last, triangle) == triangle {
            continue;
        }
        let corners = arrangement.input.triangles[triangle as usize].map(|v| places[v as usize]);
        for owner in arrangement.cells.owners_of(cell as usize) {
            out.push(KilledFacet { source: (owner.leaf, owner.facet), triangle: corners });
        }
    }
    out
}
