//! The command line: definitions only.

use clap::error::ErrorKind;
use clap::{Args, CommandFactory, Parser, Subcommand};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

/// Solid modeler for electromagnetic finite elements: from a scene of parts to one valid piecewise linear complex.
#[derive(Parser, Debug)]
#[command(name = "gsm", version, arg_required_else_help = true)]
#[command(after_help = "Exit codes: 0 good, 1 the model or a file is wrong, 2 usage, 3 a quality threshold missed, \
                        4 an outside program failed, 70 internal error.")]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

impl Cli {
    /// The arguments, if none contradicts another.
    ///
    /// # Errors
    /// A parameter that is set twice: which value is meant, nobody knows.
    pub fn checked(self) -> Result<Self, clap::Error> {
        let set = match &self.command {
            Command::Build(args) => &args.changes.set,
            Command::Check(args) => &args.changes.set,
            Command::Mesh(args) => &args.changes.set,
            Command::Convert(_) | Command::New(_) => return Ok(self),
        };
        let repeated = set.iter().enumerate().find_map(|(k, b)| set[..k].iter().find(|a| a.0 == b.0).map(|a| (a, b)));
        let Some(((name, first), (_, second))) = repeated else { return Ok(self) };
        let message = format!("the parameter '{name}' is set twice: --set {name}={first} and --set {name}={second}");
        Err(Self::command().error(ErrorKind::ArgumentConflict, message + "\n\n  tip: leave out one of them"))
    }
}

/// The commands.
#[derive(Subcommand, Debug)]
pub enum Command {
    /// Build a scene: write NAME.poly for TetGen and NAME.gsm.json with the meaning of its numbers.
    Build(BuildArgs),
    /// Verify exactly that a scene's result, or a .poly or .smesh file, is a valid complex.
    Check(CheckArgs),
    /// Build a scene (or take a .poly) and mesh its volumes by TetGen; write the mesh for solvers, with all names.
    Mesh(Box<MeshArgs>),
    /// Convert a mesh or surface from one file format to another, with its names.
    Convert(ConvertArgs),
    /// Write a commented scene to start from.
    New(NewArgs),
}

impl Command {
    /// The file that the command is about, if the arguments name one.
    pub fn file(&self) -> Option<&Path> {
        match self {
            Self::Build(args) => Some(&args.scene),
            Self::Check(args) => Some(&args.path),
            Self::Mesh(args) => Some(&args.path),
            Self::Convert(args) => Some(&args.input),
            Self::New(args) => args.output.as_deref(),
        }
    }
}

/// Arguments of `gsm build`.
#[derive(Args, Debug)]
pub struct BuildArgs {
    /// Scene to build.
    pub scene: PathBuf,
    /// Where to write; the manifest goes beside it [default: NAME.poly in the current folder].
    #[arg(short, long, value_name = "PATH.poly")]
    pub output: Option<PathBuf>,
    /// Changes to the scene.
    #[command(flatten)]
    pub changes: Changes,
    /// Options of every command.
    #[command(flatten)]
    pub common: Common,
}

/// Arguments of `gsm check`.
#[derive(Args, Debug)]
pub struct CheckArgs {
    /// Scene (built, nothing is written), .poly or .smesh; names come from the manifest beside it.
    pub path: PathBuf,
    /// Changes to the scene.
    #[command(flatten)]
    pub changes: Changes,
    /// Options of every command.
    #[command(flatten)]
    pub common: Common,
}

/// Arguments of `gsm mesh`.
#[derive(Args, Debug)]
pub struct MeshArgs {
    /// Scene, or a .poly with its manifest beside it.
    pub path: PathBuf,
    /// Where to write; the extension is the format (msh, vtu, mesh, obj, stl, ply, off, smesh, glb); may be given several times
    /// [default: NAME.msh in the current folder].
    #[arg(short, long, value_name = "PATH")]
    pub output: Vec<PathBuf>,
    /// Version of .msh files.
    #[arg(long, value_enum, default_value_t = MshVersion::V22, value_name = "VERSION")]
    pub msh: MshVersion,
    /// Changes to the scene.
    #[command(flatten)]
    pub changes: Changes,
    /// TetGen program [default: the variable GSM_TETGEN, else tetgen on PATH].
    #[arg(long, value_name = "PROGRAM")]
    pub tetgen: Option<PathBuf>,
    /// Largest wanted ratio of circumradius to shortest edge of a tetrahedron [default: the scene's, else 2].
    #[arg(long, value_name = "RATIO", value_parser = ratio)]
    pub ratio: Option<f64>,
    /// Smallest wanted dihedral angle, in degrees [default: the scene's, else none].
    #[arg(long, value_name = "DEGREES", value_parser = angle)]
    pub dihedral: Option<f64>,
    /// Largest wanted volume of a tetrahedron, in the scene's unit cubed; parts may ask for less.
    #[arg(long, value_name = "VOLUME", value_parser = positive)]
    pub max_volume: Option<f64>,
    /// Longest run of TetGen, in seconds.
    #[arg(long, default_value_t = 3600.0, value_name = "SECONDS", value_parser = positive)]
    pub time_limit: f64,
    /// Most memory of TetGen, in GiB.
    #[arg(long, default_value_t = 16.0, value_name = "GIB", value_parser = positive)]
    pub memory_limit: f64,
    /// Report the condition number of the stiffness matrix.
    #[arg(long)]
    pub condition: bool,
    /// Fail (exit code 3) if a dihedral angle is smaller, in degrees.
    #[arg(long, value_name = "DEGREES", value_parser = angle, help_heading = "Thresholds")]
    pub min_dihedral: Option<f64>,
    /// Fail if a radius-edge ratio is larger.
    #[arg(long, value_name = "RATIO", value_parser = positive, help_heading = "Thresholds")]
    pub max_ratio: Option<f64>,
    /// Fail if an aspect ratio R/r is larger.
    #[arg(long, value_name = "RATIO", value_parser = positive, help_heading = "Thresholds")]
    pub max_aspect: Option<f64>,
    /// Fail if an angle of a triangle is smaller, in degrees.
    #[arg(long, value_name = "DEGREES", value_parser = angle, help_heading = "Thresholds")]
    pub min_angle: Option<f64>,
    /// Fail if the condition number of the stiffness matrix is larger.
    #[arg(long, value_name = "NUMBER", value_parser = positive, help_heading = "Thresholds")]
    pub max_condition: Option<f64>,
    /// Options of every command.
    #[command(flatten)]
    pub common: Common,
}

