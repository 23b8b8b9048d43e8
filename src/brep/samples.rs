//! Models for tests: regions made of unit cubes, and a few with polygons that have holes, lone vertices and lone edges.

use super::complex::{Complex, ComplexFacet, ComplexSurface, ComplexVertex, Marker, Region};
use super::model::Brep;
use crate::geom::Vec3;
use crate::ids::{Id, LeafId, MarkerId, PartId, RegionId, SurfaceId, VertexId};
use crate::primitive::solid::{Freedom, Shape};
use std::collections::BTreeMap;

/// A complex with one marker per pair of regions, one surface per direction and plane.
#[derive(Default)]
pub struct Sketch {
    complex: Complex,
    vertex: BTreeMap<[i32; 3], VertexId>,
    surface: BTreeMap<(usize, i32), SurfaceId>,
    marker: BTreeMap<[RegionId; 2], MarkerId>,
}

impl Sketch {
    pub fn with_regions(bounded: usize) -> Self {
        let mut sketch = Self::default();
        for k in 0..=bounded {
            sketch.complex.regions.push(Region { part: k.checked_sub(1).map(PartId::new) });
        }
        sketch
    }
    pub fn vertex(&mut self, at: [i32; 3]) -> VertexId {
        let vertices = &mut self.complex.vertices;
        *self
            .vertex
            .entry(at)
            .or_insert_with(|| vertices.push(ComplexVertex { point: Vec3::from(at.map(f64::from)), freedom: Freedom::Surface }))
    }
    /// A facet; `plane` names its surface.
    pub fn facet(&mut self, loops: &[&[[i32; 3]]], triangles: &[[[i32; 3]; 3]], sides: [u32; 2], plane: (usize, i32)) {
        let loops = loops.iter().map(|walk| walk.iter().map(|&at| self.vertex(at)).collect()).collect();
        let triangles = triangles.iter().map(|t| t.map(|at| self.vertex(at))).collect();
        let sides = sides.map(RegionId);
        let surfaces = &mut self.complex.surfaces;
        let surface = *self.surface.entry(plane).or_insert_with(|| {
            surfaces.push(ComplexSurface { leaf: LeafId(0), side: format!("{plane:?}"), shape: Shape::Plane })
        });
        let markers = &mut self.complex.markers;
        let name = if sides[0] < sides[1] { sides } else { [sides[1], sides[0]] };
        let marker = *self.marker.entry(name).or_insert_with(|| {
            let interface = MarkerId::new(markers.len());
            markers.push(Marker { name: format!("{name:?}"), parts: [None, None], interface, max_edge: None })
        });
        let source = (LeafId(0), self.complex.facets.len() as u32);
        let facet = ComplexFacet { loops, triangles, sides, surface, source, marker, is_modified: false };
        self.complex.facets.push(facet);
    }
    pub fn complex(self) -> Complex {
        self.complex
    }
    pub fn brep(self) -> Brep {
        Brep::from_complex(self.complex).unwrap()
    }
}

/// Unit cubes of numbered regions; a facet per wall between different regions, squares or (`is_cut`) two triangles each.
pub fn voxels(cubes: &[([i32; 3], u32)], is_cut: bool) -> Sketch {
    let region: BTreeMap<[i32; 3], u32> = cubes.iter().copied().collect();
    let mut sketch = Sketch::with_regions(region.values().copied().max().unwrap_or(0) as usize);
    let at = |cell: [i32; 3]| region.get(&cell).copied().unwrap_or(0);
    let mut walls = std::collections::BTreeSet::new();
    for &cell in region.keys() {
        for axis in 0..3 {
            for step in [0, 1] {
                let mut upper = cell;
                upper[axis] += step;
                walls.insert((upper, axis));
            }
        }
    }
    for (upper, axis) in walls {
        let mut lower = upper;
        lower[axis] -= 1;
        let sides = [at(upper), at(lower)];
        if sides[0] == sides[1] {
            continue;
        }
        let corner = |du: i32, dv: i32| {
            let mut p = upper;
            p[(axis + 1) % 3] += du;
            p[(axis + 2) % 3] += dv;
            p
        };
        let q = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
        let tiles = [[q[0], q[1], q[2]], [q[0], q[2], q[3]]];
        let plane = (axis, upper[axis]);
        if is_cut {
            tiles.iter().for_each(|tile| sketch.facet(&[tile], &[*tile], sides, plane));
        } else {
            sketch.facet(&[&q], &tiles, sides, plane);
        }
    }
    sketch
}

