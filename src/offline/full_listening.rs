//! A moving scene in full: each source with its loudness, delays, echoes and reverberation.

use super::Timing;
use crate::acoustics::ListenerAxes;
use crate::audio::{AudioError, FrameBlocks, SAMPLE_RATE, Sound};
use crate::auralisation::{Auralisation, Heard, Spec};
use crate::error::Error;
use crate::response::{HeardSource, Response, ResponseSettings};
use crate::scene::Scene;
use crate::trace::Tracer;

/// Seconds between two late parts: reverberation changes more slowly than echoes, and its kernel
/// costs as much as several frames.
const LATE_S: f64 = 0.25;

/// Samples between the end of a fade and the next late part: blocks of the convolution do not end
/// at frame borders.
const FADE_MARGIN: u32 = 2048;

/// Number of moments of a path, from its start to its end, at which the length of the responses is estimated.
const MOMENTS: u32 = 3;

/// The longest response by default, in seconds: later sound is hardly audible behind continuous sound.
const LONGEST_S: f64 = 3.0;

/// Settings of full listening to a scene.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct FullSettings {
    /// Settings of each response. Without `seconds`, responses have the greatest length needed at the start, in the
    /// middle and at the end of the scene's path.
    pub response: ResponseSettings,
    /// Index of the listener, from 0 in the order of [`Scene::listeners`].
    pub listener: usize,
    /// Seed for the noise of the late parts.
    pub seed: u64,
}

impl FullSettings {
    /// Settings for the first listener; responses last up to 3 seconds, or as long as `response` states if that is
    /// shorter.
    pub fn new(response: ResponseSettings) -> FullSettings {
        let longest_s = response.longest_s.min(LONGEST_S);
        FullSettings {
            response: response.with_longest(longest_s),
            listener: 0,
            seed: 0,
        }
    }

    /// Sets the length of the responses in seconds.
    pub fn with_tail(mut self, seconds: f64) -> FullSettings {
        self.response.seconds = Some(seconds);
        self
    }

    /// The length of the responses, in seconds.
    ///
    /// # Errors
    /// As [`Response::trace`].
    pub fn tail_s(&self, tracer: &mut Tracer, scene: &Scene) -> Result<f64, Error> {
        if let Some(seconds) = self.response.seconds {
            return Ok(seconds);
        }
        let moments = if scene.duration() > 0.0 { MOMENTS } else { 1 };
        let mut longest: f64 = 0.0;
        for moment in 0..moments {
            let time = scene.duration() * f64::from(moment) / f64::from(MOMENTS - 1);
            let now = scene.at(time);
            for source in 0..scene.sources().count() {
                let pair = now.heard_by(source, self.listener)?;
                longest = longest.max(self.response.seconds_needed(tracer, &pair)?);
            }
        }
        Ok(longest)
    }
}

/// One frame's part of the sound.
#[derive(Debug)]
#[non_exhaustive]
pub struct FullBlock<'a> {
    /// Number of the frame, from 0.
    pub index: u64,
    /// Start time in seconds.
    pub time: f64,
    /// Each source as heard by the listener, in the scene's order.
    pub sources: &'a [HeardSource],
    /// Interleaved left and right samples, at [`SAMPLE_RATE`].
    pub samples: &'a [f32],
}

/// One source: its sound and its current state.
struct Playing<'a> {
    sound: &'a mut Sound,
    ears: Auralisation,
    /// The last traced scene, with this source as its first.
    scene: Option<Scene>,
    response: Option<Response>,
    /// A late part that waits for the previous fade to end.
    late: Option<Heard>,
    heard: HeardSource,
}

