//! Vertices about which triangles lie like the sectors of a disc, seen along a coordinate axis.
//!
//! Two of them then meet in the vertex and in the edge that they share, if they do, and nowhere else: their sectors are apart
//! otherwise. On a smooth surface nearly all vertices are such, and most pairs of triangles that are near each other share one;
//! a round of comparisons settles all pairs about it at once.

use crate::geom::Vec3;
use crate::geom::lists::Lists;
use crate::geom::predicates::{Projection, orient2d};
use rayon::prelude::*;

/// Triangles about a vertex from which on it is not looked at: the search for the next sector goes over all.
const MANY: usize = 32;

/// For every point whether its triangles are sectors of a disc. `projections`: one for each triangle in which it is
/// counter-clockwise. O(n).
pub(super) fn discs(points: &[Vec3], triangles: &[[u32; 3]], projections: &[Option<Projection>]) -> Vec<bool> {
    let uses = Lists::from_iter(points.len(), triangles.iter().zip(0..).flat_map(|(t, k)| t.map(|v| (v, k))));
    let is_disc = |center: u32| -> Option<bool> {
        let around = uses.of(center);
        let projection = projections[*around.first()? as usize]?;
        let mut sectors = [[0; 2]; MANY];
        for (sector, &t) in sectors.get_mut(..around.len())?.iter_mut().zip(around) {
            let corners = triangles[t as usize];
            let k = corners.iter().position(|&v| v == center)?;
            let [a, b, c] = corners.map(|v| projection.apply(&points[v as usize]));
            if projections[t as usize]? != projection && orient2d(a, b, c) <= 0 {
                return None;
            }
            *sector = [corners[(k + 1) % 3], corners[(k + 2) % 3]];
        }
        Some(is_once_round(&sectors[..around.len()], |v| is_lower(v, center, points, projection)))
    };
    (0..points.len() as u32).into_par_iter().with_min_len(1024).map(|v| is_disc(v).unwrap_or(false)).collect()
}

/// Whether a point lies, seen from a centre, in the lower half of the plane: at an angle from half a turn to a whole one.
fn is_lower(v: u32, center: u32, points: &[Vec3], projection: Projection) -> bool {
    let [p, c] = [v, center].map(|v| projection.apply(&points[v as usize]));
    p[1] < c[1] || p[1] == c[1] && p[0] < c[0]
}

/// Whether sectors, each less than half a turn from its first to its second end, follow each other once round.
fn is_once_round(sectors: &[[u32; 2]], is_lower: impl Fn(u32) -> bool) -> bool {
    let start = sectors[0][0];
    let (mut at, mut rounds) = (start, 0);
    for step in 1..=sectors.len() {
        let Some(&[_, next]) = sectors.iter().find(|s| s[0] == at) else { return false };
        // Every round passes the angle 0 once, from the lower to the upper half.
        rounds += u32::from(is_lower(at) && !is_lower(next));
        at = next;
        if at == start {
            return step == sectors.len() && rounds == 1;
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::super::projection_of;
    use super::*;

    fn is_disc(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> bool {
        let points: Vec<Vec3> = points.iter().map(|&p| p.into()).collect();
        let projections: Vec<_> = triangles.iter().map(|t| projection_of(t.map(|v| points[v as usize]))).collect();
        discs(&points, triangles, &projections)[0]
    }

    #[test]
    fn a_flat_roof_is_a_disc_and_what_goes_round_twice_or_is_open_is_none() {
        let corner = |k: u32| {
            let angle = 0.3 + f64::from(k) * 0.8 * std::f64::consts::PI;
            [libm::cos(angle), libm::sin(angle), 0.0]
        };
        let points = |center: f64| [[0.0, 0.0, center]].into_iter().chain((0..5).map(corner)).collect::<Vec<_>>();
        // Corners 1 to 5 lie two fifths of a turn apart: in this order they go round twice.
        let twice = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5], [0, 5, 1]];
        let once = [[0, 1, 4], [0, 4, 2], [0, 2, 5], [0, 5, 3], [0, 3, 1]];
        assert!(is_disc(&points(0.0), &once) && is_disc(&points(0.2), &once));
        assert!(!is_disc(&points(0.0), &twice) && !is_disc(&points(0.2), &twice));
        assert!(!is_disc(&points(0.0), &once[1..]));
        // From a steep roof no side is seen along the axis of another.
        assert!(!is_disc(&points(9.0), &once));
        let turned = [[0, 4, 1], once[1], once[2], once[3], once[4]];
        assert!(!is_disc(&points(0.0), &turned));
        assert!(!is_disc(&points(0.0), &[once[0], once[1], once[2], once[3], once[4], once[4]]));
    }
}
