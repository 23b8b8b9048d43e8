//! Triangulations of the rounded polygons.

use super::collapse::Loops;
use crate::diag::Diagnostic;
use crate::geom::Vec3;
use crate::geom::polygon::{self, PolygonError};
use rayon::prelude::*;

/// A facet, or one triangle of it.
pub struct Piece {
    /// Number of the selected facet.
    pub facet: usize,
    /// Loops, outer first.
    pub loops: Vec<Vec<u32>>,
    /// Triangles over the same vertices.
    pub triangles: Vec<[u32; 3]>,
}

/// Triangulates every facet that has loops; facets whose vertices do not lie within `flatness` of their plane become one piece per triangle.
pub fn triangulate(loops: Loops, points: &[Vec3], flatness: f64) -> Result<Vec<Piece>, Diagnostic> {
    let one = |(facet, loops): (usize, Vec<Vec<u32>>)| -> Result<Vec<Piece>, Diagnostic> {
        let Some(outer) = loops.first() else { return Ok(Vec::new()) };
        let walks: Vec<&[u32]> = loops.iter().map(|l| &l[..]).collect();
        let triangles = match polygon::triangulate(&walks, &[], &[], points) {
            Ok(triangles) => triangles,
            // A facet rounded to a line bounds nothing; if its neighbours do not close over it, the exact test says so.
            Err(PolygonError::Flat) => return Ok(Vec::new()),
            Err(PolygonError::NotSimple) => {
                let text = "a rounded facet is not simple";
                return Err(Diagnostic::internal("facet-not-simple", text).near(points[outer[0] as usize]));
            }
        };
        if triangles.len() == 1 || polygon::is_planar(&walks, points, flatness) {
            return Ok(vec![Piece { facet, loops, triangles }]);
        }
        Ok(triangles.into_iter().map(|t| Piece { facet, loops: vec![t.to_vec()], triangles: vec![t] }).collect())
    };
    let nested: Vec<Vec<Piece>> = if loops.len() < 1024 {
        loops.into_iter().enumerate().map(one).collect::<Result<_, _>>()?
    } else {
        loops.into_par_iter().enumerate().with_min_len(256).map(one).collect::<Result<_, _>>()?
    };
    Ok(nested.into_iter().flatten().collect())
}
