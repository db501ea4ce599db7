//! Audio output: turns a mono sound and one pan per video frame into two channels.
//!
//! This module is the third part of the thesis (P. Sjöberg, 2011, section 3.2.4). It needs neither a graphics card nor
//! a sound card. A [`Sound`] fills a mono slice, a [`Mixer`] turns that slice into an interleaved stereo slice (left,
//! right, left, right, …), and a player or a [`WavWriter`] outputs the stereo slice.
//!
//! # Theory
//! The tracer returns one *pan* for each video frame, −1 for all left and +1 for all right. A [`PanningLaw`] turns the
//! pan into two amplitude [`Gains`], one for each channel, which multiply every sample of the frame. With the linear
//! law the two gains always sum to one: this is the thesis' "equal level". With the constant-power law their squares
//! sum to one, which keeps the loudness constant for a listener whose ears receive the channels incoherently.
//!
//! # Differences from the thesis
//! The thesis applies a new pan at once, so the gains step at each frame boundary, which is audible as a click. Here
//! the gains *glide*: they run linearly from the last frame's gains to this frame's gains over the block, so that the
//! output is continuous and the pan is reached on the last sample of its frame. The disadvantage is that a pan takes
//! effect up to one frame late. The constant-power law is an addition; the thesis has only the linear law.
//!
//! # Cost
//! [`Sound::fill`] and [`Mixer`] do not allocate and take constant time per sample, so an audio thread may call them. A
//! WAV clip is mixed to mono and resampled once, when it is loaded, and is held in memory as a whole (4 bytes per
//! sample).
//!
//! ```
//! use echomarch::audio::{FrameBlocks, Mixer, PanningLaw, Sound};
//!
//! let mut sound = Sound::parse("sine:440", Sound::SAMPLE_RATE)?;
//! let mut mixer = Mixer::new(PanningLaw::ConstantPower);
//! let frames = FrameBlocks::new(60.0, Sound::SAMPLE_RATE)?;
//! let mut mono = vec![0.0; frames.longest()];
//! let mut stereo = vec![0.0; 2 * frames.longest()];
//! for (i, pan) in [-0.5, 0.0, 0.5].into_iter().enumerate() {
//!     let count = frames.len(i as u64);
//!     sound.fill(&mut mono[..count]);
//!     mixer.mix(&mono[..count], pan, &mut stereo[..2 * count])?;
//! }
//! # Ok::<(), echomarch::audio::AudioError>(())
//! ```

mod error;
#[cfg(feature = "live")]
pub mod live;
mod panning;
mod signals;
mod sound;
mod speech;
mod wav_read;
mod wav_write;

pub use error::AudioError;
pub use panning::{FrameBlocks, Gains, Mixer, PanningLaw};
pub use signals::Signal;
pub use sound::{Sound, SoundSpec, StereoSignal};
pub use wav_write::WavWriter;
#[doc(hidden)]
pub use wav_write::wav_to_io;

/// Protects programs that hand sounds to another thread.
const _: () = {
    const fn may_move<T: Send>() {}
    may_move::<Sound>();
    #[cfg(feature = "live")]
    may_move::<live::SoundSource>();
    may_move::<Mixer>();
    may_move::<WavWriter>();
};

/// Rejects an unsupported sample rate.
fn check_rate(sample_rate_hz: u32) -> Result<(), AudioError> {
    if Sound::SAMPLE_RATES.contains(&sample_rate_hz) {
        Ok(())
    } else {
        Err(AudioError::BadSampleRate { sample_rate_hz })
    }
}
