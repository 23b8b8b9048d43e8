//! The triangles kept beside polygons: renewing them, and cutting a polygon into them.

use super::local::Touched;
use super::model::Brep;
use super::store::{EdgeId, FinId};
use crate::geom::Vec3;
use crate::geom::polygon::{PolygonError, triangulate};
use crate::ids::{FacetId, VertexId};
use std::collections::HashSet;

impl Brep {
    /// Triangles of `facet` if `kept` stood for `gone` (equal: as it is) and vertices were where `at` says: what a plan would
    /// lead to. Loops of one or two vertices become inner vertices and edges.
    ///
    /// # Errors
    /// If the facet would not be simple in its dominant projection, or flat.
    pub fn triangulation_if(
        &self,
        facet: FacetId,
        [gone, kept]: [VertexId; 2],
        at: impl Fn(VertexId) -> Vec3,
    ) -> Result<Vec<[VertexId; 3]>, PolygonError> {
        let renamed = |v: VertexId| if v == gone { kept } else { v };
        let mut walks: Vec<Vec<VertexId>> =
            self.topology.loops(facet).map(|walk| self.topology.corners(walk).map(renamed).collect()).collect();
        for walk in &mut walks {
            walk.dedup();
            while walk.len() > 1 && walk.first() == walk.last() {
                walk.pop();
            }
        }
        let mut vertices: Vec<VertexId> = walks.iter().flatten().copied().collect();
        vertices.sort_unstable();
        vertices.dedup();
        let points: Vec<Vec3> = vertices.iter().map(|&v| at(v)).collect();
        let slot = |v: &VertexId| vertices.binary_search(v).unwrap_or(0) as u32;
        let walks: Vec<Vec<u32>> = walks.iter().map(|walk| walk.iter().map(slot).collect()).collect();
        let loops: Vec<&[u32]> = walks.iter().map(Vec::as_slice).filter(|walk| walk.len() > 2).collect();
        let chains: Vec<[u32; 2]> = walks.iter().filter(|walk| walk.len() == 2).map(|walk| [walk[0], walk[1]]).collect();
        let lone: Vec<u32> = walks.iter().filter(|walk| walk.len() == 1).map(|walk| walk[0]).collect();
        let triangles = triangulate(&loops, &chains, &lone, &points)?;
        Ok(triangles.into_iter().map(|t| t.map(|k| vertices[k as usize])).collect())
    }

    /// Renews the triangles kept beside a polygon from the present positions.
    ///
    /// # Errors
    /// As [`Brep::triangulation_if`]; the old triangles stay then.
    pub fn retriangulate(&mut self, facet: FacetId) -> Result<(), PolygonError> {
        let same = VertexId(u32::MAX);
        let tiles = self.triangulation_if(facet, [same, same], |v| self.point(v))?;
        self.facets[facet].tiles = if self.topology.triangle(facet).is_some() { Vec::new() } else { tiles };
        Ok(())
    }

    /// Cuts a polygon into the triangles kept beside it: what a strip of a curved side needs before it can be remeshed. Euler
    /// operators: MEKL until one loop is left, then MEF. Two vertices that a diagonal joins must have no edge yet: where facets
    /// meet in nothing but edges and vertices, they have none.
    pub fn divide_facet(&mut self, facet: FacetId) -> Touched {
        let tiles = std::mem::take(&mut self.facets[facet].tiles);
        let fans = Fans::new(&tiles);
        let mut touched = Touched { facets: vec![facet], ..Touched::default() };
        let mut pieces = HashSet::from([facet]);
        let diagonals = fans.diagonals(self, facet);
        let mut later = Vec::new();
        for ends in diagonals {
            match fans.corners(self, &pieces, ends) {
                Some([a, b]) if self.topology.loop_of(a) != self.topology.loop_of(b) => {
                    touched.edges.extend(self.topology.mekl(a, b).ok());
                }
                _ => later.push(ends),
            }
        }
        for ends in later {
            let cut: Option<(EdgeId, FacetId)> =
                fans.corners(self, &pieces, ends).and_then(|[a, b]| self.topology.mef(a, b).ok());
            debug_assert!(cut.is_some(), "the triangles do not tile the facet");
            if let Some((edge, part)) = cut {
                self.set_facet(part, self.facets[facet].clone());
                pieces.insert(part);
                touched.edges.push(edge);
                touched.facets.push(part);
            }
        }
        touched
    }
}

