//! What is wrong with a model or may not be meant, by name and place.

use crate::arrangement::Arrangement;
use crate::brep::complex::Complex;
use crate::classify::Classified;
use crate::contact::{self, conforming::Conforming};
use crate::diag::{Diagnostic, Name, Outcome, Severity, short};
use crate::geom::Vec3;
use crate::geom::polygon;
use crate::ids::{LeafId, PartId};
use crate::primitive::solid::Solid;
use crate::round::Fault;
use crate::scene::model::{BoundarySelection, Interface, Node, OUTER, Policy, Scene};
use crate::select::Selected;
use std::collections::{BTreeMap, BTreeSet};

/// Parts whose tree uses a leaf, in file order.
fn users(scene: &Scene, leaf: LeafId) -> Vec<PartId> {
    fn uses(node: &Node, leaf: LeafId) -> bool {
        match node {
            Node::Leaf(l) => *l == leaf,
            Node::Boolean(_, operands) => operands.iter().any(|o| uses(o, leaf)),
        }
    }
    scene.parts.enumerate().filter(|(_, p)| uses(&p.solid, leaf)).map(|(id, _)| id).collect()
}

/// How messages call a leaf.
pub fn leaf_name(scene: &Scene, leaf: LeafId) -> Name {
    let span = scene.leaves[leaf].span;
    let what = scene.leaves[leaf].name.as_ref().map_or("a solid".to_owned(), |n| format!("`{n}`"));
    let text = match users(scene, leaf).first() {
        Some(&part) => format!("{what} of part `{}` (line {})", scene.parts[part].name, span.line),
        None => format!("{what} (line {})", span.line),
    };
    Name { text, span }
}

/// Contacts that are resolved with a smaller tolerance only: what was wrong with the one that was asked for.
pub fn finer(faults: Vec<Diagnostic>, asked: f64, taken: f64) -> Vec<Diagnostic> {
    let soften = |mut d: Diagnostic| {
        d.severity = Severity::Warning;
        d.hints = vec![format!(
            "the tolerance {} is taken instead of {}: touching parts further apart stay apart",
            short(taken),
            short(asked)
        )];
        d
    };
    faults.into_iter().map(soften).collect()
}

/// Parts that come near without touching: warnings, or errors if the scene forbids them.
pub fn gaps(scene: &Scene, solids: &[Solid], conforming: &Conforming) -> Outcome<Vec<Diagnostic>> {
    let mut nearest: BTreeMap<(PartId, PartId), (f64, Vec3)> = BTreeMap::new();
    for gap in contact::nearly_touching(solids, conforming) {
        let [first, second] = gap.leaves.map(|l| users(scene, l));
        if first.iter().any(|p| second.contains(p)) {
            continue;
        }
        let (Some(&a), Some(&b)) = (first.first(), second.first()) else { continue };
        let entry = nearest.entry((a.min(b), a.max(b))).or_insert((gap.distance, gap.place));
        if gap.distance < entry.0 {
            *entry = (gap.distance, gap.place);
        }
    }
    let describe = |(&(a, b), &(distance, place)): (&(PartId, PartId), &(f64, Vec3))| {
        let (a, b) = (&scene.parts[a], &scene.parts[b]);
        let text = format!("parts `{}` and `{}` are {distance:.3e} {} apart without touching", a.name, b.name, scene.unit);
        let diagnostic = match scene.gaps {
            Policy::Allow => Diagnostic::warning("narrow-gap", text),
            Policy::Forbid => Diagnostic::error("narrow-gap", text),
        };
        diagnostic
            .at(b.span)
            .near(place)
            .hint("let them touch exactly, move them apart, or raise `tolerance` if they are meant to touch")
    };
    let found: Vec<Diagnostic> = nearest.iter().map(describe).collect();
    if scene.gaps == Policy::Forbid && !found.is_empty() { Err(found) } else { Ok(found) }
}

/// Overlapping parts, if the scene forbids them, with the common volume.
pub fn overlaps(scene: &Scene, arrangement: &Arrangement, classified: &Classified, selected: &Selected) -> Vec<Diagnostic> {
    if scene.overlap == Policy::Allow || selected.overlaps.is_empty() {
        return Vec::new();
    }
    let mut claimants: BTreeMap<u32, BTreeSet<PartId>> = BTreeMap::new();
    for o in &selected.overlaps {
        claimants.entry(o.label).or_default().extend([o.loser, o.winner]);
    }
    let mut labels: BTreeMap<(PartId, PartId), BTreeSet<u32>> = BTreeMap::new();
    for (label, parts) in claimants {
        let later = |a: PartId| parts.iter().filter(move |b| **b > a).map(move |&b| (a, b));
        for pair in parts.iter().flat_map(|&a| later(a)) {
            labels.entry(pair).or_default().insert(label);
        }
    }
    let describe = |(&(a, b), set): (&(PartId, PartId), &BTreeSet<u32>)| {
        let (volume, place) = volume_of(arrangement, classified, set)?;
        let (a, b) = (&scene.parts[a], &scene.parts[b]);
        let text = format!("parts `{}` and `{}` overlap in {} {}^3", a.name, b.name, short(volume), scene.unit);
        let error = Diagnostic::error("overlap", text).at(b.span).near(place);
        Some(error.hint("subtract one from the other, or set `overlap: Allow`"))
    };
    labels.iter().filter_map(describe).collect()
}

