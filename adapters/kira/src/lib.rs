//! Plays what is heard of the sources of an [`echomarch::simulator`] through [kira](https://docs.rs/kira).
//!
//! [`Heard`] is an effect for a track: everything that the track plays is the sound of one source. [`World`] is a sound:
//! the mix of all sources, whose samples a function of the game fills. Neither allocates, frees nor locks while it plays.
//! Both must have the sampling rate of the backend.

use echomarch::simulator::{Ears, Mix, SourceId};
use kira::Frame;
use kira::effect::{Effect, EffectBuilder};
use kira::info::Info;
use kira::sound::{Sound, SoundData};
use std::convert::Infallible;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Frames that are processed at once.
const CHUNK: usize = 128;

/// An effect on a track: plays the track as the sound of a source, at the listener of the simulator.
pub struct Heard {
    ears: Ears,
    mono: [f32; CHUNK],
    stereo: [f32; 2 * CHUNK],
}

impl Heard {
    /// The effect of a source's ears, which must have the sampling rate of the backend.
    pub fn new(ears: Ears) -> Heard {
        Heard {
            ears,
            mono: [0.0; CHUNK],
            stereo: [0.0; 2 * CHUNK],
        }
    }
}

impl EffectBuilder for Heard {
    type Handle = ();

    fn build(self) -> (Box<dyn Effect>, ()) {
        (Box::new(self), ())
    }
}

impl Effect for Heard {
    fn process(&mut self, input: &mut [Frame], _dt: f64, _info: &Info) {
        for frames in input.chunks_mut(CHUNK) {
            let count = frames.len();
            for (mono, frame) in self.mono.iter_mut().zip(&*frames) {
                *mono = 0.5 * (frame.left + frame.right);
            }
            let stereo = &mut self.stereo[..2 * count];
            if self.ears.process(&self.mono[..count], stereo).is_err() {
                stereo.fill(0.0);
            }
            write(stereo, frames);
        }
    }
}

fn write(stereo: &[f32], frames: &mut [Frame]) {
    for (frame, [left, right]) in frames.iter_mut().zip(stereo.as_chunks::<2>().0) {
        *frame = Frame::new(*left, *right);
    }
}

/// A sound: the mix of all sources of a simulator. Played by `AudioManager::play`, it goes on until its handle is
/// dropped.
pub struct World<F> {
    mix: Mix,
    fill: F,
}

impl<F: FnMut(SourceId, &mut [f32]) + Send + 'static> World<F> {
    /// The sound of a mix, which must have the sampling rate of the backend. `fill` writes the next samples of a source;
    /// they are silent before. It is called on the audio thread, so it must not wait.
    pub fn new(mix: Mix, fill: F) -> World<F> {
        World { mix, fill }
    }
}

/// Ends its [`World`] when it is dropped.
#[derive(Debug)]
pub struct WorldHandle {
    is_dropped: Arc<AtomicBool>,
}

impl Drop for WorldHandle {
    fn drop(&mut self) {
        self.is_dropped.store(true, Ordering::Relaxed);
    }
}

impl<F: FnMut(SourceId, &mut [f32]) + Send + 'static> SoundData for World<F> {
    type Error = Infallible;
    type Handle = WorldHandle;

    fn into_sound(self) -> Result<(Box<dyn Sound>, WorldHandle), Infallible> {
        let is_dropped = Arc::new(AtomicBool::new(false));
        let playing = Playing {
            world: self,
            stereo: [0.0; 2 * CHUNK],
            is_dropped: Arc::clone(&is_dropped),
        };
        Ok((Box::new(playing), WorldHandle { is_dropped }))
    }
}

/// A [`World`] on the audio thread.
struct Playing<F> {
    world: World<F>,
    stereo: [f32; 2 * CHUNK],
    is_dropped: Arc<AtomicBool>,
}

impl<F: FnMut(SourceId, &mut [f32]) + Send> Sound for Playing<F> {
    fn process(&mut self, out: &mut [Frame], _dt: f64, _info: &Info) {
        for frames in out.chunks_mut(CHUNK) {
            let stereo = &mut self.stereo[..2 * frames.len()];
            self.world.mix.process(stereo, &mut self.world.fill);
            write(stereo, frames);
        }
    }

    fn finished(&self) -> bool {
        self.is_dropped.load(Ordering::Relaxed)
    }
}
