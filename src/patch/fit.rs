//! Supports of a complex: exact ones by shape, fitted ones from facets and their neighbours (thesis 4.2.1, 4.2.2, 6.2).

use super::analytic::support_of_shape;
use super::bspline::BsplinePatch;
use super::plane::Plane;
use super::sample::{Sample, SurfaceSample};
use super::support::{Foot, Nearest, Support};
use crate::brep::complex::{Complex, ComplexSurface};
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use crate::geom::bvh::Bvh;
use crate::ids::{IdVec, LeafId, SurfaceId};
use crate::primitive::solid::Shape;
use crate::scene::model::PatchMode;
use std::collections::{BTreeMap, HashMap};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, OnceLock};

/// Patches of neighbouring facets differ by about this fraction of the shortest edges.
const GRAIN: f64 = 1e-4;

/// The support of every surface of the complex, in order; `None` for flat ones, whose facets carry their own planes.
/// Must run on the complex as evaluated: killed facets shape the patches. Linear up to the box trees' logarithm; patches are
/// fitted where somebody asks for them.
pub fn supports_of(complex: &Complex, patches: PatchMode) -> IdVec<SurfaceId, Option<Arc<Support>>> {
    let is_fitted = |shape: &Shape| match (shape, patches) {
        (Shape::Plane, _) => false,
        (Shape::Sampled, _) | (_, PatchMode::BSpline) => true,
        (_, PatchMode::Analytic) => false,
    };
    let leaves = complex.surfaces.iter().filter(|s| is_fitted(&s.shape)).map(|s| s.leaf);
    let samples: BTreeMap<LeafId, Arc<Sample>> =
        Sample::of_leaves(complex, leaves).into_iter().map(|(leaf, sample)| (leaf, Arc::new(sample))).collect();
    let support = |(id, surface): (SurfaceId, &ComplexSurface)| match samples.get(&surface.leaf) {
        Some(leaf) if is_fitted(&surface.shape) => {
            let fitted = FittedSurface::of(SurfaceSample::new(leaf.clone(), id));
            Some(Arc::new(Support::Fitted(Box::new(fitted))))
        }
        _ => support_of_shape(&surface.shape).map(Arc::new),
    };
    complex.surfaces.enumerate().map(support).collect()
}

/// A surface known by its facets: a patch or plane for each facet of the leaf.
#[derive(Clone, Debug)]
pub struct FittedSurface {
    sample: SurfaceSample,
    triangles: Vec<[Vec3; 3]>,
    patch_of_triangle: Vec<u32>,
    tree: Bvh,
    /// Facets with their patches, fitted by whoever needs them first; what they become does not depend on when.
    patches: Vec<(u32, OnceLock<LocalPatch>)>,
    grain: f64,
    /// The triangle found last: the next question is mostly about a place beside. Answers do not depend on it.
    last: Arc<AtomicU32>,
}

/// What stands for a facet.
#[derive(Clone, Debug)]
pub(super) struct LocalPatch {
    pub shape: PatchShape,
    /// Of the facet.
    pub width: f64,
}

#[derive(Clone, Debug)]
pub(super) enum PatchShape {
    Plane(Plane),
    Bspline {
        patch: Box<BsplinePatch>,
        /// The largest curvature that the facets show: what a patch has beyond is made up.
        most_curved: f64,
    },
}

impl FittedSurface {
    /// The surface that a sample shows.
    pub(super) fn of(sample: SurfaceSample) -> Self {
        let (mut triangles, mut patch_of_triangle, mut patches) = (Vec::new(), Vec::new(), Vec::new());
        let mut patch_of_facet: HashMap<u32, u32> = HashMap::new();
        for (corners, facet) in sample.triangles() {
            triangles.push(corners);
            patch_of_triangle.push(*patch_of_facet.entry(facet).or_insert_with(|| {
                patches.push((facet, OnceLock::new()));
                patches.len() as u32 - 1
            }));
        }
        let boxes = triangles.iter().map(|t| Aabb::around(t.iter())).collect();
        let shortest = |[a, b, c]: &[Vec3; 3]| (b - a).norm().min((c - b).norm()).min((a - c).norm());
        let grain = GRAIN * triangles.iter().map(shortest).sum::<f64>() / triangles.len().max(1) as f64;
        Self { sample, triangles, patch_of_triangle, tree: Bvh::new(boxes), patches, grain, last: Arc::default() }
    }

    pub(super) fn closest(&self, point: &Vec3) -> Foot {
        match self.patch_near(point).map(|p| &p.shape) {
            Some(PatchShape::Plane(plane)) => plane.closest(point),
            Some(PatchShape::Bspline { patch, most_curved }) => {
                let mut foot = patch.closest(point);
                foot.bending *= (most_curved / foot.largest_curvature()).min(1.0);
                foot
            }
            None => Foot { point: *point, normal: Vec3::z(), bending: nalgebra::Matrix3::zeros() },
        }
    }

    pub(super) fn nearest(&self, point: &Vec3) -> Nearest {
        match self.patch_near(point).map(|p| &p.shape) {
            Some(PatchShape::Plane(plane)) => plane.nearest(point),
            Some(PatchShape::Bspline { patch, most_curved }) => {
                let near = patch.nearest(point);
                Nearest { curvature: near.curvature.min(*most_curved), ..near }
            }
            None => Nearest { point: *point, normal: Vec3::z(), curvature: 0.0 },
        }
    }

    /// Width of the nearest facet.
    pub(super) fn spacing(&self, point: &Vec3) -> f64 {
        self.patch_near(point).map_or(0.0, |p| p.width)
    }

    /// The patch of the nearest facet.
    fn patch_near(&self, point: &Vec3) -> Option<&LocalPatch> {
        let (facet, patch) = &self.patches[self.patch_of_triangle[self.nearest_triangle(point)? as usize] as usize];
        Some(patch.get_or_init(|| self.sample.fit_facet(*facet)))
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
