//! Cells of all sheets and untouched facets to one list.

use super::body::{Body, Names};
use super::candidates::{PARALLEL_FROM, SHARES};
use super::cells::{self, Draft, Tangled};
use super::conforming::{Cell, Conforming, Owner};
use super::drafts::Drafts;
use super::sheets::{Sheet, Sheets};
use super::weld::MAX_MESSAGES;
use crate::cull::Fate;
use crate::diag::{Diagnostic, Outcome, Tally};
use rayon::prelude::*;

/// All cells in the order of their first facets.
pub(super) fn assemble(body: &Body, sheets: Sheets, tolerance: f64, names: Names) -> Outcome<Conforming> {
    let plan = Plan::new(body, &sheets);
    let (mut drafts, tangled) = plan.drafts();
    drafts.join(&body.points);
    let mut errors = Tally::default();
    tangled.into_iter().for_each(|(facet, t)| errors.add(body.leaf(facet), || unresolved(body, facet, t, names)));
    let mut out = Conforming { points: body.points.clone(), tolerance, ..Conforming::default() };
    out.reserve(drafts.len() + plan.triangles.len());
    let one = |&f: &u32| (f, cells::triangle(f, body));
    let lone: Vec<_> = plan.triangles.par_iter().with_min_len(PARALLEL_FROM).map(one).collect();
    let mut rest = lone.into_iter().peekable();
    let mut add_triangles = |until: u32, out: &mut Conforming| {
        while let Some((f, triangle)) = rest.next_if(|(f, _)| *f < until) {
            match triangle {
                Ok(triangle) => plan.finish(f, &[body.owner(f, false)], &[triangle], out),
                Err(t) => errors.add(body.leaf(f), || unresolved(body, f, t, names)),
            }
        }
    };
    for (sheet, owners, triangles) in drafts.iter() {
        add_triangles(sheet, &mut out);
        plan.finish(sheet, owners, triangles, &mut out);
    }
    add_triangles(u32::MAX, &mut out);
    if errors.is_empty() { Ok(out) } else { Err(errors.finish().into_iter().take(MAX_MESSAGES).collect()) }
}

/// What becomes cells, and how.
struct Plan<'a> {
    body: &'a Body<'a>,
    sheets: &'a Sheets,
    /// For every facet, the sheet that begins with it, or `u32::MAX`.
    sheet_at: Vec<u32>,
    /// For every point, whether facets of several leaves may have it.
    is_shared: Vec<bool>,
    /// Facets of one triangle on which nothing lies and that coincide with none.
    triangles: Vec<u32>,
    /// First facets of all other sheets, and other facets without a contact.
    starts: Vec<u32>,
    /// The coarsest tolerance.
    reach: f64,
    /// Contact moves a vertex within the coarser tolerance: then also towards leaves for which a finer one holds.
    is_uniform: bool,
}

