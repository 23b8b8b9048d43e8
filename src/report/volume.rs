//! All that is reported of a volume mesh, and the thresholds it may have to meet.

use super::poor::{PoorTet, poor_tets};
use super::stiffness::{Stiffness, stiffness};
use super::tets::{TetQuality, TetShape};
use super::triangles::TriangleStatistics;
use crate::io::mesh::Mesh;
use crate::scene::model::Thresholds;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;

/// Tetrahedra above the ratio that the terminal shows.
const SHOWN: usize = 10;

/// Statistics of a volume mesh.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct VolumeReport {
    /// Number of nodes.
    pub nodes: u64,
    /// The tetrahedra.
    pub tets: TetQuality,
    /// Those above the ratio with their place, worst first, 1000 at most.
    pub poor: Vec<PoorTet>,
    /// The triangles of interfaces and boundaries.
    pub triangles: TriangleStatistics,
    /// The stiffness matrix, if asked for and if any node is free.
    pub stiffness: Option<Stiffness>,
    /// Volume of each region by name (pieces of one part together).
    pub volumes: BTreeMap<String, f64>,
}

impl VolumeReport {
    /// Of the mesh; `ratio_bound` is the radius-edge ratio that was asked for. The stiffness matrix takes the longest, so it is
    /// computed on demand.
    pub fn new(mesh: &Mesh, ratio_bound: f64, with_stiffness: bool) -> Self {
        let triangles: Vec<_> = mesh.triangles.iter().filter(|t| t.marker != 0).map(|t| mesh.triangle_points(t)).collect();
        let shapes: Vec<TetShape> = mesh.tets.iter().map(|t| TetShape::new(&mesh.tet_points(t))).collect();
        Self {
            nodes: mesh.nodes.len() as u64,
            tets: TetQuality::new(&shapes, ratio_bound),
            poor: poor_tets(mesh, &shapes, ratio_bound),
            triangles: TriangleStatistics::new(&triangles),
            stiffness: if with_stiffness { stiffness(mesh) } else { None },
            volumes: mesh.volumes().into_iter().map(|(r, v)| (mesh.region_name(r), v)).collect(),
        }
    }

    /// The thresholds that are missed, a sentence each.
    pub fn missed(&self, wanted: &Thresholds) -> Vec<String> {
        let condition = self.stiffness.map_or(1.0, |s| s.plain.condition);
        let at_least = [
            ("the smallest dihedral angle", self.tets.min_dihedral.min, wanted.min_dihedral),
            ("the smallest angle of a triangle", self.triangles.min_angle.min, wanted.min_angle),
        ];
        let at_most = [
            ("the largest radius-edge ratio", self.tets.radius_edge.max, wanted.max_ratio),
            ("the largest aspect ratio", self.tets.aspect.max, wanted.max_aspect),
            ("the condition number", condition, wanted.max_condition),
        ];
        let low = at_least.into_iter().filter_map(|(what, is, limit)| {
            limit.filter(|l| is < *l || is.is_nan()).map(|l| format!("{what} is {is:.6}, wanted at least {l}"))
        });
        let high = at_most.into_iter().filter_map(|(what, is, limit)| {
            limit.filter(|l| is > *l || is.is_nan()).map(|l| format!("{what} is {is:.6}, wanted at most {l}"))
        });
        low.chain(high).collect()
    }
}

impl fmt::Display for VolumeReport {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let (tets, triangles) = (&self.tets, &self.triangles);
        writeln!(f, "{} nodes, {} tetrahedra, {} triangles", self.nodes, tets.tets, triangles.triangles)?;
        write!(f, "{} tetrahedra above radius-edge ratio {}", tets.above_bound, tets.ratio_bound)?;
        match self.poor.iter().filter(|p| p.forced.is_some()).count() {
            0 => writeln!(f)?,
            forced => writeln!(f, ", {forced} of them forced by the model")?,
        }
        for poor in self.poor.iter().take(SHOWN) {
            writeln!(f, "  {poor}")?;
        }
        if self.poor.len() > SHOWN {
            writeln!(f, "  .. (all with --json)")?;
        }
        writeln!(f, "\nTetrahedra")?;
        for d in [&tets.radius_edge, &tets.aspect, &tets.min_dihedral, &tets.max_dihedral] {
            write!(f, "{d}")?;
        }
        writeln!(
            f,
            "\nTriangles: {:.1} % under 30 degrees, {:.1} % over 40, edges {:.6} to {:.6}",
            triangles.percent_below_30, triangles.percent_above_40, triangles.min_edge, triangles.max_edge
        )?;
        for d in [&triangles.min_angle, &triangles.max_angle, &triangles.aspect, &triangles.distortion] {
            write!(f, "{d}")?;
        }
        if let Some(s) = &self.stiffness {
            writeln!(f, "\nStiffness matrix (linear elements, potential given outside), {} unknowns", s.unknowns)?;
            for (name, e) in [("as it is", &s.plain), ("Jacobi-scaled", &s.scaled)] {
                let least = if e.is_converged { "" } else { "at least " };
                writeln!(f, "  {name:<14} condition {least}{:.6e}  (eigenvalues {:.6e} to {:.6e})", e.condition, e.min, e.max)?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::mesh::tests::cube;

    #[test]
    fn thresholds_of_the_cube() {
        let report = VolumeReport::new(&cube(), 2.0, true);
        assert_eq!(report.stiffness, None);
        assert_eq!(report.volumes.keys().collect::<Vec<_>>(), ["air", "iron"]);
        // Kuhn's tetrahedra: dihedral angles from 45 to 90, R = sqrt(3)/2 over 1.
        let met = Thresholds { min_dihedral: Some(44.9), max_ratio: Some(0.867), ..Thresholds::default() };
        assert_eq!(report.missed(&met), Vec::<String>::new());
        let missed = Thresholds { min_dihedral: Some(45.1), max_ratio: Some(0.866), ..Thresholds::default() };
        assert_eq!(report.missed(&missed).len(), 2);
        assert!(report.to_string().contains("6 tetrahedra"));
    }
}
