//! `gsm new`: a commented scene to start from.

use super::session::{self, Exit, Session};
use crate::cli::{NewArgs, Template};
use crate::diag::Diagnostic;
use crate::io::atomic::{self, NewFile};
use std::io;
use std::path::PathBuf;

impl Template {
    /// Name of the file and the scene's text.
    fn content(self) -> (&'static str, &'static str) {
        match self {
            Self::Transformer => ("transformer", include_str!("../../scenes/transformer3.ron")),
            Self::Machine => ("machine", include_str!("../../scenes/machine.ron")),
            Self::Team07 => ("team07", include_str!("../../scenes/team07.ron")),
            Self::SphereInBox => ("sphere-in-box", include_str!("../../scenes/sphere_in_box.ron")),
        }
    }
}

/// Writes the scene and says what to do with it.
///
/// # Errors
/// Those of standard output.
pub fn run(args: &NewArgs, session: &mut Session) -> io::Result<Exit> {
    let (name, text) = args.template.content();
    let path = args.output.clone().unwrap_or_else(|| PathBuf::from(format!("{name}.ron")));
    let written = if path.exists() {
        Err(Diagnostic::error("already-there", format!("{} is there already", path.display()))
            .hint("choose another place with -o, or remove it"))
    } else if let Some(fault) = session::missing_folder(std::slice::from_ref(&path)) {
        Err(fault)
    } else {
        atomic::write_all(&[NewFile { path: path.clone(), content: text.as_bytes() }])
    };
    let shown = path.display().to_string();
    match written {
        Ok(()) if session.common.json => session.json(&path, &[], &serde_json::json!({ "output": shown }))?,
        Ok(()) if session.common.quiet => {}
        Ok(()) => writeln!(session.out, "written: {shown}\nnow: gsm mesh {shown}")?,
        Err(fault) => {
            session.fail(std::slice::from_ref(&fault), &path, "")?;
            return Ok(Exit::of(&[fault]));
        }
    }
    Ok(Exit::Good)
}
