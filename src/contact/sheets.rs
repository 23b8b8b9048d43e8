//! Which facets lie in one sheet, and which edges and points of others lie on each.

use super::body::{Body, Names};
use super::candidates::PARALLEL_FROM;
use super::chords;
use super::edges::EdgeSet;
use super::outline::Outline;
use super::weld::{MAX_MESSAGES, chain};
use crate::diag::{Diagnostic, Outcome, Tally};
use crate::geom::lists::Lists;
use crate::geom::union_find::UnionFind;
use rayon::prelude::*;

/// Facets belong to one sheet if they lie within this part of the tolerance of its plane: two of them are then within the
/// tolerance of each other.
const SHEET_SHARE: f64 = 0.5;
/// Heights above a facet, in tolerances, up to which a point that is on another facet tells of a chain.
const CHAIN_REACH: f64 = 2.0;

/// Facets in one plane that overlap, with what else lies on them. Facets are given by their slots in `Sheets::outlines`.
#[derive(Clone, Copy)]
pub(super) struct Sheet<'a> {
    /// The members; the one whose plane counts is the largest.
    pub members: &'a [u32],
    pub reference: u32,
    /// Edges of other facets that run inside a member.
    pub segments: &'a [[u32; 2]],
    /// Points of other facets that lie inside a member.
    pub lone: &'a [u32],
    /// Where other facets cross a member, unless a segment does.
    pub chords: &'a [[u32; 2]],
}

impl Sheet<'_> {
    /// Whether it is one facet with nothing on it.
    pub fn is_plain(&self) -> bool {
        self.members.len() == 1 && self.segments.is_empty() && self.lone.is_empty() && self.chords.is_empty()
    }
}

/// All active facets, and their sheets in the order of the first members.
pub(super) struct Sheets {
    /// Active facets in ascending order.
    pub outlines: Vec<Outline>,
    /// For every facet of the scene its slot in `outlines`, or `u32::MAX`.
    pub slot: Vec<u32>,
    references: Vec<u32>,
    members: Lists,
    segments: Lists<[u32; 2]>,
    lone: Lists,
    chords: Lists<[u32; 2]>,
}

impl Sheets {
    /// Number of sheets.
    pub fn len(&self) -> usize {
        self.references.len()
    }
    /// One of them.
    pub fn sheet(&self, k: u32) -> Sheet<'_> {
        Sheet {
            members: self.members.of(k),
            reference: self.references[k as usize],
            segments: self.segments.of(k),
            lone: self.lone.of(k),
            chords: self.chords.of(k),
        }
    }
}

/// Gathers the sheets. The edges must have been connected.
pub(super) fn gather(body: &Body, set: &mut EdgeSet, pairs: &[[u32; 2]], names: Names) -> Outcome<Sheets> {
    let active: Vec<u32> = (0..body.facet_count() as u32).filter(|&f| set.is_active[f as usize]).collect();
    let mut slot = vec![u32::MAX; body.facet_count()];
    active.iter().enumerate().for_each(|(k, &f)| slot[f as usize] = k as u32);
    let outlines: Vec<Outline> = if active.len() >= PARALLEL_FROM {
        active.par_iter().map(|&f| Outline::new(f, body.loops(f), Some(set), &body.points)).collect()
    } else {
        active.iter().map(|&f| Outline::new(f, body.loops(f), Some(set), &body.points)).collect()
    };
    let pairs: Vec<[u32; 2]> = pairs.iter().map(|p| p.map(|f| slot[f as usize])).collect();
    let (references, sheet_of) = group(body, &outlines, &pairs);
    let landed = landings(body, set, &outlines, &pairs, &sheet_of);
    let (mut lone, mut segments, mut chords) = (Vec::new(), Vec::new(), Vec::new());
    let (mut inside, mut near_misses) = (Vec::new(), Vec::new());
    for landing in &landed {
        let outline = &outlines[landing.on as usize];
        let leaf = body.leaf_of_facet[outline.facet as usize];
        let sheet = sheet_of[landing.on as usize];
        match landing.what {
            What::Point(p) if set.put_into_facet(outline.facet, leaf, p) => {
                lone.push((sheet, p));
                inside.push((landing.on, p));
            }
            What::Point(_) => {}
            What::NearMiss(p) => near_misses.push((p, landing.on)),
            // Points come before the segments that they end.
            What::Segment(ends) => {
                if ends.iter().all(|&v| outline.has_corner(v) || set.put_into_facet(outline.facet, leaf, v)) {
                    segments.push((sheet, ends));
                }
            }
        }
    }
    for chord in chords::find(body, &outlines, &sheet_of, &inside) {
        chords.extend(chord.facets.map(|slot| (sheet_of[slot as usize], chord.ends)));
    }
    let errors = chains(body, &outlines, &landed, &near_misses, names);
    if !errors.is_empty() {
        return Err(errors);
    }
    let count = references.len();
    let members = Lists::from_iter(count, sheet_of.iter().copied().zip(0..));
    let (segments, lone, chords) = (Lists::new(count, &segments), Lists::new(count, &lone), Lists::new(count, &chords));
    Ok(Sheets { outlines, slot, references, members, segments, lone, chords })
}

