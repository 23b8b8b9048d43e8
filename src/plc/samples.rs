//! Complexes made by hand, for tests.

use crate::brep::complex::{Complex, ComplexFacet, ComplexVertex, Marker, Region};
use crate::geom::Vec3;
use crate::geom::polygon::triangulate;
use crate::ids::{FacetId, IdVec, LeafId, MarkerId, PartId, RegionId, SurfaceId, VertexId};
use crate::primitive::solid::Freedom;
use crate::scene::model::{Node, Operation, Part, Policy, Scene};

/// A model under construction: facets with loops and the regions in front and behind. Region r is part r - 1, or a void.
#[derive(Clone, Default)]
pub(crate) struct Sample {
    pub points: Vec<Vec3>,
    pub facets: Vec<(Vec<Vec<u32>>, [u32; 2])>,
    pub voids: Vec<u32>,
}

/// Sides of a block whose corner is number x + 2 y + 4 z, seen from outside: x-, x+, y-, y+, z-, z+.
pub(crate) const SIDES: [[u32; 4]; 6] = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];

impl Sample {
    /// Adds the corners of a block and gives the first one's number.
    pub fn corners(&mut self, lo: [f64; 3], hi: [f64; 3]) -> u32 {
        let base = self.points.len() as u32;
        for k in 0..8 {
            let pick = |axis: usize| if k >> axis & 1 == 0 { lo[axis] } else { hi[axis] };
            self.points.push(Vec3::new(pick(0), pick(1), pick(2)));
        }
        base
    }

    /// Adds some sides of a block, facing outwards, with the regions outside and inside of it.
    pub fn sides(&mut self, base: u32, which: &[usize], regions: [u32; 2]) {
        for &k in which {
            self.facets.push((vec![SIDES[k].map(|v| base + v).to_vec()], regions));
        }
    }

    pub fn rotated(mut self) -> Self {
        let turn = nalgebra::Rotation3::from_euler_angles(0.3, 1.1, -0.7);
        self.points.iter_mut().for_each(|p| *p = turn * *p + Vec3::new(0.1, 0.2, 0.3));
        self
    }

    pub fn complex(&self) -> Complex {
        let count = self.facets.iter().flat_map(|f| f.1).max().unwrap_or(0);
        let part = |r: u32| (r > 0 && !self.voids.contains(&r)).then(|| PartId(r - 1));
        let mut pairs: Vec<[u32; 2]> = self.facets.iter().map(|f| [f.1[0].min(f.1[1]), f.1[0].max(f.1[1])]).collect();
        pairs.sort_unstable();
        pairs.dedup();
        let name = |r: u32| part(r).map_or("outer".to_owned(), |p| format!("p{}", p.0));
        let markers = pairs.iter().enumerate().map(|(k, &[a, b])| Marker {
            name: format!("{}|{}", name(b), name(a)),
            parts: [part(b), part(a)],
            interface: MarkerId(k as u32),
            max_edge: None,
        });
        let facet = |(loops, sides): &(Vec<Vec<u32>>, [u32; 2])| {
            let wide: Vec<&[u32]> = loops.iter().filter(|w| w.len() > 2).map(Vec::as_slice).collect();
            let chains: Vec<[u32; 2]> = loops.iter().filter_map(|w| <[u32; 2]>::try_from(w.as_slice()).ok()).collect();
            let lone: Vec<u32> = loops.iter().filter(|w| w.len() == 1).map(|w| w[0]).collect();
            let triangles = triangulate(&wide, &chains, &lone, &self.points).unwrap();
            let pair = [sides[0].min(sides[1]), sides[0].max(sides[1])];
            ComplexFacet {
                loops: loops.iter().map(|w| w.iter().map(|&v| VertexId(v)).collect()).collect(),
                triangles: triangles.into_iter().map(|t| t.map(VertexId)).collect(),
                sides: sides.map(RegionId),
                surface: SurfaceId(0),
                source: (LeafId(0), 0),
                marker: MarkerId(pairs.binary_search(&pair).unwrap() as u32),
                is_modified: false,
            }
        };
        let vertices = self.points.iter().map(|&point| ComplexVertex { point, freedom: Freedom::Fixed });
        Complex {
            vertices: vertices.collect(),
            facets: self.facets.iter().map(facet).collect::<IdVec<FacetId, _>>(),
            regions: (0..=count).map(|r| Region { part: part(r) }).collect(),
            markers: markers.collect(),
            ..Complex::default()
        }
    }

