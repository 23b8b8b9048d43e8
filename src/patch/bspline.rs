//! Bicubic B-spline patches fitted to scattered points (thesis 2.6, equations 2.34 to 2.41).
//!
//! The parameters of a point are its coordinates in a plane. A bicubic B-spline reproduces these two coordinates exactly
//! and both energies vanish on them up to a constant, so that of the three components only the height over the plane is left
//! to be solved for: F = |B c - p|² + lambda (c - r)' E (c - r), that is (B'B + lambda E) c = B' p + lambda E r. Here r is the
//! quadric through the points instead of the plane of the thesis, r = 0: where points are far apart, as along the strips of a
//! cylinder, the patch goes on as it is bent. The system is small (25 unknowns for 2 x 2 spans) and dense, so it is solved by
//! Cholesky's method instead of the multigrid of the thesis' library.

use super::plane::Plane;
use super::support::{Foot, Nearest, bending_of_level};
use crate::geom::Vec3;
use nalgebra::{Matrix3, SMatrix, SVector};

/// Smoothing term of the functional.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, serde::Deserialize, serde::Serialize)]
pub enum Energy {
    /// Second derivatives (equation 2.36).
    #[default]
    ThinPlate,
    /// First derivatives (equation 2.37).
    Membrane,
}

/// Weight of the smoothing term as a fraction of the data term's trace. Small, since vertices are exact samples: it only
/// has to choose among the patches that meet them.
const SMOOTHING: f64 = 1e-6;

/// What points must at least tell of a coefficient of their quadric, as a fraction of what they tell of all.
const LEAST_SHARE: f64 = 1e-9;

/// Spans per side of a patch: 5 x 5 control heights for about 15 points.
const SPANS: usize = 2;
const CONTROLS: usize = SPANS + 3;
const UNKNOWNS: usize = CONTROLS * CONTROLS;

/// How far the parameter domain reaches past the points, as a fraction of their extent.
const MARGIN: f64 = 0.05;

/// Newton steps of the projection at most; near the patch two or three do.
const MAX_STEPS: usize = 12;
/// A step of this fraction of a span leaves its square: 1e-8 of a span.
const LAST_STEP: f64 = 1e-4;
/// Determinant of the Hessian, as a fraction of its diagonal's, below which a Newton step is not trusted.
const LEAST_CONVEXITY: f64 = 0.01;

/// Height, gradient, and second derivatives uu, uv, vv.
type Height = (f64, [f64; 2], [f64; 3]);

/// A quadratic form of the control heights.
type Form = SMatrix<f64, UNKNOWNS, UNKNOWNS>;
/// A quadratic form of the controls along one side.
type SideForm = SMatrix<f64, CONTROLS, CONTROLS>;

/// A fitted patch: heights over a plane.
#[derive(Clone, Debug)]
pub struct BsplinePatch {
    plane: Plane,
    axes: [Vec3; 2],
    low: [f64; 2],
    span: [f64; 2],
    /// Heights, rows along the second axis.
    controls: [f64; UNKNOWNS],
    error: f64,
}

impl BsplinePatch {
    /// The patch over `plane` through points with weights, nearly (at least three, not collinear in the plane), with one side
    /// along a direction in the plane; `None` if the points do not determine one.
    pub fn fit(plane: Plane, side: &Vec3, points: &[(Vec3, f64)], energy: Energy) -> Option<Self> {
        let u = side.try_normalize(0.0)?;
        let axes = [u, plane.normal.cross(&u)];
        let flat: Vec<[f64; 2]> = points.iter().map(|(p, _)| axes.map(|a| a.dot(&(p - plane.origin)))).collect();
        let mut low = [f64::INFINITY; 2];
        let mut span = [0.0; 2];
        for k in 0..2 {
            low[k] = flat.iter().map(|q| q[k]).fold(f64::INFINITY, f64::min);
            let high = flat.iter().map(|q| q[k]).fold(f64::NEG_INFINITY, f64::max);
            let extent = high - low[k];
            low[k] -= MARGIN * extent;
            span[k] = extent * (1.0 + 2.0 * MARGIN) / SPANS as f64;
        }
        if !(span[0] > 0.0 && span[1] > 0.0) {
            return None;
        }
        let mut patch = Self { plane, axes, low, span, controls: [0.0; UNKNOWNS], error: 0.0 };
        let samples = || points.iter().zip(&flat).map(|((p, weight), q)| (*q, plane.height(p), *weight));
        let rest = patch.quadric(samples());
        let (mut normal, mut right) = (Form::zeros(), SVector::zeros());
        for (q, height, weight) in samples() {
            let terms = patch.terms(q);
            for (row, x) in terms {
                right[row] += weight * x * height;
                terms.iter().for_each(|(column, y)| normal[(*column, row)] += weight * x * y);
            }
        }
        let smooth = energy_form(energy, span);
        let weight = SMOOTHING * normal.trace() / smooth.trace();
        patch.controls = (normal + smooth * weight).cholesky()?.solve(&(right + smooth * rest * weight)).into();
        let misses = samples().map(|(q, height, weight)| weight.sqrt() * (patch.height(q).0 - height).abs());
        patch.error = misses.fold(0.0, f64::max);
        patch.error.is_finite().then_some(patch)
    }

