//! The number of waves that fits a time, from the time of the last trace.

use std::ops::RangeInclusive;
use std::time::Duration;

/// Number of waves in the first trace of a scene with marched fields, whose duration is unknown. The same number is the
/// minimum in a trace that takes longer than its limit. 64 waves fill eight vectors of a software renderer.
pub const LEAST_WAVES: u32 = 64;

/// Minimum share of a time limit that is left to waves, however long everything else takes. With fewer waves, a trace
/// would hardly be shorter, but its late part would be rough.
const LEAST_FOR_WAVES: f64 = 0.25;

/// Duration of a trace.
#[derive(Clone, Copy, Debug, Default)]
pub struct TraceTime {
    /// Time that is proportional to the number of waves.
    pub waves: Duration,
    /// Time that hardly depends on the number of waves, such as that of diffraction.
    fixed: Duration,
}

impl TraceTime {
    /// Splits the duration of a trace. `fixed_ms` is the part in milliseconds that hardly depends on the number of
    /// waves.
    pub fn new(whole: Duration, fixed_ms: f64) -> TraceTime {
        let fixed = Duration::from_secs_f64(fixed_ms / 1e3).min(whole);
        TraceTime {
            waves: whole - fixed,
            fixed,
        }
    }

    /// The number of waves, within the limits, of a trace of `seconds`. This trace of `before` waves took this time.
    pub fn fitting(&self, before: u32, seconds: f64, limits: &RangeInclusive<u32>) -> u32 {
        let for_waves = (seconds - self.fixed.as_secs_f64()).max(LEAST_FOR_WAVES * seconds);
        let fit = f64::from(before) * for_waves / self.waves.as_secs_f64();
        (fit as u32).clamp(*limits.start(), *limits.end())
    }
}
