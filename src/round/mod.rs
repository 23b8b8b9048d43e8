//! Exact facets to `f64` coordinates, verified: a [`Complex`].
//!
//! Reads the [`Selected`] facets, gives `brep` and `remesh` a [`Complex`] that is proved to be an embedding.
//!
//! # Steps
//! 1. `dissolve`: vertices left in the middle of a straight edge go.
//! 2. Every point is rounded once, to the nearest `f64`; intersection points within 4 units in the last place of the model's
//!    size of another vertex become that vertex, and facets that collapse go (`collapse`).
//! 3. `facets`: every polygon is triangulated over its vertices; a polygon that is not planar to rounding (contact moved its
//!    vertices within the tolerance) is written as its triangles. Where an edge passes through a vertex of its own facet, the
//!    vertex becomes one of the edge (`touching`).
//! 4. `verify`: the triangles are tested exactly against each other, and the order of the facets around every edge. What the
//!    rounded facets enclose are the volumes: rounding may close a neck, or put an edge into another facet, which then lists
//!    it.
//! 5. `repair`: where that fails, the rounded triangles are cut against each other and rounded again. What fails in the end is
//!    reported to the caller: a broken complex is never taken for a valid one.
//! 6. `regions`: volumes are joined across nested components by exact rays, and numbered.

mod collapse;
mod dissolve;
mod facets;
mod freedom;
mod regions;
mod repair;
mod touching;
mod verify;

pub use verify::{Breach, Fault};

use crate::arrangement::Arrangement;
use crate::brep::complex::{Complex, ComplexFacet, ComplexSurface, ComplexVertex, KilledFacet};
use crate::diag::Diagnostic;
use crate::geom::Vec3;
use crate::ids::{Id, IdVec, LeafId, MarkerId, PartId, RegionId, SurfaceId, VertexId};
use crate::primitive::solid::{Freedom, Solid};
use crate::select::{Selected, SelectedFacet};

/// Units in the last place of the model's size (or of its distance from the origin, if that is larger: nothing finer can be
/// written) within which a polygon's vertices lie in its plane.
pub const PLANAR_ULPS: f64 = 4.0;

/// A complex, or where rounding broke it.
pub enum Rounded {
    /// Proved to be an embedding.
    Valid {
        /// The complex.
        complex: Complex,
        /// What it took.
        repairs: Repairs,
    },
    /// Facets meet where they must not.
    Broken {
        /// Polygons with rounded vertices that make the broken complex.
        complex: Complex,
        /// Some of the places.
        faults: Vec<Fault>,
    },
}

/// How often rounding had to be repaired, and on what.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct Repairs {
    /// How often all facets were cut again; 0 almost always.
    pub rounds: u32,
    /// Pairs of triangles that rounding made meet or change sides, up to a limit.
    pub contacts: usize,
    /// The first of each kind.
    pub places: Vec<Repaired>,
}

/// A place that rounding broke and that was repaired.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Repaired {
    /// What two facets did there.
    pub what: Breach,
    /// The interfaces or boundaries that the facets belong to.
    pub markers: [String; 2],
    /// A point of it.
    pub point: [f64; 3],
}

impl Repairs {
    fn of(complex: &Complex, faults: &[Fault]) -> Self {
        let is_first = |k: usize| faults[..k].iter().all(|f| f.what != faults[k].what);
        let name = |facet| complex.markers[complex.facets[facet].marker].name.clone();
        let place = |f: &Fault| Repaired { what: f.what, markers: f.facets.map(name), point: f.point.into() };
        let places = (0..faults.len()).filter(|&k| is_first(k)).map(|k| place(&faults[k])).collect();
        Self { rounds: 0, contacts: faults.len(), places }
    }
}

/// Polygons over points that are not rounded yet.
struct Draft {
    /// What the facets are.
    facets: Vec<Lineage>,
    /// Their loops.
    loops: collapse::Loops,
    /// The nearest `f64` to every point.
    places: Vec<Vec3>,
    /// The first places, which are exact.
    explicit: usize,
}

/// What a facet is, without loops: a third of its memory.
#[derive(Clone, Copy)]
struct Lineage {
    sides: [RegionId; 2],
    surface: SurfaceId,
    source: (LeafId, u32),
    marker: MarkerId,
    is_modified: bool,
    /// Corners that it has if nothing cuts it.
    corners: u32,
}

