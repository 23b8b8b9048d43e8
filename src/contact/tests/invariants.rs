//! What the step promises, by brute force.

use super::super::crossings::onto_line;
use super::*;
use std::collections::{BTreeMap, BTreeSet};

type Edges = BTreeMap<(u32, u32), i32>;

fn add(edges: &mut Edges, [a, b]: [u32; 2], turn: i32) {
    let sign = if a < b { turn } else { -turn };
    *edges.entry((a.min(b), a.max(b))).or_insert(0) += sign;
}

fn sides(walk: &[u32]) -> impl Iterator<Item = [u32; 2]> + '_ {
    (0..walk.len()).map(|k| [walk[k], walk[(k + 1) % walk.len()]])
}

/// Leaves closed over the rims of cells, triangles tile cells, and nothing within the tolerance is unconnected.
pub fn check(solids: &[Solid], c: &Conforming) {
    let mut leaves: Vec<Edges> = vec![Edges::new(); solids.len()];
    let rims = rims(c);
    for (k, rim) in rims.iter().enumerate() {
        let owners = c.owners_of(k as u32);
        assert!(!owners[0].is_flipped && owners.is_sorted());
        assert!(!rim.is_empty() && rim.values().all(|n| n.abs() == 1), "triangles do not tile a cell");
        for (&(a, b), &turn) in rim {
            for owner in owners {
                add(&mut leaves[owner.leaf.0 as usize], [a, b], if owner.is_flipped { -turn } else { turn });
            }
        }
    }
    assert!(leaves.iter().all(|e| e.values().all(|&n| n == 0)), "a leaf is open");
    nothing_is_near(c);
}

/// The edges of every cell's triangles that are not inside it.
fn rims(c: &Conforming) -> Vec<Edges> {
    let mut rims: Vec<Edges> = vec![Edges::new(); c.cells.len()];
    let mut is_used = BTreeSet::new();
    for (t, &cell) in c.triangles.iter().zip(&c.cell_of_triangle) {
        for side in sides(t) {
            assert!(is_used.insert((cell, side)), "triangles of a cell overlap");
            add(&mut rims[cell as usize], side, 1);
        }
    }
    rims.iter_mut().for_each(|rim| rim.retain(|_, n| *n != 0));
    rims
}

/// No point within the tolerance of a triangle or edge that does not have it, no edges that come within it elsewhere, no
/// overlap of cells.
fn nothing_is_near(c: &Conforming) {
    let at = |v: u32| c.points[v as usize];
    let used: BTreeSet<u32> = c.triangles.iter().flatten().copied().collect();
    let edges: BTreeSet<[u32; 2]> = rims(c).iter().flat_map(|rim| rim.keys().map(|&(a, b)| [a, b])).collect();
    for &[a, b] in &edges {
        for &v in used.iter().filter(|v| ![a, b].contains(v)) {
            let (s, distance) = onto_line(&[at(a), at(b)], &at(v));
            assert!(distance > c.tolerance || !(0.0..=1.0).contains(&s), "{v} lies on edge {a}-{b} at {}", at(v));
        }
        for &[p, q] in edges.iter().filter(|e| **e > [a, b] && !e.contains(&a) && !e.contains(&b)) {
            let (d, e) = (at(b) - at(a), at(q) - at(p));
            let n = d.cross(&e);
            if n.norm() > 1e-6 * d.norm() * e.norm() {
                let between = at(p) - at(a);
                let (s, t) = (between.cross(&e).dot(&n) / n.norm_squared(), between.cross(&d).dot(&n) / n.norm_squared());
                let cross = s > 0.0 && s < 1.0 && t > 0.0 && t < 1.0;
                assert!(!cross || between.dot(&n).abs() > c.tolerance * n.norm(), "edges {a}-{b} and {p}-{q} cross");
            }
        }
    }
    let inside = |t: &[u32; 3], x: &Vec3| {
        let [p, q, r] = t.map(at);
        let n = (q - p).cross(&(r - p));
        let turns = [(p, q), (q, r), (r, p)].map(|(a, b)| (b - a).cross(&(x - a)).dot(&n) / n.norm() / (b - a).norm());
        (x - p).dot(&n).abs() <= c.tolerance * n.norm() && turns.iter().all(|&d| d > c.tolerance)
    };
    for (k, t) in c.triangles.iter().enumerate() {
        for &v in &used {
            assert!(t.contains(&v) || !inside(t, &at(v)), "{v} lies on triangle {t:?} at {}", at(v));
        }
        for (m, other) in c.triangles.iter().enumerate().filter(|(m, _)| c.cell_of_triangle[*m] != c.cell_of_triangle[k]) {
            let center = other.iter().map(|&v| at(v)).sum::<Vec3>() / 3.0;
            let n = |t: &[u32; 3]| (at(t[1]) - at(t[0])).cross(&(at(t[2]) - at(t[0]))).normalize();
            let is_parallel = n(t).cross(&n(other)).norm() < 1e-6;
            assert!(!is_parallel || !inside(t, &center), "cells of triangles {k} and {m} overlap");
        }
    }
}
