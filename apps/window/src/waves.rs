//! The number of waves, and the cost of the scene's fields. The first frames of a scene choose the number, which then
//! adapts to the frame time.

use super::adapt::{FirstFrames, LEAST_WAVES, MOST_WAVES, SHARE_OF_WAVES, WaveTime};
use super::adapt::{step_of, wave_ladder};
use super::app::App;
use super::state::Measured;

/// A warning is shown if the waves take more than this multiple of the frame time.
const TOO_LONG: f64 = 2.0;
/// Number of consecutive frames that must exceed `TOO_LONG`. A single frame may be delayed by chance.
const TOO_OFTEN: u32 = 30;
/// Time of a frame of waves, in milliseconds. If a number of waves chosen by the user exceeds this time, the warning is
/// also printed on the terminal.
const DEAR_MS: f64 = 1000.0;

impl App {
    /// Starts a measurement if the scene, the profile or a fixed number of waves has not been measured yet.
    pub fn measure_new(&mut self) {
        let settings = &self.choices.settings;
        let adapts = self.choices.adapt_waves;
        let new = Measured {
            scene: self.world.name.clone(),
            profile: settings.profile(),
            iterations: settings.iterations,
            fixed: (!adapts).then_some(settings.waves),
        };
        if self.measured.as_ref() == Some(&new) {
            return;
        }
        if !self
            .measured
            .as_ref()
            .is_some_and(|old| old.is_of_march(&new))
        {
            self.fields.forget();
            self.fields_are_due = true;
        }
        self.measured = Some(new);
        (self.late, self.least_waves) = (0, LEAST_WAVES);
        self.wave_time = None;
        self.wave_control.forget();
        let first = match adapts {
            true => FirstFrames::new(self.asked_waves, LEAST_WAVES),
            false => FirstFrames::new(settings.waves, settings.waves),
        };
        self.choices.settings.waves = first.waves();
        self.first_frames = Some(first);
    }

    /// Requests a new measurement, because the scene's files have changed.
    pub fn measure_again(&mut self) {
        self.measured = None;
    }

    /// The first frames; `None` if the frame of waves in progress was begun with other settings.
    fn first_of_these(&mut self) -> Option<&mut FirstFrames> {
        let is_of_these = self.under_way == self.choices.settings;
        self.first_frames.as_mut().filter(|_| is_of_these)
    }

    /// Records a part of the frame of waves in progress: milliseconds spent, and the share that is traced.
    pub fn part_traced(&mut self, spent: f64, share: f64) {
        let first = self.first_of_these();
        if let Some(time) = first.and_then(|first| first.part(spent, share)) {
            self.choose_waves(time);
        }
    }

    /// Records the time of a whole frame of waves, in milliseconds.
    pub fn frame_traced(&mut self, milliseconds: f64) {
        let first = self.first_of_these();
        if let Some(time) = first.and_then(|first| first.whole(milliseconds)) {
            self.choose_waves(time);
        }
    }

    /// Chooses the number of waves from the time of the first frames, or warns that a fixed number takes long.
    fn choose_waves(&mut self, time: WaveTime) {
        let Some(first) = self.first_frames.take() else {
            return;
        };
        self.wave_time = Some(time);
        if !self.choices.adapt_waves {
            if time.milliseconds > DEAR_MS {
                self.tell(self.too_long(time.milliseconds));
            }
            return;
        }
        let chosen = self.fitting(time, first.asked);
        self.choices.settings.waves = chosen;
        self.least_waves = LEAST_WAVES.min(chosen);
        if chosen < first.asked {
            self.say(format!(
                "{chosen} of {} waves: more would not keep the frame rate",
                first.asked
            ));
        }
    }

    /// The largest number of waves up to `most` that fits the frame time.
    fn fitting(&self, time: WaveTime, most: u32) -> u32 {
        let every = f64::from(self.choices.trace_every.max(1));
        let shared = WaveTime {
            milliseconds: time.milliseconds / every,
            ..time
        };
        shared.fitting(most, self.options.frame_milliseconds)
    }

    /// The warning about a fixed number of waves that does not fit the frame time.
    fn too_long(&self, milliseconds: f64) -> String {
        let waves = self.choices.settings.waves;
        let time = WaveTime {
            waves,
            milliseconds,
        };
        let fitting = self.fitting(time, waves);
        format!(
            "{waves} waves take {milliseconds:.0} ms, in parts: T reduces them to {fitting}, [ halves them"
        )
    }

    /// Repeats the warning for as long as a fixed number of waves takes too long.
    pub fn watch_waves(&mut self) {
        let target = self.options.frame_milliseconds;
        let foreseen = self.wave_time.map_or(0.0, |time| time.milliseconds);
        let took = self.on_waves.max(foreseen);
        let is_late = took > TOO_LONG * target && !self.choices.adapt_waves;
        self.late = if is_late { self.late + 1 } else { 0 };
        if self.late >= TOO_OFTEN && self.message.is_none() {
            self.late = 0;
            self.say(self.too_long(took));
        }
    }

    /// Adapts the number of waves, and returns whether it changed. `on_waves` is the average time per frame, in
    /// milliseconds, of waves traced in one piece. `others` is the time of all other work.
    pub fn adapt_waves(&mut self, others: f64, on_waves: f64) -> bool {
        if !self.choices.adapt_waves || self.first_frames.is_some() {
            return false;
        }
        let ladder = wave_ladder(self.least_waves, MOST_WAVES);
        let costs: Vec<f64> = ladder.iter().map(|&waves| f64::from(waves)).collect();
        let waves = self.choices.settings.waves;
        let before = step_of(&ladder, waves);
        let target = self.options.frame_milliseconds;
        // The remaining time is reserved for the picture, which every movement of the listener redraws.
        let others = others.max((1.0 - SHARE_OF_WAVES) * target);
        self.wave_control.add(others + on_waves, on_waves);
        let chosen = self.wave_control.choose(&costs, before, target);
        if chosen == before {
            return false;
        }
        self.choices.settings.waves = ladder[chosen];
        true
    }

    /// The requested number of waves, if it is larger than the number that fits the frame time.
    pub fn more_waves_asked(&self) -> Option<u32> {
        let is_fewer = self.choices.adapt_waves && self.choices.settings.waves < self.asked_waves;
        is_fewer.then_some(self.asked_waves)
    }

    /// Measures the cost of a scene's marched fields once its number of waves is chosen, and takes the result.
    pub fn follow_fields(&mut self) {
        let is_due = self.fields_are_due && self.first_frames.is_none();
        if is_due && let Ok(pair) = self.world.pair() {
            let mut scene = self.world.now.clone();
            scene.sources = vec![pair.source().clone()];
            scene.listeners = vec![pair.listener().clone()];
            self.fields.measure(scene, &self.choices.settings);
            self.fields_are_due = false;
        }
        self.fields.poll();
    }
}
