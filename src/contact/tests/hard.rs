//! Cases that break engines, and refusals.

use super::super::nearly_touching;
use super::*;
use std::f64::consts::{FRAC_PI_2, PI};

fn codes(outcome: Outcome<Conforming>) -> Vec<&'static str> {
    outcome.err().map_or(Vec::new(), |e| e.iter().map(|d| d.code).collect())
}

#[test]
fn stacked_cylinders() {
    for turn in [Rotation3::identity(), rotation(1), rotation(2)] {
        let stack = |n: u32, phase: f64| {
            [prism(16, 1.0, [0.0, 1.0], 0.0, [0.0; 2]), prism(n, 1.0, [1.0, 2.0], phase, [0.0; 2])]
                .map(|s| moved(&s, |p| turn * p))
        };
        let same = checked(&stack(16, 0.0), 1e-9);
        assert_eq!((same.cells.len(), owned_by(&same, 2)), (35, 1));
        let half = checked(&stack(16, PI / 16.0), 1e-9);
        // The caps share a 32-gon; each has 16 corners beyond it.
        assert_eq!((half.cells.len(), owned_by(&half, 2)), (34 + 1 + 32, 1));
        checked(&stack(24, 0.1), 1e-9);
    }
}

#[test]
fn turned_cubes_share_their_caps() {
    for (n, is_cut) in [(5, false), (5, true), (12, true)] {
        let cubes: Vec<Solid> = (0..n)
            .map(|k| {
                let turn = Rotation3::from_axis_angle(&nalgebra::Vector3::z_axis(), FRAC_PI_2 * f64::from(k) / f64::from(n));
                let cube = block([-0.5; 3], [0.5; 3]);
                moved(&if is_cut { triangulated(&cube) } else { cube }, |p| rotation(4) * (turn * p))
            })
            .collect();
        let c = checked(&cubes, 1e-9);
        if !is_cut {
            // Every pair of caps crosses in 8 points; the middle belongs to all.
            assert_eq!(c.points.len(), 8 * n as usize + 2 * 8 * (n * (n - 1) / 2) as usize);
            assert_eq!(owned_by(&c, n as usize), 2);
        }
    }
}

#[test]
fn blocks_on_an_integer_grid() {
    let mut state = 9u64;
    let mut random = |n: u64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) % n) as f64
    };
    for round in 0..20 {
        let blocks: Vec<Solid> = (0..6)
            .map(|_| {
                let lo = [random(4), random(4), random(4)];
                block(lo, [lo[0] + 1.0 + random(2), lo[1] + 1.0 + random(2), lo[2] + 1.0 + random(2)])
            })
            .collect();
        checked(&blocks, 1e-9);
        let turned: Vec<Solid> = blocks.iter().map(|b| moved(b, |p| rotation(round) * p * 0.1)).collect();
        checked(&turned, 1e-10);
    }
}

#[test]
fn a_tilted_facet_touches_only_where_it_is_near() {
    for angle in [1e-3, 1e-5, 1e-7, 1e-8, 1e-10, 1e-13, 1e-15] {
        let tilt = Rotation3::from_axis_angle(&nalgebra::Vector3::x_axis(), angle);
        // Its foot stands on the plate along the axis of the tilt, which is an edge of the foot.
        let foot = moved(&block([0.5, 0.0, 0.0], [1.5, 1.0, 1.0]), |p| tilt * p);
        let c = checked(&[block([0.0, -1.0, -1.0], [2.0, 2.0, 0.0]), foot], 1e-9);
        let is_level = angle < 1e-9;
        assert_eq!(owned_by(&c, 2), usize::from(is_level), "angle {angle}");
    }
}

