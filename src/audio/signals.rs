//! The trait of all mono signals, and the built-in signals: a sine whose phase does not drift, reproducible white
//! noise, and a recorded sound in memory.

use std::f64::consts::TAU;

use super::AudioError;
use crate::sampling::hash;

/// Consecutive mono samples; 1 is full scale.
///
/// A caller's own sound implements this trait; [`Sound::new`](super::Sound::new) turns it into a
/// [`Sound`](super::Sound). An audio thread calls these methods: they must not allocate, lock or wait.
///
/// ```
/// use echomarch::audio::{Signal, Sound};
///
/// /// A click of one sample every half second at 48 kHz.
/// struct Metronome(u64);
///
/// impl Signal for Metronome {
///     fn fill(&mut self, out: &mut [f32]) {
///         for sample in out {
///             *sample = if self.0.is_multiple_of(24_000) { 0.5 } else { 0.0 };
///             self.0 += 1;
///         }
///     }
///
///     fn seek(&mut self, sample: u64) {
///         self.0 = sample;
///     }
/// }
///
/// let mut sound = Sound::new(Metronome(0));
/// let mut out = [0.0; 4];
/// sound.fill(&mut out);
/// assert_eq!(out, [0.5, 0.0, 0.0, 0.0]);
/// ```
pub trait Signal: Send {
    /// Overwrites `out` with the next `out.len()` samples.
    fn fill(&mut self, out: &mut [f32]);

    /// Continues at sample number `sample`, counted from 0.
    fn seek(&mut self, sample: u64);

    /// Chooses whether the sound restarts at its end or falls silent. Has no effect on an endless sound.
    fn set_looping(&mut self, looping: bool) {
        let _ = looping;
    }

    /// The number of samples from the start to the end; `None` for endless sounds.
    fn length(&self) -> Option<usize> {
        None
    }

    /// Whether the signal has ended, so that only silence follows.
    fn is_finished(&self) -> bool {
        false
    }
}

/// The peak of a sine, relative to full scale 1: −6.02 dBFS.
pub(super) const SINE_AMPLITUDE: f32 = 0.5;

/// An endless sine that starts at phase 0.
///
/// The phase is stored in turns, between 0 and 1, in `f64`. Each step rounds by at most 2⁻⁵³ turns, so even errors that
/// all have the same sign add up to only 2·10⁻⁸ turns in an hour.
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

    /// Sets the position so that sample `index` is the next sample.
    fn seek(&mut self, index: u64) {
        self.phase_turns = (self.step_turns * index as f64).fract();
    }
}

/// The peak of the noise, relative to full scale 1: −6.02 dBFS, at a level of −10.8 dBFS (RMS).
pub(super) const NOISE_AMPLITUDE: f32 = 0.5;

/// White noise, uniformly distributed; a sample depends only on its index and the seed.
#[derive(Debug, Clone)]
pub(super) struct Noise {
    seed: u64,
    index: u64,
}

impl Noise {
    pub(super) fn new(seed: u64) -> Self {
        Self { seed, index: 0 }
    }
}

impl Signal for Noise {
    fn fill(&mut self, out: &mut [f32]) {
        for sample in out {
            *sample = noise_at(self.seed, self.index);
            self.index = self.index.wrapping_add(1);
        }
    }

    /// Sets the position so that sample `index` is the next sample.
    fn seek(&mut self, index: u64) {
        self.index = index;
    }
}

/// The noise at one index. The seed is hashed first, so that similar seeds give different noise.
fn noise_at(seed: u64, index: u64) -> f32 {
    let bits = hash(hash(seed).wrapping_add(index));
    let signed = (bits >> 40) as i32 - (1 << 23); // 24 bits: exact in f32
    NOISE_AMPLITUDE * signed as f32 / (1 << 23) as f32
}

/// Length in seconds of the cross-fade from a loop's end into its start: long enough to avoid a click, and too short to
/// be audible as a separate change.
const SEAM_S: f64 = 0.005;

/// A clip shorter than this number of seams loops at more than 50 Hz. Its seam is part of its tone and is not
/// cross-faded.
const SEAMS_AT_LEAST: usize = 4;

/// Mono samples with a read position.
///
/// If the end of a looping clip does not match its start, every restart is cross-faded: the clip's end, played
/// backwards so that the sound continues without a step, fades into its start. The first pass starts without a
/// cross-fade, and the loop is as long as the clip.
#[derive(Debug, Clone)]
pub(super) struct Clip {
    /// Never empty.
    samples: Vec<f32>,
    next: usize,
    looping: bool,
    /// Whether the clip has restarted at least once.
    is_again: bool,
    /// Length of the cross-fade in samples; 0 if the end matches the start.
    seam: usize,
}

impl Clip {
    /// A looping clip at its start; `samples` must not be empty.
    pub(super) fn new(samples: Vec<f32>, rate_hz: u32) -> Self {
        debug_assert!(!samples.is_empty());
        Self {
            seam: seam(&samples, rate_hz),
            samples,
            next: 0,
            looping: true,
            is_again: false,
        }
    }

