//! Supports of a complex: exact ones by shape, fitted ones from facets and their neighbours (thesis 4.2.1, 4.2.2, 6.2).

use super::analytic::support_of_shape;
use super::bspline::BsplinePatch;
use super::plane::Plane;
use super::sample::Sample;
use super::support::{Foot, Nearest, Support};
use crate::brep::complex::Complex;
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use crate::geom::bvh::Bvh;
use crate::ids::{IdVec, SurfaceId};
use crate::primitive::solid::Shape;
use crate::scene::model::PatchMode;
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

/// Patches of neighbouring facets differ by about this fraction of the shortest edges.
const GRAIN: f64 = 1e-4;

/// The support of every surface of the complex, in order; `None` for flat ones, whose facets carry their own planes.
/// Must run on the complex as evaluated: killed facets shape the patches. Linear up to the box trees' logarithm.
pub fn supports_of(complex: &Complex, patches: PatchMode) -> IdVec<SurfaceId, Option<Arc<Support>>> {
    let fitted = |surface: SurfaceId| Some(Arc::new(Support::Fitted(Box::new(FittedSurface::of(complex, surface)))));
    complex
        .surfaces
        .enumerate()
        .map(|(id, surface)| match (&surface.shape, patches) {
            (Shape::Plane, _) => None,
            (Shape::Sampled, _) | (_, PatchMode::BSpline) => fitted(id),
            (shape, PatchMode::Analytic) => support_of_shape(shape).map(Arc::new),
        })
        .collect()
}

/// A surface known by its facets: a patch or plane for each facet of the leaf.
#[derive(Clone, Debug)]
pub struct FittedSurface {
    triangles: Vec<[Vec3; 3]>,
    patch_of_triangle: Vec<u32>,
    tree: Bvh,
    patches: Vec<LocalPatch>,
    grain: f64,
    /// The triangle found last: the next question is mostly about a place beside. Answers do not depend on it.
    last: Arc<AtomicU32>,
}

#[derive(Clone, Debug)]
pub(super) enum LocalPatch {
    Plane(Plane),
    Bspline {
        patch: BsplinePatch,
        /// The largest curvature that the facets show: what a patch has beyond is made up.
        most_curved: f64,
    },
}

impl FittedSurface {
    /// Fits all facets of a surface, from its retained and its killed facets.
    pub fn of(complex: &Complex, surface: SurfaceId) -> Self {
        Self::fit(&Sample::of(complex, surface))
    }

    fn fit(sample: &Sample) -> Self {
        let patches: Vec<LocalPatch> = sample.facets.par_iter().map(|facet| sample.fit_facet(facet)).collect();
        let triangles: Vec<[Vec3; 3]> = sample.triangles.iter().map(|t| t.0.map(|v| sample.points[v as usize])).collect();
        let boxes = triangles.iter().map(|t| Aabb::around(t.iter())).collect();
        let patch_of_triangle = sample.triangles.iter().map(|t| t.1).collect();
        let shortest = |[a, b, c]: &[Vec3; 3]| (b - a).norm().min((c - b).norm()).min((a - c).norm());
        let grain = GRAIN * triangles.iter().map(shortest).sum::<f64>() / triangles.len().max(1) as f64;
        Self { triangles, patch_of_triangle, tree: Bvh::new(boxes), patches, grain, last: Arc::default() }
    }

    pub(super) fn closest(&self, point: &Vec3) -> Foot {
        let nearest = self.nearest_triangle(point);
        match nearest.map(|t| &self.patches[self.patch_of_triangle[t as usize] as usize]) {
            Some(LocalPatch::Plane(plane)) => plane.closest(point),
            Some(LocalPatch::Bspline { patch, most_curved }) => {
                let mut foot = patch.closest(point);
                foot.bending *= (most_curved / foot.largest_curvature()).min(1.0);
                foot
            }
            None => Foot { point: *point, normal: Vec3::z(), bending: nalgebra::Matrix3::zeros() },
        }
    }

    pub(super) fn nearest(&self, point: &Vec3) -> Nearest {
        let triangle = self.nearest_triangle(point);
        match triangle.map(|t| &self.patches[self.patch_of_triangle[t as usize] as usize]) {
            Some(LocalPatch::Plane(plane)) => plane.nearest(point),
            Some(LocalPatch::Bspline { patch, most_curved }) => {
                let near = patch.nearest(point);
                Nearest { curvature: near.curvature.min(*most_curved), ..near }
            }
            None => Nearest { point: *point, normal: Vec3::z(), curvature: 0.0 },
        }
    }

    /// Nearest triangle, the first of equally near ones.
    fn nearest_triangle(&self, point: &Vec3) -> Option<u32> {
        let distance = |t: u32| (closest_on_triangle(&self.triangles[t as usize], point) - point).norm_squared();
        let last = self.last.load(Ordering::Relaxed);
        let found = self.tree.nearest(point, ((last as usize) < self.triangles.len()).then_some(last), distance)?;
        self.last.store(found, Ordering::Relaxed);
        Some(found)
    }

    /// Steps from patch to patch below this are no steps.
    pub(super) fn grain(&self) -> f64 {
        self.grain
    }

    /// How many facets fell back to their plane, and how many there are.
    pub fn plane_count(&self) -> (usize, usize) {
        (self.patches.iter().filter(|p| matches!(p, LocalPatch::Plane(_))).count(), self.patches.len())
    }
}

/// The closest point of a triangle (Ericson, Real-Time Collision Detection, 5.1.5).
pub fn closest_on_triangle([a, b, c]: &[Vec3; 3], p: &Vec3) -> Vec3 {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(&ap), ac.dot(&ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return *a;
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(&bp), ac.dot(&bp));
    if d3 >= 0.0 && d4 <= d3 {
        return *b;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 && d1 > d3 {
        return a + ab * (d1 / (d1 - d3));
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(&cp), ac.dot(&cp));
    if d6 >= 0.0 && d5 <= d6 {
        return *c;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 && d2 > d6 {
        return a + ac * (d2 / (d2 - d6));
    }
    let va = d3 * d6 - d5 * d4;
    let (e, f) = (d4 - d3, d5 - d6);
    if va <= 0.0 && e >= 0.0 && f >= 0.0 && e + f > 0.0 {
        return b + (c - b) * (e / (e + f));
    }
    let sum = va + vb + vc;
    if sum > 0.0 { a + ab * (vb / sum) + ac * (vc / sum) } else { *a }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closest_on_triangle_in_all_zones() {
        let t = [Vec3::zeros(), Vec3::new(4.0, 0.0, 0.0), Vec3::new(0.0, 4.0, 0.0)];
        let foot = |x, y| closest_on_triangle(&t, &Vec3::new(x, y, 1.0));
        assert_eq!(foot(1.0, 1.0), Vec3::new(1.0, 1.0, 0.0));
        assert_eq!(foot(-1.0, -1.0), Vec3::zeros());
        assert_eq!(foot(2.0, -3.0), Vec3::new(2.0, 0.0, 0.0));
        assert_eq!(foot(9.0, 0.0), Vec3::new(4.0, 0.0, 0.0));
        assert_eq!(foot(4.0, 4.0), Vec3::new(2.0, 2.0, 0.0));
    }
}
