//! What cannot reach the result is set aside before anything is intersected.
//!
//! Reads the scene and its leaf solids, gives `contact` the same solids with their facets cut into pieces, each with its
//! [`Fate`].
//!
//! Two hundred cubes about one axis cross 159200 times on each cap, and their union has 1600 vertices there: where one cube
//! covers a place, it does not matter how the others lie. So space is divided into boxes ([`zones`]). In each the parts' trees
//! are evaluated with three values ([`inside`]): a leaf contains the box, or does not, or its boundary passes through and
//! nothing is known. Where all parts' claims are known nevertheless, the box is one volume, and no facet in it can reach the
//! result. Where they are known on both sides of a plane, its piece in the box is one facet of the result, whatever else lies
//! in it. Facets are cut along such boxes ([`pieces`]), so that what is set aside is whole pieces; a leaf stays closed, since
//! all pieces are kept, those of one facet that are set aside as few polygons ([`rebuild`]).
//!
//! Boxes cost time too: only piles of leaves are worth it ([`is_worthwhile`]).

mod inside;
mod pieces;
mod rebuild;
mod zones;

use crate::geom::aabb::Aabb;
use crate::geom::bvh::Bvh;
use crate::ids::PartId;
use crate::primitive::solid::Solid;
use crate::scene::model::{Policy, Scene};

/// Leaves over one place from which on culling pays: their pairs grow with the square, the boxes hardly.
const DEEP: usize = 32;

/// What may become of a facet.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug, Default)]
pub enum Fate {
    /// Anything: it has to be intersected.
    #[default]
    Live,
    /// One part, or none, lies on both sides of it.
    Hidden,
    /// It is a facet of the result between these parts, in front and behind.
    Face([Option<PartId>; 2]),
    /// It lies on a [`Fate::Face`] and adds nothing to it.
    Copy,
}

impl Fate {
    /// Whether it need not be compared with others.
    pub fn is_aside(self) -> bool {
        matches!(self, Fate::Hidden | Fate::Copy)
    }
    /// Seen from the other side.
    #[must_use]
    pub fn turned(self) -> Self {
        if let Fate::Face([front, back]) = self { Fate::Face([back, front]) } else { self }
    }
}

/// A facet of a cut solid: which facet of the leaf it is a piece of, and its fate.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Piece {
    /// Facet of the leaf's solid.
    pub facet: u32,
    /// What may become of it.
    pub fate: Fate,
}

/// Solids with cut facets.
#[derive(Clone, Debug)]
pub struct Culled {
    /// The leaves.
    pub solids: Vec<Solid>,
    /// Every facet of every leaf.
    pub pieces: Vec<Vec<Piece>>,
}

/// Cuts the facets of a scene, unless that is not worth it. `tolerance`: that of contact, in the scene's unit.
///
/// O(n log n) in the facets, times the boxes that they pass through.
pub fn cull(scene: &Scene, solids: &[Solid], tolerance: f64) -> Option<Culled> {
    if scene.overlap == Policy::Forbid || !is_worthwhile(solids) {
        return None;
    }
    let settled = zones::settle(scene, solids, tolerance);
    Some(rebuild::rebuild(solids, settled))
}

/// Whether many leaves lie over one place.
fn is_worthwhile(solids: &[Solid]) -> bool {
    if solids.len() < DEEP {
        return false;
    }
    let boxes: Vec<Aabb> = solids.iter().map(|s| Aabb::around(s.vertices.iter().map(|v| &v.point))).collect();
    let tree = Bvh::new(boxes.clone());
    boxes.iter().any(|own| {
        let (middle, mut count) = (own.center(), 0);
        tree.overlapping(&Aabb { lo: middle, hi: middle }, |_| count += 1);
        count >= DEEP
    })
}

#[cfg(test)]
mod tests;
