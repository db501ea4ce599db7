//! Keeps the frame time near its target by choosing the picture's resolution and the number of waves.
//!
//! All functions depend only on the measurements. The cost is lowered at once and raised one step at a time. The
//! threshold for raising lies below the threshold for lowering, which prevents oscillation.

use echomarch::internals::sampling::median;

/// Side lengths of the square grids of waves that the control can choose.
const SIDES: [u32; 13] = [
    32, 48, 64, 96, 128, 192, 256, 384, 512, 768, 1024, 1448, 2048,
];

/// Usual minimum number of waves, and the number of waves of a scene's first frame. With fewer waves, only a few dozen
/// reach the listener, which is too few for a stable pan. If a frame with this number takes longer than
/// [`LONGEST_WAIT_MS`], the number is reduced further.
pub const LEAST_WAVES: u32 = 4096;

/// Maximum time between two frames of waves, in milliseconds. Above this time the number of waves may fall below
/// [`LEAST_WAVES`].
const LONGEST_WAIT_MS: f64 = 1000.0;

/// Share of the frame time that is spent on waves if a frame of waves is too long for one picture frame.
pub const SHARE_OF_WAVES: f64 = 0.4;

/// Maximum number of waves that the control and the slider can choose.
pub const MOST_WAVES: u32 = 1 << 20;

/// Scales that the control can choose: the picture's resolution divided by the window's, along one side.
pub const SCALES: [f32; 8] = [0.2, 0.25, 0.33, 0.4, 0.5, 0.65, 0.8, 1.0];

/// Number of frames that are measured before the first change.
const FRAMES: usize = 6;

/// Number of measured frames that is required before the cost is raised.
const FRAMES_TO_SPARE: usize = 18;

/// Share of the target time above which the cost is lowered.
const FULL: f64 = 0.92;

/// Share of the target time that the predicted time may fill after the cost is raised.
const ROOM: f64 = 0.80;

/// Minimum measured time, in milliseconds, from which the time of a whole frame of waves is predicted. The value equals
/// three parts of a frame at 30 frames per second.
const ENOUGH_MS: f64 = 40.0;

/// The recent measurements for one setting whose values form a ladder of increasing cost.
#[derive(Clone, Debug, Default)]
pub struct Control {
    whole: Vec<f64>,
    part: Vec<f64>,
}

impl Control {
    /// Adds one frame, in milliseconds: its total time, and the part of that time that depends on the setting.
    pub fn add(&mut self, whole: f64, part: f64) {
        self.whole.push(whole);
        self.part.push(part);
        if self.whole.len() > FRAMES_TO_SPARE {
            self.whole.remove(0);
            self.part.remove(0);
        }
    }

    /// Returns the step to use next. `costs` are the increasing costs of the ladder's steps in any unit, `now` is the
    /// current step, and `target` is the frame time to keep, in milliseconds.
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

    /// Clears the measurements, which are invalid after a change of any setting.
    pub fn forget(&mut self) {
        self.whole.clear();
        self.part.clear();
    }
}

/// The median of the most recent frame times.
fn recent(times: &[f64]) -> f64 {
    let first = times.len().saturating_sub(FRAMES);
    median(times[first..].iter().copied())
}

/// The numbers of waves from `least` to `most` that the control can choose.
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
    /// Predicts the time of a frame with `waves` waves, in milliseconds.
    pub fn of(self, waves: u32) -> f64 {
        self.milliseconds * f64::from(waves) / f64::from(self.waves.max(1))
    }

    /// The largest number of waves up to `most` that keeps the frame time `target`, in milliseconds. A number below the
    /// usual minimum is chosen only if a frame of waves would otherwise take longer than [`LONGEST_WAIT_MS`].
    pub fn fitting(self, most: u32, target: f64) -> u32 {
        // The control lowers the number only if the waves exceed this time.
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
/// The first part of the first frame includes shader compilation, so its time is not counted. If that part was the
/// whole frame, a second frame is measured. If a frame takes many parts, its time is predicted from the first few.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstFrames {
    /// The number of waves to use if it fits the frame time.
    pub asked: u32,
    waves: u32,
    /// The time in milliseconds and the share of the frame that are excluded from the measurement.
    from: Option<(f64, f64)>,
}

impl FirstFrames {
    /// `asked` is the number of waves to use if it fits the frame time; the first frames have at most `most` waves.
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

    /// Adds a measurement of a frame in progress: milliseconds spent, and the share that is traced, 0 to 1. Returns the
    /// predicted time of the frame once enough of it is measured.
    pub fn part(&mut self, spent: f64, share: f64) -> Option<WaveTime> {
        let (from_ms, from_share) = *self.from.get_or_insert((spent, share));
        let (spent, share) = (spent - from_ms, share - from_share);
        (spent >= ENOUGH_MS && share > 0.0).then(|| WaveTime {
            waves: self.waves(),
            milliseconds: spent / share,
        })
    }

    /// Adds a finished frame, in milliseconds. Returns `None` if the time includes compilation: another frame is then
    /// needed.
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

/// Index of the last step of an increasing ladder that does not exceed `value`; the first step if all steps exceed it.
pub fn step_of<T: PartialOrd>(ladder: &[T], value: T) -> usize {
    ladder
        .iter()
        .rposition(|step| *step <= value)
        .unwrap_or_default()
}

/// The cost of each scale: its number of pixels.
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

    /// Simulates a machine that needs `fixed` milliseconds plus `full` at the top of the ladder. Returns the steps
    /// visited.
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

    /// Protects the frame time: on every simulated machine, the control settles below the target, at the highest step
    /// that fits, without oscillation.
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

    /// Protects a machine that cannot reach the target: the control goes to the lowest step at once and stays there.
    #[test]
    fn the_least_is_the_least() {
        assert_eq!(*run(100.0, 10.0, 4, 60).last().unwrap(), 0);
        assert_eq!(run(12.0, 400.0, 7, FRAMES + 1).len(), 2);
    }

    /// Protects the allowed maximum: the ladder of wave numbers does not exceed it.
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

    /// Protects the frame rate in expensive scenes, and the number of waves in cheap scenes. The chosen number fits the
    /// frame time, or else the maximum wait of one second. The chosen number never exceeds the requested number.
    #[test]
    fn the_number_of_waves_follows_the_measured_rate() {
        assert_eq!(fitting(0.1, 65_536), 65_536);
        assert_eq!(fitting(0.1, 50_000), 50_000);
        assert_eq!(fitting(1.0, 65_536), 36_864);
        assert_eq!(fitting(2.6, 262_144), 16_384);
        assert_eq!(fitting(10.0, 65_536), 4096);
        // From this time on, a frame of waves is traced in parts.
        assert_eq!(fitting(399.0, 65_536), 4096);
        assert_eq!(fitting(410.0, 65_536), 2304);
        assert_eq!(fitting(1500.0, 65_536), 1024);
        assert_eq!(fitting(1e6, 65_536), 1024);
        assert_eq!(fitting(1e6, 300), 300);
        assert_eq!(fitting(0.0, 65_536), 65_536);
    }

    /// Protects the number chosen from the first frames: the frame-time control does not lower it at once.
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

    /// Protects the measurement from compilation time, and the user from waiting for a long frame.
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

        // A frame in a few parts: the second frame is measured, including its first part.
        let mut between = FirstFrames::new(4096, 4096);
        assert_eq!(between.part(900.0, 0.5), None);
        assert_eq!(between.whole(910.0), None);
        assert_eq!(between.part(13.0, 0.5), None);
        assert_eq!(between.whole(26.0).unwrap().milliseconds, 26.0);
    }
}
