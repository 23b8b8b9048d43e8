//! Fields of a node as they are written: those it has, and those it should not have.
//!
//! A field of an unknown name is a fault, but none that hides others: the node is read all the same, and what a misspelt field
//! holds is taken for what was meant, so that its faults are told in the same run.

use super::ast::{Axis, Entries, Values};
use super::fault;
use super::model::{PatchMode, Policy, RemeshMode};
use super::source::{Field, Raw};
use crate::diag::Diagnostic;
use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
use std::borrow::Cow;

/// A field that a node should not have.
pub(super) struct Stray<'a> {
    /// Its name as it stands in the text.
    pub name: Raw<'a>,
    /// The node that it stands in.
    node: &'static str,
    /// The names of the node's fields.
    known: &'static [&'static str],
}

impl Stray<'_> {
    /// The fault, without its place.
    pub fn fault(&self) -> Diagnostic {
        let name = self.name.0;
        if self.known.contains(&name) {
            let fault = Diagnostic::error("duplicate-field", format!("the field `{name}` is given twice"));
            return fault.hint("take out one of them");
        }
        let fault = Diagnostic::error("unknown-field", format!("unknown field `{name}` in {}", self.node));
        fault::with_names(fault, name, self.known.iter().copied())
    }
}

/// What [`super::reader::Reader::read`] reads: a value that may have fields which it should not have.
pub(super) trait Written<'a>: Deserialize<'a> {
    /// These fields.
    fn strays(&self) -> &[Stray<'a>] {
        &[]
    }
}

/// Values without fields.
macro_rules! without_fields {
    ($($value:ty),*) => { $(impl<'a> Written<'a> for $value {})* };
}
without_fields!(f64, bool, String, Cow<'a, str>, Vec<Raw<'a>>, Values<'a>, Entries<'a>, Axis, Policy, RemeshMode, PatchMode);

/// The fields of the node `node` in the order of `known`, and those that it should not have.
///
/// # Errors
/// Those of the deserializer: the text is none of a node.
pub(super) fn read<'de, D: Deserializer<'de>>(
    deserializer: D,
    node: &'static str,
    known: &'static [&'static str],
) -> Result<(Vec<Field<'de>>, Vec<Stray<'de>>), D::Error> {
    deserializer.deserialize_struct(node, known, FieldsOf { node, known })
}

struct FieldsOf {
    node: &'static str,
    known: &'static [&'static str],
}

impl<'de> Visitor<'de> for FieldsOf {
    type Value = (Vec<Field<'de>>, Vec<Stray<'de>>);

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "the fields of {}", self.node)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let Self { node, known } = self;
        let mut fields = vec![Field::default(); known.len()];
        let (mut strays, mut misspelt) = (Vec::new(), Vec::new());
        while let Some(name) = map.next_key::<&'de str>()? {
            let value: Field = map.next_value()?;
            match known.iter().position(|field| *field == name) {
                Some(k) if fields[k].0.is_none() => fields[k] = value,
                is_known => {
                    strays.push(Stray { name: Raw(name), node, known });
                    misspelt.extend(is_known.is_none().then_some((name, value)));
                }
            }
        }
        for (name, value) in misspelt {
            let meant = fault::nearest(name, known.iter().copied());
            if let Some(k) = meant.and_then(|meant| known.iter().position(|field| *field == meant))
                && fields[k].0.is_none()
            {
                fields[k] = value;
            }
        }
        Ok((fields, strays))
    }
}
