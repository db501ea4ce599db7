//! Renders the sound of a scene frame by frame, without a sound card.
//!
//! [`render`] uses the thesis' method: during a frame's block of samples, the gains of one sound glide to the panning
//! of the frame. [`render_full`] plays each source with delays, loudness, echoes and reverberation
//! ([`auralisation`](crate::auralisation)). Each frame is traced with the scene at the frame's start.

use crate::audio::{AudioError, FrameBlocks, Mixer, Sound};
use crate::auralisation::{Auralisation, Heard, Spec};
use crate::error::Error;
use crate::response::{HeardSource, ListenerAxes, Response, ResponseSettings};
use crate::scene::{IntoPair, Pair, Scene};
use crate::tracer::{Frame, Settings, TraceError, Tracer};

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

    /// Number of frames. The last frame is cut at the end of the duration.
    pub fn frames(&self) -> u64 {
        // Smaller fractions of a frame are rounding errors: at 1000 frames per second this fraction is far below one
        // sample.
        const ROUNDING: f64 = 1e-6;
        (self.seconds * self.fps - ROUNDING).ceil().max(0.0) as u64
    }

    /// Samples of each channel.
    fn samples(&self) -> u64 {
        (self.seconds * f64::from(Sound::SAMPLE_RATE)).round() as u64
    }

    /// The number of samples of the longest block, and the number, the start time in seconds and the number of samples
    /// of each frame.
    fn blocks(self) -> Result<(usize, impl Iterator<Item = (u64, f64, usize)>), Error> {
        let blocks = FrameBlocks::new(self.fps, Sound::SAMPLE_RATE)?;
        let (longest, end) = (blocks.longest(), self.samples());
        let block = move |index| {
            let range = blocks.samples(index);
            let length = range.end.min(end).saturating_sub(range.start);
            (index, index as f64 / self.fps, length as usize)
        };
        Ok((longest, (0..self.frames()).map(block)))
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

/// One frame's part of the sound. `Of` is the traced result that the samples were made from: one [`Frame`]
/// ([`render`]), or each source as the listener hears it ([`render_full`]).
#[derive(Debug)]
#[non_exhaustive]
pub struct Block<'a, Of: ?Sized> {
    /// Number of the frame, from 0.
    pub index: u64,
    /// Start time in seconds.
    pub time: f64,
    /// The traced result that the samples were made from.
    pub heard: &'a Of,
    /// Interleaved left and right samples, at [`Sound::SAMPLE_RATE`].
    pub samples: &'a [f32],
}

/// Traces and mixes `timing.seconds` of `sound` from a source to a listener of a moving scene, and passes each frame's
/// block to `take`.
///
/// # Errors
/// [`Error::Trace`] for seconds that are not finite, [`Error::Audio`] for an invalid frame rate, the errors of
/// [`Tracer::frame`], and any error that `take` returns.
pub fn render<'a, E: From<Error>>(
    tracer: &mut Tracer,
    pair: impl IntoPair<'a>,
    settings: &Settings,
    sound: &mut Sound,
    mixer: &mut Mixer,
    timing: Timing,
    mut take: impl FnMut(Block<Frame>) -> Result<(), E>,
) -> Result<(), E> {
    let pair = pair.chosen().map_err(Error::from)?;
    let (source, listener) = pair.indices();
    timing.check()?;
    let (longest, blocks) = timing.blocks()?;
    let mut mono = vec![0.0; longest];
    let mut stereo = vec![0.0; 2 * longest];
    for (index, time, length) in blocks {
        let now = pair.scene.at(time);
        let pair = now.pair(source, listener).map_err(Error::from)?;
        let frame = tracer.frame(pair, settings);
        let frame = frame.map_err(|error| error.at(time))?;
        let (mono, stereo) = (&mut mono[..length], &mut stereo[..2 * length]);
        sound.fill(mono);
        let pan = frame.panning.pan() as f32;
        mixer.mix(mono, pan, stereo).map_err(Error::from)?;
        take(Block {
            index,
            time,
            heard: &frame,
            samples: stereo,
        })?;
    }
    Ok(())
}

