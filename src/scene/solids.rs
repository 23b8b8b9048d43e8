//! Solids as they are written, to shared [`Tree`]s: Booleans, motions, patterns, named solids.

use super::ast::{self, Entries, Solid};
use super::fault::with_names;
use super::model::{Operation, Primitive};
use super::motion::Motion;
use super::reader::{MAX_LENGTH, Owner, Reader};
use super::source::{Field, Raw};
use super::tree::Tree;
use crate::diag::Diagnostic;
use crate::geom::Vec3;
use std::collections::BTreeMap;
use std::path::Path;
use std::rc::Rc;

/// Depth of solids in solids, through names too: bounds the stack.
const MAX_DEPTH: usize = 1000;
/// Copies in one pattern; the limit on leaves comes before in any real scene.
const MAX_COPIES: u32 = 1_000_000;

/// Named solids, read on first use.
#[derive(Default)]
pub(super) struct Library<'a> {
    entries: BTreeMap<String, (Raw<'a>, State)>,
    /// Names being read, outermost first.
    chain: Vec<String>,
}

#[derive(Clone)]
enum State {
    New,
    Busy,
    /// `None` if it is faulty.
    Done(Option<Rc<Tree>>),
}

/// Reads solids.
pub(super) struct SolidReader<'r, 'a> {
    pub reader: &'r mut Reader<'a>,
    pub library: Library<'a>,
    /// Where relative files are.
    pub folder: &'r Path,
    /// Whether imports may lie outside of the folder.
    pub is_free: bool,
    depth: usize,
}

impl<'r, 'a> SolidReader<'r, 'a> {
    /// Reads the `solids` map.
    pub fn new(reader: &'r mut Reader<'a>, solids: Field<'a>, folder: &'r Path, is_free: bool) -> Self {
        let mut library = Library::default();
        let entries = solids.0.and_then(|raw| reader.read::<Entries>(raw));
        for (key, value) in entries.map_or(Vec::new(), |e| e.0) {
            let Some(name) = reader.name("name of a solid", key) else { continue };
            if library.entries.insert(name.clone(), (value, State::New)).is_some() {
                let message = format!("the solid `{name}` is given twice");
                reader.fail::<()>(key, "duplicate-name", message, "give one of them another name");
            }
        }
        Self { reader, library, folder, is_free, depth: 0 }
    }

    /// Reads the named solids that nothing used, for their faults.
    pub fn finish(&mut self) {
        let names: Vec<String> = self.library.entries.keys().cloned().collect();
        for name in names {
            let raw = match self.library.entries.get(&name) {
                Some((raw, State::New)) => *raw,
                _ => continue,
            };
            self.named(raw, &name);
        }
    }

    /// A solid.
    pub fn solid(&mut self, raw: Raw<'a>) -> Option<Rc<Tree>> {
        if self.depth == MAX_DEPTH {
            let message = format!("solids are nested more than {MAX_DEPTH} deep");
            return self.reader.fail(raw, "too-deep", message, "one operation takes any number of operands: Union([a, b, c])");
        }
        self.depth += 1;
        let tree = self.any_solid(raw);
        self.depth -= 1;
        tree
    }

