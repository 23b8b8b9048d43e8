//! Reading text formats: words and numbers with the place of every fault. Input is untrusted: counts only bound loops,
//! memory is taken as data really comes.

use crate::diag::Diagnostic;
use std::str::{FromStr, Lines, SplitWhitespace};

/// Words of a text, comments (from a mark to the end of the line) left out.
pub struct Words<'t> {
    file: &'t str,
    lines: Lines<'t>,
    words: SplitWhitespace<'t>,
    line: u32,
    comment: Option<char>,
}

impl<'t> Words<'t> {
    /// The words of `text`, which came from `file`.
    pub fn new(file: &'t str, text: &'t str, comment: Option<char>) -> Self {
        Self { file, lines: text.lines(), words: "".split_whitespace(), line: 0, comment }
    }

    /// The next word, on whatever line it stands.
    pub fn next_word(&mut self) -> Option<&'t str> {
        loop {
            if let Some(word) = self.words.next() {
                return Some(word);
            }
            let line = self.next_line()?;
            self.words = line.split_whitespace();
        }
    }

    /// The next whole line (what is left of the current one is dropped), without its comment.
    pub fn next_line(&mut self) -> Option<&'t str> {
        self.words = "".split_whitespace();
        let line = self.lines.next()?;
        self.line += 1;
        Some(match self.comment.and_then(|mark| line.split_once(mark)) {
            Some((before, _)) => before,
            None => line,
        })
    }

    /// The words left on the current line.
    pub fn rest_of_line(&mut self) -> Vec<&'t str> {
        std::mem::replace(&mut self.words, "".split_whitespace()).collect()
    }

    /// The next word as a number.
    ///
    /// # Errors
    /// If the text ends or the word is no such number.
    pub fn number<T: FromStr>(&mut self, what: &str) -> Result<T, Diagnostic> {
        let Some(word) = self.next_word() else { return Err(self.fault(format!("ends before {what}"))) };
        word.parse().map_err(|_| self.fault(format!("`{word}` is not {what}")))
    }

    /// The next word as a finite number.
    ///
    /// # Errors
    /// As [`Self::number`], and for infinities and NaN.
    pub fn real(&mut self, what: &str) -> Result<f64, Diagnostic> {
        let x: f64 = self.number(what)?;
        if x.is_finite() { Ok(x) } else { Err(self.fault(format!("{what} is not finite"))) }
    }

    /// Three finite numbers.
    ///
    /// # Errors
    /// As [`Self::real`].
    pub fn point(&mut self) -> Result<crate::geom::Vec3, Diagnostic> {
        Ok(crate::geom::Vec3::new(self.real("a coordinate")?, self.real("a coordinate")?, self.real("a coordinate")?))
    }

    /// An error at the current line.
    pub fn fault(&self, what: impl AsRef<str>) -> Diagnostic {
        Diagnostic::error("bad-file", format!("{}:{}: {}", self.file, self.line, what.as_ref()))
            .hint("the file is damaged or of another kind: write it again")
    }
}
