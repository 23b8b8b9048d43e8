//! One facet of a .poly: its triangulation as TetGen understands it, and points inside its holes.

use super::PlcFacet;
use crate::geom::Vec3;
use crate::geom::cdt::{self, Cdt};
use crate::geom::polygon::{PolygonError, triangulate, vector_area};
use crate::geom::predicates::{Projection, orient2d};
use crate::geom::union_find::UnionFind;
use spade::handles::{FixedFaceHandle, PossiblyOuterTag};
use spade::{PositionInTriangulation, Triangulation as _};
use std::collections::{BTreeMap, BTreeSet};

/// A facet as TetGen understands it.
#[derive(Clone, Debug, Default)]
pub struct Area {
    /// Triangles over its own vertices, counter-clockwise about the normal of its largest polygon.
    pub triangles: Vec<[u32; 3]>,
    /// Its hole points that take nothing away, since what encloses them is none of its segments.
    pub idle_holes: Vec<Vec3>,
    /// Its hole points that lie on a segment, so that nobody knows what they take away.
    pub unclear_holes: Vec<Vec3>,
}

/// Triangles of a facet over its own vertices, counter-clockwise about the normal of its largest polygon.
///
/// # Errors
/// As [`area_of`].
pub fn triangulate_facet(facet: &PlcFacet, points: &[Vec3]) -> Result<Vec<[u32; 3]>, PolygonError> {
    area_of(facet, points).map(|area| area.triangles)
}

/// What the segments of a facet enclose, less what is reached from its hole points without crossing a segment.
///
/// # Errors
/// If segments cross, overlap or pass through a vertex in the dominant projection, or nothing is enclosed.
pub fn area_of(facet: &PlcFacet, points: &[Vec3]) -> Result<Area, PolygonError> {
    let (wide, narrow): (Vec<&[u32]>, Vec<&[u32]>) = facet.polygons.iter().map(Vec::as_slice).partition(|p| p.len() > 2);
    if let [outer] = wide[..]
        && facet.holes.is_empty()
        && is_once_each(outer)
    {
        let chains: Vec<[u32; 2]> = narrow.iter().filter_map(|p| <[u32; 2]>::try_from(*p).ok()).collect();
        let lone: Vec<u32> = narrow.iter().filter(|p| p.len() == 1).map(|p| p[0]).collect();
        return triangulate(&[outer], &chains, &lone, points).map(|triangles| Area { triangles, ..Area::default() });
    }
    let normal = normal_of(facet, points);
    if normal == Vec3::zeros() {
        return Err(PolygonError::Flat);
    }
    enclosed(facet, points, Projection::along(&normal))
}

/// Whether no vertex is listed twice.
pub fn is_once_each(polygon: &[u32]) -> bool {
    let mut sorted = polygon.to_vec();
    sorted.sort_unstable();
    sorted.windows(2).all(|w| w[0] != w[1])
}

/// Normal of a facet, of any length: that of its largest polygon; zero if all its vertices are on a line.
pub fn normal_of(facet: &PlcFacet, points: &[Vec3]) -> Vec3 {
    let areas = facet.polygons.iter().map(|p| vector_area([&p[..]], points));
    let widest = areas.max_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared())).unwrap_or_default();
    if widest == Vec3::zeros() { normal_across(facet, points) } else { widest }
}

/// Normal of the plane through three vertices that are far apart: for facets whose segments are listed one by one.
fn normal_across(facet: &PlcFacet, points: &[Vec3]) -> Vec3 {
    let all = || facet.polygons.iter().flatten().map(|&v| points[v as usize]);
    let Some(first) = all().next() else { return Vec3::zeros() };
    let farthest = |size: &dyn Fn(&Vec3) -> f64| all().fold(first, |far, p| if size(&p) > size(&far) { p } else { far });
    let second = farthest(&|p| (p - first).norm_squared());
    let third = farthest(&|p| (second - first).cross(&(p - first)).norm_squared());
    (second - first).cross(&(third - first))
}

/// The segments that a polygon lists: none for a lone vertex, one for two vertices, else a closed walk.
pub fn segments_of(polygon: &[u32]) -> impl Iterator<Item = [u32; 2]> {
    let count = if polygon.len() == 2 { 1 } else { polygon.len() };
    (0..count)
        .map(|k| [polygon[k], polygon[(k + 1) % polygon.len()]])
        .filter(|[a, b]| a != b)
        .map(|[a, b]| [a.min(b), a.max(b)])
}

/// What a facet lists outside of its area.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Strays {
    /// Segments of closed polygons that lead out of the area and back.
    pub spikes: Vec<[u32; 2]>,
    /// Segments listed as polygons of two vertices.
    pub segments: Vec<[u32; 2]>,
    /// Vertices listed as polygons of one.
    pub vertices: Vec<u32>,
}

/// What a facet with this triangulation lists outside of it.
pub fn strays(facet: &PlcFacet, triangles: &[[u32; 3]]) -> Strays {
    let mut strays = Strays::default();
    if let [only] = &facet.polygons[..]
        && only.len() == triangles.len() + 2
        && is_once_each(only)
    {
        return strays;
    }
    let corners: BTreeSet<u32> = triangles.iter().flatten().copied().collect();
    let edges: BTreeSet<[u32; 2]> = triangles.iter().flat_map(|t| segments_of(t)).collect();
    for polygon in &facet.polygons {
        let outside = segments_of(polygon).filter(|s| !edges.contains(s));
        match polygon[..] {
            [v] => strays.vertices.extend((!corners.contains(&v)).then_some(v)),
            [_, _] => strays.segments.extend(outside),
            _ => strays.spikes.extend(outside),
        }
    }
    for list in [&mut strays.spikes, &mut strays.segments] {
        list.sort_unstable();
        list.dedup();
    }
    strays
}

