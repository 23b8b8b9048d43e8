//! The model's size, to which tolerances are relative, and where it lies.

use crate::geom::aabb::Aabb;
use crate::ids::Id;
use crate::primitive::solid::Solid;
use crate::scene::model::{Node, Operation, Scene};

/// How large a model is, and where.
#[derive(Clone, Copy)]
pub struct Extent {
    /// Diagonal of the box around what the parts can claim, without a part that encloses all others: neither a large tool nor
    /// the air box changes what touches.
    pub size: f64,
    /// The box around what the parts can claim.
    pub bounds: Aabb,
}

/// The extent of a scene's parts.
pub fn of(scene: &Scene, solids: &[Solid]) -> Extent {
    let leaves: Vec<Aabb> = solids.iter().map(|s| Aabb::around(s.vertices.iter().map(|v| &v.point))).collect();
    let parts: Vec<Aabb> = scene.parts.iter().map(|p| bounds(&p.solid, &leaves)).collect();
    let around = |skip: usize| {
        let others = parts.iter().enumerate().filter(|(k, b)| *k != skip && !b.is_empty());
        others.fold(Aabb::EMPTY, |all, (_, b)| all.union(b))
    };
    let all = around(usize::MAX);
    // A part that encloses all others is as large as all, and the first that is.
    let others = parts.iter().position(|b| *b == all).map_or(Aabb::EMPTY, around);
    let is_enclosed = !others.is_empty() && (0..3).all(|a| all.lo[a] < others.lo[a] && others.hi[a] < all.hi[a]);
    let size = if is_enclosed { others } else { all }.diagonal();
    if size > 0.0 {
        return Extent { size, bounds: all };
    }
    // Where the boxes tell that nothing is left, rounding is still that of the leaves.
    let bounds = leaves.iter().fold(Aabb::EMPTY, |all, b| all.union(b));
    Extent { size: bounds.diagonal(), bounds }
}

/// A box around the points that a tree can claim.
fn bounds(node: &Node, leaves: &[Aabb]) -> Aabb {
    match node {
        Node::Leaf(leaf) => leaves[leaf.index()],
        Node::Boolean(operation, operands) => {
            let mut boxes = operands.iter().map(|o| bounds(o, leaves));
            match operation {
                Operation::Union | Operation::Xor => boxes.fold(Aabb::EMPTY, |all, b| all.union(&b)),
                Operation::Difference => boxes.next().unwrap_or(Aabb::EMPTY),
                Operation::Intersection => {
                    let common = |a: Aabb, b: Aabb| Aabb { lo: a.lo.sup(&b.lo), hi: a.hi.inf(&b.hi) };
                    boxes.reduce(common).filter(|b| !b.is_empty()).unwrap_or(Aabb::EMPTY)
                }
            }
        }
    }
}
