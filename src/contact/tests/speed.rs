//! Times on large input, by hand: `cargo test --release --lib contact::tests::speed -- --ignored --nocapture`.

use super::*;
use std::time::Instant;

/// A finely facetted ball: rings of quadrilaterals and caps of triangles.
fn ball(n: u32, center: Vec3) -> Solid {
    let at = |i: u32, j: u32| {
        let (s, c) = libm::sincos(std::f64::consts::PI * f64::from(i) / f64::from(n));
        let (t, d) = libm::sincos(std::f64::consts::TAU * f64::from(j) / f64::from(n));
        center + Vec3::new(s * d, s * t, -c)
    };
    let id = |i: u32, j: u32| {
        if i == 0 {
            0
        } else if i == n {
            1
        } else {
            2 + (i - 1) * n + j % n
        }
    };
    let mut vertices = vec![at(0, 0), at(n, 0)];
    vertices.extend((1..n).flat_map(|i| (0..n).map(move |j| at(i, j))));
    let mut facets = Vec::new();
    for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
        let [a, b, c, d] = [id(i, j), id(i, j + 1), id(i + 1, j + 1), id(i + 1, j)];
        facets.extend(
            [[a, b, c], [a, c, d]].into_iter().filter(|t| t[0] != t[1] && t[1] != t[2] && t[0] != t[2]).map(|t| t.to_vec()),
        );
    }
    solid(vertices, facets)
}

#[allow(clippy::print_stdout)]
fn report(name: &str, solids: &[Solid]) {
    let facets: usize = solids.iter().map(|s| s.facets.len()).sum();
    let size = 1e-9 * 4.0;
    let start = Instant::now();
    let c = try_conform(solids, size).unwrap_or_else(|e| panic!("{name}: {e:?}"));
    println!("{name}: {facets} facets, {} cells, {} points, {:?}", c.cells.len(), c.points.len(), start.elapsed());
}

#[test]
#[ignore = "measures"]
fn times() {
    let at = |x: f64| Vec3::new(x, 0.17, 0.23);
    report("ball", &[ball(175, at(0.0))]);
    report("two balls apart", &[ball(125, at(0.0)), ball(125, at(3.0))]);
    report("two balls apart in a box", &[block([-9.0; 3], [9.0; 3]), ball(125, at(0.0)), ball(125, at(3.0))]);
    report("two balls crossing", &[ball(224, at(0.0)), ball(224, at(0.4))]);
    report("two equal balls", &[ball(224, at(0.0)), ball(224, at(0.0))]);
    for n in [50, 200] {
        let cube = |k: u32| {
            let turn = Rotation3::from_axis_angle(
                &nalgebra::Vector3::z_axis(),
                std::f64::consts::FRAC_PI_2 * f64::from(k) / f64::from(n),
            );
            moved(&block([-0.5; 3], [0.5; 3]), |p| turn * p)
        };
        let cubes: Vec<Solid> = (0..n).map(cube).collect();
        report("turned cubes", &cubes);
        report("turned cubes, triangulated", &cubes.iter().map(triangulated).collect::<Vec<_>>());
        let tilted: Vec<Solid> = cubes.iter().map(|c| moved(c, |p| rotation(1) * p)).collect();
        report("turned cubes, oblique", &tilted);
    }
    let grid: Vec<Solid> = (0..1000)
        .map(|k| {
            let p = [f64::from(k % 10), f64::from(k / 10 % 10), f64::from(k / 100)];
            block(p, p.map(|x| x + 1.0))
        })
        .collect();
    report("grid of blocks", &grid);
}
