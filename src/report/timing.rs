//! How long each stage took: wall time and processor time of all threads.

use crate::diag::Diagnostic;
use serde::Serialize;
use std::fmt;
use std::sync::Arc;
use std::time::Instant;

/// One stage.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct StageTime {
    /// Its name, as in the pipeline's figure.
    pub stage: &'static str,
    /// Elapsed seconds.
    pub wall: f64,
    /// Processor seconds of all threads; null where the system does not tell.
    pub cpu: Option<f64>,
}

/// The stages so far, in order.
#[derive(Clone, Debug, Default, Serialize)]
#[serde(transparent)]
pub struct Timings {
    /// In the order in which they ended.
    pub stages: Vec<StageTime>,
    /// Called with the name of each stage that begins: where progress is shown.
    #[serde(skip)]
    pub on_begin: Option<fn(&'static str)>,
    /// Where warnings go that shall not wait for the end.
    #[serde(skip)]
    pub on_warning: Option<Listener>,
}

/// Hears warnings as soon as they are found.
#[derive(Clone)]
pub struct Listener(pub Arc<Hear>);

/// What is done with warnings.
pub type Hear = dyn Fn(&[Diagnostic]) + Send + Sync;

impl fmt::Debug for Listener {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Listener")
    }
}

impl StageTime {
    fn add(&mut self, more: &Self) {
        self.wall += more.wall;
        self.cpu = self.cpu.zip(more.cpu).map(|(a, b)| a + b);
    }
}

impl Timings {
    /// Runs a stage and notes its times; one that goes on where it stopped stays one.
    pub fn measure<T>(&mut self, stage: &'static str, work: impl FnOnce() -> T) -> T {
        let goes_on = self.stages.last().is_some_and(|last| last.stage == stage);
        if let Some(begin) = self.on_begin.filter(|_| !goes_on) {
            begin(stage);
        }
        let (wall, cpu) = (Instant::now(), processor_time());
        let result = work();
        let cpu = processor_time().zip(cpu).map(|(after, before)| after - before);
        let time = StageTime { stage, wall: wall.elapsed().as_secs_f64(), cpu };
        match self.stages.last_mut().filter(|_| goes_on) {
            Some(last) => last.add(&time),
            None => self.stages.push(time),
        }
        result
    }

    /// Tells warnings at once.
    pub fn tell(&self, warnings: &[Diagnostic]) {
        if let Some(Listener(hear)) = self.on_warning.as_ref().filter(|_| !warnings.is_empty()) {
            hear(warnings);
        }
    }

    /// The sum over all stages.
    pub fn total(&self) -> StageTime {
        let cpu = self.stages.iter().map(|s| s.cpu).sum();
        StageTime { stage: "total", wall: self.stages.iter().map(|s| s.wall).sum(), cpu }
    }
}

/// Seconds of processor time of this process, ended threads included.
#[cfg(unix)]
fn processor_time() -> Option<f64> {
    let t = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Some(t.tv_sec as f64 + t.tv_nsec as f64 * 1e-9)
}

#[cfg(not(unix))]
fn processor_time() -> Option<f64> {
    None
}
