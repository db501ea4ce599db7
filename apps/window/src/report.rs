//! The report of a run of the window in numbers: for `--json`, for tests, for people.

use super::latency::Parts;
use super::sound::SoundStatus;
use echomarch::internals::fields_cost::FieldsCost;
use echomarch::internals::sampling::{median, quantiles};
use echomarch::response::HeardSource;
use echomarch::tracer::{Counts, Frame, Profile};
use echomarch_walk::EarsStatus;
use serde::Serialize;
use std::collections::BTreeMap;

/// Maximum number of stored pans. When it is reached, every second pan is dropped.
const PANS_AT_MOST: usize = 4096;

/// Maximum number of stored changes of the scene's files; the oldest are dropped.
const REREAD_AT_MOST: usize = 100;

/// Maximum number of stored frame times for the medians; the oldest are dropped.
const TIMES_AT_MOST: usize = 36_000;

/// Maximum number of minutes with a memory record: a day.
const MINUTES_AT_MOST: usize = 24 * 60;

/// Milliseconds spent on each part of one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct FrameTimes {
    /// Sphere tracing the picture.
    pub picture: f64,
    /// Initialise, march and pan of the waves.
    pub waves: f64,
    /// Copying and summing the panning.
    pub read_back: f64,
    /// The paths in the plan.
    pub paths: f64,
    /// Panels.
    pub overlay: f64,
    /// Presenting the frame on the screen.
    pub swap: f64,
    /// The whole frame, without waiting for the next one.
    pub work: f64,
    /// Time from the start of the last frame to the start of this one.
    pub whole: f64,
}

/// A pan and its time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PanAt {
    /// Seconds since the start.
    pub seconds: f64,
    /// −1 left, 1 right.
    pub pan: f64,
    /// The algorithm that computed the pan.
    pub profile: String,
}

/// A record of one frame, for a program that drives the window.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FrameLine<'a> {
    /// Frames drawn, this one included.
    pub frame: u64,
    /// Start time of the frame, in seconds since 1970 by the system clock.
    pub began: f64,
    /// Seconds since the start.
    pub seconds: f64,
    /// Frames of waves heard.
    pub traced: u64,
    /// The last pan heard.
    pub heard: Option<&'a PanAt>,
    /// Waves in a frame.
    pub waves: u32,
    /// The number of waves that would be traced if it fitted the frame time; none if all are.
    pub more_waves_asked: Option<u32>,
    /// The cost of the scene's marched fields; none without fields, and until it is measured.
    pub fields: Option<&'a FieldsCost>,
    /// Whether the number of waves follows the frame time.
    pub adapts_waves: bool,
    /// The name or file that the scene was loaded by.
    pub scene: &'a str,
    /// The name or file of a chosen scene while its users' fields are tried.
    pub trying: Option<&'a str>,
    /// The scene's named values that were set, in the unit of its file.
    pub values: &'a [(String, f32)],
    /// Whether the mouse looks about.
    pub mouse_looks: bool,
    /// Paths of heard waves in the plan.
    pub paths_heard: usize,
    /// The listener's position in metres.
    pub listener: [f32; 3],
    /// Whether sound is audible.
    pub sound: bool,
    /// The level of each source in full listening; none with the balance.
    pub sources: Option<&'a [HeardSource]>,
}

/// A change of the scene's files.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reread {
    /// Seconds since the start.
    pub seconds: f64,
    /// Number of frames drawn before the change.
    pub frames: u64,
    /// The reason why the last good scene stays, in one sentence; `None` if the new scene is in
    /// use.
    pub error: Option<String>,
}

/// Resident memory in MiB; none if the system does not report it.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Memory {
    /// After two seconds.
    pub at_start: Option<f64>,
    /// After each minute of the first day.
    pub each_minute: Vec<Option<f64>>,
    /// At the end.
    pub at_end: Option<f64>,
}

/// A position and gaze at the end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct EndPose {
    /// World position in metres.
    pub position: [f32; 3],
    /// Degrees to the right.
    pub yaw: f32,
    /// Degrees upwards.
    pub pitch: f32,
}

/// The results of a run of the window.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Report {
    /// The scene at the end.
    pub scene: String,
    /// The algorithm at the end.
    pub profile: String,
    /// Waves in a frame at the end.
    pub waves: u32,
    /// The number of waves that would have been traced at the end if it had fitted the frame time; none if all were.
    pub more_waves_asked: Option<u32>,
    /// The cost of the scene's marched fields; none without fields, or if it was not measured.
    pub fields: Option<FieldsCost>,
    /// Whether the number of waves followed the frame time at the end.
    pub adapts_waves: bool,
    /// Iterations at the end.
    pub iterations: u32,
    /// GL_RENDERER.
    pub renderer: String,
    /// Seconds that the window was open.
    pub seconds: f64,
    /// Frames drawn.
    pub frames: u64,
    /// Frames of waves that were heard.
    pub traced: u64,
    /// Frames a second, by the median of the times between them.
    pub fps_median: f64,
    /// The 95th percentile of the times between two frames, in milliseconds.
    pub frame_ms_95: f64,
    /// The median of the times between frames, and of each part.
    pub frame_ms_median: FrameTimes,
    /// The window's size in pixels at the end.
    pub window: [u32; 2],
    /// The picture's size in pixels at the end.
    pub picture: [u32; 2],
    /// Number of frames after which GL reported an error; none if errors were not queried.
    pub gl_errors: Option<u64>,
    /// Resident memory in MiB.
    pub memory_mib: Memory,
    /// The sound.
    pub sound: SoundStatus,
    /// The listening mode at the end: full, or balance.
    pub listen: String,
    /// The report of full listening; none with the balance.
    pub in_full: Option<EarsStatus>,
    /// From a key to the ear, in milliseconds.
    pub latency_ms: Parts,
    /// The waves of the last frame.
    pub counts: Counts,
    /// Listener at the end.
    pub listener: EndPose,
    /// Source at the end, in metres.
    pub source: [f32; 3],
    /// Whether the help was open at the end.
    pub help: bool,
    /// Whether the mouse looked about at the end.
    pub mouse_looks: bool,
    /// Named values set differently from the scene's file, in the unit of the file.
    pub values: BTreeMap<String, f32>,
    /// Paths of waves that reached the listener in the plan at the end.
    pub paths_heard: usize,
    /// Scene files that were saved.
    pub saved: Vec<String>,
    /// The `trace` call that reproduces the last frame.
    pub trace_call: String,
    /// Whether that call's scene contains the source and the listener at their present positions.
    pub trace_call_is_exact: bool,
    /// The changes of the scene's files, the last hundred.
    pub reread: Vec<Reread>,
    /// The pans heard.
    pub pans: Vec<PanAt>,
}

