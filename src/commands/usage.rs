//! Wrong arguments, for scripts.

use crate::diag::Diagnostic;

/// What `clap` says of the arguments: its first paragraph is what is wrong, the others (tips, usage) are what to do.
pub fn fault(error: &clap::Error) -> Diagnostic {
    let text = error.render().to_string();
    let joined = |paragraph: &str| paragraph.split_whitespace().collect::<Vec<_>>().join(" ");
    let mut paragraphs = text.split("\n\n").map(joined).filter(|p| !p.is_empty());
    let first = paragraphs.next().unwrap_or_default();
    let fault = Diagnostic::usage("usage", first.strip_prefix("error: ").unwrap_or(&first));
    paragraphs.fold(fault, |fault, p| fault.hint(p.strip_prefix("tip: ").unwrap_or(&p)))
}
