//! Settings of a simulator.

use super::SimulatorError;
use crate::gl::ContextOptions;
use crate::response::ResponseSettings;
use crate::tracer::Settings;
use std::ops::RangeInclusive;

/// Settings of a [`Simulator`](super::Simulator). All of them have defaults.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SimulatorSettings {
    /// The renderer.
    pub context: ContextOptions,
    /// Time in milliseconds that the simulator's thread works in each round, 0.5 to 1000. After a longer round it rests
    /// longer, so that on average it keeps to its share of the time.
    pub milliseconds: f64,
    /// Rounds per second, 1 to 1000.
    pub rounds_hz: f64,
    /// Maximum number of waves of a trace, 64 to 65,536. A trace has fewer waves if its time is short.
    pub waves: u32,
    /// Length of a trace in seconds after the source's impulse, 0.1 to 10.
    pub seconds: f64,
    /// Length in seconds of the traces that measure the decay, 0.1 to 20. A quarter of the waves is followed for this
    /// time. If it is not longer than `seconds`, the decay beyond the trace is extrapolated.
    pub longest_s: f64,
    /// Maximum number of reflections of an echo, 0 to 8.
    pub order: u32,
    /// Maximum number of echoes of a source: the strongest, 0 to 64. All other sound is in the reverberation.
    pub echoes: usize,
    /// Whether sound bends around what hides a source.
    pub diffraction: bool,
    /// Whether sound passes solids whose materials transmit.
    pub transmission: bool,
}

impl Default for SimulatorSettings {
    /// Returns 6 ms in each of 60 rounds a second, 4,096 waves of 0.8 s, echoes of up to three reflections.
    fn default() -> SimulatorSettings {
        SimulatorSettings {
            context: ContextOptions::default(),
            milliseconds: 6.0,
            rounds_hz: 60.0,
            waves: 4096,
            seconds: 0.8,
            longest_s: 3.0,
            order: 3,
            echoes: 32,
            diffraction: true,
            transmission: true,
        }
    }
}

impl SimulatorSettings {
    /// Returns the settings with a renderer.
    #[must_use]
    pub fn with_context(mut self, context: ContextOptions) -> SimulatorSettings {
        self.context = context;
        self
    }

    /// Returns the settings with a time in milliseconds for each round.
    #[must_use]
    pub fn with_milliseconds(mut self, milliseconds: f64) -> SimulatorSettings {
        self.milliseconds = milliseconds;
        self
    }

    /// Returns the settings with a maximum number of waves of a trace.
    #[must_use]
    pub fn with_waves(mut self, waves: u32) -> SimulatorSettings {
        self.waves = waves;
        self
    }

    /// Returns the settings with a length of traces in seconds, and one of the traces that measure the decay.
    #[must_use]
    pub fn with_seconds(mut self, seconds: f64, longest_s: f64) -> SimulatorSettings {
        (self.seconds, self.longest_s) = (seconds, longest_s);
        self
    }

    /// Returns the settings with a maximum order and number of echoes.
    #[must_use]
    pub fn with_echoes(mut self, order: u32, echoes: usize) -> SimulatorSettings {
        (self.order, self.echoes) = (order, echoes);
        self
    }

    /// Checks every number against its range.
    ///
    /// # Errors
    /// [`SimulatorError::BadNumber`].
    pub fn validate(&self) -> Result<(), SimulatorError> {
        let check =
            |what, must, range: RangeInclusive<f64>, value: f64| match range.contains(&value) {
                true => Ok(()),
                false => Err(SimulatorError::BadNumber { what, must, value }),
            };
        let (milliseconds, rate) = (self.milliseconds, self.rounds_hz);
        check(
            "the milliseconds of a round",
            "0.5 to 1000",
            0.5..=1e3,
            milliseconds,
        )?;
        check("the rounds per second", "1 to 1000", 1.0..=1e3, rate)?;
        let waves = f64::from(self.waves);
        check("the number of waves", "64 to 65536", 64.0..=65536.0, waves)?;
        check(
            "the seconds of a trace",
            "0.1 to 10",
            0.1..=10.0,
            self.seconds,
        )?;
        check(
            "the longest seconds",
            "0.1 to 20",
            0.1..=20.0,
            self.longest_s,
        )?;
        let order = f64::from(self.order);
        check("the order of echoes", "0 to 8", 0.0..=8.0, order)?;
        check(
            "the number of echoes",
            "0 to 64",
            0.0..=64.0,
            self.echoes as f64,
        )
    }

    /// The settings of a trace of this many waves and seconds.
    pub(super) fn response(&self, waves: u32, seed: u32, seconds: f64) -> ResponseSettings {
        let trace = Settings::hybrid().with_waves(waves).with_seed(seed);
        // The direct ways are found apart, at a rate of their own.
        ResponseSettings::default()
            .with_trace(trace)
            .with_order(self.order)
            .with_seconds(seconds)
            .with_transmission(self.transmission)
            .without_figures()
    }
}