/// Traces and plays `timing.seconds` of a moving scene, with one of `sounds` for each source, and passes each frame's
/// block to `take`. Single echoes are updated with each frame, the late part every quarter of a second. While the scene
/// stands still, it is not traced again.
///
/// # Errors
/// [`Error::Trace`] for settings out of range, [`Error::Audio`] for an invalid frame rate, those of
/// [`Response::trace`], and any error that `take` returns; [`Error::Scene`] if there is no such listener,
/// [`Error::Audio`] if the number of sounds differs from that of sources.
pub fn render_full<E: From<Error>>(
    tracer: &mut Tracer,
    scene: &Scene,
    settings: &FullSettings,
    sounds: &mut [Sound],
    timing: Timing,
    mut take: impl FnMut(FullBlock) -> Result<(), E>,
) -> Result<(), E> {
    timing.check()?;
    let (given, sources) = (sounds.len(), scene.sources().count());
    if given != sources {
        return Err(Error::from(AudioError::NotASoundEach { given, sources }).into());
    }
    let blocks = FrameBlocks::new(timing.fps, SAMPLE_RATE).map_err(Error::from)?;
    let end = timing.samples();
    let seconds = settings.tail_s(tracer, scene)?;
    let settings = settings.clone().with_tail(seconds);
    let spec = Spec::of(scene, SAMPLE_RATE).with_longest(seconds);
    let mut sources: Vec<Playing> = sounds
        .iter_mut()
        .map(|sound| Playing::new(sound, spec))
        .collect::<Result<_, _>>()?;
    let mut stereo = vec![0.0; 2 * blocks.longest()];
    let mut mono = vec![0.0; blocks.longest()];
    let mut heard = Vec::with_capacity(sources.len());
    for index in 0..timing.frames() {
        let time = index as f64 / timing.fps;
        let range = blocks.samples(index);
        let length = range.end.min(end).saturating_sub(range.start) as usize;
        let late_is_due = index == 0 || is_due(time, time - 1.0 / timing.fps);
        let now = scene.at(time);
        let (mono, stereo) = (&mut mono[..length], &mut stereo[..2 * length]);
        stereo.fill(0.0);
        heard.clear();
        for (number, source) in sources.iter_mut().enumerate() {
            let pair = now
                .heard_by(number, settings.listener)
                .map_err(Error::from)?;
            source
                .listen(tracer, pair, &settings, late_is_due, length as u32)
                .map_err(|error| error.at(time))?;
            source.sound.fill(mono);
            source.ears.add(mono, stereo).map_err(Error::from)?;
            heard.push(source.heard);
        }
        take(FullBlock {
            index,
            time,
            sources: &heard,
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
            scene: None,
            response: None,
            late: None,
            heard: HeardSource::default(),
        })
    }

    /// Glides to the responses in `pair` within the given number of samples.
    fn listen(
        &mut self,
        tracer: &mut Tracer,
        pair: Scene,
        settings: &FullSettings,
        late_is_due: bool,
        samples: u32,
    ) -> Result<(), Error> {
        let is_first = self.scene.is_none();
        let moves = self.scene.as_ref() != Some(&pair);
        if moves {
            let response = Response::trace(tracer, &pair, &settings.response)?;
            self.heard = HeardSource::of(&response);
            let axes = ListenerAxes::of(&pair.listener)?;
            let echoes = Heard::of_paths(&response.paths, &axes, self.ears.spec())?;
            self.ears
                .glide_echoes(&echoes, if is_first { 0 } else { samples })?;
            self.response = Some(response);
            self.scene = Some(pair);
        }
        if late_is_due {
            self.make_late(settings)?;
        }
        if is_first {
            return self.begin();
        }
        self.fade_late()
    }

    /// Computes the late part from the traces since the last one.
    fn make_late(&mut self, settings: &FullSettings) -> Result<(), Error> {
        let (Some(response), Some(scene)) = (self.response.take(), &self.scene) else {
            return Ok(());
        };
        let axes = ListenerAxes::of(&scene.listener)?;
        let heard = Heard::new(&response, &axes, self.ears.spec(), settings.seed)?;
        self.late = Some(heard);
        Ok(())
    }

    /// Takes the first late part at once, and skips the latency.
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
        let samples = (LATE_S * f64::from(SAMPLE_RATE)) as u32 - FADE_MARGIN;
        let Some(late) = &mut self.late else {
            return Ok(());
        };
        if self.ears.glide_late(late, samples)? {
            self.late = None;
        }
        Ok(())
    }
}
