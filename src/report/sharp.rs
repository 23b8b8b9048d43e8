//! Sharp angles of triangular facets with their place, and whether the model itself forces them.

use crate::brep::complex::{Complex, ComplexFacet};
use crate::geom::Vec3;
use crate::ids::{SurfaceId, VertexId};
use serde::Serialize;
use std::collections::BTreeMap;

/// Angles below this many degrees are sharp (thesis 2.4.1).
const SHARP: f64 = 30.0;
/// An equilateral triangle's half of 30.000 must not count as below 30.
const ROUNDING: f64 = 1e-9;
/// Sharpest angles kept: a model that is not remeshed may have one per facet.
const MOST: usize = 1000;

/// A sharp angle of a triangular facet.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct SharpAngle {
    /// Degrees.
    pub angle: f64,
    /// The corner, in the scene's unit.
    pub at: [f64; 3],
    /// Name of the facet's marker.
    pub interface: String,
    /// Whether the facet's surface has no more than a sharp angle there in all: no triangulation could do better.
    pub is_forced: bool,
}

/// The angles below 30 degrees of the facets that are single triangles, sharpest first, 1000 at most.
pub fn sharp_angles(complex: &Complex) -> Vec<SharpAngle> {
    let point = |v: VertexId| complex.vertices[v].point;
    // How much of each surface there is around a vertex.
    let mut sectors: BTreeMap<(VertexId, SurfaceId), f64> = BTreeMap::new();
    for facet in complex.facets.iter() {
        for (vertex, angle) in facet.triangles.iter().flat_map(|t| angles_of(*t, point)) {
            *sectors.entry((vertex, facet.surface)).or_default() += angle;
        }
    }
    let is_triangle = |f: &&ComplexFacet| matches!(&f.loops[..], [only] if only.len() == 3);
    let mut sharp = Vec::new();
    for facet in complex.facets.iter().filter(is_triangle) {
        for (vertex, angle) in facet.triangles.iter().flat_map(|t| angles_of(*t, point)) {
            if angle < SHARP - ROUNDING {
                let sector = sectors.get(&(vertex, facet.surface)).copied().unwrap_or(0.0);
                let interface = complex.markers[facet.marker].name.clone();
                sharp.push(SharpAngle { angle, at: point(vertex).into(), interface, is_forced: sector < SHARP });
            }
        }
    }
    sharp.sort_by(|a, b| a.angle.total_cmp(&b.angle));
    sharp.truncate(MOST);
    sharp
}

/// The corners of a triangle with their angles in degrees.
fn angles_of(triangle: [VertexId; 3], point: impl Fn(VertexId) -> Vec3) -> [(VertexId, f64); 3] {
    [0, 1, 2].map(|k| {
        let [a, b, c] = [0, 1, 2].map(|i| point(triangle[(k + i) % 3]));
        let (u, v) = (b - a, c - a);
        (triangle[k], libm::atan2(u.cross(&v).norm(), u.dot(&v)).to_degrees())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plc::samples;

    /// A fan of triangles about the origin, from a cube's complex: their other corners are at these directions in degrees.
    fn fan(directions: &[f64]) -> Complex {
        let mut complex = samples::cube().complex();
        let ends = directions.iter().map(|d| d.to_radians()).map(|a| Vec3::new(libm::cos(a), libm::sin(a), 0.0));
        for (vertex, point) in complex.vertices.iter_mut().zip([Vec3::zeros()].into_iter().chain(ends)) {
            vertex.point = point;
        }
        let one = complex.facets.iter().next().cloned().unwrap();
        let triangle = |k: u32| [0, k, k + 1].map(VertexId);
        let facets = (1..directions.len() as u32).map(triangle);
        complex.facets = facets.map(|t| ComplexFacet { loops: vec![t.to_vec()], triangles: vec![t], ..one.clone() }).collect();
        complex
    }

    #[test]
    fn only_the_models_own_angles_are_forced() {
        let forced = sharp_angles(&fan(&[0.0, 25.0]));
        assert!(forced.len() == 1 && forced[0].is_forced && (forced[0].angle - 25.0).abs() < 1e-9);
        // Here one triangle of 45 degrees would do.
        let split = sharp_angles(&fan(&[0.0, 20.0, 45.0]));
        assert!(split.len() == 2 && split.iter().all(|s| !s.is_forced && s.at == [0.0; 3]));
        assert!(sharp_angles(&fan(&[0.0, 60.0])).is_empty());
    }
}
