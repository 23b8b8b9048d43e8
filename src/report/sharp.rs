//! Sharp angles of triangular facets with their place, and whether the model itself forces them.

use crate::brep::complex::{Complex, ComplexFacet};
use crate::geom::Vec3;
use crate::ids::{Id, SurfaceId, VertexId};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

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
    let is_triangle = |f: &&ComplexFacet| matches!(&f.loops[..], [only] if only.len() == 3);
    let mut sharp = Vec::new();
    for facet in complex.facets.iter().filter(is_triangle) {
        for corner in facet.triangles.iter().flat_map(|t| corners_of(*t, point)).filter(Corner::may_be_sharp) {
            let angle = corner.angle();
            if angle < SHARP - ROUNDING {
                sharp.push((angle, corner.vertex, facet));
            }
        }
    }
    sharp.sort_by(|a, b| a.0.total_cmp(&b.0));
    sharp.truncate(MOST);
    let sectors = sectors(complex, &sharp.iter().map(|s| (s.1, s.2.surface)).collect());
    let describe = |(angle, vertex, facet): (f64, VertexId, &ComplexFacet)| SharpAngle {
        angle,
        at: point(vertex).into(),
        interface: complex.markers[facet.marker].name.clone(),
        is_forced: sectors.get(&(vertex, facet.surface)).is_some_and(|sector| *sector < SHARP),
    };
    sharp.into_iter().map(describe).collect()
}

/// How much there is of a surface around a vertex, in degrees, for some of both.
fn sectors(complex: &Complex, wanted: &BTreeSet<(VertexId, SurfaceId)>) -> BTreeMap<(VertexId, SurfaceId), f64> {
    let mut is_wanted = vec![false; complex.vertices.len()];
    wanted.iter().for_each(|w| is_wanted[w.0.index()] = true);
    let mut sectors: BTreeMap<(VertexId, SurfaceId), f64> = BTreeMap::new();
    for facet in complex.facets.iter() {
        let corners = facet.triangles.iter().flat_map(|t| corners_of(*t, |v| complex.vertices[v].point));
        for corner in corners.filter(|c| is_wanted[c.vertex.index()]) {
            *sectors.entry((corner.vertex, facet.surface)).or_default() += corner.angle();
        }
    }
    sectors
}

/// A corner of a triangle, and the edges from it.
struct Corner {
    vertex: VertexId,
    edges: [Vec3; 2],
}

impl Corner {
    /// Degrees.
    fn angle(&self) -> f64 {
        let [u, v] = &self.edges;
        libm::atan2(u.cross(v).norm(), u.dot(v)).to_degrees()
    }
    /// Whether the angle is below some 31 degrees: few are, and the angle costs more than its cosine.
    fn may_be_sharp(&self) -> bool {
        const SQUARED_COSINE: f64 = 0.73;
        let [u, v] = &self.edges;
        let dot = u.dot(v);
        dot >= 0.0 && dot * dot >= SQUARED_COSINE * u.norm_squared() * v.norm_squared()
    }
}

/// The corners of a triangle.
fn corners_of(triangle: [VertexId; 3], point: impl Fn(VertexId) -> Vec3) -> [Corner; 3] {
    let at = triangle.map(point);
    [0, 1, 2].map(|k| Corner { vertex: triangle[k], edges: [1, 2].map(|i| at[(k + i) % 3] - at[k]) })
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
