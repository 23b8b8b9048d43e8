//! Two blocks in every contact, straight and turned.

use super::*;

const A: [[f64; 3]; 2] = [[0.0; 3], [4.0; 3]];

/// Second block, cells, cells with two owners.
const CONTACTS: [([[f64; 3]; 2], usize, usize); 12] = [
    ([[4., 0., 0.], [8., 4., 4.]], 11, 1),   // full face
    ([[4., 1., 1.], [7., 3., 3.]], 12, 1),   // part of a face: ring and square
    ([[4., -1., -1.], [7., 5., 5.]], 12, 1), // covers the face
    ([[4., 1., -2.], [7., 3., 6.]], 15, 1),  // crossed: two strips on A, two on B
    ([[4., 4., 0.], [8., 8., 4.]], 12, 0),   // along a whole edge
    ([[4., 4., 1.], [8., 8., 3.]], 12, 0),   // along part of an edge
    ([[4., 4., 4.], [8., 8., 8.]], 12, 0),   // at a vertex
    ([[1., 1., 0.], [3., 3., 2.]], 12, 1),   // inside, on a face
    ([[0., 0., 0.], [2., 2., 2.]], 12, 3),   // inside, in a corner
    ([[0., 0., 0.], [4., 4., 4.]], 6, 6),    // equal
    ([[-2., 1., 0.], [6., 3., 4.]], 26, 2),  // through, two faces coplanar: they have 5 cells, 4 walls 3, and 4 are whole
    ([[6., 0., 0.], [8., 4., 4.]], 12, 0),   // apart
];

fn check_all(map: impl Fn(Vec3) -> Vec3, tolerance: f64) {
    for (k, &(b, cells, shared)) in CONTACTS.iter().enumerate() {
        let solids = [block(A[0], A[1]), block(b[0], b[1])].map(|s| moved(&s, &map));
        let c = checked(&solids, tolerance);
        assert_eq!((c.cells.len(), owned_by(&c, 2)), (cells, shared), "contact {k}");
    }
}

#[test]
fn contacts_of_blocks() {
    check_all(|p| p, 1e-9);
}

#[test]
fn contacts_of_turned_blocks() {
    for k in 0..10 {
        let turn = rotation(k);
        check_all(|p| turn * p / 3.0, 1e-9);
    }
}

#[test]
fn contacts_of_blocks_turned_far_away() {
    let turn = rotation(3);
    check_all(|p| turn * p + Vec3::new(7e3, -2e3, 5e3), 7e-9);
}

#[test]
fn contacts_of_triangulated_blocks() {
    for k in 0..4 {
        for (b, ..) in CONTACTS {
            let turn = rotation(k);
            let solids = [block(A[0], A[1]), block(b[0], b[1])].map(|s| moved(&triangulated(&s), |p| turn * p / 3.0));
            checked(&solids, 1e-9);
        }
    }
}

#[test]
fn what_was_written_differently_is_one_place() {
    let c = checked(&[block([0.0; 3], [1.0, 1.0, 0.1 + 0.2]), block([0.0, 0.0, 0.3], [1.0; 3])], 1e-9);
    assert_eq!((c.cells.len(), owned_by(&c, 2), c.points.len()), (11, 1, 12));
}

#[test]
fn a_corner_on_a_wall_is_a_point_of_it() {
    let tilted = moved(&block([0.0; 3], [1.0; 3]), |p| {
        // The body diagonal upwards: corner 0 is the lowest point.
        Rotation3::rotation_between(&Vec3::repeat(1.0), &Vec3::z()).unwrap() * p
    });
    let c = checked(&[block([-2.0, -2.0, -1.0], [2.0, 2.0, 0.0]), tilted], 1e-9);
    assert_eq!((c.cells.len(), c.points.len()), (12, 16));
    let top = c.triangles.iter().filter(|t| t.iter().all(|&v| c.points[v as usize].z == 0.0)).count();
    assert_eq!(top, 4);
}

#[test]
fn a_cylinder_on_a_plate_touches_along_one_edge() {
    for k in 0..6 {
        let turn = rotation(k);
        // Axis along y; the generator at angle -90 degrees lies on the plate, inside it.
        let lying = moved(&prism(12, 1.0, [-1.0, 1.0], 0.0, [0.0, 0.0]), |p| turn * Vec3::new(p.x, p.z, -p.y + 1.0));
        let lying = Solid { facets: flipped(&lying), ..lying };
        let plate = moved(&block([-3.0, -3.0, -1.0], [3.0, 3.0, 0.0]), |p| turn * p);
        let c = checked(&[plate, lying], 1e-9);
        assert_eq!((c.cells.len(), c.points.len()), (6 + 14, 8 + 24));
        let touching: Vec<_> =
            c.triangles.iter().enumerate().filter(|(k, t)| c.cell_of_triangle[*k] < 6 && t.iter().any(|&v| v > 7)).collect();
        assert_eq!(touching.len(), 6, "four corners and two points inside make six triangles");
    }
}

fn flipped(solid: &Solid) -> Facets {
    solid.facets.iter().map(|f| (f.loops.iter().map(|w| w.iter().rev().copied().collect()).collect::<Vec<_>>(), 0)).collect()
}
