//! What a result must satisfy to count.

use super::input::Input;
use crate::geom::Vec3;
use crate::geom::predicates::orient3d;
use crate::io::mesh::{Mesh, Tet};
use std::collections::BTreeMap;

/// Largest relative difference of a region's volume or a marker's area from the complex.
pub const TOLERANCE: f64 = 1e-9;

/// A tetrahedron whose volume is a smaller fraction of its longest edge cubed has no usable element matrix: to a solver it is
/// flat.
const LEAST_THICKNESS: f64 = 1e-13;

fn thickness([a, b, c, d]: &[Vec3; 4]) -> f64 {
    let longest = [b - a, c - a, d - a, c - b, d - b, d - c].iter().map(Vec3::norm_squared).fold(0.0, f64::max);
    (b - a).cross(&(c - a)).dot(&(d - a)).abs() / (6.0 * longest * longest.sqrt())
}

/// Compares a mesh with the complex that it is to be one of: every region's volume, every marker's area, and that no
/// tetrahedron is flat or turned over. The tetrahedra must be in TetGen's order of corners.
///
/// # Errors
/// What is wrong, a sentence each.
pub fn verify(mesh: &Mesh, input: &Input) -> Result<(), Vec<String>> {
    let mut faults = Vec::new();
    let sign = |t: &Tet| {
        let [a, b, c, d] = mesh.tet_points(t);
        orient3d(&a, &b, &c, &d)
    };
    // TetGen orders all tetrahedra alike; which way is a matter of its version.
    let usual = mesh.tets.first().map_or(1, sign);
    let flat = mesh.tets.iter().filter(|t| sign(t) != usual || usual == 0).count();
    let thin = mesh.tets.iter().filter(|t| thickness(&mesh.tet_points(t)) < LEAST_THICKNESS).count();
    if flat.max(thin) > 0 {
        faults.push(format!("{} tetrahedra are flat or turned over", flat.max(thin)));
    }
    let name = |r: u32| input.regions.get(&r).map_or_else(|| format!("region {r}"), |label| format!("`{}`", label.name));
    let volumes = mesh.volumes().into_iter().map(|(r, v)| (r, v.abs())).collect();
    compare(&input.volumes(), &volumes, |r| format!("the volume of {}", name(r)), &mut faults);
    let mut areas = BTreeMap::new();
    for t in mesh.triangles.iter().filter(|t| t.marker != 0) {
        let [a, b, c] = mesh.triangle_points(t);
        *areas.entry(t.marker).or_insert(0.0) += 0.5 * (b - a).cross(&(c - a)).norm();
    }
    let mut expected = input.areas();
    expected.remove(&0);
    let name = |m: u32| input.markers.get(&m).map_or_else(|| format!("marker {m}"), |n| format!("`{n}`"));
    compare(&expected, &areas, |m| format!("the area of {}", name(m)), &mut faults);
    if faults.is_empty() { Ok(()) } else { Err(faults) }
}

fn compare(expected: &BTreeMap<u32, f64>, found: &BTreeMap<u32, f64>, name: impl Fn(u32) -> String, faults: &mut Vec<String>) {
    for (number, want) in expected {
        let got = found.get(number).copied().unwrap_or(0.0);
        let difference = (got - want).abs();
        if difference > TOLERANCE * want.abs() || difference.is_nan() {
            faults.push(format!("{} is {got:?} instead of {want:?}", name(*number)));
        }
    }
    for number in found.keys().filter(|n| !expected.contains_key(n)) {
        faults.push(format!("{} should not be there", name(*number)));
    }
}