    pub fn scene(&self) -> Scene {
        let count = self.facets.iter().flat_map(|f| f.1).max().unwrap_or(0);
        let parts = (0..count).map(|k| Part {
            name: format!("p{k}"),
            copy_of: None,
            material: Some("iron".to_owned()),
            solid: Node::Boolean(Operation::Union, Vec::new()),
            max_edge: None,
            max_volume: (k == 1).then_some(0.25),
            span: Default::default(),
        });
        Scene {
            name: "sample".to_owned(),
            unit: "mm".to_owned(),
            hash: "0".repeat(64),
            tolerance: 1e-9,
            remesh: Default::default(),
            mesh: Default::default(),
            overlap: Policy::Allow,
            gaps: Policy::Allow,
            leaves: IdVec::new(),
            parts: parts.collect(),
            boundaries: IdVec::new(),
            interfaces: Default::default(),
        }
    }
}

pub(crate) fn cube() -> Sample {
    let mut s = Sample::default();
    let base = s.corners([0.0; 3], [1.0; 3]);
    s.sides(base, &[0, 1, 2, 3, 4, 5], [0, 1]);
    s
}

/// Two cubes with a common facet.
pub(crate) fn two_cubes() -> Sample {
    let mut s = cube();
    s.facets[1].1 = [2, 1];
    for z in [0.0, 1.0] {
        for y in [0.0, 1.0] {
            s.points.push(Vec3::new(2.0, y, z));
        }
    }
    // Corner (x, y, z) of the second cube: x- from the first, x+ new.
    let number = [1, 8, 3, 9, 5, 10, 7, 11];
    for k in [1, 2, 3, 4, 5] {
        s.facets.push((vec![SIDES[k].map(|v| number[v as usize]).to_vec()], [0, 2]));
    }
    s
}

/// A block with a square hole through it from bottom to top; with a plug, the hole is region 2.
pub(crate) fn through_hole(has_plug: bool) -> Sample {
    let mut s = Sample::default();
    let (outer, hole) = (s.corners([0.0; 3], [3.0; 3]), s.corners([1.0, 1.0, 0.0], [2.0, 2.0, 3.0]));
    s.sides(outer, &[0, 1, 2, 3, 4, 5], [0, 1]);
    for k in [4, 5] {
        s.facets[k].0.push(SIDES[k].iter().rev().map(|v| hole + v).collect());
    }
    // The walls look out of the hole, into the block.
    s.sides(hole, &[0, 1, 2, 3], [1, if has_plug { 2 } else { 0 }]);
    if has_plug {
        s.sides(hole, &[4, 5], [0, 2]);
    }
    s
}

/// A cube with a wall of the given thickness around a void, or around a second part.
pub(crate) fn shell(wall: f64, is_void: bool) -> Sample {
    let mut s = cube();
    let inner = s.corners([wall; 3], [1.0 - wall; 3]);
    s.sides(inner, &[0, 1, 2, 3, 4, 5], [1, 2]);
    s.voids = if is_void { vec![2] } else { Vec::new() };
    s
}

/// On the top of a cube a pyramid stands on its apex and a wedge on its edge.
pub(crate) fn touching() -> Sample {
    let mut s = cube();
    let v = |s: &mut Sample, x: f64, y: f64, z: f64| {
        s.points.push(Vec3::new(x, y, z));
        s.points.len() as u32 - 1
    };
    let apex = v(&mut s, 0.25, 0.25, 1.0);
    let [a, b, c] = [(0.1, 0.1), (0.4, 0.1), (0.2, 0.4)].map(|(x, y)| v(&mut s, x, y, 1.5));
    for tri in [[a, b, c], [apex, b, a], [apex, c, b], [apex, a, c]] {
        s.facets.push((vec![tri.to_vec()], [0, 2]));
    }
    let (e, f) = (v(&mut s, 0.7, 0.3, 1.0), v(&mut s, 0.7, 0.8, 1.0));
    let [g, h, i, j] = [(0.6, 0.3), (0.8, 0.3), (0.8, 0.8), (0.6, 0.8)].map(|(x, y)| v(&mut s, x, y, 1.4));
    for walk in [vec![g, h, i, j], vec![e, h, g], vec![f, j, i], vec![e, g, j, f], vec![e, f, i, h]] {
        s.facets.push((vec![walk], [0, 3]));
    }
    s.facets[5].0.extend([vec![apex], vec![e, f]]);
    s
}