/// Seconds between two updates of the late part. Reverberation changes more slowly than echoes, and the computation of
/// its kernel takes as long as several frames.
const LATE_S: f64 = 0.25;

/// Samples between the end of a fade and the next update of the late part, because blocks of the convolution do not end
/// at frame boundaries.
const FADE_MARGIN: u32 = 2048;

/// Number of times, from the start to the end of the scene's paths, at which the length of the responses is estimated.
const MOMENTS: u32 = 3;

/// The longest response by default, in seconds. Later reverberation is hardly audible behind continuous sound.
const LONGEST_S: f64 = 3.0;

/// Settings of full listening to a scene.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct FullSettings {
    /// Settings of each response. If `seconds` is `None`, all responses have the longest of the lengths needed at the
    /// start, the middle and the end of the scene's paths.
    pub response: ResponseSettings,
    /// Index of the listener in [`Scene::listeners`], from 0.
    pub listener: usize,
    /// Seed for the noise of the late parts.
    pub seed: u64,
}

impl FullSettings {
    /// Settings for a listener, by its index. If `response` sets no length, responses last at most 3 seconds, or at
    /// most `response.longest_s` if that is shorter.
    pub fn new(response: ResponseSettings, listener: usize) -> FullSettings {
        let longest_s = response.longest_s.min(LONGEST_S);
        FullSettings {
            response: response.with_longest(longest_s),
            listener,
            seed: 0,
        }
    }

    /// Sets the length of the responses in seconds.
    #[must_use]
    pub fn with_tail(mut self, seconds: f64) -> FullSettings {
        self.response.seconds = Some(seconds);
        self
    }

    /// The length of the responses, in seconds.
    ///
    /// # Errors
    /// The errors of [`Response::trace`].
    pub fn tail_s(&self, tracer: &mut Tracer, scene: &Scene) -> Result<f64, Error> {
        if let Some(seconds) = self.response.seconds {
            return Ok(seconds);
        }
        let moments = if scene.duration() > 0.0 { MOMENTS } else { 1 };
        let mut longest: f64 = 0.0;
        for moment in 0..moments {
            let time = scene.duration() * f64::from(moment) / f64::from(MOMENTS - 1);
            let now = scene.at(time);
            for source in 0..scene.sources.len() {
                let pair = now.pair(source, self.listener)?;
                longest = longest.max(self.response.seconds_needed(tracer, pair)?);
            }
        }
        Ok(longest)
    }
}

/// One source: its sound and its current state.
struct Playing<'a> {
    sound: &'a mut Sound,
    ears: Auralisation,
    response: Option<Response>,
    /// A late part that waits for the previous fade to end.
    late: Option<Heard>,
    heard: HeardSource,
}

