//! The attempts, cheapest in tetrahedra first, until one yields a mesh that counts.

use super::apart::{self, Markers};
use super::child::{self, Ending, Folder, Limits};
use super::find::Program;
use super::input::Input;
use super::place::Place;
use super::{explain, read, runaway, thin, verify};
use crate::diag::{Diagnostic, Outcome};
use crate::io::mesh::{Mesh, RegionNumber};
use crate::io::poly;
use crate::plc::Plc;
use std::collections::BTreeMap;
use std::fmt;
use std::io;
use std::path::Path;
use std::time::Duration;

/// What is wanted of the volume mesh, and what it may cost.
#[derive(Clone, Debug)]
pub struct Options {
    /// Largest ratio of circumradius to shortest edge; TetGen's default, and the thesis', is 2.
    pub ratio: f64,
    /// Smallest wanted dihedral angle in degrees; 0 leaves it open.
    pub dihedral: f64,
    /// Largest volume of any tetrahedron, in the scene's unit cubed; parts may ask for less.
    pub max_volume: Option<f64>,
    /// Longest run of TetGen.
    pub time: Duration,
    /// Largest address space of TetGen, in bytes.
    pub memory: u64,
    /// Told what is being tried, attempt by attempt.
    pub on_attempt: Option<fn(&str)>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            ratio: 2.0,
            dihedral: 0.0,
            max_volume: None,
            time: Duration::from_secs(3600),
            memory: 16 << 30,
            on_attempt: None,
        }
    }
}

/// Bends, in order: the smaller one changes shapes less, the larger one cures more.
const BENDS: [(f64, u64); 4] = [(1e-5, 1), (1e-5, 2), (1e-4, 3), (1e-4, 4)];
/// Moves, as fractions of the size: 3e-9 cured all of 16 rotations of a machine, 1e-9 all but three, at 5 % fewer tetrahedra.
const MOVES: [(f64, u64); 5] = [(1e-9, 1), (3e-9, 2), (1e-8, 3), (1e-7, 4), (1e-6, 5)];
/// An attempt that after this time still recovers facets is held to run in circles. What is right takes under 1 ms per vertex.
const STALL: Duration = Duration::from_secs(5);
const STALL_PER_VERTEX: Duration = Duration::from_millis(2);
/// After an attempt that refined without end all others may together take as long as it did, and at least this: where they do
/// better, they are ten to a hundred times as fast, and a user waits.
const LEAST_AFTER_RUNAWAY: Duration = Duration::from_secs(20);

/// Kinds of improvements that TetGen may make in the end, as a switch, in the order in which they are tried.
///
/// By default it inserts points against slivers too. Version 1.5 then at times puts a point of a facet beside it: the facet's
/// triangles are no faces of the mesh any more, and two regions have other volumes. Flips and moves alone (`-O2/3`) do not.
const IMPROVEMENTS: [&str; 2] = ["", "O2/3"];

/// A volume mesh that counts, and how it came about.
#[derive(Clone, Debug)]
pub struct Meshed {
    /// The mesh, with all names.
    pub mesh: Mesh,
    /// The program that made it.
    pub program: Program,
    /// All attempts; the last one succeeded, unless all meshes were refined without end.
    pub attempts: Vec<Attempt>,
    /// Volumes of the regions of the complex that was meshed.
    pub volumes: BTreeMap<RegionNumber, f64>,
    /// By how much vertices were moved, as a fraction of the size; 0 on all rungs but the last ones.
    pub moved: f64,
    /// What may not be meant.
    pub warnings: Vec<Diagnostic>,
}

/// One attempt.
#[derive(Clone, Debug, PartialEq)]
pub struct Attempt {
    /// What was done to the complex.
    pub place: Place,
    /// Further switches: one of those that restrict what TetGen does in the end, or none.
    pub improvements: &'static str,
    /// Version of the program.
    pub version: String,
    /// What came of it.
    pub verdict: String,
    /// How long it took, by the clock.
    pub seconds: f64,
}

impl fmt::Display for Attempt {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}", told(&self.place, self.improvements))
    }
}

/// What an attempt does.
fn told(place: &Place, improvements: &str) -> String {
    let place = match place {
        Place::AsIs => "as it is".into(),
        Place::Turned(_) => "turned into its main axes and back".into(),
        Place::Bent(amount, _) => format!("bent by {amount:e} and back"),
        Place::Split => "strips as triangles, no facets merged".into(),
        Place::Moved(amount, _) => format!("vertices moved by {amount:e} of the size"),
    };
    if improvements.is_empty() { place } else { place + ", no points against slivers" }
}

