//! The measurements of a run of the window, for `--json`, for tests, and for the printed summary.

use super::latency::Parts;
use super::sound::SoundStatus;
use echomarch::auralisation::HeardSource;
use echomarch::internals::fields_cost::FieldsCost;
use echomarch::internals::sampling::{median, quantiles};
use echomarch::tracer::{Counts, Frame, Profile};
use echomarch_walk::EarsStatus;
use serde::Serialize;
use std::collections::BTreeMap;

/// Maximum number of stored pans. When it is reached, every second stored pan is removed.
const PANS_AT_MOST: usize = 4096;

/// Maximum number of stored changes of the scene's files. The oldest are removed.
const REREAD_AT_MOST: usize = 100;

/// Maximum number of stored frame times, from which the medians are computed. The oldest are removed.
const TIMES_AT_MOST: usize = 36_000;

/// Maximum number of stored memory measurements, one per minute: one day.
const MINUTES_AT_MOST: usize = 24 * 60;

/// Milliseconds spent on each part of one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct FrameTimes {
    /// Sphere tracing of the picture.
    pub picture: f64,
    /// Initialisation, march and pan of the waves.
    pub waves: f64,
    /// Read-back and summation of the panning.
    pub read_back: f64,
    /// Tracing of the paths in the plan.
    pub paths: f64,
    /// Drawing of the panels.
    pub overlay: f64,
    /// Presenting the frame on the screen.
    pub swap: f64,
    /// The whole frame, excluding the wait for the next frame.
    pub work: f64,
    /// Time from the start of the previous frame to the start of this frame.
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

/// The record of one frame, for a program that controls the window.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FrameLine<'a> {
    /// Number of frames drawn, including this frame.
    pub frame: u64,
    /// Start time of the frame, in seconds since 1970 by the system clock.
    pub began: f64,
    /// Seconds since the start.
    pub seconds: f64,
    /// Number of frames of waves whose panning was played.
    pub traced: u64,
    /// The last pan that was played.
    pub heard: Option<&'a PanAt>,
    /// Number of waves in a frame.
    pub waves: u32,
    /// The requested number of waves, if it is larger than the number that fits the frame time; otherwise `None`.
    pub more_waves_asked: Option<u32>,
    /// The cost of the scene's marched fields; `None` without marched fields, and until the cost is measured.
    pub fields: Option<&'a FieldsCost>,
    /// Whether the number of waves adapts to the frame time.
    pub adapts_waves: bool,
    /// The name or the file of the scene, as given when it was loaded.
    pub scene: &'a str,
    /// The name or the file of a chosen scene whose users' fields are being tried.
    pub trying: Option<&'a str>,
    /// The named values that were set, in the units of the scene file.
    pub values: &'a [(String, f32)],
    /// Whether mouse look is on.
    pub mouse_looks: bool,
    /// Number of paths in the plan that reached the listener.
    pub paths_heard: usize,
    /// The listener's position in metres.
    pub listener: [f32; 3],
    /// Whether sound is audible.
    pub sound: bool,
    /// The level of each source in full listening; `None` with the balance.
    pub sources: Option<&'a [HeardSource]>,
}

/// A change of the scene's files.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reread {
    /// Seconds since the start.
    pub seconds: f64,
    /// Number of frames drawn before the change.
    pub frames: u64,
    /// The reason why the last valid scene stays, in one sentence; `None` if the new scene is in use.
    pub error: Option<String>,
}

/// Resident memory in MiB; `None` if the system does not report it.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Memory {
    /// Two seconds after the start.
    pub at_start: Option<f64>,
    /// After each minute of the first day.
    pub each_minute: Vec<Option<f64>>,
    /// At the end of the run.
    pub at_end: Option<f64>,
}

/// Position and gaze of the listener at the end of the run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct EndPose {
    /// World position in metres.
    pub position: [f32; 3],
    /// Rotation to the right, in degrees.
    pub yaw: f32,
    /// Rotation upwards, in degrees.
    pub pitch: f32,
}

