//! Places where feature curves are apart on the facets, but coincide on the true surfaces.
//!
//! Where a rim lies on another surface, or surfaces are almost tangent, facets cross in a zigzag beside the rim. The true
//! curves are one, or nearly so: vertices that went there would leave nothing between them. Such facets stay as evaluated.
//!
//! ```text
//! facets:  rim ───────────────   true:  ═════════════
//!          zigzag ╲╱╲╱╲╱╲╱╲╱
//! ```

use super::workpiece::{Place, Workpiece};
use crate::brep::store::EdgeId;
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use crate::geom::bvh::Bvh;
use crate::geom::segment::share_nearest;
use crate::ids::VertexId;

/// Distance of a vertex from a feature edge on the true curves, over that on the facets, below which they are pinched. Curves
/// that come closer because their chords have different sags keep more.
const PINCHED: f64 = 0.25;

/// A feature edge as it is and as it would be on its true curve.
struct Chord {
    edge: EdgeId,
    now: [Vec3; 2],
    home: [Vec3; 2],
    /// How far its ends would move.
    way: f64,
}

impl Workpiece {
    /// Vertices that must not move, as on their true curves they would nearly meet others: the vertices of features that come
    /// too near to an edge, and the ends of that edge. Features must be known. Cost: n log n in the feature edges, times the
    /// number of those that are nearer to a vertex than it moves.
    pub fn pinched(&self) -> Vec<VertexId> {
        let homes = |v: VertexId| self.true_place(v).unwrap_or_else(|| self.point(v));
        let features = self.brep.topology.edges().filter(|&e| self.brep.is_feature(e));
        let chords: Vec<Chord> = features
            .map(|edge| {
                let ends = self.brep.topology.ends(edge);
                let (now, home) = (ends.map(|v| self.point(v)), ends.map(homes));
                let way = (home[0] - now[0]).norm().max((home[1] - now[1]).norm());
                Chord { edge, now, home, way }
            })
            .collect();
        // What gets so much nearer was nearer than this share of both ways.
        let reach = 1.0 / (1.0 - PINCHED);
        let tree = Bvh::new(chords.iter().map(|c| Aabb::around(&c.now).inflated(reach * c.way)).collect());
        let mut vertices: Vec<VertexId> = chords.iter().flat_map(|c| self.brep.topology.ends(c.edge)).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let mut pinched = Vec::new();
        for v in vertices {
            let (now, home) = (self.point(v), homes(v));
            let around = Aabb::around([&now]).inflated(reach * (home - now).norm());
            tree.overlapping(&around, |c| {
                let chord = &chords[c as usize];
                if self.is_pinched(v, &now, &home, chord) {
                    pinched.push(v);
                    pinched.extend(self.brep.topology.ends(chord.edge));
                }
            });
        }
        pinched.sort_unstable();
        pinched.dedup();
        pinched
    }

    fn is_pinched(&self, vertex: VertexId, now: &Vec3, home: &Vec3, chord: &Chord) -> bool {
        let curve = self.curve_of(chord.edge);
        let is_same = curve.is_some_and(|c| self.place(vertex) == Place::Curve(c));
        if is_same || self.brep.topology.ends(chord.edge).contains(&vertex) {
            return false;
        }
        let least = PINCHED * distance(now, &chord.now).0;
        let (to_chord, is_beside) = distance(home, &chord.home);
        let to_curve = || curve.filter(|_| is_beside).and_then(|c| self.curves[c].gap(home)).map_or(f64::INFINITY, |g| g.0);
        to_chord < least || to_curve() < least
    }
}

/// Distance from a segment, and whether the nearest point is inside of it.
fn distance(point: &Vec3, [a, b]: &[Vec3; 2]) -> (f64, bool) {
    let share = share_nearest(point, [a, b]);
    ((a + (b - a) * share - point).norm(), share > 0.0 && share < 1.0)
}
