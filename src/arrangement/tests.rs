use super::*;
use crate::contact::conforming::Cell;
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use crate::geom::polygon;
use crate::ids::LeafId;

/// Boxes as leaves over shared bit-equal vertices, quads cut in two.
pub fn boxes(list: &[[[f64; 3]; 2]]) -> Conforming {
    let mut out = Conforming::default();
    for (leaf, [lo, hi]) in list.iter().enumerate() {
        let ids: Vec<u32> = (0..8)
            .map(|k| {
                let pick = |a: usize| if k >> a & 1 == 1 { hi[a] } else { lo[a] };
                let p = Vec3::new(pick(0), pick(1), pick(2));
                let found = out.points.iter().position(|q| *q == p);
                found.unwrap_or_else(|| {
                    out.points.push(p);
                    out.points.len() - 1
                }) as u32
            })
            .collect();
        for (facet, q) in
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]].iter().enumerate()
        {
            let quad = q.map(|k: usize| ids[k]);
            let cell = out.cells.len() as u32;
            let owner = Owner { leaf: LeafId(leaf as u32), facet: facet as u32, is_flipped: false };
            let triangles = polygon::triangulate(&[&quad], &[], &[], &out.points).unwrap();
            let cell = Cell { facet: cell, sheet: cell, is_near: true, fate: Default::default() };
            out.push(cell, &[owner], &triangles);
        }
    }
    let count = out.cells.len() as u32;
    out.pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| [a, b])).filter(|[a, b]| a / 6 != b / 6).collect();
    out
}

fn area(a: &Arrangement) -> f64 {
    let places: Vec<Vec3> = (0..a.points.len() as u32).map(|p| a.points.at(p)).collect();
    (0..a.cells.len()).map(|c| polygon::vector_area(a.cells.loops(c), &places).norm()).sum()
}

/// Directed edges cancel: every piece's boundary is matched within its leaf.
fn assert_closed(a: &Arrangement, leaf: u32) {
    let mut balance = std::collections::BTreeMap::new();
    for c in 0..a.cells.len() {
        let Some(owner) = a.cells.owners_of(c).iter().find(|o| o.leaf.0 == leaf) else { continue };
        for walk in a.cells.loops(c) {
            for k in 0..walk.len() {
                let (p, q) = (walk[k], walk[(k + 1) % walk.len()]);
                let s = if owner.is_flipped { -1 } else { 1 } * if p < q { 1 } else { -1 };
                *balance.entry((p.min(q), p.max(q))).or_insert(0) += s;
            }
        }
    }
    assert!(balance.values().all(|s| *s == 0));
}

#[test]
fn a_box_through_another_cuts_two_square_holes() {
    let input = boxes(&[[[0., 0., 0.], [4., 4., 4.]], [[1., 1., -1.], [3., 3., 5.]]]);
    let a = arrange(&input);
    assert!((area(&a) - (96.0 + 8.0 + 48.0)).abs() < 1e-12);
    assert_closed(&a, 0);
    assert_closed(&a, 1);
}

#[test]
fn overlapping_faces_become_common_pieces() {
    // A smaller box on top of a bigger one: the contact is one square of two owners.
    let input = boxes(&[[[0., 0., 0.], [4., 4., 4.]], [[1., 1., 4.], [3., 3., 5.]]]);
    let a = arrange(&input);
    let common: Vec<usize> = (0..a.cells.len()).filter(|&c| a.cells.owners_of(c).len() == 2).collect();
    let places: Vec<Vec3> = (0..a.points.len() as u32).map(|p| a.points.at(p)).collect();
    let shared: f64 = common.iter().map(|&c| polygon::vector_area(a.cells.loops(c), &places).norm()).sum();
    assert!((shared - 4.0).abs() < 1e-12);
    assert!(common.iter().all(|&c| a.cells.owners_of(c)[0].is_flipped != a.cells.owners_of(c)[1].is_flipped));
    assert_closed(&a, 0);
    assert_closed(&a, 1);
    assert!((area(&a) - (96.0 + 16.0 - 4.0)).abs() < 1e-12);
}

/// Pairs of a wall of an upper box and the cap of the lower one that are settled because the wall rests on the cap's rim.
fn settled(upper: [[f64; 3]; 2]) -> usize {
    let input = boxes(&[[[0., 0., 0.], [4., 4., 4.]], upper]);
    let mesh = graph::Mesh::new(&input);
    let facet = |t: u32| (mesh.owners(t)[0].leaf.0, mesh.owners(t)[0].facet);
    // Contact would make one sheet of the cap and what stands on it.
    let compared: Vec<u32> = mesh.near.iter().copied().filter(|&t| facet(t) != (1, 0)).collect();
    let level = rests::Level::new(&mesh, &compared);
    let item = |t: u32| {
        let bounds = Aabb::around(mesh.triangles[t as usize].map(|v| &input.points[v as usize]));
        level.item(&mesh, t, &bounds)
    };
    let of = |leaf: u32, range: std::ops::Range<u32>| {
        compared.iter().filter(move |&&t| facet(t).0 == leaf && range.contains(&facet(t).1)).map(|&t| item(t))
    };
    of(1, 2..6).flat_map(|wall| of(0, 1..2).map(move |cap| wall.rests(&cap))).filter(|&s| s).count()
}

#[test]
fn a_wall_rests_on_a_rim_and_not_across_it() {
    // Eight triangles of walls and two of the cap.
    assert_eq!(settled([[0., 0., 4.], [4., 4., 6.]]), 16);
    // Corners inside the cap and beyond; a wall that goes through.
    assert_eq!(settled([[1., 1., 4.], [4., 5., 6.]]), 0);
    assert_eq!(settled([[0., 0., 3.], [4., 4., 6.]]), 0);
}

#[test]
fn three_boxes_with_a_common_point_inside() {
    let input = boxes(&[[[0., 0., 0.], [2., 2., 2.]], [[1., 1., 1.], [3., 3., 3.]], [[1., 0., 1.], [3., 2., 3.]]]);
    let a = arrange(&input);
    for leaf in 0..3 {
        assert_closed(&a, leaf);
    }
}
