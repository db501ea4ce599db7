//! Mixes mono samples with gains to interleaved stereo.

use super::{AudioError, Gains, PanningLaw};

/// Mixes one mono sound to two channels, block by block, with gains that glide.
///
/// A block's gains run linearly from the previous block's to its own target, which its last sample
/// reaches; the first block starts at its own. The gain of a sample differs from that of the
/// previous one by at most the block's gain change divided by its length, borders included.
///
/// ```
/// use echomarch::audio::{Mixer, PanningLaw};
///
/// let mut mixer = Mixer::new(PanningLaw::Linear);
/// let mut stereo = [0.0; 4];
/// mixer.mix(&[1.0, 1.0], -1.0, &mut stereo)?;
/// assert_eq!(stereo, [1.0, 0.0, 1.0, 0.0]);
/// mixer.mix(&[1.0, 1.0], 1.0, &mut stereo)?; // glides to the right
/// assert_eq!(stereo, [0.5, 0.5, 0.0, 1.0]);
/// # Ok::<(), echomarch::audio::AudioError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Mixer {
    law: PanningLaw,
    /// The gains of the last sample mixed; `None` before the first block.
    current: Option<Gains>,
}

impl Mixer {
    /// Creates a mixer that has mixed nothing yet.
    pub fn new(law: PanningLaw) -> Self {
        Self { law, current: None }
    }

    /// The panning law that [`mix`](Self::mix) follows.
    pub fn law(&self) -> PanningLaw {
        self.law
    }

    /// The gains of the last sample mixed; `None` before the first.
    pub fn current(&self) -> Option<Gains> {
        self.current
    }

    /// Forgets the gains, so that the next block starts at its own.
    pub fn reset(&mut self) {
        self.current = None;
    }

    /// Mixes one block towards the gains of the law for `pan`, −1 (left) to 1 (right).
    ///
    /// `out` is interleaved (left, right, …) and is overwritten. An empty block changes nothing.
    ///
    /// # Errors
    /// As [`mix_to`](Self::mix_to).
    pub fn mix(&mut self, mono: &[f32], pan: f32, out: &mut [f32]) -> Result<(), AudioError> {
        self.mix_to(mono, self.law.gains(pan), out)
    }

    /// Mixes one block towards the `target` gains: [`Gains::SILENT`] fades out over the block.
    ///
    /// A gain that is not finite counts as 0. `out` is interleaved (left, right, …) and is
    /// overwritten. An empty block changes nothing.
    ///
    /// # Errors
    /// [`AudioError::BadStereoLength`] if `out` is not twice as long as `mono`: then nothing changes.
    pub fn mix_to(
        &mut self,
        mono: &[f32],
        target: Gains,
        out: &mut [f32],
    ) -> Result<(), AudioError> {
        if out.len() / 2 != mono.len() || !out.len().is_multiple_of(2) {
            let (mono, stereo) = (mono.len(), out.len());
            return Err(AudioError::BadStereoLength { mono, stereo });
        }
        if mono.is_empty() {
            return Ok(());
        }
        let target = finite(target);
        let start = self.current.unwrap_or(target);
        let length = mono.len() as f32;
        for (i, (&sample, pair)) in mono.iter().zip(out.chunks_exact_mut(2)).enumerate() {
            let along = (i + 1) as f32 / length;
            pair[0] = sample * glide(start.left, target.left, along);
            pair[1] = sample * glide(start.right, target.right, along);
        }
        self.current = Some(target);
        Ok(())
    }
}

/// The gain at `along` (0 to 1) of the way; exactly `start` if both ends are equal.
fn glide(start: f32, target: f32, along: f32) -> f32 {
    start + (target - start) * along
}

fn finite(gains: Gains) -> Gains {
    let or_silent = |gain: f32| if gain.is_finite() { gain } else { 0.0 };
    Gains {
        left: or_silent(gains.left),
        right: or_silent(gains.right),
    }
}
