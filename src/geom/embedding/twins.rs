//! Which triangle lies beyond each side of a triangle.

use crate::geom::lists::Lists;

/// No triangle, or several.
pub(super) const NONE: u32 = u32::MAX;

/// Lists up to this length are searched from end to end; longer ones are sorted.
const SHORT: usize = 8;

/// For every side of every triangle (three times the triangle plus the corner where the side begins) the one side that has the
/// same ends in the other order; [`NONE`] where there is none, or the edge has further sides. O(n log n).
pub(super) fn twins(vertices: usize, triangles: &[[u32; 3]]) -> Vec<u32> {
    let sides = || triangles.iter().enumerate().flat_map(|(t, c)| (0..3).map(move |k| (3 * t + k, [c[k], c[(k + 1) % 3]])));
    let rising = || sides().filter(|(_, [a, b])| a < b).map(|(side, [a, b])| (a, (b, side as u32)));
    let mut at_lower = Lists::from_iter(vertices, rising());
    for v in 0..vertices as u32 {
        let list = at_lower.of_mut(v);
        if list.len() > SHORT {
            list.sort_unstable();
        }
    }
    let mut twins = vec![NONE; 3 * triangles.len()];
    let mut is_crowded = Vec::new();
    for (side, [a, b]) in sides().filter(|(_, [a, b])| a >= b) {
        let list = at_lower.of(b);
        let from = if list.len() > SHORT { list.partition_point(|s| s.0 < a) } else { 0 };
        let mut same = list[from..].iter().take_while(|s| list.len() <= SHORT || s.0 == a).filter(|s| s.0 == a);
        match (same.next(), same.next()) {
            (Some(&(_, other)), None) if twins[other as usize] == NONE => {
                twins[other as usize] = side as u32;
                twins[side] = other;
            }
            (Some(&(_, other)), None) => is_crowded.push(other),
            _ => {}
        }
    }
    for side in is_crowded {
        let other = std::mem::replace(&mut twins[side as usize], NONE);
        if other != NONE {
            twins[other as usize] = NONE;
        }
    }
    twins
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_find_each_other_and_crowds_do_not() {
        // A tetrahedron; a fin at one of its edges; a triangle that agrees with none in orientation.
        let tetrahedron = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        let found = twins(4, &tetrahedron);
        assert!(found.iter().enumerate().all(|(side, &t)| t != NONE && found[t as usize] == side as u32));
        assert_eq!(found[3], 2);
        for fin in [[0, 1, 4], [1, 0, 4]] {
            let found = twins(5, &[&tetrahedron[..], &[fin]].concat());
            assert_eq!(found.iter().filter(|t| **t == NONE).count(), 5, "{fin:?}");
            assert_eq!([found[2], found[3]], [NONE, NONE]);
        }
        assert_eq!(twins(4, &[[0, 1, 2], [0, 1, 3]]), [NONE; 6]);
    }

    #[test]
    fn many_sides_at_one_vertex() {
        let fan: Vec<[u32; 3]> = (0..100).map(|k| [0, 1 + k, 1 + (k + 1) % 100]).collect();
        let found = twins(101, &fan);
        assert!((0..100).all(|k| found[3 * k + 2] == 3 * ((k as u32 + 1) % 100) && found[3 * k + 1] == NONE));
    }
}
