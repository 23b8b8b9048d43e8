//! Diagnostics: what is wrong, where, and what to do about it.
//!
//! Stages return diagnostics, they never print; several are collected per run. The command line renders them as text
//! (`file:line:column: error[code]: message`, names, coordinates, hints) or as JSON.

use serde::Serialize;

/// How bad it is.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// The result is written all the same.
    Warning,
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
    /// A warning without place.
    pub fn warning(code: &'static str, message: impl Into<String>) -> Self {
        Self::with_severity(Severity::Warning, code, message)
    }
    /// A broken invariant of gsm itself.
    pub fn internal(code: &'static str, message: impl Into<String>) -> Self {
        Self::with_severity(Severity::Internal, code, message)
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

/// The outcome of a stage that may find several errors; warnings go to a separate list.
pub type Outcome<T> = Result<T, Vec<Diagnostic>>;
