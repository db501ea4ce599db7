//! Keeps the frame time: chooses the picture's resolution and the number of waves.
//!
//! Pure functions of the measurements. The cost is lowered quickly and raised slowly, with a gap between the two
//! thresholds to prevent oscillation.

use echomarch::internals::sampling::median;

/// Sides of the grid of waves that the control chooses from.
const SIDES: [u32; 13] = [
    32, 48, 64, 96, 128, 192, 256, 384, 512, 768, 1024, 1448, 2048,
];

/// Usual minimum number of waves, and the number of the first frame of a scene: of fewer the listener receives only a
/// few dozen, too few for a stable pan. Scenes whose frames take longer than [`LONGEST_WAIT_MS`] with this number get
/// fewer.
pub const LEAST_WAVES: u32 = 4096;

/// Maximum time from a frame of waves to the next in milliseconds, for which the number of waves may fall below
/// [`LEAST_WAVES`].
const LONGEST_WAIT_MS: f64 = 1000.0;

/// The share of a frame's time spent on waves if a whole frame of waves does not fit.
pub const SHARE_OF_WAVES: f64 = 0.4;

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

/// Time of parts of a frame of waves in milliseconds from which the time of the frame is predicted: three parts at 30
/// frames a second.
const ENOUGH_MS: f64 = 40.0;

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

/// Returns the selectable numbers of waves from `least` to `most`.
pub fn wave_ladder(least: u32, most: u32) -> Vec<u32> {
    let all = SIDES.iter().map(|side| side * side);
    all.filter(|waves| (least..=most).contains(waves)).collect()
}

/// The time of a frame of waves, measured or predicted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WaveTime {
    pub waves: u32,
    pub milliseconds: f64,
}

impl WaveTime {
    /// Predicted milliseconds of a frame of another number of waves.
    pub fn of(self, waves: u32) -> f64 {
        self.milliseconds * f64::from(waves) / f64::from(self.waves.max(1))
    }

    /// The largest selectable number of waves up to `most` that keeps the frame time `target`, in milliseconds. Below
    /// the usual minimum the number only falls as far as is needed for a frame in parts to last a second at most.
    pub fn fitting(self, most: u32, target: f64) -> u32 {
        // The control lowers a number only above this time.
        let room = (FULL - (1.0 - SHARE_OF_WAVES)) * target;
        let within_frame = |waves: &u32| self.of(*waves) <= room;
        if within_frame(&most) {
            return most;
        }
        let usual = wave_ladder(LEAST_WAVES.min(most), most);
        if let Some(waves) = usual.iter().rev().copied().find(within_frame) {
            return waves;
        }
        let within_wait = |waves: &u32| self.of(*waves) <= SHARE_OF_WAVES * LONGEST_WAIT_MS;
        let few = wave_ladder(1, LEAST_WAVES.min(most));
        let fitting = few.iter().rev().copied().find(within_wait);
        fitting.or(few.first().copied()).unwrap_or(most)
    }
}

/// The first frames of waves of a scene, whose time decides the number of waves.
///
/// The first part that is drawn also compiles, so its time is not used: if it was the whole frame, a second frame
/// follows. A frame that takes many parts is not waited for; its time is predicted from a few of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstFrames {
    /// The number of waves that is used if it fits.
    pub asked: u32,
    waves: u32,
    /// Time and share of the frame that are not counted.
    from: Option<(f64, f64)>,
}

impl FirstFrames {
    /// `asked` waves are used if they fit; these frames have `most` at most.
    pub fn new(asked: u32, most: u32) -> FirstFrames {
        FirstFrames {
            asked,
            waves: asked.min(most),
            from: None,
        }
    }

    /// The number of waves of these frames.
    pub fn waves(&self) -> u32 {
        self.waves
    }

    /// Takes the milliseconds and the share, 0 to 1, of a frame in progress; returns its time once it can be predicted.
    pub fn part(&mut self, spent: f64, share: f64) -> Option<WaveTime> {
        let (from_ms, from_share) = *self.from.get_or_insert((spent, share));
        let (spent, share) = (spent - from_ms, share - from_share);
        (spent >= ENOUGH_MS && share > 0.0).then(|| WaveTime {
            waves: self.waves(),
            milliseconds: spent / share,
        })
    }

