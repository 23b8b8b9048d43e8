//! What a primitive becomes: a closed shell of planar facets with their true surfaces.

use crate::geom::lists::Lists;
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
    pub facets: Facets,
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

/// The facets of a leaf solid, stored flat: imports have millions, and lists of each would be a tenth of all memory.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Facets {
    /// All loops, facet by facet.
    walks: Lists,
    /// For each facet, the end of its loops.
    ends: Vec<u32>,
    surfaces: Vec<u32>,
}

impl Facets {
    /// No facets yet, but room for so many of one loop each and for their corners.
    pub fn with_capacity(facets: usize, corners: usize) -> Self {
        let walks = Lists::with_capacity(facets, corners);
        Self { walks, ends: Vec::with_capacity(facets), surfaces: Vec::with_capacity(facets) }
    }
    /// Adds a facet: see [`SolidFacet`].
    pub fn push(&mut self, loops: impl IntoIterator<Item = impl IntoIterator<Item = u32>>, surface: u32) {
        loops.into_iter().for_each(|walk| self.walks.push(walk));
        self.ends.push(self.walks.count() as u32);
        self.surfaces.push(surface);
    }
    /// Number of facets.
    pub fn len(&self) -> usize {
        self.ends.len()
    }
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }
    /// One facet.
    pub fn of(&self, facet: u32) -> SolidFacet<'_> {
        let k = facet as usize;
        let first = if k == 0 { 0 } else { self.ends[k - 1] };
        SolidFacet { loops: Walks { all: &self.walks, first, end: self.ends[k] }, surface: self.surfaces[k] }
    }
    /// All facets in order.
    pub fn iter(&self) -> impl Iterator<Item = SolidFacet<'_>> + Clone {
        (0..self.len() as u32).map(|k| self.of(k))
    }
    /// The vertex numbers of all loops.
    pub fn corners(&self) -> &[u32] {
        self.walks.items()
    }
    /// The vertex numbers of all loops, to be changed.
    pub fn corners_mut(&mut self) -> &mut [u32] {
        self.walks.items_mut()
    }
}

impl<L: IntoIterator<Item = Vec<u32>>> FromIterator<(L, u32)> for Facets {
    fn from_iter<I: IntoIterator<Item = (L, u32)>>(facets: I) -> Self {
        let mut all = Self::default();
        facets.into_iter().for_each(|(loops, surface)| all.push(loops, surface));
        all
    }
}

/// A planar facet of a leaf solid.
#[derive(Clone, Copy, Debug)]
pub struct SolidFacet<'a> {
    /// Vertex numbers: outer loop first, counter-clockwise seen from outside, then holes, clockwise.
    pub loops: Walks<'a>,
    /// Index into [`Solid::surfaces`].
    pub surface: u32,
}

/// The loops of a facet.
#[derive(Clone, Copy, Debug)]
pub struct Walks<'a> {
    all: &'a Lists,
    first: u32,
    end: u32,
}

impl<'a> Walks<'a> {
    /// The first loop.
    pub fn outer(self) -> &'a [u32] {
        self.iter().next().unwrap_or(&[])
    }
    /// All loops.
    pub fn iter(self) -> impl Iterator<Item = &'a [u32]> + Clone {
        (self.first..self.end).map(move |k| self.all.of(k))
    }
    /// The corners of all loops.
    pub fn corners(self) -> impl Iterator<Item = u32> + Clone {
        self.iter().flatten().copied()
    }
    /// Number of loops.
    pub fn count(self) -> usize {
        (self.end - self.first) as usize
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_facet_keeps_its_loops() {
        let facets: Facets = [(vec![vec![0, 1, 2]], 0), (vec![vec![0, 2, 3, 4], vec![5, 6, 7]], 1)].into_iter().collect();
        let loops = |k: u32| facets.of(k).loops.iter().map(<[u32]>::to_vec).collect::<Vec<_>>();
        assert_eq!((facets.len(), facets.corners().len()), (2, 10));
        assert_eq!((loops(0), facets.of(0).surface), (vec![vec![0, 1, 2]], 0));
        assert_eq!(
            (loops(1), facets.of(1).loops.outer(), facets.of(1).surface),
            (vec![vec![0, 2, 3, 4], vec![5, 6, 7]], &[0, 2, 3, 4][..], 1)
        );
    }
}
