//! Surfaces of several shells: each outermost one is turned outwards with all that lies in it, and what lies in another one has
//! to be its cavity, or a body in the cavity of one, and so on.

use super::Surface;
use super::shells;
use super::sides::Sides;
use crate::diag::Diagnostic;
use crate::geom::aabb::Aabb;
use crate::geom::cast::{CastError, Caster};

/// A part of the surface that bounds one body ([`shells`]).
struct Shell {
    /// Six times the volume that it encloses; negative if it is inside out.
    volume: f64,
    /// One of its triangles.
    triangle: u32,
    /// The shells that it lies in.
    around: Vec<u32>,
}

/// Turns shells so that outermost ones enclose what lies in them. The triangles are those of the polygons, each with its
/// polygon, and meet in whole vertices and edges only. O(n log n), and the depth for each shell.
///
/// # Errors
/// `nested-shells`: one that lies directly in another one is oriented as that one, so that nobody knows what is inside.
pub(super) fn orient(
    surface: &mut Surface,
    sides: &Sides,
    (triangles, polygon_of): (&[[u32; 3]], &[u32]),
    file: &str,
) -> Result<(), Diagnostic> {
    let (shell_of, count) = shells::shells(surface, sides, (triangles, polygon_of));
    let shell_of_triangle: Vec<u32> = polygon_of.iter().map(|&p| shell_of[p as usize]).collect();
    let mut shells: Vec<Shell> = (0..count).map(|_| Shell { volume: 0.0, triangle: u32::MAX, around: Vec::new() }).collect();
    let origin = Aabb::around(&surface.points).center();
    for ((t, &own), k) in triangles.iter().zip(&shell_of_triangle).zip(0u32..) {
        let [a, b, c] = t.map(|v| surface.points[v as usize] - origin);
        let shell = &mut shells[own as usize];
        shell.volume += a.dot(&b.cross(&c));
        shell.triangle = shell.triangle.min(k);
    }
    if count > 1 {
        nest(&mut shells, &shell_of_triangle, &Caster::new(&surface.points, triangles))
            .map_err(|_| Diagnostic::internal("ray", format!("{file}: every ray from a shell meets an edge")))?;
    }
    let is_turned: Vec<bool> = (0..count).map(|k| shells[outermost(&shells, k)].volume < 0.0).collect();
    let is_cavity = |k: usize| (shells[k].volume < 0.0) != is_turned[k];
    if let Some(bad) = (0..count).find(|&k| is_cavity(k) != (shells[k].around.len() % 2 == 1)) {
        let places = triangles[shells[bad].triangle as usize].map(|v| surface.points[v as usize]);
        let message = format!("{file}: a shell lies in another one and is oriented as that one");
        let hint = "turn its facets if it is a cavity; if it is a body, give it a file of its own, or leave it out";
        return Err(Diagnostic::error("nested-shells", message).near(places[0]).hint(hint));
    }
    for (k, &shell) in (0u32..).zip(&shell_of) {
        if is_turned[shell as usize] {
            surface.polygons.of_mut(k).reverse();
        }
    }
    Ok(())
}

/// The shell around a shell that lies in no other; itself if it does not.
fn outermost(shells: &[Shell], own: usize) -> usize {
    shells[own].around.iter().map(|&a| a as usize).find(|&a| shells[a].around.is_empty()).unwrap_or(own)
}

/// Finds the shells around each by a ray.
fn nest(shells: &mut [Shell], shell_of: &[u32], caster: &Caster) -> Result<(), CastError> {
    for (own, shell) in (0u32..).zip(shells) {
        let line = caster.line_through(shell.triangle)?;
        let behind = line.iter().skip_while(|crossing| crossing.triangle != shell.triangle);
        let mut crossed: Vec<u32> = behind.map(|crossing| shell_of[crossing.triangle as usize]).collect();
        crossed.sort_unstable();
        let odd = crossed.chunk_by(|a, b| a == b).filter(|same| same[0] != own && same.len() % 2 == 1);
        shell.around = odd.map(|same| same[0]).collect();
    }
    Ok(())
}