/// Traces and plays `timing.seconds` of a moving scene, with one of `sounds` for each source. Each frame's block is
/// passed to `take`, with each source as the listener hears it, in the scene's order. Echoes are updated with each
/// frame, the late part every quarter of a second. A source is traced again only when the source, the listener or a
/// surface has changed.
///
/// # Errors
/// [`Error::Trace`] for settings out of range, [`Error::Audio`] for an invalid frame rate, the errors of
/// [`Response::trace`], and any error that `take` returns; [`Error::Scene`] if there is no such listener,
/// [`Error::Audio`] if the number of sounds differs from the number of sources.
pub fn render_full<E: From<Error>>(
    tracer: &mut Tracer,
    scene: &Scene,
    settings: &FullSettings,
    sounds: &mut [Sound],
    timing: Timing,
    mut take: impl FnMut(Block<[HeardSource]>) -> Result<(), E>,
) -> Result<(), E> {
    timing.check()?;
    let (given, sources) = (sounds.len(), scene.sources.len());
    if given != sources {
        return Err(Error::from(AudioError::NotASoundEach { given, sources }).into());
    }
    let (longest, blocks) = timing.blocks()?;
    let seconds = settings.tail_s(tracer, scene)?;
    let settings = settings.clone().with_tail(seconds);
    let spec = Spec::of(scene, Sound::SAMPLE_RATE).with_longest(seconds);
    let mut sources: Vec<Playing> = sounds
        .iter_mut()
        .map(|sound| Playing::new(sound, spec))
        .collect::<Result<_, _>>()?;
    let mut stereo = vec![0.0; 2 * longest];
    let mut mono = vec![0.0; longest];
    let mut heard = Vec::with_capacity(sources.len());
    let mut before: Option<Scene> = None;
    for (index, time, length) in blocks {
        let late_is_due = index == 0 || is_due(time, time - 1.0 / timing.fps);
        let now = scene.at(time);
        let (mono, stereo) = (&mut mono[..length], &mut stereo[..2 * length]);
        stereo.fill(0.0);
        heard.clear();
        for (number, source) in sources.iter_mut().enumerate() {
            let pair = |scene| Scene::pair(scene, number, settings.listener);
            let before = before.as_ref().map(pair).transpose();
            let pairs = (
                before.map_err(Error::from)?,
                pair(&now).map_err(Error::from)?,
            );
            source
                .listen(tracer, pairs, &settings, late_is_due, length as u32)
                .map_err(|error| error.at(time))?;
            source.sound.fill(mono);
            source.ears.add(mono, stereo).map_err(Error::from)?;
            heard.push(source.heard);
        }
        take(Block {
            index,
            time,
            heard: &heard,
            samples: stereo,
        })?;
        before = Some(now);
    }
    Ok(())
}

/// Whether a quarter of a second has begun since the previous frame.
fn is_due(time: f64, before: f64) -> bool {
    (time / LATE_S).floor() > (before / LATE_S).floor()
}

impl<'a> Playing<'a> {
    fn new(sound: &'a mut Sound, spec: Spec) -> Result<Playing<'a>, Error> {
        Ok(Playing {
            sound,
            ears: Auralisation::new(spec)?,
            response: None,
            late: None,
            heard: HeardSource::default(),
        })
    }

    /// Glides to the response of a pair over the given number of samples; `before` is the pair in the previous frame.
    fn listen(
        &mut self,
        tracer: &mut Tracer,
        (before, pair): (Option<Pair>, Pair),
        settings: &FullSettings,
        late_is_due: bool,
        samples: u32,
    ) -> Result<(), Error> {
        let is_first = before.is_none();
        let axes = ListenerAxes::of(pair.listener)?;
        if before != Some(pair) {
            let response = Response::trace(tracer, pair, &settings.response)?;
            self.heard = HeardSource::of(&response);
            let echoes = Heard::of_paths(&response.paths, &axes, self.ears.spec())?;
            self.ears
                .glide_echoes(&echoes, if is_first { 0 } else { samples })?;
            self.response = Some(response);
        }
        if late_is_due {
            self.make_late(&axes, settings)?;
        }
        if is_first {
            return self.begin();
        }
        self.fade_late()
    }

    /// Computes the late part from the last response if this response has not been used yet.
    fn make_late(&mut self, axes: &ListenerAxes, settings: &FullSettings) -> Result<(), Error> {
        let Some(response) = self.response.take() else {
            return Ok(());
        };
        let heard = Heard::new(&response, axes, self.ears.spec(), settings.seed)?;
        self.late = Some(heard);
        Ok(())
    }

    /// Applies the first late part without a fade, and skips the latency.
    fn begin(&mut self) -> Result<(), Error> {
        if let Some(late) = &mut self.late {
            self.ears.glide_late(late, 0)?;
        }
        self.late = None;
        let ahead = self.ears.latency();
        let mut mono = vec![0.0; ahead];
        self.sound.fill(&mut mono);
        Ok(self.ears.add(&mono, &mut vec![0.0; 2 * ahead])?)
    }

    fn fade_late(&mut self) -> Result<(), Error> {
        let samples = (LATE_S * f64::from(Sound::SAMPLE_RATE)) as u32 - FADE_MARGIN;
        let Some(late) = &mut self.late else {
            return Ok(());
        };
        if self.ears.glide_late(late, samples)? {
            self.late = None;
        }
        Ok(())
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