impl<'a> Plan<'a> {
    fn new(body: &'a Body, sheets: &'a Sheets) -> Self {
        let mut sheet_at = vec![u32::MAX; body.facet_count()];
        for k in 0..sheets.len() as u32 {
            sheet_at[sheets.outlines[sheets.sheet(k).members[0] as usize].facet as usize] = k;
        }
        let is_uniform = body.tolerances.windows(2).all(|w| w[0] == w[1]);
        let reach = body.tolerances.iter().fold(0.0, |m: f64, &t| m.max(t));
        let (is_shared, triangles, starts) = (shared_points(body, sheets), Vec::new(), Vec::new());
        let mut plan = Self { body, sheets, sheet_at, is_shared, triangles, starts, reach, is_uniform };
        for f in 0..body.facet_count() as u32 {
            let is_alone = sheets.slot[f as usize] == u32::MAX;
            match plan.sheet(f) {
                None if !is_alone => {}
                None if body.is_triangle(f) => plan.triangles.push(f),
                Some(sheet) if sheet.is_plain() && plan.is_lone_triangle(&sheet) => plan.triangles.push(f),
                _ => plan.starts.push(f),
            }
        }
        plan
    }
    /// The sheet that begins with a facet.
    fn sheet(&self, first: u32) -> Option<Sheet<'a>> {
        let sheet = self.sheet_at[first as usize];
        (sheet != u32::MAX).then(|| self.sheets.sheet(sheet))
    }
    /// Whether a plain sheet is a triangle that coincides with no other cell.
    fn is_lone_triangle(&self, sheet: &Sheet) -> bool {
        let outline = &self.sheets.outlines[sheet.reference as usize];
        outline.corners().count() == 3 && !self.can_coincide(&outline.loops, self.body.fate(outline.facet))
    }
    /// Whether other sheets may have a cell too. What is set aside does not matter where it coincides.
    fn can_coincide(&self, loops: &[Vec<u32>], fate: Fate) -> bool {
        !fate.is_aside() && loops.iter().flatten().all(|&v| self.is_shared[v as usize])
    }

    /// The cells of all that is not one triangle, and the facets of which there are none.
    fn drafts(&self) -> (Drafts, Vec<(u32, Tangled)>) {
        let search = |starts: &[u32]| {
            let (mut found, mut tangled) = (Drafts::default(), Vec::new());
            for &f in starts {
                match self.draft(f) {
                    Ok(drafts) => drafts.into_iter().for_each(|d| {
                        let fate = |o: &Owner| self.body.fate(self.facet(o));
                        let is_common = d.owners.iter().all(|o| self.can_coincide(&d.loops, fate(o)));
                        found.push(f, d, is_common);
                    }),
                    Err(t) => tangled.push((f, t)),
                }
            }
            (found, tangled)
        };
        let shares = self.shares();
        if let [all] = shares[..] {
            return search(all);
        }
        let mut lists: Vec<_> = shares.into_par_iter().map(search).collect();
        let (mut all, mut tangled) = (Drafts::default(), Vec::new());
        for (drafts, errors) in lists.drain(..) {
            all.append(drafts);
            tangled.extend(errors);
        }
        (all, tangled)
    }
    /// `starts` in pieces of about equal work, as the items of their sheets tell it: a few large ones may be most of it.
    fn shares(&self) -> Vec<&[u32]> {
        let work = |&f: &u32| match self.sheet(f) {
            None => 1,
            Some(s) => {
                let corners = |&m: &u32| self.sheets.outlines[m as usize].loops.iter().map(Vec::len).sum::<usize>();
                s.members.iter().map(corners).sum::<usize>() + s.segments.len() + s.lone.len() + s.chords.len()
            }
        };
        let works: Vec<usize> = self.starts.iter().map(work).collect();
        let most = (works.iter().sum::<usize>() / SHARES).max(PARALLEL_FROM / 4);
        let (mut shares, mut first, mut sum) = (Vec::with_capacity(SHARES), 0, 0);
        for (k, work) in works.into_iter().enumerate() {
            sum += work;
            if sum > most || k + 1 == self.starts.len() {
                shares.push(&self.starts[first..=k]);
                (first, sum) = (k + 1, 0);
            }
        }
        shares
    }
    /// The cells of the sheet that begins with a facet, or of a facet without a contact.
    fn draft(&self, first: u32) -> Result<Vec<Draft>, Tangled> {
        let outlines = &self.sheets.outlines;
        let one = |loops: Vec<Vec<u32>>| cells::plain(first, loops, self.body).map(|d| vec![d]);
        match self.sheet(first) {
            None => one(self.body.loops(first)),
            Some(s) if s.is_plain() => one(outlines[s.reference as usize].loops.clone()),
            Some(s) => cells::trace(&s, outlines, self.body, self.reach),
        }
    }

    fn facet(&self, owner: &Owner) -> u32 {
        self.body.first_facet[owner.leaf.0 as usize] + owner.facet
    }
    /// Adds a cell, turned so that its first owner is not flipped.
    fn finish(&self, sheet: u32, owners: &[Owner], triangles: &[[u32; 3]], out: &mut Conforming) {
        let is_near = owners.iter().any(|o| !self.is_uniform || self.sheets.slot[self.facet(o) as usize] != u32::MAX);
        let fate = |o: &Owner| {
            let fate = self.body.fate(self.facet(o));
            if o.is_flipped { fate.turned() } else { fate }
        };
        let is_known = |f: &Fate| *f != Fate::Live;
        if let [owner] = owners
            && !owner.is_flipped
        {
            return out.push(Cell { facet: self.facet(owner), sheet, is_near, fate: fate(owner) }, owners, triangles);
        }
        let (mut owners, mut triangles) = (owners.to_vec(), triangles.to_vec());
        owners.sort_unstable();
        if owners.first().is_some_and(|o| o.is_flipped) {
            owners.iter_mut().for_each(|o| o.is_flipped = !o.is_flipped);
            triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
        let fate = owners.iter().map(fate).find(is_known).unwrap_or_default();
        let facet = owners.first().map_or(sheet, |o| self.facet(o));
        out.push(Cell { facet, sheet, is_near, fate }, &owners, &triangles);
    }
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
    for sheet in (0..sheets.len() as u32).map(|k| sheets.sheet(k)) {
        let inside = sheet.segments.iter().chain(sheet.chords).flatten().chain(sheet.lone);
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
