//! Profiles: an outer chain and holes, oriented and checked.

use super::outline::{Outline, Rule, doubled_area};
use crate::diag::Diagnostic;
use crate::geom::Vec3;
use crate::geom::polygon::{self, PolygonError, vector_area};
use crate::scene::model::Profile;

/// Areas of a polygon and of its triangles agree within this fraction, unless holes lie outside or inside each other.
const SAME_AREA: f64 = 1e-9;

/// Divides a profile: outer chain counter-clockwise, holes clockwise.
///
/// # Errors
/// As [`Outline::new`]; if chains cross or touch once arcs are chords; if a hole is outside.
pub(crate) fn divide(profile: &Profile, rule: &mut Rule) -> Result<Vec<Outline>, Diagnostic> {
    let mut loops = vec![Outline::new(&profile.outer, |k| format!("side{}", k + 1), rule)?];
    for (h, hole) in profile.holes.iter().enumerate() {
        loops.push(Outline::new(hole, |k| format!("hole{}_side{}", h + 1, k + 1), rule)?);
    }
    for (k, outline) in loops.iter_mut().enumerate() {
        if !outline.is_closed {
            return Err(Diagnostic::error("bad-profile", "the profile is not closed").hint("leave out `closed: false`"));
        }
        outline.orient(k == 0);
    }
    check(&loops)?;
    Ok(loops)
}

fn check(loops: &[Outline]) -> Result<(), Diagnostic> {
    let chains: Vec<Vec<[f64; 2]>> = loops.iter().map(Outline::points).collect();
    if let [chain] = &chains[..]
        && is_convex(chain)
    {
        return Ok(());
    }
    let flat = chains.iter().map(|c| c.iter().map(|p| Vec3::new(p[0], p[1], 0.0)).collect()).collect::<Vec<Vec<_>>>();
    check_region(&flat, chains.iter().map(|c| doubled_area(c)).sum::<f64>() * 0.5).map_err(|fault| {
        Diagnostic::error("bad-profile", format!("the profile {fault} when its arcs are divided into chords"))
            .hint("its outer chain and its holes must be simple and must not touch; thin rings need more segments")
    })
}

/// Whether closed chains bound a region of the given area, all on its proper side.
pub(crate) fn check_region(chains: &[Vec<Vec3>], area: f64) -> Result<(), &'static str> {
    let points: Vec<Vec3> = chains.iter().flatten().copied().collect();
    let mut next = 0u32;
    let loops: Vec<Vec<u32>> = chains
        .iter()
        .map(|c| {
            next += c.len() as u32;
            (next - c.len() as u32..next).collect()
        })
        .collect();
    let slices: Vec<&[u32]> = loops.iter().map(Vec::as_slice).collect();
    match polygon::triangulate(&slices, &[], &[], &points) {
        Ok(triangles) => {
            let covered: f64 = triangles.iter().map(|t| vector_area([&t[..]], &points).norm()).sum();
            let is_nested = (covered - area).abs() <= SAME_AREA * covered;
            if is_nested { Ok(()) } else { Err("has a hole outside its outer chain or inside another hole") }
        }
        Err(PolygonError::NotSimple) => Err("crosses or touches itself"),
        Err(PolygonError::Flat) => Err("has no area"),
    }
}

/// Whether a chain turns left at every vertex and once in all: the frequent case, in linear time.
fn is_convex(points: &[[f64; 2]]) -> bool {
    let n = points.len();
    let at = |k: usize| points[k % n];
    let turns_left = (0..n).all(|k| crate::geom::predicates::orient2d(at(k), at(k + 1), at(k + 2)) > 0);
    // A chain that winds twice goes from left to right twice.
    let is_right = |k: usize| (at(k + 1)[0], at(k + 1)[1]) > (at(k)[0], at(k)[1]);
    turns_left && (0..n).filter(|&k| is_right(k) && !is_right(k + 1)).count() == 1
}
