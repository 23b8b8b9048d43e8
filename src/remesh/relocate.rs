//! Where vertices go.

use super::quality::cosine_of_degrees;
use super::workpiece::{Place, Workpiece};
use crate::geom::Vec3;
use crate::ids::{Id, VertexId};
use crate::patch::curve::project_on_all;
use crate::patch::support::{Support, any_normal_to};

/// What a vertex is to move towards.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Aim {
    /// Its true curve, surface or corner.
    Home,
    /// The middle of its neighbours, weighted so that edges get their wanted lengths.
    Middle,
}

/// Shares of the way that are tried when the whole way is not legal.
const SHARES: [f64; 3] = [1.0, 0.5, 0.25];

/// Smoothing may lower the smallest angle at a vertex as long as it stays above this, in degrees.
const FINE: f64 = 38.0;
/// A vertex that goes home may squeeze triangles to this; later passes repair them.
const SQUEEZED: f64 = 5.0;

/// A corner nearer to its surfaces than this share of the allowed deviation stays where it is.
const AT_HOME: f64 = 1e-6;
/// Volume of three unit normals (sine for two) above which their surfaces meet in a point (a curve).
const INDEPENDENT: f64 = 0.05;

impl Workpiece {
    /// Moves a vertex towards its aim as far as that is legal; whether it moved.
    pub fn relocate_towards(&mut self, vertex: VertexId, aim: Aim) -> bool {
        let from = self.point(vertex);
        let target = match aim {
            Aim::Home => self.true_place(vertex),
            Aim::Middle => self.middle(vertex),
        };
        let Some(target) = target.filter(|t| (t - from).norm_squared() > 0.0) else { return false };
        let ring = self.ring(vertex);
        let before = ring.before;
        let (floor, excess) = match aim {
            Aim::Home => (SQUEEZED, f64::INFINITY),
            Aim::Middle => (FINE, before.excess.max(1.0)),
        };
        let limit = before.cosine.max(cosine_of_degrees(floor));
        let places = SHARES.iter().map(|share| from + (target - from) * *share);
        let mut places = places.map(|step| if aim == Aim::Home { step } else { self.home(vertex, &step) });
        let is_good = |to: &Vec3| ring.plan(to, limit, excess).is_some_and(|e| aim == Aim::Home || e.is_legal());
        let Some(to) = places.find(is_good) else { return false };
        drop(ring);
        self.relocate(vertex, to);
        true
    }

    /// Where a vertex ought to be; `None` if it may not move. Corners made by an intersection of facets, off the
    /// true surfaces, belong where all of these meet.
    pub fn true_place(&self, vertex: VertexId) -> Option<Vec3> {
        let point = self.point(vertex);
        if self.is_movable(vertex) {
            return Some(self.home(vertex, &point));
        }
        if self.is_held(vertex) {
            return None;
        }
        let (mut supports, mut is_home) = (Vec::new(), true);
        for facet in self.brep.topology.facets_at(vertex) {
            let support = self.support_or_plane(facet)?;
            // Patches of neighbouring facets jump: such corners would wander.
            if matches!(*support, Support::Fitted(_)) {
                return None;
            }
            let foot = support.nearest(&point);
            is_home &= (foot.point - point).norm() <= AT_HOME * self.bound_on(facet).along(foot.curvature);
            supports.push((support, foot.normal));
        }
        if is_home {
            return None;
        }
        let mut independent: Vec<(std::sync::Arc<_>, Vec3)> = Vec::new();
        for (support, normal) in supports {
            let rest = match &independent[..] {
                [] => 1.0,
                [(_, a)] => normal.cross(a).norm(),
                [(_, a), (_, b)] => normal.dot(&a.cross(b)).abs(),
                _ => 0.0,
            };
            if rest > INDEPENDENT {
                independent.push((support, normal));
            }
        }
        let supports: Vec<_> = independent.into_iter().map(|s| s.0).collect();
        project_on_all(&point, &supports)
    }

    /// Whether a curved facet that stays as it is has this corner.
    fn is_held(&self, vertex: VertexId) -> bool {
        self.brep
            .topology
            .facets_at(vertex)
            .any(|f| !self.is_treated(f) && self.supports[self.brep.facets[f].surface].is_some())
    }

    /// The middle of the neighbours on the same curve or surface, weighted by 1 / wanted length.
    fn middle(&self, vertex: VertexId) -> Option<Vec3> {
        let on_curve = match self.place(vertex) {
            Place::Corner => return None,
            Place::Curve(_) => true,
            Place::Surface(_) => false,
        };
        let (mut sum, mut weights) = (Vec3::zeros(), 0.0);
        for edge in self.brep.topology.edges_at(vertex) {
            if on_curve && !self.brep.is_feature(edge) {
                continue;
            }
            let other = self.brep.topology.other_end(edge, vertex);
            let weight = 1.0 / self.sizes[other.index()].min(f64::MAX);
            sum += self.point(other) * weight;
            weights += weight;
        }
        (weights > 0.0).then(|| self.home(vertex, &(sum / weights)))
    }

    /// Directions in which a vertex of this kind may move.
    pub fn directions(&self, place: Place, here: &Vec3) -> Option<Vec<Vec3>> {
        match place {
            Place::Corner => None,
            Place::Curve(c) => {
                let tangent = self.curves[c].closest(here)?.tangent;
                Some(vec![tangent, -tangent])
            }
            Place::Surface(s) => {
                let normal = self.supports[s].as_ref()?.nearest(here).normal;
                let u = any_normal_to(&normal);
                let v = normal.cross(&u);
                let diagonal = std::f64::consts::FRAC_1_SQRT_2;
                let (p, q) = ((u + v) * diagonal, (u - v) * diagonal);
                Some(vec![u, v, -u, -v, p, q, -p, -q])
            }
        }
    }
}