impl Brep {
    /// Makes one polygon of the two facets at an edge, with the triangles of both; the facet that stays, `None` if the edge is
    /// a feature, or if they touch elsewhere, too. Euler operator: KEF.
    pub fn merge_facets(&mut self, edge: EdgeId) -> Option<FacetId> {
        let fins: Vec<FinId> = self.topology.fins_around(edge).collect();
        let &[f, g] = &fins[..] else { return None };
        let [kept, gone] = [f, g].map(|fin| self.topology.facet_of(fin));
        let corners = |facet| -> HashSet<VertexId> {
            self.topology.fins_of_facet(facet).flat_map(|fin| self.topology.fin_ends(fin)).collect()
        };
        if self.is_feature(edge) || corners(kept).intersection(&corners(gone)).count() != 2 {
            return None;
        }
        let tiles: Vec<[VertexId; 3]> = self.triangles(kept).chain(self.triangles(gone)).collect();
        self.topology.kef(g).ok()?;
        self.facets[kept].tiles = tiles;
        Some(kept)
    }
}

/// The triangles of a polygon by directed edge: for each, its third corner.
struct Fans(Vec<([VertexId; 2], VertexId)>);

impl Fans {
    fn new(tiles: &[[VertexId; 3]]) -> Self {
        let mut fans: Vec<_> = tiles.iter().flat_map(|&[a, b, c]| [([a, b], c), ([b, c], a), ([c, a], b)]).collect();
        fans.sort_unstable();
        Self(fans)
    }

    fn apex(&self, ends: [VertexId; 2]) -> Option<VertexId> {
        self.0.binary_search_by(|probe| probe.0.cmp(&ends)).ok().map(|k| self.0[k].1)
    }

    /// Edges with a triangle on both sides that are not edges of the facet.
    fn diagonals(&self, brep: &Brep, facet: FacetId) -> Vec<[VertexId; 2]> {
        let mut rim: Vec<[VertexId; 2]> = brep.topology.fins_of_facet(facet).map(|fin| brep.topology.fin_ends(fin)).collect();
        rim.sort_unstable();
        let inner = self.0.iter().map(|&(ends, _)| ends).filter(|&[a, b]| a < b && self.apex([b, a]).is_some());
        inner.filter(|ends| rim.binary_search(ends).is_err()).collect()
    }

    /// The corners of pieces between which the diagonal lies.
    fn corners(&self, brep: &Brep, pieces: &HashSet<FacetId>, [a, b]: [VertexId; 2]) -> Option<[FinId; 2]> {
        Some([self.corner(brep, pieces, a, b)?, self.corner(brep, pieces, b, a)?])
    }

    /// The corner at `a` whose triangles, from its outgoing to its incoming edge, have an edge to `b`.
    fn corner(&self, brep: &Brep, pieces: &HashSet<FacetId>, a: VertexId, b: VertexId) -> Option<FinId> {
        let topology = &brep.topology;
        let sees = |fin: FinId| {
            if topology.edge_of(fin).is_none() {
                return true;
            }
            let last = topology.fin_ends(topology.prev_fin(fin))[0];
            let mut at = topology.fin_ends(fin)[1];
            for _ in 0..=self.0.len() {
                match self.apex([a, at]) {
                    Some(next) if next == b => return true,
                    Some(next) if next != last => at = next,
                    _ => return false,
                }
            }
            false
        };
        topology.fins_at(a).find(|&fin| pieces.contains(&topology.facet_of(fin)) && sees(fin))
    }
}