/// Arguments of `gsm convert`.
#[derive(Args, Debug)]
pub struct ConvertArgs {
    /// File to read: .msh (2.2, 4.1), .mesh, .poly or .smesh (names from the manifest beside it), .obj, .off, .stl.
    pub input: PathBuf,
    /// File to write: .msh, .vtu, .mesh, .obj, .stl, .ply, .off, .smesh, .glb.
    pub output: PathBuf,
    /// Version of .msh files.
    #[arg(long, value_enum, default_value_t = MshVersion::V22, value_name = "VERSION")]
    pub msh: MshVersion,
    /// Length unit of the input, for formats that are in metres (glTF) [default: the manifest's, else m].
    #[arg(long, value_name = "UNIT")]
    pub unit: Option<String>,
    /// Options of every command.
    #[command(flatten)]
    pub common: Common,
}

/// Arguments of `gsm new`.
#[derive(Args, Debug)]
pub struct NewArgs {
    /// Which scene.
    #[arg(value_enum)]
    pub template: Template,
    /// Where to write [default: NAME.ron in the current folder]; a file that is there already is not replaced.
    #[arg(short, long, value_name = "PATH.ron")]
    pub output: Option<PathBuf>,
    /// Options of every command.
    #[command(flatten)]
    pub common: Common,
}

/// Scenes to start from.
#[derive(clap::ValueEnum, Clone, Copy, PartialEq, Eq, Debug)]
pub enum Template {
    /// A three-phase transformer.
    Transformer,
    /// A rotating machine with slots and magnets.
    Machine,
    /// TEAM problem 7: a coil over a plate with a hole.
    Team07,
    /// A sphere in a box: the shortest one.
    SphereInBox,
}

/// Modes of the remesher.
#[derive(clap::ValueEnum, Clone, Copy, PartialEq, Eq, Debug)]
pub enum Remesh {
    /// All curved facets.
    Full,
    /// Curved facets near curves that an intersection made.
    Interfaces,
    /// None.
    Off,
}

/// Versions of Gmsh's format.
#[derive(clap::ValueEnum, Clone, Copy, PartialEq, Eq, Debug)]
pub enum MshVersion {
    /// What all solvers read.
    #[value(name = "2.2")]
    V22,
    /// Gmsh's own present one.
    #[value(name = "4.1")]
    V41,
}

/// What the command line changes in a scene.
#[derive(Args, Debug, Clone, Default)]
pub struct Changes {
    /// Set a parameter of the scene, e.g. --set gap=0.8mm; may be given several times.
    #[arg(long, value_name = "NAME=VALUE", value_parser = assignment)]
    pub set: Vec<(String, String)>,
    /// Which curved facets are remeshed [default: the scene's, else interfaces].
    #[arg(long, value_enum, value_name = "MODE")]
    pub remesh: Option<Remesh>,
}

/// Options of every command.
#[derive(Args, Debug, Clone, Default)]
pub struct Common {
    /// Print the result as JSON.
    #[arg(long)]
    pub json: bool,
    /// Number of threads; the result does not depend on it [default: all processors].
    #[arg(long, value_name = "N", value_parser = threads)]
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

/// More threads than this only cost memory.
const MAX_THREADS: usize = 1024;

/// A number of threads.
fn threads(text: &str) -> Result<NonZeroUsize, String> {
    let number = text.parse().ok().filter(|n: &NonZeroUsize| n.get() <= MAX_THREADS);
    number.ok_or_else(|| format!("expected a whole number from 1 to {MAX_THREADS}"))
}

/// A finite number above zero.
fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if x.is_finite() && x > 0.0 => Ok(x),
        _ => Err("expected a number above zero".to_owned()),
    }
}

/// A ratio of circumradius to shortest edge that TetGen can reach.
fn ratio(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if x.is_finite() && x >= 1.0 => Ok(x),
        _ => Err("expected a number of at least 1".to_owned()),
    }
}

/// An angle from 0 to 90 degrees.
fn angle(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if (0.0..90.0).contains(&x) => Ok(x),
        _ => Err("expected degrees from 0 up to 90".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn definitions_are_consistent_and_assignments_are_split() {
        Cli::command().debug_assert();
        assert_eq!(assignment("gap = 0.8mm"), Ok(("gap".to_owned(), "0.8mm".to_owned())));
        assert!(assignment("gap").is_err() && assignment("=1").is_err());
        assert!(threads("2").is_ok() && threads("0").is_err() && threads("99999").is_err());
    }
}