impl Lineage {
    fn of(facet: &ComplexFacet) -> Self {
        let &ComplexFacet { sides, surface, source, marker, is_modified, .. } = facet;
        Self { sides, surface, source, marker, is_modified, corners: corners(&facet.loops) }
    }
    fn facet(&self, loops: Vec<Vec<VertexId>>, triangles: Vec<[VertexId; 3]>) -> ComplexFacet {
        let &Self { sides, surface, source, marker, is_modified, .. } = self;
        let is_modified = is_modified || corners(&loops) != self.corners;
        ComplexFacet { loops, triangles, sides, surface, source, marker, is_modified }
    }
}

fn corners<T>(loops: &[Vec<T>]) -> u32 {
    loops.iter().map(|walk| walk.len() as u32).sum()
}

/// The selected facets over exact points: all that rounding needs of the stages before.
pub struct Exact {
    /// Names, surfaces and dropped facets; no facets yet.
    complex: Complex,
    draft: Draft,
    part_of_volume: Vec<Option<PartId>>,
}

impl Exact {
    /// O(n).
    pub fn new(selected: Selected, arrangement: &Arrangement, solids: &[Solid]) -> Self {
        let (surfaces, surface_of) = surface_table(solids);
        let draft = draft(selected.facets, arrangement, solids, surface_of);
        let killed = killed(&selected.killed, arrangement);
        let complex = Complex { surfaces, markers: selected.markers, killed, ..Default::default() };
        Self { complex, draft, part_of_volume: selected.part_of_volume }
    }
}

/// Rounds, triangulates, verifies and numbers.
///
/// `tolerance`: that of the contact step, in the scene's unit; `size`: that of the model.
pub fn round(exact: Exact, solids: &[Solid], tolerance: f64, size: f64) -> Result<Rounded, Diagnostic> {
    let Exact { mut complex, mut draft, mut part_of_volume } = exact;
    let used = draft.loops.iter().flatten().flatten().map(|&p| &draft.places[p as usize]);
    let reach = PLANAR_ULPS * f64::EPSILON * used.fold(size, |m, p| m.max(p.amax()));
    dissolve::dissolve(&mut draft.loops, &draft.places, tolerance.max(reach));
    fill(&mut complex, draft, reach)?;
    let (repairs, checked) = settle(&mut complex, &mut part_of_volume, reach)?;
    let volumes = match checked {
        Ok(volumes) => volumes,
        Err(faults) => return Ok(Rounded::Broken { complex, faults }),
    };
    renumber(&mut complex, &part_of_volume, &volumes, reach)?;
    freedom::assign(&mut complex, solids);
    Ok(Rounded::Valid { complex, repairs })
}

/// Cuts the facets again until they are a complex; what they enclose, or where they still are none in the end. `parts` are
/// those of the volumes that are the sides of facets, and become those of regions if something is cut.
fn settle(
    complex: &mut Complex,
    parts: &mut Vec<Option<PartId>>,
    reach: f64,
) -> Result<(Repairs, Result<verify::Volumes, Vec<Fault>>), Diagnostic> {
    let mut checked = check(complex, parts);
    let mut repairs = Repairs::default();
    if let Err(faults) = &checked {
        repairs = Repairs::of(complex, faults);
        regions::number(complex, parts, reach)?;
        *parts = complex.regions.iter().map(|r| r.part).collect();
    }
    while let Err(faults) = &checked
        && repairs.rounds < repair::MAX_ROUNDS
    {
        let Ok(draft) = repair::cut_again(complex, faults, reach) else { break };
        fill(complex, draft, reach)?;
        checked = check(complex, parts);
        if let Err(faults) = &checked
            && let Some(draft) = repair::join_edges(complex, faults, reach)
        {
            fill(complex, draft, reach)?;
            checked = check(complex, parts);
        }
        repairs.rounds += 1;
    }
    Ok((repairs, checked))
}

/// What facets enclose, once those list all that lies in them.
fn check(complex: &mut Complex, parts: &[Option<PartId>]) -> Result<verify::Volumes, Vec<Fault>> {
    let found = verify::check(complex, parts)?;
    if found.unlisted.is_empty() {
        return Ok(found);
    }
    touching::list(complex, found.unlisted);
    verify::check(complex, parts)
}

/// Regions are what the rounded facets enclose: rounding may close a neck that joined two of them.
fn renumber(complex: &mut Complex, parts: &[Option<PartId>], found: &verify::Volumes, reach: f64) -> Result<(), Diagnostic> {
    let mut part_of_volume = vec![None; found.count];
    for (facet, sides) in complex.facets.iter_mut().zip(&found.sides) {
        for (old, &new) in facet.sides.iter_mut().zip(sides) {
            part_of_volume[new as usize] = parts[old.index()];
            *old = RegionId(new);
        }
    }
    regions::number(complex, &part_of_volume, reach)
}