/// Sheets of level facets that overlap: the reference of each sheet, and the sheet of each facet.
fn group(body: &Body, outlines: &[Outline], pairs: &[[u32; 2]]) -> (Vec<u32>, Vec<u32>) {
    let mut sets = UnionFind::new(outlines.len());
    let mut is_alone = vec![true; outlines.len()];
    for &[f, g] in pairs {
        if sets.find(f) != sets.find(g) && are_overlapping(body, &outlines[f as usize], &outlines[g as usize]) {
            sets.join(f, g);
            (is_alone[f as usize], is_alone[g as usize]) = (false, false);
        }
    }
    let largest = |a: u32, b: u32| if outlines[b as usize].area > outlines[a as usize].area { b } else { a };
    let mut largest_of: Vec<u32> = (0..outlines.len() as u32).collect();
    for k in 0..outlines.len() as u32 {
        let r = sets.find(k) as usize;
        largest_of[r] = largest(largest_of[r], k);
    }
    // Facets that left the plane step by step are sheets of their own: their edges then count like those of any other.
    let mut number = vec![u32::MAX; outlines.len()];
    let mut references = Vec::with_capacity(outlines.len());
    let mut sheet_of = Vec::with_capacity(outlines.len());
    for (k, outline) in outlines.iter().enumerate() {
        let r = sets.find(k as u32) as usize;
        let main = largest_of[r];
        let share = level(body, outline.facet, outlines[main as usize].facet);
        if is_alone[k] || !outlines[main as usize].is_level_with(outline, share, &body.points) {
            sheet_of.push(references.len() as u32);
            references.push(k as u32);
            continue;
        }
        if number[r] == u32::MAX {
            number[r] = references.len() as u32;
            references.push(main);
        }
        sheet_of.push(number[r]);
    }
    (references, sheet_of)
}

fn level(body: &Body, f: u32, g: u32) -> f64 {
    SHEET_SHARE * body.tolerance(body.leaf_of_facet[f as usize], body.leaf_of_facet[g as usize])
}

fn are_overlapping(body: &Body, f: &Outline, g: &Outline) -> bool {
    let (large, small) = if f.area >= g.area { (f, g) } else { (g, f) };
    large.is_level_with(small, level(body, f.facet, g.facet), &body.points)
        && (large.is_entered_by(small, &body.points) || small.is_entered_by(large, &body.points))
}

/// Something of one facet that lies on another.
#[derive(Clone)]
struct Landing {
    on: u32,
    what: What,
}

#[derive(Clone, Copy)]
enum What {
    Point(u32),
    Segment([u32; 2]),
    /// A point beyond the tolerance, but near.
    NearMiss(u32),
}

/// What lies on facets of other sheets, in the order of pairs.
fn landings(body: &Body, set: &EdgeSet, outlines: &[Outline], pairs: &[[u32; 2]], sheet_of: &[u32]) -> Vec<Landing> {
    let search = |chunk: &[[u32; 2]]| {
        let mut found = Vec::new();
        for &[f, g] in chunk.iter().filter(|[f, g]| sheet_of[*f as usize] != sheet_of[*g as usize]) {
            land(body, set, &outlines[f as usize], &outlines[g as usize], g, &mut found);
            land(body, set, &outlines[g as usize], &outlines[f as usize], f, &mut found);
        }
        found
    };
    if pairs.len() >= PARALLEL_FROM {
        let lists: Vec<Vec<Landing>> = pairs.par_chunks(pairs.len().div_ceil(256)).map(search).collect();
        lists.concat()
    } else {
        search(pairs)
    }
}

