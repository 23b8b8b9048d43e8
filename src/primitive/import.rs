//! Imported surfaces: what a file gives becomes a closed, oriented [`Solid`], or an error that says where it is not.
//!
//! Steps: points of equal coordinates become one, those within its tolerance too (of STL by default), unless the surface is
//! closed without that and a shell would collapse or touch itself ([`weld`]); polygons that collapse vanish, those without area
//! become a part of a neighbour ([`flat`]); polygons that are not planar or not simple become triangles; every directed edge
//! must be matched; shells that are inside out are turned ([`nesting`]); pieces of one plane become one polygon ([`flats`]).
//! Edges with several matched uses (two cubes that touch) are allowed.

mod flat;
mod flats;
mod nesting;
mod shells;
mod sides;
mod weld;

use super::division::MAX_FACETS;
use super::place::Place;
use super::solid::{Facets, Freedom, Shape, Solid, SolidSurface, SolidVertex};
use crate::diag::{Diagnostic, short};
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use crate::geom::embedding;
use crate::geom::lists::Lists;
use crate::geom::polygon::{triangulate, vector_area};
use crate::io::{self, SurfaceFormat};
use crate::scene::model::Leaf;
use sides::Sides;
use std::path::Path;

/// Welding distance of STL files, as a fraction of their size: their numbers are single precision.
const STL_TOLERANCE: f64 = 1e-6;
/// A polygon is planar if its vertices lie this near its plane, as a fraction of the surface's size: 4 units in the last place.
const FLAT: f64 = 4.0 * f64::EPSILON;
/// Edges at which facets turn by more are features (cosine of 40 degrees): coarser curved imports hardly exist.
const FEATURE_COSINE: f64 = 0.766;
/// Largest coordinate and smallest size of a file, in the scene's unit: what is written in scenes has narrower limits, but
/// files with 3.4e38, the largest single number, exist and can be computed with. Beyond these, products of seven coordinates,
/// of which a point of three planes is made, leave the range of floats.
const LARGEST: f64 = 1e40;
const SMALLEST: f64 = 1e-30;
/// What to do about an open surface in general.
const OPEN: &str = "close its holes, or give the import a tolerance that welds its points";
/// Places listed in a message.
const LISTED: usize = 5;

/// Polygons over welded points, with their groups.
struct Surface {
    points: Vec<Vec3>,
    polygons: Lists,
    group_of: Vec<u32>,
}

/// Reads and checks the surface of a leaf.
///
/// # Errors
/// `malformed-file` and its like from reading; `open-surface`; `flat-facet`; `self-intersection`; `nested-shells`; `no-volume`;
/// `no-facets`; `too-many-facets`; `out-of-range`.
pub(crate) fn import(leaf: &Leaf, path: &Path, scale: f64) -> Result<Solid, Diagnostic> {
    let mesh = io::read_surface(path)?;
    let file = path.display().to_string();
    if mesh.polygons.is_empty() {
        let fault = Diagnostic::error("no-facets", format!("{file}: the file has no facets"));
        let kind = SurfaceFormat::of(path).map_or("a surface", SurfaceFormat::told);
        return Err(fault.hint(format!("is it really {kind}? Export the surface again, as polygons or triangles")));
    }
    if mesh.polygons.count() > MAX_FACETS {
        let message = format!("{file}: {} facets are more than {MAX_FACETS}", mesh.polygons.count());
        return Err(Diagnostic::error("too-many-facets", message).hint("reduce it before it is imported"));
    }
    let place = Place::of_axes(&leaf.transform);
    let at = |p: &[f64; 3]| place.point(p[0] * scale, p[1] * scale, p[2] * scale);
    let points: Vec<Vec3> = mesh.points.iter().map(at).collect();
    if let Some(p) = points.iter().find(|p| !p.iter().all(|x| x.abs() <= LARGEST)) {
        let message =
            format!("{file}: a point lies {} from the origin; coordinates go up to {LARGEST:e} units", short(p.amax()));
        return Err(Diagnostic::error("out-of-range", message).hint("check the file, and `unit` and `scale` of the import"));
    }
    let extent = Aabb::around(&points).diagonal();
    if extent < SMALLEST {
        let message = format!("{file}: the surface has a size of {}; sizes go from {SMALLEST:e} units", short(extent));
        return Err(Diagnostic::error("out-of-range", message).hint("check the file, and `unit` and `scale` of the import"));
    }
    let tolerance = leaf.tolerance.unwrap_or(match SurfaceFormat::of(path) {
        Some(SurfaceFormat::Stl) => STL_TOLERANCE,
        _ => 0.0,
    });
    let exact = weld::identified(&mesh, &points);
    let mut groups = mesh.groups;
    // The name of the only solid of an STL file is that of the body, not of a side of it.
    if let ([only], Some(SurfaceFormat::Stl)) = (&mut groups[..], SurfaceFormat::of(path)) {
        *only = "surface".into();
    }
    // Their memory serves what follows.
    drop((mesh.points, mesh.polygons, mesh.group_of, points));
    let closed = |surface| closed(surface, place.is_mirrored(), &file);
    let merged = (tolerance > 0.0).then(|| weld::merged(&exact, tolerance)).flatten();
    let (surface, sides) = match merged {
        None => closed(exact),
        // The file needs it: its points were rounded one by one.
        Some(merged) if exact.is_open() => closed(merged.surface).map_err(|fault| told_of_merging(fault, tolerance * extent)),
        Some(merged) if merged.lost_a_shell(&exact) => closed(exact),
        // A foil whose sides became one, or a gap that vanished: then what the file says is meant.
        Some(merged) => closed(merged.surface).or_else(|_| closed(exact)),
    }?;
    let freedoms = freedoms(&surface, &sides);
    // Other diagonals of facets that are planar to rounding only may meet what the first ones miss.
    let is_sound = |facets: &Facets| check_embedded(&surface.points, &triangles_of(facets, &surface.points), &file).is_ok();
    let facets = flats::join(&surface, &sides, surface.flatness()).filter(is_sound).unwrap_or_else(|| surface.facets());
    Ok(finish(&surface.points, facets, &freedoms, groups))
}

