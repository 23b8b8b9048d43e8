//! Triangulations of the rounded polygons.

use super::collapse::Loops;
use super::touching;
use crate::diag::Diagnostic;
use crate::geom::Vec3;
use crate::geom::polygon::{self, PolygonError};
use crate::geom::union_find::UnionFind;
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

/// How often edges are cut at vertices that lie on them; what it makes touch may have to be cut once more.
const MAX_CUTS: usize = 6;

type Triangles = Result<Vec<[u32; 3]>, PolygonError>;

/// Triangulates every facet that has loops. Where rounding pushed a vertex onto or through an edge of its own facet, the vertex
/// becomes one of that edge in all facets ([`touching`]). Facets whose vertices do not lie within `flatness` of their plane, and
/// those that fall apart, become one piece per triangle.
///
/// # Errors
/// If edges of a facet cross far from their ends.
pub fn triangulate(mut loops: Loops, points: &[Vec3], flatness: f64) -> Result<Vec<Piece>, Diagnostic> {
    let mut triangles: Vec<Triangles> = match loops.len() < 1024 {
        true => loops.iter().map(|facet| triangles_of(facet, points)).collect(),
        false => loops.par_iter().with_min_len(256).map(|facet| triangles_of(facet, points)).collect(),
    };
    for _ in 0..MAX_CUTS {
        let failed: Vec<usize> = (0..loops.len()).filter(|&k| triangles[k].is_err()).collect();
        let changed = touching::cut(&mut loops, &failed, points, flatness);
        if changed.is_empty() {
            break;
        }
        for facet in changed {
            triangles[facet] = triangles_of(&loops[facet], points);
        }
    }
    let mut pieces = Vec::with_capacity(loops.len());
    for (facet, (loops, triangles)) in loops.into_iter().zip(triangles).enumerate() {
        let walks: Vec<&[u32]> = loops.iter().map(|l| &l[..]).collect();
        match triangles {
            Ok(triangles) if triangles.is_empty() => {}
            Ok(triangles) if triangles.len() == 1 || is_whole(&walks, &triangles, points, flatness) => {
                pieces.push(Piece { facet, loops, triangles });
            }
            Ok(triangles) => {
                pieces.extend(triangles.into_iter().map(|t| Piece { facet, loops: vec![t.to_vec()], triangles: vec![t] }));
            }
            // A facet rounded to a line bounds nothing; if its neighbours do not close over it, the exact test says so.
            Err(PolygonError::Flat) => {}
            Err(PolygonError::NotSimple) => {
                let text = "a rounded facet is not simple";
                return Err(Diagnostic::internal("facet-not-simple", text).near(points[loops[0][0] as usize]));
            }
        }
    }
    Ok(pieces)
}

fn triangles_of(loops: &[Vec<u32>], points: &[Vec3]) -> Triangles {
    if loops.is_empty() {
        return Ok(Vec::new());
    }
    let walks: Vec<&[u32]> = loops.iter().map(|l| &l[..]).collect();
    polygon::triangulate(&walks, &[], &[], points)
}

/// Whether a facet is one planar polygon; one loop that visits no vertex twice does not fall apart.
fn is_whole(walks: &[&[u32]], triangles: &[[u32; 3]], points: &[Vec3], flatness: f64) -> bool {
    polygon::is_planar(walks, points, flatness) && !(walks.len() > 1 && falls_apart(walks, triangles))
}

/// Whether triangles hang together in vertices only, or over edges in which something touches from rim to rim.
fn falls_apart(walks: &[&[u32]], triangles: &[[u32; 3]]) -> bool {
    let touching: Vec<[u32; 2]> =
        walks.iter().filter_map(|w| if let &[a, b] = *w { Some([a.min(b), a.max(b)]) } else { None }).collect();
    let mut edges: Vec<([u32; 2], usize)> = Vec::with_capacity(3 * triangles.len());
    for (t, corners) in triangles.iter().enumerate() {
        edges.extend((0..3).map(|k| (corners[k], corners[(k + 1) % 3])).map(|(a, b)| ([a.min(b), a.max(b)], t)));
    }
    edges.sort_unstable();
    let mut sets = UnionFind::new(triangles.len());
    for pair in edges.windows(2).filter(|w| w[0].0 == w[1].0 && !touching.contains(&w[0].0)) {
        sets.join(pair[0].1 as u32, pair[1].1 as u32);
    }
    sets.number().1 > 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edge_that_touches_from_rim_to_rim_parts_a_facet() {
        let p = |x: f64, y: f64| Vec3::new(x, y, 0.0);
        let points = [p(0., 0.), p(4., 0.), p(4., 4.), p(0., 4.), p(2., 2.), p(2., 0.), p(2., 4.)];
        let count = |loops: Vec<Vec<u32>>| triangulate(vec![loops], &points, 1e-15).unwrap().len();
        let rim = vec![0, 5, 1, 2, 6, 3];
        assert_eq!(count(vec![rim.clone(), vec![5, 4]]), 1);
        assert_eq!(count(vec![rim, vec![5, 4], vec![4, 6]]), 6);
    }
}
