//! Diagnostics: what is wrong, where, and what to do about it.
//!
//! Stages return diagnostics, they never print; several are collected per run. The command line renders them as text
//! (`file:line:column: error[code]: message`, names, coordinates, hints) or as JSON.

use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::{self, Display};
use std::io::ErrorKind;
use std::path::Path;

/// A text in which no carriage return stands alone: as the only line ends (old Macs, some spreadsheets) they become line feeds,
/// which places in messages, comments and readers go by. As long as before.
pub(crate) fn with_line_feeds(text: String) -> String {
    let mut pieces = text.split('\r');
    let mut found = String::with_capacity(text.len());
    found.push_str(pieces.next().unwrap_or_default());
    for piece in pieces {
        found.push(if piece.starts_with('\n') { '\r' } else { '\n' });
        found.push_str(piece);
    }
    found
}

/// How bad it is.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// The result is written all the same.
    Warning,
    /// The arguments are wrong, whatever the files hold; nothing is written; exit code 2. An error to those who read it.
    #[serde(rename = "error")]
    Usage,
    /// Nothing is written; exit code 1.
    Error,
    /// A broken invariant of gsm itself; nothing is written; exit code 70.
    Internal,
}

/// A place in the scene text: 1-based line and column of its first character.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, Default, Serialize)]
pub struct Span {
    /// Line, from 1; 0 if unknown.
    pub line: u32,
    /// Column in characters, from 1; 0 if unknown.
    pub column: u32,
}

/// One message to the user.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Diagnostic {
    /// Stable identifier, kebab-case, e.g. `empty-part`.
    pub code: &'static str,
    /// How bad it is.
    pub severity: Severity,
    /// What is wrong, one sentence, with the names involved.
    pub message: String,
    /// Where in the scene text.
    pub span: Option<Span>,
    /// Where in space, in the scene's unit.
    pub points: Vec<[f64; 3]>,
    /// What to do.
    pub hints: Vec<String>,
}

impl Diagnostic {
    /// An error without place.
    pub fn error(code: &'static str, message: impl Into<String>) -> Self {
        Self::with_severity(Severity::Error, code, message)
    }
    /// A fault of the command line's arguments.
    pub fn usage(code: &'static str, message: impl Into<String>) -> Self {
        Self::with_severity(Severity::Usage, code, message)
    }
    /// A warning without place.
    pub fn warning(code: &'static str, message: impl Into<String>) -> Self {
        Self::with_severity(Severity::Warning, code, message)
    }
    /// A broken invariant of gsm itself.
    pub fn internal(code: &'static str, message: impl Into<String>) -> Self {
        Self::with_severity(Severity::Internal, code, message)
    }
    /// The fault of a file that cannot be read: which, why, and what to do if that is known.
    pub fn unreadable(code: &'static str, path: &Path, error: &std::io::Error) -> Self {
        let here = || std::env::current_dir().ok().filter(|_| path.is_relative());
        let (why, hint) = match error.kind() {
            _ if path.is_dir() => ("it is a folder".to_owned(), Some("name a file in it".to_owned())),
            ErrorKind::NotFound => (
                "there is no such file".to_owned(),
                here().map(|folder| format!("it was looked for from the current folder, {}", folder.display())),
            ),
            ErrorKind::PermissionDenied => ("permission denied".to_owned(), Some("check who may read it".to_owned())),
            ErrorKind::InvalidData => ("it is no UTF-8 text".to_owned(), None),
            _ => (error.to_string(), None),
        };
        let fault = Self::error(code, format!("cannot read {}: {why}", path.display()));
        Self { hints: hint.into_iter().collect(), ..fault }
    }
    fn with_severity(severity: Severity, code: &'static str, message: impl Into<String>) -> Self {
        Self { code, severity, message: message.into(), span: None, points: Vec::new(), hints: Vec::new() }
    }
    /// Adds the place in the scene text.
    pub fn at(mut self, span: Span) -> Self {
        self.span = Some(span);
        self
    }
    /// Adds a place in space.
    pub fn near(mut self, point: impl Into<[f64; 3]>) -> Self {
        self.points.push(point.into());
        self
    }
    /// Adds what to do.
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hints.push(hint.into());
        self
    }
}

/// How messages call something of the scene, and where it is written.
#[derive(Clone, Debug, Default)]
pub struct Name {
    /// Its name and what it belongs to.
    pub text: String,
    /// Its first character.
    pub span: Span,
}

impl Display for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// Diagnostics of which those about the same things are told once: the first, with the number of places.
#[derive(Debug)]
pub struct Tally<K> {
    found: BTreeMap<K, (usize, Diagnostic, usize)>,
}

impl<K> Default for Tally<K> {
    fn default() -> Self {
        Self { found: BTreeMap::new() }
    }
}

impl<K: Ord> Tally<K> {
    /// Adds a diagnostic about the things named by `key`.
    pub fn add(&mut self, key: K, make: impl FnOnce() -> Diagnostic) {
        let order = self.found.len();
        self.found.entry(key).or_insert_with(|| (order, make(), 0)).2 += 1;
    }
    /// How many are told.
    pub fn len(&self) -> usize {
        self.found.len()
    }
    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.found.is_empty()
    }
    /// In the order in which they were found.
    pub fn finish(self) -> Vec<Diagnostic> {
        let mut found: Vec<_> = self.found.into_values().collect();
        found.sort_by_key(|f| f.0);
        let told = |(_, mut d, count): (usize, Diagnostic, usize)| {
            if count > 1 {
                d.message += &format!(" (the first of {count} places)");
            }
            d
        };
        found.into_iter().map(told).collect()
    }
}

/// A number for a message: six significant digits, with an exponent only where that is shorter.
pub fn short(x: f64) -> String {
    let text = format!("{x:.5e}");
    let Some((mantissa, exponent)) = text.split_once('e') else { return text };
    let power: i32 = exponent.parse().unwrap_or(0);
    let trim = |s: &str| if s.contains('.') { s.trim_end_matches('0').trim_end_matches('.').to_owned() } else { s.to_owned() };
    if (-4..6).contains(&power) {
        return trim(&format!("{x:.decimals$}", decimals = (5 - power).max(0) as usize));
    }
    format!("{}e{exponent}", trim(mantissa))
}

/// The outcome of a stage that may find several errors; warnings go to a separate list.
pub type Outcome<T> = Result<T, Vec<Diagnostic>>;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_messages_have_six_digits() {
        for (x, text) in [
            (1.7320508075688772e-9, "1.73205e-9"),
            (1e-12, "1e-12"),
            (0.994872465, "0.994872"),
            (8419.650298496512, "8419.65"),
            (3.0223143721030964e23, "3.02231e23"),
            (-250.0, "-250"),
        ] {
            assert_eq!(short(x), text);
        }
    }

    #[test]
    fn what_is_said_twice_is_counted() {
        let mut tally = Tally::default();
        for key in ["b", "a", "b", "b"] {
            tally.add(key, || Diagnostic::error("code", key));
        }
        let said: Vec<String> = tally.finish().into_iter().map(|d| d.message).collect();
        assert_eq!(said, ["b (the first of 3 places)", "a"]);
    }

    #[test]
    fn a_carriage_return_alone_ends_a_line() {
        assert_eq!(with_line_feeds("a\rb\r\nc\n\r\r".into()), "a\nb\r\nc\n\n\n");
    }
}
