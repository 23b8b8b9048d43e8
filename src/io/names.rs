//! Names and numbers as file formats can hold them.

use super::mesh::{MarkerNumber, Mesh, RegionNumber};
use std::collections::{BTreeMap, BTreeSet};

/// The physical tags of a mesh file: surfaces and volumes share no number (GetDP's `Region[n]` takes every dimension), and no
/// name occurs twice in one dimension.
pub struct Tags {
    /// Tag and name of each region in use.
    pub volumes: BTreeMap<RegionNumber, String>,
    /// Tag and name of each marker in use.
    pub surfaces: BTreeMap<u32, String>,
    /// What is added to a marker to make its tag.
    shift: u32,
}

impl Tags {
    /// Tags for all regions and markers that the mesh uses. Markers keep their numbers unless one is also a region's; then all
    /// of them are shifted by the first power of ten, from 100, above the largest region, so that they stay readable.
    pub fn new(mesh: &Mesh) -> Self {
        let used: BTreeSet<RegionNumber> = mesh.tets.iter().map(|t| t.region).filter(|r| *r != 0).collect();
        let marked: BTreeSet<MarkerNumber> = mesh.triangles.iter().map(|t| t.marker).filter(|m| *m != 0).collect();
        let largest = used.last().copied().unwrap_or(0);
        let shift =
            if used.is_disjoint(&marked) { 0 } else { (2..9).map(|k| 10u32.pow(k)).find(|p| *p > largest).unwrap_or(largest) };
        let volumes = used.iter().map(|r| (*r, name_of(&mesh.regions, *r, "region"))).collect();
        let surfaces = marked.iter().map(|m| (m.saturating_add(shift), name_of(&mesh.markers, *m, "marker"))).collect();
        Self { volumes: unique(volumes), surfaces: unique(surfaces), shift }
    }

    /// The tag of a marker, if it has one (marker 0 has none).
    pub fn surface(&self, marker: MarkerNumber) -> Option<u32> {
        (marker != 0).then(|| marker.saturating_add(self.shift))
    }
}

/// A region's or marker's name in the form that all formats can hold.
pub fn name_of(names: &BTreeMap<u32, String>, number: u32, kind: &str) -> String {
    names.get(&number).map_or_else(|| format!("{kind}{number}"), |name| plain(name))
}

/// Printable ASCII without blanks and quotes: solvers split lines on blanks (NGSolve) and read bytes.
fn plain(name: &str) -> String {
    let letter = |c: char| if c.is_ascii_graphic() && c != '"' { c } else { '_' };
    if name.is_empty() { "_".into() } else { name.chars().map(letter).collect() }
}

/// Numbers the second and later holders of one name.
fn unique(names: BTreeMap<u32, String>) -> BTreeMap<u32, String> {
    let mut seen = BTreeSet::new();
    let mut result = BTreeMap::new();
    for (number, name) in names {
        let fresh = if seen.contains(&name) { format!("{name}_{number}") } else { name };
        seen.insert(fresh.clone());
        result.insert(number, fresh);
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::mesh::tests::cube;

    #[test]
    fn overlapping_numbers_are_shifted_and_names_kept() {
        let mut mesh = cube();
        let tags = Tags::new(&mesh);
        assert_eq!(tags.surface(3), Some(3));
        mesh.triangles.iter_mut().for_each(|t| t.marker -= 2);
        mesh.markers = mesh.markers.into_iter().map(|(k, n)| (k - 2, n)).collect();
        let tags = Tags::new(&mesh);
        assert_eq!(tags.surfaces.keys().copied().collect::<Vec<_>>(), [101, 102, 103]);
        assert_eq!(tags.surfaces[&103], "iron|air");
        assert_eq!(tags.volumes[&1], "iron");
    }

    #[test]
    fn names_become_words_and_stay_different() {
        assert_eq!(plain("air gap \"ü\""), "air_gap____");
        let names = BTreeMap::from([(1, "a".to_string()), (2, "a".to_string())]);
        assert_eq!(unique(names)[&2], "a_2");
    }
}