/// Constrained Delaunay triangulation of all segments, without what is reached from outside or from a hole point.
fn enclosed(facet: &PlcFacet, points: &[Vec3], projection: Projection) -> Result<Area, PolygonError> {
    let vertices: Vec<u32> = facet.polygons.iter().flatten().copied().collect::<BTreeSet<_>>().into_iter().collect();
    let flat = |p: &Vec3| projection.apply(p);
    let number = |v: u32| vertices.binary_search(&v).unwrap_or(0);
    let listed: BTreeSet<[u32; 2]> = facet.polygons.iter().flat_map(|w| segments_of(w)).collect();
    let segments: Vec<[usize; 2]> = listed.into_iter().map(|s| s.map(number)).collect();
    let places = vertices.iter().map(|&v| flat(&points[v as usize]));
    let cdt = Cdt::new(places, &segments).map_err(|_| PolygonError::NotSimple)?.triangulation;
    let mut area = Area::default();
    let mut is_gone = vec![false; cdt.num_all_faces()];
    carve(&cdt, &mut is_gone, vec![cdt.outer_face().fix()]);
    let mut stack = Vec::new();
    let is_outside = is_gone.clone();
    for hole in &facet.holes {
        let face = match cdt.locate(cdt::place(flat(hole))) {
            PositionInTriangulation::OnFace(f) => Some(cdt.face(f).adjacent_edges()[0].face().fix()),
            PositionInTriangulation::OnEdge(e) if !cdt.directed_edge(e).is_constraint_edge() => {
                Some(cdt.directed_edge(e).face().fix())
            }
            PositionInTriangulation::OnEdge(_) | PositionInTriangulation::OnVertex(_) => {
                area.unclear_holes.push(*hole);
                continue;
            }
            PositionInTriangulation::OutsideOfConvexHull(_) | PositionInTriangulation::NoTriangulation => None,
        };
        match face.filter(|f| !is_outside[f.index()]) {
            Some(face) => stack.push(face),
            None => area.idle_holes.push(*hole),
        }
    }
    carve(&cdt, &mut is_gone, stack);
    let inner = cdt.inner_faces().filter(|f| !is_gone[f.index()]);
    area.triangles = inner.map(|f| f.vertices().map(|v| vertices[cdt::slot(v)])).collect();
    if area.triangles.is_empty() { Err(PolygonError::Flat) } else { Ok(area) }
}

/// Marks what is reached from these faces without crossing a segment.
fn carve(cdt: &cdt::Triangulation, is_gone: &mut [bool], mut stack: Vec<FixedFaceHandle<PossiblyOuterTag>>) {
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
        // The inner square edge by edge, a hole point in its plane but outside, and one that leaves nothing.
        let one_by_one = [[4, 5], [5, 6], [6, 7], [7, 4]].map(|s| s.to_vec());
        facet.polygons.splice(1.., one_by_one);
        facet.holes.push(Vec3::new(2., 2., 0.));
        assert_eq!(area(&triangulate_facet(&facet, &points).unwrap(), &points), 12.0);
        facet.holes.push((points[0] + points[4]) * 0.5);
        assert_eq!(triangulate_facet(&facet, &points), Err(PolygonError::Flat));
    }

    #[test]
    fn hole_points_that_do_nothing_and_those_on_a_segment_are_told() {
        let (points, mut facet) = ring();
        facet.holes = vec![Vec3::new(9., 2., 0.), Vec3::new(2., 1., 0.)];
        let found = area_of(&facet, &points).unwrap();
        assert_eq!((&found.idle_holes[..], &found.unclear_holes[..]), (&facet.holes[..1], &facet.holes[1..]));
        assert_eq!(area(&found.triangles, &points), 16.0);
    }

    #[test]
    fn what_is_listed_outside_of_the_area_is_a_stray() {
        let (mut points, _) = ring();
        points.push(Vec3::new(9., 9., 0.));
        points.push(Vec3::new(5., 5., 0.));
        let strays_of = |polygons: &[&[u32]]| {
            let facet = PlcFacet { polygons: polygons.iter().map(|p| p.to_vec()).collect(), ..PlcFacet::default() };
            strays(&facet, &triangulate_facet(&facet, &points).unwrap())
        };
        assert_eq!(strays_of(&[&[0, 1, 2, 8, 2, 3]]), Strays { spikes: vec![[2, 8]], ..Strays::default() });
        assert_eq!(strays_of(&[&[0, 1, 2, 3], &[8, 9]]), Strays { segments: vec![[8, 9]], ..Strays::default() });
        assert_eq!(strays_of(&[&[0, 1, 2, 3], &[4, 6], &[5], &[9]]), Strays { vertices: vec![9], ..Strays::default() });
        // There and back inside of the area is an edge of it.
        assert_eq!(strays_of(&[&[0, 1, 2, 6, 2, 3]]), Strays::default());
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
