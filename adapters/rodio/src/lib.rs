//! Plays the mix of all sources of an [`echomarch::simulator`] as a source of [rodio](https://docs.rs/rodio).
//!
//! [`World`] neither allocates, frees nor locks while it plays.

use echomarch::simulator::{EarsSpec, Mix, Simulator, SimulatorError, SourceId};
use rodio::{ChannelCount, Sample, SampleRate};
use std::num::NonZero;
use std::time::Duration;

/// Frames that are mixed at once.
const CHUNK: usize = 128;

/// Number of channels: left and right.
const CHANNELS: ChannelCount = NonZero::<u16>::MIN.saturating_add(1);

/// A source of rodio without an end: the mix of all sources of a simulator.
pub struct World<F> {
    mix: Mix,
    fill: F,
    rate_hz: SampleRate,
    stereo: [f32; 2 * CHUNK],
    /// Index of the next sample.
    next: usize,
}

impl<F: FnMut(SourceId, &mut [f32])> World<F> {
    /// The mix of a simulator. `fill` writes the next samples of a source; they are silent before. It is called on the
    /// audio thread, so it must not wait.
    ///
    /// # Errors
    /// [`SimulatorError::BadNumber`] for a number of the format out of its range.
    pub fn new(
        simulator: &Simulator,
        spec: &EarsSpec,
        fill: F,
    ) -> Result<World<F>, SimulatorError> {
        let mix = simulator.mix(spec)?;
        let rate_hz = SampleRate::new(spec.rate_hz).unwrap_or(SampleRate::MIN);
        Ok(World {
            mix,
            fill,
            rate_hz,
            stereo: [0.0; 2 * CHUNK],
            next: 2 * CHUNK,
        })
    }
}

impl<F: FnMut(SourceId, &mut [f32])> Iterator for World<F> {
    type Item = Sample;

    fn next(&mut self) -> Option<Sample> {
        if self.next == self.stereo.len() {
            self.mix.process(&mut self.stereo, &mut self.fill);
            self.next = 0;
        }
        let sample = self.stereo[self.next];
        self.next += 1;
        Some(sample)
    }
}

impl<F: FnMut(SourceId, &mut [f32])> rodio::Source for World<F> {
    fn current_span_len(&self) -> Option<usize> {
        None
    }

    fn channels(&self) -> ChannelCount {
        CHANNELS
    }

    fn sample_rate(&self) -> SampleRate {
        self.rate_hz
    }

    fn total_duration(&self) -> Option<Duration> {
        None
    }
}
