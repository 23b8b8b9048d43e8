//! Vertices that rounding pushed onto or through an edge, of their own facet or of one that they meet, become vertices of that
//! edge.
//!
//! Two segments that do not meet are nearest in an end of one of them. If the ends move by a few units in the last place and
//! the segments meet then, one of the ends is that near to the other segment: cutting edges at near vertices undoes every
//! crossing. It is done in all facets of the edge, so that they still close.

use super::collapse::{self, Loops};
use super::facets::{self, Piece};
use crate::brep::complex::{Complex, ComplexFacet};
use crate::geom::Vec3;
use crate::geom::hash::IndexMap;
use crate::ids::{FacetId, Id, VertexId};

/// Vertices to be put into an edge (smaller number first) with their places along it.
type Cuts = IndexMap<[u32; 2], Vec<(f64, u32)>>;

/// Cuts the edges of facets that `failed`, by themselves or together, at their vertices within twice the `reach` that each may
/// have moved by. Yields the facets that changed, ascending.
pub fn cut<const N: usize>(facets: &mut Loops, failed: &[[usize; N]], points: &[Vec3], reach: f64) -> Vec<usize> {
    let mut cuts = Cuts::default();
    for together in failed {
        find(&together.map(|facet| &facets[facet][..]).concat(), points, 2.0 * reach, &mut cuts);
    }
    if cuts.is_empty() {
        return Vec::new();
    }
    let mut changed = Vec::new();
    for (number, facet) in facets.iter_mut().enumerate() {
        let is_cut = |walk: &Vec<u32>| (0..walk.len()).any(|k| cuts.contains_key(&key(walk, k)));
        if facet.iter().any(is_cut) {
            facet.iter_mut().for_each(|walk| *walk = with_cuts(walk, &cuts));
            collapse::tidy(facet, points);
            changed.push(number);
        }
    }
    changed
}

/// The edge of a walk that begins at its corner `k`.
fn key(walk: &[u32], k: usize) -> [u32; 2] {
    let (a, b) = (walk[k], walk[(k + 1) % walk.len()]);
    [a.min(b), a.max(b)]
}

/// Vertices of loops that lie near their edges, between the ends.
fn find(loops: &[Vec<u32>], points: &[Vec3], near: f64, cuts: &mut Cuts) {
    let mut vertices = loops.concat();
    vertices.sort_unstable();
    vertices.dedup();
    for edge in loops.iter().flat_map(|walk| (0..walk.len()).map(|k| key(walk, k))) {
        let [a, b] = edge.map(|v| points[v as usize]);
        let along = b - a;
        for &v in vertices.iter().filter(|v| !edge.contains(v)) {
            let t = (points[v as usize] - a).dot(&along) / along.norm_squared();
            let is_near = (points[v as usize] - a - along * t).norm() <= near;
            if t > 0.0 && t < 1.0 && is_near {
                let list = cuts.entry(edge).or_default();
                if list.iter().all(|known| known.1 != v) {
                    list.push((t, v));
                    list.sort_by(|p, q| p.0.total_cmp(&q.0).then(p.1.cmp(&q.1)));
                }
            }
        }
    }
}

fn with_cuts(walk: &[u32], cuts: &Cuts) -> Vec<u32> {
    let mut out = Vec::with_capacity(walk.len() + 1);
    for k in 0..walk.len() {
        out.push(walk[k]);
        let Some(inner) = cuts.get(&key(walk, k)) else { continue };
        let inner = inner.iter().map(|c| c.1);
        match walk[k] < walk[(k + 1) % walk.len()] {
            true => out.extend(inner),
            false => out.extend(inner.rev()),
        }
    }
    out
}

