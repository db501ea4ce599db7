//! A scene to sound without a sound card: traced and played frame by frame.
//!
//! [`render`] uses the thesis' method: the gains of one sound glide to a frame's panning by the end of the frame's
//! block of samples. [`render_full`] plays each source with delays, loudness, echoes and reverberation
//! ([`auralisation`](crate::auralisation)). Each frame is traced with the scene at the frame's start.

mod balance;
mod full_listening;

pub use balance::{Block, render};
pub use full_listening::{FullBlock, FullSettings, render_full};

use crate::audio::SAMPLE_RATE;
use crate::error::Error;
use crate::trace::TraceError;

/// Duration and frame rate.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Timing {
    /// Seconds of sound.
    pub seconds: f64,
    /// Frames per second.
    pub fps: f64,
}

impl Timing {
    /// Creates a timing of `seconds` of sound at `fps` frames per second.
    pub fn new(seconds: f64, fps: f64) -> Timing {
        Timing { seconds, fps }
    }

    /// Number of frames; the last one is cut at the end of the duration.
    pub fn frames(&self) -> u64 {
        // A fraction of a frame below this is due to rounding: at 1000 frames per second it is far
        // below one sample.
        const ROUNDING: f64 = 1e-6;
        (self.seconds * self.fps - ROUNDING).ceil().max(0.0) as u64
    }

    /// Samples of each channel.
    fn samples(&self) -> u64 {
        (self.seconds * f64::from(SAMPLE_RATE)).round() as u64
    }

    fn check(&self) -> Result<(), Error> {
        if self.seconds.is_finite() && self.seconds >= 0.0 {
            return Ok(());
        }
        Err(Error::from(TraceError::BadSetting {
            what: "length in seconds",
            must: "finite and not negative".to_owned(),
            value: self.seconds.to_string(),
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the count of frames from rounding.
    #[test]
    fn frames_cover_the_time() {
        let frames = |seconds, fps| Timing { seconds, fps }.frames();
        assert_eq!(frames(1.0, 30.0), 30);
        assert_eq!(frames(0.1, 30.0), 3);
        assert_eq!(frames(1.01, 30.0), 31);
        assert_eq!(frames(4.0, 29.97), 120);
        assert_eq!(frames(0.0, 30.0), 0);
    }
}
