//! Tetrahedra above the radius-edge ratio with their place, and what in the model forces them there.

use super::tets::{ROUNDING, TetShape};
use crate::geom::Vec3;
use crate::geom::union_find::UnionFind;
use crate::io::mesh::{Mesh, NodeId, Tet};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

/// Bend of a surface, in degrees, from which an edge is one of the model and not of its triangles: eight chords per circle bend
/// by 45.
const CREASE: f64 = 50.0;
/// Angle between two surfaces, in degrees, below which tetrahedra between them cannot have good ratios (TetGen's manual: 60 to
/// 70.5).
const SHARP: f64 = 60.0;
/// Surfaces nearer than this many of the largest triangle's edges force tetrahedra between them.
const NEAR: f64 = 2.0;
/// Worst tetrahedra kept.
const MOST: usize = 1000;

/// What forces a tetrahedron above the ratio: what its shortest edge touches.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Forced {
    /// Two feature curves: borders of interfaces, creases.
    TwoCurves,
    /// An edge between surfaces that meet under less than 60 degrees.
    SharpEdge,
    /// Two surfaces that are nearer to each other than twice the size of their triangles.
    Gap,
}

/// A tetrahedron above the radius-edge ratio.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct PoorTet {
    /// Circumradius over shortest edge; JSON has `null` for a flat one.
    pub ratio: f64,
    /// The middle of its shortest edge, in the scene's unit.
    pub at: [f64; 3],
    /// Length of that edge.
    pub shortest_edge: f64,
    /// Name of the part.
    pub part: String,
    /// What forces it, if anything does.
    pub forced: Option<Forced>,
}

impl fmt::Display for PoorTet {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { ratio, at: [x, y, z], part, .. } = self;
        let cause = match self.forced {
            Some(Forced::TwoCurves) => ", between two feature curves",
            Some(Forced::SharpEdge) => ", at a sharp edge",
            Some(Forced::Gap) => ", in a gap",
            None => "",
        };
        write!(f, "{ratio:.2} in {part} at ({x:.6}, {y:.6}, {z:.6}){cause}")
    }
}

/// The tetrahedra of a mesh, of these shapes, above a ratio: worst first, 1000 at most. Cost: the number of tetrahedra, and
/// n log n in the triangles if any is above.
pub fn poor_tets(mesh: &Mesh, shapes: &[TetShape], ratio_bound: f64) -> Vec<PoorTet> {
    let limit = ratio_bound * (1.0 + ROUNDING);
    let ratios = shapes.iter().map(|s| s.radius_edge).zip(&mesh.tets);
    let mut poor: Vec<_> = ratios.filter(|p| p.0 > limit).collect();
    poor.sort_by(|p, q| q.0.total_cmp(&p.0));
    poor.truncate(MOST);
    if poor.is_empty() {
        return Vec::new();
    }
    let features = Features::of(mesh);
    let describe = |(ratio, tet): (f64, &Tet)| {
        let ends = shortest_edge(mesh, tet.corners);
        let [p, q] = ends.map(|v| mesh.nodes[v]);
        PoorTet {
            ratio,
            at: ((p + q) * 0.5).into(),
            shortest_edge: (q - p).norm(),
            part: mesh.region_name(tet.region),
            forced: features.forcing(ends, (q - p).norm()),
        }
    };
    poor.into_iter().map(describe).collect()
}

fn shortest_edge(mesh: &Mesh, corners: [NodeId; 4]) -> [NodeId; 2] {
    const EDGES: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];
    let length = |[a, b]: [NodeId; 2]| (mesh.nodes[b] - mesh.nodes[a]).norm_squared();
    let edges = EDGES.map(|e| e.map(|k| corners[k]));
    edges.into_iter().min_by(|e, f| length(*e).total_cmp(&length(*f))).unwrap_or(edges[0])
}

/// What lies at the nodes of surfaces.
#[derive(Default)]
struct Features {
    /// Surfaces between creases, by their numbers.
    patches: BTreeMap<NodeId, BTreeSet<u32>>,
    /// Patches that meet in an edge, smaller number first.
    meeting: BTreeSet<[u32; 2]>,
    /// Feature curves between their ends, by their numbers.
    curves: BTreeMap<NodeId, BTreeSet<u32>>,
    /// Nodes of edges where surfaces meet under a sharp angle.
    sharp: BTreeSet<NodeId>,
    /// Longest edge of the surface's triangles.
    sizes: BTreeMap<NodeId, f64>,
}

