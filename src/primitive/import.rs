//! Imported surfaces: what a file gives becomes a closed, oriented [`Solid`], or an error that says where it is not.
//!
//! Steps: points of equal coordinates become one (for STL, where that leaves edges open, points within its tolerance); polygons
//! that collapse vanish; polygons that are not planar or not simple become triangles; every directed edge must be matched; a
//! surface that is all inside out is turned. Edges with several matched uses (two cubes that touch) are allowed.

use super::division::MAX_FACETS;
use super::place::Place;
use super::solid::{Freedom, Shape, Solid, SolidFacet, SolidSurface, SolidVertex};
use crate::diag::{Diagnostic, short};
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use crate::geom::embedding;
use crate::geom::hash::IndexMap;
use crate::geom::polygon::{triangulate, vector_area};
use crate::io::{self, PolygonMesh, SurfaceFormat};
use crate::scene::model::Leaf;
use std::path::Path;

/// Welding distance of STL files, as a fraction of their size: their numbers are single precision.
const STL_TOLERANCE: f64 = 1e-6;
/// A polygon is planar if its vertices lie this near its plane, as a fraction of the surface's size: 4 units in the last place.
const FLAT: f64 = 4.0 * f64::EPSILON;
/// Edges at which facets turn by more are features (cosine of 40 degrees): coarser curved imports hardly exist.
const FEATURE_COSINE: f64 = 0.766;
/// Largest coordinate and smallest size of a file, in the scene's unit: what is written in scenes has narrower limits, but
/// files with 1e17 exist and can be computed with. Beyond these, determinants of coordinates leave the range of floats.
const LARGEST: f64 = 1e30;
const SMALLEST: f64 = 1e-30;
/// Places listed in a message.
const LISTED: usize = 5;

/// Polygons over welded points, with their groups.
struct Surface {
    points: Vec<Vec3>,
    polygons: Vec<(Vec<u32>, u32)>,
}

