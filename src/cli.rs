//! The command line: definitions only.

use clap::{Args, Parser, Subcommand};
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// Solid modeler for electromagnetic finite elements: from a scene of parts to one valid piecewise linear complex.
#[derive(Parser, Debug)]
#[command(name = "gsm", version, arg_required_else_help = true)]
#[command(after_help = "Exit codes: 0 good, 1 the model is wrong, 2 usage, 3 a quality threshold missed, \
                        4 an outside program failed, 70 internal error.")]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Subcommand, Debug)]
pub enum Command {
    /// Build a scene: write NAME.poly for TetGen and NAME.gsm.json with the meaning of its numbers.
    Build(BuildArgs),
    /// Verify exactly that a scene's result, or a .poly or .smesh file, is a valid complex.
    Check(CheckArgs),
}

/// Arguments of `gsm build`.
#[derive(Args, Debug)]
pub struct BuildArgs {
    /// Scene to build.
    pub scene: PathBuf,
    /// Where to write; the manifest goes beside it [default: NAME.poly in the current folder].
    #[arg(short, long, value_name = "PATH.poly")]
    pub output: Option<PathBuf>,
    /// Set a parameter of the scene, e.g. --set gap=0.8mm; may be given several times.
    #[arg(long, value_name = "NAME=VALUE", value_parser = assignment)]
    pub set: Vec<(String, String)>,
    /// Options of every command.
    #[command(flatten)]
    pub common: Common,
}

/// Arguments of `gsm check`.
#[derive(Args, Debug)]
pub struct CheckArgs {
    /// Scene (built, nothing is written), .poly or .smesh; names come from the manifest beside it.
    pub path: PathBuf,
    /// Set a parameter of the scene, e.g. --set gap=0.8mm; may be given several times.
    #[arg(long, value_name = "NAME=VALUE", value_parser = assignment)]
    pub set: Vec<(String, String)>,
    /// Options of every command.
    #[command(flatten)]
    pub common: Common,
}

/// Options of every command.
#[derive(Args, Debug, Clone, Default)]
pub struct Common {
    /// Print the result as JSON.
    #[arg(long)]
    pub json: bool,
    /// Number of threads; the result does not depend on it [default: all processors].
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
    /// Print errors only.
    #[arg(short, long)]
    pub quiet: bool,
}

/// `name=value` with a name.
fn assignment(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.trim().is_empty() && !value.trim().is_empty() => {
            Ok((name.trim().to_owned(), value.trim().to_owned()))
        }
        _ => Err("expected NAME=VALUE, e.g. gap=0.8mm".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn definitions_are_consistent_and_assignments_are_split() {
        Cli::command().debug_assert();
        assert_eq!(assignment("gap = 0.8mm"), Ok(("gap".to_owned(), "0.8mm".to_owned())));
        assert!(assignment("gap").is_err() && assignment("=1").is_err());
    }
}