/// Meshes the complex. `programs` are as [`super::find::find`] gives them.
///
/// A mesh that was refined without end ([`runaway`]) counts only if no other attempt that leaves the vertices where they are
/// makes a better one; then the smallest of such meshes is given with a warning.
///
/// # Errors
/// If no attempt yields a mesh that counts: what TetGen said, by names and coordinates.
pub fn mesh(input: &Input, programs: &[Program], options: &Options) -> Outcome<Meshed> {
    let mut climb = Climb { attempts: Vec::new(), logs: Vec::new(), runaway: None, time: options.time };
    let task = Task { input, options };
    'rungs: for (program, place) in rungs(input, programs) {
        // What is exact counts more than what is small.
        if matches!(place, Place::Moved(..)) && (climb.runaway.is_some() || !place.is_valid(input)) {
            continue;
        }
        for improvements in IMPROVEMENTS {
            match climb.attempt(&task, program, &place, improvements)? {
                Next::Done(meshed) => return Ok(*meshed),
                Next::Improvements => {}
                Next::Rung => break,
                Next::Stop => break 'rungs,
            }
        }
    }
    match climb.runaway {
        Some(meshed) => Ok(Meshed { attempts: climb.attempts, ..meshed }),
        None => Err(explain::explain(input, programs, options, &climb.attempts, &climb.logs)),
    }
}

/// What follows an attempt.
enum Next {
    Done(Box<Meshed>),
    Improvements,
    Rung,
    Stop,
}

/// The attempts so far.
struct Climb {
    attempts: Vec<Attempt>,
    logs: Vec<String>,
    /// The smallest of the meshes that were refined without end.
    runaway: Option<Meshed>,
    /// Longest time of the next attempt.
    time: Duration,
}

impl Climb {
    fn attempt(&mut self, task: &Task, program: &Program, place: &Place, improvements: &'static str) -> Outcome<Next> {
        let Task { input, options } = *task;
        if self.runaway.is_some() && self.time.is_zero() {
            return Ok(Next::Stop);
        }
        if let (Some(tell), false) = (options.on_attempt, self.attempts.is_empty()) {
            tell(&format!("tetgen, attempt {}: {}", self.attempts.len() + 1, told(place, improvements)));
        }
        let (result, run) = match task.attempt(program, place, improvements, self.time) {
            Ok(done) => done,
            // There is a mesh.
            Err(_) if self.runaway.is_some() => return Ok(Next::Stop),
            Err(fault) => return Err(vec![fault]),
        };
        let endless = result.as_ref().ok().and_then(|m| runaway::verdict(m, options.ratio, input.plc.vertices.len()));
        let verdict = match &result {
            Ok(_) => endless.clone().unwrap_or("good".into()),
            Err(faults) => faults.first().cloned().unwrap_or_default(),
        };
        let (version, seconds) = (program.version.clone(), run.seconds);
        self.attempts.push(Attempt { place: place.clone(), improvements, version, verdict, seconds });
        self.logs.push(run.log);
        let spent = Duration::from_secs_f64(run.seconds);
        if self.runaway.is_some() {
            self.time = self.time.saturating_sub(spent);
        }
        if let Ok(mesh) = result {
            let moved = if let Place::Moved(amount, _) = place { *amount } else { 0.0 };
            let volumes = place.outcome(input).volumes();
            let warnings = endless.iter().map(|what| endless_refinement(what)).collect();
            let meshed = Meshed { mesh, program: program.clone(), attempts: self.attempts.clone(), volumes, moved, warnings };
            if endless.is_none() {
                return Ok(Next::Done(Box::new(meshed)));
            }
            match &self.runaway {
                None => self.time = spent.max(LEAST_AFTER_RUNAWAY).min(options.time),
                Some(known) if known.mesh.tets.len() <= meshed.mesh.tets.len() => return Ok(Next::Rung),
                Some(_) => {}
            }
            self.runaway = Some(meshed);
            return Ok(Next::Rung);
        }
        match run.ending {
            Ending::OutOfTime if self.runaway.is_none() => Err(vec![too_slow(input, options)]),
            Ending::OutOfTime => Ok(Next::Stop),
            // Only what became a mesh may become a better one.
            Ending::Clean => Ok(Next::Improvements),
            _ => Ok(Next::Rung),
        }
    }
}

fn endless_refinement(what: &str) -> Diagnostic {
    Diagnostic::warning("endless-refinement", format!("TetGen {what}; no other attempt did better in as much time"))
        .hint("edges or gaps far shorter than what is around them cost most: make them longer, or merge what they separate")
        .hint("allow a larger --ratio, or give the parts a --max-volume that grades the mesh")
}

fn too_slow(input: &Input, options: &Options) -> Diagnostic {
    let limit = options.time.as_secs();
    let fault = Diagnostic::error("tetgen-time", format!("TetGen was still refining the mesh after {limit} s"));
    thin::forecast(input)
        .into_iter()
        .fold(fault, Diagnostic::hint)
        .hint("allow larger volumes or a larger --ratio, or raise --time-limit")
        .hint("thin gaps and small angles cost most: a gap of a hundredth of its width needs about ten thousand tetrahedra")
}

