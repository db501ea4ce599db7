//! Repeated pairs of frames, and the differences between the times of their frames.

use crate::stats::{median, quantiles};
use echomarch::Error;
use echomarch::scene::Scene;
use echomarch::tracer::{Frame, Milliseconds, Settings, Tracer};
use serde::Serialize;

/// The scene and the settings of a frame.
#[derive(Clone, Copy)]
pub(super) struct Case<'a> {
    pub scene: &'a Scene,
    pub settings: &'a Settings,
}

/// The frames of two cases, by run. Both frames of a run have the same seed.
pub(super) struct Pair {
    pub base: Vec<Frame>,
    pub changed: Vec<Frame>,
}

/// The time saved by a change.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Timing {
    /// Median time without the change, in milliseconds.
    pub base_ms: f64,
    /// Median time with the change, in milliseconds.
    pub changed_ms: f64,
    /// Median of the differences of all runs, in milliseconds; negative if the change costs time.
    pub saved_ms: f64,
    /// `saved_ms` in percent of `base_ms`.
    pub saved_percent: f64,
    /// Half of the interquartile range of the differences, in milliseconds.
    pub spread_ms: f64,
    /// Whether the difference exceeds both its spread and the noise of the clock.
    pub beyond_noise: bool,
}

/// Runs both cases in turns. The case that runs first alternates.
pub(super) fn pair(
    tracer: &mut Tracer,
    base: Case,
    changed: Case,
    runs: u32,
) -> Result<Pair, Error> {
    tracer.frame(base.scene, base.settings)?;
    tracer.frame(changed.scene, changed.settings)?;
    // A different number of waves needs new textures, whose memory is allocated at their first use.
    let warms = base.settings.waves != changed.settings.waves;
    let mut frame = |case: Case, run: u32| {
        let seed = case.settings.seed.wrapping_add(run);
        let settings = case.settings.clone().with_seed(seed);
        if warms {
            tracer.frame(case.scene, &settings)?;
        }
        tracer.frame(case.scene, &settings)
    };
    let mut pair = Pair {
        base: Vec::new(),
        changed: Vec::new(),
    };
    for run in 0..runs {
        if run % 2 == 0 {
            pair.base.push(frame(base, run)?);
            pair.changed.push(frame(changed, run)?);
        } else {
            pair.changed.push(frame(changed, run)?);
            pair.base.push(frame(base, run)?);
        }
    }
    Ok(pair)
}

impl Pair {
    /// Timing of the march passes. `control_percent` is the noise of the clock, from the control pair.
    pub fn march(&self, control_percent: f64) -> Timing {
        self.timing(|m| m.march, control_percent)
    }

    /// Timing of the whole frame.
    pub fn total(&self, control_percent: f64) -> Timing {
        self.timing(|m| m.total, control_percent)
    }

    fn timing(&self, part: fn(&Milliseconds) -> f64, control_percent: f64) -> Timing {
        let times = |frames: &[Frame]| -> Vec<f64> {
            frames.iter().map(|f| part(&f.milliseconds)).collect()
        };
        let (base, changed) = (times(&self.base), times(&self.changed));
        let saved: Vec<f64> = base.iter().zip(&changed).map(|(b, c)| b - c).collect();
        let base_ms = median(base);
        let saved_ms = median(saved.iter().copied());
        let percent = |ms: f64| match base_ms > 0.0 {
            true => 100.0 * ms / base_ms,
            false => 0.0,
        };
        let spread_ms = half_between_quartiles(saved);
        Timing {
            base_ms,
            changed_ms: median(changed),
            saved_ms,
            saved_percent: percent(saved_ms),
            spread_ms,
            beyond_noise: percent(saved_ms.abs() - spread_ms) > control_percent,
        }
    }
}

impl Timing {
    /// Noise of a saving in percent, measured with this pair of identical cases.
    pub(super) fn own_noise_percent(&self) -> f64 {
        match self.base_ms > 0.0 {
            true => 100.0 * (self.saved_ms.abs() + self.spread_ms) / self.base_ms,
            false => 0.0,
        }
    }
}

fn half_between_quartiles(values: Vec<f64>) -> f64 {
    let [low, high] = quantiles(values, [0.25, 0.75]);
    0.5 * (high - low)
}

#[cfg(test)]
mod tests {
    use super::half_between_quartiles;

    /// Protects the figure that decides whether a saving is within the noise.
    #[test]
    fn the_spread_is_half_of_the_middle_half() {
        assert_eq!(half_between_quartiles(vec![5.0, 1.0, 3.0, 2.0, 4.0]), 1.0);
        assert_eq!(half_between_quartiles(vec![7.0]), 0.0);
        assert_eq!(half_between_quartiles(vec![]), 0.0);
    }
}
