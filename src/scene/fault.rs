//! What `ron` and `serde` find, as diagnostics with places and suggestions.

use super::source::{Raw, Source};
use crate::diag::Diagnostic;
use ron::error::{Error, Position, SpannedError};

/// The diagnostic for an error that `ron` found inside `raw`.
pub(super) fn from_ron<'a>(error: SpannedError, source: &Source<'a>, raw: Raw<'a>) -> Diagnostic {
    let base = source.offset(raw);
    let cursor = byte_of(raw.0, error.span.end);
    if let Some((at, number)) = decimal_comma(raw.0, cursor) {
        let fault = Diagnostic::error("syntax", format!("`{number}` is two values with a comma between"));
        return fault.at(source.span_at(base + at)).hint(decimal_point(number));
    }
    // The cursor stands behind the name that was refused.
    let name_at = |name: &str| source.span_at(base + raw.0[..cursor].rfind(name).unwrap_or(0));
    let here = source.span_at(base + cursor);
    // Where the value begins that is of another kind: `raw`, or something in it that is no value at all.
    let value = source.span_at(base + byte_of(raw.0, error.span.start));
    match error.code {
        Error::NoSuchEnumVariant { expected, found, .. } => unknown_kind(&found, expected).at(name_at(&found)),
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
        Error::InvalidIdentifier(found) | Error::SuggestRawIdentifier(found) => {
            Diagnostic::error("syntax", format!("`{found}` cannot be the name of a field or kind"))
                .at(name_at(&found))
                .hint("names are letters, digits and `_`, not beginning with a digit: a field is written `name: value`")
        }
        other => Diagnostic::error("syntax", format!("{other}")).at(here).hint(syntax_hint(&other)),
    }
}

/// What to do about a decimal comma.
pub(super) fn decimal_point(number: &str) -> String {
    format!("decimals have a point: write {}, or a blank behind the comma if these are two values", number.replace(',', "."))
}

/// Digits with one comma between and no blank, `1,5`, at `cursor`, and where they begin.
pub(super) fn decimal_comma(text: &str, cursor: usize) -> Option<(usize, &str)> {
    let is_part = |c: char| c.is_ascii_digit() || ",.+-".contains(c);
    let (before, after) = (text.get(..cursor)?, text.get(cursor..)?);
    let start = before.trim_end_matches(is_part).len();
    let end = cursor + after.len() - after.trim_start_matches(is_part).len();
    let number = text[start..end].trim_end_matches(',');
    let (whole, decimals) = number.split_once(',')?;
    let is_number = whole.trim_start_matches(['+', '-']).bytes().all(|b| b.is_ascii_digit())
        && whole.ends_with(|c: char| c.is_ascii_digit())
        && !decimals.is_empty()
        && decimals.bytes().all(|b| b.is_ascii_digit());
    is_number.then_some((start, number))
}

/// The hint for a list of values of which so many are too many, if decimal commas may have made them.
pub(super) fn decimal_commas(text: &str, surplus: usize) -> Option<String> {
    let mut numbers: Vec<(usize, &str)> = text.match_indices(',').filter_map(|(at, _)| decimal_comma(text, at)).collect();
    // The comma behind a number finds it once more.
    numbers.dedup();
    let (_, first) = numbers.first()?;
    (numbers.len() == surplus).then(|| decimal_point(first))
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

/// The fault of a kind that is none of `known`, without its place.
pub(super) fn unknown_kind(found: &str, known: &[&str]) -> Diagnostic {
    with_names(Diagnostic::error("unknown-kind", format!("unknown kind `{found}`")), found, known.iter().copied())
}

/// Adds what may stand there, the nearest name first.
pub(super) fn with_names<'n>(
    diagnostic: Diagnostic,
    found: &str,
    allowed: impl IntoIterator<Item = &'n str> + Clone,
) -> Diagnostic {
    let diagnostic = match nearest(found, allowed.clone()) {
        Some(name) => diagnostic.hint(format!("did you mean `{name}`?")),
        None => diagnostic,
    };
    let list: Vec<&str> = allowed.into_iter().collect();
    match list.len() {
        0 => diagnostic.hint("the scene defines none: define it, or check the spelling"),
        n => {
            // A list longer than this helps nobody.
            let shown = list.iter().take(40).copied().collect::<Vec<_>>().join(", ");
            diagnostic.hint(format!("known: {shown}{}", if n > 40 { ", .." } else { "" }))
        }
    }
}

/// The allowed name that a misspelt one stands for, if one is near enough.
pub(super) fn nearest<'n>(found: &str, allowed: impl IntoIterator<Item = &'n str>) -> Option<&'n str> {
    let (distance, name) = allowed.into_iter().map(|name| (distance(found, name), name)).min()?;
    // Two wrong letters in a name of six is about what a typing error makes.
    (3 * distance <= found.chars().count().max(3)).then_some(name)
}

/// Number of letters to insert, drop, change or swap with the next to get from one name to the other, capitals alike.
fn distance(a: &str, b: &str) -> usize {
    // Only names are compared; longer texts are not near anything.
    let lower = |s: &str| s.chars().take(40).flat_map(char::to_lowercase).collect::<Vec<_>>();
    let (a, b) = (lower(a), lower(b));
    // Row i: the first i letters of `a` against each beginning of `b`; the two rows before are needed.
    let (mut before, mut last, mut row) = (Vec::new(), Vec::new(), (0..=b.len()).collect::<Vec<usize>>());
    for (i, &ca) in a.iter().enumerate() {
        (before, last, row) = (last, row, before);
        row.clear();
        row.push(i + 1);
        for (j, &cb) in b.iter().enumerate() {
            let mut least = (last[j] + usize::from(ca != cb)).min(last[j + 1] + 1).min(row[j] + 1);
            if i > 0 && j > 0 && ca == b[j - 1] && a[i - 1] == cb {
                least = least.min(before[j - 1] + 1);
            }
            row.push(least);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn typing_errors_are_near_and_other_names_are_not() {
        let fields = ["name", "material", "solid", "max_edge"];
        for (found, meant) in
            [("nmae", "name"), ("Name", "name"), ("naem", "name"), ("soild", "solid"), ("max_edeg", "max_edge")]
        {
            assert_eq!(nearest(found, fields), Some(meant), "{found}");
        }
        for found in ["title", "x", "edge"] {
            assert_eq!(nearest(found, fields), None, "{found}");
        }
        assert_eq!((distance("ca", "abc"), distance("ab", "ba"), distance("", "abc")), (3, 1, 3));
    }

    #[test]
    fn decimal_commas_are_digits_on_both_sides_and_only_as_many_as_are_too_many() {
        assert_eq!(decimal_comma("(radius: -1,25)", 12), Some((9, "-1,25")));
        for text in ["(1, 5)", "1,", ",5", "1.5,2", "1,2,3", "a,5"] {
            let found: Vec<_> = text.match_indices(',').filter_map(|(at, _)| decimal_comma(text, at)).collect();
            assert!(found.is_empty(), "{text}: {found:?}");
        }
        assert!(decimal_commas("(1,5, 2,5, 3)", 2).is_some_and(|hint| hint.contains("write 1.5")));
        assert_eq!(decimal_commas("(1,5, 2)", 0), None);
        assert_eq!(decimal_commas("(1,2,3,4)", 1), None);
    }
}
