//! Feature curves: where a vertex with one degree of freedom slides.
//!
//! A vertex of an intersection of facetted surfaces lies on both sets of facets, not on both true surfaces: a zigzag about the
//! true curve. Projection on all surfaces at once turns it into that curve.

use super::support::{Foot, Nearest, Support};
use crate::geom::Vec3;
use crate::geom::segment::nearest_on;
use nalgebra::Matrix3;
use std::sync::Arc;

/// The sine of the angle below which two surfaces count as tangent: their crossing is then ill-conditioned by over 1 / sine.
const TANGENT_SINE: f64 = 0.02;

/// Newton steps on a crossing; quadratic convergence needs about four.
const MAX_STEPS: usize = 40;

/// Jumps between patches, in their grain, that a foot may be left in.
const JUMP: f64 = 100.0;

/// Distance, in the patches' grain, beyond which a foot is not on the patches that were meant: half a shortest edge.
const LEAP: f64 = 5000.0;

/// Fraction of the way that may be left for a distance.
const ROUGH: f64 = 1e-6;

/// How well, relative to their extent, the points of a chain must meet a line or circle to be taken for one. Vertices of exact
/// curves agree to rounding; contact may move them by 1e-9 of the model.
const CHAIN_ACCURACY: f64 = 1e-8;

/// A curve along which vertices slide.
#[derive(Clone, Debug)]
pub enum Curve {
    /// Straight: ruling of a cylinder, edge between planes, seam of tangent surfaces.
    Line {
        /// One of its points.
        origin: Vec3,
        /// Unit direction.
        direction: Vec3,
    },
    /// Rim of a surface of revolution.
    Circle {
        /// Centre.
        center: Vec3,
        /// Unit normal of its plane.
        normal: Vec3,
        /// Radius.
        radius: f64,
    },
    /// Points on all of these surfaces, which cross.
    Crossing(Vec<Arc<Support>>),
    /// The chain itself: sharp edges of imports.
    Polyline(Vec<Vec3>),
}

/// A point of a curve with its neighbourhood.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct CurveFoot {
    /// The point.
    pub point: Vec3,
    /// Unit tangent; either sense.
    pub tangent: Vec3,
    /// Curvature, not negative.
    pub curvature: f64,
}

impl Curve {
    /// The curve of a chain of vertices (closed if its ends are equal) on `supports`: a line or a circle if the chain, or its
    /// foot on all supports, lies on one and the supports agree halfway between vertices, else the crossing of the supports,
    /// else the chain itself. That is also taken between sampled surfaces whose samples it consists of: unless an intersection
    /// made it (`is_cut`).
    pub fn of_chain(chain: &[Vec3], supports: &[Arc<Support>], is_cut: bool) -> Self {
        let exact = line_through(chain, supports).or_else(|| circle_through(chain, supports));
        if let Some(curve) = exact {
            return curve;
        }
        let sampled = supports.iter().filter(|s| matches!(***s, Support::Fitted(_))).count();
        let is_sampled = sampled > 1 && !is_cut;
        let crosses = || chain.windows(2).all(|w| project_on_all(&((w[0] + w[1]) * 0.5), supports).is_some());
        let feet: Option<Vec<Vec3>> = chain.iter().map(|p| project_on_all(p, supports)).collect();
        match feet {
            Some(feet) if supports.len() > 1 && !is_sampled && crosses() => {
                // Spheres, and surfaces of revolution about one axis, cross in circles.
                let exact = line_through(&feet, supports).or_else(|| circle_through(&feet, supports));
                exact.unwrap_or_else(|| Self::Crossing(supports.to_vec()))
            }
            _ => Self::Polyline(chain.to_vec()),
        }
    }