/// The attempts in order.
fn rungs<'a>(input: &Input, programs: &'a [Program]) -> Vec<(&'a Program, Place)> {
    let Some((usual, newer)) = programs.split_first() else { return Vec::new() };
    // A complex that lies askew meshes worse as it is even where TetGen survives: coplanar facets are not merged.
    let mut rungs: Vec<_> = Place::turned(input).into_iter().map(|p| (usual, p)).collect();
    rungs.push((usual, Place::AsIs));
    rungs.extend(BENDS.map(|(amount, seed)| (usual, Place::Bent(amount, seed))));
    rungs.push((usual, Place::Split));
    rungs.extend(newer.iter().map(|program| (program, Place::AsIs)));
    rungs.extend(MOVES.map(|(amount, seed)| (usual, Place::Moved(amount, seed))));
    rungs
}

/// A mesh, or why the attempt does not count, a sentence each.
type Judged = Result<Mesh, Vec<String>>;

/// What all attempts share.
#[derive(Clone, Copy)]
struct Task<'a> {
    input: &'a Input,
    options: &'a Options,
}

impl Task<'_> {
    /// Errors: the program cannot be started, or its files have no room.
    fn attempt(
        &self,
        program: &Program,
        place: &Place,
        improvements: &str,
        time: Duration,
    ) -> Result<(Judged, child::Run), Diagnostic> {
        let folder = Folder::new().map_err(|e| child::no_room(&e))?;
        let (marked, markers) = apart::keep_apart(&place.apply(self.input));
        let plc = limited(marked, self.options, place.distortion());
        std::fs::write(folder.path().join("m.poly"), poly::to_text(&plc, None)).map_err(|e| child::no_room(&e))?;
        let stall = STALL + STALL_PER_VERTEX * plc.vertices.len() as u32;
        let limits = Limits { time, stall, memory: self.options.memory };
        let switches = switches(&plc, self.options, place) + improvements;
        let run = child::run(&program.path, &[&switches, "m.poly"], folder.path(), &limits).map_err(|e| match e.kind() {
            io::ErrorKind::StorageFull => child::no_room(&e),
            _ => Diagnostic::error("no-tetgen", format!("{}: {e}", program.path.display()))
                .hint("check that the program runs: `tetgen -h`; --tetgen names another"),
        })?;
        let judged = self.judge(place, &markers, &run, folder.path());
        if judged.is_err() {
            // TetGen does not notice that its files are cut off.
            folder.check_room()?;
        }
        Ok((judged, run))
    }

    fn judge(&self, place: &Place, markers: &Markers, run: &child::Run, folder: &Path) -> Judged {
        let input = self.input;
        let died = |why: String| Err(vec![why]);
        match run.ending {
            Ending::Clean => {}
            Ending::Code(code) => return died(format!("exit code {code}")),
            Ending::Signal(6) => return died("aborted".into()),
            Ending::Signal(11) => return died("segmentation fault".into()),
            Ending::Signal(signal) => return died(format!("died of signal {signal}")),
            Ending::OutOfTime => return died(format!("out of time after {:.0} s", run.seconds)),
            Ending::Stalled => return died(format!("endless loop, stopped after {:.0} s", run.seconds)),
        }
        let mut mesh = read::read(&folder.join("m")).map_err(|fault| vec![fault.message])?;
        markers.restore(&mut mesh);
        place.restore(&input.plc, &mut mesh);
        verify::verify(&mesh, &place.outcome(input))?;
        mesh.holes = input.plc.holes.clone();
        mesh.regions = input.regions.iter().map(|(r, label)| (*r, label.name.clone())).collect();
        mesh.markers = input.markers.clone();
        mesh.drop_unused_nodes();
        mesh.orient();
        Ok(mesh)
    }
}

/// TetGen's switches: quality, volumes where seeds have any, region numbers.
fn switches(plc: &Plc, options: &Options, place: &Place) -> String {
    // Four: a ratio of two lengths, each of which may be off by the distortion, to first order, and once more for the shape.
    let ratio = options.ratio / (1.0 + 4.0 * place.distortion());
    let volumes = if plc.seeds.iter().any(|s| s.max_volume.is_some()) { "a" } else { "" };
    let dihedral = if options.dihedral > 0.0 { format!("/{}", options.dihedral) } else { String::new() };
    let unmerged = if *place == Place::Split { "M" } else { "" };
    format!("-pq{ratio}{dihedral}A{volumes}{unmerged}")
}

/// The volume limits that TetGen gets: the smaller of the part's and the general one.
fn limited(mut plc: Plc, options: &Options, distortion: f64) -> Plc {
    for seed in &mut plc.seeds {
        let limit = [seed.max_volume, options.max_volume].into_iter().flatten().reduce(f64::min);
        seed.max_volume = limit.map(|v| v / (1.0 + 4.0 * distortion));
    }
    plc
}
