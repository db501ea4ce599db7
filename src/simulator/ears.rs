//! The functions for a game's audio callback: the sound of sources as the listener hears them.

use super::encoder::{Encoder, MOST_CHANNELS, Planes};
use super::fit::{CHUNK, EARS};
use super::head::response_length;
use super::messages::{MESSAGES_PER_SOURCE, Message, SPARE_VOICES};
use super::network::Network;
use super::taps::Hearing;
use super::voice::{Output, Voice};
use super::{EarsFormat, HeadTracker, SimulatorError, SourceId};
use crate::bands::BAND_COUNT;
use crate::hrtf::HrirSet;
use crate::response::ImpulseSettings;
use glam::Quat;
use rtrb::{Consumer, Producer, RingBuffer};
use std::fmt;
use std::sync::Arc;

/// Maximum number of sources of a mix: each has half a megabyte.
const MOST_SOURCES: usize = 256;

/// Time in seconds in which the sound of a new source rises, and the last sample of a removed one decays to the share
/// 1/e. A sudden begin or end would click.
const RAMP_S: f64 = 0.005;

/// Time in seconds in which a turn of the head is heard: fast turns of a head take a tenth of a second.
const TURN_S: f64 = 0.01;

/// The format of [`Ears`] and [`Mix`].
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct EarsSpec {
    /// Samples per second, in [`ImpulseSettings::RATES_HZ`].
    pub rate_hz: u32,
    /// Maximum number of sources that are heard at once, 1 to 256. If there are more, the loudest ones are heard. [`Ears`]
    /// have one.
    pub sources: usize,
    /// Longest delay of a direct way or an echo in seconds, 0.01 to 5. Later ones are heard after this time. A source
    /// takes 1 MiB for each 0.7 s at 48 kHz.
    pub longest_s: f64,
    /// The channels.
    pub format: EarsFormat,
}

impl EarsSpec {
    /// The format at a sampling rate in hertz: 64 sources, 0.6 s, two loudspeakers.
    pub fn new(rate_hz: u32) -> EarsSpec {
        EarsSpec {
            rate_hz,
            sources: 64,
            longest_s: 0.6,
            format: EarsFormat::Stereo,
        }
    }

    /// Returns the format with a maximum number of sources.
    #[must_use]
    pub fn with_sources(mut self, sources: usize) -> EarsSpec {
        self.sources = sources;
        self
    }

    /// Returns the format with other channels.
    #[must_use]
    pub fn with_format(mut self, format: EarsFormat) -> EarsSpec {
        self.format = format;
        self
    }

    /// Returns the format for headphones, with a head.
    #[must_use]
    pub fn with_head(self, head: Arc<HrirSet>) -> EarsSpec {
        self.with_format(EarsFormat::Binaural(head))
    }

    /// Checks every number against its range.
    ///
    /// # Errors
    /// [`SimulatorError::BadNumber`].
    pub fn validate(&self) -> Result<(), SimulatorError> {
        let bad = |what, must, value| Err(SimulatorError::BadNumber { what, must, value });
        if !ImpulseSettings::RATES_HZ.contains(&self.rate_hz) {
            let rate = f64::from(self.rate_hz);
            return bad("the sampling rate in hertz", "8000 to 192000", rate);
        }
        if !(1..=MOST_SOURCES).contains(&self.sources) {
            return bad("the sources of a mix", "1 to 256", self.sources as f64);
        }
        if !(0.01..=5.0).contains(&self.longest_s) {
            return bad("the longest delay in seconds", "0.01 to 5", self.longest_s);
        }
        self.format.validate()
    }
}

/// A voice and the source that has it.
#[derive(Debug)]
struct Slot {
    id: Option<SourceId>,
    /// Whether the source is removed: the voice is free when it is silent.
    is_gone: bool,
    /// The last sample of the sound. After the source is removed it decays, so that nothing clicks.
    last: f32,
    /// The share of the sound that enters the voice. It rises to 1, as a sound may be under way when it is heard first.
    share: f32,
    voice: Voice,
}

impl Slot {
    /// A free voice for sounds with delays of up to `longest` samples, and responses of `head` samples (0: no head).
    fn new(longest: usize, rate_hz: u32, head: usize) -> Slot {
        Slot {
            id: None,
            is_gone: false,
            last: 0.0,
            share: 0.0,
            voice: Voice::new(longest, rate_hz, head),
        }
    }

    /// Gives the voice to a source.
    fn take(&mut self, id: SourceId) {
        (self.id, self.is_gone) = (Some(id), false);
        (self.last, self.share) = (0.0, 0.0);
        self.voice.clear();
    }

