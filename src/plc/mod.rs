//! The evaluated model as TetGen's piecewise linear complex: [`crate::brep::complex::Complex`] to [`Plc`], and its exact check.
//!
//! `build` turns facets into polygons with facet-hole points and finds one point strictly inside every region (`seeds`);
//! `volumes` finds the volumes that facets enclose from nothing but the facets, which is how `check` judges any .poly.

pub mod build;
pub mod check;
pub mod facet;
pub mod measure;
#[cfg(test)]
pub(crate) mod samples;
pub mod seeds;
#[cfg(test)]
mod tests;
pub mod volumes;

use crate::geom::{Vec3, aabb::Aabb};

/// A piecewise linear complex as a .poly file states it. Indices count from 0.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Plc {
    /// Vertices, in the scene's unit.
    pub vertices: Vec<Vec3>,
    /// Facets.
    pub facets: Vec<PlcFacet>,
    /// One point inside each volume that is not a hole.
    pub seeds: Vec<Seed>,
    /// One point inside each volume that stays empty.
    pub holes: Vec<Vec3>,
}

/// A planar facet.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct PlcFacet {
    /// Outer polygon first; further ones are holes (if a hole point lies in them), touching edges (two vertices) or touching
    /// vertices (one).
    pub polygons: Vec<Vec<u32>>,
    /// A point strictly inside each hole.
    pub holes: Vec<Vec3>,
    /// Marker, as the manifest lists it.
    pub marker: i64,
}

/// A point strictly inside a region.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Seed {
    /// Where.
    pub point: Vec3,
    /// Region number: that of the part, from 1.
    pub region: i64,
    /// Largest wanted volume of a tetrahedron.
    pub max_volume: Option<f64>,
}

impl Plc {
    /// Diagonal of the box around all vertices.
    pub fn size(&self) -> f64 {
        Aabb::around(&self.vertices).diagonal()
    }
}