    /// The closest point, exact for lines and circles; on a crossing the point that Newton's method finds from `point`;
    /// `None` if it finds none.
    pub fn closest(&self, point: &Vec3) -> Option<CurveFoot> {
        match self {
            Self::Line { origin, direction } => {
                let point = origin + direction * direction.dot(&(point - origin));
                Some(CurveFoot { point, tangent: *direction, curvature: 0.0 })
            }
            Self::Circle { center, normal, radius } => {
                let d = point - center;
                let radial = (d - normal * normal.dot(&d)).try_normalize(0.0)?;
                let tangent = normal.cross(&radial);
                Some(CurveFoot { point: center + radial * *radius, tangent, curvature: 1.0 / radius })
            }
            Self::Crossing(supports) => {
                let point = project_on_all(point, supports)?;
                let (tangent, curvature) = crossing_tangent(&point, supports)?;
                Some(CurveFoot { point, tangent, curvature })
            }
            Self::Polyline(chain) => polyline_foot(chain, point),
        }
    }

    /// The closest point alone.
    pub fn nearest(&self, point: &Vec3) -> Option<Vec3> {
        match self {
            Self::Crossing(supports) => project_on_all(point, supports),
            _ => Some(self.closest(point)?.point),
        }
    }

    /// Distance of a point near the curve to it, to about six digits, and the curvature there.
    pub fn gap(&self, point: &Vec3) -> Option<(f64, f64)> {
        let (at, curvature) = match self {
            Self::Crossing(supports) => {
                let at = newton(point, supports, ROUGH)?;
                (at, crossing_tangent(&at, supports)?.1)
            }
            _ => {
                let foot = self.closest(point)?;
                (foot.point, foot.curvature)
            }
        };
        Some(((at - point).norm(), curvature))
    }
}

/// The point on all of the surfaces that Newton's method with least steps finds from `start`; `None` where they are tangent or
/// it does not converge. With three surfaces: the corner that they share.
pub fn project_on_all(start: &Vec3, supports: &[Arc<Support>]) -> Option<Vec3> {
    Some(on_planes(newton(start, supports, 0.0)?, supports))
}

/// Newton's method until what is left is a fraction `rough` of its first step, or rounding.
fn newton(start: &Vec3, supports: &[Arc<Support>], rough: f64) -> Option<Vec3> {
    let mut point = *start;
    let (mut first, mut last) = (None, f64::NAN);
    let grain = supports.iter().map(|s| s.grain()).fold(0.0, f64::max);
    for _ in 0..MAX_STEPS {
        let step = least_step(&point, supports)?;
        let length = step.norm();
        point += step;
        let enough = (4.0 * f64::EPSILON * point.amax()).max(rough * *first.get_or_insert(length)).max(grain);
        if grain > 0.0 && (point - start).norm() > LEAP * grain {
            return None;
        }
        // What the next step would be, by quadratic convergence.
        let next = length * (length / last) * (length / last);
        if length <= enough || next <= enough || (length >= last && length <= (1e-10 * point.amax()).max(JUMP * grain)) {
            return Some(point);
        }
        last = length;
    }
    None
}

/// The point moved onto the planes among the supports, so that no rounding of other surfaces shows in planar facets.
fn on_planes(point: Vec3, supports: &[Arc<Support>]) -> Vec3 {
    let planes = supports.iter().filter(|s| s.is_plane());
    planes.fold(point, |p, s| s.nearest(&p).point)
}

/// The least step to where the tangent planes of up to three surfaces meet. They cross if their normals span as many directions
/// as there are surfaces.
fn least_step(point: &Vec3, supports: &[Arc<Support>]) -> Option<Vec3> {
    let plane = |s: &Arc<Support>| {
        let Nearest { point: foot, normal, .. } = s.nearest(point);
        (normal, (foot - point).dot(&normal))
    };
    match supports {
        [a] => {
            let (m, s) = plane(a);
            Some(m * s)
        }
        [a, b] => {
            let ((m, s), (n, t)) = (plane(a), plane(b));
            let c = m.dot(&n);
            let square = 1.0 - c * c;
            (square >= TANGENT_SINE * TANGENT_SINE).then(|| (m * (s - c * t) + n * (t - c * s)) / square)
        }
        [a, b, c] => {
            let planes = [plane(a), plane(b), plane(c)];
            let normals = Matrix3::from_rows(&planes.map(|p| p.0.transpose()));
            let volume = normals.determinant();
            let rest = Vec3::new(planes[0].1, planes[1].1, planes[2].1);
            if volume * volume < TANGENT_SINE * TANGENT_SINE { None } else { Some(normals.try_inverse()? * rest) }
        }
        _ => None,
    }
}

