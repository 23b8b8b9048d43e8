//! Volumes of regions and areas of markers.

use crate::brep::complex::{Complex, ComplexFacet};
use crate::geom::Vec3;
use crate::geom::dd::Dd;
use crate::ids::{Id, IdVec, MarkerId, PartId, RegionId};
use crate::scene::model::Part;

/// Sizes of a complex, in the scene's unit.
#[derive(Clone, Debug, Default)]
pub struct Measures {
    /// Volume of each region; 0 for the outside.
    pub volumes: IdVec<RegionId, f64>,
    /// Area of each marker.
    pub areas: IdVec<MarkerId, f64>,
    /// Number of facets of each marker.
    pub facets: IdVec<MarkerId, usize>,
}

impl Measures {
    /// Volume of each part of the complex that was measured, its pieces together.
    pub fn by_part(&self, complex: &Complex, parts: &IdVec<PartId, Part>) -> IdVec<PartId, f64> {
        let mut volumes: IdVec<PartId, f64> = parts.iter().map(|_| 0.0).collect();
        for (region, volume) in complex.regions.iter().zip(&self.volumes) {
            if let Some(part) = region.part {
                volumes[part] += volume;
            }
        }
        volumes
    }
}

/// Measures a complex.
pub fn measure(complex: &Complex) -> Measures {
    let mut areas = vec![0.0; complex.markers.len()];
    let mut facets = vec![0; complex.markers.len()];
    for facet in &complex.facets {
        areas[facet.marker.index()] += area_of(complex, facet);
        facets[facet.marker.index()] += 1;
    }
    let volumes = enclosed_volumes(complex.regions.len(), || walls(complex));
    Measures { volumes: volumes.into(), areas: areas.into(), facets: facets.into() }
}

/// A triangle with what lies in front of it and behind it.
type Wall = ([Vec3; 3], [u32; 2]);

/// What lies outside of all bodies.
const NOTHING: u32 = u32::MAX;

/// All triangles of a complex between their bounded regions.
fn walls(complex: &Complex) -> impl Iterator<Item = Wall> {
    complex.facets.iter().flat_map(move |facet| {
        let sides = facet.sides.map(|s| if s.index() == 0 { NOTHING } else { s.index() as u32 });
        facet.triangles.iter().map(move |t| (t.map(|v| complex.vertices[v].point), sides))
    })
}

/// Relative error to which volumes are good: a hundredth of what a mesh of them is compared by.
const WANTED_ERROR: f64 = 1e-11;
/// Rounding of one term of the sum, relative to the sum of its products' magnitudes: three differences, two products and two
/// sums, with room.
const TERM_ERROR: f64 = 8.0 * f64::EPSILON;

/// What the walls enclose, with sign, for each of `count` bodies; sides with other numbers are in none. Each is summed about a
/// vertex of its own, so that a small one far from the origin loses no digits, and summed again in double-double arithmetic
/// where the terms cancel more than [`WANTED_ERROR`] allows: a shell of a thickness of 1e-9 of its size still has its volume to
/// the last digits.
pub fn enclosed_volumes<I: Iterator<Item = Wall>>(count: usize, walls: impl Fn() -> I) -> Vec<f64> {
    let mut sums = vec![Sum::default(); count];
    for (corners, sides) in walls() {
        for (side, sign) in sides.into_iter().zip([-1.0, 1.0]) {
            if let Some(sum) = sums.get_mut(side as usize) {
                sum.add(corners, sign);
            }
        }
    }
    let is_rough = |s: &Sum| s.magnitude * TERM_ERROR > WANTED_ERROR * s.value.hi.abs();
    let rough: Vec<bool> = sums.iter().map(is_rough).collect();
    if rough.contains(&true) {
        let zero = Dd::from(0.0);
        sums.iter_mut().zip(&rough).filter(|(_, is_rough)| **is_rough).for_each(|(s, _)| s.value = zero);
        for (corners, sides) in walls() {
            for (side, sign) in sides.into_iter().zip([-1.0, 1.0]).filter(|(side, _)| rough.get(*side as usize) == Some(&true))
            {
                sums[side as usize].add_exactly(corners, sign);
            }
        }
    }
    // The sum was of boxes, six times a tetrahedron each.
    sums.into_iter().map(|s| s.value.hi / 6.0).collect()
}

/// Six times a volume, as a sum over triangles.
#[derive(Clone)]
struct Sum {
    origin: Option<Vec3>,
    value: Dd,
    /// Sum of the magnitudes of all products.
    magnitude: f64,
}

impl Default for Sum {
    fn default() -> Self {
        Self { origin: None, value: Dd::from(0.0), magnitude: 0.0 }
    }
}

impl Sum {
    fn add(&mut self, [a, b, c]: [Vec3; 3], sign: f64) {
        let origin = *self.origin.get_or_insert(a);
        // By edges, not by corners: small triangles far from the origin then have small terms, which cancel nothing.
        let [a, b, c] = [a - origin, b - a, c - a];
        self.value = self.value + Dd::from(sign * a.dot(&b.cross(&c)));
        let [p, q, r] = [a, b, c].map(|x| x.abs());
        self.magnitude += p.dot(&Vec3::new(q.y * r.z + q.z * r.y, q.z * r.x + q.x * r.z, q.x * r.y + q.y * r.x));
    }

    fn add_exactly(&mut self, corners: [Vec3; 3], sign: f64) {
        let origin = *self.origin.get_or_insert(corners[0]);
        let [a, b, c] = corners.map(|p| [0, 1, 2].map(|k| Dd::difference(p[k], origin[k])));
        let minor = |i: usize, j: usize| b[i] * c[j] - b[j] * c[i];
        let term = a[0] * minor(1, 2) + a[1] * minor(2, 0) + a[2] * minor(0, 1);
        self.value = self.value + if sign < 0.0 { -term } else { term };
    }
}

/// Area of one facet.
pub fn area_of(complex: &Complex, facet: &ComplexFacet) -> f64 {
    let corners = facet.triangles.iter().map(|t| t.map(|v| complex.vertices[v].point));
    corners.map(|[a, b, c]| 0.5 * (b - a).cross(&(c - a)).norm()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thin_shells_keep_their_digits() {
        // A unit square times a thickness, sheared: all coordinates are exact, and so is the volume.
        for power in [0, 10, 20, 30, 40] {
            let thickness = libm::ldexp(1.0, -power);
            let corner = |k: usize| {
                let (x, y) = [(0.25, 0.5), (1.25, 0.5), (1.25, 1.5), (0.25, 1.5)][k % 4];
                Vec3::new(x, y + 3.0 * x, x + 5.0 * y + 700.0 + if k < 4 { 0.0 } else { thickness })
            };
            let quads = [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
            let halves = |[a, b, c, d]: [usize; 4]| [[a, b, c], [a, c, d]];
            let walls: Vec<Wall> = quads.into_iter().flat_map(halves).map(|t| (t.map(corner), [0, 1])).collect();
            let volumes = enclosed_volumes(2, || walls.iter().copied());
            assert_eq!(volumes, [-thickness, thickness]);
        }
    }
}
