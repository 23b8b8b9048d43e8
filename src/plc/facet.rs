//! One facet of a .poly: its triangulation as TetGen understands it, and points inside its holes.

use super::PlcFacet;
use crate::geom::Vec3;
use crate::geom::polygon::{PolygonError, triangulate, vector_area};
use crate::geom::predicates::{Projection, orient2d};
use crate::geom::union_find::UnionFind;
use spade::{ConstrainedDelaunayTriangulation, Point2, PositionInTriangulation, Triangulation};
use std::collections::{BTreeMap, BTreeSet};

/// Triangles of a facet over its own vertices, counter-clockwise about the normal of its largest polygon.
///
/// A facet is what its segments enclose, less what is reached from its hole points without crossing a segment.
///
/// # Errors
/// If segments cross or overlap in the dominant projection, or nothing is enclosed.
pub fn triangulate_facet(facet: &PlcFacet, points: &[Vec3]) -> Result<Vec<[u32; 3]>, PolygonError> {
    let (wide, narrow): (Vec<&[u32]>, Vec<&[u32]>) = facet.polygons.iter().map(Vec::as_slice).partition(|p| p.len() > 2);
    if let [outer] = wide[..] {
        let chains: Vec<[u32; 2]> = narrow.iter().filter_map(|p| <[u32; 2]>::try_from(*p).ok()).collect();
        let lone: Vec<u32> = narrow.iter().filter(|p| p.len() == 1).map(|p| p[0]).collect();
        return triangulate(&[outer], &chains, &lone, points);
    }
    let areas = wide.iter().map(|w| vector_area([*w], points));
    let normal = areas.max_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared())).unwrap_or_default();
    if normal == Vec3::zeros() {
        return Err(PolygonError::Flat);
    }
    enclosed(facet, points, Projection::along(&normal))
}

/// Constrained Delaunay triangulation of all segments, without what is reached from outside or from a hole point.
fn enclosed(facet: &PlcFacet, points: &[Vec3], projection: Projection) -> Result<Vec<[u32; 3]>, PolygonError> {
    let vertices: Vec<u32> = facet.polygons.iter().flatten().copied().collect::<BTreeSet<_>>().into_iter().collect();
    // Flush what spade would refuse as too small.
    let tidy = |x: f64| if x.abs() < spade::MIN_ALLOWED_VALUE { 0.0 } else { x };
    let flat = |p: &Vec3| {
        let [x, y] = projection.apply(p);
        Point2::new(tidy(x), tidy(y))
    };
    let positions: Vec<Point2<f64>> = vertices.iter().map(|&v| flat(&points[v as usize])).collect();
    let slot = |v: u32| vertices.binary_search(&v).unwrap_or(0);
    let segments: BTreeSet<[usize; 2]> = facet
        .polygons
        .iter()
        .flat_map(|w| (0..w.len()).map(move |k| [slot(w[k]), slot(w[(k + 1) % w.len()])]))
        .filter(|[a, b]| a != b)
        .map(|[a, b]| [a.min(b), a.max(b)])
        .collect();
    let mut is_simple = true;
    let cdt =
        ConstrainedDelaunayTriangulation::<Point2<f64>>::try_bulk_load_cdt(positions, segments.into_iter().collect(), |_| {
            is_simple = false
        })
        .map_err(|_| PolygonError::NotSimple)?;
    if !is_simple || cdt.num_vertices() != vertices.len() {
        return Err(PolygonError::NotSimple);
    }
    let mut is_gone = vec![false; cdt.num_all_faces()];
    let mut stack = vec![cdt.outer_face().fix()];
    for hole in &facet.holes {
        match cdt.locate(flat(hole)) {
            PositionInTriangulation::OnFace(f) => stack.push(cdt.face(f).adjacent_edges()[0].face().fix()),
            PositionInTriangulation::OnEdge(e) if !cdt.directed_edge(e).is_constraint_edge() => {
                stack.push(cdt.directed_edge(e).face().fix());
            }
            _ => {}
        }
    }
    while let Some(f) = stack.pop() {
        if std::mem::replace(&mut is_gone[f.index()], true) {
            continue;
        }
        let borders: Vec<_> = match cdt.face(f).as_inner() {
            Some(inner) => inner.adjacent_edges().to_vec(),
            None => cdt.convex_hull().map(|e| if e.is_outer_edge() { e } else { e.rev() }).collect(),
        };
        stack.extend(borders.iter().filter(|e| !e.is_constraint_edge()).map(|e| e.rev().face().fix()));
    }
    let inner = cdt.inner_faces().filter(|f| !is_gone[f.index()]);
    let triangles: Vec<[u32; 3]> = inner.map(|f| f.vertices().map(|v| vertices[v.fix().index()])).collect();
    if triangles.is_empty() { Err(PolygonError::Flat) } else { Ok(triangles) }
}

