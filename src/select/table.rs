//! The decision table (thesis Table 2.4) as it follows from the labels.
//!
//! The class of a sub-facet against `A op B` from its classes against A and B. In the thesis a sub-facet lies on one of the
//! two, so only rows and columns with one *on* occur, and its entries read: *retain* where the result is on-shared, *retain +
//! flip* where it is on-anti-shared, *kill* where it is in or out. The full table serves nested trees: a sub-facet of a leaf
//! may be in any relation to both operands of a node.

use crate::classify::Class::{self, In, OnAntiShared as Anti, OnShared as On, Out};
use crate::scene::model::Operation;

/// Row: class against A; column: class against B; both in the order out, on-shared, on-anti-shared, in.
pub type Table = [[Class; 4]; 4];

/// A union B.
pub const UNION: Table = [
    // B:   out   on    anti  in
    [Out, On, Anti, In],  // A out
    [On, On, In, In],     // A on-shared
    [Anti, In, Anti, In], // A on-anti-shared
    [In, In, In, In],     // A in
];

/// A intersection B.
pub const INTERSECTION: Table = [[Out, Out, Out, Out], [Out, On, Out, On], [Out, Out, Anti, Anti], [Out, On, Anti, In]];

/// A minus B.
pub const DIFFERENCE: Table = [[Out, Out, Out, Out], [On, Out, On, Out], [Anti, Anti, Out, Out], [In, Anti, On, Out]];

/// In exactly one of A and B.
pub const XOR: Table = [[Out, On, Anti, In], [On, Out, In, Anti], [Anti, In, Out, On], [In, Anti, On, Out]];

/// The class against `A op B`.
pub fn combine(operation: Operation, a: Class, b: Class) -> Class {
    let table = match operation {
        Operation::Union => &UNION,
        Operation::Intersection => &INTERSECTION,
        Operation::Difference => &DIFFERENCE,
        Operation::Xor => &XOR,
    };
    let place = |c: Class| match c {
        Out => 0,
        On => 1,
        Anti => 2,
        In => 3,
    };
    table[place(a)][place(b)]
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Class; 4] = [Out, On, Anti, In];

    fn holds(operation: Operation, a: bool, b: bool) -> bool {
        match operation {
            Operation::Union => a || b,
            Operation::Intersection => a && b,
            Operation::Difference => a && !b,
            Operation::Xor => a != b,
        }
    }

    #[test]
    fn tables_follow_from_the_labels() {
        for operation in [Operation::Union, Operation::Intersection, Operation::Difference, Operation::Xor] {
            for a in ALL {
                for b in ALL {
                    let [front, back] = [0, 1].map(|k| holds(operation, a.sides()[k], b.sides()[k]));
                    assert_eq!(combine(operation, a, b), Class::new(front, back), "{operation:?} {a:?} {b:?}");
                }
            }
        }
    }

    /// Table 2.4: rows are (class against A, class against B) of a facet on A, then of a facet on B that is not on A.
    #[test]
    fn thesis_table_2_4() {
        let act = |operation, a, b| match combine(operation, a, b) {
            On => "retain",
            Anti => "retain+flip",
            _ => "kill",
        };
        let (minus, union, common) = (Operation::Difference, Operation::Union, Operation::Intersection);
        let rows = [
            (On, In, ["kill", "kill", "retain"]),
            (On, On, ["kill", "retain", "retain"]),
            (On, Anti, ["retain", "kill", "kill"]),
            (On, Out, ["retain", "retain", "kill"]),
            (In, On, ["retain+flip", "kill", "retain"]),
            (Out, On, ["kill", "retain", "kill"]),
        ];
        for (a, b, expected) in rows {
            assert_eq!([minus, union, common].map(|op| act(op, a, b)), expected, "{a:?} {b:?}");
        }
        // Its rows (on-shared, on) and (on-anti-shared, on) kill the second copy of a common facet: here there is only one
        // copy.
    }

    /// Tables 2.2 and 2.3: a facet whose boundary is nowhere *on* has the class of any of its edges and corners, because a
    /// label changes only across the solid. Stated on the two bits: what lies on no wall has equal labels on both sides.
    #[test]
    fn equal_labels_on_both_sides_are_in_or_out() {
        assert_eq!(Class::new(true, true), In);
        assert_eq!(Class::new(false, false), Out);
        for class in ALL {
            assert_eq!(Class::new(class.sides()[0], class.sides()[1]), class);
        }
    }
}
