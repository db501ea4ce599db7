//! What one frame yields.

use super::{Counts, Panning};
use crate::error::Error;
use crate::platform::Instant;
use std::time::Duration;

/// The result of one traced frame.
///
/// ```
/// # use echomarch::gpu::{Context, ContextOptions};
/// # use echomarch::{Scene, Settings, Tracer};
/// # let context = Context::headless(&ContextOptions::default())?;
/// let settings = Settings::default().with_waves(1024);
/// let frame = Tracer::new(&context)?.frame(&Scene::builtin("corner")?, &settings)?;
/// println!("pan {:+.2} in {:.1} ms", frame.panning.pan(), frame.milliseconds.total);
///
/// let counts = frame.counts;
/// assert_eq!(counts.listener_hits + counts.dead + counts.travelling, 1024);
/// # Ok::<(), echomarch::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
#[non_exhaustive]
pub struct Frame {
    /// What arrived at the two ears.
    pub panning: Panning,
    /// How the waves fared.
    pub counts: Counts,
    /// Where the time went.
    pub milliseconds: Milliseconds,
}

/// Time of one frame by part, in milliseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
#[non_exhaustive]
pub struct Milliseconds {
    /// The initialise pass; 0 where all passes of the frame are one.
    pub initialise: f64,
    /// All march passes together, or the one pass of the frame.
    pub march: f64,
    /// The panning pass; 0 where all passes of the frame are one.
    pub pan: f64,
    /// Reading the panning texture back, and summing it on the CPU.
    pub read_back: f64,
    /// The whole frame by the wall clock, setup included; without compiling shaders and making
    /// textures, which only a first frame does.
    pub total: f64,
}

impl Milliseconds {
    /// The median of each part over several frames, each by itself; zeros for none.
    pub fn medians(frames: &[Milliseconds]) -> Milliseconds {
        let part = |of: fn(&Milliseconds) -> f64| crate::stats::median(frames.iter().map(of));
        Milliseconds {
            initialise: part(|m| m.initialise),
            march: part(|m| m.march),
            pan: part(|m| m.pan),
            read_back: part(|m| m.read_back),
            total: part(|m| m.total),
        }
    }
}

pub(super) fn in_milliseconds(duration: Duration) -> f64 {
    duration.as_secs_f64() * 1e3
}

/// A result, and the milliseconds that it took.
pub(super) fn timed<T>(work: impl FnOnce() -> Result<T, Error>) -> Result<(T, f64), Error> {
    let began = Instant::now();
    let result = work()?;
    Ok((result, in_milliseconds(began.elapsed())))
}