impl Features {
    fn of(mesh: &Mesh) -> Self {
        let mut around: Vec<([NodeId; 2], u32)> = Vec::with_capacity(3 * mesh.triangles.len());
        for (k, t) in mesh.triangles.iter().enumerate() {
            let [a, b, c] = t.corners;
            around.extend([[a, b], [b, c], [c, a]].map(|[p, q]| ([p.min(q), p.max(q)], k as u32)));
        }
        around.sort_unstable();
        let mut features = Self::default();
        let mut patches = UnionFind::new(mesh.triangles.len());
        let mut edges: Vec<[NodeId; 2]> = Vec::new();
        let mut creases: Vec<[u32; 2]> = Vec::new();
        for run in around.chunk_by(|p, q| p.0 == q.0) {
            let ends = run[0].0;
            let length = (mesh.nodes[ends[1]] - mesh.nodes[ends[0]]).norm();
            for v in ends {
                let size = features.sizes.entry(v).or_default();
                *size = size.max(length);
            }
            let angle = smallest_angle(mesh, ends, run);
            match run {
                [p, q] if angle > 180.0 - CREASE && marker(mesh, p.1) == marker(mesh, q.1) => patches.join(p.1, q.1),
                _ => {
                    edges.push(ends);
                    let all = run.iter().flat_map(|p| run.iter().map(move |q| [p.1, q.1]));
                    creases.extend(all.filter(|[a, b]| a < b));
                }
            }
            if angle < SHARP {
                features.sharp.extend(ends);
            }
        }
        for (k, t) in mesh.triangles.iter().enumerate() {
            let patch = patches.find(k as u32);
            t.corners.iter().for_each(|&v| _ = features.patches.entry(v).or_default().insert(patch));
        }
        features.meeting =
            creases.into_iter().map(|pair| pair.map(|t| patches.find(t))).map(|[a, b]| [a.min(b), a.max(b)]).collect();
        features.find_curves(&edges);
        features
    }

    /// Joins feature edges at nodes where just two of them meet.
    fn find_curves(&mut self, edges: &[[NodeId; 2]]) {
        let mut at: BTreeMap<NodeId, Vec<u32>> = BTreeMap::new();
        for (k, ends) in edges.iter().enumerate() {
            ends.iter().for_each(|v| at.entry(*v).or_default().push(k as u32));
        }
        let mut curves = UnionFind::new(edges.len());
        for here in at.values() {
            if let [e, f] = here[..] {
                curves.join(e, f);
            }
        }
        self.curves = at.into_iter().map(|(v, here)| (v, here.into_iter().map(|e| curves.find(e)).collect())).collect();
    }

    /// What forces a tetrahedron with this shortest edge.
    fn forcing(&self, ends: [NodeId; 2], length: f64) -> Option<Forced> {
        if ends.iter().any(|v| self.sharp.contains(v)) {
            return Some(Forced::SharpEdge);
        }
        let of = |sets: &BTreeMap<NodeId, BTreeSet<u32>>| ends.map(|v| sets.get(&v).cloned().unwrap_or_default());
        let [p, q] = of(&self.curves);
        if !p.is_empty() && !q.is_empty() && p.is_disjoint(&q) {
            return Some(Forced::TwoCurves);
        }
        let [p, q] = of(&self.patches);
        let size = ends.iter().filter_map(|v| self.sizes.get(v)).copied().fold(0.0, f64::max);
        let meet = |a: u32, b: u32| a == b || self.meeting.contains(&[a.min(b), a.max(b)]);
        let are_apart = !p.is_empty() && !q.is_empty() && p.iter().all(|&a| q.iter().all(|&b| !meet(a, b)));
        (are_apart && length < NEAR * size).then_some(Forced::Gap)
    }
}

fn marker(mesh: &Mesh, triangle: u32) -> u32 {
    mesh.triangles[triangle as usize].marker
}

