//! A scene to sound without a sound card: frame after frame, traced and played.
//!
//! [`render`] is the thesis' way: a frame's panning is what the gains of one sound glide to by the end
//! of the frame's block of samples. [`render_full`] plays each source as it is heard: delays, loudness,
//! echoes, reverberation ([`auralisation`](crate::auralisation)). Each frame is traced with the scene as
//! it stands at the frame's start.

mod balance;
mod full_listening;

pub use balance::{Block, render};
pub use full_listening::{FullBlock, FullSettings, render_full};

use crate::audio::SAMPLE_RATE;
use crate::error::Error;
use crate::trace::TraceError;

/// How long, and at how many frames a second.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Timing {
    /// Seconds of sound.
    pub seconds: f64,
    /// Frames a second.
    pub fps: f64,
}

impl Timing {
    /// So many seconds of sound at so many frames a second.
    pub fn new(seconds: f64, fps: f64) -> Timing {
        Timing { seconds, fps }
    }

    /// Number of frames: the last one is cut at the end of the time.
    pub fn frames(&self) -> u64 {
        // A share of a frame below this is rounding, not time: at 1000 frames a second
        // it is far below one sample.
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