    /// The next samples of the sound of the source in `mono`, which is silent before. `step` is the change of the share
    /// in a sample.
    fn next_samples(
        &mut self,
        id: SourceId,
        mono: &mut [f32],
        step: f32,
        fill: &mut impl FnMut(SourceId, &mut [f32]),
    ) {
        if !self.is_gone {
            fill(id, mono);
        }
        for sample in mono {
            if self.is_gone {
                *sample = self.last * (1.0 - step);
            } else if self.share < 1.0 {
                self.share = (self.share + step).min(1.0);
                *sample *= self.share;
            }
            self.last = if sample.is_finite() { *sample } else { 0.0 };
        }
    }
}

/// The sound of all sources as the listener hears them. Made by [`Simulator::mix`](super::Simulator::mix).
///
/// A source is silent before its first trace, then fades in. Direct ways and echoes are taps of a delay line; the late
/// part of all sources passes one network of delay lines, which decays like the mean of all sources. It neither
/// waits, allocates nor frees, so that it may run in an audio callback.
pub struct Mix {
    inbox: Consumer<Box<Message>>,
    outbox: Producer<Box<Message>>,
    slots: Vec<Slot>,
    network: Network,
    /// The change per sample of sounds that begin or end, relative to 1.
    step: f32,
    rate_hz: u32,
    encoder: Encoder,
    channels: usize,
    head_tracker: HeadTracker,
    /// The rotation of the listener, and that of the head against it.
    listener: Quat,
    head: Quat,
    /// Whether the head has turned since the last block.
    turns: bool,
    output: Box<Output>,
    planes: Box<Planes>,
    late: [f32; CHUNK],
    mono: [f32; CHUNK],
}

/// The ends of the worker: messages to the ears, and messages back.
pub(super) type Ends = (Producer<Box<Message>>, Consumer<Box<Message>>);

impl Mix {
    pub(super) fn new(spec: &EarsSpec, encoder: Encoder, head_tracker: HeadTracker) -> (Mix, Ends) {
        let capacity = spec.sources * MESSAGES_PER_SOURCE;
        let (to_inbox, inbox) = RingBuffer::new(capacity);
        let (outbox, from_outbox) = RingBuffer::new(capacity);
        let longest = (spec.longest_s * f64::from(spec.rate_hz)) as usize;
        let head = match encoder.has_responses() {
            true => response_length(spec.rate_hz),
            false => 0,
        };
        let slot = |_| Slot::new(longest, spec.rate_hz, head);
        let mix = Mix {
            inbox,
            outbox,
            slots: (0..spec.sources + SPARE_VOICES).map(slot).collect(),
            network: Network::new(
                &[1.0; BAND_COUNT],
                spec.rate_hz,
                spec.format.channels(),
                &encoder.diffuse(),
            ),
            step: (1.0 / (RAMP_S * f64::from(spec.rate_hz))) as f32,
            rate_hz: spec.rate_hz,
            encoder,
            channels: spec.format.channels(),
            head_tracker,
            listener: Quat::IDENTITY,
            head: Quat::IDENTITY,
            turns: false,
            output: Box::new(Output::SILENT),
            planes: Box::new([[0.0; CHUNK]; MOST_CHANNELS]),
            late: [0.0; CHUNK],
            mono: [0.0; CHUNK],
        };
        (mix, (to_inbox, from_outbox))
    }

    /// Number of channels.
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// Overwrites `out`, all channels interleaved, with the next samples. `fill` is called for each source that is
    /// heard, with its id and the place for the next samples of its sound, which are silent before. It is called several
    /// times if there are more than 128 samples. An incomplete last frame is silent. A removed source is not asked for
    /// its sound; it fades out.
    pub fn process(&mut self, out: &mut [f32], mut fill: impl FnMut(SourceId, &mut [f32])) {
        if !self.encoder.is_ready() {
            out.fill(0.0);
            return;
        }
        let head = self.head_tracker.rotation();
        self.turns |= head != self.head;
        self.head = head;
        self.take_messages();
        self.turn();
        for chunk in out.chunks_mut(CHUNK * self.channels) {
            let frames = chunk.chunks_exact_mut(self.channels);
            self.render(frames.len(), &mut fill);
            for (index, frame) in frames.enumerate() {
                for (sample, plane) in frame.iter_mut().zip(&*self.planes) {
                    *sample = plane[index];
                }
            }
            let complete = chunk.len() - chunk.len() % self.channels;
            chunk[complete..].fill(0.0);
        }
    }

    /// Aims all sounds at the turned head.
    fn turn(&mut self) {
        if !std::mem::take(&mut self.turns) {
            return;
        }
        let samples = (TURN_S * f64::from(self.rate_hz)) as u32;
        let hearing = Hearing {
            encoder: &self.encoder,
            rotation: self.listener * self.head,
            rate_hz: self.rate_hz.into(),
        };
        for slot in &mut self.slots {
            slot.voice.turn(samples, &hearing);
        }
    }