/// Reads and checks the surface of a leaf.
///
/// # Errors
/// `malformed-file` and its like from reading; `open-surface`; `flat-facet`; `no-volume`; `no-facets`; `too-many-facets`.
pub(crate) fn import(leaf: &Leaf, path: &Path, scale: f64) -> Result<Solid, Diagnostic> {
    let mesh = io::read_surface(path)?;
    let file = path.display().to_string();
    if mesh.polygons.is_empty() {
        let fault = Diagnostic::error("no-facets", format!("{file}: the file has no facets"));
        let kind = SurfaceFormat::of(path).map_or("a surface", SurfaceFormat::told);
        return Err(fault.hint(format!("is it really {kind}? Export the surface again, as polygons or triangles")));
    }
    if mesh.polygons.len() > MAX_FACETS {
        let message = format!("{file}: {} facets are more than {MAX_FACETS}", mesh.polygons.len());
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
    let mut surface = welded(&mesh, &points, 0.0);
    if tolerance > 0.0 && !open_edges(&surface.polygons).is_empty() {
        surface = welded(&mesh, &points, tolerance);
    }
    split_bent(&mut surface, &file)?;
    check_closed(&surface, &file)?;
    if place.is_mirrored() {
        surface.turn();
    }
    let volume = surface.volume();
    if volume == 0.0 || !volume.is_finite() {
        let fault = Diagnostic::error("no-volume", format!("{file}: the surface encloses no volume"));
        return Err(fault.hint("it is flat, or its facets lie twice over each other: export the solid again"));
    }
    if volume < 0.0 {
        surface.turn();
    }
    check_embedded(&surface, &file)?;
    Ok(finish(surface, mesh.groups))
}

/// Refuses surfaces that cross or touch themselves outside shared vertices and edges.
fn check_embedded(surface: &Surface, file: &str) -> Result<(), Diagnostic> {
    let mut triangles = Vec::with_capacity(surface.polygons.len());
    for (walk, _) in &surface.polygons {
        match walk[..] {
            [a, b, c] => triangles.push([a, b, c]),
            // Simple: checked by `split_bent`.
            _ => triangles.extend(triangulate(&[walk], &[], &[], &surface.points).unwrap_or_default()),
        }
    }
    let found = embedding::violations(&surface.points, &triangles, LISTED);
    if found.is_empty() {
        return Ok(());
    }
    let fault = Diagnostic::error("self-intersection", format!("{file}: the surface crosses or touches itself"))
        .hint("repair it, or split it into several solids and unite them");
    Err(found.iter().fold(fault, |d, v| d.near(v.point)))
}

impl Surface {
    fn turn(&mut self) {
        self.polygons.iter_mut().for_each(|p| p.0.reverse());
    }

    fn volume(&self) -> f64 {
        let origin = Aabb::around(&self.points).center();
        let fan = |(walk, _): &(Vec<u32>, u32)| {
            let p = |k: usize| self.points[walk[k] as usize] - origin;
            (2..walk.len()).map(|k| p(0).dot(&p(k - 1).cross(&p(k)))).sum::<f64>()
        };
        self.polygons.iter().map(fan).sum::<f64>() / 6.0
    }
}

/// One point for all that have equal coordinates, or (with a tolerance, a fraction of the size) that an earlier one is within
/// reach of.
fn welded(mesh: &PolygonMesh, points: &[Vec3], tolerance: f64) -> Surface {
    let reach = tolerance * Aabb::around(points).diagonal();
    let mut kept: Vec<Vec3> = Vec::new();
    let mut exact: IndexMap<[u64; 3], u32> = IndexMap::with_capacity_and_hasher(points.len(), Default::default());
    let mut near: IndexMap<[i64; 3], Vec<u32>> = IndexMap::default();
    let mut number = vec![u32::MAX; points.len()];
    for (k, p) in points.iter().enumerate() {
        let bits: [u64; 3] = std::array::from_fn(|i| (p[i] + 0.0).to_bits());
        number[k] = *exact.entry(bits).or_insert_with(|| {
            if reach > 0.0 {
                let slot: [i64; 3] = std::array::from_fn(|i| (p[i] / reach).floor() as i64);
                let around = (0..27i64).map(|n| [n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1]);
                let found = around
                    .filter_map(|d| near.get(&std::array::from_fn::<i64, 3, _>(|i| slot[i].saturating_add(d[i]))))
                    .flatten()
                    .copied()
                    .filter(|&v| (kept[v as usize] - p).norm() <= reach)
                    .min();
                if let Some(v) = found {
                    return v;
                }
                near.entry(slot).or_default().push(kept.len() as u32);
            }
            kept.push(*p);
            kept.len() as u32 - 1
        });
    }
    let mut polygons = Vec::with_capacity(mesh.polygons.len());
    for (polygon, group) in mesh.polygons.iter().zip(&mesh.group_of) {
        let mut walk: Vec<u32> = polygon.iter().map(|v| number[*v as usize]).collect();
        walk.dedup();
        while walk.len() > 1 && walk.first() == walk.last() {
            walk.pop();
        }
        if walk.len() >= 3 {
            polygons.push((walk, *group));
        }
    }
    Surface { points: kept, polygons }
}

/// How often each edge (lower vertex first) is used forwards less backwards, and in all; in order of vertices.
fn edge_uses(polygons: &[(Vec<u32>, u32)]) -> Vec<([u32; 2], i32, u32)> {
    let mut uses: Vec<([u32; 2], i32)> = Vec::with_capacity(polygons.len() * 3);
    for (walk, _) in polygons {
        for (k, &a) in walk.iter().enumerate() {
            let b = walk[(k + 1) % walk.len()];
            uses.push(if a < b { ([a, b], 1) } else { ([b, a], -1) });
        }
    }
    uses.sort_unstable();
    uses.chunk_by(|a, b| a.0 == b.0).map(|c| (c[0].0, c.iter().map(|u| u.1).sum(), c.len() as u32)).collect()
}

/// Edges whose directions are not matched.
fn open_edges(polygons: &[(Vec<u32>, u32)]) -> Vec<([u32; 2], i32, u32)> {
    edge_uses(polygons).into_iter().filter(|e| e.1 != 0).collect()
}

fn check_closed(surface: &Surface, file: &str) -> Result<(), Diagnostic> {
    let open = open_edges(&surface.polygons);
    if open.is_empty() {
        return Ok(());
    }
    let is_twisted = open.iter().all(|e| e.2 % 2 == 0);
    let is_doubled = open.iter().all(|e| e.2 > 2);
    let (message, hint) = if is_doubled {
        ("more than two facets meet, and they do not match,", "facets are there twice, or inner walls are left: remove them")
    } else if is_twisted {
        ("facets of opposite orientation meet", "orient all facets outwards")
    } else {
        ("the surface is not closed", "close its holes, or give the import a tolerance that welds its points")
    };
    let message = format!("{file}: {message} at {} edges", open.len());
    let places = open.iter().take(LISTED).map(|e| (surface.points[e.0[0] as usize] + surface.points[e.0[1] as usize]) * 0.5);
    let fault = Diagnostic::error("open-surface", message).hint(hint);
    Err(places.fold(fault, |d, p| d.near(p)))
}

/// Cuts polygons into triangles that are not planar to rounding, not simple, or visit a vertex twice.
fn split_bent(surface: &mut Surface, file: &str) -> Result<(), Diagnostic> {
    let points = &surface.points;
    let flat = FLAT * points.iter().map(|p| p.amax()).fold(0.0, f64::max);
    let mut kept = Vec::with_capacity(surface.polygons.len());
    for (walk, group) in std::mem::take(&mut surface.polygons) {
        let area = vector_area([&walk[..]], points);
        if walk.len() == 3 && area != Vec3::zeros() {
            kept.push((walk, group));
            continue;
        }
        let cut = triangulate(&[&walk], &[], &[], points).map_err(|_| {
            let message = format!("{file}: a facet of {} vertices has no area or crosses itself", walk.len());
            Diagnostic::error("flat-facet", message).near(points[walk[0] as usize]).hint("remove or repair it")
        })?;
        let normal = area.normalize();
        let is_planar = walk.iter().all(|v| (points[*v as usize] - points[walk[0] as usize]).dot(&normal).abs() <= flat);
        if is_planar {
            kept.push((walk, group));
        } else {
            kept.extend(cut.into_iter().map(|t| (t.to_vec(), group)));
        }
    }
    surface.polygons = kept;
    Ok(())
}

fn finish(surface: Surface, groups: Vec<String>) -> Solid {
    let freedoms = freedoms(&surface);
    let mut number = vec![u32::MAX; surface.points.len()];
    let mut vertices = Vec::new();
    let mut facets = Vec::with_capacity(surface.polygons.len());
    for (mut walk, group) in surface.polygons {
        for v in &mut walk {
            let slot = *v as usize;
            if number[slot] == u32::MAX {
                number[slot] = vertices.len() as u32;
                vertices.push(SolidVertex { point: surface.points[slot], freedom: freedoms[slot] });
            }
            *v = number[slot];
        }
        facets.push(SolidFacet { loops: vec![walk], surface: group });
    }
    let surfaces = groups.into_iter().map(|side| SolidSurface { side, shape: Shape::Sampled }).collect();
    Solid { vertices, facets, surfaces }
}

/// Freedom of each point: on no feature edge, within one, or at an end or meeting of some.
fn freedoms(surface: &Surface) -> Vec<Freedom> {
    let unit = |w: &[u32]| vector_area([w], &surface.points).normalize();
    let mut sides: Vec<([u32; 2], u32, Vec3)> = Vec::with_capacity(surface.polygons.len() * 3);
    for (walk, group) in &surface.polygons {
        let normal = unit(walk);
        for (k, &a) in walk.iter().enumerate() {
            let b = walk[(k + 1) % walk.len()];
            sides.push(([a.min(b), a.max(b)], *group, normal));
        }
    }
    sides.sort_by_key(|s| s.0);
    let mut features = vec![0u32; surface.points.len()];
    for edge in sides.chunk_by(|a, b| a.0 == b.0) {
        let is_smooth = matches!(edge, [a, b] if a.1 == b.1 && a.2.dot(&b.2) > FEATURE_COSINE);
        if !is_smooth {
            edge[0].0.iter().for_each(|v| features[*v as usize] += 1);
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
mod tests {
    use super::*;
    use crate::geom::Affine;
    use crate::scene::model::{Division, Primitive};

    const CUBE: &str = "OFF\n8 6 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n\
        4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n";

    fn read(name: &str, text: &str) -> Result<Solid, Diagnostic> {
        let path = std::env::temp_dir().join(format!("gsm-import-{}-{name}", std::process::id()));
        std::fs::write(&path, text).unwrap();
        let division = Division { segments: None, max_angle: None, max_chord_error: None };
        let leaf = Leaf {
            primitive: Primitive::Import { path: path.clone(), scale: 2.0 },
            transform: Affine::identity(),
            division,
            tolerance: None,
            is_triangulated: false,
            name: None,
            span: Default::default(),
        };
        let solid = import(&leaf, &path, 2.0);
        std::fs::remove_file(&path).unwrap();
        solid
    }

    #[test]
    fn cube_of_quadrilaterals() {
        let solid = read("a.off", CUBE).unwrap();
        assert_eq!((solid.vertices.len(), solid.facets.len()), (8, 6));
        assert!(solid.vertices.iter().all(|v| v.freedom == Freedom::Fixed));
        assert!(solid.vertices.iter().any(|v| v.point == Vec3::new(2., 2., 2.)));
        let top = solid.facets.iter().find(|f| f.loops[0].iter().all(|v| solid.vertices[*v as usize].point.z == 2.)).unwrap();
        let points: Vec<Vec3> = solid.vertices.iter().map(|v| v.point).collect();
        assert_eq!(vector_area([&top.loops[0][..]], &points), Vec3::new(0., 0., 4.));
    }

    #[test]
    fn inside_out_is_turned_and_bent_polygons_are_cut() {
        let mut lines: Vec<String> = CUBE.lines().map(String::from).collect();
        for line in &mut lines[10..] {
            let mut words: Vec<&str> = line.split(' ').collect();
            words[1..].reverse();
            *line = words.join(" ");
        }
        assert_eq!(read("b.off", &lines.join("\n")).unwrap().facets.len(), 6);
        let bent = read("c.off", &CUBE.replace("\n1 1 1\n", "\n1 1 1.5\n")).unwrap();
        assert_eq!(bent.facets.len(), 9 - 2);
    }

    #[test]
    fn faults_are_named() {
        let open = read("d.off", &CUBE.replace("8 6 0", "8 5 0")).unwrap_err();
        assert_eq!((open.code, open.points.len()), ("open-surface", 4));
        let twisted = read("e.off", &CUBE.replace("4 3 0 4 7", "4 7 4 0 3")).unwrap_err();
        assert!(twisted.message.contains("opposite orientation"));
        let doubled = read("i.off", &(CUBE.replace("8 6 0", "8 7 0") + "4 3 0 4 7\n")).unwrap_err();
        assert!(doubled.message.contains("more than two facets"), "{}", doubled.message);
        assert_eq!(read("j.off", &CUBE.replace("1 1 1", "1 1 1e300")).unwrap_err().code, "out-of-range");
        assert_eq!(read("k.off", "OFF\n0 0 0\n").unwrap_err().code, "no-facets");
        assert_eq!(read("f.off", &CUBE.replace("4 3 0 4 7", "4 3 0 4 0")).unwrap_err().code, "flat-facet");
        assert_eq!(read("g.off", &CUBE.replace("4 3 0 4 7", "4 3 0 4 8")).unwrap_err().code, "malformed-file");
        assert_eq!(read("h.ply", "").unwrap_err().code, "unknown-format");
    }
}
