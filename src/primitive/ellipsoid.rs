//! Spheres and ellipsoids: the octahedron, each face divided into n^2 triangles (thesis 2.3.3.1).
//!
//! With n = 2^k m, m odd, a face is divided into m^2 triangles by one symmetric formula and these k times at the middles of
//! their edges, projected to the sphere; powers of two (m = 1) are the thesis' recursion. Edges of the octahedron, quarter
//! circles, are divided evenly and with the same bits as any circle about their axes.

use super::angle;
use super::division::{self, check_count};
use super::place::Place;
use super::shell::Shell;
use super::solid::{Freedom, Solid};
use crate::diag::Diagnostic;
use crate::geom::Vec3;
use crate::geom::hash::IndexMap;
use crate::scene::model::{Division, Leaf};
use std::collections::HashMap;

/// Centres and half axes that differ by less than this fraction of the ellipsoid are equal: rounding of transforms.
const SAME: f64 = 1e-12;

/// An ellipsoid in the scene.
#[derive(Clone, Debug)]
pub(crate) struct EllipsoidRequest {
    pub place: Place,
    pub center: Vec3,
    pub radii: Vec3,
    /// Parts of an octahedron's edge.
    pub parts: u32,
}

impl EllipsoidRequest {
    /// # Errors
    /// If the division has too many segments or facets.
    pub fn new(center: &Vec3, radii: &Vec3, leaf: &Leaf) -> Result<Self, Diagnostic> {
        let place = Place::of_axes(&leaf.transform);
        let largest = (0..3).map(|k| radii[k] * place.axes[k].norm()).fold(0.0, f64::max);
        let parts = parts(&leaf.division, largest)?;
        check_count(8.0 * f64::from(parts).powi(2))?;
        Ok(Self { place, center: *center, radii: *radii, parts })
    }

    /// Centre and images of the half axes in the scene.
    fn image(&self) -> (Vec3, [Vec3; 3]) {
        let center = self.place.point(self.center.x, self.center.y, self.center.z);
        (center, std::array::from_fn(|k| self.place.axes[k] * self.radii[k]))
    }

    /// Radius, if it is a sphere in the scene.
    fn sphere_radius(&self) -> Option<f64> {
        let (_, [a, b, c]) = self.image();
        let r = a.norm();
        let is_round = [b, c].iter().all(|v| (v.norm() - r).abs() <= SAME * r)
            && [a.dot(&b), b.dot(&c), c.dot(&a)].iter().all(|d| d.abs() <= SAME * r * r);
        is_round.then_some(r)
    }

    fn is_same(&self, other: &Self, tolerance: f64) -> bool {
        let ((c1, a1), (c2, a2)) = (self.image(), other.image());
        let reach = tolerance.max(SAME * a1[0].norm());
        if (c1 - c2).norm() > reach {
            return false;
        }
        match (self.sphere_radius(), other.sphere_radius()) {
            (Some(r), Some(s)) => (r - s).abs() <= reach,
            (None, None) => (0..3).all(|k| (a1[k] - a2[k]).norm().min((a1[k] + a2[k]).norm()) <= reach),
            _ => false,
        }
    }

    /// The solid.
    pub fn build(&self) -> Solid {
        let n = self.parts as i32;
        let mut shell = Shell::new(self.place.is_mirrored());
        let surface = shell.surface("side", self.place.ellipsoid(self.center, self.radii));
        let octant = divided_octant(self.parts);
        let row = |a: i32, b: i32| (a * (2 * n + 3 - a) / 2 + b) as usize;
        let mut known: IndexMap<[i32; 3], u32> = IndexMap::default();
        let mut vertex = |shell: &mut Shell, p: [i32; 3]| {
            *known.entry(p).or_insert_with(|| {
                let u = octant[row(p[0].abs(), p[1].abs())];
                let at = |k: usize| self.center[k] + self.radii[k] * if p[k] < 0 { -u[k] } else { u[k] };
                shell.vertex(self.place.point(at(0), at(1), at(2)), Freedom::Surface)
            })
        };
        for signs in 0..8 {
            let s: [i32; 3] = std::array::from_fn(|k| 1 - 2 * (signs >> k & 1));
            let is_turned = s[0] * s[1] * s[2] < 0;
            let mut triangle = |corners: [[i32; 2]; 3]| {
                let mut walk = corners.map(|[a, b]| vertex(&mut shell, [s[0] * a, s[1] * b, s[2] * (n - a - b)])).to_vec();
                if is_turned {
                    walk.reverse();
                }
                shell.facet(surface, vec![walk]);
            };
            for a in 0..n {
                for b in 0..n - a {
                    triangle([[a, b], [a + 1, b], [a, b + 1]]);
                    if a + b + 1 < n {
                        triangle([[a + 1, b], [a + 1, b + 1], [a, b + 1]]);
                    }
                }
            }
        }
        shell.finish()
    }
}

/// A quarter of the segments of a circle, rounded up.
fn parts(division: &Division, radius: f64) -> Result<u32, Diagnostic> {
    Ok(division::segments(division, radius)?.div_ceil(4))
}

