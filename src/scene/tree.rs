//! Solids as they are written, with numbers in place of expressions: shared, and not yet moved to their places.

use super::model::{Division, Operation, Primitive};
use super::motion::Motion;
use crate::diag::Span;
use std::rc::Rc;

/// A solid. Its parts are shared: what is used many times is read and checked once.
pub(super) enum Tree {
    /// A primitive where it was written.
    Leaf(Box<LocalLeaf>),
    /// A Boolean operation.
    Boolean(Operation, Vec<Rc<Tree>>),
    /// The union of images of one solid.
    Copies(Vec<Motion>, Rc<Tree>),
    /// A named solid.
    Named(String, Rc<Tree>),
}

/// A primitive with what was said about it.
pub(super) struct LocalLeaf {
    pub primitive: Primitive,
    pub division: Option<Division>,
    pub is_triangulated: Option<bool>,
    pub tolerance: Option<f64>,
    pub name: Option<String>,
    pub span: Span,
}