    /// Cross-fades the part of `out` that lies in the seam. `out` begins at the sample of the current position.
    fn cross_fade(&self, out: &mut [f32]) {
        let last = self.samples.len() - 1;
        for (i, sample) in (self.next..self.seam).zip(out) {
            let share = i as f64 / self.seam as f64;
            // Computed in `f64`, where the difference of two samples cannot overflow.
            let end = f64::from(self.samples[last - i]);
            *sample = (end + (f64::from(*sample) - end) * share) as f32;
        }
    }
}

impl Signal for Clip {
    fn fill(&mut self, mut out: &mut [f32]) {
        while !out.is_empty() {
            if self.next == self.samples.len() {
                if !self.looping {
                    out.fill(0.0);
                    return;
                }
                self.next = 0;
                self.is_again = true;
            }
            let left = &self.samples[self.next..];
            let count = left.len().min(out.len());
            let (now, later) = out.split_at_mut(count);
            now.copy_from_slice(&left[..count]);
            if self.is_again {
                self.cross_fade(now);
            }
            self.next += count;
            out = later;
        }
    }

    /// Sets the position so that sample `index` is the next sample. The indices of a looping clip continue past its
    /// end.
    fn seek(&mut self, index: u64) {
        let length = self.samples.len() as u64;
        self.is_again = self.looping && index >= length;
        self.next = if self.looping {
            index % length
        } else {
            index.min(length)
        } as usize;
    }

    fn length(&self) -> Option<usize> {
        Some(self.samples.len())
    }

    fn set_looping(&mut self, looping: bool) {
        self.looping = looping;
    }

    fn is_finished(&self) -> bool {
        !self.looping && self.next == self.samples.len()
    }
}

/// Number of samples to cross-fade when a clip restarts. It is zero if the step from the clip's end to its start is not
/// larger than nearby steps in the sound itself, as in a clip made to loop.
fn seam(samples: &[f32], rate_hz: u32) -> usize {
    let length = (f64::from(rate_hz) * SEAM_S) as usize;
    if length == 0 || samples.len() < SEAMS_AT_LEAST * length {
        return 0;
    }
    let (start, end) = (&samples[..length], &samples[samples.len() - length..]);
    let own = largest_step(start).max(largest_step(end));
    let step = (start[0] - end[length - 1]).abs();
    if step > own { length } else { 0 }
}

fn largest_step(samples: &[f32]) -> f32 {
    let steps = samples.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    steps.fold(0.0, f32::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the phase, which is known exactly after whole seconds: frequency × time.
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

    const RATE_HZ: u32 = 48_000;

    /// Length in samples of each clip below: 0.1 s.
    const LENGTH: usize = 4800;

    /// Plays a looping clip three and a half times, in blocks of an odd size.
    fn rounds(samples: &[f32]) -> Vec<f32> {
        let mut clip = Clip::new(samples.to_vec(), RATE_HZ);
        let mut played = vec![0.0; samples.len() * 7 / 2];
        played.chunks_mut(331).for_each(|block| clip.fill(block));
        played
    }

    /// Protects loops from clicks: if the end of a clip does not match its start, no step is larger than a step of the
    /// cross-fade.
    #[test]
    fn a_clip_that_does_not_fit_itself_starts_over_without_a_click() {
        let ramp: Vec<f32> = (0..LENGTH).map(|n| n as f32 / LENGTH as f32).collect();
        let played = rounds(&ramp);
        let seam = (f64::from(RATE_HZ) * SEAM_S) as usize;
        // The step of the seam's cross-fade per sample, plus the rise of the clip itself per sample.
        let most = 1.0 / seam as f32 + 2.0 / LENGTH as f32;
        assert!(largest_step(&played) <= most, "{}", largest_step(&played));
        // Beyond the seam the clip is unchanged. The first pass of the clip is unchanged as well.
        assert_eq!(played[..LENGTH], ramp[..]);
        assert_eq!(played[LENGTH + seam..2 * LENGTH], ramp[seam..]);
        assert_eq!(played[LENGTH..2 * LENGTH], played[2 * LENGTH..3 * LENGTH]);
    }

    /// Protects clips that were made to loop: no sample changes.
    #[test]
    fn a_clip_that_fits_itself_is_played_as_it_is() {
        // All ten periods have the same samples.
        let turn = |n: usize| ((n % 480) as f64 * std::f64::consts::TAU / 480.0).sin() as f32;
        let sine: Vec<f32> = (0..LENGTH).map(turn).collect();
        for (n, sample) in rounds(&sine).into_iter().enumerate() {
            assert_eq!(sample, sine[n % LENGTH]);
        }
    }

    /// Protects seeking in a clip: the samples after a seek are those of uninterrupted playback.
    #[test]
    fn seeking_finds_what_playing_comes_to() {
        let ramp: Vec<f32> = (0..LENGTH).map(|n| n as f32 / LENGTH as f32).collect();
        let played = rounds(&ramp);
        for from in [0, 17, LENGTH - 1, LENGTH, LENGTH + 9, 2 * LENGTH + 4000] {
            let mut clip = Clip::new(ramp.clone(), RATE_HZ);
            clip.seek(from as u64);
            let mut sought = vec![0.0; 1000];
            clip.fill(&mut sought);
            assert_eq!(sought[..], played[from..from + 1000], "from {from}");
        }
    }
}