/// Tangent and curvature of the curve on the first two surfaces whose normals differ: the component of the curvature vector
/// along each normal is the surface's normal curvature along the tangent.
fn crossing_tangent(point: &Vec3, supports: &[Arc<Support>]) -> Option<(Vec3, f64)> {
    let a = supports.first()?.closest(point);
    let others = supports.iter().skip(1).map(|s| s.closest(point));
    let b: Foot = others.into_iter().find(|f| f.normal.cross(&a.normal).norm() > TANGENT_SINE)?;
    let tangent = a.normal.cross(&b.normal).try_normalize(0.0)?;
    let (ka, kb) = (a.curvature_along(&tangent), b.curvature_along(&tangent));
    let c = a.normal.dot(&b.normal);
    let square = (ka * ka - 2.0 * c * ka * kb + kb * kb) / (1.0 - c * c);
    Some((tangent, square.max(0.0).sqrt()))
}

fn extent(chain: &[Vec3]) -> f64 {
    chain.iter().map(|p| (p - chain[0]).norm()).fold(0.0, f64::max)
}

/// A line if all vertices are on one and the supports hold it: two vertices always have a line through them, but where an
/// intersection of facets made them it is off the true surfaces.
fn line_through(chain: &[Vec3], supports: &[Arc<Support>]) -> Option<Curve> {
    let (first, last) = (*chain.first()?, *chain.last()?);
    let direction = (last - first).try_normalize(0.0)?;
    let allowed = CHAIN_ACCURACY * extent(chain);
    let is_straight = chain.iter().all(|p| (p - first).cross(&direction).norm() <= allowed);
    let exact = || supports.iter().filter(|s| !matches!(***s, Support::Fitted(_)));
    let is_held = |p: &Vec3| exact().all(|s| s.distance(p) <= allowed);
    let holds = |w: &[Vec3]| is_held(&w[0]) && is_held(&w[1]) && is_held(&((w[0] + w[1]) * 0.5));
    (is_straight && chain.windows(2).all(holds)).then_some(Curve::Line { origin: first, direction })
}

/// A circle if all vertices are on one and the supports hold it halfway between the vertices.
fn circle_through(chain: &[Vec3], supports: &[Arc<Support>]) -> Option<Curve> {
    if chain.len() < 3 {
        return None;
    }
    let is_closed = chain.first() == chain.last();
    let open = if is_closed { &chain[..chain.len() - 1] } else { chain };
    if open.len() < 3 {
        return None;
    }
    let (a, b, c) = (open[0], open[open.len() / 3], open[if is_closed { 2 * open.len() / 3 } else { open.len() - 1 }]);
    let (u, v) = (b - a, c - a);
    let cross = u.cross(&v);
    let square = cross.norm_squared();
    let offset = (v.cross(&cross) * -u.norm_squared() + u.cross(&cross) * v.norm_squared()) * (-0.5 / square);
    if square <= 0.0 || !offset.iter().all(|x| x.is_finite()) {
        return None;
    }
    // A plane support gives the exact normal and level.
    let plane = supports.iter().find_map(|s| match **s {
        Support::Plane(p) if p.normal.cross(&cross).norm() <= 1e-6 * square.sqrt() => Some(p),
        _ => None,
    });
    let normal = plane.map_or_else(|| cross.normalize(), |p| p.normal);
    let center = plane.map_or(a + offset, |p| p.closest(&(a + offset)).point);
    let radius = (a - center).norm();
    let allowed = CHAIN_ACCURACY * radius.max(extent(chain));
    let curve = Curve::Circle { center, normal, radius };
    let holds = |p: &Vec3| curve.closest(p).is_some_and(|f| (f.point - p).norm() <= allowed);
    let between = |w: &[Vec3]| {
        let foot = curve.closest(&((w[0] + w[1]) * 0.5));
        foot.is_some_and(|f| supports.iter().all(|s| s.distance(&f.point) <= allowed))
    };
    (chain.iter().all(holds) && chain.windows(2).all(between)).then_some(curve)
}

