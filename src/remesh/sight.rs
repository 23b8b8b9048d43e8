//! What TetGen would split at once: an edge or a triangle in whose smallest sphere a vertex lies. From the vertex one sees it
//! too wide; with room to spare, as what is just outside is inside of the sphere once a neighbour has been split.

use super::quality::{wide_flaw, wide_strain};
use super::workpiece::Workpiece;
use crate::brep::store::EdgeId;
use crate::geom::Vec3;
use crate::ids::{FacetId, VertexId};

/// An edge or triangle, and the vertex that lies deepest in its smallest sphere.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(super) struct Sight {
    eye: VertexId,
    pub base: [VertexId; 2],
    apex: Option<VertexId>,
}

impl Sight {
    /// All vertices that have a share in it.
    pub fn vertices(&self) -> Vec<VertexId> {
        [Some(self.eye), Some(self.base[0]), Some(self.base[1]), self.apex].into_iter().flatten().collect()
    }

    /// The angle's cosine: negative inside of the sphere; `place` tells where a vertex is.
    fn cosine(&self, place: impl Fn(VertexId) -> Vec3) -> f64 {
        self.sphere(&place).cosine(&place(self.eye))
    }

    fn sphere(&self, place: impl Fn(VertexId) -> Vec3) -> Sphere {
        let [a, b] = self.base.map(&place);
        match self.apex {
            None => Sphere::Edge([a, b]),
            Some(c) => Sphere::about_triangle([&a, &b, &place(c)]),
        }
    }

    /// How bad that is, as the flaw of an angle.
    pub fn flaw(&self, place: impl Fn(VertexId) -> Vec3) -> f64 {
        wide_flaw(self.cosine(place))
    }

    /// The same as a square, without a step.
    pub fn strain(&self, place: impl Fn(VertexId) -> Vec3) -> f64 {
        wide_strain(self.cosine(place))
    }
}

/// The smallest sphere of an edge or triangle.
enum Sphere {
    Edge([Vec3; 2]),
    /// Centre of the circumcircle and square of its radius; `None` if the triangle is degenerate.
    Triangle(Option<(Vec3, f64)>),
}

impl Sphere {
    fn about_triangle([a, b, c]: [&Vec3; 3]) -> Self {
        let (u, v) = (b - a, c - a);
        let normal = u.cross(&v);
        let square = normal.norm_squared();
        if square == 0.0 {
            return Self::Triangle(None);
        }
        let center = a + (v.cross(&normal) * u.norm_squared() + normal.cross(&u) * v.norm_squared()) / (2.0 * square);
        Self::Triangle(Some((center, (a - center).norm_squared())))
    }

    /// Whether [`Self::cosine`] is negative, which costs less.
    fn contains(&self, eye: &Vec3) -> bool {
        match self {
            Self::Edge([a, b]) => (a - eye).dot(&(b - eye)) < 0.0,
            Self::Triangle(sphere) => sphere.is_some_and(|(center, square)| (eye - center).norm_squared() < square),
        }
    }

    /// Cosine of the angle under which an edge is seen; of a triangle, the diameter of its sphere across the line of sight.
    fn cosine(&self, eye: &Vec3) -> f64 {
        match self {
            Self::Edge([a, b]) => {
                let (s, t) = (a - eye, b - eye);
                s.dot(&t) / (s.norm() * t.norm()).max(f64::MIN_POSITIVE)
            }
            Self::Triangle(None) => 1.0,
            Self::Triangle(Some((center, square))) => {
                let distance = (eye - center).norm_squared();
                (distance - square) / (distance + square)
            }
        }
    }
}

impl Workpiece {
    /// The worst sight of an edge, if one is too wide. Facets that lie in one plane have no edge between them for TetGen.
    pub fn sight_of_edge(&self, edge: EdgeId) -> Option<Sight> {
        let facets: Vec<FacetId> = self.brep.topology.facets_around(edge).collect();
        if !facets.iter().all(|&f| self.is_worth(f)) {
            return None;
        }
        if facets.len() == 2 && self.are_in_one_plane(&facets) {
            return None;
        }
        let base = self.brep.topology.ends(edge);
        self.worst_sight(base, None)
    }

    /// Whether it is worth the time to clear a facet: strips that stay are split anyway, and neighbouring patches of a fitted
    /// surface do not fit together well.
    fn is_worth(&self, facet: FacetId) -> bool {
        self.support(facet).is_none_or(|s| self.is_treated(facet) && !s.is_fitted())
    }

    /// The worst sight of a treated triangle with acute angles, if one is too wide; others are seen too wide by their corners.
    pub fn sight_of_facet(&self, facet: FacetId) -> Option<Sight> {
        let [a, b, c] = self.corners(facet)?;
        self.support(facet).filter(|_| self.is_worth(facet))?;
        self.worst_sight([a, b], Some(c))
    }

    /// Whether a sight is still there, and the worst of its edge or triangle.
    pub fn is_sight(&self, sight: &Sight) -> bool {
        let [a, b] = sight.base;
        let topology = &self.brep.topology;
        let Some(edge) = topology.edge_between(a, b).filter(|&e| self.is_active(e)) else { return false };
        let now = match sight.apex {
            None => self.sight_of_edge(edge),
            Some(c) => {
                let mut facets = topology.facets_around(edge).filter(|&f| self.is_treated(f));
                facets.find(|&f| self.corners(f).is_some_and(|t| t.contains(&c))).and_then(|f| self.sight_of_facet(f))
            }
        };
        now.as_ref() == Some(sight)
    }

    fn worst_sight(&self, base: [VertexId; 2], apex: Option<VertexId>) -> Option<Sight> {
        let topology = &self.brep.topology;
        let own = || base.into_iter().chain(apex);
        let sphere = Sight { eye: base[0], base, apex }.sphere(|v| self.point(v));
        // Some come more than once, which costs less than to find them out.
        let near = own().flat_map(|v| topology.neighbours(v)).flat_map(|v| topology.neighbours(v));
        let inside = near.filter(|&v| sphere.contains(&self.point(v)) && own().all(|o| o != v));
        let cosines = inside.map(|eye| (sphere.cosine(&self.point(eye)), eye));
        let (_, eye) = cosines.min_by(|p, q| p.0.total_cmp(&q.0).then(p.1.cmp(&q.1)))?;
        Some(Sight { eye, base, apex })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spheres_are_where_they_are() {
        let (a, b, c) = (Vec3::x(), -Vec3::x(), Vec3::y());
        for (eye, is_in) in
            [(Vec3::new(0.0, 0.0, 0.99), true), (Vec3::new(0.0, 0.0, 1.01), false), (Vec3::new(-0.9, 0.5, 0.0), false)]
        {
            for sphere in [Sphere::Edge([a, b]), Sphere::about_triangle([&a, &b, &c])] {
                assert_eq!([sphere.contains(&eye), sphere.cosine(&eye) < 0.0], [is_in; 2]);
            }
        }
        assert_eq!(Sphere::about_triangle([&a, &b, &c]).cosine(&Vec3::zeros()), -1.0);
        let flat = Sphere::about_triangle([&a, &a, &c]);
        assert!(!flat.contains(&Vec3::z()) && flat.cosine(&Vec3::z()) == 1.0);
    }
}