    /// Number of sources that are heard.
    pub fn source_count(&self) -> usize {
        self.slots.iter().filter(|slot| slot.id.is_some()).count()
    }

    fn take_messages(&mut self) {
        while let Ok(message) = self.inbox.pop() {
            if let Some(absorption) = &message.absorption {
                self.network.glide_to(absorption);
            }
            self.turns |= message.rotation != self.listener;
            self.listener = message.rotation;
            if let Some(index) = self.slot(&message) {
                let hearing = Hearing {
                    encoder: &self.encoder,
                    rotation: self.listener * self.head,
                    rate_hz: self.rate_hz.into(),
                };
                let slot = &mut self.slots[index];
                slot.voice.glide_to(&message.ways, message.glide, &hearing);
                slot.is_gone = message.is_gone;
            }
            // There is room: no more messages are under way.
            let _ = self.outbox.push(message);
        }
    }

    /// The index of the voice of the message's source. A new source gets one that is free or about to be.
    fn slot(&mut self, message: &Message) -> Option<usize> {
        let id = Some(message.id);
        let own = self.slots.iter().position(|slot| slot.id == id);
        match own {
            Some(index) => Some(index),
            None if message.is_gone => None,
            None => {
                let free = self.slots.iter().position(|slot| slot.id.is_none());
                let fading = || self.slots.iter().position(|slot| slot.is_gone);
                let index = free.or_else(fading)?;
                self.slots[index].take(message.id);
                Some(index)
            }
        }
    }

    fn render(&mut self, frames: usize, fill: &mut impl FnMut(SourceId, &mut [f32])) {
        let Output {
            ears,
            late,
            channels,
            ..
        } = &mut *self.output;
        ears[..frames].fill([[0.0; 4]; EARS]);
        late[..frames].fill([[0.0; 4]]);
        for channel in &mut channels[..self.channels] {
            channel[..frames].fill(0.0);
        }
        let has_ears = self.encoder.has_ears();
        for slot in &mut self.slots {
            let Some(id) = slot.id else {
                continue;
            };
            let mono = &mut self.mono[..frames];
            mono.fill(0.0);
            slot.next_samples(id, mono, self.step, fill);
            slot.voice.add(mono, has_ears, &mut self.output);
            if slot.is_gone && slot.voice.is_silent() {
                (slot.id, slot.is_gone) = (None, false);
            }
        }
        let Output {
            ears,
            late,
            channels,
            ..
        } = &*self.output;
        let sum = |frame: &[f32; 4]| frame[0] + frame[1] + (frame[2] + frame[3]);
        for (sum_of_bands, [late]) in self.late[..frames].iter_mut().zip(late) {
            *sum_of_bands = sum(late);
        }
        for (channel, plane) in self.planes.iter_mut().enumerate().take(self.channels) {
            match has_ears {
                true => {
                    for (sample, ears) in plane[..frames].iter_mut().zip(ears) {
                        *sample = sum(&ears[channel]);
                    }
                }
                false => plane[..frames].copy_from_slice(&channels[channel][..frames]),
            }
        }
        self.network.add(&self.late[..frames], &mut self.planes);
    }
}

impl fmt::Debug for Mix {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Mix")
            .field("sources", &self.source_count())
            .finish_non_exhaustive()
    }
}

/// The sound of one source as the listener hears it. Made by [`Simulator::ears`](super::Simulator::ears).
///
/// Like a [`Mix`] of one source, for engines that mix sources themselves.
#[derive(Debug)]
pub struct Ears {
    pub(super) mix: Mix,
}

impl Ears {
    /// Number of channels.
    pub fn channels(&self) -> usize {
        self.mix.channels
    }

    /// Overwrites `out`, all channels interleaved, with what is heard of the next samples of the source. Silent
    /// before the source's first trace. Allocates and frees nothing.
    ///
    /// # Errors
    /// [`SimulatorError::BadLength`] unless `out` has one frame for each sample of `mono`; then no sample is played.
    pub fn process(&mut self, mono: &[f32], out: &mut [f32]) -> Result<(), SimulatorError> {
        let channels = self.mix.channels;
        if out.len() != channels * mono.len() {
            return Err(SimulatorError::BadLength {
                samples: mono.len(),
                channels,
                length: out.len(),
            });
        }
        let mut rest = mono;
        for chunk in out.chunks_mut(channels * CHUNK) {
            let (now, later) = rest.split_at(chunk.len() / channels);
            self.mix
                .process(chunk, |_, place| place.copy_from_slice(now));
            rest = later;
        }
        Ok(())
    }
}
