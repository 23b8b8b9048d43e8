//! Which part claims which volume.

use super::table::combine;
use crate::classify::{Class, Classified};
use crate::geom::hash::IndexMap;
use crate::ids::{IdVec, LeafId, PartId};
use crate::scene::model::{Node, Operation, Part, Scene};

/// Two parts that claim the same space.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct Overlap {
    /// The earlier part, which loses the space.
    pub loser: PartId,
    /// The later part.
    pub winner: PartId,
    /// A label of the common space.
    pub label: u32,
}

/// The part that each label belongs to.
pub struct Decision {
    part_of_label: Vec<Option<PartId>>,
    /// Labels that several parts claim.
    pub overlaps: Vec<Overlap>,
}

impl Decision {
    /// The part that claims the volume of a shell.
    pub fn part_of_shell(&self, classified: &Classified, shell: u32) -> Option<PartId> {
        self.part_of_label[classified.label_of_shell[shell as usize] as usize]
    }
}

/// Evaluates every part's tree once per distinct label; the last part that claims it wins.
pub fn decide(scene: &Scene, classified: &Classified) -> Decision {
    let users = users_of_leaves(&scene.parts);
    let mut decision = Decision { part_of_label: Vec::with_capacity(classified.labels.len()), overlaps: Vec::new() };
    for (number, label) in classified.labels.iter().enumerate() {
        let mut candidates: Vec<PartId> = label.iter().flat_map(|l| users.get(l).into_iter().flatten().copied()).collect();
        candidates.sort_unstable();
        candidates.dedup();
        let is_inside = |leaf: LeafId| label.binary_search(&leaf.0).is_ok();
        let class = |leaf: LeafId| Class::new(is_inside(leaf), is_inside(leaf));
        let claims: Vec<PartId> =
            candidates.into_iter().rev().filter(|&p| class_against(&scene.parts[p].solid, &class) == Class::In).collect();
        let winner = claims.first().copied();
        for &loser in claims.iter().skip(1) {
            let winner = claims[0];
            decision.overlaps.push(Overlap { loser, winner, label: number as u32 });
        }
        decision.part_of_label.push(winner);
    }
    decision
}

/// The class of a sub-facet against a Boolean node, from its classes against the leaves: folds the decision table.
pub fn class_against(node: &Node, class_of_leaf: &impl Fn(LeafId) -> Class) -> Class {
    match node {
        Node::Leaf(leaf) => class_of_leaf(*leaf),
        Node::Boolean(operation, operands) => {
            let Some((first, rest)) = operands.split_first() else { return Class::Out };
            let mut class = class_against(first, class_of_leaf);
            for operand in rest {
                // Nothing can be added to the inside of a union, nor to the outside of an intersection or a difference.
                let is_settled = match operation {
                    Operation::Union => class == Class::In,
                    Operation::Intersection | Operation::Difference => class == Class::Out,
                    Operation::Xor => false,
                };
                if is_settled {
                    break;
                }
                class = combine(*operation, class, class_against(operand, class_of_leaf));
            }
            class
        }
    }
}

/// Parts that use each leaf: only those can claim a place in it, since the empty place belongs to nobody.
fn users_of_leaves(parts: &IdVec<PartId, Part>) -> IndexMap<u32, Vec<PartId>> {
    fn visit(node: &Node, part: PartId, users: &mut IndexMap<u32, Vec<PartId>>) {
        match node {
            Node::Leaf(leaf) => {
                let list = users.entry(leaf.0).or_default();
                if list.last() != Some(&part) {
                    list.push(part);
                }
            }
            Node::Boolean(_, operands) => operands.iter().for_each(|o| visit(o, part, users)),
        }
    }
    let mut users = IndexMap::default();
    for (id, part) in parts.enumerate() {
        visit(&part.solid, id, &mut users);
    }
    users
}
