//! Drafts of all sheets and untouched facets to one list of cells.

use super::body::{Body, Names};
use super::candidates::PARALLEL_FROM;
use super::cells::{self, Draft, Tangled};
use super::conforming::{Cell, Conforming, Owner};
use super::sheets::Sheets;
use super::weld::MAX_MESSAGES;
use crate::cull::Fate;
use crate::diag::{Diagnostic, Outcome, Tally};
use crate::geom::hash::IndexMap;
use crate::geom::polygon;
use rayon::prelude::*;

/// All cells in the order of their first facets.
pub(super) fn assemble(body: &Body, mut sheets: Sheets, tolerance: f64, names: Names) -> Outcome<Conforming> {
    let mut sheet_at = vec![u32::MAX; body.facet_count()];
    for (k, sheet) in sheets.sheets.iter().enumerate() {
        sheet_at[sheets.outlines[sheet.members[0] as usize].facet as usize] = k as u32;
    }
    // Sheets stand at their first member, facets without a contact for themselves: those that are one triangle need no draft.
    let is_alone = |f: u32| sheets.slot[f as usize] == u32::MAX;
    let alone: Vec<u32> = (0..body.facet_count() as u32).filter(|&f| is_alone(f) && body.is_triangle(f)).collect();
    let starts: Vec<u32> = (0..body.facet_count() as u32)
        .filter(|&f| if is_alone(f) { !body.is_triangle(f) } else { sheet_at[f as usize] != u32::MAX })
        .collect();
    let reach = body.tolerances.iter().fold(0.0, |m: f64, &t| m.max(t));
    let draft = |&f: &u32| -> Result<Vec<Draft>, (u32, Tangled)> {
        let drafts = match sheets.sheets.get(sheet_at[f as usize] as usize) {
            None => cells::plain(f, body.loops(f), body).map(|d| vec![d]),
            Some(s) if s.is_plain() => cells::whole(f, &sheets.outlines[s.reference as usize].loops, body).map(|d| vec![d]),
            Some(s) => cells::trace(s, &sheets.outlines, body, reach),
        };
        drafts.map_err(|t| (f, t))
    };
    let drafts: Vec<_> =
        if starts.len() >= PARALLEL_FROM { starts.par_iter().map(draft).collect() } else { starts.iter().map(draft).collect() };
    let is_shared = shared_points(body, &sheets);
    // What is set aside does not matter where it coincides.
    let is_aside = |o: &Owner| body.fate(body.first_facet[o.leaf.0 as usize] + o.facet).is_aside();
    let can_coincide = |d: &Draft| d.loops.iter().flatten().all(|&v| is_shared[v as usize]) && !d.owners.iter().any(is_aside);
    let mut errors = Tally::default();
    let mut all =
        Collector { last: IndexMap::with_capacity_and_hasher(starts.len(), Default::default()), ..Default::default() };
    all.drafts.reserve(starts.len());
    for (mut found, &start) in drafts.into_iter().zip(&starts) {
        found.iter_mut().flatten().for_each(|d| d.sheet = start);
        if let (Ok([whole]), Some(sheet)) = (found.as_deref_mut(), sheets.sheets.get(sheet_at[start as usize] as usize))
            && sheet.is_plain()
        {
            whole.loops = std::mem::take(&mut sheets.outlines[sheet.reference as usize].loops);
        }
        match found {
            Ok(list) => list.into_iter().for_each(|d| if can_coincide(&d) { all.add(d, body) } else { all.drafts.push(d) }),
            Err((facet, tangled)) => errors.add(body.leaf(facet), || unresolved(body, facet, tangled, names)),
        }
    }
    // Contact moves a vertex within the coarser tolerance: then also towards leaves for which a finer one holds.
    let is_uniform = body.tolerances.windows(2).all(|w| w[0] == w[1]);
    let is_near = |facet: u32| !is_uniform || sheets.slot[facet as usize] != u32::MAX;
    let mut out = Conforming { points: body.points.clone(), tolerance, ..Conforming::default() };
    out.cells.reserve(all.drafts.len() + alone.len());
    let mut rest = alone.into_iter().peekable();
    let mut finish_alone = |until: u32, out: &mut Conforming| {
        while let Some(f) = rest.next_if(|&f| f < until) {
            match cells::plain(f, body.loops(f), body) {
                Ok(draft) => finish(body, Draft { sheet: f, ..draft }, is_near, out),
                Err(tangled) => errors.add(body.leaf(f), || unresolved(body, f, tangled, names)),
            }
        }
    };
    for draft in all.drafts {
        finish_alone(draft.sheet, &mut out);
        finish(body, draft, is_near, &mut out);
    }
    finish_alone(u32::MAX, &mut out);
    if errors.is_empty() { Ok(out) } else { Err(errors.finish().into_iter().take(MAX_MESSAGES).collect()) }
}

/// For every point, whether facets of several leaves may have it.
fn shared_points(body: &Body, sheets: &Sheets) -> Vec<bool> {
    let mut is_shared = vec![false; body.points.len()];
    let mut leaf_at = vec![u32::MAX; body.points.len()];
    for outline in &sheets.outlines {
        let leaf = body.leaf_of_facet[outline.facet as usize];
        for v in outline.corners() {
            let before = std::mem::replace(&mut leaf_at[v as usize], leaf);
            is_shared[v as usize] |= before != u32::MAX && before != leaf;
        }
    }
    // What lies inside a facet belongs to another leaf.
    for sheet in &sheets.sheets {
        let inside = sheet.segments.iter().chain(&sheet.chords).flatten().chain(&sheet.lone);
        inside.for_each(|&v| is_shared[v as usize] = true);
    }
    is_shared
}

