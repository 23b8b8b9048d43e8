//! Stub.
use super::solid::Solid;
use crate::diag::Diagnostic;
use crate::scene::model::Leaf;
use std::path::Path;
pub(crate) fn import(_leaf: &Leaf, _path: &Path, _scale: f64) -> Result<Solid, Diagnostic> {
    Ok(Solid::default())
}
