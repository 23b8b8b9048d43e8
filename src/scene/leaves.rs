//! The leaves of a scene: the same primitive in the same place, divided alike, is one leaf however often it is used.

use super::Limits;
use super::memory::facet_estimate;
use super::model::{Division, Leaf, Node, Operation, Primitive};
use super::motion::Motion;
use super::place::placed;
use super::reader::MAX_LENGTH;
use super::tree::{LocalLeaf, Tree};
use crate::diag::{Diagnostic, Span};
use crate::geom::{Affine, Vec3};
use crate::ids::{IdVec, LeafId};
use std::collections::{BTreeMap, HashMap};

/// Memory of one facet of a leaf through all stages, in bytes: vertices, edges, uses and labels, a few copies of each.
const BYTES_PER_FACET: f64 = 600.0;

/// What all Scales around a solid may make of a length together: a single factor's limits, and the rounding of turns.
const SCALES: std::ops::RangeInclusive<f64> = 0.999_999e-6..=1.000_001e6;

/// Facets from which on a user should know beforehand: about half a minute's work.
const MANY_FACETS: f64 = 1e6;

/// What holds for the leaves of a part unless they say otherwise.
#[derive(Clone, Copy)]
pub(super) struct Settings {
    pub division: Division,
    pub is_triangulated: bool,
}

/// Puts trees in their places.
pub(super) struct Planter<'l> {
    pub leaves: IdVec<LeafId, Leaf>,
    /// Leaves by a number made from their coordinates; looked up only.
    known: HashMap<u64, Vec<LeafId>>,
    limits: &'l Limits,
    facets: f64,
    /// What each solid that is written makes of them.
    shares: BTreeMap<Span, Share>,
    nodes: usize,
    /// Numbers of copies that the patterns around make, from the outermost to the innermost.
    counts: Vec<usize>,
    /// Motions from the outermost to the innermost.
    motions: Vec<Motion>,
    /// Names of the solids around, and those that every leaf of the part got.
    names: Vec<String>,
    /// The leaves of the last part by the names of the solids that they are in.
    pub named: BTreeMap<String, Vec<LeafId>>,
}

impl<'l> Planter<'l> {
    /// No leaves yet.
    pub fn new(limits: &'l Limits) -> Self {
        let (leaves, known, motions) = (IdVec::new(), HashMap::new(), Vec::new());
        Self {
            leaves,
            known,
            limits,
            facets: 0.0,
            shares: BTreeMap::new(),
            nodes: 0,
            counts: Vec::new(),
            motions,
            names: Vec::new(),
            named: BTreeMap::new(),
        }
    }

    /// `tree` after `motion`, as a Boolean expression over leaves; `named` then holds its leaves by name. It is one of `copies`
    /// that the part has.
    ///
    /// Errors: more nodes or more memory than the limits allow; coordinates out of range.
    pub fn plant(
        &mut self,
        tree: &Tree,
        motion: Option<Motion>,
        copies: usize,
        settings: Settings,
        part: Span,
    ) -> Result<Node, Diagnostic> {
        self.named.clear();
        self.names.clear();
        self.motions.clear();
        self.motions.extend(motion);
        self.counts = vec![copies];
        self.node(tree, settings, part)
    }

    fn node(&mut self, tree: &Tree, settings: Settings, part: Span) -> Result<Node, Diagnostic> {
        self.nodes += 1;
        if self.nodes > self.limits.nodes {
            let message = format!("the scene has more than {} solids, counting all copies", self.limits.nodes);
            return Err(Diagnostic::error("scene-too-large", message).at(part).hint("repeat fewer or larger pieces"));
        }
        match tree {
            Tree::Leaf(leaf) => self.leaf(leaf, settings).map(Node::Leaf),
            Tree::Boolean(operation, operands) => {
                let operands = operands.iter().map(|operand| self.node(operand, settings, part)).collect::<Result<_, _>>()?;
                Ok(Node::Boolean(*operation, operands))
            }
            Tree::Copies(motions, inner) => {
                let mut copies = Vec::new();
                self.counts.push(motions.len());
                for motion in motions {
                    self.motions.push(*motion);
                    let copy = self.node(inner, settings, part);
                    self.motions.pop();
                    copies.push(copy?);
                }
                self.counts.pop();
                match copies.pop() {
                    Some(only) if copies.is_empty() => Ok(only),
                    last => Ok(Node::Boolean(Operation::Union, copies.into_iter().chain(last).collect())),
                }
            }
            Tree::Named(name, inner) => {
                self.names.push(name.clone());
                let node = self.node(inner, settings, part);
                self.names.pop();
                node
            }
        }
    }

