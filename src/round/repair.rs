//! Facets that cross after rounding are cut again, exactly, and rounded again.
//!
//! Rounding moves a vertex by a unit in the last place, which may push it through a facet that it hardly missed. The rounded
//! triangles are then input like any other: they are cut against each other exactly, and what was on the wrong side by such a
//! unit becomes a piece of its own. A piece lies between two regions if the boundaries of the regions, seen as oriented
//! surfaces, wind around its two sides differently; what is turned over or doubled has the same region on both sides and goes.
//! Rounded again, new points fall onto the vertices that they came from, and what nearly touched is joined (the idea of snap
//! rounding: Hobby 1999; in space: Devillers, Lazard, Lenhart 2018); edges of facets that still meet are cut at the vertices
//! on them.

use super::{Breach, Draft, Fault, Lineage, collapse, dissolve, touching, verify};
use crate::arrangement::{self, Arrangement};
use crate::brep::complex::{Complex, ComplexFacet};
use crate::classify::EdgeUses;
use crate::contact::conforming::{Cell, Conforming, Owner};
use crate::cull::Fate;
use crate::diag::Diagnostic;
use crate::geom::Vec3;
use crate::geom::aabb::Aabb;
use crate::geom::bvh::Bvh;
use crate::geom::embedding::Kind;
use crate::geom::polygon::vector_area;
use crate::geom::union_find::UnionFind;
use crate::ids::{FacetId, Id, LeafId, MarkerId, PartId, RegionId, VertexId};
use crate::select;
use std::ops::ControlFlow;

/// Rounds after which a scene is refused; nothing known needs more than three.
pub const MAX_ROUNDS: u32 = 8;

/// Cuts the facets of a complex against each other, where `faults` were found. The regions keep their numbers.
///
/// # Errors
/// If the facets do not bound the regions any more, or an interface would appear that the model has not.
pub fn cut_again(complex: &Complex, faults: &[Fault], reach: f64) -> Result<Draft, Diagnostic> {
    let input = soup(complex, met(complex, faults));
    let arrangement = arrangement::arrange(&input);
    let edges = EdgeUses::new(&arrangement)?;
    let (shells, count) = edges.shells(&arrangement.cells);
    let region_of_shell = regions(complex, &arrangement, &shells, count)?;
    let mut sides: Vec<[RegionId; 2]> = shells.iter().map(|s| s.map(|s| region_of_shell[s as usize])).collect();
    join_touching(complex, &mut sides);
    let kept: Vec<bool> = sides.iter().map(|s| s[0] != s[1]).collect();
    let mut source = vec![0u32; kept.len()];
    let mut marker = vec![MarkerId(0); kept.len()];
    for cell in (0..kept.len()).filter(|&c| kept[c]) {
        (source[cell], marker[cell]) = lineage(complex, &arrangement, cell, sides[cell])?;
    }
    let mut merged = select::merge(&arrangement, &edges, &kept, &marker, &source, |cell| sides[cell].map(|r| r.0));
    let mut loops: collapse::Loops = merged.iter_mut().map(|f| std::mem::take(&mut f.loops)).collect();
    let places: Vec<Vec3> = (0..arrangement.points.len() as u32).map(|p| arrangement.points.at(p)).collect();
    dissolve::dissolve(&mut loops, &places, reach);
    let facets = merged.iter().map(|f| {
        let old = &complex.facets[FacetId(f.source.0.0)];
        let is_modified = old.is_modified || f.is_partial;
        Lineage { sides: f.volumes.map(RegionId), marker: f.marker, is_modified, ..Lineage::of(old) }
    });
    Ok(Draft { facets: facets.collect(), loops, places, explicit: input.points.len() })
}

/// The facets of a complex, where vertices of those that meet lie on edges of each other but for rounding: such an edge, cut
/// there in all its facets, parts what is one place. Cutting again may leave them, some facets going past the vertex and some
/// through it, and in the next round the others. `None` if there is no such vertex.
pub fn join_edges(complex: &Complex, faults: &[Fault], reach: f64) -> Option<Draft> {
    let mut loops: collapse::Loops =
        complex.facets.iter().map(|f| f.loops.iter().map(|walk| walk.iter().map(|v| v.0).collect()).collect()).collect();
    let places: Vec<Vec3> = complex.vertices.iter().map(|v| v.point).collect();
    let mut met: Vec<[usize; 2]> = faults.iter().map(|fault| fault.facets.map(Id::index)).collect();
    // The same two may meet in many places.
    met.iter_mut().for_each(|pair| pair.sort_unstable());
    met.sort_unstable();
    met.dedup();
    let changed = touching::cut(&mut loops, &met, &places, reach);
    let facets = complex.facets.iter().map(Lineage::of).collect();
    (!changed.is_empty()).then_some(Draft { facets, loops, explicit: places.len(), places })
}