/// Edges of `from` on facet `onto`. An edge whose ends lie beyond the tolerance on different sides may still have a point on
/// it in between, where it crosses a third one.
fn land(body: &Body, set: &EdgeSet, from: &Outline, onto: &Outline, slot: u32, found: &mut Vec<Landing>) {
    let leaf = body.leaf_of_facet[onto.facet as usize];
    let tolerance = body.tolerance(body.leaf_of_facet[from.facet as usize], leaf);
    let height = |v: u32| onto.height(&body.points[v as usize]);
    let near = onto.bounds.inflated(2.0 * CHAIN_REACH * tolerance);
    let reach = CHAIN_REACH * tolerance;
    set.own_near(from.facet, &near, |edge| {
        if !near.overlaps(set.bounds(edge)) {
            return;
        }
        let ends = set.edges[edge as usize].ends.map(height);
        if ends.iter().all(|&h| h > reach) || ends.iter().all(|&h| h < -reach) {
            return;
        }
        let mut previous: Option<(u32, bool)> = None;
        for v in set.points_between(edge, near_plane(ends, reach)) {
            // Most points of an edge that comes near are not near themselves.
            if !near.contains(&body.points[v as usize]) {
                previous = None;
                continue;
            }
            let h = height(v).abs();
            let is_corner = onto.has_corner(v);
            let is_inside =
                !is_corner && h <= reach && !set.is_elsewhere(v, leaf) && onto.encloses(&body.points[v as usize], &body.points);
            if is_inside && h > tolerance {
                found.push(Landing { on: slot, what: What::NearMiss(v) });
            }
            let is_on = is_corner || is_inside && h <= tolerance;
            if is_inside && is_on {
                found.push(Landing { on: slot, what: What::Point(v) });
            }
            if let (true, Some((u, was_inside))) = (is_on, previous)
                && (was_inside || is_inside || onto.is_chord([u, v], tolerance, &body.points))
            {
                found.push(Landing { on: slot, what: What::Segment([u.min(v), u.max(v)]) });
            }
            previous = is_on.then_some((v, is_inside));
        }
    });
}

/// Parameters between which an edge whose ends have these heights may have points within `reach` of the plane. Points lie up
/// to half of `reach` beside their edge.
fn near_plane([from, to]: [f64; 2], reach: f64) -> [f64; 2] {
    let at = |h: f64| (h - from) / (to - from);
    let (a, b) = (at(-1.5 * reach), at(1.5 * reach));
    if a.is_finite() && b.is_finite() { [a.min(b), a.max(b)] } else { [0.0, 1.0] }
}

/// Points that lie on a facet which itself lies on another one there, from which they are too far.
fn chains(body: &Body, outlines: &[Outline], landed: &[Landing], misses: &[(u32, u32)], names: Names) -> Vec<Diagnostic> {
    if misses.is_empty() {
        return Vec::new();
    }
    let mut on: Vec<(u32, u32)> =
        landed.iter().filter_map(|l| if let What::Point(p) = l.what { Some((p, l.on)) } else { None }).collect();
    on.sort_unstable();
    let mut errors = Tally::default();
    for &(point, far) in misses {
        let place = body.points[point as usize];
        let first = on.partition_point(|o| o.0 < point);
        for &(_, near) in on[first..].iter().take_while(|o| o.0 == point) {
            let (near, far) = (&outlines[near as usize], &outlines[far as usize]);
            let foot = place - near.normal * near.height(&place);
            let leaves = [near, far].map(|o| body.leaf_of_facet[o.facet as usize]);
            if leaves[0] != leaves[1] && far.height(&foot).abs() <= body.tolerance(leaves[0], leaves[1]) {
                errors.add(leaves, || chain(leaves.map(|l| l as usize), &[place], names));
            }
        }
        if errors.len() >= MAX_MESSAGES {
            break;
        }
    }
    errors.finish()
}
