//! A point strictly inside every bounded region.
//!
//! From the middle of a large facet triangle, half way along the normal to what lies opposite: in a shell of any thickness that
//! is the middle of the wall, in a ring it cannot be the empty centre. Of a few such points the one with the longest way is
//! taken, and exact ray parity against the region's own facets proves that it is inside.

use crate::brep::complex::Complex;
use crate::diag::Diagnostic;
use crate::geom::Vec3;
use crate::geom::cast::Caster;
use crate::ids::{Id, IdVec, RegionId};
use std::cmp::Reverse;

/// Facet triangles tried per region before the best point is taken. The largest ones lie in the widest places; more of them
/// cost time and gain little.
const CANDIDATES: usize = 16;

/// All triangles of the complex with the regions on their sides.
pub struct Sides<'a> {
    /// Positions.
    pub points: &'a [Vec3],
    /// Corners, counter-clockwise seen from the front.
    pub triangles: &'a [[u32; 3]],
    /// Regions in front and behind.
    pub sides: &'a [[RegionId; 2]],
}

/// For each bounded region a point strictly inside; `None` for the outside.
///
/// # Errors
/// An internal error for a region in which no point was found: its facets do not enclose it.
pub fn find(complex: &Complex, all: &Sides) -> Result<IdVec<RegionId, Option<Vec3>>, Vec<Diagnostic>> {
    let caster = Caster::new(all.points, all.triangles);
    let mut triangles_of: Vec<Vec<(u32, bool)>> = vec![Vec::new(); complex.regions.len()];
    for (t, [front, back]) in all.sides.iter().enumerate() {
        if front != back {
            triangles_of[front.index()].push((t as u32, true));
            triangles_of[back.index()].push((t as u32, false));
        }
    }
    let mut faults = Vec::new();
    let seeds = complex
        .regions
        .enumerate()
        .map(|(region, _)| {
            if region.index() == 0 {
                return None;
            }
            let seed = seed_of(region, std::mem::take(&mut triangles_of[region.index()]), all, &caster);
            if seed.is_none() {
                faults.push(Diagnostic::internal("no-seed", format!("no point was found inside region {}", region.0)));
            }
            seed
        })
        .collect();
    if faults.is_empty() { Ok(seeds) } else { Err(faults) }
}

/// `triangles`: those of the region's boundary, and whether it lies in front of them.
fn seed_of(region: RegionId, triangles: Vec<(u32, bool)>, all: &Sides, caster: &Caster) -> Option<Vec3> {
    let normal = |t: u32| {
        let [a, b, c] = caster.corners(t);
        (b - a).cross(&(c - a))
    };
    let size = |t: u32| Reverse(normal(t).norm_squared().to_bits());
    let mut by_size: Vec<_> = triangles.into_iter().map(|(t, in_front)| (size(t), t, in_front)).collect();
    let few = by_size.len().min(CANDIDATES);
    if few < by_size.len() {
        by_size.select_nth_unstable(few);
    }
    let (largest, others) = by_size.split_at_mut(few);
    // The way through the region from a triangle, if it is longer than the best one so far, and its middle.
    let longer = |best: Option<(f64, Vec3)>, &(_, t, in_front): &(_, u32, bool)| {
        let inwards = normal(t).normalize() * if in_front { 1.0 } else { -1.0 };
        let [a, b, c] = caster.corners(t);
        let center = (a + b + c) / 3.0;
        let way = caster.distance_to_next(&center, &inwards, t, best.map_or(0.0, |b| b.0))?;
        let point = center + inwards * (0.5 * way);
        is_inside(region, &point, all, caster).then_some((way, point))
    };
    largest.sort_unstable();
    let mut best = largest.iter().fold(None, |best, triangle| longer(best, triangle).or(best));
    if best.is_none() {
        others.sort_unstable();
        best = others.iter().find_map(|triangle| longer(None, triangle));
    }
    best.map(|b| b.1)
}

/// Whether a ray from the point to the outside crosses the region's boundary an odd number of times; exact.
fn is_inside(region: RegionId, point: &Vec3, all: &Sides, caster: &Caster) -> bool {
    caster.cast(point).is_ok_and(|crossings| {
        let of_region = |t: u32| {
            let [front, back] = all.sides[t as usize];
            (front == region) != (back == region)
        };
        crossings.iter().filter(|c| of_region(c.triangle)).count() % 2 == 1
    })
}
