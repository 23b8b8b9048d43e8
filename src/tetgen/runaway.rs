//! Whether TetGen ran away: refined without end, and stopped for another reason than that the mesh is good.
//!
//! Where small angles of the complex keep tetrahedra from being good, TetGen leaves them: a few at each such vertex. But at
//! times its points encroach on each other's segments in turn, and it cuts down to edges as short as rounding allows. What it
//! then returns is a valid mesh of a hundred times as many tetrahedra as another attempt makes, most of the new ones as bad as
//! before. Measured on wholly remeshed scenes: up to 4.5 % above the ratio and 1.3 such per vertex of the complex (via_array
//! 3.2 %, coax 1.7 %, transformer3 1.4 %); a cone of 25 vertices 80 %, 4.5 per vertex. A microstrip of 1779 vertices, remeshed
//! by a build since mended, ended with 3.6 million tetrahedra, a fifth of them above: 404 per vertex.

use crate::geom::Vec3;
use crate::io::mesh::Mesh;

/// More than this share of tetrahedra above the wanted ratio is seldom what refinement leaves.
const SHARE: f64 = 0.03;
/// And more than so many for each vertex of the complex are not what its own small angles force: a vertex has some 25
/// tetrahedra, and five times what the cone has.
const PER_VERTEX: usize = 25;

/// What is to be said of a mesh that TetGen made when it ran away from a complex of so many vertices.
pub(super) fn verdict(mesh: &Mesh, ratio: f64, vertices: usize) -> Option<String> {
    let (count, bad) = (mesh.tets.len(), mesh.tets.iter().filter(|t| is_above(mesh.tet_points(t), ratio)).count());
    let is_runaway = bad as f64 > SHARE * count as f64 && bad > PER_VERTEX * vertices;
    is_runaway.then(|| {
        let share = 100.0 * bad as f64 / count as f64;
        format!("refined without end: {count} tetrahedra, {share:.0} % of them above the ratio")
    })
}

/// Whether the circumradius is larger than so many shortest edges.
fn is_above(p: [Vec3; 4], ratio: f64) -> bool {
    let (a, b, c) = (p[1] - p[0], p[2] - p[0], p[3] - p[0]);
    let doubled = 2.0 * a.dot(&b.cross(&c));
    let center = a.norm_squared() * b.cross(&c) + b.norm_squared() * c.cross(&a) + c.norm_squared() * a.cross(&b);
    let edges = [a, b, c, b - a, c - a, c - b].map(|e| e.norm_squared());
    let shortest = edges.into_iter().fold(f64::INFINITY, f64::min);
    doubled == 0.0 || center.norm_squared() > ratio * ratio * shortest * doubled * doubled
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ratios_of_a_corner_and_a_needle() {
        // The corner of a cube has 0.75f64.sqrt() = 0.866.
        let corner = |h: f64| [Vec3::zeros(), Vec3::x(), Vec3::y(), Vec3::z() * h];
        assert!(is_above(corner(1.0), 0.86) && !is_above(corner(1.0), 0.87));
        assert!(is_above(corner(10.0), 2.0));
        assert!(is_above([Vec3::zeros(), Vec3::x(), Vec3::y(), Vec3::new(1.0, 1.0, 0.0)], 2.0), "a flat one");
    }
}
