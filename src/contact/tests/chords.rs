//! Where facets cross between common points.

use super::*;
use crate::arrangement::arrange;

/// Points that are left to the exact arrangement.
fn implicit_points(solids: &[Solid]) -> u64 {
    arrange(&checked(solids, 1e-9)).statistics.intersection_points
}

fn turned(solid: &Solid, angle: f64) -> Solid {
    let turn = Rotation3::from_axis_angle(&nalgebra::Vector3::z_axis(), angle);
    moved(solid, |p| turn * p)
}

#[test]
fn turned_cubes_cross_in_common_edges() {
    for k in 0..8 {
        let cubes: Vec<Solid> =
            [0.0, 0.3, 0.7, 1.1].map(|a| moved(&turned(&block([-0.5; 3], [0.5; 3]), a), |p| rotation(k) * p)).to_vec();
        assert_eq!(implicit_points(&cubes[..2]), 0);
        assert_eq!(implicit_points(&cubes), 0);
        let cut: Vec<Solid> = cubes.iter().map(triangulated).collect();
        assert_eq!(implicit_points(&cut[..2]), 0, "triangles, {k}");
        assert_eq!(implicit_points(&cut), 0, "triangles, {k}");
    }
}

#[test]
fn prisms_along_one_axis_cross_in_common_edges() {
    // A star is not convex: chords of its caps run outside.
    let mut star = prism(10, 1.0, [0.0, 1.0], 0.2, [0.0; 2]);
    star.vertices.iter_mut().step_by(2).for_each(|v| (v.point.x, v.point.y) = (v.point.x * 0.4, v.point.y * 0.4));
    for k in 0..8 {
        let other = [prism(7, 0.8, [0.0, 1.0], 0.1, [0.5, 0.1]), prism(3, 1.5, [0.0, 1.0], 0.5, [-0.3, 0.2])];
        let all = [star.clone(), other[0].clone(), other[1].clone()].map(|s| moved(&s, |p| rotation(k) * p));
        assert_eq!(implicit_points(&all[1..]), 0, "convex, {k}");
        assert_eq!(implicit_points(&all), 0, "star, {k}");
    }
}

#[test]
fn two_walls_are_cut_along_their_common_edge() {
    // A cross of two bars of one height: every bar has two walls, cut twice each, and caps of three pieces that share one.
    for k in 0..4 {
        let bars = [block([-3.0, -1.0, 0.0], [3.0, 1.0, 1.0]), block([-1.0, -3.0, 0.0], [1.0, 3.0, 1.0])];
        let c = checked(&bars.map(|s| moved(&s, |p| rotation(k) * p)), 1e-9);
        assert_eq!((c.points.len(), c.cells.len(), owned_by(&c, 2)), (16 + 8, 4 * 3 + 4 + 2 * 5, 2));
    }
}

#[test]
fn cylinders_across_each_other_are_left_alone() {
    let upright = prism(24, 1.0, [-3.0, 3.0], 0.1, [0.0; 2]);
    let lying = moved(&prism(20, 0.7, [-3.0, 3.0], 0.05, [0.0; 2]), |p| Vec3::new(p.z, p.x, p.y));
    let c = checked(&[upright, lying], 1e-9);
    assert_eq!((c.points.len(), c.cells.len(), owned_by(&c, 1)), (48 + 40, 26 + 22, 48));
}
