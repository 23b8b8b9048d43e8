//! One run of an outside program: in its own folder, with limits on time and memory, everything it says kept.

use crate::diag::Diagnostic;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

/// Bytes that must still fit into a folder where a program failed: else it failed for lack of room.
const ROOM: usize = 1 << 16;

/// The fault of temporary files that cannot be written.
pub fn no_room(error: &io::Error) -> Diagnostic {
    let folder = std::env::temp_dir();
    Diagnostic::error("cannot-write", format!("cannot write TetGen's files below {}: {error}", folder.display()))
        .hint("make room there, or let the variable TMPDIR name another folder")
}

/// A folder that goes with its contents when it is dropped.
pub struct Folder(PathBuf);

impl Folder {
    /// A new, empty folder among the system's temporary files, of a name that no other run has.
    ///
    /// # Errors
    /// If it cannot be made.
    pub fn new() -> io::Result<Self> {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        // Making a folder fails if the name is taken (by whatever), so the next number is tried.
        for _ in 0..1000 {
            let number = COUNT.fetch_add(1, Ordering::Relaxed);
            let path = std::env::temp_dir().join(format!("gsm-{}-{number}", std::process::id()));
            match fs::create_dir(&path) {
                Ok(()) => return Ok(Self(path)),
                Err(e) if e.kind() == io::ErrorKind::AlreadyExists => {}
                Err(e) => return Err(e),
            }
        }
        Err(io::ErrorKind::AlreadyExists.into())
    }

    /// Whether more can be written: programs that do not notice a full disk leave files that are cut off.
    ///
    /// # Errors
    /// `cannot-write`, if there is no room.
    pub fn check_room(&self) -> Result<(), Diagnostic> {
        fs::write(self.0.join("room"), vec![0; ROOM]).map_err(|e| no_room(&e))
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.0
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // A folder left behind in the temporary files does no harm.
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Limits of a run.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Longest run, by the clock.
    pub time: Duration,
    /// Most work without progress ([`Watch`]): processor time where the system tells it, so that a busy machine changes
    /// nothing.
    pub stall: Duration,
    /// Largest address space, in bytes.
    pub memory: u64,
}

/// How a run ended.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Ending {
    /// With exit code 0.
    Clean,
    /// With another exit code.
    Code(i32),
    /// By a signal (6 is an assertion or an uncaught error, 11 a bad address).
    Signal(i32),
    /// Killed at the limit of time.
    OutOfTime,
    /// Killed because it seemed to run in circles.
    Stalled,
}

/// A finished run.
#[derive(Clone, PartialEq, Debug)]
pub struct Run {
    /// How it ended.
    pub ending: Ending,
    /// What it wrote to its outputs.
    pub log: String,
    /// How long it took, by the clock.
    pub seconds: f64,
}

/// Tells running in circles from long work.
///
/// TetGen 1.5 has two endless loops. One is in the recovery of the given facets, where what is right takes no time. The other
/// is in the refinement, in flips that lead back to where they came from; that phase may rightly take long, but then it inserts
/// points, and the memory grows.
struct Watch {
    stall: Duration,
    /// The most memory so far, and after how much work it was reached.
    memory: u64,
    grown: Duration,
}

/// Part of all work that may pass without growth: the larger the mesh, the more bad tetrahedra that cannot be split are tried
/// in a row.
const QUIET_SHARE: u32 = 4;

impl Watch {
    /// Whether a run that did so much work and holds so much memory, if known, runs in circles; `log` gives what it said.
    fn is_in_circles(&mut self, work: Duration, memory: Option<u64>, log: impl Fn() -> String) -> bool {
        if memory.is_none_or(|m| m > self.memory) {
            self.memory = memory.unwrap_or(0);
            self.grown = work;
        }
        if work < self.stall {
            return false;
        }
        let quiet = work.saturating_sub(self.grown);
        let log = log();
        match ["Optimizing mesh", "Writing ", "Refining mesh"].iter().position(|phase| log.contains(phase)) {
            Some(0 | 1) => false,
            Some(_) => quiet >= self.stall.max(work / QUIET_SHARE),
            None => true,
        }
    }
}

