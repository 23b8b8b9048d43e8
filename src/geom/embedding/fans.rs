//! Triangles around vertices that very many share: their boxes all overlap there, but few pairs can meet anywhere else.

use super::Projection;
use super::bundles::{Bundles, Thing};
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use std::ops::ControlFlow;

/// Triangles at a vertex from which on it costs less to sort them than to look at all pairs.
const MANY: u32 = 128;

/// Triangles in fans.
pub(super) struct Fans {
    /// Their numbers, ascending.
    pub triangles: Vec<u32>,
    bundles: Bundles,
}

/// The triangles with area that are in no fan, ascending, and those in fans.
pub(super) fn split(points: &[Vec3], triangles: &[[u32; 3]], projections: &[Option<Projection>]) -> (Vec<u32>, Fans) {
    let mut degree = vec![0u32; points.len()];
    for &v in triangles.iter().flatten() {
        degree[v as usize] += 1;
    }
    let has_area = (0..triangles.len() as u32).filter(|&t| projections[t as usize].is_some());
    let is_in_fan = |t: &u32| triangles[*t as usize].iter().any(|&v| degree[v as usize] >= MANY);
    let (fans, plain): (Vec<u32>, Vec<u32>) = has_area.partition(is_in_fan);
    let thing = |&t: &u32| {
        let corners = triangles[t as usize];
        let hub = corners.into_iter().fold(corners[0], |h, v| if degree[v as usize] > degree[h as usize] { v } else { h });
        let others = corners.iter().filter(|&&v| v != hub).map(|&v| &points[v as usize]);
        Thing { ends: [Aabb::around([&points[hub as usize]]), Aabb::around(others)], hub: Some(hub) }
    };
    let things: Vec<Thing> = fans.iter().map(thing).collect();
    (plain, Fans { triangles: fans, bundles: Bundles::new(&things) })
}

impl Fans {
    /// Visits every pair of them that may meet elsewhere than in a common vertex, once, until the visitor breaks off.
    pub fn pairs(&self, mut visit: impl FnMut(u32, u32) -> ControlFlow<()>) {
        self.bundles.pairs(|s, t| visit(self.triangles[s as usize], self.triangles[t as usize]));
    }
}
