//! Complex to [`Plc`]: facets become polygons with facet-hole points, regions become seeds, voids become TetGen holes.

use super::seeds::{self, Sides};
use super::{Plc, PlcFacet, Seed, facet};
use crate::brep::complex::{Complex, ComplexFacet};
use crate::diag::{Diagnostic, Outcome};
use crate::geom::Vec3;
use crate::geom::parallel::both;
use crate::ids::{Id, IdVec, PartId, VertexId};
use crate::scene::model::Part;

/// Facets from which on more than one thread works.
const PARALLEL_FROM: usize = 4096;

/// The PLC of an evaluated model. Vertices and facets keep their order; marker numbers are marker ids from 1, region numbers
/// part ids from 1. Facets get their hole points, volumes of parts a seed each (in region order), voids a hole.
///
/// # Errors
/// Internal errors only: a facet without an outline, a hole or region without inside, or no finite coordinates.
pub fn build(complex: &Complex, parts: &IdVec<PartId, Part>) -> Outcome<Plc> {
    let vertices: Vec<Vec3> = complex.vertices.iter().map(|v| v.point).collect();
    let find_seeds = || {
        let (triangles, sides) = triangles_of(complex);
        seeds::find(complex, &Sides { points: &vertices, triangles: &triangles, sides: &sides })
    };
    let (facets, points) = both(complex.facets.len() >= PARALLEL_FROM, || facets_of(complex, &vertices), find_seeds);
    let (facets, points) = (facets?, points?);
    let mut plc = Plc { vertices, facets, ..Plc::default() };
    for (region, &point) in complex.regions.iter().zip(&points) {
        match (region.part, point) {
            (Some(part), Some(point)) => plc.seeds.push(Seed {
                point,
                region: i64::from(part.0) + 1,
                max_volume: parts.get(part).and_then(|p| p.max_volume),
            }),
            (None, Some(point)) => plc.holes.push(point),
            (_, None) => {}
        }
    }
    Ok(plc)
}

/// All facets in their order.
fn facets_of(complex: &Complex, vertices: &[Vec3]) -> Outcome<Vec<PlcFacet>> {
    let mut faults = Vec::new();
    let mut facets = Vec::with_capacity(complex.facets.len());
    for (id, f) in complex.facets.enumerate() {
        match polygons_of(f, vertices) {
            Ok(facet) if facet.polygons.iter().any(|p| p.len() > 2) => facets.push(facet),
            Ok(_) => faults.push(Diagnostic::internal("facet-outline", format!("facet {} has no outline", id.0))),
            Err(point) => {
                faults.push(Diagnostic::internal("facet-hole", format!("a hole of facet {} has no inside", id.0)).near(point))
            }
        }
    }
    if faults.is_empty() { Ok(facets) } else { Err(faults) }
}

/// All triangles of a complex and the regions on their sides, facet by facet.
pub fn triangles_of(complex: &Complex) -> (Vec<[u32; 3]>, Vec<[crate::ids::RegionId; 2]>) {
    let triangles = complex.triangles();
    let mut sides = Vec::with_capacity(triangles.len());
    complex.facets.iter().for_each(|f| sides.resize(sides.len() + f.triangles.len(), f.sides));
    (triangles, sides)
}

/// A facet with a point in each of its holes; the error is a place on the hole that has none.
fn polygons_of(f: &ComplexFacet, points: &[Vec3]) -> Result<PlcFacet, Vec3> {
    let numbers = |w: &[VertexId]| w.iter().map(|v| v.0).collect::<Vec<u32>>();
    let mut facet = PlcFacet { marker: f.marker.index() as i64 + 1, ..PlcFacet::default() };
    for (k, walk) in f.loops.iter().enumerate() {
        let polygon = numbers(walk);
        if k > 0 && polygon.len() > 2 {
            let inside = facet::points_inside(&polygon, points).map_err(|_| points[polygon[0] as usize])?;
            facet.holes.extend(inside);
        }
        facet.polygons.push(polygon);
    }
    Ok(facet)
}
