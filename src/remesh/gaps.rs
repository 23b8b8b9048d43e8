//! Thin gaps and walls: how near other surfaces are.

use super::Supports;
use crate::brep::complex::{Complex, ComplexFacet};
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use crate::geom::bvh::Bvh;
use crate::geom::segment::between;
use crate::ids::{FacetId, Id, SurfaceId};
use crate::patch::fit::closest_on_triangle;

type Triangle = [Vec3; 3];

/// The facets of a model before it changes, to be asked what is near.
pub(super) struct Gaps {
    tree: Bvh,
    triangles: Vec<(Triangle, SurfaceId)>,
    /// By triangle.
    facets: Vec<FacetId>,
    /// By surface: surfaces that share a vertex with it, sorted. These meet, and leave no gap.
    touching: Vec<Vec<SurfaceId>>,
    /// Largest distance of a triangle's middle from its true surface.
    sag: f64,
}

impl Gaps {
    /// Those of a complex. Cost: n log n.
    pub fn of(complex: &Complex, supports: &Supports) -> Self {
        let mut triangles = Vec::new();
        let mut at: Vec<Vec<SurfaceId>> = vec![Vec::new(); complex.vertices.len()];
        let mut facets = Vec::new();
        for (id, facet) in complex.facets.enumerate() {
            facets.resize(facets.len() + facet.triangles.len(), id);
            triangles.extend(facet.triangles.iter().map(|t| (t.map(|v| complex.vertices[v].point), facet.surface)));
            facet.loops.iter().flatten().for_each(|v| at[v.index()].push(facet.surface));
        }
        let mut touching = vec![Vec::new(); complex.surfaces.len()];
        for here in &mut at {
            here.sort_unstable();
            here.dedup();
            here.iter().for_each(|s| touching[s.index()].extend_from_slice(here));
        }
        for list in &mut touching {
            list.sort_unstable();
            list.dedup();
        }
        let middle = |[a, b, c]: &Triangle| (a + b + c) / 3.0;
        let exact = |s: SurfaceId| supports[s].as_deref().filter(|s| !s.is_fitted());
        let sag = |(t, surface): &(Triangle, SurfaceId)| exact(*surface).map_or(0.0, |s| s.distance(&middle(t)));
        let sag = triangles.iter().map(sag).fold(0.0, f64::max);
        let boxes = triangles.iter().map(|t| Aabb::around(t.0.iter())).collect();
        Self { tree: Bvh::new(boxes), triangles, facets, touching, sag }
    }

    fn is_touching(&self, surface: SurfaceId, other: SurfaceId) -> bool {
        self.touching[surface.index()].binary_search(&other).is_ok()
    }

    /// Distance to the nearest facet of a surface that meets none of some surfaces, at most `reach`.
    pub fn width(&self, point: &Vec3, reach: f64, surfaces: &[SurfaceId]) -> f64 {
        let mut width = reach;
        self.tree.overlapping(&Aabb::around([point]).inflated(reach), |t| {
            let (corners, other) = &self.triangles[t as usize];
            if !surfaces.iter().any(|&s| self.is_touching(s, *other)) {
                width = width.min((closest_on_triangle(corners, point) - point).norm());
            }
        });
        width
    }

    /// The facets nearer than `near` to a facet, of surfaces that its own does not meet, perhaps several times; `None` if not
    /// even one is nearer than `reach`.
    pub fn facing(&self, facet: &ComplexFacet, complex: &Complex, [near, reach]: [f64; 2]) -> Option<Vec<FacetId>> {
        let mut nearest = f64::INFINITY;
        let mut facing = Vec::new();
        for corners in facet.triangles.iter().map(|t| t.map(|v| complex.vertices[v].point)) {
            self.tree.overlapping(&Aabb::around(&corners).inflated(reach.max(near)), |t| {
                let (across, other) = &self.triangles[t as usize];
                if !self.is_touching(facet.surface, *other) {
                    let distance = distance(&corners, across);
                    nearest = nearest.min(distance);
                    facing.extend((distance < near).then_some(self.facets[t as usize]));
                }
            });
        }
        (nearest < reach).then_some(facing)
    }

    /// Whether no other true surface, but those that meet a point's own, is within reach of it. Facets will not do: they sag by
    /// more than a thin gap.
    pub fn is_clear(&self, point: &Vec3, reach: f64, surface: SurfaceId, supports: &Supports) -> bool {
        let far = reach + self.sag;
        let mut is_clear = true;
        self.tree.overlapping(&Aabb::around([point]).inflated(far), |t| {
            let (corners, other) = &self.triangles[t as usize];
            if is_clear && !self.is_touching(surface, *other) {
                let from_facet = (closest_on_triangle(corners, point) - point).norm();
                let support = supports[*other].as_deref().filter(|s| !s.is_fitted() && from_facet < far);
                is_clear = support.map_or(from_facet, |s| s.distance(point).min(from_facet)) >= reach;
            }
        });
        is_clear
    }
}

/// Distance of two triangles that do not cross.
fn distance(a: &Triangle, b: &Triangle) -> f64 {
    let from_corners =
        |of: &Triangle, to: &Triangle| of.iter().map(|p| (closest_on_triangle(to, p) - p).norm()).fold(f64::INFINITY, f64::min);
    let sides = |[a, b, c]: &Triangle| [[*a, *b], [*b, *c], [*c, *a]];
    let of_sides = sides(a).iter().flat_map(|p| sides(b).map(|q| between(p, &q).0)).fold(f64::INFINITY, f64::min);
    of_sides.min(from_corners(a, b)).min(from_corners(b, a))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_are_apart_by_corner_face_or_edges() {
        let floor = [Vec3::new(0.0, 0.0, 0.0), Vec3::new(4.0, 0.0, 0.0), Vec3::new(0.0, 4.0, 0.0)];
        let spike = [Vec3::new(1.0, 1.0, 2.0), Vec3::new(0.0, 0.0, 9.0), Vec3::new(2.0, 0.0, 9.0)];
        assert_eq!(distance(&floor, &spike), 2.0);
        assert_eq!(distance(&spike, &floor), 2.0);
        let beam = [Vec3::new(2.0, -9.0, 3.0), Vec3::new(2.0, 9.0, 3.0), Vec3::new(2.0, 0.0, 20.0)];
        assert_eq!(distance(&floor, &beam), 3.0);
    }
}
