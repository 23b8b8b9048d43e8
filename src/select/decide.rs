//! Which part claims which volume.

use super::table::combine;
use crate::classify::{Class, Classified};
use crate::contact::conforming::Owner;
use crate::cull::Fate;
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
pub struct Decision<'a> {
    claims: Claims<'a>,
    part_of_label: Vec<Option<PartId>>,
    /// Labels that several parts claim.
    pub overlaps: Vec<Overlap>,
}

impl<'a> Decision<'a> {
    /// Evaluates every part's tree once per distinct label; the last part that claims it wins.
    pub fn new(scene: &'a Scene, classified: &Classified) -> Self {
        let claims = Claims { parts: &scene.parts, users: users_of_leaves(&scene.parts) };
        let (mut part_of_label, mut overlaps) = (Vec::with_capacity(classified.labels.len()), Vec::new());
        for (number, label) in classified.labels.iter().enumerate() {
            let mut claimants = claims.of(label);
            let winner = claimants.next();
            part_of_label.push(winner);
            let loses = |loser| winner.map(|winner| Overlap { loser, winner, label: number as u32 });
            overlaps.extend(claimants.filter_map(loses));
        }
        Self { claims, part_of_label, overlaps }
    }

    /// The parts that claim the volumes in front of a sub-cell and behind it; twice the same where nothing else is known than
    /// that they are.
    pub fn parts_beside(&self, classified: &Classified, cell: usize, fate: Fate) -> [Option<PartId>; 2] {
        match fate {
            Fate::Live => classified.shells[cell].map(|s| self.part_of_label[classified.label_of_shell[s as usize] as usize]),
            Fate::Face(parts) => parts,
            Fate::Hidden | Fate::Copy => [None; 2],
        }
    }

    /// Which of the facets that coincide in a retained sub-cell it is a piece of: the first that makes the difference on its
    /// own, so that a facet is not split where another one that does not matter happens to lie on it.
    pub fn source_of(&self, label_in_front: &[u32], owners: &[Owner]) -> usize {
        let part_in_front = self.claims.of(label_in_front).next();
        let matters = |owner: &Owner| {
            let mut label = label_in_front.to_vec();
            match label.binary_search(&owner.leaf.0) {
                Ok(k) => drop(label.remove(k)),
                Err(k) => label.insert(k, owner.leaf.0),
            }
            self.claims.of(&label).next() != part_in_front
        };
        owners.iter().position(matters).unwrap_or(0)
    }
}

/// Evaluates the parts' trees on labels.
struct Claims<'a> {
    parts: &'a IdVec<PartId, Part>,
    users: IndexMap<u32, Vec<PartId>>,
}

impl Claims<'_> {
    /// The parts that claim a place with this label, last in the file first.
    fn of<'b>(&'b self, label: &'b [u32]) -> impl Iterator<Item = PartId> + 'b {
        let mut candidates: Vec<PartId> = label.iter().flat_map(|l| self.users.get(l).into_iter().flatten().copied()).collect();
        candidates.sort_unstable();
        candidates.dedup();
        let class = |leaf: LeafId| {
            let is_inside = label.binary_search(&leaf.0).is_ok();
            Class::new(is_inside, is_inside)
        };
        candidates.into_iter().rev().filter(move |&p| class_against(&self.parts[p].solid, &class) == Class::In)
    }
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
