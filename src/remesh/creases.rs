//! Sharp edges of imported surfaces: each smooth piece becomes a surface of its own while the model is remeshed (thesis 6.2
//! leaves sharp features of acquired models to future work). A piece that lies in a plane is one: its facets stay polygons.

use crate::brep::complex::{Complex, ComplexFacet, ComplexSurface};
use crate::geom::Vec3;
use crate::geom::polygon::{is_planar, vector_area};
use crate::ids::{FacetId, Id, IdVec, SurfaceId, VertexId};
use crate::primitive::solid::Shape;
use std::collections::{BTreeMap, HashMap};

/// Cosine of the turn past which an edge is sharp (40 degrees); the patches use the same.
const CREASE_COSINE: f64 = 0.766;
/// Distance from a plane that is rounding, as a fraction of the largest coordinate: that of corners, and as much again of
/// points where facets cut each other.
const FLAT: f64 = 8.0 * f64::EPSILON;

/// Divides sampled surfaces along their sharp edges; gives for every surface, new ones included, the original.
pub(super) fn divide(complex: &mut Complex) -> Vec<SurfaceId> {
    let mut original: Vec<SurfaceId> = complex.surfaces.ids().collect();
    let is_sampled: Vec<bool> = complex.surfaces.iter().map(|s| s.shape == Shape::Sampled).collect();
    if !is_sampled.contains(&true) {
        return original;
    }
    let sampled: Vec<FacetId> = complex.facets.ids().filter(|&f| is_sampled[complex.facets[f].surface.index()]).collect();
    let roots = smooth_pieces(complex, &sampled);
    // The first piece of a surface keeps its number.
    let mut piece_of_root: BTreeMap<FacetId, SurfaceId> = BTreeMap::new();
    let mut has_piece = vec![false; original.len()];
    for (&facet, &root) in sampled.iter().zip(&roots) {
        let surface = complex.facets[facet].surface;
        let piece = *piece_of_root.entry(root).or_insert_with(|| {
            if std::mem::replace(&mut has_piece[surface.index()], true) {
                original.push(surface);
                let copy = complex.surfaces[surface].clone();
                complex.surfaces.push(copy)
            } else {
                surface
            }
        });
        complex.facets[facet].surface = piece;
    }
    for surface in planar_pieces(complex, &sampled) {
        complex.surfaces[surface].shape = Shape::Plane;
    }
    original
}

/// Surfaces of which all facets lie in one plane.
fn planar_pieces(complex: &Complex, sampled: &[FacetId]) -> Vec<SurfaceId> {
    let points: Vec<Vec3> = complex.vertices.iter().map(|v| v.point).collect();
    let flatness = FLAT * points.iter().map(|p| p.amax()).fold(0.0, f64::max);
    let mut walks: BTreeMap<SurfaceId, Vec<Vec<u32>>> = BTreeMap::new();
    for &facet in sampled {
        let ComplexFacet { surface, loops, .. } = &complex.facets[facet];
        walks.entry(*surface).or_default().extend(loops.iter().map(|walk| walk.iter().map(|v| v.0).collect()));
    }
    let is_flat = |walks: &Vec<Vec<u32>>| is_planar(&walks.iter().map(Vec::as_slice).collect::<Vec<_>>(), &points, flatness);
    walks.into_iter().filter(|(_, walks)| is_flat(walks)).map(|(surface, _)| surface).collect()
}

/// Gives facets their original surfaces back.
pub(super) fn restore(complex: &mut Complex, original: &[SurfaceId], surfaces: &IdVec<SurfaceId, ComplexSurface>) {
    for facet in complex.facets.iter_mut() {
        facet.surface = original[facet.surface.index()];
    }
    complex.surfaces = surfaces.clone();
}

/// For each facet, the smallest facet of its smooth piece.
fn smooth_pieces(complex: &Complex, facets: &[FacetId]) -> Vec<FacetId> {
    let points: Vec<Vec3> = complex.vertices.iter().map(|v| v.point).collect();
    let normal = |f: FacetId| {
        let loops: Vec<Vec<u32>> = complex.facets[f].loops.iter().map(|w| w.iter().map(|v| v.0).collect()).collect();
        vector_area(loops.iter().map(|w| &w[..]), &points).normalize()
    };
    let normals: Vec<Vec3> = facets.iter().map(|&f| normal(f)).collect();
    let mut parent: Vec<usize> = (0..facets.len()).collect();
    let mut seen: HashMap<([VertexId; 2], SurfaceId), usize> = HashMap::new();
    for (k, &f) in facets.iter().enumerate() {
        let data = &complex.facets[f];
        for walk in &data.loops {
            for (i, &a) in walk.iter().enumerate() {
                let b = walk[(i + 1) % walk.len()];
                let key = ([a.min(b), a.max(b)], data.surface);
                match seen.get(&key) {
                    Some(&other) if normals[other].dot(&normals[k]) > CREASE_COSINE => join(&mut parent, other, k),
                    Some(_) => {}
                    None => {
                        seen.insert(key, k);
                    }
                }
            }
        }
    }
    (0..facets.len()).map(|k| facets[root(&mut parent, k)]).collect()
}

fn root(parent: &mut [usize], mut k: usize) -> usize {
    while parent[k] != k {
        parent[k] = parent[parent[k]];
        k = parent[k];
    }
    k
}

fn join(parent: &mut [usize], a: usize, b: usize) {
    let (a, b) = (root(parent, a), root(parent, b));
    parent[a.max(b)] = a.min(b);
}