    /// Takes the milliseconds of a finished frame; `None` if they include compiling, so that another frame is needed.
    pub fn whole(&mut self, milliseconds: f64) -> Option<WaveTime> {
        if self.from != Some((0.0, 0.0)) {
            self.from = Some((0.0, 0.0));
            return None;
        }
        Some(WaveTime {
            waves: self.waves(),
            milliseconds,
        })
    }
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
        let usual = |most| wave_ladder(LEAST_WAVES, most);
        assert_eq!(usual(65_536).last(), Some(&65_536));
        assert_eq!(usual(70_000).last(), Some(&65_536));
        assert_eq!(usual(70_000)[0], 4096);
        assert_eq!(wave_ladder(1, 4096), [1024, 2304, 4096]);
        assert_eq!(step_of(&[1, 5, 9], 6), 1);
        assert_eq!(step_of(&[1, 5, 9], 0), 0);
        assert_eq!(step_of(&SCALES, 1.0), SCALES.len() - 1);
    }

    fn fitting(milliseconds_of_4096: f64, most: u32) -> u32 {
        let time = WaveTime {
            waves: 4096,
            milliseconds: milliseconds_of_4096,
        };
        time.fitting(most, TARGET)
    }

    /// Protects the frame rate from dear scenes, and cheap scenes from needlessly few waves: the number fits the frame,
    /// then a second, and the number asked for is never exceeded.
    #[test]
    fn the_number_of_waves_follows_the_measured_rate() {
        assert_eq!(fitting(0.1, 65_536), 65_536);
        assert_eq!(fitting(0.1, 50_000), 50_000);
        assert_eq!(fitting(1.0, 65_536), 36_864);
        assert_eq!(fitting(2.6, 262_144), 16_384);
        assert_eq!(fitting(10.0, 65_536), 4096);
        // From here a frame is traced in parts.
        assert_eq!(fitting(399.0, 65_536), 4096);
        assert_eq!(fitting(410.0, 65_536), 2304);
        assert_eq!(fitting(1500.0, 65_536), 1024);
        assert_eq!(fitting(1e6, 65_536), 1024);
        assert_eq!(fitting(1e6, 300), 300);
        assert_eq!(fitting(0.0, 65_536), 65_536);
    }

    /// Protects the chosen number from being lowered at once by the control that follows the frame time.
    #[test]
    fn the_control_keeps_the_first_number() {
        let costs: Vec<f64> = wave_ladder(LEAST_WAVES, MOST_WAVES)
            .iter()
            .map(|&waves| f64::from(waves))
            .collect();
        for of_4096 in [0.1, 0.5, 1.0, 2.6, 5.0, 10.0] {
            let waves = fitting(of_4096, 65_536);
            let ladder = wave_ladder(LEAST_WAVES, MOST_WAVES);
            let step = step_of(&ladder, waves);
            let part = of_4096 * f64::from(waves) / 4096.0;
            let mut control = Control::default();
            for _ in 0..FRAMES {
                control.add((1.0 - SHARE_OF_WAVES) * TARGET + part, part);
            }
            assert!(control.choose(&costs, step, TARGET) >= step, "{of_4096}");
        }
    }

    /// Protects the measurement from the time of compiling, and the user from waiting for a long frame.
    #[test]
    fn compiling_is_no_part_of_the_first_time() {
        let mut quick = FirstFrames::new(65_536, 4096);
        assert_eq!(quick.waves(), 4096);
        assert_eq!(quick.whole(900.0), None);
        let time = quick.whole(2.0).unwrap();
        assert_eq!((time.waves, time.milliseconds), (4096, 2.0));

        let mut slow = FirstFrames::new(1000, 4096);
        assert_eq!(slow.part(900.0, 0.01), None);
        assert_eq!(slow.part(913.0, 0.02), None);
        let time = slow.part(950.0, 0.06).unwrap();
        assert_eq!(time.waves, 1000);
        assert!((time.milliseconds - 1000.0).abs() < 1e-9);

        // A frame in a few parts: the second is measured, its first part included.
        let mut between = FirstFrames::new(4096, 4096);
        assert_eq!(between.part(900.0, 0.5), None);
        assert_eq!(between.whole(910.0), None);
        assert_eq!(between.part(13.0, 0.5), None);
        assert_eq!(between.whole(26.0).unwrap().milliseconds, 26.0);
    }
}