/// The surface as it bounds a solid, with the edges of its polygons; `is_mirrored` turns all of them.
fn closed(mut surface: Surface, is_mirrored: bool, file: &str) -> Result<(Surface, Sides), Diagnostic> {
    flat::absorb(&mut surface);
    // All points became one: a far one makes the tolerance large.
    if surface.polygons.count() == 0 {
        return Err(without_volume(file));
    }
    split_bent(&mut surface, file)?;
    let sides = Sides::new(&surface);
    check_closed(&surface, &sides, file)?;
    if is_mirrored {
        surface.turn();
    }
    let (triangles, polygon_of) = surface.triangles();
    let is_flat = surface.volume() == 0.0;
    check_embedded(&surface.points, &triangles, file).map_err(|fault| if is_flat { without_volume(file) } else { fault })?;
    nesting::orient(&mut surface, &sides, (&triangles, &polygon_of), file)?;
    Ok((surface, sides))
}

/// What is wrong with a surface that is closed only after points within `reach` became one, which may be why.
fn told_of_merging(fault: Diagnostic, reach: f64) -> Diagnostic {
    if fault.code == "open-surface" {
        return fault;
    }
    let reach = short(reach);
    fault.hint(format!(
        "points within {reach} units became one, as it is not closed without: try a smaller `tolerance` of the import"
    ))
}

fn without_volume(file: &str) -> Diagnostic {
    Diagnostic::error("no-volume", format!("{file}: the surface encloses no volume"))
        .hint("it is flat, or its facets lie twice over each other: export the solid again")
}

/// Refuses surfaces that cross or touch themselves outside shared vertices and edges.
fn check_embedded(points: &[Vec3], triangles: &[[u32; 3]], file: &str) -> Result<(), Diagnostic> {
    let found = embedding::violations(points, triangles, LISTED);
    if found.is_empty() {
        return Ok(());
    }
    let fault = Diagnostic::error("self-intersection", format!("{file}: the surface crosses or touches itself"))
        .hint("repair it, or split it into several solids and unite them");
    Err(found.iter().fold(fault, |d, v| d.near(v.point)))
}

impl Surface {
    fn turn(&mut self) {
        (0..self.polygons.count() as u32).for_each(|k| self.polygons.of_mut(k).reverse());
    }

    fn is_open(&self) -> bool {
        Sides::new(self).edges().any(|e| sides::is_open(&e))
    }

    /// The polygons as triangles, and the polygon of each.
    fn triangles(&self) -> (Vec<[u32; 3]>, Vec<u32>) {
        let mut triangles = Vec::with_capacity(self.polygons.items().len());
        let mut polygon_of = Vec::with_capacity(self.polygons.items().len());
        for (walk, polygon) in self.polygons.iter().zip(0u32..) {
            match walk {
                &[a, b, c] => triangles.push([a, b, c]),
                // Simple: checked by `split_bent`.
                _ => triangles.extend(triangulate(&[walk], &[], &[], &self.points).unwrap_or_default()),
            }
            polygon_of.resize(triangles.len(), polygon);
        }
        (triangles, polygon_of)
    }

    /// The polygons as facets, each on the surface of its group.
    fn facets(&self) -> Facets {
        let mut facets = Facets::default();
        self.polygons.iter().zip(&self.group_of).for_each(|(walk, &group)| facets.push([walk.iter().copied()], group));
        facets
    }

    fn volume(&self) -> f64 {
        let origin = Aabb::around(&self.points).center();
        let fan = |walk: &[u32]| {
            let p = |k: usize| self.points[walk[k] as usize] - origin;
            (2..walk.len()).map(|k| p(0).dot(&p(k - 1).cross(&p(k)))).sum::<f64>()
        };
        self.polygons.iter().map(fan).sum::<f64>() / 6.0
    }

    /// Distance from a plane that is rounding.
    fn flatness(&self) -> f64 {
        FLAT * self.points.iter().map(|p| p.amax()).fold(0.0, f64::max)
    }
}

