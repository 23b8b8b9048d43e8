//! What `ron` and `serde` find, as diagnostics with places and suggestions.

use super::source::{Raw, Source};
use crate::diag::Diagnostic;
use ron::error::{Error, Position, SpannedError};

/// The diagnostic for an error that `ron` found inside `raw`.
pub(super) fn from_ron<'a>(error: SpannedError, source: &Source<'a>, raw: Raw<'a>) -> Diagnostic {
    let base = source.offset(raw);
    let cursor = byte_of(raw.0, error.span.end);
    // The cursor stands behind the name that was refused.
    let name_at = |name: &str| source.span_at(base + raw.0[..cursor].rfind(name).unwrap_or(0));
    let here = source.span_at(base + cursor);
    // Where the value begins that is of another kind: `raw`, or something in it that is no value at all.
    let value = source.span_at(base + byte_of(raw.0, error.span.start));
    match error.code {
        Error::NoSuchStructField { expected, found, outer } => {
            let place = outer.map_or(String::new(), |o| format!(" in {o}"));
            let diagnostic = Diagnostic::error("unknown-field", format!("unknown field `{found}`{place}"));
            with_names(diagnostic.at(name_at(&found)), &found, expected.iter().copied())
        }
        Error::NoSuchEnumVariant { expected, found, .. } => {
            let diagnostic = Diagnostic::error("unknown-kind", format!("unknown kind `{found}`"));
            with_names(diagnostic.at(name_at(&found)), &found, expected.iter().copied())
        }
        Error::DuplicateStructField { field, .. } => {
            let fault = Diagnostic::error("duplicate-field", format!("the field `{field}` is given twice"));
            fault.at(name_at(field)).hint("take out one of them")
        }
        Error::ExceededRecursionLimit => Diagnostic::error("too-deep", "the scene is nested too deeply")
            .at(here)
            .hint("name inner solids in `solids` and refer to them with Use(\"name\")"),
        Error::InvalidValueForType { expected, found } => {
            let fault = Diagnostic::error("wrong-type", format!("expected {expected}, found {found}"));
            fault.at(source.span(raw)).hint("the language is described in scenes/tour.ron and in src/scene/LANGUAGE.md")
        }
        Error::ExpectedDifferentLength { expected, found } => {
            let fault = Diagnostic::error("wrong-length", format!("expected {expected}, found {found} values"));
            fault.at(source.span(raw)).hint("points of space are (x, y, z), those of a plane (x, y)")
        }
        Error::ExpectedFloat | Error::ExpectedInteger => Diagnostic::error("wrong-type", "expected a number")
            .at(value)
            .hint("numbers are plain, or expressions in quotes: 12.5, \"12.5 mm\", \"-gap / 2\"; \
                 a direction against an axis is a vector: (0, 0, -1)"),
        Error::ExpectedString => {
            Diagnostic::error("wrong-type", "expected a text in quotes").at(value).hint("put it in double quotes")
        }
        Error::ExpectedBoolean => Diagnostic::error("wrong-type", "expected true or false")
            .at(value)
            .hint("write true or false, without quotes"),
        Error::ExpectedArray => Diagnostic::error("wrong-type", "expected a list in brackets [..]")
            .at(value)
            .hint("put brackets around it, also around a single element"),
        Error::ExpectedMap => Diagnostic::error("wrong-type", "expected a map in braces {\"name\": value, ..}")
            .at(value)
            .hint("write for instance params: {\"gap\": \"0.8 mm\"}, solids: {\"pole\": Block(..)}, interfaces: {\"a|b\": (max_edge: 2)}"),
        other => Diagnostic::error("syntax", format!("{other}")).at(here).hint(syntax_hint(&other)),
    }
}

/// What to do about a text that is not RON.
fn syntax_hint(error: &Error) -> &'static str {
    match error {
        Error::Eof | Error::ExpectedStructLikeEnd | Error::ExpectedArrayEnd | Error::ExpectedMapEnd => {
            "a `)`, `]` or `}` is missing, or a comma before this"
        }
        Error::ExpectedComma => {
            "a comma is missing here, or a `)` or `]` before this is missing or one too many; numbers with units are in quotes: \"1 mm\""
        }
        Error::ExpectedAttribute => "comments begin with // or stand between /* and */",
        Error::ExpectedMapColon => "write `name: value`",
        Error::ExpectedStringEnd => "a closing quote is missing",
        Error::UnclosedBlockComment => "close the comment with */",
        Error::TrailingCharacters => "the scene ends before this: is there a `)` too many?",
        Error::ExpectedNamedStructLike("Scene") | Error::ExpectedDifferentStructName { expected: "Scene", .. } => {
            "a scene is Scene(units: \"mm\", parts: [..]); `gsm new` writes one to start from"
        }
        Error::ExpectedDifferentStructName { expected: "Part", .. } => {
            "parts are Part(name: \"..\", solid: ..); solids stand in their field `solid`"
        }
        Error::ExpectedStructLike | Error::ExpectedNamedStructLike(_) => "fields stand in parentheses: Block(size: (1, 1, 1))",
        _ => "names of kinds are capital (Block), of fields small (size:), texts are in double quotes; see scenes/tour.ron",
    }
}

/// Byte of a line and column of `text`.
fn byte_of(text: &str, position: Position) -> usize {
    let line_start = match position.line {
        0 | 1 => 0,
        line => text.match_indices('\n').nth(line - 2).map_or(text.len(), |(at, _)| at + 1),
    };
    let line = &text[line_start..];
    line_start + line.char_indices().nth(position.col.saturating_sub(1)).map_or(line.len(), |(at, _)| at)
}

/// Adds what may stand there, the nearest name first.
pub(super) fn with_names<'n>(
    diagnostic: Diagnostic,
    found: &str,
    allowed: impl IntoIterator<Item = &'n str> + Clone,
) -> Diagnostic {
    // Two wrong letters in a name of six is about what a typing error makes.
    let nearest = allowed.clone().into_iter().map(|name| (distance(found, name), name)).min();
    let list: Vec<&str> = allowed.into_iter().collect();
    let diagnostic = match nearest {
        Some((d, name)) if 3 * d <= found.chars().count().max(3) => diagnostic.hint(format!("did you mean `{name}`?")),
        _ => diagnostic,
    };
    match list.len() {
        0 => diagnostic.hint("the scene defines none: define it, or check the spelling"),
        n => {
            // A list longer than this helps nobody.
            let shown = list.iter().take(40).copied().collect::<Vec<_>>().join(", ");
            diagnostic.hint(format!("known: {shown}{}", if n > 40 { ", .." } else { "" }))
        }
    }
}

/// Number of letters to insert, drop or change to get from one name to the other, capitals alike.
fn distance(a: &str, b: &str) -> usize {
    // Only names are compared; longer texts are not near anything.
    let lower = |s: &str| s.chars().take(40).flat_map(char::to_lowercase).collect::<Vec<_>>();
    let (a, b) = (lower(a), lower(b));
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, ca) in a.iter().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, cb) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(ca != cb);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}
