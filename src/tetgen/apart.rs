//! Facets that TetGen must not merge.
//!
//! TetGen 1.5 and 1.6 merge neighbouring facets of one marker whose planes differ by less than 0.1 degrees to one facet. Where
//! they are coplanar that is wanted (`-M`, which forbids it, costs a multiple of tetrahedra); else the merged facet encloses
//! another volume. Facets of different markers are never merged, so the latter get markers of their own for the run.

use super::input::Input;
use crate::geom::polygon::vector_area;
use crate::geom::union_find::UnionFind;
use crate::geom::{Vec3, aabb::Aabb};
use crate::io::mesh::{MarkerNumber, Mesh};
use crate::plc::Plc;
use std::collections::BTreeMap;

/// Facets with a smaller angle between their planes, in radians, may be merged: twice TetGen's 0.1 degrees.
const NEAR: f64 = 3.5e-3;
/// Facets are coplanar if no corner is farther from the other's plane than this fraction of the size: what turning and rounding
/// leave.
const COPLANAR: f64 = 1e-12;

/// Markers that stand for others during a run.
#[derive(Debug, Default)]
pub struct Markers(BTreeMap<i64, i64>);

/// The complex with markers of their own for the facets to be kept apart, and what these stand for.
pub fn keep_apart(input: &Input) -> (Plc, Markers) {
    let planes = planes(input);
    let mut groups = UnionFind::new(planes.len());
    let mut near = Vec::new();
    let tolerance = COPLANAR * Aabb::around(&input.plc.vertices).diagonal();
    for [f, g] in neighbours(input) {
        if input.plc.facets[f].marker != input.plc.facets[g].marker || planes[f].normal.cross(&planes[g].normal).norm() > NEAR {
            continue;
        }
        let is_on = |a: usize, b: usize| planes[a].holds(input, b, tolerance);
        if is_on(f, g) && is_on(g, f) { groups.join(f as u32, g as u32) } else { near.push([f, g]) }
    }
    let mut result = input.plc.clone();
    let mut markers = Markers::default();
    let first = input.plc.facets.iter().map(|f| f.marker).max().unwrap_or(0) + 1;
    let group_of: Vec<u32> = (0..planes.len() as u32).map(|f| groups.find(f)).collect();
    let mut apart: Vec<u32> = near.iter().flatten().map(|&f| group_of[f]).collect();
    apart.sort_unstable();
    apart.dedup();
    for (facet, group) in result.facets.iter_mut().zip(&group_of) {
        if let Ok(k) = apart.binary_search(group) {
            markers.0.insert(first + k as i64, facet.marker);
            facet.marker = first + k as i64;
        }
    }
    (result, markers)
}

impl Markers {
    /// Puts the markers of the model back.
    pub fn restore(&self, mesh: &mut Mesh) {
        let usual = |m: MarkerNumber| self.0.get(&i64::from(m)).and_then(|&m| MarkerNumber::try_from(m).ok()).unwrap_or(m);
        mesh.triangles.iter_mut().for_each(|t| t.marker = usual(t.marker));
    }
}

struct Plane {
    normal: Vec3,
    origin: Vec3,
}

impl Plane {
    /// Whether all corners of a facet lie on the plane.
    fn holds(&self, input: &Input, facet: usize, tolerance: f64) -> bool {
        let corners = input.plc.facets[facet].polygons.iter().flatten();
        corners.into_iter().all(|&v| self.normal.dot(&(input.plc.vertices[v as usize] - self.origin)).abs() <= tolerance)
    }
}

fn planes(input: &Input) -> Vec<Plane> {
    let points = &input.plc.vertices;
    let plane = |triangles: &Vec<[u32; 3]>| {
        let area: Vec3 = triangles.iter().map(|t| vector_area([&t[..]], points)).sum();
        let origin = triangles.first().map_or_else(Vec3::zeros, |t| points[t[0] as usize]);
        Plane { normal: area.try_normalize(0.0).unwrap_or_else(Vec3::zeros), origin }
    };
    input.triangles.iter().map(plane).collect()
}

/// Pairs of facets along edges that only these two have: only there TetGen merges.
fn neighbours(input: &Input) -> Vec<[usize; 2]> {
    let mut edges: Vec<([u32; 2], usize)> = Vec::new();
    for (f, facet) in input.plc.facets.iter().enumerate() {
        for polygon in facet.polygons.iter().filter(|p| p.len() > 1) {
            let next = polygon.iter().cycle().skip(1);
            edges.extend(polygon.iter().zip(next).map(|(&a, &b)| ([a.min(b), a.max(b)], f)));
        }
    }
    edges.sort_unstable();
    edges.chunk_by(|a, b| a.0 == b.0).filter(|c| c.len() == 2 && c[0].1 != c[1].1).map(|c| [c[0].1, c[1].1]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plc::PlcFacet;

    /// Three squares side by side of marker 7, the last one turned down by an angle.
    fn squares(angle: f64) -> Input {
        let (c, s) = (libm::cos(angle), libm::sin(angle));
        let columns = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0 + c, -s]];
        let vertices = columns.iter().flat_map(|[x, z]| [Vec3::new(*x, 0.0, *z), Vec3::new(*x, 1.0, *z)]).collect();
        let square = |k: u32| vec![2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1];
        let facet = |k: u32| PlcFacet { polygons: vec![square(k)], holes: Vec::new(), marker: 7 };
        let triangles = |k: u32| vec![[2 * k, 2 * k + 2, 2 * k + 3], [2 * k, 2 * k + 3, 2 * k + 1]];
        Input {
            plc: Plc { vertices, facets: (0..3).map(facet).collect(), ..Plc::default() },
            triangles: (0..3).map(triangles).collect(),
            ..Input::default()
        }
    }

    #[test]
    fn only_nearly_coplanar_facets_are_kept_apart() {
        let groups = |angle: f64| {
            let (marked, markers) = keep_apart(&squares(angle));
            (marked.facets.iter().map(|f| f.marker).collect::<Vec<_>>(), markers.0)
        };
        // Coplanar ones may be merged, and what is bent by half a degree never is.
        assert_eq!(groups(0.0), (vec![7, 7, 7], BTreeMap::new()));
        assert_eq!(groups(0.01), (vec![7, 7, 7], BTreeMap::new()));
        // A twentieth of a degree: the two coplanar squares stay together.
        assert_eq!(groups(1e-3), (vec![8, 8, 9], BTreeMap::from([(8, 7), (9, 7)])));
    }
}
