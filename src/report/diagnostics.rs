//! Diagnostics as text: `file:line:column: error[code]: message`, the line itself, places and hints.

use crate::diag::{Diagnostic, Severity};
use std::fmt::Write;

/// Longest part of a source line that is shown.
const MAX_LINE: usize = 120;

/// Where diagnostics come from and how they look.
#[derive(Clone, Copy, Debug, Default)]
pub struct Style<'a> {
    /// Name of the file that spans refer to.
    pub file: &'a str,
    /// Its text, if lines are to be shown.
    pub text: Option<&'a str>,
    /// Unit of the points.
    pub unit: &'a str,
    /// Whether to use terminal colours.
    pub is_coloured: bool,
}

/// The text of one diagnostic, with a line break at the end.
pub fn render(d: &Diagnostic, style: &Style) -> String {
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = write_one(&mut out, d, style);
    out
}

fn write_one(out: &mut String, d: &Diagnostic, style: &Style) -> std::fmt::Result {
    let (label, colour) = match d.severity {
        Severity::Warning => ("warning", "33"),
        Severity::Error => ("error", "31"),
        Severity::Internal => ("internal error", "35"),
    };
    let (on, off) = if style.is_coloured { (format!("\x1b[1;{colour}m"), "\x1b[0m") } else { (String::new(), "") };
    match d.span.filter(|s| s.line > 0) {
        Some(s) => write!(out, "{}:{}:{}: ", style.file, s.line, s.column)?,
        None if !style.file.is_empty() => write!(out, "{}: ", style.file)?,
        None => {}
    }
    writeln!(out, "{on}{label}[{}]{off}: {}", d.code, printable(&d.message))?;
    if let (Some(span), Some(text)) = (d.span, style.text)
        && let Some(line) = (span.line as usize).checked_sub(1).and_then(|k| text.lines().nth(k))
    {
        let number = span.line.to_string();
        let shown: String = printable(line).chars().take(MAX_LINE).collect();
        writeln!(out, " {number} | {shown}")?;
        let caret = (span.column as usize).saturating_sub(1);
        if span.column > 0 && caret <= shown.chars().count() {
            writeln!(out, " {:width$} | {:caret$}^", "", "", width = number.len())?;
        }
    }
    for p in &d.points {
        writeln!(out, "  at ({:?}, {:?}, {:?}) {}", p[0], p[1], p[2], style.unit)?;
    }
    for hint in &d.hints {
        writeln!(out, "  hint: {}", printable(hint))?;
    }
    Ok(())
}

/// Names come from untrusted files: no control characters reach the terminal; a tab is one column.
fn printable(text: &str) -> String {
    text.chars()
        .map(|c| {
            if c == '\t' {
                ' '
            } else if c.is_control() {
                '\u{fffd}'
            } else {
                c
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diag::Span;

    #[test]
    fn shows_the_line_with_a_caret_and_what_to_do() {
        let d = Diagnostic::error("bad-unit", "unit `\x1bfoot` is not known")
            .at(Span { line: 2, column: 10 })
            .near([1.0, 2.5, 0.0])
            .hint("use mm");
        let style = Style { file: "a.ron", text: Some("Scene(\n  units: \"foot\",\n)"), unit: "mm", is_coloured: false };
        let expected = "a.ron:2:10: error[bad-unit]: unit `\u{fffd}foot` is not known\n 2 |   units: \"foot\",\n   \
                        |          ^\n  at (1.0, 2.5, 0.0) mm\n  hint: use mm\n";
        assert_eq!(render(&d, &style), expected);
        assert!(render(&d, &Style { is_coloured: true, ..style }).contains("\x1b[1;31merror[bad-unit]\x1b[0m"));
    }
}
