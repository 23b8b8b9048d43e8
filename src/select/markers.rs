//! Names of interfaces and boundaries.

use crate::arrangement::Arrangement;
use crate::brep::complex::Marker;
use crate::ids::{Id, IdVec, LeafId, MarkerId, PartId};
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
    let (candidates, mut last) = (Candidates::new(scene), None);
    for (cell, _) in kept.iter().enumerate().filter(|k| *k.1) {
        let mut parts = parts_of(cell).map(|p| p.unwrap_or(OUTSIDE));
        parts.sort_unstable();
        let all = candidates.at(scene, arrangement, cell, parts).into_iter();
        let mut named = all.filter(|&id| is_of(&scene.boundaries[id].selection, solids, arrangement, cell, parts));
        let first = named.next();
        if let Some(first) = first {
            claims[first.index()].has_facets = true;
            for other in named {
                claims[other.index()].lost.entry(first).or_insert(cell as u32);
            }
        }
        let key = (parts, first);
        // Neighbours mostly have the same.
        if last.replace(key) != Some(key) {
            numbers.insert((parts, None), MarkerId(0));
            numbers.insert(key, MarkerId(0));
        }
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

/// The named boundaries by what they select: of the very many that a part may have, few can name a sub-cell.
struct Candidates {
    outer: BTreeMap<PartId, Vec<BoundaryId>>,
    of_leaf: BTreeMap<LeafId, Vec<BoundaryId>>,
}

impl Candidates {
    fn new(scene: &Scene) -> Self {
        let mut candidates = Self { outer: BTreeMap::new(), of_leaf: BTreeMap::new() };
        for (id, boundary) in scene.boundaries.enumerate() {
            match &boundary.selection {
                BoundarySelection::Outer => candidates.outer.entry(boundary.part).or_default().push(id),
                BoundarySelection::Sides(sides) => {
                    sides.iter().for_each(|(leaf, _)| candidates.of_leaf.entry(*leaf).or_default().push(id));
                }
            }
        }
        candidates
    }

    /// Those of two parts that may name a sub-cell between them, in the order of the file.
    fn at(&self, scene: &Scene, arrangement: &Arrangement, cell: usize, parts: [PartId; 2]) -> Vec<BoundaryId> {
        let outer = parts.iter().filter_map(|part| self.outer.get(part)).flatten();
        let leaves = arrangement.cells.owners_of(cell).iter().filter_map(|owner| self.of_leaf.get(&owner.leaf)).flatten();
        let mut found: Vec<BoundaryId> =
            outer.chain(leaves).copied().filter(|&id| parts.contains(&scene.boundaries[id].part)).collect();
        found.sort_unstable();
        found.dedup();
        found
    }
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