fn polyline_foot(chain: &[Vec3], point: &Vec3) -> Option<CurveFoot> {
    let mut best: Option<(f64, CurveFoot)> = None;
    for w in chain.windows(2) {
        let d = w[1] - w[0];
        let square = d.norm_squared();
        if square == 0.0 {
            continue;
        }
        let foot = nearest_on(point, [&w[0], &w[1]]);
        let distance = (foot - point).norm_squared();
        if best.is_none_or(|b| distance < b.0) {
            best = Some((distance, CurveFoot { point: foot, tangent: d / square.sqrt(), curvature: 0.0 }));
        }
    }
    best.map(|b| b.1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::patch::analytic::Cone;
    use crate::patch::plane::Plane;
    use crate::scene::model::Frame;

    fn cylinder(axis: usize, radius: f64) -> Arc<Support> {
        let mut axes = [Vec3::x(), Vec3::y(), Vec3::z()];
        axes.rotate_left((axis + 1) % 3);
        let frame = Frame { origin: Vec3::zeros(), x: axes[0], y: axes[1], z: axes[2] };
        Arc::new(Support::Cone(Cone::new(frame, radius, 0.0)))
    }

    #[test]
    fn newton_reaches_the_curve_of_two_cylinders() {
        let both = [cylinder(2, 50.0), cylinder(0, 40.0)];
        let p = project_on_all(&Vec3::new(40.0, 29.0, 26.0), &both).unwrap();
        assert!((libm::hypot(p.x, p.y) - 50.0).abs() < 1e-12 && (libm::hypot(p.y, p.z) - 40.0).abs() < 1e-12);
    }

    #[test]
    fn three_equal_cylinders_meet_in_a_corner() {
        let all = [cylinder(0, 50.0), cylinder(1, 50.0), cylinder(2, 50.0)];
        let p = project_on_all(&Vec3::new(36.0, 34.0, 35.0), &all).unwrap();
        assert!((p - Vec3::repeat(50.0 / 2f64.sqrt())).norm() < 1e-11);
        // Two of them are tangent on the axis of the third.
        assert!(project_on_all(&Vec3::new(0.0, 0.0, 50.0), &all[..2]).is_none());
    }

    #[test]
    fn a_rim_is_a_circle_in_its_plane() {
        let plane = Arc::new(Support::Plane(Plane::new(Vec3::new(0.0, 0.0, 0.1), Vec3::z()).unwrap()));
        let at = |k: i32| {
            let a = f64::from(k % 24) * std::f64::consts::TAU / 24.0;
            Vec3::new(50.0 * libm::cos(a), 50.0 * libm::sin(a), 0.1)
        };
        let chain: Vec<Vec3> = (0..=24).map(at).collect();
        let curve = Curve::of_chain(&chain, &[cylinder(2, 50.0), plane], false);
        assert!(matches!(curve, Curve::Circle { .. }));
        let foot = curve.closest(&Vec3::new(3.0, 4.0, 7.0)).unwrap();
        assert!((foot.point - Vec3::new(30.0, 40.0, 0.1)).norm() < 1e-12 && foot.point.z == 0.1);
        assert!((foot.curvature - 0.02).abs() < 1e-15);
    }

    #[test]
    fn curvature_of_an_ellipse_on_a_cylinder() {
        // x = y on the unit cylinder about x: an ellipse with half axes sqrt 2 and 1; at (1, 1, 0) its curvature is sqrt 2.
        let plane = Arc::new(Support::Plane(Plane::new(Vec3::zeros(), Vec3::new(1.0, -1.0, 0.0)).unwrap()));
        let curve = Curve::Crossing(vec![cylinder(0, 1.0), plane]);
        let foot = curve.closest(&Vec3::new(1.0, 1.0, 0.0)).unwrap();
        assert!((foot.curvature - 2f64.sqrt()).abs() < 1e-12, "{}", foot.curvature);
    }
}
