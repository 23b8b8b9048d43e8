//! Parts, their copies and their named boundaries.

use super::ast;
use super::expr::Kind;
use super::leaves::{Planter, Settings};
use super::model::{Boundary, BoundaryId, BoundarySelection, Part};
use super::motion::Motion;
use super::reader::{Owner, Reader};
use super::solids::SolidReader;
use super::source::{Field, Raw};
use super::tree::Tree;
use crate::diag::{Diagnostic, Span};
use crate::ids::{IdVec, LeafId, PartId};
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

/// What the `parts` list becomes.
pub(super) struct Parts<'l> {
    pub parts: IdVec<PartId, Part>,
    pub boundaries: IdVec<BoundaryId, Boundary>,
    pub planter: Planter<'l>,
    /// Names given so far, with their places.
    names: BTreeMap<String, Span>,
    /// Names by which interfaces can call parts, also faulty ones: those of all parts, and those that copies share.
    callable: BTreeSet<String>,
    /// Names shared by copies.
    patterns: BTreeSet<String>,
    /// Whether some could not be read, so that a name that is not known may be one of them.
    pub is_incomplete: bool,
}

/// A part as it is written; its copies differ in name and place only. Of a faulty one there are the names that could be read.
struct Pattern<'a> {
    name: Option<String>,
    at: Raw<'a>,
    /// Places of the copies; `None` if the part is not repeated.
    motions: Option<Vec<Motion>>,
    boundaries: Vec<Named<'a>>,
    body: Option<Body>,
}

/// What a part is.
struct Body {
    material: Option<String>,
    max_edge: Option<f64>,
    max_volume: Option<f64>,
    settings: Settings,
    tree: Rc<Tree>,
}

/// A boundary as it is written.
struct Named<'a> {
    name: String,
    at: Raw<'a>,
    side: Option<(Option<String>, Option<String>, Raw<'a>)>,
}

impl<'l> Parts<'l> {
    /// No parts yet.
    pub fn new(planter: Planter<'l>) -> Self {
        Self {
            parts: IdVec::new(),
            boundaries: IdVec::new(),
            planter,
            names: BTreeMap::new(),
            callable: BTreeSet::new(),
            patterns: BTreeSet::new(),
            is_incomplete: false,
        }
    }

