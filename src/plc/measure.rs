//! Volumes of regions and areas of markers.

use crate::brep::complex::{Complex, ComplexFacet};
use crate::geom::Vec3;
use crate::ids::{Id, IdVec, MarkerId, RegionId};

/// Sizes of a complex, in the scene's unit.
#[derive(Clone, Debug, Default)]
pub struct Measures {
    /// Volume of each region; 0 for the outside.
    pub volumes: IdVec<RegionId, f64>,
    /// Area of each marker.
    pub areas: IdVec<MarkerId, f64>,
    /// Number of facets of each marker.
    pub facets: IdVec<MarkerId, usize>,
}

/// Measures a complex. Each volume is summed about a vertex of its own, so that a small region far from the origin loses no
/// digits.
pub fn measure(complex: &Complex) -> Measures {
    let mut origins: Vec<Option<Vec3>> = vec![None; complex.regions.len()];
    let mut volumes = vec![0.0; complex.regions.len()];
    let mut areas = vec![0.0; complex.markers.len()];
    let mut facets = vec![0; complex.markers.len()];
    for facet in &complex.facets {
        let corners = || facet.triangles.iter().map(|t| t.map(|v| complex.vertices[v].point));
        areas[facet.marker.index()] += area_of(complex, facet);
        facets[facet.marker.index()] += 1;
        for (side, outwards) in facet.sides.into_iter().zip([-1.0, 1.0]) {
            if side.index() == 0 {
                continue;
            }
            for [a, b, c] in corners() {
                let o = *origins[side.index()].get_or_insert(a);
                volumes[side.index()] += outwards * (a - o).dot(&(b - o).cross(&(c - o)));
            }
        }
    }
    // The sum was of boxes, six times a tetrahedron each.
    volumes.iter_mut().for_each(|v| *v /= 6.0);
    Measures { volumes: volumes.into(), areas: areas.into(), facets: facets.into() }
}

/// Area of one facet.
pub fn area_of(complex: &Complex, facet: &ComplexFacet) -> f64 {
    let corners = facet.triangles.iter().map(|t| t.map(|v| complex.vertices[v].point));
    corners.map(|[a, b, c]| 0.5 * (b - a).cross(&(c - a)).norm()).sum()
}
