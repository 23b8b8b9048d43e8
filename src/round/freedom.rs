//! Degrees of freedom of the vertices (thesis 4.3), from the surfaces that meet there.

use crate::brep::complex::Complex;
use crate::geom::Vec3;
use crate::geom::hash::IndexMap;
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
    let mut around: Vec<(u32, u32)> = Vec::new();
    for facet in &complex.facets {
        around.extend(facet.loops.iter().flatten().map(|v| (v.0, facet.surface.0)));
    }
    around.sort_unstable();
    around.dedup();
    let mut rest = &around[..];
    while let Some(&(vertex, _)) = rest.first() {
        let count = rest.iter().take_while(|a| a.0 == vertex).count();
        let (mine, others) = rest.split_at(count);
        rest = others;
        let vertex = &mut complex.vertices[crate::ids::VertexId(vertex)];
        vertex.freedom = match mine {
            _ if corners.contains_key(&key(&vertex.point)) => Freedom::Fixed,
            [_] => Freedom::Surface,
            [a, b] => {
                let leaf = |s: u32| complex.surfaces[crate::ids::SurfaceId(s)].leaf;
                if leaf(a.1) == leaf(b.1) { Freedom::Edge } else { Freedom::Intersection }
            }
            _ => Freedom::Fixed,
        };
    }
}