    /// A warning if the leaves have very many facets.
    pub fn forecast(&self) -> Option<Diagnostic> {
        let total = self.facets;
        let (span, share) = self.heaviest().filter(|_| total >= MANY_FACETS)?;
        let (facets, whose) = (share.facets, share.whose());
        let message = format!("building takes long: about {total:.2e} facets, {facets:.2e} of them on {whose}");
        Some(Diagnostic::warning("many-facets", message).at(span).hint(format!("{}, if that is enough", share.hint())))
    }

    /// The solid of the most facets, all copies together, and where it is written.
    fn heaviest(&self) -> Option<(Span, &Share)> {
        let most = self.shares.iter().max_by(|a, b| a.1.facets.total_cmp(&b.1.facets));
        most.map(|(span, share)| (*span, share))
    }

    fn leaf(&mut self, local: &LocalLeaf, settings: Settings) -> Result<LeafId, Diagnostic> {
        let linear = self.motions.iter().fold(nalgebra::Matrix3::<f64>::identity(), |m, motion| m * motion.linear);
        let factors = [0, 1, 2].map(|k| linear.column(k).norm());
        if !factors.iter().all(|f| SCALES.contains(f)) {
            let factor = factors.into_iter().max_by(|a, b| libm::log(*a).abs().total_cmp(&libm::log(*b).abs())).unwrap_or(1.0);
            let message = format!("the Scales around this solid make it {factor:.1e} times as large, all together");
            return Err(Diagnostic::error("out-of-range", message)
                .at(local.span)
                .hint("together they go from 1e-6 to 1e6; write the solid in its true size, with a unit"));
        }
        let (primitive, transform) = placed(&local.primitive, self.motions.iter().rev());
        let anchor = transform * nalgebra::Point3::from(anchor(&primitive));
        if !anchor.coords.iter().all(|x| x.abs() <= MAX_LENGTH) {
            let message = "a copy of this solid lies farther out than 1e9 units";
            return Err(Diagnostic::error("out-of-range", message)
                .at(local.span)
                .hint("check the pattern's step, and the units"));
        }
        let leaf = Leaf {
            primitive,
            transform,
            division: local.division.unwrap_or(settings.division),
            tolerance: local.tolerance,
            is_triangulated: local.is_triangulated.unwrap_or(settings.is_triangulated),
            name: local.name.clone().or_else(|| self.names.last().cloned()),
            span: local.span,
        };
        let id = self.intern(leaf)?;
        for name in self.names.iter().chain(&local.name) {
            self.named.entry(name.clone()).or_default().push(id);
        }
        Ok(id)
    }

    fn intern(&mut self, leaf: Leaf) -> Result<LeafId, Diagnostic> {
        let key = fingerprint(&leaf);
        let same = self.known.get(&key).into_iter().flatten().find(|&&id| is_same(&self.leaves[id], &leaf));
        if let Some(&id) = same {
            return Ok(id);
        }
        let facets = facet_estimate(&leaf);
        self.facets += facets;
        let share = self.shares.entry(leaf.span).or_insert_with(|| Share::of(&leaf));
        share.facets += facets;
        share.leaves += 1;
        share.counts.clone_from(&self.counts);
        share.counts.retain(|&count| count > 1);
        if BYTES_PER_FACET * self.facets > self.limits.memory {
            let (span, share) = self.heaviest().unwrap_or((leaf.span, &self.shares[&leaf.span]));
            return Err(share.fault(self.limits.memory).at(span));
        }
        let id = self.leaves.push(leaf);
        self.known.entry(key).or_default().push(id);
        Ok(id)
    }
}

/// What one solid that is written makes of all facets.
struct Share {
    facets: f64,
    /// Its leaves, each in a place of its own.
    leaves: usize,
    /// Copies that the patterns around the last one make, from the outermost to the innermost.
    counts: Vec<usize>,
    is_import: bool,
}

