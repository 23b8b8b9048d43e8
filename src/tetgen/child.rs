//! One run of an outside program: in its own folder, with limits on time and memory, everything it says kept.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

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
    /// Most work without reaching a phase in which long work is normal ([`is_long_work`]): processor time where the system
    /// tells it, so that a busy machine changes nothing.
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

/// TetGen's endless loops happen while it recovers the given facets; refinement and what follows may rightly take long.
fn is_long_work(log: &str) -> bool {
    log.contains("Refining mesh") || log.contains("Optimizing mesh") || log.contains("Writing ")
}

/// Runs the program in the folder.
///
/// # Errors
/// If it cannot be started or watched.
pub fn run(program: &Path, arguments: &[&str], folder: &Path, limits: &Limits) -> io::Result<Run> {
    let log_path = folder.join("log.txt");
    let log = File::create(&log_path)?;
    let mut command = limited(program, limits.memory);
    command.args(arguments).current_dir(folder).stdin(Stdio::null()).stdout(log.try_clone()?).stderr(log);
    let start = Instant::now();
    let mut child = command.spawn()?;
    let mut pause = Duration::from_millis(1);
    let mut stall = limits.stall;
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
        if age >= stall && processor_time(&child).unwrap_or(age) >= stall {
            if !is_long_work(&read()) {
                kill(&mut child);
                break Ending::Stalled;
            }
            stall = limits.time;
        }
        std::thread::sleep(pause);
        pause = (pause * 2).min(Duration::from_millis(50));
    };
    Ok(Run { ending, log: read(), seconds: start.elapsed().as_secs_f64() })
}

/// The program under a memory limit, in a process group of its own, writing line by line: what a program holds back in its
/// buffer is lost when it aborts.
#[cfg(unix)]
fn limited(program: &Path, memory: u64) -> Command {
    use std::os::unix::process::CommandExt;
    const SCRIPT: &str = r#"ulimit -v "$1" 2>/dev/null; shift
if command -v stdbuf >/dev/null 2>&1; then exec stdbuf -oL "$@"; fi
exec "$@""#;
    let mut command = Command::new("/bin/sh");
    command.args(["-c", SCRIPT, "sh", &(memory / 1024).to_string()]).arg(program).process_group(0);
    command
}

#[cfg(not(unix))]
fn limited(program: &Path, _memory: u64) -> Command {
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
        let run = sh("echo Refining mesh...; echo oops >&2; sleep 0.4; exit 1", 9.0, 0.2);
        assert_eq!(run.ending, Ending::Code(1));
        assert!(run.log.contains("Refining") && run.log.contains("oops"));
    }

    #[test]
    fn the_folder_goes() {
        let folder = Folder::new().unwrap();
        let path = folder.path().to_path_buf();
        fs::write(path.join("x"), "x").unwrap();
        drop(folder);
        assert!(!path.exists());
    }
}
