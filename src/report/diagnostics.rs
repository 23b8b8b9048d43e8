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
        Severity::Usage | Severity::Error => ("error", "31"),
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
        let (shown, caret) = excerpt(&printable(line), (span.column as usize).saturating_sub(1));
        writeln!(out, " {number} | {shown}")?;
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

/// The part of a long line around a column, and the column in it.
fn excerpt(line: &str, column: usize) -> (String, usize) {
    let count = line.chars().count();
    let first = if column < MAX_LINE { 0 } else { (column - MAX_LINE / 2).min(count.saturating_sub(MAX_LINE)) };
    let head = if first > 0 { "... " } else { "" };
    let tail = if count > first + MAX_LINE { " ..." } else { "" };
    let shown: String = line.chars().skip(first).take(MAX_LINE).collect();
    (format!("{head}{shown}{tail}"), column - first + head.len())
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
        // A long line is shown around the column.
        let line = format!("{}gap{}", "x, ".repeat(300), ", y".repeat(300));
        let (shown, caret) = excerpt(&line, 900);
        assert_eq!((&shown[caret..caret + 3], shown.len()), ("gap", MAX_LINE + 8));
        assert_eq!(excerpt(&line, 2 * 900 + 3).1, MAX_LINE + 4);
        assert!(render(&d, &Style { is_coloured: true, ..style }).contains("\x1b[1;31merror[bad-unit]\x1b[0m"));
    }
}