/// Runs the program in the folder.
///
/// # Errors
/// If it cannot be started or watched.
pub fn run(program: &Path, arguments: &[&str], folder: &Path, limits: &Limits) -> io::Result<Run> {
    let log_path = folder.join("log.txt");
    let log = File::create(&log_path)?;
    let mut command = limited(program, limits);
    command.args(arguments).current_dir(folder).stdin(Stdio::null()).stdout(log.try_clone()?).stderr(log);
    let start = Instant::now();
    let mut child = command.spawn()?;
    let mut pause = Duration::from_millis(1);
    let mut watch = Watch { stall: limits.stall, memory: 0, grown: Duration::ZERO };
    let read = || fs::read(&log_path).map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).unwrap_or_default();
    let ending = loop {
        if let Some(status) = child.try_wait()? {
            break ending_of(status);
        }
        let age = start.elapsed();
        if age >= limits.time {
            kill(&mut child);
            break Ending::OutOfTime;
        }
        if watch.is_in_circles(processor_time(&child).unwrap_or(age), resident_memory(&child), read) {
            kill(&mut child);
            break Ending::Stalled;
        }
        std::thread::sleep(pause);
        pause = (pause * 2).min(Duration::from_millis(50));
    };
    Ok(Run { ending, log: read(), seconds: start.elapsed().as_secs_f64() })
}

/// The program under its limits, in a process group of its own, writing line by line: what a program holds back in its buffer
/// is lost when it aborts. It ends with its parent, however that ends, where there is `setpriv` (Linux); elsewhere at the
/// latest after as much processor time as it has time.
#[cfg(unix)]
fn limited(program: &Path, limits: &Limits) -> Command {
    use std::os::unix::process::CommandExt;
    const SCRIPT: &str = r#"ulimit -v "$1" 2>/dev/null; ulimit -t "$2" 2>/dev/null; shift 2
if command -v stdbuf >/dev/null 2>&1; then set -- stdbuf -oL "$@"; fi
if setpriv --pdeathsig KILL true 2>/dev/null; then set -- setpriv --pdeathsig KILL "$@"; fi
exec "$@""#;
    let mut command = Command::new("/bin/sh");
    let [memory, time] = [limits.memory / 1024, limits.time.as_secs().saturating_add(1)].map(|n| n.to_string());
    command.args(["-c", SCRIPT, "sh", &memory, &time]).arg(program).process_group(0);
    command
}

#[cfg(not(unix))]
fn limited(program: &Path, _limits: &Limits) -> Command {
    Command::new(program)
}

/// Kills the child and whatever it has started.
fn kill(child: &mut Child) {
    #[cfg(unix)]
    {
        let group = format!("-{}", child.id());
        let _ = Command::new("kill").args(["-KILL", "--", &group]).stderr(Stdio::null()).status();
    }
    // Errors mean that it is gone already.
    let _ = child.kill();
    let _ = child.wait();
}

/// Processor time of a running child, from Linux' /proc; in its clock ticks of 10 ms.
fn processor_time(child: &Child) -> Option<Duration> {
    let stat = fs::read_to_string(format!("/proc/{}/stat", child.id())).ok()?;
    // The name, in parentheses, may hold anything; user and system time are the 12th and 13th fields after it.
    let ticks: Vec<u64> = stat.rsplit_once(')')?.1.split_whitespace().skip(11).take(2).filter_map(|w| w.parse().ok()).collect();
    (ticks.len() == 2).then(|| Duration::from_millis(10 * ticks.iter().sum::<u64>()))
}

/// Memory that a running child holds, in pages, from Linux' /proc.
fn resident_memory(child: &Child) -> Option<u64> {
    fs::read_to_string(format!("/proc/{}/statm", child.id())).ok()?.split_whitespace().nth(1)?.parse().ok()
}