impl Share {
    /// That of the solid of this leaf, before it is counted.
    fn of(leaf: &Leaf) -> Self {
        let is_import = matches!(leaf.primitive, Primitive::Import { .. });
        Self { facets: 0.0, leaves: 0, counts: Vec::new(), is_import }
    }

    /// All copies, also those that are not made yet.
    fn copies(&self) -> usize {
        self.counts.iter().fold(1, |product: usize, &count| product.saturating_mul(count)).max(self.leaves)
    }

    /// The numbers that multiply: ` (30 x 30 x 30)`; nothing where one number says it all.
    fn factors(&self) -> String {
        let factors: Vec<String> = self.counts.iter().map(usize::to_string).collect();
        if factors.len() > 1 { format!(" ({})", factors.join(" x ")) } else { String::new() }
    }

    fn whose(&self) -> String {
        match self.copies() {
            1 => "this solid".to_owned(),
            n => format!("{n} copies{} of this solid", self.factors()),
        }
    }

    /// What makes the facets fewer.
    fn hint(&self) -> String {
        let finer = match self.is_import {
            true => "reduce it before it is imported",
            false => "use fewer segments, or a larger max_angle or max_chord_error",
        };
        match self.copies() {
            1 => finer.to_owned(),
            _ => format!("make fewer copies (`count` in the patterns around it), or {finer}"),
        }
    }

    fn fault(&self, memory: f64) -> Diagnostic {
        let (code, what) = match (self.copies(), self.is_import) {
            (1, true) => ("too-many-facets", "the facets up to this surface".to_owned()),
            (1, false) => ("too-many-segments", "this discretization".to_owned()),
            _ => ("too-many-facets", format!("{} with {:.0} facets each", self.whose(), self.facets / self.leaves as f64)),
        };
        Diagnostic::error(code, format!("{what} would need more than {:.1} GB of memory", memory / 1e9)).hint(self.hint())
    }
}

/// Whether two leaves are the same solid, divided alike.
fn is_same(a: &Leaf, b: &Leaf) -> bool {
    a.primitive == b.primitive
        && a.transform == b.transform
        && a.division == b.division
        && a.tolerance == b.tolerance
        && a.is_triangulated == b.is_triangulated
}

/// A point of the primitive's own coordinates that moves with it.
fn anchor(primitive: &Primitive) -> Vec3 {
    match primitive {
        Primitive::Block { lo, .. } => *lo,
        Primitive::Ellipsoid { center, .. } => *center,
        Primitive::Import { .. } => Vec3::zeros(),
        Primitive::Pyramid { frame, .. }
        | Primitive::Cone { frame, .. }
        | Primitive::Torus { frame, .. }
        | Primitive::Extrusion { frame, .. }
        | Primitive::Revolution { frame, .. }
        | Primitive::PathSweep { frame, .. } => frame.origin,
    }
}

/// A number that is the same for leaves that are the same, and rarely for others (FNV-1a over some coordinates).
fn fingerprint(leaf: &Leaf) -> u64 {
    let direction = match &leaf.primitive {
        Primitive::Block { hi, .. } => *hi,
        Primitive::Ellipsoid { radii, .. } => *radii,
        Primitive::Cone { frame, bottom_radius, top_radius, height } => {
            frame.x + Vec3::new(*bottom_radius, *top_radius, *height)
        }
        Primitive::Pyramid { frame, .. }
        | Primitive::Torus { frame, .. }
        | Primitive::Extrusion { frame, .. }
        | Primitive::Revolution { frame, .. }
        | Primitive::PathSweep { frame, .. } => frame.x,
        Primitive::Import { .. } => Vec3::zeros(),
    };
    let map: &Affine = &leaf.transform;
    let anchor = anchor(&leaf.primitive);
    let numbers = anchor.iter().chain(direction.iter()).chain(map.matrix().iter());
    // Adding 0 turns -0 into 0, which equals it.
    numbers.fold(0xcbf2_9ce4_8422_2325, |hash, x| (hash ^ (x + 0.0).to_bits()).wrapping_mul(0x0100_0000_01b3))
}
