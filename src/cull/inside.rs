//! What is known of a place: of leaves, of trees, of parts.

use crate::geom::Vec3;
use crate::ids::{Id, LeafId, PartId};
use crate::primitive::solid::Solid;
use crate::scene::model::{Node, Operation, Scene};
use std::f64::consts::PI;

/// Whether a solid contains a place, or all of a zone.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Status {
    Out,
    In,
    Unknown,
}

use Status::{In, Out, Unknown};

impl Status {
    fn not(self) -> Self {
        match self {
            Out => In,
            In => Out,
            Unknown => Unknown,
        }
    }
}

/// The part that claims a zone, if that is known: the last in the file that contains it.
pub fn owner(scene: &Scene, of_leaf: impl Fn(LeafId) -> Status) -> Option<Option<PartId>> {
    for k in (0..scene.parts.len()).rev() {
        let part = PartId::new(k);
        match status(&scene.parts[part].solid, &of_leaf) {
            Out => {}
            In => return Some(Some(part)),
            Unknown => return None,
        }
    }
    Some(None)
}

/// The status of a tree.
fn status(node: &Node, of_leaf: &impl Fn(LeafId) -> Status) -> Status {
    let (operation, operands) = match node {
        Node::Leaf(leaf) => return of_leaf(*leaf),
        Node::Boolean(operation, operands) => (operation, operands),
    };
    let mut each = operands.iter().map(|o| status(o, of_leaf));
    match operation {
        Operation::Union => any(each),
        Operation::Intersection if operands.is_empty() => Out,
        Operation::Intersection => any(each.map(Status::not)).not(),
        Operation::Difference => match each.next() {
            None | Some(Out) => Out,
            Some(first) => any([first.not()].into_iter().chain(each)).not(),
        },
        Operation::Xor => each.fold(Out, |sum, x| match (sum, x) {
            (Unknown, _) | (_, Unknown) => Unknown,
            (a, b) => {
                if a == b {
                    Out
                } else {
                    In
                }
            }
        }),
    }
}

fn any(each: impl Iterator<Item = Status>) -> Status {
    let mut sum = Out;
    for x in each {
        match x {
            In => return In,
            Unknown => sum = Unknown,
            Out => {}
        }
    }
    sum
}

/// Whether a solid contains a point that is not near its boundary: the solid angle under which it is seen (van Oosterom and
/// Strackee 1983).
pub fn contains(solid: &Solid, p: &Vec3) -> Status {
    let at = |v: u32| solid.vertices[v as usize].point - p;
    let mut sum = 0.0;
    for walk in solid.facets.iter().flat_map(|f| f.loops.iter()) {
        for k in 2..walk.len() {
            let [a, b, c] = [walk[0], walk[k - 1], walk[k]].map(at);
            let (la, lb, lc) = (a.norm(), b.norm(), c.norm());
            let side = la * lb * lc + a.dot(&b) * lc + b.dot(&c) * la + c.dot(&a) * lb;
            sum += 2.0 * libm::atan2(a.dot(&b.cross(&c)), side);
        }
    }
    if sum.abs() > 2.0 * PI { In } else { Out }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_known_decides() {
        let leaf = |k: u32| Node::Leaf(LeafId(k));
        let known = |leaf: LeafId| [Out, In, Unknown][leaf.0 as usize];
        let of = |operation, operands: &[u32]| {
            status(&Node::Boolean(operation, operands.iter().map(|&k| leaf(k)).collect()), &known)
        };
        assert_eq!(of(Operation::Union, &[0, 2, 1]), In);
        assert_eq!(of(Operation::Union, &[0, 2]), Unknown);
        assert_eq!(of(Operation::Intersection, &[1, 2, 0]), Out);
        assert_eq!(of(Operation::Intersection, &[1, 2]), Unknown);
        assert_eq!(of(Operation::Intersection, &[1, 1]), In);
        assert_eq!(of(Operation::Difference, &[2, 1]), Out);
        assert_eq!(of(Operation::Difference, &[1, 0]), In);
        assert_eq!(of(Operation::Difference, &[1, 2]), Unknown);
        assert_eq!(of(Operation::Xor, &[1, 1, 1]), In);
        assert_eq!(of(Operation::Xor, &[1, 2]), Unknown);
    }
}