/// Lists edges of other facets in the facets that they lie in; those fall apart where such edges go from rim to rim.
pub fn list(complex: &mut Complex, mut unlisted: Vec<(FacetId, [VertexId; 2])>) {
    unlisted.sort_unstable();
    unlisted.dedup();
    let points: Vec<Vec3> = complex.vertices.iter().map(|v| v.point).collect();
    let mut out = Vec::with_capacity(complex.facets.len() + unlisted.len());
    let mut rest = &unlisted[..];
    for (id, facet) in complex.facets.enumerate() {
        let (own, others) = rest.split_at(rest.iter().take_while(|u| u.0 == id).count());
        rest = others;
        if own.is_empty() {
            out.push(facet.clone());
            continue;
        }
        let is_end = |v: VertexId| own.iter().any(|u| u.1.contains(&v));
        let kept = facet.loops.iter().filter(|w| w.len() != 1 || !is_end(w[0]));
        let mut loops: Vec<Vec<u32>> = kept.map(|w| w.iter().map(|v| v.0).collect()).collect();
        loops.extend(own.iter().map(|u| u.1.map(|v| v.0).to_vec()));
        let triangles: Vec<[u32; 3]> = facet.triangles.iter().map(|t| t.map(|v| v.0)).collect();
        let part = |piece: Piece| ComplexFacet {
            loops: piece.loops.into_iter().map(|w| w.into_iter().map(VertexId).collect()).collect(),
            triangles: piece.triangles.into_iter().map(|t| t.map(VertexId)).collect(),
            is_modified: true,
            ..facet.clone()
        };
        out.extend(facets::parts(id.index(), &loops, &triangles, &points).into_iter().map(part));
    }
    complex.facets = out.into();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_corner_pushed_through_an_edge_cuts_it_in_both_facets() {
        let p = |x: f64, y: f64| Vec3::new(x, y, 0.0);
        let places = [p(0., 0.), p(4., 0.), p(4., 4.), p(2., -1e-15), p(0., 4.), p(2., -4.)];
        let mut facets = vec![vec![vec![0, 1, 2, 3, 4]], vec![vec![1, 0, 5]]];
        assert_eq!(cut(&mut facets, &[[0]], &places, 1e-15), [0, 1]);
        assert_eq!(facets, [vec![vec![0, 3, 4], vec![3, 1, 2]], vec![vec![1, 3, 0, 5]]]);
        assert!(cut(&mut facets, &[[0], [1]], &places, 1e-15).is_empty());
    }

    #[test]
    fn a_triangle_rounded_to_a_line_goes_and_its_neighbour_gets_the_vertex() {
        let p = |x: f64, y: f64| Vec3::new(x, y, 0.0);
        let places = [p(0., 0.), p(4., 0.), p(2., 0.), p(2., -4.)];
        let mut facets = vec![vec![vec![0, 1, 2]], vec![vec![1, 0, 3]]];
        assert_eq!(cut(&mut facets, &[[0]], &places, 1e-15), [0, 1]);
        assert_eq!(facets, [vec![], vec![vec![1, 2, 0, 3]]]);
    }

    #[test]
    fn an_edge_from_rim_to_rim_is_listed_and_parts_the_facet() {
        let point = |x: f64, y: f64| crate::brep::complex::ComplexVertex {
            point: Vec3::new(x, y, 0.0),
            freedom: crate::primitive::solid::Freedom::Fixed,
        };
        let v = |walk: &[u32]| walk.iter().map(|&v| VertexId(v)).collect::<Vec<_>>();
        let facet = ComplexFacet {
            loops: vec![v(&[0, 1, 2, 3])],
            triangles: vec![[0, 1, 2].map(VertexId), [0, 2, 3].map(VertexId)],
            sides: [crate::ids::RegionId(0), crate::ids::RegionId(1)],
            surface: crate::ids::SurfaceId(0),
            source: (crate::ids::LeafId(0), 0),
            marker: crate::ids::MarkerId(0),
            is_modified: false,
        };
        let mut complex = Complex {
            vertices: vec![point(0., 0.), point(4., 0.), point(4., 4.), point(0., 4.)].into(),
            facets: vec![facet].into(),
            ..Complex::default()
        };
        list(&mut complex, vec![(FacetId(0), [VertexId(0), VertexId(2)])]);
        let found: Vec<_> = complex.facets.iter().map(|f| (f.loops.clone(), f.triangles.len(), f.is_modified)).collect();
        assert_eq!(found, [(vec![v(&[0, 1, 2])], 1, true), (vec![v(&[0, 2, 3])], 1, true)]);
    }
}