fn ending_of(status: ExitStatus) -> Ending {
    #[cfg(unix)]
    if let Some(signal) = std::os::unix::process::ExitStatusExt::signal(&status) {
        return Ending::Signal(signal);
    }
    match status.code() {
        Some(0) => Ending::Clean,
        code => Ending::Code(code.unwrap_or(-1)),
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    fn sh(script: &str, time: f64, stall: f64) -> Run {
        let folder = Folder::new().unwrap();
        let limits = Limits { time: Duration::from_secs_f64(time), stall: Duration::from_secs_f64(stall), memory: 4 << 30 };
        run(Path::new("/bin/sh"), &["-c", script], folder.path(), &limits).unwrap()
    }

    #[test]
    fn endings_are_told_apart() {
        assert_eq!(sh("exit 0", 5.0, 5.0).ending, Ending::Clean);
        assert_eq!(sh("exit 3", 5.0, 5.0).ending, Ending::Code(3));
        assert_eq!(sh("kill -6 $$", 5.0, 5.0).ending, Ending::Signal(6));
        assert_eq!(sh("sleep 30", 0.2, 9.0).ending, Ending::OutOfTime);
        assert_eq!(sh("while :; do :; done", 30.0, 0.2).ending, Ending::Stalled);
    }

    #[test]
    fn long_work_is_not_a_stall_and_messages_are_kept() {
        let run =
            sh("echo Optimizing mesh...; echo oops >&2; n=0; while [ $n -lt 300000 ]; do n=$((n+1)); done; exit 1", 9.0, 0.1);
        assert_eq!(run.ending, Ending::Code(1));
        assert!(run.log.contains("Optimizing") && run.log.contains("oops"));
    }

    #[test]
    fn refinement_may_take_long_as_long_as_memory_grows() {
        let mut watch = Watch { stall: Duration::from_secs(5), memory: 0, grown: Duration::ZERO };
        let mut is_in_circles =
            |work, memory, said: &str| watch.is_in_circles(Duration::from_secs(work), Some(memory), || said.to_string());
        assert!(!is_in_circles(4, 100, "Delaunizing vertices"));
        assert!(!is_in_circles(90, 200, "Refining mesh"));
        // A quarter of 110 s may pass without growth.
        assert!(!is_in_circles(110, 200, "Refining mesh"));
        assert!(is_in_circles(130, 200, "Refining mesh"));
        assert!(!is_in_circles(130, 201, "Refining mesh"));
        assert!(!is_in_circles(900, 201, "Refining mesh... Optimizing mesh"));
        assert!(is_in_circles(6, 300, "Recovering boundaries"));
    }

    #[test]
    fn a_child_does_not_outlive_its_parent() {
        let has_setpriv = Command::new("setpriv").args(["--pdeathsig", "KILL", "true"]).status().is_ok_and(|s| s.success());
        let limits = Limits { time: Duration::from_secs(3), stall: Duration::from_secs(3), memory: 4 << 30 };
        // An endless loop whose parent, a thread, ends once the loop has begun.
        let parent = std::thread::spawn(move || {
            let mut command = limited(Path::new("/bin/sh"), &limits);
            let mut child = command.args(["-c", "echo; while :; do :; done"]).stdout(Stdio::piped()).spawn().unwrap();
            io::Read::read_exact(child.stdout.as_mut().unwrap(), &mut [0]).unwrap();
            child
        });
        let mut child = parent.join().unwrap();
        let start = Instant::now();
        let status = child.wait().unwrap();
        assert!(!status.success());
        // Else the limit of processor time holds.
        assert!(!has_setpriv || start.elapsed() < Duration::from_secs(2), "{:?}", start.elapsed());
    }

    #[test]
    fn the_folder_goes() {
        let folder = Folder::new().unwrap();
        let path = folder.path().to_path_buf();
        fs::write(path.join("x"), "x").unwrap();
        assert_eq!(folder.check_room(), Ok(()));
        fs::remove_dir_all(&path).unwrap();
        let fault = folder.check_room().unwrap_err();
        assert!(fault.code == "cannot-write" && fault.hints[0].contains("TMPDIR"), "{fault:?}");
        fs::create_dir(&path).unwrap();
        drop(folder);
        assert!(!path.exists());
    }
}
