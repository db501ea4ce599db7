//! Plays a source as the listener hears it: with delays, loudness, echoes and reverberation.
//!
//! A [`Response`](crate::response::Response) describes the arriving sound. [`Heard`] is made from it, on any thread:
//! the strongest exact paths as single echoes, everything else as a kernel. An [`Auralisation`] applies this to a
//! source's own sound and outputs two channels. It runs on a thread that must not wait, so it never allocates or locks.
//!
//! # Method
//! - **Echoes**, including the direct sound, are read from a delay line at fractional delays, each with an amplitude
//!   for each band and channel (panned with constant power). When source, listener or surfaces move, delays and
//!   amplitudes run linearly to their next values. This avoids clicks, and a moving source is heard with its Doppler
//!   shift. An echo fades instead if its delay would change by more than a fifth of the elapsed time, or if its path is
//!   replaced by another path.
//! - **The late part** is convolved in blocks and fades to the next kernel. Both kernels are made from the same noise,
//!   so that a fade between similar kernels is inaudible.
//! - **Bands**: if materials or the air change the timbre, zero-phase filters split the sound into octave bands once
//!   for all echoes. Otherwise there is one band and no filter.
//!
//! Amplitudes are the same as in [`ImpulseResponse`](crate::response::ImpulseResponse): the direct sound of a source at
//! 1 m equals the source's sound. The output is delayed by [`Auralisation::latency`] samples.
//!
//! ```
//! use echomarch::auralisation::{Auralisation, Heard, Spec};
//! use echomarch::response::ListenerAxes;
//! use echomarch::gl::{Context, ContextOptions};
//! use echomarch::response::{Response, ResponseSettings};
//! use echomarch::{Scene, Tracer};
//!
//! let scene = Scene::builtin("open-field")?;
//! let mut tracer = Tracer::new(&Context::headless(&ContextOptions::default())?)?;
//! let settings = ResponseSettings::default().with_seconds(0.1);
//! let response = Response::trace(&mut tracer, &scene, &settings)?;
//!
//! let spec = Spec::of(&scene, 48_000);
//! let axes = ListenerAxes::of(&scene.listeners[0])?;
//! let mut heard = Heard::new(&response, &axes, spec, 1)?;
//! let mut ears = Auralisation::new(spec)?;
//! ears.glide_echoes(&heard, 0)?;
//! ears.glide_late(&mut heard, 0)?;
//! let mut stereo = [0.0; 2 * 4800];
//! ears.add(&[0.5; 4800], &mut stereo)?;
//! assert!(stereo.iter().any(|sample| *sample != 0.0));
//! # Ok::<(), echomarch::Error>(())
//! ```

mod convolution;
mod delay_line;
mod echoes;
mod heard_source;
mod player;
mod prepared_sound;
#[cfg(test)]
mod tests;

pub use heard_source::{HeardKind, HeardSource};
pub use player::{Player, PlayerRemote};
pub use prepared_sound::Heard;
#[doc(hidden)]
pub use prepared_sound::HeardParts;

use crate::bands::BAND_COUNT;
use crate::response::{ImpulseSettings, ResponseError};
use crate::scene::Scene;
use crate::tracer::Profile;
use convolution::{BLOCK, FILTER_DELAY, FILTER_PARTITIONS, Kernel, Signal, octave_filters};
use delay_line::REACH;
use echoes::Echoes;

/// Left and right.
const CHANNELS: usize = 2;

/// Default length of the longest response in seconds: the reverberation time of a large hall.
const USUAL_LONGEST_S: f64 = 3.0;

/// A listening mode. Names, for `FromStr` and `Display`: `full`, `balance`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[doc(hidden)]
pub enum Listen {
    /// Loudness, delays, echoes, reverberation.
    Full,
    /// Only the balance of left and right, as in the thesis: one pan, at constant loudness.
    Balance,
}

impl Listen {
    /// The default listening mode of an algorithm: waves of the thesis' algorithm end at the listener and give only a
    /// balance.
    pub fn for_profile(profile: Profile) -> Listen {
        match profile {
            Profile::Thesis => Listen::Balance,
            _ => Listen::Full,
        }
    }
}

named_values!(Listen, "way to listen": Full = "full", Balance = "balance");

/// The format of an [`Auralisation`] and its [`Heard`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Spec {
    /// Samples per second, in [`ImpulseSettings::RATES_HZ`].
    pub rate_hz: u32,
    /// Whether the sound is split into octave bands, which is required if materials or the air change the timbre.
    pub has_bands: bool,
    /// Maximum length of the response in seconds, above 0, at most [`ImpulseSettings::MAX_SECONDS`]: memory and work
    /// grow with it.
    pub longest_s: f64,
}