/// The finest division for ellipsoids that were written more than once; the first one's place gives the points.
/// Cost: quadratic only in the number of ellipsoids with one centre.
pub(crate) fn unify(requests: &mut [EllipsoidRequest], tolerance: f64) {
    let size = requests.iter().map(|r| r.image()).fold(0.0, |m: f64, (c, a)| m.max(c.amax()).max(a[0].norm()));
    let cell = size * 1e-6;
    let mut lookup: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
    let mut first: Vec<usize> = Vec::with_capacity(requests.len());
    for k in 0..requests.len() {
        let (center, _) = requests[k].image();
        let slot: [i64; 3] = std::array::from_fn(|i| (center[i] / cell).round() as i64);
        let known = (0..27)
            .filter_map(|n| lookup.get(&[slot[0] + n / 9 - 1, slot[1] + n / 3 % 3 - 1, slot[2] + n % 3 - 1]))
            .flatten()
            .find(|&&other| requests[other].is_same(&requests[k], tolerance * size));
        match known.copied() {
            Some(other) => {
                first.push(other);
                requests[other].parts = requests[other].parts.max(requests[k].parts);
            }
            None => {
                first.push(k);
                lookup.entry(slot).or_default().push(k);
            }
        }
    }
    for k in 0..requests.len() {
        if first[k] != k {
            requests[k] = requests[first[k]].clone();
        }
    }
}

/// Points of the unit sphere's positive octant, by grid coordinates (a, b, n - a - b) towards x, y, z: a rising, then b.
fn divided_octant(n: u32) -> Vec<Vec3> {
    let halvings = n.trailing_zeros();
    let mut parts = (n >> halvings) as usize;
    let mut points = by_formula(parts);
    for _ in 0..halvings {
        points = halved(&points, parts);
        parts *= 2;
    }
    points
}

/// Position of (a, b) in a grid of n parts.
fn slot(n: usize, a: usize, b: usize) -> usize {
    a * (2 * n + 3 - a) / 2 + b
}

fn grid(n: usize, mut inner: impl FnMut(usize, usize) -> Vec3) -> Vec<Vec3> {
    let mut points = Vec::with_capacity((n + 1) * (n + 2) / 2);
    for a in 0..=n {
        for b in 0..=n - a {
            let c = n - a - b;
            let on_circle = |k: usize| angle::cos_sin(90.0 * k as f64 / n as f64);
            points.push(match (a, b, c) {
                (0, _, _) => Vec3::new(0.0, on_circle(b).1, on_circle(b).0),
                (_, 0, _) => Vec3::new(on_circle(c).0, 0.0, on_circle(c).1),
                (_, _, 0) => Vec3::new(on_circle(b).0, on_circle(b).1, 0.0),
                _ => inner(a, b),
            });
        }
    }
    points
}

/// Sines of the three angles, normalised: even on the edges, symmetric inside.
fn by_formula(n: usize) -> Vec<Vec3> {
    let sine = |k: usize| angle::cos_sin(90.0 * k as f64 / n as f64).1;
    grid(n, |a, b| Vec3::new(sine(a), sine(b), sine(n - a - b)).normalize())
}

/// One step of the recursion.
fn halved(points: &[Vec3], n: usize) -> Vec<Vec3> {
    let old = |a: usize, b: usize| points[slot(n, a / 2, b / 2)];
    grid(2 * n, |a, b| match (a % 2, b % 2) {
        (0, 0) => old(a, b),
        (0, _) => (old(a, b - 1) + old(a, b + 1)).normalize(),
        (_, 0) => (old(a - 1, b) + old(a + 1, b)).normalize(),
        _ => (old(a - 1, b + 1) + old(a + 1, b - 1)).normalize(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_two_are_repeated_midpoints() {
        let four = divided_octant(4);
        let two = divided_octant(2);
        let m = |p: Vec3, q: Vec3| (p + q).normalize();
        // (2, 1, 1) of 4 is the middle of (1, 1, 0) and (1, 0, 1) of 2.
        assert_eq!(four[slot(4, 2, 1)], m(two[slot(2, 1, 1)], two[slot(2, 1, 0)]));
        assert!(four.iter().all(|p| (p.norm() - 1.0).abs() < 4e-16));
    }

    #[test]
    fn twenty_four_segments_are_well_shaped() {
        let octant = divided_octant(6);
        let mut smallest = 180f64;
        for a in 0..6 {
            for b in 0..6 - a {
                let t = [slot(6, a, b), slot(6, a + 1, b), slot(6, a, b + 1)].map(|k| octant[k]);
                for k in 0..3 {
                    let (u, v) = (t[(k + 1) % 3] - t[k], t[(k + 2) % 3] - t[k]);
                    smallest = smallest.min(libm::acos(u.normalize().dot(&v.normalize())).to_degrees());
                }
            }
        }
        assert!(smallest > 44.0, "{smallest}");
        // 15 degrees along the equator, with the bits of any circle.
        assert_eq!(octant[slot(6, 5, 1)], Vec3::new(angle::cos_sin(15.0).0, angle::cos_sin(15.0).1, 0.0));
    }
}
