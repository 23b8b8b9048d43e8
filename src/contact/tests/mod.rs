//! Contacts of known solids: counts by hand, and the promise of the step checked by brute force.

mod cases;
mod chords;
mod hard;
mod invariants;
mod many;

use super::conform;
use super::conforming::Conforming;
use crate::diag::{Name, Outcome};
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use crate::ids::LeafId;
use crate::primitive::solid::{Facets, Freedom, Shape, Solid, SolidSurface, SolidVertex};
use nalgebra::Rotation3;

/// A solid from vertices and facets of one loop each.
fn solid(vertices: impl IntoIterator<Item = Vec3>, facets: impl IntoIterator<Item = Vec<u32>>) -> Solid {
    Solid {
        vertices: vertices.into_iter().map(|point| SolidVertex { point, freedom: Freedom::Fixed }).collect(),
        facets: facets.into_iter().map(|w| ([w], 0)).collect(),
        surfaces: vec![SolidSurface { side: "side".into(), shape: Shape::Plane }],
    }
}

/// An axis-parallel block.
fn block(lo: [f64; 3], hi: [f64; 3]) -> Solid {
    let corner = |k: usize| Vec3::new([lo, hi][k & 1][0], [lo, hi][k >> 1 & 1][1], [lo, hi][k >> 2 & 1][2]);
    let facets = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [1, 3, 7, 5], [3, 2, 6, 7], [2, 0, 4, 6]];
    solid((0..8).map(corner), facets.map(|w| w.to_vec()))
}

/// A regular prism about an axis parallel to z: caps are polygons.
fn prism(n: u32, radius: f64, z: [f64; 2], phase: f64, center: [f64; 2]) -> Solid {
    let ring = |z: f64| {
        (0..n).map(move |k| {
            let (s, c) = libm::sincos(phase + std::f64::consts::TAU * f64::from(k) / f64::from(n));
            Vec3::new(center[0] + radius * c, center[1] + radius * s, z)
        })
    };
    let sides = (0..n).map(|k| vec![k, (k + 1) % n, n + (k + 1) % n, n + k]);
    let caps = [(0..n).rev().collect(), (n..2 * n).collect()];
    solid(ring(z[0]).chain(ring(z[1])), caps.into_iter().chain(sides))
}

/// Every facet cut into a fan of triangles, as an import has them.
fn triangulated(solid: &Solid) -> Solid {
    let fan = |w: &[u32]| (1..w.len() - 1).map(|k| vec![w[0], w[k], w[k + 1]]).collect::<Vec<_>>();
    let facets = solid.facets.iter().flat_map(|f| fan(f.loops.outer()));
    Solid { facets: facets.map(|w| ([w], 0)).collect(), ..solid.clone() }
}

fn moved(solid: &Solid, map: impl Fn(Vec3) -> Vec3) -> Solid {
    let mut image = solid.clone();
    image.vertices.iter_mut().for_each(|v| v.point = map(v.point));
    image
}

/// The rotation number `k` of a fixed sequence of arbitrary ones.
fn rotation(k: u32) -> Rotation3<f64> {
    let f = f64::from(k);
    Rotation3::from_scaled_axis(Vec3::new((f * 1.7).sin() + 0.3, (f * 2.3).cos() - 0.2, (f * 3.1).sin() + 0.1) * 1.3)
}

/// The box of all solids.
fn around(solids: &[Solid]) -> Aabb {
    Aabb::around(solids.iter().flat_map(|s| &s.vertices).map(|v| &v.point))
}

fn try_conform(solids: &[Solid], tolerance: f64) -> Outcome<Conforming> {
    conform(solids, &[], tolerance, &vec![None; solids.len()], &around(solids), &|l: LeafId| Name {
        text: format!("leaf {}", l.0),
        ..Name::default()
    })
}

/// Conforms and checks every promise.
fn checked(solids: &[Solid], tolerance: f64) -> Conforming {
    let conforming = try_conform(solids, tolerance).unwrap_or_else(|e| panic!("{e:?}"));
    invariants::check(solids, &conforming);
    conforming
}

/// Cells with as many owners.
fn owned_by(conforming: &Conforming, owners: usize) -> usize {
    (0..conforming.cells.len() as u32).filter(|&c| conforming.owners_of(c).len() == owners).count()
}
