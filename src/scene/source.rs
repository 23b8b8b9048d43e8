//! The scene text: pieces of it that `ron` has accepted, with their places.
//!
//! A [`Raw`] is one RON value as it stands in the text. It is read into a type only when it is needed, so that each value has
//! an exact place, and a fault in one does not hide those in the others. Reading the values of a node once each costs
//! O(text x depth) in all, which [`MAX_WORK`] bounds.

use super::fault;
use crate::diag::{Diagnostic, Span};
use ron::extensions::Extensions;
use serde::{Deserialize, Deserializer};

/// Nesting that `ron` follows. A Boolean inside a Boolean counts four where it is only passed over, so more fit than
/// `solids::MAX_DEPTH` allows; [`super::STACK`] is sized for it.
const MAX_DEPTH: usize = 4600;
/// Bytes read in all, so that deep nesting of a long text cannot take minutes (2^28 bytes take a few seconds).
const MAX_WORK: usize = 1 << 28;

/// The name by which `ron` is asked for the text of a value that it has parsed. This is what `ron::value::RawValue` does; that
/// type parses the text once more, and there allows a depth of 128 only.
const RAW_VALUE: &str = "$ron::private::RawValue";

/// One RON value as it stands in the text.
#[derive(Clone, Copy, Debug)]
pub(super) struct Raw<'a>(pub &'a str);

impl<'de: 'a, 'a> Deserialize<'de> for Raw<'a> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visitor;
        impl<'de> serde::de::Visitor<'de> for Visitor {
            type Value = Raw<'de>;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a value")
            }
            fn visit_borrowed_str<E>(self, text: &'de str) -> Result<Self::Value, E> {
                Ok(Raw(without_leading_blanks(text)))
            }
        }
        deserializer.deserialize_newtype_struct(RAW_VALUE, Visitor)
    }
}

/// A field that may be absent.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Field<'a>(pub Option<Raw<'a>>);

impl<'de: 'a, 'a> Deserialize<'de> for Field<'a> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Raw::deserialize(deserializer).map(|raw| Field(Some(raw)))
    }
}

/// The text from its first character that is neither blank nor comment.
fn without_leading_blanks(mut text: &str) -> &str {
    loop {
        text = text.trim_start();
        let rest = if text.starts_with("//") {
            text.find('\n').map(|end| &text[end..])
        } else if text.starts_with("/*") {
            end_of_comment(text).map(|end| &text[end..])
        } else {
            None
        };
        match rest {
            Some(rest) => text = rest,
            None => return text,
        }
    }
}

/// Where the block comment at the start of `text` ends; they nest.
fn end_of_comment(text: &str) -> Option<usize> {
    let (mut depth, mut at) = (0usize, 0usize);
    while let Some(pair) = text.as_bytes().get(at..at + 2) {
        match pair {
            b"/*" => depth += 1,
            b"*/" => depth -= 1,
            _ => {
                at += 1;
                continue;
            }
        }
        at += 2;
        if depth == 0 {
            return Some(at);
        }
    }
    None
}

/// Bytes of the text from one count of its characters to the next: a scene on one line is not counted from its begin for each
/// of its values.
const COUNTED: usize = 256;

/// Characters that begin in a piece of UTF-8: all bytes but those that go on with one.
fn begun(piece: &[u8]) -> usize {
    piece.iter().filter(|&&byte| byte & 0xC0 != 0x80).count()
}

/// The whole text, and where its lines begin.
pub(super) struct Source<'a> {
    text: &'a str,
    line_starts: Vec<usize>,
    /// Characters that begin before each [`COUNTED`]th byte.
    counts: Vec<usize>,
    work: usize,
}

impl<'a> Source<'a> {
    /// The source of `text`.
    pub fn new(text: &'a str) -> Self {
        let line_starts = std::iter::once(0).chain(text.match_indices('\n').map(|(at, _)| at + 1)).collect();
        let mut counts = vec![0];
        for piece in text.as_bytes().chunks_exact(COUNTED) {
            counts.extend(counts.last().map(|before| before + begun(piece)));
        }
        Self { text, line_starts, counts, work: 0 }
    }

    /// Characters that begin before a byte of the text.
    fn characters_before(&self, offset: usize) -> usize {
        let counted = offset / COUNTED;
        self.counts[counted] + begun(&self.text.as_bytes()[counted * COUNTED..offset])
    }

    /// Line and column of a byte of the text.
    pub fn span_at(&self, offset: usize) -> Span {
        let offset = offset.min(self.text.len());
        let line = self.line_starts.partition_point(|&start| start <= offset);
        let start = line.checked_sub(1).and_then(|k| self.line_starts.get(k)).copied().unwrap_or(0);
        let column = 1 + self.characters_before(offset) - self.characters_before(start);
        Span { line: line as u32, column: column as u32 }
    }

    /// Byte at which a piece of the text begins. (Pieces are always borrowed from the text itself.)
    pub fn offset(&self, raw: Raw<'a>) -> usize {
        (raw.0.as_ptr() as usize).saturating_sub(self.text.as_ptr() as usize)
    }

    /// Line and column at which a piece begins.
    pub fn span(&self, raw: Raw<'a>) -> Span {
        self.span_at(self.offset(raw))
    }

    /// The whole text as one value.
    pub fn whole(&self) -> Raw<'a> {
        Raw(without_leading_blanks(self.text))
    }

    /// A piece as a value of type `T`.
    ///
    /// Errors: what `ron` or `serde` find, at its place in the file; a text too large and too deep to be read.
    pub fn read<T: Deserialize<'a>>(&mut self, raw: Raw<'a>) -> Result<T, Diagnostic> {
        self.work += raw.0.len();
        if self.work > MAX_WORK {
            return Err(Diagnostic::error("scene-too-large", "the scene is too long for its depth of nesting")
                .at(self.span(raw))
                .hint("name inner solids in `solids` and refer to them with Use(\"name\")"));
        }
        let options =
            ron::Options::default().with_default_extension(Extensions::UNWRAP_VARIANT_NEWTYPES).with_recursion_limit(MAX_DEPTH);
        options.from_str(raw.0).map_err(|error| fault::from_ron(error, self, raw))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_characters_of_the_line() {
        // Characters of one to four bytes over several counts, and a length that is a multiple of what is counted at once.
        let line = "aé€😀".repeat(100);
        let text = format!("{line}\n\n{line}{}", "x".repeat(COUNTED - (2 * line.len() + 2) % COUNTED));
        let source = Source::new(&text);
        for (at, _) in text.char_indices().chain([(text.len(), ' ')]) {
            let before = &text[..at];
            let line = 1 + before.matches('\n').count();
            let column = 1 + before.rsplit('\n').next().map_or(0, |last| last.chars().count());
            assert_eq!(source.span_at(at), Span { line: line as u32, column: column as u32 }, "{at}");
        }
        assert_eq!(source.span_at(text.len() + 9), source.span_at(text.len()));
        assert_eq!(Source::new("").span_at(0), Span { line: 1, column: 1 });
    }
}
