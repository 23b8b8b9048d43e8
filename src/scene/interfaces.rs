//! What is asked of interfaces, by their names in the manifest.

use super::ast::{self, Entries};
use super::fault::with_names;
use super::model::{Interface, OUTER, sorted};
use super::parts::Parts;
use super::reader::{Owner, Reader};
use super::source::{Field, Raw};
use crate::diag::Diagnostic;
use std::collections::{BTreeMap, BTreeSet};

/// Reads the `interfaces` map, after the parts.
pub(super) fn read<'a>(reader: &mut Reader<'a>, field: Field<'a>, parts: &Parts) -> BTreeMap<[String; 2], Interface> {
    let entries = field.0.and_then(|raw| reader.read::<Entries>(raw));
    let mut interfaces: BTreeMap<[String; 2], Interface> = BTreeMap::new();
    let known = parts.callable();
    for (key, value) in entries.map_or(Vec::new(), |e| e.0) {
        let names = names(reader, key, parts, &known);
        let max_edge = max_edge(reader, value);
        let (Some(names), Some(max_edge)) = (names, max_edge) else { continue };
        let [a, b] = names.clone();
        let span = reader.span(key);
        if let Some(first) = interfaces.insert(names, Interface { max_edge, span }) {
            let place = first.span;
            let message = format!("the interface `{a}|{b}` is given at {}:{} already", place.line, place.column);
            reader.fail::<()>(key, "duplicate-name", message, "take out one of them; `a|b` and `b|a` are the same");
        }
    }
    interfaces
}

/// The two names of a key, sorted.
fn names<'a>(reader: &mut Reader<'a>, key: Raw<'a>, parts: &Parts, known: &BTreeSet<&str>) -> Option<[String; 2]> {
    let text = reader.read::<String>(key)?;
    let names: Vec<&str> = text.split('|').map(str::trim).collect();
    let Ok([a, b]) = <[&str; 2]>::try_from(names) else {
        let hint = "write the names of two parts with `|` between: \"air|coil\", or \"coil|outer\" for what faces the outside";
        return reader.fail(key, "bad-name", format!("`{text}` is not the name of an interface"), hint);
    };
    let mut are_known = true;
    for name in [a, b].into_iter().filter(|name| *name != OUTER && !known.contains(name)) {
        are_known = false;
        // It may be among those that cannot be read.
        if !parts.is_incomplete && !reader.is_full() {
            let fault = Diagnostic::error("unknown-part", format!("there is no part `{name}`")).at(reader.span(key));
            reader.fault(with_names(fault, name, known.iter().copied().chain([OUTER])));
        }
    }
    // Copies may touch each other.
    if a == b && are_known && !parts.are_copies(a) {
        let message = format!("`{text}` names no interface: there is none of a part with itself, or of the outside");
        return reader.fail(key, "bad-name", message, "name two parts, or one part and `outer`");
    }
    are_known.then(|| sorted([a, b].map(str::to_owned)))
}

fn max_edge<'a>(reader: &mut Reader<'a>, value: Raw<'a>) -> Option<f64> {
    if !value.0.starts_with(|c: char| c == '(' || c.is_alphabetic()) {
        let hint = "write fields in parentheses: (max_edge: \"2 mm\")";
        return reader.fail(value, "wrong-type", "expected what is asked of the interface", hint);
    }
    let node: ast::Interface = reader.read(value)?;
    let raw = reader.need(Owner { kind: "an interface", raw: value }, "max_edge", node.max_edge)?;
    reader.size("max_edge", raw)
}
