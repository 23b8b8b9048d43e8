//! Names of interfaces and boundaries.

use crate::arrangement::Arrangement;
use crate::brep::complex::Marker;
use crate::ids::{Id, IdVec, MarkerId, PartId};
use crate::primitive::solid::Solid;
use crate::scene::model::{BoundaryId, BoundarySelection, Scene};
use std::collections::BTreeMap;

/// The two parts at an interface in file order, the outside last, and the named boundary on it.
type Key = ([PartId; 2], Option<BoundaryId>);

/// Stands for the outside in a key, so that it sorts behind all parts.
const OUTSIDE: PartId = PartId(u32::MAX);

/// Markers in order of their parts and boundaries, and the marker of each retained sub-cell.
pub fn assign(
    scene: &Scene,
    solids: &[Solid],
    arrangement: &Arrangement,
    kept: &[bool],
    parts_of: impl Fn(usize) -> [Option<PartId>; 2],
) -> (IdVec<MarkerId, Marker>, Vec<MarkerId>) {
    let mut keys: Vec<Option<Key>> = vec![None; kept.len()];
    let mut numbers: BTreeMap<Key, MarkerId> = BTreeMap::new();
    for (cell, _) in kept.iter().enumerate().filter(|k| *k.1) {
        let mut parts = parts_of(cell).map(|p| p.unwrap_or(OUTSIDE));
        parts.sort_unstable();
        let key = (parts, boundary_of(scene, solids, arrangement, cell, parts));
        numbers.insert((parts, None), MarkerId(0));
        numbers.insert(key, MarkerId(0));
        keys[cell] = Some(key);
    }
    for (k, number) in numbers.values_mut().enumerate() {
        *number = MarkerId::new(k);
    }
    let markers = numbers
        .keys()
        .map(|&(parts, boundary)| {
            let interface = interface_name(scene, parts);
            let name = match boundary {
                None => interface,
                Some(b) => {
                    let is_alone = numbers.keys().filter(|k| k.1 == Some(b)).count() == 1;
                    let name = &scene.boundaries[b].name;
                    if is_alone { name.clone() } else { format!("{name}[{interface}]") }
                }
            };
            let part = |p: PartId| (p != OUTSIDE).then_some(p);
            Marker { name, parts: parts.map(part), interface: numbers[&(parts, None)] }
        })
        .collect();
    let marker_of = keys.iter().map(|k| k.map_or(MarkerId(0), |k| numbers[&k])).collect();
    (markers, marker_of)
}

fn interface_name(scene: &Scene, parts: [PartId; 2]) -> String {
    let name = |p: PartId| if p == OUTSIDE { "outer" } else { &scene.parts[p].name };
    format!("{}|{}", name(parts[0]), name(parts[1]))
}

/// The first named boundary in the file that a sub-cell belongs to.
fn boundary_of(
    scene: &Scene,
    solids: &[Solid],
    arrangement: &Arrangement,
    cell: usize,
    parts: [PartId; 2],
) -> Option<BoundaryId> {
    scene.boundaries.enumerate().find_map(|(id, boundary)| {
        let is_selected = parts.contains(&boundary.part)
            && match &boundary.selection {
                BoundarySelection::Outer => parts[1] == OUTSIDE,
                BoundarySelection::Side { leaves, side } => arrangement.cells.owners_of(cell).iter().any(|owner| {
                    let solid = &solids[owner.leaf.index()];
                    let surface = &solid.surfaces[solid.facets[owner.facet as usize].surface as usize];
                    leaves.contains(&owner.leaf) && side.as_ref().is_none_or(|s| *s == surface.side)
                }),
            };
        is_selected.then_some(id)
    })
}
