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
pub struct Decision {
    claims: Claims,
    part_of_label: Vec<Option<PartId>>,
    /// Labels that several parts claim.
    pub overlaps: Vec<Overlap>,
}

impl Decision {
    /// Evaluates every part's tree once per distinct label; the last part that claims it wins.
    pub fn new(scene: &Scene, classified: &Classified) -> Self {
        let claims =
            Claims { trees: scene.parts.iter().map(|p| Tree::new(&p.solid)).collect(), users: users_of_leaves(&scene.parts) };
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
struct Claims {
    trees: IdVec<PartId, Tree>,
    users: IndexMap<u32, Vec<PartId>>,
}

impl Claims {
    /// The parts that claim a place with this label, last in the file first.
    fn of<'b>(&'b self, label: &'b [u32]) -> impl Iterator<Item = PartId> + 'b {
        let mut candidates: Vec<PartId> = label.iter().flat_map(|l| self.users.get(l).into_iter().flatten().copied()).collect();
        candidates.sort_unstable();
        candidates.dedup();
        candidates.into_iter().rev().filter(move |&p| self.trees[p].class_of(label) == Class::In)
    }
}

/// A part's tree, prepared for many labels.
enum Tree {
    Leaf(LeafId),
    Boolean {
        operation: Operation,
        operands: Vec<Tree>,
        /// Leaves, ascending, each with an operand that uses it.
        uses: Vec<(u32, u32)>,
    },
}

impl Tree {
    fn new(node: &Node) -> Self {
        let (operation, nodes) = match node {
            Node::Leaf(leaf) => return Self::Leaf(*leaf),
            Node::Boolean(operation, nodes) => (*operation, nodes),
        };
        let operands: Vec<Self> = nodes.iter().map(Self::new).collect();
        let mut uses: Vec<(u32, u32)> = Vec::new();
        for (operand, k) in operands.iter().zip(0..) {
            match operand {
                Self::Leaf(leaf) => uses.push((leaf.0, k)),
                Self::Boolean { uses: below, .. } => uses.extend(below.iter().map(|u| (u.0, k))),
            }
        }
        uses.sort_unstable();
        uses.dedup();
        Self::Boolean { operation, operands, uses }
    }

    /// The class of a place against a Boolean node, from those against the leaves: folds the decision table over the operands
    /// that use a leaf of the label. A place is outside of the others, which a union of thousands has, and few labels have many
    /// leaves.
    fn class_of(&self, label: &[u32]) -> Class {
        let (operation, operands, uses) = match self {
            Self::Leaf(leaf) => {
                let is_inside = label.binary_search(&leaf.0).is_ok();
                return Class::new(is_inside, is_inside);
            }
            Self::Boolean { operation, operands, uses } => (*operation, operands, uses),
        };
        let users = |leaf: u32| {
            let first = uses.partition_point(|u| u.0 < leaf);
            uses[first..].iter().take_while(move |u| u.0 == leaf).map(|u| u.1)
        };
        let mut present: Vec<u32> = label.iter().copied().flat_map(users).collect();
        present.sort_unstable();
        present.dedup();
        let is_outside = match operation {
            Operation::Union | Operation::Xor => false,
            Operation::Intersection => present.len() < operands.len(),
            Operation::Difference => present.first() != Some(&0),
        };
        let Some((first, rest)) = present.split_first().filter(|_| !is_outside) else { return Class::Out };
        let mut class = operands[*first as usize].class_of(label);
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
            class = combine(operation, class, operands[*operand as usize].class_of(label));
        }
        class
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the definition, on all trees of two levels over three leaves, one of them used twice, and all labels.
    #[test]
    fn classes_follow_from_the_leaves() {
        const ALL: [Operation; 4] = [Operation::Union, Operation::Intersection, Operation::Difference, Operation::Xor];
        let holds = |operation, operands: &[bool]| match operation {
            Operation::Union => operands.contains(&true),
            Operation::Intersection => !operands.contains(&false),
            Operation::Difference => operands[0] && !operands[1..].contains(&true),
            Operation::Xor => operands.iter().filter(|o| **o).count() % 2 == 1,
        };
        let leaf = |k: u32| Node::Leaf(LeafId(k));
        for (outer, inner) in ALL.into_iter().flat_map(|o| ALL.map(|i| (o, i))) {
            for order in [[0, 1, 2], [2, 0, 1], [1, 2, 0]] {
                let below = Node::Boolean(inner, vec![leaf(order[0]), leaf(order[1])]);
                let tree = Tree::new(&Node::Boolean(outer, vec![below, leaf(order[2]), leaf(order[1])]));
                for bits in 0..8u32 {
                    let label: Vec<u32> = (0..3).filter(|k| bits >> k & 1 == 1).collect();
                    let [a, b, c] = order.map(|k| label.contains(&k));
                    let is_inside = holds(outer, &[holds(inner, &[a, b]), c, b]);
                    assert_eq!(tree.class_of(&label), Class::new(is_inside, is_inside), "{outer:?} {inner:?} {label:?}");
                }
            }
        }
        assert_eq!(Tree::new(&Node::Boolean(Operation::Intersection, vec![])).class_of(&[0]), Class::Out);
    }
}