/// The smallest angle, in degrees, between two of the triangles at an edge; 180 for a lone one. O(n log n).
fn smallest_angle(mesh: &Mesh, [a, b]: [NodeId; 2], run: &[([NodeId; 2], u32)]) -> f64 {
    let (from, along) = (mesh.nodes[a], (mesh.nodes[b] - mesh.nodes[a]).normalize());
    let out = |triangle: u32| -> Vec3 {
        let corners = mesh.triangles[triangle as usize].corners;
        corners.into_iter().find(|&v| v != a && v != b).map_or(from, |v| mesh.nodes[v]) - from
    };
    // Angles about the edge, from the first triangle on.
    let ahead = run.first().map_or(Vec3::zeros(), |r| out(r.1));
    let ahead = ahead - along * along.dot(&ahead);
    let left = along.cross(&ahead);
    let turn = |way: Vec3| libm::atan2(left.dot(&way), ahead.dot(&way)).to_degrees();
    let mut turns: Vec<f64> = run.iter().map(|r| turn(out(r.1))).collect();
    turns.sort_by(f64::total_cmp);
    let round = turns.first().map(|first| first + 360.0);
    let next = turns.iter().skip(1).copied().chain(round);
    turns.iter().zip(next).map(|(one, next)| next - one).fold(180.0, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::mesh::Triangle;

    fn surface(points: &[[f64; 3]], faces: &[[u32; 3]]) -> Mesh {
        let triangle = |corners: &[u32; 3]| Triangle { corners: corners.map(NodeId), marker: 1, sides: [0, 1] };
        let nodes = points.iter().map(|p| Vec3::from(*p)).collect();
        Mesh { nodes, triangles: faces.iter().map(triangle).collect(), ..Mesh::default() }
    }

    /// A tetrahedron on the first four of these points, in region 1, and a surface of triangles.
    fn tet(points: &[[f64; 3]], faces: &[[u32; 3]]) -> Mesh {
        let mut mesh = surface(points, faces);
        mesh.tets.push(Tet { corners: [0, 1, 2, 3].map(NodeId), region: 1 });
        mesh.regions.insert(1, "iron".into());
        mesh
    }

    fn poor(mesh: &Mesh, ratio_bound: f64) -> Vec<PoorTet> {
        poor_tets(mesh, &[TetShape::new(&mesh.tet_points(&mesh.tets[0]))], ratio_bound)
    }

    fn forced(points: &[[f64; 3]], faces: &[[u32; 3]]) -> Option<Forced> {
        poor(&tet(points, faces), 2.0)[0].forced
    }

    /// The shortest edge is that from 0 to 1.
    const SPLINTER: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]];

    #[test]
    fn places_and_ratios() {
        let all = poor(&tet(&SPLINTER, &[]), 2.0);
        assert_eq!(all.len(), 1);
        // The circumscribed box has three of the edges: R is half its diagonal.
        assert!((all[0].ratio - 0.5 * 8.01f64.sqrt() / 0.1).abs() < 1e-12);
        assert_eq!((all[0].at, all[0].part.as_str(), all[0].forced), ([0.05, 0.0, 0.0], "iron", None));
        assert!(poor(&tet(&SPLINTER, &[]), 15.0).is_empty());
    }

    #[test]
    fn creases_and_sharp_edges_force() {
        // Both ends on the border of one surface: one curve.
        assert_eq!(forced(&SPLINTER, &[[0, 1, 2]]), None);
        // Across a crease of 90 degrees, and along it.
        assert_eq!(forced(&SPLINTER, &[[0, 2, 3], [1, 2, 3]]), Some(Forced::TwoCurves));
        assert_eq!(forced(&SPLINTER, &[[0, 1, 2], [0, 1, 3]]), None);
        let mut leaning = SPLINTER;
        leaning[3] = [0.0, 1.7, 1.0];
        assert_eq!(forced(&leaning, &[[0, 1, 2], [0, 1, 3]]), Some(Forced::SharpEdge));
    }

    #[test]
    fn angles_about_an_edge() {
        let least = |turns: &[f64]| {
            let apex = |turn: &f64| [0.7, 2.0 * libm::cos(turn.to_radians()), 2.0 * libm::sin(turn.to_radians())];
            let points: Vec<[f64; 3]> = [[0.0; 3], [1.0, 0.0, 0.0]].into_iter().chain(turns.iter().map(apex)).collect();
            let faces: Vec<[u32; 3]> = (0..turns.len() as u32).map(|k| [0, 2 + k, 1]).collect();
            let ends = [NodeId(0), NodeId(1)];
            let run: Vec<_> = (0..turns.len() as u32).map(|k| (ends, k)).collect();
            smallest_angle(&surface(&points, &faces), ends, &run)
        };
        for (turns, expected) in [
            (&[40.0][..], 180.0),
            (&[10.0, 190.0], 180.0),
            (&[10.0, 200.0], 170.0),
            (&[250.0, 10.0, 355.0, 130.0], 15.0),
            (&[0.0, 100.0, 103.0, 240.0], 3.0),
        ] {
            assert!((least(turns) - expected).abs() < 1e-9, "{turns:?}: {}", least(turns));
        }
    }

    #[test]
    fn surfaces_force_what_lies_between_them() {
        // Two squares, each a fan about its middle (0 and 1), at some distance.
        let fan = |middle: u32, first: u32| (0..4).map(move |k| [middle, first + k, first + (k + 1) % 4]);
        let faces: Vec<[u32; 3]> = fan(0, 2).chain(fan(1, 6)).collect();
        let plates = |gap: f64| {
            let corners = |z: f64| [[1.0, 1.0, z], [-1.0, 1.0, z], [-1.0, -1.0, z], [1.0, -1.0, z]];
            [&[[0.0, 0.0, 0.0], [0.0, 0.0, gap]][..], &corners(0.0), &corners(gap)].concat()
        };
        assert_eq!(forced(&plates(0.1), &faces), Some(Forced::Gap));
        // Not if both ends are on one of them.
        assert_eq!(forced(&plates(0.1), &faces[..4]), None);
        assert!(poor(&tet(&plates(1.0), &faces), 2.0).is_empty());
    }
}
