//! Names as they are written: fields that a node has, those that it should not have, and kinds.
//!
//! A name that is unknown is a fault, but none that hides others: the node is read all the same, and what a misspelt field or
//! kind holds is taken for that of the one that was meant, so that its faults are told in the same run.

use super::ast::{Axis, Entries, Values};
use super::fault;
use super::model::{PatchMode, Policy, RemeshMode};
use super::source::{Field, Raw};
use crate::diag::Diagnostic;
use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};

/// A name that should not stand where it does, of a field or kind.
pub(super) struct Stray<'a> {
    /// As it stands in the text.
    pub name: Raw<'a>,
    /// The fault, without its place.
    pub fault: Diagnostic,
}

impl<'a> Stray<'a> {
    /// A field of `node` that is none of `known`, or that is there twice.
    fn field(name: &'a str, node: &str, known: &[&str]) -> Self {
        let fault = if known.contains(&name) {
            Diagnostic::error("duplicate-field", format!("the field `{name}` is given twice")).hint("take out one of them")
        } else {
            let fault = Diagnostic::error("unknown-field", format!("unknown field `{name}` in {node}"));
            fault::with_names(fault, name, known.iter().copied())
        };
        Self { name: Raw(name), fault }
    }

    /// The kind that stands at the begin of `raw`, if that is not the name of the one which it was read as.
    pub fn kind(raw: Raw<'a>, read_as: &str, known: &[&str]) -> Option<Self> {
        // RON lets any name begin so; behind it stand a parenthesis, blanks or a comment.
        let text = raw.0.strip_prefix("r#").unwrap_or(raw.0);
        let end = text.find(|c: char| c == '(' || c == '/' || c.is_whitespace()).unwrap_or(text.len());
        let name = &text[..end];
        (name != read_as).then(|| Self { name: Raw(name), fault: fault::unknown_kind(name, known) })
    }
}

/// The name of a field or kind.
pub(super) struct Name<'a>(pub &'a str);

impl<'de: 'a, 'a> Deserialize<'de> for Name<'a> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct NameVisitor;
        impl<'de> Visitor<'de> for NameVisitor {
            type Value = Name<'de>;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a name")
            }
            fn visit_borrowed_str<E>(self, name: &'de str) -> Result<Self::Value, E> {
                Ok(Name(name))
            }
        }
        deserializer.deserialize_identifier(NameVisitor)
    }
}

/// The kind that a name stands for, also a misspelt one. Its first letter has to be right: `Cube` is near `Tube`, but not meant
/// so, and its fields would all be told as faults.
pub(super) fn kind_meant_by(name: &str, known: &[&'static str]) -> Option<&'static str> {
    let initial = |text: &str| text.chars().next().map(|c| c.to_ascii_lowercase());
    // Nearly all are right, and comparing letters takes longer than reading.
    let exact = known.iter().copied().find(|kind| *kind == name);
    exact.or_else(|| fault::nearest(name, known.iter().copied()).filter(|meant| initial(meant) == initial(name)))
}

/// What [`super::reader::Reader::read`] reads: a value in which names may stand that should not.
pub(super) trait Written<'a>: Deserialize<'a> {
    /// These names, of a value that was read from `raw`.
    fn take_strays(&mut self, _raw: Raw<'a>) -> Vec<Stray<'a>> {
        Vec::new()
    }
}

/// Values without fields.
macro_rules! without_fields {
    ($($value:ty),*) => { $(impl<'a> Written<'a> for $value {})* };
}
without_fields!(f64, bool, String, Vec<Raw<'a>>, Values<'a>, Entries<'a>, Axis, Policy, RemeshMode, PatchMode);

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
                    strays.push(Stray::field(name, node, known));
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_are_read_if_they_are_near_and_told_if_they_are_not_exact() {
        let known = &["Block", "Tube"];
        for (name, meant) in [("Block", Some("Block")), ("blok", Some("Block")), ("Cube", None), ("Box", None)] {
            assert_eq!(kind_meant_by(name, known), meant, "{name}");
        }
        let told = |text| Stray::kind(Raw(text), "Block", known).map(|stray| stray.name.0);
        for text in ["Block(size: 1)", "Block (size: 1)", "Block/* a */(size: 1)", "r#Block(size: 1)"] {
            assert_eq!(told(text), None, "{text}");
        }
        for (text, name) in [("Blok(size: 1)", "Blok"), ("r#blok\n(1)", "blok"), ("Block\u{301}(1)", "Block\u{301}")] {
            assert_eq!(told(text), Some(name));
        }
    }
}
