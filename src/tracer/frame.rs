//! The result of a frame: panning, counts of waves, and times.

use super::waves::{Fate, unpack_counters};
use crate::error::Error;
use crate::platform::Instant;
use std::time::Duration;

/// The result of one traced frame.
///
/// ```
/// # use echomarch::gl::{Context, ContextOptions};
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
#[derive(Clone, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
#[non_exhaustive]
pub struct Frame {
    /// The sound at the two ears.
    pub panning: Panning,
    /// Counts of waves by their fate.
    pub counts: Counts,
    /// Time of each part of the frame.
    pub milliseconds: Milliseconds,
}

/// Times of the parts of one frame, in milliseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
#[non_exhaustive]
pub struct Milliseconds {
    /// The initialise pass; 0 if all passes of the frame are drawn as one.
    pub initialise: f64,
    /// All march passes together, or the single pass of the frame.
    pub march: f64,
    /// The panning pass. If all passes of the frame are drawn as one, the time is that of the pass that rearranges the
    /// contributions into the order of the waves, or 0 if they are already in this order.
    pub pan: f64,
    /// The read-back of the panning texture, and its summation on the CPU.
    pub read_back: f64,
    /// The elapsed time of the whole frame, including setup. The compilation of shaders and the creation of textures,
    /// which happen only in a first frame, are not included.
    pub total: f64,
}

impl Milliseconds {
    /// The median of each part over several frames. The parts are 0 without frames.
    #[doc(hidden)]
    pub fn medians(frames: &[Milliseconds]) -> Milliseconds {
        let part = |of: fn(&Milliseconds) -> f64| crate::sampling::median(frames.iter().map(of));
        Milliseconds {
            initialise: part(|m| m.initialise),
            march: part(|m| m.march),
            pan: part(|m| m.pan),
            read_back: part(|m| m.read_back),
            total: part(|m| m.total),
        }
    }
}

/// The sound at the two ears: the summed contributions of all waves that reached the listener (thesis, section 3.2.4).
/// Each of these waves contributes 1, divided between the ears.
///
/// ```
/// use echomarch::Panning;
///
/// let mut panning = Panning::default();
/// assert_eq!(panning.pan(), 0.0); // nothing arrived
/// (panning.left, panning.right) = (1.0, 3.0);
/// assert_eq!(panning.pan(), 0.5);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
#[non_exhaustive]
pub struct Panning {
    /// Sum of the contributions to the left.
    pub left: f64,
    /// Sum of the contributions to the right.
    pub right: f64,
}

impl Panning {
    /// The panning value: −1 left, 0 the middle, 1 right. The value is 0 if no wave arrived. A sum that is negative or
    /// not finite counts as 0.
    pub fn pan(&self) -> f64 {
        let or_none = |sum: f64| if sum.is_finite() { sum.max(0.0) } else { 0.0 };
        // Half of each sum is used, so that the total is finite.
        let (left, right) = (0.5 * or_none(self.left), 0.5 * or_none(self.right));
        let sum = left + right;
        if sum > 0.0 { (right - left) / sum } else { 0.0 }
    }
}

/// Counts of waves by fate, and of events during their marches. If the counts are summed on the GPU, those of marches
/// and evaluations are exact up to 2^24 and rounded above.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
#[non_exhaustive]
pub struct Counts {
    /// Waves that reached the listener.
    pub listener_hits: u64,
    /// Dead waves: they hit no surface within the maximum distance, or one of their marches reached the step limit.
    pub dead: u64,
    /// Waves that are neither heard nor dead after the last iteration.
    pub travelling: u64,
    /// Waves whose position or direction is not finite, because of a faulty shader or driver. They contribute to
    /// neither ear and are in no other count.
    pub not_finite: u64,
    /// Marches (of one wave in one iteration) that ended at distance 0.
    pub zero_length_passes: u64,
    /// Marches that reached the step limit.
    pub step_limit_reached: u64,
    /// Evaluations of the distance, if they are counted. `zero_length_passes` and `step_limit_reached` are then 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub evaluations: u64,
}

fn is_zero(count: &u64) -> bool {
    *count == 0
}

impl Counts {
    /// Adds the counters of one wave.
    fn add_counters(&mut self, counters: f32, are_evaluations: bool) {
        if are_evaluations {
            self.evaluations += counters as u64;
            return;
        }
        let (zero_length, step_limit) = unpack_counters(counters);
        self.zero_length_passes += u64::from(zero_length);
        self.step_limit_reached += u64::from(step_limit);
    }
}

/// Sums a panning texture that was read back: `[left, right, status, counters]` per wave.
///
/// The sum is computed in `f64` in the order of the waves, so every run has the same result.
pub(super) fn sum(contributions: &[f32], are_evaluations: bool) -> (Panning, Counts) {
    let mut panning = Panning::default();
    let mut counts = Counts::default();
    for &[left, right, status, counters] in contributions.as_chunks::<4>().0 {
        match Fate::of(status) {
            // Only heard waves contribute to the sums.
            Fate::Listener => {
                counts.listener_hits += 1;
                panning.left += f64::from(left);
                panning.right += f64::from(right);
            }
            Fate::Dead => counts.dead += 1,
            Fate::Travelling => counts.travelling += 1,
            Fate::NotFinite => counts.not_finite += 1,
        }
        if counters != 0.0 {
            counts.add_counters(counters, are_evaluations);
        }
    }
    (panning, counts)
}

pub(super) fn in_milliseconds(duration: Duration) -> f64 {
    duration.as_secs_f64() * 1e3
}

/// Returns a result, and the time in milliseconds of its computation.
pub(super) fn timed<T>(work: impl FnOnce() -> Result<T, Error>) -> Result<(T, f64), Error> {
    let began = Instant::now();
    let result = work()?;
    Ok((result, in_milliseconds(began.elapsed())))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the sign and the range of the panning value, and the value of silence.
    #[test]
    fn pan_runs_from_left_to_right() {
        let pan = |left, right| Panning { left, right }.pan();
        assert_eq!(pan(5.0, 0.0), -1.0);
        assert_eq!(pan(2.0, 2.0), 0.0);
        assert_eq!(pan(1.0, 3.0), 0.5);
        assert_eq!(pan(0.0, 0.0), 0.0);
        // Sums that cannot result from waves.
        assert_eq!(pan(-1.0, 3.0), 1.0);
        assert_eq!(pan(f64::NAN, 2.0), 1.0);
        assert_eq!(pan(f64::INFINITY, f64::INFINITY), 0.0);
        assert_eq!(pan(f64::MAX, f64::MAX), 0.0);
    }

    /// Protects the counting of fates and counters.
    #[test]
    fn a_texture_is_summed_and_counted() {
        let texels = [
            0.25, 0.75, 0.0, 2.0, //
            0.0, 0.0, -1.0, 4096.0, //
            0.0, 0.0, 3.0, 1.0,
        ];
        let (panning, counts) = sum(&texels, false);
        assert_eq!((panning.left, panning.right), (0.25, 0.75));
        let fates = (counts.listener_hits, counts.dead, counts.travelling);
        assert_eq!(fates, (1, 1, 1));
        assert_eq!(
            (counts.zero_length_passes, counts.step_limit_reached),
            (3, 1)
        );
    }
}
