//! Renders the sound of a scene frame by frame, without a sound card.
//!
//! [`render`] uses the thesis' method: during a frame's block of samples, the gains of one sound glide to the panning
//! of the frame. [`render_full`] plays each source with delays, loudness, echoes and reverberation
//! ([`auralisation`](crate::auralisation)). Each frame is traced with the scene at the frame's start; responses are
//! renewed at most ten times a second, and only where something has changed.

mod renewal;

use crate::audio::{AudioError, FrameBlocks, Mixer, Sound};
use crate::auralisation::{Auralisation, Heard, HeardSource, Spec};
use crate::error::Error;
use crate::response::{ListenerAxes, Response, ResponseSettings};
use crate::scene::{IntoPair, Scene};
use crate::tracer::{Frame, Settings, TraceError, Tracer};
use renewal::{Renewal, Slots};
use std::rc::Rc;

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

/// Renewals of a response in a second by default. Delays and levels glide between them (docs/audio.md has the
/// differences from a response in each frame).
const RESPONSES_HZ: f64 = 10.0;

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
    /// Maximum number of renewals of a response in a second, above 0: 10 by default.
    pub responses_per_second: f64,
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
            responses_per_second: RESPONSES_HZ,
        }
    }

    /// Sets the length of the responses in seconds.
    #[must_use]
    pub fn with_tail(mut self, seconds: f64) -> FullSettings {
        self.response.seconds = Some(seconds);
        self
    }

    /// The checked number of responses in a second.
    fn responses_hz(&self) -> Result<f64, Error> {
        let value = self.responses_per_second;
        if value.is_finite() && value > 0.0 {
            return Ok(value);
        }
        Err(Error::from(TraceError::BadSetting {
            what: "responses in a second",
            must: "finite and above 0".to_owned(),
            value: value.to_string(),
        }))
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
    /// The last response, until its late part is made, and the listener's axes.
    response: Option<(Response, ListenerAxes)>,
    /// A late part that waits for the previous fade to end.
    late: Option<Heard>,
    /// The source at the start of the current slot of frames, and at its end.
    heard: HeardSource,
    next: HeardSource,
    renewal: Renewal,
}

/// Traces and plays `timing.seconds` of a moving scene, with one of `sounds` for each source. Each frame's block is
/// passed to `take`, with each source as the listener hears it, in the scene's order.
///
/// Responses are renewed in slots of whole frames, at most `settings.responses_per_second` times a second. The response
/// of the end of a slot is traced at its start, and the echoes glide to it during the slot, so that they do not lag. A
/// response is renewed only if the source or the listener has moved by 2 cm or turned by 1° since its last response, or a
/// surface, a material or the air has changed. The late part follows every quarter of a second. The frames of a slot
/// state the source at the slot's start.
///
/// # Errors
/// [`Error::Trace`] for settings out of range, [`Error::Audio`] for an invalid frame rate, the errors of
/// [`Response::trace`], and any error that `take` returns; [`Error::Scene`] if there is no such listener,
/// [`Error::Audio`] if the number of sounds differs from the number of sources.
/// [`Error::Trace`] if the responses in a second are not finite and above 0.
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
    let spec = Spec::of(scene, Sound::SAMPLE_RATE)
        .with_diffraction(settings.response.diffraction)
        .with_longest(seconds);
    let mut sources: Vec<Playing> = sounds
        .iter_mut()
        .map(|sound| Playing::new(sound, spec))
        .collect::<Result<_, _>>()?;
    let mut stereo = vec![0.0; 2 * longest];
    let mut mono = vec![0.0; longest];
    let mut heard = Vec::with_capacity(sources.len());
    let slots = Slots::new(settings.responses_hz()?, timing.fps, timing.frames());
    for (index, time, length) in blocks {
        if index == 0 {
            let now = Rc::new(scene.at(time));
            for (number, source) in sources.iter_mut().enumerate() {
                let began = source.begin(tracer, &now, number, &settings);
                began.map_err(|error| error.at(time))?;
            }
        }
        if slots.begins(index) {
            let end_s = slots.end_s(index);
            let end = Rc::new(scene.at(end_s));
            let late_is_due = index > 0 && is_due(time, time - slots.seconds());
            for (number, source) in sources.iter_mut().enumerate() {
                let glide = slots.samples(Sound::SAMPLE_RATE);
                let next = source.listen(tracer, &end, number, &settings, late_is_due, glide);
                next.map_err(|error| error.at(end_s))?;
            }
        }
        let (mono, stereo) = (&mut mono[..length], &mut stereo[..2 * length]);
        stereo.fill(0.0);
        heard.clear();
        for source in &mut sources {
            source.fade_late()?;
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
            next: HeardSource::default(),
            renewal: Renewal::default(),
        })
    }

    /// Renews the response of the source with index `number` if something has changed, and glides to its echoes over
    /// the given number of samples.
    fn renew(
        &mut self,
        tracer: &mut Tracer,
        scene: &Rc<Scene>,
        number: usize,
        settings: &FullSettings,
        samples: u32,
    ) -> Result<(), Error> {
        self.heard = self.next;
        let indices = (number, settings.listener);
        if !self.renewal.is_due(scene, indices)? {
            return Ok(());
        }
        let pair = scene.pair(number, settings.listener)?;
        let axes = ListenerAxes::of(pair.listener)?;
        let response = Response::trace(tracer, pair, &settings.response)?;
        self.next = HeardSource::of(&response);
        let echoes = Heard::of_paths(&response.paths, &axes, self.ears.spec())?;
        self.ears.glide_echoes(&echoes, samples)?;
        self.response = Some((response, axes));
        Ok(())
    }

    /// Glides to the state at the end of a slot of frames.
    fn listen(
        &mut self,
        tracer: &mut Tracer,
        end: &Rc<Scene>,
        number: usize,
        settings: &FullSettings,
        late_is_due: bool,
        samples: u32,
    ) -> Result<(), Error> {
        self.renew(tracer, end, number, settings, samples)?;
        if late_is_due {
            self.make_late(settings)?;
        }
        Ok(())
    }

    /// Computes the late part from the last response if this response has not been used yet.
    fn make_late(&mut self, settings: &FullSettings) -> Result<(), Error> {
        let Some((response, axes)) = self.response.take() else {
            return Ok(());
        };
        let heard = Heard::new(&response, &axes, self.ears.spec(), settings.seed)?;
        self.late = Some(heard);
        Ok(())
    }

    /// Applies the first response without a glide, and skips the latency.
    fn begin(
        &mut self,
        tracer: &mut Tracer,
        scene: &Rc<Scene>,
        number: usize,
        settings: &FullSettings,
    ) -> Result<(), Error> {
        self.renew(tracer, scene, number, settings, 0)?;
        self.make_late(settings)?;
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