/// Makes one region of regions of one part that touch: the facets between them would be nothing's border.
fn join_touching(complex: &Complex, sides: &mut [[RegionId; 2]]) {
    let mut joined = UnionFind::new(complex.regions.len());
    for &mut [front, back] in sides.iter_mut() {
        if complex.regions[front].part == complex.regions[back].part {
            joined.join(front.0, back.0);
        }
    }
    sides.iter_mut().flatten().for_each(|r| *r = RegionId(joined.find(r.0)));
}

/// Pairs of facets that meet where they must not: all that may if `faults` are not all. Those without area were not compared.
fn met(complex: &Complex, faults: &[Fault]) -> Vec<[u32; 2]> {
    let place = |v: &VertexId| &complex.vertices[*v].point;
    let around = |f: &ComplexFacet| Aabb::around(f.loops.iter().flatten().map(place));
    let boxes: Vec<Aabb> = complex.facets.iter().map(around).collect();
    let mut pairs = Vec::new();
    if faults.len() >= verify::LIMIT {
        let tree = Bvh::new(boxes);
        for task in tree.pair_tasks(1) {
            tree.overlapping_pairs(task, |f, g| {
                pairs.push([f, g]);
                ControlFlow::Continue(())
            });
        }
        return pairs;
    }
    for fault in faults {
        let [f, g] = fault.facets.map(|f| f.0);
        match fault.what {
            Breach::TurnedOver => {}
            Breach::Meeting(Kind::Degenerate) => {
                let flat = boxes[f as usize];
                pairs.extend((0..).zip(&boxes).filter(|(_, b)| b.overlaps(&flat)).map(|(g, _)| [f.min(g), f.max(g)]));
            }
            Breach::Meeting(_) => pairs.push([f.min(g), f.max(g)]),
        }
    }
    pairs.sort_unstable();
    pairs.dedup();
    pairs.retain(|[f, g]| f != g);
    pairs
}

/// Every facet is a leaf and a sheet of its own: valid in itself, and to be cut by those that it meets.
fn soup(complex: &Complex, pairs: Vec<[u32; 2]>) -> Conforming {
    let points = complex.vertices.iter().map(|v| v.point).collect();
    let mut is_cut = vec![false; complex.vertices.len()];
    for v in pairs.iter().flatten().flat_map(|&f| complex.facets[FacetId(f)].loops.iter().flatten()) {
        is_cut[v.index()] = true;
    }
    let mut out = Conforming { points, pairs, ..Conforming::default() };
    for (id, facet) in complex.facets.enumerate() {
        let triangles: Vec<[u32; 3]> = facet.triangles.iter().map(|t| t.map(|v| v.0)).collect();
        let owner = Owner { leaf: LeafId(id.0), facet: 0, is_flipped: false };
        // What has an edge in common with a facet that is cut is cut there as well.
        let is_near = facet.loops.iter().flatten().any(|v| is_cut[v.index()]);
        out.push(Cell { facet: id.0, sheet: id.0, is_near, fate: Fate::Live }, &[owner], &triangles);
    }
    out
}

/// How often each region winds around a place; sorted, without zeros. The sum is one.
type Winding = Vec<(RegionId, i32)>;

fn add(winding: &mut Winding, region: RegionId, turns: i32) {
    match winding.binary_search_by_key(&region, |w| w.0) {
        Ok(k) if winding[k].1 == -turns => drop(winding.remove(k)),
        Ok(k) => winding[k].1 += turns,
        Err(k) => winding.insert(k, (region, turns)),
    }
}