    fn any_solid(&mut self, raw: Raw<'a>) -> Option<Rc<Tree>> {
        let own = |kind| Owner { kind, raw };
        let solid = self.reader.read::<Solid>(raw)?;
        macro_rules! primitive {
            ($kind:literal, $read:ident, $node:expr) => {{
                let primitive = self.reader.$read(own($kind), &$node);
                self.reader.leaf(own($kind), $node.common(), primitive, None)
            }};
        }
        match solid {
            Solid::Block(node) => primitive!("Block", block, node),
            Solid::Prism(node) => primitive!("Prism", prism, node),
            Solid::Pyramid(node) => primitive!("Pyramid", pyramid, node),
            Solid::Cylinder(node) => primitive!("Cylinder", cylinder, node),
            Solid::Tube(node) => primitive!("Tube", tube, node),
            Solid::Cone(node) => primitive!("Cone", cone, node),
            Solid::Frustum(node) => primitive!("Frustum", frustum, node),
            Solid::Sphere(node) => primitive!("Sphere", sphere, node),
            Solid::Ellipsoid(node) => primitive!("Ellipsoid", ellipsoid, node),
            Solid::Torus(node) => primitive!("Torus", torus, node),
            Solid::Extrude(node) => primitive!("Extrude", extrude, node),
            Solid::Revolve(node) => primitive!("Revolve", revolve, node),
            Solid::Sweep(node) => primitive!("Sweep", sweep, node),
            Solid::Import(node) => self.imported(own("Import"), &node),
            Solid::Union(list) => self.boolean(raw, Operation::Union, &list),
            Solid::Difference(list) => self.boolean(raw, Operation::Difference, &list),
            Solid::Intersection(list) => self.boolean(raw, Operation::Intersection, &list),
            Solid::Xor(list) => self.boolean(raw, Operation::Xor, &list),
            Solid::Translate(node) => {
                let by = self.reader.need(own("Translate"), "by", node.by).and_then(|raw| self.reader.point("by", raw));
                self.copies(own("Translate"), by.map(|by| vec![Motion::translation(by)]), node.solid)
            }
            Solid::Rotate(node) => {
                let motion = self.rotation(own("Rotate"), &node);
                self.copies(own("Rotate"), motion, node.solid)
            }
            Solid::Scale(node) => {
                let motion = self.scale(own("Scale"), &node);
                self.copies(own("Scale"), motion, node.solid)
            }
            Solid::Mirror(node) => {
                let motion = self.mirror(own("Mirror"), &node);
                self.copies(own("Mirror"), motion, node.solid)
            }
            Solid::Linear(node) => {
                let motions = self.reader.linear(own("Linear"), &node);
                self.copies(own("Linear"), motions, node.solid)
            }
            Solid::Polar(node) => {
                let motions = self.reader.polar(own("Polar"), &node);
                self.copies(own("Polar"), motions, node.solid)
            }
            Solid::Use(name) => self.named(raw, &name),
        }
    }

    fn imported(&mut self, owner: Owner<'a>, node: &ast::Import<'a>) -> Option<Rc<Tree>> {
        let primitive = self.reader.import(owner, node, self.folder, self.is_free);
        let tolerance = self.reader.maybe(node.tolerance, Reader::tolerance);
        // The numbers of an STL file are single precision.
        let is_stl = matches!(&primitive, Some(Primitive::Import { path, .. })
            if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("stl")));
        let tolerance = tolerance?.or(is_stl.then_some(1e-6));
        self.reader.leaf(owner, node.common(), primitive, tolerance)
    }

    fn boolean(&mut self, raw: Raw<'a>, operation: Operation, list: &[Raw<'a>]) -> Option<Rc<Tree>> {
        if list.is_empty() {
            let warning = Diagnostic::warning("empty-node", "this operation has no operands: it is empty")
                .hint("fill in its operands, or take it out");
            self.reader.warnings.push(warning.at(self.reader.span(raw)));
        }
        let operands: Vec<Option<Rc<Tree>>> = list.iter().map(|&operand| self.solid(operand)).collect();
        Some(Rc::new(Tree::Boolean(operation, operands.into_iter().collect::<Option<_>>()?)))
    }

    /// Images of the inner solid.
    fn copies(&mut self, owner: Owner<'a>, motions: Option<Vec<Motion>>, solid: Field<'a>) -> Option<Rc<Tree>> {
        let inner = self.reader.need(owner, "solid", solid).and_then(|raw| self.solid(raw));
        Some(Rc::new(Tree::Copies(motions?, inner?)))
    }

    fn rotation(&mut self, owner: Owner<'a>, node: &ast::Rotate<'a>) -> Option<Vec<Motion>> {
        let axis = self.reader.need(owner, "axis", node.axis).and_then(|raw| self.reader.axis("axis", raw));
        let angle = self.reader.need(owner, "angle", node.angle).and_then(|raw| self.reader.degrees("angle", raw));
        let center = self.reader.point_or_origin("center", node.center);
        Some(vec![Motion::rotation(axis?, angle?, center?)])
    }

    fn mirror(&mut self, owner: Owner<'a>, node: &ast::Mirror<'a>) -> Option<Vec<Motion>> {
        let normal = self.reader.need(owner, "normal", node.normal).and_then(|raw| self.reader.axis("normal", raw));
        let center = self.reader.point_or_origin("center", node.center);
        Some(vec![Motion::mirror(normal?, center?)])
    }

    /// By one factor, or by one for each of x, y, z; none 0, and a negative one mirrors.
    fn scale(&mut self, owner: Owner<'a>, node: &ast::Scale<'a>) -> Option<Vec<Motion>> {
        let center = self.reader.point_or_origin("center", node.center);
        let raw = self.reader.need(owner, "by", node.by)?;
        let factors = if raw.0.starts_with('(') {
            let [x, y, z] = self.reader.tuple("by", raw)?.map(|f| self.reader.plain("by", f));
            Vec3::new(x?, y?, z?)
        } else {
            Vec3::repeat(self.reader.plain("by", raw)?)
        };
        // Factors beyond this make sizes that no unit is meant for.
        if factors.iter().any(|f| !(1e-6..=1e6).contains(&f.abs())) {
            let message = "factors of a Scale go from 1e-6 to 1e6, and must not be 0";
            return self.reader.fail(raw, "out-of-range", message, "check the factor; -1 mirrors");
        }
        Some(vec![Motion::scale(factors, center?)])
    }

    fn named(&mut self, raw: Raw<'a>, name: &str) -> Option<Rc<Tree>> {
        let Some((value, state)) = self.library.entries.get_mut(name) else {
            if self.reader.is_full() {
                return None;
            }
            let fault = Diagnostic::error("unknown-solid", format!("there is no solid `{name}` in `solids`"));
            let fault = with_names(fault.at(self.reader.span(raw)), name, self.library.entries.keys().map(String::as_str));
            self.reader.fault(fault);
            return None;
        };
        let value = *value;
        match state {
            State::Done(tree) => return tree.clone().map(|tree| Rc::new(Tree::Named(name.to_owned(), tree))),
            State::Busy => {
                let from = self.library.chain.iter().position(|link| link == name).unwrap_or(0);
                let cycle = self.library.chain[from..].join(" -> ");
                let message = format!("solids contain each other in a circle: {cycle} -> {name}");
                return self.reader.fail(raw, "cyclic-reference", message, "let one of them do without the others");
            }
            State::New => *state = State::Busy,
        }
        self.library.chain.push(name.to_owned());
        let tree = self.solid(value);
        self.library.chain.pop();
        if let Some(entry) = self.library.entries.get_mut(name) {
            entry.1 = State::Done(tree.clone());
        }
        tree.map(|tree| Rc::new(Tree::Named(name.to_owned(), tree)))
    }
}

