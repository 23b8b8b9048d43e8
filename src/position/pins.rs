//! Lone vertices in polygons of what stands free, so that no circle through their corners is empty.
//!
//! Where air surrounds a stretched body, TetGen finds its polygons. Where nothing does, faces of the convex hull run through
//! them, and corners of one circle still span flat tetrahedra there: of bodies without air every second one is lost. One vertex
//! in the circle, which TetGen takes for a vertex that the facet has to keep, leaves none of these tetrahedra Delaunay.

use super::{Circle, Pieces, flatness};
use crate::brep::complex::{Complex, ComplexFacet, ComplexVertex};
use crate::geom::Vec3;
use crate::geom::embedding::violations;
use crate::geom::polygon::{is_planar, triangulate};
use crate::ids::{FacetId, Id, VertexId};
use crate::primitive::solid::Freedom;

/// Corners on a circle that are too many for it: three of them are always on one.
const CORNERS: usize = 4;
/// Triangles of a polygon whose circles are tried at most, by falling area: each is compared with every corner.
const TRIED: usize = 200;

impl Pieces {
    /// Puts a lone vertex into each circle with four corners of a polygon, in all stretched pieces that border the outside or a
    /// void. `points`: of the vertices before the stretch. A polygon that has no triangulation with them gets none; where
    /// anything would meet, none gets any.
    pub(super) fn pin(&self, complex: &mut Complex, points: &[Vec3]) {
        let is_free = self.free(complex);
        let mut now: Vec<Vec3> = complex.vertices.iter().map(|v| v.point).collect();
        let (count, flatness) = (now.len(), flatness(&now));
        let mut pinned: Vec<(FacetId, ComplexFacet)> = Vec::new();
        for (id, facet) in complex.facets.enumerate().filter(|(_, f)| f.triangles.len() > 1) {
            let piece = self.of_facet(facet);
            if self.is_moved[piece] && is_free[piece] {
                pinned.extend(with_pins(facet, points, &mut now, flatness).map(|facet| (id, facet)));
            }
        }
        if pinned.is_empty() {
            return;
        }
        let swap = |complex: &mut Complex, pinned: &mut [(FacetId, ComplexFacet)]| {
            pinned.iter_mut().for_each(|(id, facet)| std::mem::swap(&mut complex.facets[*id], facet));
        };
        swap(complex, &mut pinned);
        let triangles: Vec<[u32; 3]> = complex.facets.iter().flat_map(|f| &f.triangles).map(|t| t.map(|v| v.0)).collect();
        if violations(&now, &triangles, 1).is_empty() {
            for &point in &now[count..] {
                complex.vertices.push(ComplexVertex { point, freedom: Freedom::Surface });
            }
        } else {
            swap(complex, &mut pinned);
        }
    }

    /// By piece: whether it borders the outside or a void.
    fn free(&self, complex: &Complex) -> Vec<bool> {
        let mut is_free = vec![false; self.is_moved.len()];
        for facet in complex.facets.iter().filter(|f| f.sides.iter().any(|&s| complex.regions[s].part.is_none())) {
            is_free[self.of_facet(facet)] = true;
        }
        is_free
    }
}

/// The facet with a lone vertex in each circle of four of its corners, whose places join `now`; `None`, and no place, if it has
/// no such circle, or no triangulation with these vertices.
fn with_pins(facet: &ComplexFacet, points: &[Vec3], now: &mut Vec<Vec3>, flatness: f64) -> Option<ComplexFacet> {
    let count = now.len();
    for t in in_circles(facet, points) {
        now.push(t.iter().map(|v| now[v.index()]).sum::<Vec3>() / 3.0);
    }
    let pins = count as u32..now.len() as u32;
    let mut loops: Vec<Vec<u32>> = facet.loops.iter().map(|walk| walk.iter().map(|v| v.0).collect()).collect();
    loops.extend(pins.clone().map(|v| vec![v]));
    let walks: Vec<&[u32]> = loops.iter().map(Vec::as_slice).collect();
    let triangles = if pins.is_empty() || !is_planar(&walks, now, flatness) {
        None
    } else {
        // A vertex inside makes two triangles more; one that rounding put outside does not.
        triangulate(&walks, &[], &[], now).ok().filter(|t| t.len() == facet.triangles.len() + 2 * pins.len())
    };
    let Some(triangles) = triangles else {
        now.truncate(count);
        return None;
    };
    Some(ComplexFacet {
        loops: loops.into_iter().map(|walk| walk.into_iter().map(VertexId).collect()).collect(),
        triangles: triangles.into_iter().map(|t| t.map(VertexId)).collect(),
        ..facet.clone()
    })
}

/// The largest triangle of each circle on which four corners of the facet lie but for rounding, by falling area.
fn in_circles(facet: &ComplexFacet, points: &[Vec3]) -> Vec<[VertexId; 3]> {
    let mut corners: Vec<VertexId> = facet.loops.iter().flatten().copied().collect();
    corners.sort_unstable();
    corners.dedup();
    let place = |v: VertexId| points[v.index()];
    let area = |t: &[VertexId; 3]| (place(t[1]) - place(t[0])).cross(&(place(t[2]) - place(t[0]))).norm_squared();
    let mut triangles = facet.triangles.clone();
    // The sort is stable: triangles of one area keep their order.
    triangles.sort_by(|s, t| area(t).total_cmp(&area(s)));
    let mut circles: Vec<Vec<VertexId>> = Vec::new();
    let mut found = Vec::new();
    let mut tried = 0;
    for t in triangles.into_iter().filter(|t| area(t) > 0.0) {
        if circles.iter().any(|on| t.iter().all(|v| on.binary_search(v).is_ok())) {
            continue;
        }
        tried += 1;
        if tried > TRIED {
            break;
        }
        let circle = Circle::through(&t.map(place));
        let on: Vec<VertexId> = corners.iter().copied().filter(|&v| t.contains(&v) || circle.holds(&place(v))).collect();
        if on.len() >= CORNERS {
            circles.push(on);
            found.push(t);
        }
    }
    found
}
