//! Condition number of the stiffness matrix of Laplace's equation with linear elements, potential given on the outer boundary.
//!
//! Both ends of the spectrum come from one Lanczos process (Lanczos 1950; Paige 1972: without reorthogonalisation the extreme
//! values still converge). No factorisation: the crate `faer`, measured for it, takes 210 s of CPU time to compile and fills in
//! like n^(4/3), while this needs the matrix and three vectors.

use super::lanczos;
use crate::ids::Id;
use crate::io::mesh::{Mesh, NodeId, TET_FACES, sorted};
use serde::Serialize;

/// Ends of a spectrum.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct Spectrum {
    /// Smallest eigenvalue.
    pub min: f64,
    /// Largest eigenvalue.
    pub max: f64,
    /// Their quotient, the condition number.
    pub condition: f64,
    /// Whether the iteration settled; if not, the condition number is a lower bound.
    pub is_converged: bool,
}

/// Condition of a mesh for finite elements.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct Stiffness {
    /// Number of unknowns: nodes that are not on the outer boundary.
    pub unknowns: u64,
    /// The matrix as it is. Grows like h^-2, so compare at equal numbers of nodes only.
    pub plain: Spectrum,
    /// Scaled by its diagonal, which takes out the grading of element sizes.
    pub scaled: Spectrum,
}

/// Computes both condition numbers; `None` if no node is free.
///
/// Cost: proportional to the number of tetrahedra times the square root of the condition number.
pub fn stiffness(mesh: &Mesh) -> Option<Stiffness> {
    let matrix = Matrix::assemble(mesh);
    if matrix.rows() == 0 {
        return None;
    }
    let scale: Vec<f64> = (0..matrix.rows()).map(|r| 1.0 / matrix.diagonal(r).sqrt()).collect();
    Some(Stiffness {
        unknowns: matrix.rows() as u64,
        plain: lanczos::extremes(matrix.rows(), |x, y| matrix.multiply(x, y)),
        scaled: lanczos::extremes(matrix.rows(), |x, y| {
            let x: Vec<f64> = x.iter().zip(&scale).map(|(x, s)| x * s).collect();
            matrix.multiply(&x, y);
            y.iter_mut().zip(&scale).for_each(|(y, s)| *y *= s);
        }),
    })
}

/// A sparse matrix by rows.
struct Matrix {
    starts: Vec<usize>,
    columns: Vec<u32>,
    values: Vec<f64>,
}

impl Matrix {
    fn rows(&self) -> usize {
        self.starts.len() - 1
    }

    fn row(&self, r: usize) -> impl Iterator<Item = (u32, f64)> {
        let range = self.starts[r]..self.starts[r + 1];
        self.columns[range.clone()].iter().copied().zip(self.values[range].iter().copied())
    }

    fn diagonal(&self, r: usize) -> f64 {
        self.row(r).find(|(c, _)| *c as usize == r).map_or(1.0, |(_, v)| v)
    }

    fn multiply(&self, x: &[f64], y: &mut [f64]) {
        for (r, y) in y.iter_mut().enumerate() {
            *y = self.row(r).map(|(c, v)| v * x[c as usize]).sum();
        }
    }

    /// Over the free nodes: entry (i, j) of a tetrahedron is its volume times grad i dot grad j.
    fn assemble(mesh: &Mesh) -> Self {
        let free = free_numbers(mesh);
        let rows = free.iter().flatten().count();
        let mut entries: Vec<Vec<(u32, f64)>> = vec![Vec::new(); rows];
        for tet in &mesh.tets {
            let p = mesh.tet_points(tet);
            let six = (p[1] - p[0]).cross(&(p[2] - p[0])).dot(&(p[3] - p[0]));
            // Inward normal of the face opposite to each corner, doubled area long: the gradient times 6 V.
            let normal = [[1, 3, 2], [0, 2, 3], [0, 3, 1], [0, 1, 2]].map(|[i, j, k]| (p[j] - p[i]).cross(&(p[k] - p[i])));
            for i in 0..4 {
                let Some(row) = free[tet.corners[i].index()] else { continue };
                for j in 0..4 {
                    if let Some(column) = free[tet.corners[j].index()] {
                        entries[row as usize].push((column, normal[i].dot(&normal[j]) / (6.0 * six)));
                    }
                }
            }
        }
        let mut matrix = Self { starts: vec![0], columns: Vec::new(), values: Vec::new() };
        for mut row in entries {
            row.sort_by_key(|e| e.0);
            for group in row.chunk_by(|a, b| a.0 == b.0) {
                matrix.columns.push(group[0].0);
                matrix.values.push(group.iter().map(|e| e.1).sum());
            }
            matrix.starts.push(matrix.columns.len());
        }
        matrix
    }
}

/// Row of each node that is not on the outer boundary: on no face of one tetrahedron only.
fn free_numbers(mesh: &Mesh) -> Vec<Option<u32>> {
    let mut faces: Vec<[NodeId; 3]> =
        mesh.tets.iter().flat_map(|t| TET_FACES.map(|f| sorted(f.map(|k| t.corners[k])))).collect();
    faces.sort_unstable();
    let mut is_free = vec![true; mesh.nodes.len()];
    for face in faces.chunk_by(|a, b| a == b).filter(|same| same.len() == 1) {
        face[0].iter().for_each(|v| is_free[v.index()] = false);
    }
    let mut next = 0;
    is_free
        .into_iter()
        .map(|free| {
            free.then(|| {
                next += 1;
                next - 1
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Vec3;
    use crate::io::mesh::Tet;

    #[test]
    fn one_free_node() {
        // A regular octahedron and its centre: the only entry is the sum over 8 corners of |n|^2 / (6 * 6 V).
        let axes = [Vec3::x(), Vec3::y(), Vec3::z()];
        let mut nodes = vec![Vec3::zeros()];
        nodes.extend(axes.iter().flat_map(|a| [*a, -a]));
        let mut tets = Vec::new();
        for (i, j, k) in (0..8).map(|m| (m & 1, m >> 1 & 1, m >> 2 & 1)) {
            tets.push(Tet { corners: [0, 1 + i, 3 + j, 5 + k].map(NodeId), region: 1 });
        }
        let mut mesh = Mesh { nodes: nodes.into(), tets, ..Mesh::default() };
        mesh.orient();
        let s = stiffness(&mesh).unwrap();
        // 6 V = 1, and the face opposite has the doubled area sqrt(3).
        assert_eq!(s.unknowns, 1);
        assert!((s.plain.max - 8.0 * 3.0 / 6.0).abs() < 1e-12 && s.plain.condition == 1.0);
        assert!((s.scaled.max - 1.0).abs() < 1e-12);
    }
}
