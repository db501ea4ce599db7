//! A scene to sound without a sound card: frame after frame, traced and played.
//!
//! [`render`] is the thesis' way: a frame's panning is what the gains of one sound glide to by the end
//! of the frame's block of samples. [`render_full`] plays each source as it is heard: delays, loudness,
//! echoes, reverberation ([`auralisation`](crate::auralisation)). Each frame is traced with the scene as
//! it stands at the frame's start.

mod full_listening;

pub use full_listening::{FullBlock, FullSettings, HeardSource, render_full};

use crate::audio::{FrameBlocks, Mixer, SAMPLE_RATE, Sound};
use crate::error::Error;
use crate::scene::Scene;
use crate::trace::{Frame, Settings, TraceError, Tracer};

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

    /// Number of frames: the last one is cut where the time is over.
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

/// One frame's share of the sound.
#[derive(Debug)]
#[non_exhaustive]
pub struct Block<'a> {
    /// Number of the frame, from 0.
    pub index: u64,
    /// When it starts, in seconds.
    pub time: f64,
    /// What was traced.
    pub frame: &'a Frame,
    /// Left and right samples in turns, at [`SAMPLE_RATE`].
    pub samples: &'a [f32],
}

/// Traces and mixes `timing.seconds` of `sound` in a moving scene and hands each
/// frame's block to `take`.
///
/// # Errors
/// [`Error::Trace`] for seconds that are not finite, [`Error::Audio`] for a frame rate
/// that makes no sense, those of [`Tracer::frame`],
/// and whatever `take` returns.
pub fn render<E: From<Error>>(
    tracer: &mut Tracer,
    scene: &Scene,
    settings: &Settings,
    sound: &mut Sound,
    mixer: &mut Mixer,
    timing: Timing,
    mut take: impl FnMut(Block) -> Result<(), E>,
) -> Result<(), E> {
    timing.check()?;
    let blocks = FrameBlocks::new(timing.fps, SAMPLE_RATE).map_err(Error::from)?;
    let end = timing.samples();
    let mut mono = vec![0.0; blocks.longest()];
    let mut stereo = vec![0.0; 2 * blocks.longest()];
    for index in 0..timing.frames() {
        let time = index as f64 / timing.fps;
        let frame = tracer.frame(&scene.at(time), settings);
        let frame = frame.map_err(|error| error.at(time))?;
        let range = blocks.samples(index);
        let length = range.end.min(end).saturating_sub(range.start) as usize;
        let (mono, stereo) = (&mut mono[..length], &mut stereo[..2 * length]);
        sound.fill(mono);
        mixer.mix(mono, frame.panning.pan() as f32, stereo);
        take(Block {
            index,
            time,
            frame: &frame,
            samples: stereo,
        })?;
    }
    Ok(())
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
