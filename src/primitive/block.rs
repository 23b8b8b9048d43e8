//! Solids of planar facets only: blocks and pyramids.

use super::outline::doubled_area;
use super::place::Place;
use super::profile;
use super::shell::Shell;
use super::solid::{Freedom, Shape, Solid};
use crate::diag::Diagnostic;
use crate::geom::{Affine, Vec3};
use crate::scene::model::Frame;

/// Corners of a block by the bits of their number: 1 for x, 2 for y, 4 for z.
const BLOCK_SIDES: [(&str, [u32; 4]); 6] = [
    ("x-", [0, 4, 6, 2]),
    ("x+", [1, 3, 7, 5]),
    ("y-", [0, 1, 5, 4]),
    ("y+", [2, 6, 7, 3]),
    ("z-", [0, 2, 3, 1]),
    ("z+", [4, 5, 7, 6]),
];

/// Six quadrilaterals.
pub(crate) fn block(lo: &Vec3, hi: &Vec3, transform: &Affine) -> Solid {
    let place = Place::of_axes(transform);
    let mut shell = Shell::new(place.is_mirrored());
    for corner in 0..8 {
        let pick = |axis: usize| if corner >> axis & 1 == 0 { lo[axis] } else { hi[axis] };
        shell.vertex(place.point(pick(0), pick(1), pick(2)), Freedom::Fixed);
    }
    for (side, corners) in BLOCK_SIDES {
        let surface = shell.surface(side, Shape::Plane);
        shell.facet(surface, vec![corners.to_vec()]);
    }
    shell.finish()
}

/// A polygon and one triangle for each of its edges.
///
/// # Errors
/// If the polygon is not simple or the apex lies in its plane.
pub(crate) fn pyramid(frame: &Frame, base: &[[f64; 2]], apex: &Vec3, transform: &Affine) -> Result<Solid, Diagnostic> {
    let place = Place::new(frame, transform);
    let area = doubled_area(base) * 0.5;
    let mut chain: Vec<Vec3> = base.iter().map(|p| Vec3::new(p[0], p[1], 0.0)).collect();
    if area < 0.0 {
        chain.reverse();
    }
    profile::check_region(&[chain], area.abs()).map_err(|fault| {
        Diagnostic::error("bad-profile", format!("the pyramid's base {fault}")).hint("list its points in order around it")
    })?;
    if apex.z == 0.0 {
        let fault = Diagnostic::error("bad-profile", "the pyramid's apex lies in the plane of its base");
        return Err(fault.hint("give it a height"));
    }
    // Given clockwise from above, or seen from below, the base faces the other way.
    let is_turned = (area < 0.0) != (apex.z < 0.0);
    let mut shell = Shell::new(place.is_mirrored() != is_turned);
    let corners: Vec<u32> = base.iter().map(|p| shell.vertex(place.point(p[0], p[1], 0.0), Freedom::Fixed)).collect();
    let top = shell.vertex(place.point(apex.x, apex.y, apex.z), Freedom::Fixed);
    let bottom = shell.surface("bottom", Shape::Plane);
    shell.facet(bottom, vec![corners.iter().rev().copied().collect()]);
    for k in 0..corners.len() {
        let side = shell.surface(&format!("side{}", k + 1), Shape::Plane);
        shell.facet(side, vec![vec![corners[k], corners[(k + 1) % corners.len()], top]]);
    }
    Ok(shell.finish())
}
