//! Pure mathematics without topology: exact signs, boxes, box trees, polygons.

pub mod aabb;
pub mod bvh;
pub mod cast;
pub(crate) mod cdt;
pub mod dd;
pub mod embedding;
pub mod hash;
pub mod lists;
pub mod parallel;
pub mod plane;
pub mod polygon;
pub mod predicates;
pub mod radial;
pub mod segment;
pub mod union_find;

/// A position or direction, in the scene's unit.
pub type Vec3 = nalgebra::Vector3<f64>;
/// An affine map of space.
pub type Affine = nalgebra::Affine3<f64>;