/// Volume of the places with the given labels, and one of their vertices; `None` if there is no such place: parts that touch
/// have the label of both on the facets where they do.
fn volume_of(arrangement: &Arrangement, classified: &Classified, labels: &BTreeSet<u32>) -> Option<(f64, Vec3)> {
    let cells = &arrangement.cells;
    let places: Vec<Vec3> = (0..arrangement.points.len() as u32).map(|p| arrangement.points.at(p)).collect();
    let (mut volume, mut origin) = (0.0, None);
    for (cell, shells) in classified.shells.iter().enumerate() {
        let [front, back] = shells.map(|s| labels.contains(&classified.label_of_shell[s as usize]));
        if front == back {
            continue;
        }
        let corner = cells.loops(cell).next().map_or(Vec3::zeros(), |l| places[l[0] as usize]);
        let origin = *origin.get_or_insert(corner);
        let third = (corner - origin).dot(&polygon::vector_area(cells.loops(cell), &places)) / 3.0;
        volume += if back { third } else { -third };
    }
    Some((volume, origin?))
}

/// Parts that are left without volume: errors. No part at all is one too.
pub fn empty_parts(scene: &Scene, selected: &Selected) -> Vec<Diagnostic> {
    let alive: BTreeSet<PartId> = selected.part_of_volume.iter().copied().flatten().collect();
    let empty = scene.parts.enumerate().filter(|(id, _)| !alive.contains(id));
    empty
        .map(|(_, part)| {
            Diagnostic::error("empty-part", format!("part `{}` is empty: nothing is left of its solid", part.name))
                .at(part.span)
                .hint("later parts take the space of earlier ones: put an enclosing box first; or check the Boolean operations")
        })
        .collect()
}

/// Named boundaries that name nothing, and those of which another one that is listed earlier takes facets. That an `Outer`
/// leaves facets to boundaries listed before it is what it is for.
pub fn boundaries(scene: &Scene, arrangement: &Arrangement, selected: &Selected) -> Vec<Diagnostic> {
    let place = |cell: u32| {
        let corner = arrangement.cells.loops(cell as usize).next().and_then(|l| l.first().copied());
        corner.map_or(Vec3::zeros(), |v| arrangement.points.at(v))
    };
    let mut found = Vec::new();
    for (id, boundary) in scene.boundaries.enumerate() {
        let claim = &selected.claims[id];
        let (name, part) = (&boundary.name, &scene.parts[boundary.part].name);
        let is_outer = matches!(boundary.selection, BoundarySelection::Outer);
        if !claim.has_facets && claim.lost.is_empty() {
            let (what, hint) = match is_outer {
                true => ("no facet of the part faces the outside", "other parts cover it all: leave the boundary out"),
                false => (
                    "the side does not reach the surface of the part",
                    "it lies inside the part, was cut off or is covered by a later part: name another side",
                ),
            };
            let message = format!("the boundary `{name}` of part `{part}` names no facet: {what}");
            found.push(Diagnostic::warning("empty-boundary", message).at(boundary.span).hint(hint));
        } else if !(claim.lost.is_empty() || is_outer && claim.has_facets) {
            let names = claim.lost.keys().map(|&w| format!("`{}`", scene.boundaries[w].name)).collect::<Vec<_>>();
            let left = if claim.has_facets { "keeps the rest" } else { "keeps none" };
            let message = format!(
                "facets of the boundary `{name}` of part `{part}` have the name {} already, which is listed earlier; `{name}` {left}",
                names.join(" or ")
            );
            let warning = Diagnostic::warning("taken-boundary", message).at(boundary.span);
            let places = claim.lost.values().map(|&cell| place(cell));
            found.push(
                places
                    .fold(warning, |w, p| w.near(p))
                    .hint("a facet has one name: list the one first that shall have it, or drop the other"),
            );
        }
    }
    found
}

/// Interfaces of which the scene asks something, and which are none.
pub fn interfaces(scene: &Scene, selected: &Selected) -> Vec<Diagnostic> {
    let found: BTreeSet<_> = selected.markers.iter().flat_map(|m| scene.interfaces_between(m.parts).map(|i| i.0)).collect();
    let missing = scene.interfaces.iter().filter(|(names, _)| !found.contains(names));
    let describe = |([a, b], interface): (&[String; 2], &Interface)| {
        let (a, b) = if a == OUTER { (b, a) } else { (a, b) };
        let (message, hint) = match b == OUTER {
            true => (format!("nothing of `{a}` faces the outside"), "other parts cover it: take the entry out"),
            false => (format!("`{a}` and `{b}` do not touch"), "name two parts that share a surface, or let them touch"),
        };
        Diagnostic::warning("empty-interface", format!("the interface `{a}|{b}` has no facet: {message}"))
            .at(interface.span)
            .hint(hint)
    };
    missing.map(describe).collect()
}

/// A result that rounding breaks: the parts and places.
pub fn broken(scene: &Scene, complex: &Complex, faults: &[Fault]) -> Vec<Diagnostic> {
    let mut seen = BTreeSet::new();
    let mut out = Vec::new();
    for fault in faults {
        let leaves = fault.facets.map(|f| complex.facets[f].source.0);
        if !seen.insert(leaves) || out.len() >= 10 {
            continue;
        }
        let [a, b] = leaves.map(|l| leaf_name(scene, l));
        let text =
            format!("facets of {a} and {b} come so near that rounding to 64-bit coordinates makes them meet or turn over");
        out.push(
            Diagnostic::error("rounding", text)
                .at(a.span)
                .near(fault.point)
                .hint("move one of them by more than the contact tolerance, or raise `tolerance` so that they touch"),
        );
    }
    out
}