    /// Reads one part and appends it, or its copies.
    pub fn add<'a>(&mut self, solids: &mut SolidReader<'_, 'a>, raw: Raw<'a>, settings: Settings) {
        let pattern = read_part(solids, raw, settings);
        // Of a faulty part that is repeated, not all copies are named.
        self.is_incomplete |= pattern.as_ref().is_none_or(|p| p.name.is_none() || (p.body.is_none() && p.motions.is_some()));
        if let Some(pattern) = pattern {
            self.append(solids.reader, &pattern);
        }
    }

    /// Whether this is the name that copies share.
    pub fn are_copies(&self, name: &str) -> bool {
        self.patterns.contains(name)
    }

    /// The names by which interfaces can call parts, none twice.
    pub fn callable(&self) -> BTreeSet<&str> {
        self.callable.iter().map(String::as_str).collect()
    }

    fn append<'a>(&mut self, reader: &mut Reader<'a>, pattern: &Pattern<'a>) {
        let single = [None];
        let motions: Vec<Option<Motion>> = match &pattern.motions {
            None => single.to_vec(),
            Some(motions) => motions.iter().map(|m| Some(*m)).collect(),
        };
        let count = motions.len();
        for (k, motion) in motions.into_iter().enumerate() {
            let numbered = |name: &str| match &pattern.motions {
                None => name.to_owned(),
                Some(_) => format!("{name}{}", k + 1),
            };
            // All names are claimed, so that none that is taken is hidden by another fault of its part.
            let name = pattern.name.as_deref().map(numbered);
            let mut is_new = name.as_ref().is_none_or(|name| self.claim(reader, name, pattern.at, "part"));
            let boundaries: Vec<(String, &Named)> = pattern.boundaries.iter().map(|b| (numbered(&b.name), b)).collect();
            for (name, boundary) in &boundaries {
                is_new &= self.claim(reader, name, boundary.at, "boundary");
            }
            self.callable.extend(name.clone());
            if let Some(body) = &pattern.body {
                let span = reader.span(pattern.at);
                let solid = match self.planter.plant(&body.tree, motion, count, body.settings, span) {
                    Ok(solid) => solid,
                    Err(fault) => return reader.fault(fault),
                };
                let Body { max_edge, max_volume, .. } = *body;
                let material = body.material.clone();
                let copy_of = motion.and(pattern.name.clone());
                self.patterns.extend(copy_of.clone());
                self.callable.extend(copy_of.clone());
                let name = name.unwrap_or_default();
                let part = self.parts.push(Part { name, copy_of, material, solid, max_edge, max_volume, span });
                for (name, boundary) in boundaries {
                    self.add_boundary(reader, boundary, part, name);
                }
            }
            // The other copies would say the same; those of a faulty part are never made, and may be any number.
            if !is_new || pattern.name.is_none() || pattern.body.is_none() {
                return;
            }
        }
    }

    /// Takes a name; a name that is taken is a fault.
    fn claim<'a>(&mut self, reader: &mut Reader<'a>, name: &str, at: Raw<'a>, what: &str) -> bool {
        let Some(first) = self.names.insert(name.to_owned(), reader.span(at)) else { return true };
        let message = format!("the {what} `{name}` has a name that was given at {}:{} already", first.line, first.column);
        let hint = "give each part and each boundary a name of its own; copies have their number behind it";
        reader.fail::<()>(at, "duplicate-name", message, hint);
        false
    }

    fn add_boundary<'a>(&mut self, reader: &mut Reader<'a>, named: &Named<'a>, part: PartId, name: String) {
        let span = reader.span(named.at);
        let selection = match &named.side {
            None => Some(BoundarySelection::Outer),
            Some((of, side, at)) => self.select(reader, of.as_deref(), side.as_deref(), *at),
        };
        if let Some(selection) = selection {
            self.boundaries.push(Boundary { name, part, selection, span });
        }
    }

    /// The leaves of the last part that have a name (all without one) and a side.
    fn select<'a>(
        &self,
        reader: &mut Reader<'a>,
        of: Option<&str>,
        side: Option<&str>,
        at: Raw<'a>,
    ) -> Option<BoundarySelection> {
        if reader.is_full() {
            return None;
        }
        let of_part = &self.planter.named;
        let mut leaves: Vec<LeafId> = match of {
            Some(of) => of_part.get(of).cloned().unwrap_or_default(),
            None => self.parts.iter().last().map_or(Vec::new(), |part| leaves_of(&part.solid)),
        };
        leaves.sort_unstable();
        leaves.dedup();
        if leaves.is_empty() {
            let of = of.unwrap_or("");
            let fault = Diagnostic::error("unknown-solid", format!("the part has no solid named `{of}`")).at(reader.span(at));
            reader.fault(super::fault::with_names(fault, of, of_part.keys().map(String::as_str)));
            return None;
        }
        let Some(written) = side else {
            return Some(BoundarySelection::Sides(leaves.into_iter().map(|leaf| (leaf, None)).collect()));
        };
        let called = |&leaf: &LeafId| self.planter.leaves[leaf].primitive.side_called(written).map(|side| (leaf, Some(side)));
        let sides: Vec<(LeafId, Option<String>)> = leaves.iter().filter_map(called).collect();
        if sides.is_empty() {
            let known: BTreeSet<String> =
                leaves.iter().flat_map(|&id| self.planter.leaves[id].primitive.names_of_sides()).collect();
            let message = match of {
                Some(of) => format!("`{of}` has no side `{written}`"),
                None => format!("no solid of the part has a side `{written}`"),
            };
            let fault = Diagnostic::error("unknown-side", message).at(reader.span(at));
            reader.fault(super::fault::with_names(fault, written, known.iter().map(String::as_str)));
            return None;
        }
        Some(BoundarySelection::Sides(sides))
    }
}