/// Collects the measurements while the window is open.
#[derive(Debug, Default)]
pub struct Recorder {
    /// Frames drawn.
    pub frames: u64,
    /// Frames of waves heard.
    pub traced: u64,
    /// Frames after which GL reported an error.
    pub gl_errors: u64,
    times: Vec<FrameTimes>,
    pans: Vec<PanAt>,
    reread: Vec<Reread>,
    stride: u64,
    memory: Memory,
}

impl Recorder {
    /// Records a frame drawn `seconds` after the start.
    pub fn frame(&mut self, times: FrameTimes, seconds: f64) {
        self.frames += 1;
        if self.times.len() == TIMES_AT_MOST {
            self.times.drain(..TIMES_AT_MOST / 2);
        }
        self.times.push(times);
        let due = |slot: Option<f64>, after: f64| slot.is_none() && seconds >= after;
        if due(self.memory.at_start, 2.0) {
            self.memory.at_start = resident_mib();
        }
        let minutes = &mut self.memory.each_minute;
        if seconds >= 60.0 * (minutes.len() + 1) as f64 && minutes.len() < MINUTES_AT_MOST {
            minutes.push(resident_mib());
        }
    }

    /// Records a frame of waves.
    pub fn heard(&mut self, frame: &Frame, profile: Profile, seconds: f64) {
        self.traced += 1;
        let stride = self.stride.max(1);
        if !self.traced.is_multiple_of(stride) {
            return;
        }
        self.pans.push(PanAt {
            seconds,
            pan: frame.panning.pan(),
            profile: profile.to_string(),
        });
        if self.pans.len() == PANS_AT_MOST {
            let mut index = 0;
            self.pans.retain(|_| {
                index += 1;
                index % 2 == 0
            });
            self.stride = 2 * stride;
        }
    }

    /// Records a change of the scene's files.
    pub fn reread(&mut self, reread: Reread) {
        if self.reread.len() == REREAD_AT_MOST {
            self.reread.remove(0);
        }
        self.reread.push(reread);
    }

    /// The last pan heard.
    pub fn last_heard(&self) -> Option<&PanAt> {
        self.pans.last()
    }

    /// The last frames, at most `frames`.
    pub fn last(&self, frames: usize) -> &[FrameTimes] {
        &self.times[self.times.len().saturating_sub(frames)..]
    }

    /// Writes the measurements into a report.
    pub fn fill(self, report: &mut Report) {
        // The first second, with compiling and warming up, is left out as not representative.
        let warm = self.times.len().min(30).min(self.times.len() / 4);
        let times = &self.times[warm..];
        let whole = || times.iter().map(|t| t.whole);
        report.frame_ms_median = medians(times);
        report.fps_median = 1000.0 / median(whole()).max(1e-3);
        [report.frame_ms_95] = quantiles(whole(), [0.95]);
        (report.frames, report.traced) = (self.frames, self.traced);
        report.memory_mib = Memory {
            at_end: resident_mib(),
            ..self.memory
        };
        report.reread = self.reread;
        report.pans = self.pans;
    }
}

/// The median of each part.
pub fn medians(times: &[FrameTimes]) -> FrameTimes {
    let of = |part: fn(&FrameTimes) -> f64| median(times.iter().map(part));
    FrameTimes {
        picture: of(|t| t.picture),
        waves: of(|t| t.waves),
        read_back: of(|t| t.read_back),
        paths: of(|t| t.paths),
        overlay: of(|t| t.overlay),
        swap: of(|t| t.swap),
        work: of(|t| t.work),
        whole: of(|t| t.whole),
    }
}

/// Resident memory of this process in MiB, as reported by Linux.
fn resident_mib() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmRSS:"))?;
    let kib: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kib / 1024.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects long runs: the stored pans are bounded, in order, and span the run.
    #[test]
    fn a_long_run_keeps_a_bounded_history() {
        let mut recorder = Recorder::default();
        let mut frame = Frame::default();
        frame.panning.right = 1.0;
        for index in 0..20_000 {
            recorder.heard(&frame, Profile::Hybrid, f64::from(index));
            recorder.frame(FrameTimes::default(), f64::from(index));
        }
        let mut report = Report::default();
        recorder.fill(&mut report);
        assert!(report.pans.len() < PANS_AT_MOST && report.pans.len() > 1000);
        assert!(report.pans.windows(2).all(|p| p[0].seconds < p[1].seconds));
        assert!(report.pans.last().unwrap().seconds > 19_900.0);
        assert_eq!((report.frames, report.traced), (20_000, 20_000));
    }
}
