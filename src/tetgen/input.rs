//! What TetGen is given, and what is known of it beforehand.

use crate::brep::complex::Complex;
use crate::diag::{Diagnostic, Outcome, Severity, Span};
use crate::geom::cast::Caster;
use crate::geom::polygon::vector_area;
use crate::geom::union_find::UnionFind;
use crate::ids::{Id, IdVec, PartId};
use crate::io::manifest::Manifest;
use crate::io::mesh::{MarkerNumber, Mesh, NodeId, RegionNumber, Triangle};
use crate::plc::{Plc, check, facet, volumes};
use crate::scene::model::Part;
use std::collections::BTreeMap;

/// A complex with its names.
#[derive(Clone, Debug, Default)]
pub struct Input {
    /// The complex.
    pub plc: Plc,
    /// A triangulation of each facet over its own vertices.
    pub triangles: Vec<Vec<[u32; 3]>>,
    /// Regions in front of and behind each facet; 0 is the outside or a void.
    pub sides: Vec<[RegionNumber; 2]>,
    /// The parts.
    pub regions: BTreeMap<RegionNumber, PartLabel>,
    /// Names of markers.
    pub markers: BTreeMap<MarkerNumber, String>,
}

/// A part's name and its place in the scene text.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PartLabel {
    /// Name.
    pub name: String,
    /// Where the scene defines it.
    pub span: Option<Span>,
}

impl Input {
    /// The evaluated complex together with its .poly form, in which facets have kept their order.
    pub fn new(plc: Plc, complex: &Complex, parts: &IdVec<PartId, Part>) -> Self {
        let number = |part: Option<PartId>| part.map_or(0, |p| p.0 + 1);
        let side = |r| number(complex.regions.get(r).and_then(|region| region.part));
        Self {
            plc,
            triangles: complex.facets.iter().map(|f| f.triangles.iter().map(|t| t.map(|v| v.0)).collect()).collect(),
            sides: complex.facets.iter().map(|f| f.sides.map(side)).collect(),
            regions: parts
                .enumerate()
                .map(|(id, p)| (id.0 + 1, PartLabel { name: p.name.clone(), span: Some(p.span) }))
                .collect(),
            markers: complex.markers.enumerate().map(|(id, m)| (id.index() as u32 + 1, m.name.clone())).collect(),
        }
    }

    /// A complex from a file: triangulated, and the regions beside each facet found from the seeds.
    ///
    /// # Errors
    /// What the exact check finds; a complex that is not valid has no regions.
    pub fn from_plc(plc: Plc, manifest: Option<&Manifest>) -> Outcome<Self> {
        let faults: Vec<_> = check::check(&plc, manifest).into_iter().filter(|f| f.severity > Severity::Warning).collect();
        if !faults.is_empty() {
            return Err(faults);
        }
        let each: Result<Vec<_>, _> = plc.facets.iter().map(|f| facet::triangulate_facet(f, &plc.vertices)).collect();
        let triangles = each.map_err(|e| vec![Diagnostic::internal("triangulation", format!("a checked facet is {e:?}"))])?;
        let all: Vec<[u32; 3]> = triangles.iter().flatten().copied().collect();
        let caster = Caster::new(&plc.vertices, &all);
        let volumes = volumes::find(&plc.vertices, &all, &caster);
        let mut region_of: Vec<RegionNumber> = vec![0; volumes.count as usize];
        for seed in &plc.seeds {
            if let Ok(volume) = volumes.at(&seed.point, &caster) {
                region_of[volume as usize] = RegionNumber::try_from(seed.region).unwrap_or(0);
            }
        }
        let mut first = 0;
        let mut sides = Vec::with_capacity(triangles.len());
        for list in &triangles {
            sides.push([0, 1].map(|k| region_of[volumes.of_side[2 * first + k] as usize]));
            first += list.len();
        }
        let number = |n: i64| u32::try_from(n).unwrap_or(0);
        let regions = manifest.iter().flat_map(|m| &m.regions);
        let markers = manifest.iter().flat_map(|m| &m.markers);
        Ok(Self {
            regions: regions.map(|r| (number(r.region), PartLabel { name: r.part.clone(), span: None })).collect(),
            markers: markers.map(|m| (number(m.marker), m.name.clone())).collect(),
            plc,
            triangles,
            sides,
        })
    }