/// The results of a run of the window.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Report {
    /// The scene at the end.
    pub scene: String,
    /// The algorithm at the end.
    pub profile: String,
    /// Number of waves in a frame at the end.
    pub waves: u32,
    /// The requested number of waves at the end, if it was larger than the number that fitted the frame time; otherwise
    /// `None`.
    pub more_waves_asked: Option<u32>,
    /// The cost of the scene's marched fields; `None` without marched fields, or if the cost was not measured.
    pub fields: Option<FieldsCost>,
    /// Whether the number of waves adapted to the frame time at the end.
    pub adapts_waves: bool,
    /// Number of iterations at the end.
    pub iterations: u32,
    /// GL_RENDERER.
    pub renderer: String,
    /// Duration of the run in seconds.
    pub seconds: f64,
    /// Number of frames drawn.
    pub frames: u64,
    /// Number of frames of waves whose panning was played.
    pub traced: u64,
    /// Frames per second, from the median time between two frames.
    pub fps_median: f64,
    /// The 95th percentile of the times between two frames, in milliseconds.
    pub frame_ms_95: f64,
    /// The median of the time between two frames, and of each part of a frame.
    pub frame_ms_median: FrameTimes,
    /// The window's size in pixels at the end.
    pub window: [u32; 2],
    /// The picture's size in pixels at the end.
    pub picture: [u32; 2],
    /// Number of frames after which GL reported an error; `None` if errors were not queried.
    pub gl_errors: Option<u64>,
    /// Resident memory in MiB.
    pub memory_mib: Memory,
    /// The status of the sound.
    pub sound: SoundStatus,
    /// The listening mode at the end: `full` or `balance`.
    pub listen: String,
    /// The status of full listening; `None` with the balance.
    pub in_full: Option<EarsStatus>,
    /// Latency from a key to the ear, in milliseconds.
    pub latency_ms: Parts,
    /// The counts of waves in the last frame.
    pub counts: Counts,
    /// Position and gaze of the listener at the end.
    pub listener: EndPose,
    /// Position of the source at the end, in metres.
    pub source: [f32; 3],
    /// Whether the help was open at the end.
    pub help: bool,
    /// Whether mouse look was on at the end.
    pub mouse_looks: bool,
    /// Named values that differ from the scene file, in the units of the file.
    pub values: BTreeMap<String, f32>,
    /// Number of paths in the plan that reached the listener, at the end.
    pub paths_heard: usize,
    /// The scene files saved in this run.
    pub saved: Vec<String>,
    /// The `trace` call that reproduces the last frame.
    pub trace_call: String,
    /// Whether the scene of that call has the source and the listener at their final positions.
    pub trace_call_is_exact: bool,
    /// The last hundred changes of the scene's files.
    pub reread: Vec<Reread>,
    /// The pans that were played.
    pub pans: Vec<PanAt>,
}

/// Collects measurements while the window is open.
#[derive(Debug, Default)]
pub struct Recorder {
    /// Number of frames drawn.
    pub frames: u64,
    /// Number of frames of waves whose panning was played.
    pub traced: u64,
    /// Number of frames after which GL reported an error.
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

    /// Records a finished frame of waves.
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

    /// The last pan that was played.
    pub fn last_heard(&self) -> Option<&PanAt> {
        self.pans.last()
    }

    /// The most recent frames, at most `frames` of them.
    pub fn last(&self, frames: usize) -> &[FrameTimes] {
        &self.times[self.times.len().saturating_sub(frames)..]
    }

    /// Writes the measurements into a report.
    pub fn fill(self, report: &mut Report) {
        // The first second is excluded, because it contains compilation and warm-up.
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

    /// Protects long runs: the number of stored pans is bounded, and the stored pans are in order and span the run.
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
