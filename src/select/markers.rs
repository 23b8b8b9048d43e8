//! Names of interfaces and boundaries.

use crate::arrangement::Arrangement;
use crate::brep::complex::Marker;
use crate::ids::{Id, IdVec, MarkerId, PartId};
use crate::primitive::solid::Solid;
use crate::scene::model::{BoundaryId, BoundarySelection, OUTER, Scene};
use std::collections::BTreeMap;

/// The two parts at an interface in file order, the outside last, and the named boundary on it.
type Key = ([PartId; 2], Option<BoundaryId>);

/// Stands for the outside in a key, so that it sorts behind all parts.
const OUTSIDE: PartId = PartId(u32::MAX);

/// What became of a named boundary.
#[derive(Clone, Debug, Default)]
pub struct Claim {
    /// Whether some facet has its name.
    pub has_facets: bool,
    /// The boundaries that have facets which it names too, and a sub-cell of each.
    pub lost: BTreeMap<BoundaryId, u32>,
}

/// Names of facets.
pub struct Names {
    /// Markers in order of their parts and boundaries.
    pub markers: IdVec<MarkerId, Marker>,
    /// The marker of each retained sub-cell.
    pub marker_of: Vec<MarkerId>,
    /// What became of each named boundary.
    pub claims: IdVec<BoundaryId, Claim>,
}

/// Markers in order of their parts and boundaries, and the marker of each retained sub-cell.
pub fn assign(
    scene: &Scene,
    solids: &[Solid],
    arrangement: &Arrangement,
    kept: &[bool],
    parts_of: impl Fn(usize) -> [Option<PartId>; 2],
) -> Names {
    let mut claims: Vec<Claim> = vec![Claim::default(); scene.boundaries.len()];
    let mut keys: Vec<Option<Key>> = vec![None; kept.len()];
    let mut numbers: BTreeMap<Key, MarkerId> = BTreeMap::new();
    let mut boundaries_at: BTreeMap<PartId, Vec<BoundaryId>> = BTreeMap::new();
    for (id, boundary) in scene.boundaries.enumerate() {
        boundaries_at.entry(boundary.part).or_default().push(id);
    }
    for (cell, _) in kept.iter().enumerate().filter(|k| *k.1) {
        let mut parts = parts_of(cell).map(|p| p.unwrap_or(OUTSIDE));
        parts.sort_unstable();
        // In the order of the file, as the parts and the boundaries of each are.
        let of_parts = parts.iter().filter_map(|p| boundaries_at.get(p)).flatten().copied();
        let mut named = of_parts.filter(|&id| is_of(&scene.boundaries[id].selection, solids, arrangement, cell, parts));
        let first = named.next();
        if let Some(first) = first {
            claims[first.index()].has_facets = true;
            for other in named {
                claims[other.index()].lost.entry(first).or_insert(cell as u32);
            }
        }
        let key = (parts, first);
        numbers.insert((parts, None), MarkerId(0));
        numbers.insert(key, MarkerId(0));
        keys[cell] = Some(key);
    }
    for (k, number) in numbers.values_mut().enumerate() {
        *number = MarkerId::new(k);
    }
    let mut pairs_of = vec![0u32; scene.boundaries.len()];
    for boundary in numbers.keys().filter_map(|key| key.1) {
        pairs_of[boundary.index()] += 1;
    }
    let markers = numbers
        .keys()
        .map(|&(parts, boundary)| {
            let interface = interface_name(scene, parts);
            let name = match boundary {
                None => interface,
                Some(b) => {
                    let is_alone = pairs_of[b.index()] == 1;
                    let name = &scene.boundaries[b].name;
                    if is_alone { name.clone() } else { format!("{name}[{interface}]") }
                }
            };
            let parts_of = parts.map(|p| (p != OUTSIDE).then_some(p));
            let max_edge = scene.interfaces_between(parts_of).map(|(_, i)| i.max_edge).reduce(f64::min);
            Marker { name, parts: parts_of, interface: numbers[&(parts, None)], max_edge }
        })
        .collect();
    let marker_of = keys.iter().map(|k| k.map_or(MarkerId(0), |k| numbers[&k])).collect();
    Names { markers, marker_of, claims: claims.into() }
}

fn interface_name(scene: &Scene, parts: [PartId; 2]) -> String {
    let name = |p: PartId| if p == OUTSIDE { OUTER } else { &scene.parts[p].name };
    format!("{}|{}", name(parts[0]), name(parts[1]))
}

/// Whether a sub-cell of a part's boundary between these parts belongs to a named boundary of it.
fn is_of(selection: &BoundarySelection, solids: &[Solid], arrangement: &Arrangement, cell: usize, parts: [PartId; 2]) -> bool {
    match selection {
        BoundarySelection::Outer => parts[1] == OUTSIDE,
        BoundarySelection::Sides(sides) => arrangement.cells.owners_of(cell).iter().any(|owner| {
            let solid = &solids[owner.leaf.index()];
            let surface = &solid.surfaces[solid.facets.of(owner.facet).surface as usize];
            let from = sides.partition_point(|(leaf, _)| *leaf < owner.leaf);
            let own = sides[from..].iter().take_while(|(leaf, _)| *leaf == owner.leaf);
            own.into_iter().any(|(_, side)| side.as_ref().is_none_or(|s| *s == surface.side))
        }),
    }
}
