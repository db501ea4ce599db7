//! The trait of all playable sounds.

/// Consecutive mono samples; 1 is full scale.
///
/// A caller's own sound implements this and becomes a [`Sound`](super::Sound) by
/// [`Sound::new`](super::Sound::new). An audio thread calls these methods: they must not allocate,
/// lock or wait.
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

    /// Makes the sample with this number, counted from 0, the next one.
    fn seek(&mut self, sample: u64);

    /// Chooses whether a sound with an end starts over there or falls silent. A sound without an
    /// end ignores this.
    fn set_looping(&mut self, looping: bool) {
        let _ = looping;
    }

    /// The number of samples from the start to the end; `None` for endless sounds.
    fn length(&self) -> Option<usize> {
        None
    }

    /// Whether only silence is left.
    fn is_finished(&self) -> bool {
        false
    }
}