impl<'a> Reader<'a> {
    /// The motions of a linear pattern: k times `step`.
    pub fn linear(&mut self, owner: Owner<'a>, node: &ast::Linear<'a>) -> Option<Vec<Motion>> {
        let count = self.need(owner, "count", node.count).and_then(|raw| self.count("count", raw, 1, MAX_COPIES));
        let step = self.need(owner, "step", node.step);
        let vector = step.and_then(|raw| self.point("step", raw));
        let (count, vector) = (count?, vector?);
        if vector == Vec3::zeros() && count > 1 {
            let message = "`step` is (0, 0, 0): all copies lie in one place";
            return self.fail(step.unwrap_or(owner.raw), "zero-axis", message, "write the way from one copy to the next");
        }
        if vector.amax() * f64::from(count) > MAX_LENGTH {
            let message = "the last copy lies farther out than 1e9 units";
            return self.fail(owner.raw, "out-of-range", message, "check `count` and `step`, and the units");
        }
        Some((0..count).map(|k| Motion::translation(vector * f64::from(k))).collect())
    }

    /// The motions of a polar pattern: k times `step`, or k / count of a full turn.
    pub fn polar(&mut self, owner: Owner<'a>, node: &ast::Polar<'a>) -> Option<Vec<Motion>> {
        let count = self.need(owner, "count", node.count).and_then(|raw| self.count("count", raw, 1, MAX_COPIES));
        let axis = self.axis_or_z(node.axis);
        let center = self.point_or_origin("center", node.center);
        let step = self.maybe(node.step, |r, raw| r.degrees("step", raw));
        let (count, axis, center, step) = (count?, axis?, center?, step?);
        let angle = |k: u32| match step {
            Some(step) => step * f64::from(k),
            None => 360.0 * f64::from(k) / f64::from(count),
        };
        Some((0..count).map(|k| Motion::rotation(axis, angle(k), center)).collect())
    }
}