    /// The control heights of the quadric that meets some heights with weights best: the shape in which the patch is without
    /// energy. A plate that is flat without energy would be flat between the ends of long strips.
    fn quadric(&self, samples: impl Iterator<Item = ([f64; 2], f64, f64)>) -> SVector<f64, UNKNOWNS> {
        let monomials = |[x, y]: [f64; 2], less: f64| SVector::<f64, 6>::from([1.0, x, y, x * x - less, x * y, y * y - less]);
        let (mut normal, mut right) = (SMatrix::<f64, 6, 6>::zeros(), SVector::zeros());
        for (q, height, weight) in samples {
            let row = monomials([0, 1].map(|k| (q[k] - self.low[k]) / self.span[k] - 1.0), 0.0);
            normal += row * row.transpose() * weight;
            right += row * height * weight;
        }
        normal += SMatrix::identity() * (LEAST_SHARE * normal.trace());
        let Some(solved) = normal.cholesky() else { return SVector::zeros() };
        let coefficients = solved.solve(&right);
        // A square has controls that are a third of a span's square less than their own places'.
        let control = |k: usize| monomials([k / CONTROLS, k % CONTROLS].map(|i| i as f64 - 2.0), 1.0 / 3.0).dot(&coefficients);
        SVector::from_fn(|k, _| control(k))
    }

    /// The control heights that the height at plane coordinates is made of, with their shares.
    fn terms(&self, q: [f64; 2]) -> [(usize, f64); 16] {
        let (i, j, wu, wv) = self.basis(q);
        std::array::from_fn(|k| ((i + k / 4) * CONTROLS + j + k % 4, wu[0][k / 4] * wv[0][k % 4]))
    }

    /// Largest distance, along the plane's normal, of the fitted points; of those that count little, as little.
    pub fn error(&self) -> f64 {
        self.error
    }

    /// The closest point of the patch; outside of the domain the patch goes on straight.
    pub fn closest(&self, point: &Vec3) -> Foot {
        let (q, (h, g, hess)) = self.foot(point);
        let n = self.plane.normal;
        let [u, v] = self.axes;
        let gradient = n - u * g[0] - v * g[1];
        let cross = u * v.transpose() + v * u.transpose();
        let hessian: Matrix3<f64> = -(u * u.transpose() * hess[0] + cross * hess[1] + v * v.transpose() * hess[2]);
        Foot {
            point: self.plane.origin + u * q[0] + v * q[1] + n * h,
            normal: gradient.normalize(),
            bending: bending_of_level(&gradient, &hessian),
        }
    }

    /// The closest point as [`BsplinePatch::closest`] gives it; the curvature from the fundamental forms.
    pub fn nearest(&self, point: &Vec3) -> Nearest {
        let (q, (h, g, hess)) = self.foot(point);
        let n = self.plane.normal;
        let [u, v] = self.axes;
        let (e, f, k) = (1.0 + g[0] * g[0], g[0] * g[1], 1.0 + g[1] * g[1]);
        let square = e * k - f * f;
        let mean = 0.5 * (e * hess[2] - 2.0 * f * hess[1] + k * hess[0]) / (square * square.sqrt());
        let gauss = (hess[0] * hess[2] - hess[1] * hess[1]) / (square * square);
        Nearest {
            point: self.plane.origin + u * q[0] + v * q[1] + n * h,
            normal: (n - u * g[0] - v * g[1]) / square.sqrt(),
            curvature: mean.abs() + (mean * mean - gauss).max(0.0).sqrt(),
        }
    }

