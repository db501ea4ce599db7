//! Keeps the frame time: chooses the picture's resolution and the number of waves.
//!
//! Pure functions of the measurements. The cost is lowered quickly and raised slowly, with a gap between the two
//! thresholds to prevent oscillation.

use echomarch::internals::sampling::median;

/// Sides of the grid of waves that the control chooses from. The first is the minimum: of fewer than 4,096 waves the
/// listener receives only a few dozen, too few for a stable pan.
const SIDES: [u32; 11] = [64, 96, 128, 192, 256, 384, 512, 768, 1024, 1448, 2048];

/// Maximum number of waves that the control and the slider choose.
pub const MOST_WAVES: u32 = 1 << 20;

/// Ratios of the picture's resolution to the window's, along one side, that the control chooses from.
pub const SCALES: [f32; 8] = [0.2, 0.25, 0.33, 0.4, 0.5, 0.65, 0.8, 1.0];

/// Frames to measure before anything is changed.
const FRAMES: usize = 6;

/// Frames with spare time before the cost is raised.
const FRAMES_TO_SPARE: usize = 18;

/// Above this share of the target time the cost is lowered.
const FULL: f64 = 0.92;

/// Share of the target time that the predicted time may fill after the cost is raised.
const ROOM: f64 = 0.80;

/// The recent measurements for one choice from a ladder of costs.
#[derive(Clone, Debug, Default)]
pub struct Control {
    whole: Vec<f64>,
    part: Vec<f64>,
}

impl Control {
    /// Adds one frame: its whole time, and the part of that time that depends on the choice, in milliseconds.
    pub fn add(&mut self, whole: f64, part: f64) {
        self.whole.push(whole);
        self.part.push(part);
        if self.whole.len() > FRAMES_TO_SPARE {
            self.whole.remove(0);
            self.part.remove(0);
        }
    }

    /// Returns the step to use from now on. `costs` are the increasing costs of the ladder's steps in any unit, `now`
    /// is the step in use, and `target` is the frame time to keep, in milliseconds.
    pub fn choose(&mut self, costs: &[f64], now: usize, target: f64) -> usize {
        let now = now.min(costs.len().saturating_sub(1));
        if self.whole.len() < FRAMES || costs.is_empty() {
            return now;
        }
        let (whole, part) = (recent(&self.whole), recent(&self.part));
        let foreseen = |step: usize| whole - part + part * costs[step] / costs[now];
        let chosen = if whole > FULL * target {
            (0..now)
                .rev()
                .find(|&step| foreseen(step) <= ROOM * target)
                .unwrap_or(0)
        } else if self.whole.len() >= FRAMES_TO_SPARE
            && now + 1 < costs.len()
            && foreseen(now + 1) <= ROOM * target
        {
            now + 1
        } else {
            now
        };
        if chosen != now {
            self.forget();
        }
        chosen
    }

    /// Clears the measurements, which are no longer valid after another change.
    pub fn forget(&mut self) {
        self.whole.clear();
        self.part.clear();
    }
}

/// The median of the last frames.
fn recent(times: &[f64]) -> f64 {
    let first = times.len().saturating_sub(FRAMES);
    median(times[first..].iter().copied())
}

/// Returns the selectable numbers of waves up to `most`.
pub fn wave_ladder(most: u32) -> Vec<u32> {
    SIDES
        .iter()
        .map(|side| side * side)
        .filter(|&waves| waves <= most)
        .collect()
}

/// Returns the largest step of an increasing ladder that does not exceed a value; the first step if all exceed it.
pub fn step_of<T: PartialOrd>(ladder: &[T], value: T) -> usize {
    ladder
        .iter()
        .rposition(|step| *step <= value)
        .unwrap_or_default()
}

/// The costs of the scales: the number of pixels at each.
pub fn scale_costs() -> Vec<f64> {
    SCALES
        .iter()
        .map(|&scale| f64::from(scale) * f64::from(scale))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TARGET: f64 = 33.3;

    /// Simulates a machine that needs `fixed` milliseconds plus `full` at the end of the ladder; returns the visited
    /// steps.
    fn run(fixed: f64, full: f64, start: usize, frames: usize) -> Vec<usize> {
        let costs = scale_costs();
        let mut control = Control::default();
        let mut step = start;
        let mut steps = vec![start];
        for _ in 0..frames {
            let part = full * costs[step];
            control.add(fixed + part, part);
            step = control.choose(&costs, step, TARGET);
            if steps.last() != Some(&step) {
                steps.push(step);
            }
        }
        steps
    }

    /// Protects the frame time: on every machine the control ends below the target, at the highest step that fits, and
    /// does not oscillate there.
    #[test]
    fn the_control_settles_at_the_most_that_fits() {
        let costs = scale_costs();
        for full in [5.0, 40.0, 90.0, 300.0, 500.0] {
            for start in [0, 4, SCALES.len() - 1] {
                let steps = run(12.0, full, start, 600);
                let last = *steps.last().unwrap();
                assert!(12.0 + full * costs[last] <= TARGET, "{full}: {steps:?}");
                if let Some(more) = costs.get(last + 1) {
                    assert!(12.0 + full * more > ROOM * TARGET, "{full}: {steps:?}");
                }
                assert!(steps.len() <= SCALES.len() + 1, "it swings: {steps:?}");
            }
        }
    }

    /// Protects a machine that cannot reach the target: the control stays at the minimum, and goes down to it at once.
    #[test]
    fn the_least_is_the_least() {
        assert_eq!(*run(100.0, 10.0, 4, 60).last().unwrap(), 0);
        assert_eq!(run(12.0, 400.0, 7, FRAMES + 1).len(), 2);
    }

    /// Protects the ladder of wave numbers from exceeding the allowed maximum.
    #[test]
    fn ladders_end_where_they_must() {
        assert_eq!(wave_ladder(65_536).last(), Some(&65_536));
        assert_eq!(wave_ladder(70_000).last(), Some(&65_536));
        assert_eq!(wave_ladder(70_000)[0], 4096);
        assert_eq!(step_of(&[1, 5, 9], 6), 1);
        assert_eq!(step_of(&[1, 5, 9], 0), 0);
        assert_eq!(step_of(&SCALES, 1.0), SCALES.len() - 1);
    }
}
