//! Parts so thin that TetGen needs very many tetrahedra, to be told before it starts: it would run until its limits, without a
//! mesh.

use super::input::Input;
use crate::diag::{Diagnostic, short};
use crate::io::mesh::RegionNumber;
use std::collections::BTreeMap;

/// Tetrahedra for the area of a thin part over the square of its thickness: at ratio 2.0 they are about as long as it is thick,
/// in it and beside it. (Planar transformer with windings of 35 um: 1.67 million, forecast 1.8; four planes of 18 um: 1.12
/// million, forecast 1.2.)
const PER_SQUARE: f64 = 4.0;
/// Tetrahedra that take TetGen minutes and gigabytes.
const MANY: f64 = 1e7;

/// A warning about the part that needs the most tetrahedra, if these are very many.
pub fn warning(input: &Input) -> Option<Diagnostic> {
    forecast(input).map(|thin| Diagnostic::warning("thin-part", thin))
}

/// What to say of that part.
pub(super) fn forecast(input: &Input) -> Option<String> {
    let mut areas: BTreeMap<RegionNumber, f64> = BTreeMap::new();
    for (triangles, &[front, behind]) in input.triangles.iter().zip(&input.sides) {
        let corners = triangles.iter().map(|t| t.map(|v| input.plc.vertices[v as usize]));
        let area: f64 = corners.map(|[a, b, c]| 0.5 * (b - a).cross(&(c - a)).norm()).sum();
        for region in [front, behind] {
            *areas.entry(region).or_insert(0.0) += area;
        }
    }
    let needs = input.volumes().into_iter().filter_map(|(region, volume)| {
        let area = areas.get(&region)?;
        let thickness = 2.0 * volume / area;
        Some((PER_SQUARE * area / (thickness * thickness), thickness, region))
    });
    let (count, thickness, region) = needs.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|need| need.0 > MANY)?;
    let name = input.regions.get(&region).map_or("", |label| label.name.as_str());
    let thickness = short(thickness);
    Some(format!(
        "part `{name}` is some {thickness} thick: at ratio 2.0 it takes about {count:.0e} tetrahedra; \
         thicken it, or leave it out and give the interface there the condition of a sheet"
    ))
}

#[cfg(test)]
mod tests {
    use super::super::input::PartLabel;
    use super::*;
    use crate::geom::Vec3;

    /// A plate of 1 by 1.
    fn plate(thickness: f64) -> Input {
        let corner = |k: u32| Vec3::new(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2) * thickness);
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let mut input = Input::default();
        input.plc.vertices = (0..8).map(corner).collect();
        input.triangles = quads.map(|[a, b, c, d]| vec![[a, b, c], [a, c, d]]).to_vec();
        input.sides = vec![[0, 1]; 6];
        input.regions.insert(1, PartLabel { name: "foil".into(), span: None });
        input
    }

    #[test]
    fn a_foil_is_told_and_a_sheet_is_not() {
        assert_eq!(forecast(&plate(0.01)), None);
        let told = forecast(&plate(1e-5)).unwrap();
        assert!(told.contains("`foil`") && told.contains("8e10"), "{told}");
    }
}