    /// Plane coordinates of the closest point, and the height there.
    fn foot(&self, point: &Vec3) -> ([f64; 2], Height) {
        let relative = point - self.plane.origin;
        let target = [self.axes[0].dot(&relative), self.axes[1].dot(&relative)];
        let height = self.plane.height(point);
        let enough = LAST_STEP * self.span[0].min(self.span[1]);
        let mut q = target;
        let mut at = self.height(q);
        for _ in 0..MAX_STEPS {
            let step = self.step_to_foot(q, &at, target, height);
            q = [q[0] + step[0], q[1] + step[1]];
            at = self.height(q);
            if step[0] * step[0] + step[1] * step[1] <= enough * enough {
                break;
            }
        }
        (q, at)
    }

    /// Newton's step of half the square of the distance, whose gradient is q - target - rest g and whose Hessian I + g g' -
    /// rest H; without H, which is the foot on the tangent plane, where that is not positive definite.
    fn step_to_foot(&self, q: [f64; 2], at: &Height, target: [f64; 2], height: f64) -> [f64; 2] {
        let (h, g, hess) = at;
        let rest = height - h;
        let down = [target[0] - q[0] + rest * g[0], target[1] - q[1] + rest * g[1]];
        let solve = |rest: f64| {
            let [a, b, c] =
                [1.0 + g[0] * g[0] - rest * hess[0], g[0] * g[1] - rest * hess[1], 1.0 + g[1] * g[1] - rest * hess[2]];
            let determinant = a * c - b * b;
            let step = [(c * down[0] - b * down[1]) / determinant, (a * down[1] - b * down[0]) / determinant];
            (a > 0.0 && determinant > LEAST_CONVEXITY * a * c).then_some(step)
        };
        solve(rest).or_else(|| solve(0.0)).unwrap_or([0.0; 2])
    }

    /// Height with gradient and second derivatives (uu, uv, vv) at plane coordinates.
    fn height(&self, q: [f64; 2]) -> Height {
        let inside = [0, 1].map(|k| q[k].clamp(self.low[k], self.low[k] + self.span[k] * SPANS as f64));
        let (i, j, wu, wv) = self.basis(inside);
        // Value and two derivatives along v of the four control rows.
        let mut rows = [[0.0; 3]; 4];
        for (a, row) in rows.iter_mut().enumerate() {
            for (b, c) in self.controls[(i + a) * CONTROLS + j..][..4].iter().enumerate() {
                for (r, w) in row.iter_mut().zip(&wv) {
                    *r += w[b] * c;
                }
            }
        }
        let sum = |du: usize, dv: usize| wu[du].iter().zip(&rows).map(|(w, row)| w * row[dv]).sum::<f64>();
        let [su, sv] = self.span;
        let g = [sum(1, 0) / su, sum(0, 1) / sv];
        let out = [q[0] - inside[0], q[1] - inside[1]];
        let hess =
            if out == [0.0; 2] { [sum(2, 0) / (su * su), sum(1, 1) / (su * sv), sum(0, 2) / (sv * sv)] } else { [0.0; 3] };
        (sum(0, 0) + g[0] * out[0] + g[1] * out[1], g, hess)
    }

    /// First control row and column and the weights of value and two derivatives, per direction.
    fn basis(&self, q: [f64; 2]) -> (usize, usize, [[f64; 4]; 3], [[f64; 4]; 3]) {
        let locate = |k: usize| {
            let t = ((q[k] - self.low[k]) / self.span[k]).clamp(0.0, SPANS as f64);
            let first = (t as usize).min(SPANS - 1);
            (first, cubic_basis(t - first as f64))
        };
        let ((i, wu), (j, wv)) = (locate(0), locate(1));
        (i, j, wu, wv)
    }
}

