//! Smallest and largest eigenvalue of a symmetric positive definite matrix that is only multiplied with vectors.

use super::stiffness::Spectrum;

/// Relative change of both ends between looks at which they count as settled.
const SETTLED: f64 = 1e-10;
/// Looks are taken after a third more steps each: a plateau of that length is not a passing one.
const FIRST_LOOK: usize = 24;
/// More steps than any mesh in the reference scenes needs a tenth of.
const MAX_STEPS: usize = 30_000;

/// Ends of the spectrum of the `n` by `n` matrix that `multiply` (x, y := A x) stands for.
pub fn extremes(n: usize, multiply: impl Fn(&[f64], &mut [f64])) -> Spectrum {
    let mut v = start(n);
    let mut previous = vec![0.0; n];
    let mut w = vec![0.0; n];
    let (mut diagonal, mut off): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
    let mut ends = [0.0f64; 2];
    let mut look = FIRST_LOOK.min(n);
    let mut settled = 0;
    loop {
        multiply(&v, &mut w);
        let beta = off.last().copied().unwrap_or(0.0);
        let alpha = dot(&v, &w);
        w.iter_mut().zip(&v).zip(&previous).for_each(|((w, v), p)| *w -= alpha * v + beta * p);
        diagonal.push(alpha);
        let steps = diagonal.len();
        let next = dot(&w, &w).sqrt();
        let scale = ends[1].max(alpha.abs());
        // An invariant space: the tridiagonal matrix has all that the start vector can show.
        let is_exhausted = next <= f64::EPSILON * scale;
        if steps >= look || is_exhausted || steps >= MAX_STEPS {
            let now = [end_of(&diagonal, &off, false), end_of(&diagonal, &off, true)];
            let is_same = (0..2).all(|k| (now[k] - ends[k]).abs() <= SETTLED * now[k].abs());
            settled = if is_same { settled + 1 } else { 0 };
            ends = now;
            let is_converged = settled >= 2 || is_exhausted || steps >= 3 * n;
            if is_converged || steps >= MAX_STEPS {
                return Spectrum { min: ends[0], max: ends[1], condition: ends[1] / ends[0], is_converged };
            }
            look = steps + steps / 3 + 1;
        }
        off.push(next);
        std::mem::swap(&mut previous, &mut v);
        v.iter_mut().zip(&w).for_each(|(v, w)| *v = w / next);
    }
}

/// A unit vector with a part of every eigenvector, the same every time: a low-discrepancy sequence about 1.
fn start(n: usize) -> Vec<f64> {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let v: Vec<f64> = (1..=n).map(|k| 0.5 + (k as f64 * GOLDEN).fract()).collect();
    let length = dot(&v, &v).sqrt();
    v.into_iter().map(|x| x / length).collect()
}

fn dot(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(a, b)| a * b).sum()
}

/// Largest or smallest eigenvalue of a symmetric tridiagonal matrix by bisection on Sturm counts.
fn end_of(diagonal: &[f64], off: &[f64], is_largest: bool) -> f64 {
    let n = diagonal.len();
    // Number of eigenvalues below x: negative pivots of T - x.
    let below = |x: f64| {
        let mut count = 0;
        let mut pivot = 1.0;
        for k in 0..n {
            let coupling = if k == 0 { 0.0 } else { off[k - 1] * off[k - 1] };
            pivot = diagonal[k] - x - coupling / pivot;
            if pivot == 0.0 {
                pivot = f64::MIN_POSITIVE;
            }
            count += usize::from(pivot < 0.0);
        }
        count
    };
    // Gershgorin's bounds.
    let radius =
        |k: usize| if k == 0 { 0.0 } else { off[k - 1].abs() } + off.get(k).filter(|_| k + 1 < n).map_or(0.0, |b| b.abs());
    let mut lo = (0..n).map(|k| diagonal[k] - radius(k)).fold(f64::INFINITY, f64::min);
    let mut hi = (0..n).map(|k| diagonal[k] + radius(k)).fold(f64::NEG_INFINITY, f64::max);
    let wanted = if is_largest { n } else { 1 };
    loop {
        let middle = 0.5 * (lo + hi);
        if middle <= lo || middle >= hi {
            return middle;
        }
        if below(middle) >= wanted { hi = middle } else { lo = middle }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn second_differences() {
        // Eigenvalues 2 - 2 cos(k pi / (n + 1)).
        for n in [1, 2, 7, 400] {
            let s = extremes(n, |x, y| {
                for k in 0..n {
                    let left = if k == 0 { 0.0 } else { x[k - 1] };
                    y[k] = 2.0 * x[k] - left - x.get(k + 1).copied().unwrap_or(0.0);
                }
            });
            let exact = |k: usize| 2.0 - 2.0 * libm::cos(k as f64 * std::f64::consts::PI / (n + 1) as f64);
            assert!(s.is_converged);
            assert!((s.min / exact(1) - 1.0).abs() < 1e-8, "{n}: {} {}", s.min, exact(1));
            assert!((s.max / exact(n) - 1.0).abs() < 1e-8, "{n}: {} {}", s.max, exact(n));
        }
    }
}
