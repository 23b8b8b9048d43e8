//! Triangulations of the rounded polygons.

use super::collapse::{self, Loops};
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
/// becomes one of that edge in all facets ([`touching`]). Facets whose vertices do not lie within `flatness` of their plane,
/// and those that fall apart, become one piece per triangle.
///
/// # Errors
/// If edges of a facet cross far from their ends.
pub fn triangulate(mut loops: Loops, points: &[Vec3], flatness: f64) -> Result<Vec<Piece>, Diagnostic> {
    let mut triangles: Vec<Triangles> = match loops.len() < 1024 {
        true => loops.iter().map(|facet| triangles_of(facet, points)).collect(),
        false => loops.par_iter().with_min_len(256).map(|facet| triangles_of(facet, points)).collect(),
    };
    for _ in 0..MAX_CUTS {
        let failed: Vec<[usize; 1]> = (0..loops.len()).filter(|&k| triangles[k].is_err()).map(|k| [k]).collect();
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
            Ok(triangles) if polygon::is_planar(&walks, points, flatness) => {
                pieces.extend(parts(facet, &loops, &triangles, points));
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
    connected(&touching_edges(walks), triangles).1 > 1
}

fn touching_edges(walks: &[&[u32]]) -> Vec<[u32; 2]> {
    walks.iter().filter_map(|w| if let &[a, b] = *w { Some([a.min(b), a.max(b)]) } else { None }).collect()
}

/// Triangles that hang together over edges other than the touching ones: the set of each, and the number of sets.
fn connected(touching: &[[u32; 2]], triangles: &[[u32; 3]]) -> (Vec<u32>, usize) {
    let mut edges: Vec<([u32; 2], u32)> = Vec::with_capacity(3 * triangles.len());
    for (t, corners) in triangles.iter().enumerate() {
        edges.extend(edges_of(corners).map(|[a, b]| ([a.min(b), a.max(b)], t as u32)));
    }
    edges.sort_unstable();
    let mut sets = UnionFind::new(triangles.len());
    for pair in edges.windows(2).filter(|w| w[0].0 == w[1].0 && !touching.contains(&w[0].0)) {
        sets.join(pair[0].1, pair[1].1);
    }
    sets.number()
}

fn edges_of(t: &[u32; 3]) -> impl Iterator<Item = [u32; 2]> {
    [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]].into_iter()
}

/// The polygons that a polygon falls apart into, with their triangles.
pub fn parts(facet: usize, loops: &[Vec<u32>], triangles: &[[u32; 3]], points: &[Vec3]) -> Vec<Piece> {
    let walks: Vec<&[u32]> = loops.iter().map(Vec::as_slice).collect();
    let touching = touching_edges(&walks);
    let (set_of, count) = connected(&touching, triangles);
    let part = |set: usize| {
        let own: Vec<[u32; 3]> = (0..triangles.len()).filter(|&t| set_of[t] as usize == set).map(|t| triangles[t]).collect();
        let mut edges: Vec<[u32; 2]> = own.iter().flat_map(edges_of).collect();
        let mut sorted = edges.clone();
        sorted.sort_unstable();
        let has = |edge: &[u32; 2]| sorted.binary_search(edge).is_ok();
        edges.retain(|&[a, b]| !has(&[b, a]));
        let mut own_loops = collapse::simple_loops(edges);
        collapse::put_outer_first(&mut own_loops, points);
        own_loops.extend(touching.iter().filter(|&&[a, b]| has(&[a, b]) && has(&[b, a])).map(|e| e.to_vec()));
        let is_lone = |p: u32| own.iter().flatten().any(|&v| v == p) && !own_loops.iter().flatten().any(|&v| v == p);
        let lone: Vec<Vec<u32>> = loops.iter().filter(|w| w.len() == 1 && is_lone(w[0])).cloned().collect();
        own_loops.extend(lone);
        Piece { facet, loops: own_loops, triangles: own }
    };
    (0..count).map(part).collect()
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
        assert_eq!(count(vec![rim, vec![5, 4], vec![4, 6]]), 2);
    }

    #[test]
    fn what_lies_in_a_part_stays_with_it() {
        let p = |x: f64, y: f64| Vec3::new(x, y, 0.0);
        let points = [p(0., 0.), p(4., 0.), p(4., 4.), p(0., 4.), p(1., 1.), p(3., 2.)];
        // A square with an edge along its diagonal, one in the middle of it, and a point.
        let loops = vec![vec![0, 1, 2, 3], vec![0, 4], vec![4, 2], vec![5]];
        let pieces = triangulate(vec![loops], &points, 1e-15).unwrap();
        let found: Vec<Vec<Vec<u32>>> = pieces.into_iter().map(|p| p.loops).collect();
        assert_eq!(found.len(), 2);
        assert!(found.iter().any(|l| l.len() == 2 && l[1] == [5]), "{found:?}");
    }
}