/// The leaves of an expression.
fn leaves_of(node: &super::model::Node) -> Vec<LeafId> {
    match node {
        super::model::Node::Leaf(id) => vec![*id],
        super::model::Node::Boolean(_, operands) => operands.iter().flat_map(leaves_of).collect(),
    }
}

fn read_part<'a>(solids: &mut SolidReader<'_, 'a>, raw: Raw<'a>, scene: Settings) -> Option<Pattern<'a>> {
    let owner = Owner { kind: "Part", raw };
    let reader = &mut *solids.reader;
    let node: ast::Part = reader.read(raw)?;
    let name = reader.need(owner, "name", node.name).and_then(|raw| reader.name_of_interfaces("name of a part", raw));
    let material = reader.maybe(node.material, |r, raw| r.name("name of a material", raw));
    let max_edge = reader.maybe(node.max_edge, |r, raw| r.size("max_edge", raw));
    let max_volume = reader.maybe(node.max_volume, |r, raw| r.positive("max_volume", raw, Kind::Length(3)));
    let division = reader.maybe(node.discretization, Reader::division);
    let is_triangulated = reader.read_or(node.triangulated, scene.is_triangulated);
    let motions = reader.maybe(node.copies, read_copies);
    let boundaries = read_boundaries(reader, node.boundaries);
    let solid = reader.need(owner, "solid", node.solid).and_then(|raw| solids.solid(raw));
    let settings = Settings {
        division: division.flatten().unwrap_or(scene.division),
        is_triangulated: is_triangulated.unwrap_or(scene.is_triangulated),
    };
    let (material, max_edge, max_volume) = (material.flatten(), max_edge.flatten(), max_volume.flatten());
    // Whatever else is faulty, the sides that boundaries name are looked for in the solid.
    let body = solid.map(|tree| Body { material, max_edge, max_volume, settings, tree });
    // How often a part with faulty copies is repeated, and so what its names are, nobody knows.
    Some(Pattern { name, at: raw, motions: motions?, boundaries, body })
}

fn read_copies<'a>(reader: &mut Reader<'a>, raw: Raw<'a>) -> Option<Vec<Motion>> {
    let (inner, motions) = match reader.read::<ast::Copies>(raw)? {
        ast::Copies::Linear(node) => (node.solid, reader.linear(Owner { kind: "Linear", raw }, &node)),
        ast::Copies::Polar(node) => (node.solid, reader.polar(Owner { kind: "Polar", raw }, &node)),
    };
    match inner.0 {
        None => motions,
        Some(raw) => {
            let message = "`copies` repeats the part's own solid; it has no `solid`";
            reader.fail(raw, "conflict", message, "leave out this `solid`; the part has one")
        }
    }
}

/// The boundaries that could be read.
fn read_boundaries<'a>(reader: &mut Reader<'a>, field: Field<'a>) -> Vec<Named<'a>> {
    let list = reader.read_or::<Vec<Raw>>(field, Vec::new()).unwrap_or_default();
    list.into_iter().filter_map(|raw| read_boundary(reader, raw)).collect()
}

fn read_boundary<'a>(reader: &mut Reader<'a>, raw: Raw<'a>) -> Option<Named<'a>> {
    let (kind, name, side) = match reader.read::<ast::Boundary>(raw)? {
        ast::Boundary::Outer(node) => ("Outer", node.name, None),
        ast::Boundary::Side(node) => ("Side", node.name, Some((node.of, node.side))),
    };
    let owner = Owner { kind, raw };
    let name = reader.need(owner, "name", name).and_then(|raw| reader.name_of_interfaces("name of a boundary", raw));
    let side = match side {
        None => Some(None),
        Some((of, side)) => {
            let at = side.0.or(of.0).unwrap_or(raw);
            let of = reader.maybe(of, |r, raw| r.read::<String>(raw));
            let side = reader.maybe(side, |r, raw| r.read::<String>(raw));
            of.zip(side).map(|(of, side)| Some((of, side, at)))
        }
    };
    Some(Named { name: name?, at: raw, side: side? })
}