impl Spec {
    /// The format for a scene at a sampling rate in hertz. Its numbers are checked where a player or a [`Heard`] is
    /// created.
    pub fn of(scene: &Scene, rate_hz: u32) -> Spec {
        Spec {
            rate_hz,
            has_bands: scene.has_bands(),
            longest_s: USUAL_LONGEST_S,
        }
    }

    /// Splits the sound into octave bands if it bends around obstacles (`diffraction`): they dull it, even if no material
    /// changes the timbre.
    #[must_use]
    pub fn with_diffraction(mut self, diffraction: bool) -> Spec {
        self.has_bands |= diffraction;
        self
    }

    /// Sets the length of the longest response, in seconds.
    #[must_use]
    pub fn with_longest(mut self, seconds: f64) -> Spec {
        self.longest_s = seconds;
        self
    }

    /// Checks both numbers against their ranges.
    ///
    /// # Errors
    /// [`ResponseError::BadRate`] and [`ResponseError::BadLength`].
    pub fn validate(self) -> Result<(), ResponseError> {
        let (rate_hz, seconds) = (self.rate_hz, self.longest_s);
        if !ImpulseSettings::RATES_HZ.contains(&rate_hz) {
            return Err(ResponseError::BadRate { rate_hz });
        }
        if !(seconds > 0.0 && seconds <= ImpulseSettings::MAX_SECONDS) {
            return Err(ResponseError::BadLength { seconds });
        }
        Ok(())
    }

    /// Checks that `heard` was made for this format; a silent `heard` fits every format.
    fn check(self, heard: &Heard) -> Result<(), ResponseError> {
        match heard.spec {
            Some(other) if other != self => Err(ResponseError::OtherSpec {
                heard_hz: other.rate_hz,
                heard_s: other.longest_s,
                played_hz: self.rate_hz,
                played_s: self.longest_s,
            }),
            _ => Ok(()),
        }
    }

    /// Delay of the output by the band filters, in samples.
    fn filter_delay(self) -> usize {
        if self.has_bands { FILTER_DELAY } else { 0 }
    }

    /// Length of the longest response in samples.
    fn longest(self) -> usize {
        (self.longest_s * f64::from(self.rate_hz)).ceil() as usize
    }
}

/// Plays the sound of one source as heard by the listener.
#[derive(Debug)]
pub struct Auralisation {
    spec: Spec,
    signal: Signal,
    echoes: Bank,
    late: Kernel,
    /// The target of the current fade.
    next: Option<Fade>,
    /// The kernel before the last fade. Another thread frees it.
    retired: Kernel,
    /// The block being filled, and the number of samples in it.
    input: [f32; BLOCK],
    filled: usize,
    /// The output that is played while the next block is filled.
    output: [[f32; BLOCK]; CHANNELS],
}

/// The echoes, with one band or with all bands.
#[derive(Debug)]
enum Bank {
    Grey(Echoes<1>),
    Bands {
        filters: Kernel,
        bands: Box<[[f32; BLOCK]; BAND_COUNT]>,
        echoes: Echoes<BAND_COUNT>,
    },
}

#[derive(Debug)]
struct Fade {
    to: Kernel,
    /// Progress in samples.
    done: u32,
    length: u32,
}

impl Fade {
    /// Weight of the fade's target at sample `index` of the next block.
    fn share(&self, index: usize) -> f32 {
        let done = self.done.saturating_add(index as u32 + 1);
        done.min(self.length) as f32 / self.length as f32
    }
}

impl Auralisation {
    /// Creates a silent player. At 48 kHz it takes about 0.7 MiB per second of response, or 3 MiB with bands.
    ///
    /// # Errors
    /// [`ResponseError::BadRate`] for a rate outside [`ImpulseSettings::RATES_HZ`], and [`ResponseError::BadLength`]
    /// unless the seconds are above 0 and at most [`ImpulseSettings::MAX_SECONDS`].
    pub fn new(spec: Spec) -> Result<Auralisation, ResponseError> {
        spec.validate()?;
        let longest = spec.longest();
        let partitions = (longest + spec.filter_delay() + REACH).div_ceil(BLOCK);
        let echoes = match spec.has_bands {
            false => Bank::Grey(Echoes::new(longest)),
            true => Bank::Bands {
                filters: octave_filters(spec.rate_hz),
                bands: Box::new([[0.0; BLOCK]; BAND_COUNT]),
                echoes: Echoes::new(longest),
            },
        };
        Ok(Auralisation {
            spec,
            signal: Signal::new(partitions.max(FILTER_PARTITIONS)),
            echoes,
            late: Kernel::default(),
            next: None,
            retired: Kernel::default(),
            input: [0.0; BLOCK],
            filled: 0,
            output: [[0.0; BLOCK]; CHANNELS],
        })
    }