/// A point strictly inside each connected piece of a polygon, which is given clockwise or counter-clockwise about the facet's
/// normal: the centroid of the piece's largest triangle, verified by signs.
///
/// # Errors
/// If the polygon crosses itself or has no inside that floats can name.
pub fn points_inside(polygon: &[u32], points: &[Vec3]) -> Result<Vec<Vec3>, PolygonError> {
    let triangles = triangulate(&[polygon], &[], &[], points)?;
    let projection = Projection::along(&vector_area([polygon], points));
    let mut best: BTreeMap<u32, (f64, u32)> = BTreeMap::new();
    for (t, piece) in pieces(&triangles).into_iter().enumerate() {
        let area = vector_area([&triangles[t][..]], points).norm();
        let entry = best.entry(piece).or_insert((area, t as u32));
        if area > entry.0 {
            *entry = (area, t as u32);
        }
    }
    best.values()
        .map(|&(_, t)| {
            let [a, b, c] = triangles[t as usize].map(|v| points[v as usize]);
            let center = (a + b + c) / 3.0;
            let [p, q, r, x] = [a, b, c, center].map(|p| projection.apply(&p));
            let is_inside = orient2d(p, q, x) > 0 && orient2d(q, r, x) > 0 && orient2d(r, p, x) > 0;
            if is_inside { Ok(center) } else { Err(PolygonError::Flat) }
        })
        .collect()
}

/// The piece of each triangle: triangles are in one piece if they are joined over edges.
fn pieces(triangles: &[[u32; 3]]) -> Vec<u32> {
    let mut union = UnionFind::new(triangles.len());
    let mut over: BTreeMap<[u32; 2], u32> = BTreeMap::new();
    for (t, w) in triangles.iter().enumerate() {
        for k in 0..3 {
            let (a, b) = (w[k], w[(k + 1) % 3]);
            let first = *over.entry([a.min(b), a.max(b)]).or_insert(t as u32);
            union.join(first, t as u32);
        }
    }
    (0..triangles.len() as u32).map(|t| union.find(t)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring() -> (Vec<Vec3>, PlcFacet) {
        let p = |x: f64, y: f64| Vec3::new(x, y, 0.0);
        let points = vec![p(0., 0.), p(4., 0.), p(4., 4.), p(0., 4.), p(1., 1.), p(1., 3.), p(3., 3.), p(3., 1.)];
        (points, PlcFacet { polygons: vec![vec![0, 1, 2, 3], vec![4, 5, 6, 7]], holes: vec![p(2., 2.)], marker: 1 })
    }

    fn area(triangles: &[[u32; 3]], points: &[Vec3]) -> f64 {
        triangles.iter().map(|t| vector_area([&t[..]], points).z).sum()
    }

    #[test]
    fn a_hole_point_makes_the_hole() {
        let (points, mut facet) = ring();
        assert_eq!(area(&triangulate_facet(&facet, &points).unwrap(), &points), 12.0);
        facet.holes.clear();
        assert_eq!(area(&triangulate_facet(&facet, &points).unwrap(), &points), 16.0);
    }

    #[test]
    fn a_hole_of_two_lobes_gets_two_points() {
        let p = |x: f64, y: f64| Vec3::new(x, y, 0.0);
        let points = [p(0., 0.), p(2., 1.), p(2., -1.), p(-2., -1.), p(-2., 1.)];
        // Both lobes clockwise, meeting in vertex 0.
        let inside = points_inside(&[0, 1, 2, 0, 3, 4], &points).unwrap();
        assert_eq!(inside.len(), 2);
        assert!(inside[0].x * inside[1].x < 0.0);
    }
}
