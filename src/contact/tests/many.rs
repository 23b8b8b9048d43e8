//! Larger input: finely facetted balls, many blocks.

use super::*;

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

fn cells(solids: &[Solid]) -> usize {
    try_conform(solids, 4e-9).unwrap().cells.len()
}

#[test]
fn balls_apart_keep_their_facets_and_equal_ones_share_them() {
    let at = |x: f64| ball(24, Vec3::new(x, 0.17, 0.23));
    let alone = at(0.0).facets.len();
    assert_eq!(alone, 2 * 24 * 23);
    assert_eq!(cells(&[at(0.0)]), alone);
    assert_eq!(cells(&[at(0.0), at(3.0)]), 2 * alone);
    assert_eq!(cells(&[block([-9.0; 3], [9.0; 3]), at(0.0), at(3.0)]), 2 * alone + 6);
    assert_eq!(cells(&[at(0.0), at(0.0)]), alone);
    // Where they cross askew is not the business of contact.
    assert_eq!(cells(&[at(0.0), ball(24, Vec3::new(0.41, 0.27, 0.36))]), 2 * alone);
}

#[test]
fn a_grid_of_blocks_has_one_cell_for_every_wall() {
    const N: u32 = 6;
    let corner = |k: u32| [k % N, k / N % N, k / N / N].map(f64::from);
    let grid: Vec<Solid> = (0..N * N * N).map(|k| block(corner(k), corner(k).map(|x| x + 1.0))).collect();
    assert_eq!(cells(&grid), (3 * N * N * (N + 1)) as usize);
}

#[test]
fn turned_cubes_conform_however_they_lie_and_are_cut() {
    const N: u32 = 12;
    let turn = |k: u32| std::f64::consts::FRAC_PI_2 * f64::from(k) / f64::from(N);
    let turned = |k: u32| {
        let turn = Rotation3::from_axis_angle(&nalgebra::Vector3::z_axis(), turn(k));
        moved(&block([-0.5; 3], [0.5; 3]), |p| turn * p)
    };
    let cubes: Vec<Solid> = (0..N).map(turned).collect();
    let oblique: Vec<Solid> = cubes.iter().map(|c| moved(c, |p| rotation(1) * p)).collect();
    let cut: Vec<Solid> = cubes.iter().map(triangulated).collect();
    // The caps of each lie in those of all: the sides of all, and two common caps in pieces.
    let sides = 4 * N as usize;
    assert!(cells(&cubes) > sides);
    assert_eq!(cells(&oblique), cells(&cubes));
    assert!(cells(&cut) > cells(&cubes));
}
