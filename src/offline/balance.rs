//! The thesis' method: the gains of one sound glide to a frame's panning by the end of the frame's block of samples.

use super::Timing;
use crate::audio::{FrameBlocks, Mixer, SAMPLE_RATE, Sound};
use crate::error::Error;
use crate::scene::Scene;
use crate::trace::{Frame, Settings, Tracer};

/// One frame's part of the sound.
#[derive(Debug)]
#[non_exhaustive]
pub struct Block<'a> {
    /// Number of the frame, from 0.
    pub index: u64,
    /// Start time in seconds.
    pub time: f64,
    /// The traced frame.
    pub frame: &'a Frame,
    /// Interleaved left and right samples, at [`SAMPLE_RATE`].
    pub samples: &'a [f32],
}

/// Traces and mixes `timing.seconds` of `sound` in a moving scene and passes each frame's block to
/// `take`.
///
/// # Errors
/// [`Error::Trace`] for seconds that are not finite, [`Error::Audio`] for an invalid frame rate,
/// those of [`Tracer::frame`], and any error that `take` returns.
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
        let pan = frame.panning.pan() as f32;
        mixer.mix(mono, pan, stereo).map_err(Error::from)?;
        take(Block {
            index,
            time,
            frame: &frame,
            samples: stereo,
        })?;
    }
    Ok(())
}