fn check_closed(surface: &Surface, sides: &Sides, file: &str) -> Result<(), Diagnostic> {
    let open: Vec<sides::Edge> = sides.edges().filter(sides::is_open).collect();
    if open.is_empty() {
        return Ok(());
    }
    let is_twisted = open.iter().all(|e| e.1.len() % 2 == 0);
    let is_doubled = open.iter().all(|e| e.1.len() > 2);
    let (message, hint) = if is_doubled {
        ("more than two facets meet, and they do not match,", "facets are there twice, or inner walls are left: remove them")
    } else if is_twisted {
        ("facets of opposite orientation meet", "orient all facets outwards")
    } else {
        ("the surface is not closed", OPEN)
    };
    let is_near = || weld::merged(surface, STL_TOLERANCE).is_some_and(|merged| !merged.surface.is_open());
    let hint = match hint == OPEN && is_near() {
        true => format!(
            "give the import `tolerance: {STL_TOLERANCE:e}`: points nearer than that are not the same, and it is then closed"
        ),
        false => hint.to_owned(),
    };
    let message = format!("{file}: {message} at {} edges", open.len());
    let places = open.iter().take(LISTED).map(|e| (surface.points[e.0[0] as usize] + surface.points[e.0[1] as usize]) * 0.5);
    let fault = Diagnostic::error("open-surface", message).hint(hint);
    Err(places.fold(fault, |d, p| d.near(p)))
}

/// Cuts polygons into triangles that are not planar to rounding, not simple, or visit a vertex twice.
fn split_bent(surface: &mut Surface, file: &str) -> Result<(), Diagnostic> {
    let (points, flat) = (&surface.points, surface.flatness());
    let is_clear = |walk: &[u32], area: &Vec3| walk.len() == 3 && *area != Vec3::zeros();
    if surface.polygons.iter().all(|walk| is_clear(walk, &vector_area([walk], points))) {
        return Ok(());
    }
    let (mut polygons, mut group_of) = (Lists::default(), Vec::with_capacity(surface.group_of.len()));
    for (walk, &group) in surface.polygons.iter().zip(&surface.group_of) {
        let area = vector_area([walk], points);
        if is_clear(walk, &area) {
            polygons.push(walk.iter().copied());
            group_of.push(group);
            continue;
        }
        let cut = triangulate(&[walk], &[], &[], points).map_err(|_| {
            let message = format!("{file}: a facet of {} vertices has no area or crosses itself", walk.len());
            Diagnostic::error("flat-facet", message).near(points[walk[0] as usize]).hint("remove or repair it")
        })?;
        let normal = area.normalize();
        let is_planar = walk.iter().all(|v| (points[*v as usize] - points[walk[0] as usize]).dot(&normal).abs() <= flat);
        if is_planar {
            polygons.push(walk.iter().copied());
            group_of.push(group);
        } else {
            cut.iter().for_each(|t| polygons.push(*t));
            group_of.resize(polygons.count(), group);
        }
    }
    (surface.polygons, surface.group_of) = (polygons, group_of);
    Ok(())
}

/// Facets, with holes or without, as triangles.
fn triangles_of(facets: &Facets, points: &[Vec3]) -> Vec<[u32; 3]> {
    let loops = facets.iter().map(|f| f.loops.iter().collect::<Vec<_>>());
    // Simple: checked by `split_bent` and `flats`.
    loops.flat_map(|loops| triangulate(&loops, &[], &[], points).unwrap_or_default()).collect()
}

/// The solid of the facets, without the points that none of them uses.
fn finish(points: &[Vec3], mut facets: Facets, freedoms: &[Freedom], groups: Vec<String>) -> Solid {
    let mut number = vec![u32::MAX; points.len()];
    let mut vertices = Vec::with_capacity(points.len());
    for corner in facets.corners_mut() {
        let slot = *corner as usize;
        if number[slot] == u32::MAX {
            number[slot] = vertices.len() as u32;
            vertices.push(SolidVertex { point: points[slot], freedom: freedoms[slot] });
        }
        *corner = number[slot];
    }
    let surfaces = groups.into_iter().map(|side| SolidSurface { side, shape: Shape::Sampled }).collect();
    Solid { vertices, facets, surfaces }
}

/// Freedom of each point: on no feature edge, within one, or at an end or meeting of some.
fn freedoms(surface: &Surface, sides: &Sides) -> Vec<Freedom> {
    let normals: Vec<Vec3> = surface.polygons.iter().map(|walk| vector_area([walk], &surface.points).normalize()).collect();
    let is_smooth = |a: u32, b: u32| {
        let [a, b] = [a, b].map(|k| k as usize);
        surface.group_of[a] == surface.group_of[b] && normals[a].dot(&normals[b]) > FEATURE_COSINE
    };
    let mut features = vec![0u32; surface.points.len()];
    for (ends, sides) in sides.edges() {
        if !matches!(sides, [a, b] if is_smooth(a.polygon(), b.polygon())) {
            ends.iter().for_each(|v| features[*v as usize] += 1);
        }
    }
    let freedom = |n: u32| match n {
        0 => Freedom::Surface,
        2 => Freedom::Edge,
        _ => Freedom::Fixed,
    };
    features.into_iter().map(freedom).collect()
}

#[cfg(test)]
mod tests;
