//! Turns facets of a surface that lie almost, but not quite, in one plane clear of each other.
//!
//! TetGen 1.5 and 1.6 merge neighbouring facets of one marker whose planes differ by less than 0.1 degrees, and the merged facet
//! encloses another volume. Where a vertex of a band lies almost on a ruling, the triangle at the strip's end is almost in the
//! strip's plane. A slide by a hundredth of the edge length takes it out.

use super::operators::Effect;
use super::workpiece::{Place, Workpiece};
use crate::brep::store::EdgeId;
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use crate::ids::{FacetId, VertexId};

/// Sine of the angle between planes below which TetGen might merge facets: 0.12 degrees.
const MERGED_SINE: f64 = 2.1e-3;
/// Facets are in one plane if no corner is farther off than this fraction of the size: merging them is harmless.
const COPLANAR: f64 = 1e-13;
/// Lengths of slides that are tried, in shortest edges at the vertex.
const SLIDES: [f64; 6] = [0.005, 0.01, 0.02, 0.04, 0.08, 0.16];
/// Newton steps to a plane along a curve; they start at a hundredth of the distance.
const FOOT_STEPS: usize = 4;
/// How often all edges are looked at; a slide may bring another edge into trouble.
const PASSES: usize = 4;

impl Workpiece {
    /// Moves vertices until no two facets of a surface are almost in one plane, as far as that is legal.
    pub fn clear_bends(&mut self) {
        let extent = Aabb::around(self.brep.vertices.iter().map(|v| &v.point)).diagonal();
        let flat = COPLANAR * extent;
        for _ in 0..PASSES {
            let mut is_done = true;
            for edge in self.active_edges() {
                if self.brep.topology.has_edge(edge) && self.is_blurred(edge, flat) {
                    is_done = false;
                    self.clear_bend(edge, flat);
                }
            }
            if is_done {
                break;
            }
        }
    }

    /// Whether TetGen would merge the facets at an edge although they are not in one plane.
    fn is_blurred(&self, edge: EdgeId, flat: f64) -> bool {
        let mut facets = self.brep.topology.facets_around(edge);
        let (Some(f), Some(g), None) = (facets.next(), facets.next(), facets.next()) else { return false };
        let (m, n) = (self.normal(f), self.normal(g));
        if self.brep.facets[f].marker != self.brep.facets[g].marker || m.cross(&n).norm() > MERGED_SINE {
            return false;
        }
        let start = self.point(self.brep.topology.ends(edge)[0]);
        let is_off = |facet: FacetId, normal: &Vec3| {
            let fins = self.brep.topology.fins_of_facet(facet);
            fins.flat_map(|fin| self.brep.topology.fin_ends(fin)).any(|v| normal.dot(&(self.point(v) - start)).abs() > flat)
        };
        is_off(f, &n) || is_off(g, &m)
    }

    /// Unit normal of a facet.
    fn normal(&self, facet: FacetId) -> Vec3 {
        let corners = self.brep.triangles(facet).map(|t| t.map(|v| self.point(v)));
        let area: Vec3 = corners.map(|[a, b, c]| (b - a).cross(&(c - a))).sum();
        area.try_normalize(0.0).unwrap_or_else(Vec3::zeros)
    }

    /// The move of a vertex of the two facets that leaves the fewest such edges and, of these, the best angles: into the plane of
    /// the other facet if possible, for TetGen needs fewer tetrahedra the fewer edges it has to keep.
    fn clear_bend(&mut self, edge: EdgeId, flat: f64) {
        let mut vertices: Vec<VertexId> =
            self.brep.topology.facets_around(edge).filter_map(|f| self.corners(f)).flatten().collect();
        vertices.sort_unstable();
        vertices.dedup();
        let mut best: Option<((bool, std::cmp::Reverse<usize>, f64), VertexId, Vec3)> = None;
        for vertex in vertices {
            let star = self.star(vertex);
            let before = self.worst_at(vertex, &star);
            let blurred = self.blurred_around(&star, flat);
            let feet = self.feet(vertex, edge).into_iter().map(|to| (false, to));
            for (is_slide, to) in feet.chain(self.slides(vertex).into_iter().map(|to| (true, to))) {
                let Some(Effect { after, .. }) = self.plan_move(vertex, &star, before, &to, 1.0) else { continue };
                if after.is_flipped || after.excess > before.excess.max(1.0) * self.bound.slack() {
                    continue;
                }
                let from = std::mem::replace(&mut self.brep.vertices[vertex].point, to);
                let left = self.blurred_around(&star, flat);
                self.brep.vertices[vertex].point = from;
                let rank = (is_slide, std::cmp::Reverse(blurred.saturating_sub(left)), after.cosine);
                if left < blurred && best.as_ref().is_none_or(|(b, ..)| rank < *b) {
                    best = Some((rank, vertex, to));
                }
            }
        }
        if let Some((_, vertex, to)) = best {
            self.relocate(vertex, to);
        } else {
            eprintln!("STUCK {edge:?}");
        }
    }

    fn blurred_around(&self, star: &[FacetId], flat: f64) -> usize {
        let mut edges = self.edges_of(star);
        edges.sort_unstable();
        edges.dedup();
        edges.into_iter().filter(|&e| self.is_blurred(e, flat)).count()
    }

    /// Places of a vertex in the planes of those facets at an edge that it is not a corner of: the feet, or, on a curve, where the
    /// curve passes through.
    fn feet(&self, vertex: VertexId, edge: EdgeId) -> Vec<Vec3> {
        let here = self.point(vertex);
        let start = self.point(self.brep.topology.ends(edge)[0]);
        let others = self.brep.topology.facets_around(edge).filter(|&f| self.corners(f).is_none_or(|t| !t.contains(&vertex)));
        let normals = others.filter(|_| !self.brep.topology.ends(edge).contains(&vertex)).map(|f| self.normal(f));
        normals.filter_map(|n| self.foot_in_plane(vertex, &here, &start, &n)).collect()
    }

    fn foot_in_plane(&self, vertex: VertexId, here: &Vec3, origin: &Vec3, normal: &Vec3) -> Option<Vec3> {
        let height = |p: &Vec3| normal.dot(&(p - origin));
        let Place::Curve(curve) = self.place(vertex) else { return Some(here - normal * height(here)) };
        let mut at = *here;
        for _ in 0..FOOT_STEPS {
            let tangent = self.curves[curve].closest(&at)?.tangent;
            let rise = tangent.dot(normal);
            at = self.home(vertex, &(at - tangent * (height(&at) / rise)));
        }
        at.iter().all(|x| x.is_finite()).then_some(at)
    }

    /// Places near a vertex on its curve or surface.
    fn slides(&self, vertex: VertexId) -> Vec<Vec3> {
        let here = self.point(vertex);
        let Some(directions) = self.directions(vertex, &here) else { return Vec::new() };
        let shortest =
            self.brep.topology.neighbours(vertex).map(|n| (self.point(n) - here).norm()).fold(f64::INFINITY, f64::min);
        let steps = SLIDES.iter().flat_map(|s| directions.iter().map(move |d| here + d * (s * shortest)));
        steps.map(|to| self.home(vertex, &to)).collect()
    }
}