    /// The format of this player.
    pub fn spec(&self) -> Spec {
        self.spec
    }

    /// Delay of the output in samples: one block, because a block must be filled before it is processed, and the reach
    /// of the filters.
    pub fn latency(&self) -> usize {
        BLOCK + REACH + self.spec.filter_delay()
    }

    /// Glides to the single echoes of `heard` within `samples` samples, from the next block on; 0 switches at once.
    /// Does not allocate.
    ///
    /// # Errors
    /// [`ResponseError::OtherSpec`] if `heard` was made for another rate or length: then nothing changes.
    pub fn glide_echoes(&mut self, heard: &Heard, samples: u32) -> Result<(), ResponseError> {
        self.spec.check(heard)?;
        match &mut self.echoes {
            Bank::Grey(echoes) => echoes.glide_to(&heard.echoes, samples),
            Bank::Bands { echoes, .. } => echoes.glide_to(&heard.echoes, samples),
        }
        Ok(())
    }

    /// Takes the late part of `heard`, if it has one, and fades to it within `samples` samples, from the next block on.
    /// The kernel that is no longer needed is stored in `heard` instead. Returns false and changes nothing while a fade
    /// is in progress. Neither allocates nor frees.
    ///
    /// # Errors
    /// [`ResponseError::OtherSpec`] if `heard` was made for another rate or length: then nothing changes.
    pub fn glide_late(&mut self, heard: &mut Heard, samples: u32) -> Result<bool, ResponseError> {
        self.spec.check(heard)?;
        if self.next.is_some() {
            return Ok(false);
        }
        let Some(kernel) = &mut heard.late else {
            return Ok(true);
        };
        if samples == 0 {
            std::mem::swap(&mut self.late, kernel);
            return Ok(true);
        }
        let to = std::mem::replace(kernel, std::mem::take(&mut self.retired));
        self.next = Some(Fade {
            to,
            done: 0,
            length: samples,
        });
        Ok(true)
    }

    /// Adds the response to the next samples of the source's sound to the interleaved samples of both channels. A
    /// sample that is not finite counts as 0, because its effect would last as long as the response. Does not allocate.
    ///
    /// # Errors
    /// [`ResponseError::BadStereoLength`] if `stereo` is not twice as long as `mono`: then the player does not
    /// advance.
    pub fn add(&mut self, mono: &[f32], stereo: &mut [f32]) -> Result<(), ResponseError> {
        if stereo.len() / CHANNELS != mono.len() || !stereo.len().is_multiple_of(CHANNELS) {
            let (mono, stereo) = (mono.len(), stereo.len());
            return Err(ResponseError::BadStereoLength { mono, stereo });
        }
        let (pairs, _) = stereo.as_chunks_mut::<CHANNELS>();
        for (sample, pair) in mono.iter().zip(pairs) {
            for (out, channel) in pair.iter_mut().zip(&self.output) {
                *out += channel[self.filled];
            }
            self.input[self.filled] = if sample.is_finite() { *sample } else { 0.0 };
            self.filled += 1;
            if self.filled == BLOCK {
                self.render();
                self.filled = 0;
            }
        }
        Ok(())
    }

    /// Computes the late part of the output for the full block.
    fn render_late(&mut self) {
        for (channel, out) in self.output.iter_mut().enumerate() {
            self.signal.convolve(&self.late, channel, out);
        }
        let Some(mut fade) = self.next.take() else {
            return;
        };
        let mut other = [0.0; BLOCK];
        for (channel, out) in self.output.iter_mut().enumerate() {
            self.signal.convolve(&fade.to, channel, &mut other);
            for (index, (out, other)) in out.iter_mut().zip(&other).enumerate() {
                *out += (other - *out) * fade.share(index);
            }
        }
        fade.done = fade.done.saturating_add(BLOCK as u32);
        if fade.done < fade.length {
            self.next = Some(fade);
            return;
        }
        self.retired = std::mem::replace(&mut self.late, fade.to);
    }

    /// Computes the output for the full block.
    fn render(&mut self) {
        self.signal.push(&self.input);
        self.render_late();
        match &mut self.echoes {
            Bank::Grey(echoes) => echoes.render(&[&self.input], &mut self.output),
            Bank::Bands {
                filters,
                bands,
                echoes,
            } => {
                for (band, samples) in bands.iter_mut().enumerate() {
                    self.signal.convolve(filters, band, samples);
                }
                echoes.render(&bands.each_ref().map(|band| &band[..]), &mut self.output);
            }
        }
    }
}
