//! Assignment of audio samples to video frames.

use std::ops::Range;

use super::AudioError;

/// Divides audio samples among video frames, without gap, overlap or drift.
///
/// Frame `i` starts at the sample nearest to `i · rate / fps`. Each border is rounded on its own,
/// so frames differ by at most one sample in length, and after any number of frames picture and
/// sound are less than a sample apart (up to 2⁵³ samples, thousands of years).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameBlocks {
    fps: f64,
    rate_hz: u32,
}

impl FrameBlocks {
    /// Creates the division for `fps` frames per second and `rate_hz` samples per second.
    ///
    /// # Errors
    /// [`AudioError::BadFrameRate`] if `fps` is not 0.001 to 1,000,000, and
    /// [`AudioError::BadSampleRate`] if `rate_hz` is outside [`SAMPLE_RATES`](super::SAMPLE_RATES).
    pub fn new(fps: f64, rate_hz: u32) -> Result<Self, AudioError> {
        if !is_usable(fps) {
            return Err(AudioError::BadFrameRate { fps });
        }
        super::rate::check_rate(rate_hz)?;
        Ok(Self { fps, rate_hz })
    }

    /// The samples of frame `i`, counted from the first sample of frame 0.
    pub fn samples(&self, i: u64) -> Range<u64> {
        let border = |frame: f64| (frame * f64::from(self.rate_hz) / self.fps).round() as u64;
        border(i as f64)..border(i as f64 + 1.0)
    }

    /// The number of samples of frame `i`; 0 is possible only with more frames than samples.
    #[allow(clippy::len_without_is_empty)] // A frame's length, not this value's.
    pub fn len(&self, i: u64) -> usize {
        let samples = self.samples(i);
        (samples.end - samples.start) as usize
    }

    /// An upper bound of the samples in a frame, to size a buffer by.
    pub fn longest(&self) -> usize {
        (f64::from(self.rate_hz) / self.fps).ceil() as usize + 1
    }
}

/// Rejects frames longer than a quarter of an hour, and frames below a microsecond, which hold no
/// sample at any rate.
fn is_usable(fps: f64) -> bool {
    (1e-3..=1e6).contains(&fps)
}
