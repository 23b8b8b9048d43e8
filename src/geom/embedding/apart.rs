//! Is there a plane between two convex sets?
//!
//! Looked for by the point of a set of differences that is nearest to the origin (Gilbert, Johnson and Keerthi 1988): the plane
//! square to it is the one that parts them most clearly. Whatever rounding does on the way, a plane is only believed if the
//! sets are beyond it by more than rounding.

use crate::geom::Vec3;

/// Directions that are tried: sets that are apart clearly take two or three, others are divided further.
const TRIES: usize = 8;

/// Volume over the product of three edges below which a tetrahedron has no inside: what rounding leaves of none.
const FLAT: f64 = 64.0 * f64::EPSILON;

/// Whether a set certainly leaves out the origin. `lowest` gives the point of the set that is lowest along a direction, and is
/// wrong by `error` times the direction's sum of magnitudes at most; `start` is a first guess of the direction.
pub(super) fn leaves_out_origin(start: Vec3, error: f64, lowest: impl Fn(&Vec3) -> Vec3) -> bool {
    let mut along = start;
    let mut simplex = Simplex { corners: [Vec3::zeros(); 4], count: 0 };
    for _ in 0..TRIES {
        let low = lowest(&along);
        if along.dot(&low) > error * along.lp_norm(1) {
            return true;
        }
        simplex.corners[simplex.count] = low;
        simplex.count += 1;
        match simplex.nearest() {
            Some(nearest) => along = nearest,
            None => return false,
        }
    }
    false
}

/// Up to four points.
struct Simplex {
    corners: [Vec3; 4],
    count: usize,
}

impl Simplex {
    /// The point of the hull that is nearest to the origin; the corners whose hull has it are kept. `None` if it has the origin.
    fn nearest(&mut self) -> Option<Vec3> {
        let [a, b, c, d] = self.corners;
        let (place, kept) = match self.count {
            1 => return Some(a),
            2 => on_segment([a, b]),
            3 => on_triangle([a, b, c]),
            _ => {
                // Sides beyond which the origin is.
                let sides = [[a, b, c, d], [a, b, d, c], [a, c, d, b], [b, c, d, a]].into_iter().filter(|[a, b, c, inner]| {
                    let (u, v, w) = (b - a, c - a, a - inner);
                    let normal = u.cross(&v);
                    let height = normal.dot(&w);
                    normal.dot(a) * height < 0.0 || height.abs() <= FLAT * (u.norm() * v.norm() * w.norm())
                });
                let nearest = sides.map(|[a, b, c, _]| on_triangle([a, b, c]));
                nearest.min_by(|p, q| p.0.norm_squared().total_cmp(&q.0.norm_squared()))?
            }
        };
        (self.corners, self.count) = (kept.corners, kept.count);
        Some(place).filter(|p| *p != Vec3::zeros())
    }

    fn of<const N: usize>(points: [Vec3; N]) -> Self {
        let mut corners = [Vec3::zeros(); 4];
        corners[..N].copy_from_slice(&points);
        Self { corners, count: N }
    }
}

fn on_segment([a, b]: [Vec3; 2]) -> (Vec3, Simplex) {
    let along = b - a;
    let t = -a.dot(&along);
    if t <= 0.0 {
        (a, Simplex::of([a]))
    } else if t >= along.norm_squared() {
        (b, Simplex::of([b]))
    } else {
        (a + along * (t / along.norm_squared()), Simplex::of([a, b]))
    }
}

fn on_triangle([a, b, c]: [Vec3; 3]) -> (Vec3, Simplex) {
    let normal = (b - a).cross(&(c - a));
    // Whether the origin is beyond an edge, as seen along the normal.
    let is_beyond = |p: &Vec3, q: &Vec3| normal.cross(&(q - p)).dot(p) >= 0.0;
    let beyond = [[a, b], [b, c], [c, a]].into_iter().filter(|[p, q]| is_beyond(p, q)).map(on_segment);
    let nearest = beyond.min_by(|p, q| p.0.norm_squared().total_cmp(&q.0.norm_squared()));
    nearest.unwrap_or_else(|| (normal * (normal.dot(&a) / normal.norm_squared()), Simplex::of([a, b, c])))
}
