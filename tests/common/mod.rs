//! Complexes built in code: prisms that share their facets.
#![allow(dead_code)]

use gsm::geom::Vec3;
use gsm::plc::{PlcFacet, Seed};
use gsm::tetgen::Input;
use gsm::tetgen::input::PartLabel;
use std::collections::BTreeMap;

/// Collects prisms; equal vertices and equal facets become one.
#[derive(Default)]
pub struct Builder {
    input: Input,
    vertices: BTreeMap<[i64; 3], u32>,
    facets: BTreeMap<Vec<u32>, usize>,
    markers: BTreeMap<String, u32>,
}

impl Builder {
    fn vertex(&mut self, p: Vec3) -> u32 {
        let list = &mut self.input.plc.vertices;
        *self.vertices.entry([0, 1, 2].map(|k| (p[k] * 1e9).round() as i64)).or_insert_with(|| {
            list.push(p);
            list.len() as u32 - 1
        })
    }

    /// A facet, counter-clockwise seen from outside the region.
    fn facet(&mut self, points: &[Vec3], region: u32) {
        let polygon: Vec<u32> = points.iter().map(|p| self.vertex(*p)).collect();
        let mut key = polygon.clone();
        key.sort_unstable();
        if let Some(&k) = self.facets.get(&key) {
            self.input.sides[k][0] = region;
            return;
        }
        self.facets.insert(key, self.input.sides.len());
        // Convex polygons only: a fan.
        self.input.triangles.push((2..polygon.len()).map(|k| [polygon[0], polygon[k - 1], polygon[k]]).collect());
        self.input.sides.push([0, region]);
        self.input.plc.facets.push(PlcFacet { polygons: vec![polygon], holes: Vec::new(), marker: 0 });
    }

    /// A prism over a convex polygon, counter-clockwise, from z0 to z1; seeded if `name` is new or `seed` is set.
    pub fn prism(&mut self, base: &[[f64; 2]], z: [f64; 2], region: u32, name: &str, seed: bool) {
        let at = |p: &[f64; 2], z: f64| Vec3::new(p[0], p[1], z);
        let top: Vec<Vec3> = base.iter().map(|p| at(p, z[1])).collect();
        let mut bottom: Vec<Vec3> = base.iter().map(|p| at(p, z[0])).collect();
        for k in 0..base.len() {
            let j = (k + 1) % base.len();
            self.facet(&[bottom[k], bottom[j], top[j], top[k]], region);
        }
        if seed {
            let point = bottom.iter().chain(&top).sum::<Vec3>() / (2 * base.len()) as f64;
            self.input.plc.seeds.push(Seed { point, region: i64::from(region), max_volume: None });
        }
        bottom.reverse();
        self.facet(&bottom, region);
        self.facet(&top, region);
        self.input.regions.insert(region, PartLabel { name: name.into(), span: None });
    }

    /// Facets get their markers `A|B` and `A|outer`; those inside a region stay without.
    pub fn finish(mut self) -> Input {
        let name = |r: u32| self.input.regions.get(&r).map_or("outer".to_string(), |label| label.name.clone());
        for (facet, [front, behind]) in self.input.plc.facets.iter_mut().zip(&self.input.sides) {
            if front == behind {
                continue;
            }
            let (a, b) = if *front == 0 || behind < front { (*behind, *front) } else { (*front, *behind) };
            let next = self.markers.len() as u32 + 1;
            facet.marker = i64::from(*self.markers.entry(format!("{}|{}", name(a), name(b))).or_insert(next));
        }
        self.input.markers = self.markers.iter().map(|(n, m)| (*m, n.clone())).collect();
        self.input
    }
}

/// Coaxial rings of 24 facets each, as in an electrical machine: every ring a region, every sector wall a facet.
pub fn rings() -> Input {
    let mut builder = Builder::default();
    let circle: Vec<[f64; 2]> =
        (0..24).map(|k| std::f64::consts::TAU * k as f64 / 24.0).map(|t| [libm::cos(t), libm::sin(t)]).collect();
    let scaled = |r: f64| circle.iter().map(move |p| [r * p[0], r * p[1]]).collect::<Vec<_>>();
    let radii = [0.3, 0.5, 0.55, 0.8, 1.0, 1.5];
    for z in [[0.0, 0.4], [0.4, 1.0]] {
        builder.prism(&scaled(radii[0]), z, 1, "shaft", true);
        for (ring, pair) in radii.windows(2).enumerate() {
            let (inner, outer) = (scaled(pair[0]), scaled(pair[1]));
            for k in 0..24 {
                let j = (k + 1) % 24;
                let base = [inner[k], outer[k], outer[j], inner[j]];
                builder.prism(&base, z, ring as u32 + 2, &format!("ring{}", ring + 1), true);
            }
        }
    }
    builder.finish()
}

/// The complex turned about an oblique axis.
pub fn rotated(mut input: Input, seed: u64) -> Input {
    // Any spread of axes and angles will do.
    let s = seed as f64;
    let axis = Vec3::new(libm::sin(1.7 * s + 0.3), libm::cos(2.3 * s + 0.1), libm::sin(3.1 * s + 1.0));
    let turn = nalgebra::Rotation3::new(axis.normalize() * (0.4 + 1.1 * s % 2.9));
    let plc = &mut input.plc;
    let seeds = plc.seeds.iter_mut().map(|s| &mut s.point);
    for p in plc.vertices.iter_mut().chain(&mut plc.holes).chain(seeds) {
        *p = turn * *p;
    }
    input
}

/// Puts another complex beside; its regions must have other numbers.
pub fn append(all: &mut Input, other: Input, shift: Vec3) {
    let (first, markers) = (all.plc.vertices.len() as u32, all.markers.len() as u32);
    all.plc.vertices.extend(other.plc.vertices.iter().map(|p| p + shift));
    all.plc.seeds.extend(other.plc.seeds.iter().map(|s| Seed { point: s.point + shift, ..*s }));
    all.triangles.extend(other.triangles.iter().map(|list| list.iter().map(|t| t.map(|v| v + first)).collect::<Vec<_>>()));
    all.sides.extend(other.sides);
    all.regions.extend(other.regions);
    all.markers.extend(other.markers.into_iter().map(|(m, name)| (m + markers, name)));
    for facet in other.plc.facets {
        let polygons = facet.polygons.iter().map(|p| p.iter().map(|v| v + first).collect()).collect();
        all.plc.facets.push(PlcFacet { polygons, holes: Vec::new(), marker: facet.marker + i64::from(markers) });
    }
}