/// The region of each shell.
fn regions(
    complex: &Complex,
    arrangement: &Arrangement,
    shells: &[[u32; 2]],
    count: usize,
) -> Result<Vec<RegionId>, Diagnostic> {
    let cells = &arrangement.cells;
    let mut sets = UnionFind::new(count);
    let mut around: Vec<(u32, u32)> = Vec::with_capacity(2 * shells.len());
    for (cell, &[front, back]) in shells.iter().enumerate() {
        sets.join(front, back);
        around.extend([(front, cell as u32), (back, cell as u32)]);
    }
    around.sort_unstable();
    let (component, components) = sets.number();
    let mut winding: Vec<Option<Winding>> = vec![None; count];
    let mut stack: Vec<u32> = Vec::new();
    // The largest piece of a component is not one that rounding has turned over: its sides are what they were.
    for (cell, area) in largest(arrangement, shells, &component, components).into_iter().flatten() {
        debug_assert!(area > 0.0);
        let owner = cells.owners_of(cell)[0];
        let sides = complex.facets[FacetId(owner.leaf.0)].sides;
        let front = shells[cell][0];
        winding[front as usize] = Some(vec![(sides[usize::from(owner.is_flipped)], 1)]);
        stack.push(front);
    }
    while let Some(shell) = stack.pop() {
        let here = winding[shell as usize].clone().unwrap_or_default();
        let first = around.partition_point(|a| a.0 < shell);
        for &(_, cell) in around[first..].iter().take_while(|a| a.0 == shell) {
            let [front, back] = shells[cell as usize];
            let (is_front, other) = if front == shell { (true, back) } else { (false, front) };
            let mut there = here.clone();
            for owner in cells.owners_of(cell as usize) {
                let [ahead, behind] = complex.facets[FacetId(owner.leaf.0)].sides;
                let step = if is_front != owner.is_flipped { 1 } else { -1 };
                add(&mut there, ahead, -step);
                add(&mut there, behind, step);
            }
            match &winding[other as usize] {
                Some(known) if *known == there => {}
                Some(_) => return Err(Diagnostic::internal("label-conflict", "rounded facets do not bound regions")),
                None => {
                    winding[other as usize] = Some(there);
                    stack.push(other);
                }
            }
        }
    }
    let region = |w: Option<Winding>| w.into_iter().flatten().find(|w| w.1 > 0).map_or(RegionId(0), |w| w.0);
    Ok(winding.into_iter().map(region).collect())
}

/// The cell with the largest area of each component, among those of one facet only.
fn largest(arrangement: &Arrangement, shells: &[[u32; 2]], component: &[u32], components: usize) -> Vec<Option<(usize, f64)>> {
    let places: Vec<Vec3> = (0..arrangement.points.len() as u32).map(|p| arrangement.points.at(p)).collect();
    let mut out: Vec<Option<(usize, f64)>> = vec![None; components];
    for (cell, sides) in shells.iter().enumerate() {
        let area = vector_area(arrangement.cells.loops(cell), &places).norm();
        let best = &mut out[component[sides[0] as usize] as usize];
        if arrangement.cells.owners_of(cell).len() == 1 && best.is_none_or(|b| b.1 < area) {
            *best = Some((cell, area));
        }
    }
    out
}

/// Which owner a piece is a piece of, and its name.
fn lineage(
    complex: &Complex,
    arrangement: &Arrangement,
    cell: usize,
    sides: [RegionId; 2],
) -> Result<(u32, MarkerId), Diagnostic> {
    let owners = arrangement.cells.owners_of(cell);
    let marker_of = |o: &Owner| complex.facets[FacetId(o.leaf.0)].marker;
    let mut parts = sides.map(|r| complex.regions[r].part);
    parts.sort_unstable_by_key(|p: &Option<PartId>| p.map_or(u32::MAX, |p| p.0));
    let is_right = |m: MarkerId| complex.markers[m].parts == parts;
    if let Some(k) = owners.iter().position(|o| is_right(marker_of(o))) {
        return Ok((k as u32, marker_of(&owners[k])));
    }
    match complex.markers.ids().find(|&m| is_right(m) && complex.markers[m].interface == m) {
        Some(marker) => Ok((0, marker)),
        None => {
            let corner = arrangement.cells.loops(cell).next().map_or(0, |l| l[0]);
            let text = "rounding makes parts touch that do not";
            Err(Diagnostic::internal("new-interface", text).near(arrangement.points.at(corner)))
        }
    }
}