/// The four uniform cubic B-splines that live on a span, at t in [0, 1]: values, first and second derivatives.
fn cubic_basis(t: f64) -> [[f64; 4]; 3] {
    let s = 1.0 - t;
    [
        [
            s * s * s / 6.0,
            (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0,
            (3.0 * s * s * s - 6.0 * s * s + 4.0) / 6.0,
            t * t * t / 6.0,
        ],
        [-s * s / 2.0, (3.0 * t * t - 4.0 * t) / 2.0, -(3.0 * s * s - 4.0 * s) / 2.0, t * t / 2.0],
        [s, 3.0 * t - 2.0, 3.0 * s - 2.0, t],
    ]
}

/// The energy as a quadratic form of the control heights, for spans of these lengths.
fn energy_form(energy: Energy, span: [f64; 2]) -> Form {
    let form = |order: usize, length: f64| side_form(order) * length.powi(1 - 2 * order as i32);
    let pair = |a: usize, b: usize| form(a, span[0]).kronecker(&form(b, span[1]));
    match energy {
        Energy::ThinPlate => pair(2, 0) + pair(1, 1) * 2.0 + pair(0, 2),
        Energy::Membrane => pair(1, 0) + pair(0, 1),
    }
}

/// Integrals of products of derivatives of the one-dimensional basis over all spans of length 1, exact: four Gauss points for
/// polynomials of degree 6.
fn side_form(order: usize) -> SideForm {
    const NODES: [(f64, f64); 4] = [
        (-0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
        (-0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
        (0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
        (0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
    ];
    let mut form = SideForm::zeros();
    for (first, (x, w)) in (0..SPANS).flat_map(|s| NODES.map(|n| (s, n))) {
        let weights = cubic_basis(0.5 + 0.5 * x)[order];
        for (a, b) in (0..4).flat_map(|a| (0..4).map(move |b| (a, b))) {
            form[(first + a, first + b)] += 0.5 * w * weights[a] * weights[b];
        }
    }
    form
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sphere_samples(radius: f64, step: f64) -> Vec<(Vec3, f64)> {
        let at = |i: i32, j: i32| {
            let (x, y) = (f64::from(i) * step, f64::from(j) * step);
            Vec3::new(x, y, (radius * radius - x * x - y * y).sqrt())
        };
        (-2..=2).flat_map(|i| (-1..=1).map(move |j| (i, j))).map(|(i, j)| (at(i, j), 1.0)).collect()
    }

    #[test]
    fn nearest_is_closest() {
        let plane = Plane { origin: Vec3::new(0.0, 0.0, 10.0), normal: Vec3::z() };
        let patch = BsplinePatch::fit(plane, &Vec3::x(), &sphere_samples(10.0, 1.0), Energy::ThinPlate).unwrap();
        for p in [Vec3::new(0.3, -0.7, 9.0), Vec3::new(1.5, 0.9, 11.0), Vec3::new(4.0, 0.0, 10.0)] {
            let (foot, near) = (patch.closest(&p), patch.nearest(&p));
            assert_eq!(foot.point, near.point);
            assert!((foot.normal - near.normal).norm() < 1e-14);
            assert!(
                (foot.largest_curvature() - near.curvature).abs() < 1e-12,
                "{} {}",
                foot.largest_curvature(),
                near.curvature
            );
        }
    }

    #[test]
    fn basis_sums_to_one_and_its_derivatives_to_zero() {
        for t in [0.0, 0.3, 1.0] {
            let sums = cubic_basis(t).map(|w| w.iter().sum::<f64>());
            assert!((sums[0] - 1.0).abs() < 1e-15 && sums[1].abs() < 1e-15 && sums[2].abs() < 1e-15);
        }
    }

    #[test]
    fn plane_points_give_the_plane() {
        let plane = Plane::new(Vec3::zeros(), Vec3::z()).unwrap();
        let samples = sphere_samples(100.0, 10.0);
        let points: Vec<(Vec3, f64)> = samples.iter().map(|(p, w)| (Vec3::new(p.x, p.y, 1.0 + 0.1 * p.x), *w)).collect();
        let patch = BsplinePatch::fit(plane, &Vec3::x(), &points, Energy::ThinPlate).unwrap();
        assert!(patch.error() < 1e-9);
        let foot = patch.closest(&Vec3::new(5.0, 3.0, 4.0));
        assert!((foot.point.z - 1.0 - 0.1 * foot.point.x).abs() < 1e-9);
        assert!(foot.bending.norm() < 1e-9);
    }

    #[test]
    fn fifteen_points_of_the_thesis_sphere_give_it_to_a_percent() {
        let radius = 100.0;
        let plane = Plane::new(Vec3::new(0.0, 0.0, radius), Vec3::z()).unwrap();
        let patch = BsplinePatch::fit(plane, &Vec3::x(), &sphere_samples(radius, 20.0), Energy::ThinPlate).unwrap();
        assert!(patch.error() < 0.01);
        let foot = patch.closest(&Vec3::new(7.0, 4.0, 98.0));
        assert!((foot.point.norm() - radius).abs() < 0.05, "{}", foot.point.norm());
        assert!((foot.mean_curvature() * radius - 1.0).abs() < 0.2, "{}", foot.mean_curvature());
    }
}
