//! Kill, retain or flip by the decision table, per Boolean node, then per part; what is left is merged to polygons.
//!
//! Reads a classified arrangement, gives `round` a [`Selected`] set of polygonal facets over exact points.
//!
//! A sub-cell is retained when it is *on* the boundary of what some part claims. Its class against a Boolean node follows from
//! its classes against the operands ([`table`], thesis Table 2.4); the parts in front and behind are the last ones in the file
//! that claim these sides. Retained neighbours that come from one facet of one leaf, separate the same parts and carry the same
//! marker are merged: no diagonal and no edge of a killed facet survives.

pub mod decide;
mod markers;
mod merge;
pub mod table;

pub use markers::Claim;
pub use merge::merge;

use crate::arrangement::Arrangement;
use crate::brep::complex::Marker;
use crate::classify::Classified;
use crate::cull::Fate;
use crate::geom::hash::IndexMap;
use crate::geom::union_find::UnionFind;
use crate::ids::{IdVec, LeafId, MarkerId, PartId};
use crate::primitive::solid::Solid;
use crate::scene::model::{BoundaryId, Scene};
use rayon::prelude::*;

/// Sub-cells or edges that one thread takes at once: each takes a few memory accesses.
const SHARE: usize = 1 << 14;

/// Retained facets over the points of the arrangement.
pub struct Selected {
    /// Facets, in order of their first sub-cell.
    pub facets: Vec<SelectedFacet>,
    /// Markers in use.
    pub markers: IdVec<MarkerId, Marker>,
    /// What became of the named boundaries.
    pub claims: IdVec<BoundaryId, Claim>,
    /// Sub-cells that were dropped.
    pub killed: Vec<u32>,
    /// Part of each volume (`None`: nobody's); volumes are what `SelectedFacet::volumes` numbers.
    pub part_of_volume: Vec<Option<PartId>>,
    /// Areas of the sub-cells where two parts claim the same space.
    pub overlaps: Vec<decide::Overlap>,
}

/// A polygon with two sides.
#[derive(Clone, Debug)]
pub struct SelectedFacet {
    /// Loops of point numbers, outer first; the facet lies to the left.
    pub loops: Vec<Vec<u32>>,
    /// Connected volumes of the arrangement in front and behind (nested components not yet joined).
    pub volumes: [u32; 2],
    /// The leaf's facet that it is a piece of.
    pub source: (LeafId, u32),
    /// Whether the source facet's outward normal is opposite to the facet's orientation.
    pub is_flipped: bool,
    /// Its name.
    pub marker: MarkerId,
    /// Whether it is less than its source facet.
    pub is_partial: bool,
}

/// Selects and merges.
pub fn select(scene: &Scene, solids: &[Solid], arrangement: &Arrangement, classified: &Classified) -> Selected {
    let decision = decide::Decision::new(scene, classified);
    let parts_beside = |cell: usize| decision.parts_beside(classified, cell, arrangement.cells.fate_of(cell));
    let is_kept = |cell: usize| parts_beside(cell)[0] != parts_beside(cell)[1];
    let kept: Vec<bool> = (0..arrangement.cells.len()).into_par_iter().with_min_len(SHARE).map(is_kept).collect();
    let killed = (0..kept.len() as u32).filter(|&cell| !kept[cell as usize]).collect();
    let (volume_of_shell, count) = volumes(arrangement, classified, &kept);
    let volumes_of = |cell: usize| classified.shells[cell].map(|s| volume_of_shell[s as usize]);
    let mut part_of_volume = vec![None; count];
    for cell in (0..kept.len()).filter(|&cell| kept[cell]) {
        let [front, back] = volumes_of(cell).map(|v| v as usize);
        [part_of_volume[front], part_of_volume[back]] = parts_beside(cell);
    }
    let names = markers::assign(scene, solids, arrangement, &kept, |cell| volumes_of(cell).map(|v| part_of_volume[v as usize]));
    let source_of = sources(arrangement, classified, &decision, &kept);
    let facets = merge(arrangement, &classified.edges, &kept, &names.marker_of, &source_of, volumes_of);
    let markers::Names { markers, claims, .. } = names;
    Selected { facets, markers, claims, killed, part_of_volume, overlaps: decision.overlaps }
}

/// Shells between which no retained facet stands are one volume: the volume of each, and their number.
///
/// What is known to lie inside a volume was not cut by what it crosses, so it may seem to lie on both sides of a facet of the
/// result: it never tells which sides face each other, retained pieces alone do.
fn volumes(arrangement: &Arrangement, classified: &Classified, kept: &[bool]) -> (Vec<u32>, usize) {
    let fate = |cell: usize| arrangement.cells.fate_of(cell);
    let mut sets = UnionFind::new(classified.label_of_shell.len());
    for (cell, &[front, back]) in classified.shells.iter().enumerate() {
        if !kept[cell] && fate(cell) == Fate::Live {
            sets.join(front, back);
        }
    }
    let edges = &classified.edges;
    let shell = |side: u32| classified.shells[side as usize / 2][side as usize % 2];
    let cell_of = |corner: u32| edges.cell_of[corner as usize] as usize;
    let mut alive = Vec::new();
    let is_known = |group: &[u32]| group.iter().any(|&c| fate(cell_of(c)) != Fate::Live);
    let groups = edges.groups().take_while(|_| arrangement.cells.has_fates());
    for group in groups.filter(|g| is_known(g)) {
        alive.clear();
        alive.extend(group.iter().copied().filter(|&c| kept[cell_of(c)]));
        for [a, b] in edges.facing_in(&alive) {
            sets.join(shell(a), shell(b));
        }
    }
    sets.number()
}

/// For each retained sub-cell, which of its owners it counts as a piece of.
fn sources(arrangement: &Arrangement, classified: &Classified, decision: &decide::Decision, kept: &[bool]) -> Vec<u32> {
    let cells = &arrangement.cells;
    let mut known: IndexMap<(u32, u32), u32> = IndexMap::default();
    let mut choose = |cell: usize| {
        let owners = cells.owners_of(cell);
        if !kept[cell] || owners.len() < 2 || cells.fate_of(cell) != Fate::Live {
            return 0;
        }
        let label = classified.label_of_shell[classified.shells[cell][0] as usize];
        let find = || decision.source_of(&classified.labels[label as usize], owners) as u32;
        *known.entry((label, cells.owners[cell])).or_insert_with(find)
    };
    (0..cells.len()).map(&mut choose).collect()
}
