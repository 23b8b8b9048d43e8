//! Degrees of freedom of the vertices (thesis 4.3), from the surfaces that meet there.

use crate::brep::complex::Complex;
use crate::geom::Vec3;
use crate::geom::hash::IndexMap;
use crate::geom::lists::Lists;
use crate::ids::SurfaceId;
use crate::primitive::solid::{Freedom, Solid};

/// Corners of the leaves stay fixed; else one surface around a vertex lets it move on it, two on their common curve (an
/// intersection line if they belong to different leaves), more not at all.
pub fn assign(complex: &mut Complex, solids: &[Solid]) {
    let key = |p: &Vec3| [p.x + 0.0, p.y + 0.0, p.z + 0.0].map(f64::to_bits);
    let mut corners: IndexMap<[u64; 3], ()> = IndexMap::default();
    for solid in solids {
        for v in solid.vertices.iter().filter(|v| v.freedom == Freedom::Fixed) {
            corners.insert(key(&v.point), ());
        }
    }
    let mut uses: Vec<(u32, u32)> = Vec::new();
    for facet in &complex.facets {
        uses.extend(facet.loops.iter().flatten().map(|v| (v.0, facet.surface.0)));
    }
    let surfaces_at = Lists::new(complex.vertices.len(), &uses);
    let leaf = |s: u32| complex.surfaces[SurfaceId(s)].leaf;
    let mut around: Vec<u32> = Vec::new();
    for (k, vertex) in complex.vertices.iter_mut().enumerate() {
        around.clear();
        around.extend_from_slice(surfaces_at.of(k as u32));
        around.sort_unstable();
        around.dedup();
        vertex.freedom = match around[..] {
            [] => vertex.freedom,
            _ if corners.contains_key(&key(&vertex.point)) => Freedom::Fixed,
            [_] => Freedom::Surface,
            [a, b] if leaf(a) == leaf(b) => Freedom::Edge,
            [_, _] => Freedom::Intersection,
            _ => Freedom::Fixed,
        };
    }
}
