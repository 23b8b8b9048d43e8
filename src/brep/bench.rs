//! Cost of the kernel on a million triangles: `cargo test --release --lib brep::bench -- --ignored --nocapture`.

use super::model::Brep;
use super::samples::{block, voxels};
use std::time::Instant;

#[test]
#[ignore = "measures"]
fn a_million_triangles() {
    // The hull of a block of 290 cubes per edge would do, but its inner cubes would not fit: a plate.
    let complex = voxels(&block([0, 0, 0], [498, 498, 1], 1), true).complex();
    let memory = || {
        std::fs::read_to_string("/proc/self/status")
            .unwrap_or_default()
            .lines()
            .find(|l| l.starts_with("VmRSS"))
            .map(str::to_owned)
    };
    let n = complex.facets.len();
    let mut report = vec![format!("{n} triangles, complex: {:?}", memory())];
    let start = Instant::now();
    let mut brep = Brep::from_complex(complex).unwrap();
    report.push(format!("build {:?}, {:?}", start.elapsed(), memory()));
    let start = Instant::now();
    assert!(brep.topology.check_links().is_empty());
    report.push(format!("check links {:?}", start.elapsed()));
    let start = Instant::now();
    assert!(brep.topology.count().tally.is_balanced());
    report.push(format!("count {:?}", start.elapsed()));
    let start = Instant::now();
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
    report.push(format!("{collapses} collapses, {swaps} swaps in {:?}", start.elapsed()));
    let start = Instant::now();
    assert_eq!(brep.to_complex().facets.len(), brep.topology.counts()[2]);
    report.push(format!("back {:?}", start.elapsed()));
    std::fs::write(std::env::temp_dir().join("gsm-brep-bench.txt"), report.join("\n")).unwrap();
}