    /// The facets as a triangulated surface with names.
    pub fn surface(&self) -> Mesh {
        let mut mesh = Mesh {
            nodes: self.plc.vertices.clone().into(),
            regions: self.regions.iter().map(|(r, label)| (*r, label.name.clone())).collect(),
            markers: self.markers.clone(),
            seeds: self.plc.seeds.clone(),
            holes: self.plc.holes.clone(),
            ..Mesh::default()
        };
        for ((facet, list), sides) in self.plc.facets.iter().zip(&self.triangles).zip(&self.sides) {
            let marker = MarkerNumber::try_from(facet.marker).unwrap_or(0);
            mesh.triangles.extend(list.iter().map(|t| Triangle { corners: t.map(NodeId), marker, sides: *sides }));
        }
        mesh.drop_unused_nodes();
        mesh.orient();
        mesh
    }

    /// Volume of each region, from the facets around it.
    pub fn volumes(&self) -> BTreeMap<RegionNumber, f64> {
        let mut around: BTreeMap<RegionNumber, Vec<[u32; 3]>> = BTreeMap::new();
        for (triangles, &[front, behind]) in self.triangles.iter().zip(&self.sides) {
            if front != behind {
                around.entry(behind).or_default().extend(triangles);
                around.entry(front).or_default().extend(triangles.iter().map(|&[a, b, c]| [a, c, b]));
            }
        }
        around.remove(&0);
        around.into_iter().map(|(region, triangles)| (region, self.enclosed(&triangles))).collect()
    }

    /// Volume that closed surfaces enclose. Each piece is taken about a corner of its own: about a far one, a tiny piece would
    /// lose its digits.
    fn enclosed(&self, triangles: &[[u32; 3]]) -> f64 {
        let vertices = &self.plc.vertices;
        let mut corners = triangles.as_flattened().to_vec();
        corners.sort_unstable();
        corners.dedup();
        let slot = |v: u32| corners.partition_point(|&corner| corner < v);
        let mut pieces = UnionFind::new(corners.len());
        for t in triangles {
            let [a, b, c] = t.map(|v| slot(v) as u32);
            pieces.join(a, b);
            pieces.join(a, c);
        }
        let (piece_of, count) = pieces.number();
        let mut origins = vec![None; count];
        let cone = |t: &[u32; 3]| {
            let origin = *origins[piece_of[slot(t[0])] as usize].get_or_insert(vertices[t[0] as usize]);
            let [a, b, c] = t.map(|v| vertices[v as usize] - origin);
            a.cross(&b).dot(&c) / 6.0
        };
        triangles.iter().map(cone).sum()
    }

    /// Area of each marker's facets.
    pub fn areas(&self) -> BTreeMap<MarkerNumber, f64> {
        let mut areas = BTreeMap::new();
        for (facet, triangles) in self.plc.facets.iter().zip(&self.triangles) {
            let area: f64 = triangles.iter().map(|t| vector_area([&t[..]], &self.plc.vertices).norm()).sum();
            *areas.entry(facet.marker as MarkerNumber).or_insert(0.0) += area;
        }
        areas
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vec3;

    /// Two cubes of a thousandth, far from each other and from the first vertex. About that one, their volume was off by 1e-4,
    /// and no mesh of TetGen's was taken for theirs.
    #[test]
    fn tiny_pieces_keep_the_digits_of_their_volume() {
        let edge = 1.0 / 1024.0;
        let corners = |[x, y, z]: [f64; 3]| {
            (0..8)
                .map(move |k| Vec3::new(x, y, z) + Vec3::new(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2)) * edge)
        };
        let mut input = Input::default();
        input.plc.vertices = vec![Vec3::new(-5.1, -5.3, -5.7)];
        for place in [[1.0, 2.0, 0.5], [-3.0, 4.0, 2.5]] {
            let first = input.plc.vertices.len() as u32;
            input.plc.vertices.extend(corners(place));
            let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
            for [a, b, c, d] in quads.map(|q| q.map(|v: u32| v + first)) {
                input.triangles.push(vec![[a, b, c], [a, c, d]]);
                input.sides.push([0, 1]);
            }
        }
        let volume = input.volumes()[&1];
        assert!((volume / (2.0 * edge * edge * edge) - 1.0).abs() < 1e-12, "{volume:e}");
    }
}
