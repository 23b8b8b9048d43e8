//! What a primitive becomes: a closed shell of planar facets with their true surfaces.

use crate::geom::{Affine, Vec3};
use crate::scene::model::Frame;

/// A leaf solid in scene coordinates.
///
/// Invariant: every edge of every facet is used once in each direction; facets are counter-clockwise seen from outside; each
/// facet is planar to rounding and simple; no facet meets another outside shared vertices and edges.
#[derive(Clone, Debug, Default)]
pub struct Solid {
    /// Vertices.
    pub vertices: Vec<SolidVertex>,
    /// Facets.
    pub facets: Vec<SolidFacet>,
    /// True surfaces of the facets.
    pub surfaces: Vec<SolidSurface>,
}

/// A vertex of a leaf solid.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct SolidVertex {
    /// Position.
    pub point: Vec3,
    /// How it may move on the true solid.
    pub freedom: Freedom,
}

/// How a vertex may move (thesis 4.3).
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, serde::Serialize)]
pub enum Freedom {
    /// Degree 0: a corner.
    Fixed,
    /// Degree 1: along a feature edge of the model.
    Edge,
    /// Degree 2: on its surface.
    Surface,
    /// Along a curve where surfaces of different leaves meet.
    Intersection,
}

/// A planar facet of a leaf solid.
#[derive(Clone, PartialEq, Debug)]
pub struct SolidFacet {
    /// Vertex numbers: outer loop first, counter-clockwise seen from outside, then holes, clockwise.
    pub loops: Vec<Vec<u32>>,
    /// Index into [`Solid::surfaces`].
    pub surface: u32,
}

/// A source surface of a leaf solid: one named side.
#[derive(Clone, PartialEq, Debug)]
pub struct SolidSurface {
    /// Name of the side, as listed at `scene::model::Primitive`.
    pub side: String,
    /// Its exact shape.
    pub shape: Shape,
}

/// The exact shape of a surface in scene coordinates; normals of the facets point outwards of the solid, whatever the sense of
/// the shape.
#[derive(Clone, PartialEq, Debug)]
pub enum Shape {
    /// A plane: the facets themselves are exact.
    Plane,
    /// Circular cylinder or cone about the frame's z axis: radius at height z is `radius + slope * z`.
    Cone {
        /// Its place.
        frame: Frame,
        /// Radius at z = 0.
        radius: f64,
        /// Change of the radius per unit of height; 0 for a cylinder.
        slope: f64,
    },
    /// Ellipsoid with half axes along the frame's axes.
    Ellipsoid {
        /// Its place.
        frame: Frame,
        /// Half axes.
        radii: Vec3,
    },
    /// Torus about the frame's z axis.
    Torus {
        /// Its place.
        frame: Frame,
        /// Radius of the circle of centres.
        major_radius: f64,
        /// Radius of the tube.
        minor_radius: f64,
    },
    /// An affine image of another shape that is not itself one of the above (a cylinder under a non-uniform scale).
    Image {
        /// The shape before.
        shape: Box<Shape>,
        /// From it to the scene.
        map: Affine,
    },
    /// No formula: imported facets, supports are fitted.
    Sampled,
}
