//! The kernel on many triangles.

use super::model::Brep;
use super::samples::{block, voxels};

/// Triangles of the hull of a plate of n x n cubes.
fn triangles_of_plate(n: usize) -> usize {
    2 * (2 * n * n + 4 * n)
}

#[test]
fn a_plate_of_many_triangles_stays_whole_under_local_operations() {
    let complex = voxels(&block([0, 0, 0], [60, 60, 1], 1), true).complex();
    assert_eq!(complex.facets.len(), triangles_of_plate(60));
    let mut brep = Brep::from_complex(complex).unwrap();
    assert!(brep.topology.check_links().is_empty());
    assert!(brep.topology.count().tally.is_balanced());
    let (mut collapses, mut swaps) = (0, 0);
    for edge in brep.topology.edges().collect::<Vec<_>>() {
        if !brep.topology.has_edge(edge) {
            continue;
        }
        let gone = brep.topology.ends(edge)[0];
        if edge.0 % 4 == 0
            && let Ok(plan) = brep.plan_collapse(edge, gone)
        {
            brep.collapse(&plan);
            collapses += 1;
        } else if let Ok(plan) = brep.plan_swap(edge)
            && plan.opposite.iter().all(|&v| brep.topology.edges_at(v).nth(8).is_none())
        {
            brep.swap(&plan);
            swaps += 1;
        }
    }
    assert!(collapses > 0 && swaps > 0);
    assert!(brep.topology.check_links().is_empty());
    assert!(brep.topology.count().tally.is_balanced());
    assert_eq!(brep.to_complex().facets.len(), brep.topology.counts()[2]);
}