/// The selected facets; their sides are volumes.
fn draft(
    mut selected: Vec<SelectedFacet>,
    arrangement: &Arrangement,
    solids: &[Solid],
    surface_of: impl Fn((LeafId, u32)) -> SurfaceId,
) -> Draft {
    let loops: Vec<Vec<Vec<u32>>> = selected.iter_mut().map(|f| std::mem::take(&mut f.loops)).collect();
    let describe = |f: &SelectedFacet| {
        let source = solids[f.source.0.index()].facets.of(f.source.1);
        Lineage {
            sides: f.volumes.map(RegionId),
            surface: surface_of(f.source),
            source: f.source,
            marker: f.marker,
            is_modified: f.is_partial,
            corners: source.loops.corners().count() as u32,
        }
    };
    let facets = selected.iter().map(describe).collect();
    // Their memory serves what follows.
    drop(selected);
    let places = (0..arrangement.points.len() as u32).map(|p| arrangement.points.at(p)).collect();
    Draft { facets, loops, places, explicit: arrangement.points.explicit_len() }
}

/// Rounds and triangulates: vertices and facets of the complex become those of the draft.
fn fill(complex: &mut Complex, draft: Draft, reach: f64) -> Result<(), Diagnostic> {
    let (points, loops) = collapse::weld(draft.loops, &draft.places, draft.explicit, reach);
    let facet = |piece: facets::Piece| {
        let loops = piece.loops.into_iter().map(|l| l.into_iter().map(VertexId).collect()).collect();
        let triangles = piece.triangles.into_iter().map(|t| t.map(VertexId)).collect();
        draft.facets[piece.facet].facet(loops, triangles)
    };
    complex.facets = facets::triangulate(loops, &points, reach)?.into_iter().map(facet).collect::<Vec<_>>().into();
    let vertex = |point| ComplexVertex { point, freedom: Freedom::Fixed };
    complex.vertices = points.into_iter().map(vertex).collect::<Vec<_>>().into();
    drop_orphans(complex);
    Ok(())
}

/// Drops vertices whose facets were all rounded to lines.
fn drop_orphans(complex: &mut Complex) {
    let mut is_used = vec![false; complex.vertices.len()];
    complex.facets.iter().flat_map(|f| f.loops.iter().flatten()).for_each(|v| is_used[v.index()] = true);
    if is_used.iter().all(|&u| u) {
        return;
    }
    let mut kept = IdVec::new();
    let mut number = vec![VertexId(u32::MAX); is_used.len()];
    for (v, vertex) in complex.vertices.enumerate().filter(|v| is_used[v.0.index()]) {
        number[v.index()] = kept.push(*vertex);
    }
    for facet in complex.facets.iter_mut() {
        let corners = facet.loops.iter_mut().flatten().chain(facet.triangles.iter_mut().flatten());
        corners.for_each(|v| *v = number[v.index()]);
    }
    complex.vertices = kept;
}

/// All surfaces of all leaves in order, and the surface of a leaf's facet.
fn surface_table(solids: &[Solid]) -> (IdVec<SurfaceId, ComplexSurface>, impl Fn((LeafId, u32)) -> SurfaceId) {
    let mut surfaces = IdVec::new();
    let mut first = Vec::with_capacity(solids.len());
    for (leaf, solid) in solids.iter().enumerate() {
        first.push(surfaces.len() as u32);
        for s in &solid.surfaces {
            surfaces.push(ComplexSurface { leaf: LeafId::new(leaf), side: s.side.clone(), shape: s.shape.clone() });
        }
    }
    let surface_of =
        move |(leaf, facet): (LeafId, u32)| SurfaceId(first[leaf.index()] + solids[leaf.index()].facets.of(facet).surface);
    (surfaces, surface_of)
}

/// Dropped pieces of sampled surfaces (their supports are fitted): the triangles that they lay on.
fn killed(cells: &[u32], arrangement: &Arrangement) -> Vec<KilledFacet> {
    let mut out = Vec::with_capacity(cells.len());
    let mut last = u32::MAX;
    for &cell in cells {
        let triangle = arrangement.cells.triangle[cell as usize];
        if std::mem::replace(&mut last, triangle) == triangle {
            continue;
        }
        let corners = arrangement.input.triangles[triangle as usize].map(|v| arrangement.points.at(v));
        for owner in arrangement.cells.owners_of(cell as usize) {
            out.push(KilledFacet { source: (owner.leaf, owner.facet), triangle: corners });
        }
    }
    out
}

#[cfg(test)]
mod tests;
