//! A sine whose phase does not drift.

use std::f64::consts::TAU;

use super::{AudioError, Signal};

/// The peak of a sine, relative to full scale 1: −6.02 dBFS.
pub const SINE_AMPLITUDE: f32 = 0.5;

/// An endless sine that starts at phase 0.
///
/// The phase is kept in turns, between 0 and 1, in `f64`: each step rounds by at most 2⁻⁵³ turns,
/// so even errors that all have the same sign reach only 2·10⁻⁸ turns in an hour.
#[derive(Debug, Clone)]
pub(super) struct Sine {
    phase_turns: f64,
    step_turns: f64,
}

impl Sine {
    pub(super) fn new(frequency_hz: f64, sample_rate: u32) -> Result<Self, AudioError> {
        let limit_hz = f64::from(sample_rate) / 2.0;
        if !(frequency_hz > 0.0 && frequency_hz < limit_hz) {
            return Err(AudioError::BadSineFrequency {
                frequency_hz,
                limit_hz,
            });
        }
        Ok(Self {
            phase_turns: 0.0,
            step_turns: frequency_hz / f64::from(sample_rate),
        })
    }

    fn advance(&mut self) {
        self.phase_turns += self.step_turns;
        if self.phase_turns >= 1.0 {
            self.phase_turns -= 1.0;
        }
    }
}

impl Signal for Sine {
    fn fill(&mut self, out: &mut [f32]) {
        for sample in out {
            *sample = SINE_AMPLITUDE * (TAU * self.phase_turns).sin() as f32;
            self.advance();
        }
    }

    /// Makes the sample with this number the next one.
    fn seek(&mut self, index: u64) {
        self.phase_turns = (self.step_turns * index as f64).fract();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the phase, which is known exactly after whole seconds: the frequency times the time.
    #[test]
    fn phase_is_kept_for_an_hour() {
        for frequency_hz in [440.0, 997.0, 1234.5, 23_999.0] {
            let mut sine = Sine::new(frequency_hz, 48_000).unwrap();
            for _ in 0..3600 * 48_000 {
                sine.advance();
            }
            let wanted = (frequency_hz * 3600.0).fract();
            let off = (sine.phase_turns - wanted).abs();
            let off = off.min(1.0 - off);
            assert!(off < 2e-8, "{frequency_hz} Hz is {off} turns off");
        }
    }
}