fn unresolved(body: &Body, facet: u32, tangled: Tangled, names: Names) -> Diagnostic {
    let name = names(body.leaf(facet));
    Diagnostic::error("contact-unresolved", format!("what touches a facet of {name} crosses itself within the tolerance"))
        .at(name.span)
        .near(body.points[tangled.point as usize])
        .hint("features or gaps near this place are about as large as the `tolerance`: choose a smaller or larger one")
}

/// Cells by their outlines.
#[derive(Default)]
struct Collector {
    drafts: Vec<Draft>,
    /// The last cell of each short key.
    last: IndexMap<[u32; 4], u32>,
    /// For each cell with a key, the one before of the same key.
    previous: Vec<u32>,
}

impl Collector {
    /// Adds a cell, or its owners to the cell that has the same outline.
    fn add(&mut self, draft: Draft, body: &Body) {
        let next = self.drafts.len() as u32;
        self.previous.resize(next as usize + 1, u32::MAX);
        let last = self.last.entry(short_key(&draft.loops)).or_insert(u32::MAX);
        let mut slot = *last;
        // Hardly any cells have the same short key and are not the same.
        while let Some(other) = self.drafts.get(slot as usize)
            && outline_key(&other.loops).0 != outline_key(&draft.loops).0
        {
            slot = self.previous[slot as usize];
        }
        if slot == u32::MAX {
            self.previous[next as usize] = std::mem::replace(last, next);
            self.drafts.push(draft);
            return;
        }
        let is_reversed = outline_key(&draft.loops).1;
        let kept = &mut self.drafts[slot as usize];
        let is_flipped = outline_key(&kept.loops).1 != is_reversed;
        kept.owners.extend(draft.owners.iter().map(|o| Owner { is_flipped: o.is_flipped != is_flipped, ..*o }));
        if draft.chains != kept.chains || draft.lone != kept.lone {
            kept.chains.extend(draft.chains);
            kept.chains.sort_unstable();
            kept.chains.dedup();
            kept.lone.extend(draft.lone);
            kept.lone.sort_unstable();
            kept.lone.dedup();
            kept.lone.retain(|v| kept.chains.iter().all(|c| !c.contains(v)));
            let loops: Vec<&[u32]> = kept.loops.iter().map(Vec::as_slice).collect();
            if let Ok(triangles) = polygon::triangulate(&loops, &kept.chains, &kept.lone, &body.points) {
                kept.triangles = triangles;
            }
        }
    }
}

/// What equal outlines have in common and others hardly: the lowest point of the outer loop between its neighbours, and the
/// number of points.
fn short_key(loops: &[Vec<u32>]) -> [u32; 4] {
    let Some(walk) = loops.first().filter(|w| !w.is_empty()) else { return [u32::MAX; 4] };
    let n = walk.len();
    let first = (0..n).min_by_key(|&k| walk[k]).unwrap_or(0);
    let (a, b) = (walk[(first + n - 1) % n], walk[(first + 1) % n]);
    [walk[first], a.min(b), a.max(b), loops.iter().map(Vec::len).sum::<usize>() as u32]
}

/// Loops from their lowest points towards the lower neighbour, holes sorted; and whether that turns the outer loop round.
fn outline_key(loops: &[Vec<u32>]) -> (Vec<u32>, bool) {
    let mut turned: Vec<(bool, Vec<u32>)> = loops
        .iter()
        .map(|walk| {
            let n = walk.len();
            let first = (0..n).min_by_key(|&k| walk[k]).unwrap_or(0);
            let is_reversed = walk[(first + n - 1) % n] < walk[(first + 1) % n];
            let step = if is_reversed { n - 1 } else { 1 };
            (is_reversed, (0..n).map(|k| walk[(first + k * step) % n]).collect())
        })
        .collect();
    let is_reversed = turned.first().is_some_and(|t| t.0);
    if let [_, holes @ ..] = &mut turned[..] {
        holes.sort_by(|a, b| a.1.cmp(&b.1));
    }
    let key = turned.into_iter().flat_map(|t| t.1.into_iter().chain([u32::MAX])).collect();
    (key, is_reversed)
}

/// Adds a draft as a cell.
fn finish(body: &Body, mut draft: Draft, is_near: impl Fn(u32) -> bool, out: &mut Conforming) {
    draft.owners.sort_unstable();
    if draft.owners.first().is_some_and(|o| o.is_flipped) {
        draft.owners.iter_mut().for_each(|o| o.is_flipped = !o.is_flipped);
        draft.loops.iter_mut().for_each(|w| w.reverse());
        draft.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    out.cell_of_triangle.resize(out.triangles.len() + draft.triangles.len(), out.cells.len() as u32);
    out.triangles.extend(&draft.triangles);
    let facet = |o: &Owner| body.first_facet[o.leaf.0 as usize] + o.facet;
    let fate = |o: &Owner| {
        let fate = body.fate(facet(o));
        if o.is_flipped { fate.turned() } else { fate }
    };
    out.cells.push(Cell {
        fate: draft.owners.iter().map(fate).find(|f| *f != Fate::Live).unwrap_or_default(),
        is_near: draft.owners.iter().any(|o| is_near(facet(o))),
        owners: draft.owners,
        loops: draft.loops,
        sheet: draft.sheet,
    });
}