/// A block of cubes from `lo` up to `hi`.
pub fn block(lo: [i32; 3], hi: [i32; 3], region: u32) -> Vec<([i32; 3], u32)> {
    let mut cubes = Vec::new();
    for x in lo[0]..hi[0] {
        for y in lo[1]..hi[1] {
            for z in lo[2]..hi[2] {
                cubes.push(([x, y, z], region));
            }
        }
    }
    cubes
}

/// Later cubes replace earlier ones; region 0 takes away.
pub fn over(base: Vec<([i32; 3], u32)>, top: Vec<([i32; 3], u32)>) -> Vec<([i32; 3], u32)> {
    let mut cells: BTreeMap<[i32; 3], u32> = base.into_iter().collect();
    cells.extend(top);
    cells.into_iter().filter(|&(_, region)| region != 0).collect()
}

/// A 4 x 4 x 1 plate with a 2 x 2 through hole: two facets with a hole each.
pub fn plate() -> Sketch {
    let mut sketch = Sketch::with_regions(1);
    let ring = |a: i32, b: i32, z: i32| [[a, a, z], [b, a, z], [b, b, z], [a, b, z]];
    for (z, sides) in [(0, [1, 0]), (1, [0, 1])] {
        let (outer, inner) = (ring(0, 4, z), ring(1, 3, z));
        let mut tiles = Vec::new();
        for k in 0..4 {
            let l = (k + 1) % 4;
            tiles.push([outer[k], outer[l], inner[l]]);
            tiles.push([outer[k], inner[l], inner[k]]);
        }
        let hole: Vec<[i32; 3]> = inner.iter().rev().copied().collect();
        sketch.facet(&[&outer, &hole], &tiles, sides, (2, z));
    }
    for (a, b, sides, plane) in [(0, 4, [0, 1], 10), (1, 3, [1, 0], 20)] {
        let (low, high) = (ring(a, b, 0), ring(a, b, 1));
        for k in 0..4 {
            let l = (k + 1) % 4;
            let tiles = [[low[k], low[l], high[l]], [low[k], high[l], high[k]]];
            sketch.facet(&[&[low[k], low[l], high[l], high[k]]], &tiles, sides, (plane, k as i32));
        }
    }
    sketch
}

/// A block 4 x 4 x 4 (region 1) on whose top a wedge (region 2) stands, touching it in the point (1, 1, 4) or along the edge
/// from there to (3, 1, 4), inside the top.
pub fn touching(along_edge: bool) -> Sketch {
    let mut sketch = Sketch::with_regions(2);
    let at = |x: i32, y: i32, z: i32| [x, y, z];
    let top = [at(0, 0, 4), at(4, 0, 4), at(4, 4, 4), at(0, 4, 4)];
    let base = top.map(|[x, y, _]| [x, y, 0]);
    for k in 0..4 {
        let l = (k + 1) % 4;
        let tiles = [[base[k], base[l], top[l]], [base[k], top[l], top[k]]];
        sketch.facet(&[&[base[k], base[l], top[l], top[k]]], &tiles, [0, 1], (k, 0));
    }
    sketch.facet(&[&base], &[[base[0], base[1], base[2]], [base[0], base[2], base[3]]], [1, 0], (5, 0));
    let (p, q) = (at(1, 1, 4), at(3, 1, 4));
    if along_edge {
        let tiles = [
            [top[0], top[1], p],
            [top[1], q, p],
            [top[1], top[2], q],
            [top[2], top[3], q],
            [top[3], p, q],
            [top[3], top[0], p],
        ];
        sketch.facet(&[&top, &[p, q]], &tiles, [0, 1], (6, 0));
        let (r, s) = (at(2, 0, 7), at(2, 2, 7));
        for (n, t) in [[p, r, s], [q, s, r], [p, q, r], [q, p, s]].into_iter().enumerate() {
            sketch.facet(&[&t], &[t], [0, 2], (7 + n, 0));
        }
    } else {
        let tiles = [0, 1, 2, 3].map(|k| [top[k], top[(k + 1) % 4], p]);
        sketch.facet(&[&top, &[p]], &tiles, [0, 1], (6, 0));
        let (q, r, s) = (at(2, 0, 7), at(2, 2, 7), at(0, 1, 7));
        for (n, t) in [[p, q, r], [p, r, s], [p, s, q], [q, s, r]].into_iter().enumerate() {
            sketch.facet(&[&t], &[t], [2, 0], (7 + n, 0));
        }
    }
    sketch
}