#[test]
fn chains_are_refused() {
    // Same outline: the third corner is within the tolerance of the second only.
    let tower = |h: f64, side: [f64; 3]| {
        let b = |k: f64, w: f64| block([-w, -w, k * h], [w, w, 1.0 + k]);
        [b(0.0, side[0]), b(1.0, side[1]), b(2.0, side[2])]
    };
    assert!(codes(try_conform(&tower(0.8e-9, [1.0, 1.0, 1.0]), 1e-9)).contains(&"contact-chain"));
    // Other outlines: no corners meet, but the third foot lies on the second, which lies on the first.
    assert!(codes(try_conform(&tower(0.8e-9, [3.0, 2.0, 1.0]), 1e-9)).contains(&"contact-chain"));
    assert!(codes(try_conform(&tower(0.3e-9, [3.0, 2.0, 1.0]), 1e-9)).is_empty());
}

#[test]
fn features_below_the_tolerance_are_refused() {
    assert_eq!(codes(try_conform(&[block([0.0; 3], [1.0, 1.0, 0.5e-9])], 1e-9)), ["feature-below-tolerance"]);
    checked(&[block([0.0; 3], [1.0, 1.0, 1e-6]), block([0.0, 0.0, 1e-6], [1.0, 1.0, 1.0])], 1e-9);
}

#[test]
fn an_import_may_be_coarser() {
    let solids = [block([0.0; 3], [1.0; 3]), block([0.0, 0.0, 1.0 + 1e-7], [1.0, 1.0, 2.0])];
    let shared = |own: &[Option<f64>]| {
        owned_by(&conform(&solids, &[], 1e-9, own, &around(&solids), &|_| Default::default()).unwrap(), 2)
    };
    assert_eq!((shared(&[None, None]), shared(&[None, Some(1e-6)])), (0, 1));
}

#[test]
fn surfaces_moved_by_rounding_are_one() {
    let ball = prism(64, 1.0, [0.0, 1.0], 0.3, [0.1, 0.2]);
    let other = moved(&ball, |p| p * (1.0 + f64::EPSILON));
    let c = checked(&[ball, other], 1e-9);
    assert_eq!((c.cells.len(), owned_by(&c, 2), c.points.len()), (66, 66, 128));
}

#[test]
fn threads_do_not_matter() {
    let cubes: Vec<Solid> = (0..400)
        .map(|k| {
            let at = Vec3::new(f64::from(k % 8), f64::from(k / 8 % 8), f64::from(k / 64));
            moved(&block([0.0; 3], [1.0; 3]), |p| rotation(5) * (p + at))
        })
        .collect();
    let run = |n: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
        pool.install(|| format!("{:?}", try_conform(&cubes, 1e-9).unwrap()))
    };
    assert_eq!(run(1), run(2));
}

#[test]
fn small_gaps_are_told() {
    let (a, b) = (block([0.0; 3], [4.0; 3]), [4.0 + 5e-8, 1.0, 1.0]);
    let gaps = |solids: &[Solid]| nearly_touching(solids, &try_conform(solids, 1e-9).unwrap());
    for turn in [Rotation3::identity(), rotation(2)] {
        let found = gaps(&[a.clone(), block(b, [5.0, 2.0, 2.0])].map(|s| moved(&s, |p| turn * p)));
        assert_eq!((found.len(), found[0].leaves), (1, [LeafId(0), LeafId(1)]));
        assert!((found[0].distance - 5e-8).abs() < 1e-14);
    }
    let crossed = moved(&prism(4, 1.0, [-1.0, 1.0], 0.4, [0.0; 2]), |p| rotation(2) * p + Vec3::new(4.0, 2.0, 2.0));
    for other in [block([4.0, 1.0, 1.0], [5.0; 3]), block([4.0 + 2e-7, 1.0, 1.0], [5.0; 3]), crossed] {
        assert_eq!(gaps(&[a.clone(), other]), []);
    }
    let over_edge = moved(&block([0.0; 3], [1.0; 3]), |p| {
        Rotation3::from_axis_angle(&nalgebra::Vector3::x_axis(), 0.7) * (p - Vec3::new(0.5, 0.0, 0.0))
            + Vec3::new(4.0, 2.0, 4.0 + 2e-8)
    });
    assert!((gaps(&[a, over_edge])[0].distance - 2e-8).abs() < 1e-14);
}
