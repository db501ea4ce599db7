//! The callback's work, independent of a device: sounds in, interleaved stereo out.
//!
//! A [`Renderer`] never allocates, frees, locks or waits while it fills a block. Values that change often (pan, volume,
//! law) are atomics. Objects that own memory (a sound, the ring of a recording) enter through one ring. When no longer
//! needed, they leave through another ring, to be freed on another thread.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};

use cpal::{FromSample, Sample};
use rtrb::{Consumer, Producer, RingBuffer};

use super::shared::{Meter, Shared};
use super::stages::{Glide, Program, Programs};
use crate::audio::{Gains, Mixer, PanningLaw, Sound, StereoSignal};
use crate::tracer::Panning;

/// Frames mixed at once.
const BLOCK: usize = 256;

/// Inverse of the duration of a gain change and of a cross-fade, in hertz.
const FADES_HZ: u32 = 50;

/// Capacity of the queue to the callback; the return queue has twice this capacity.
const MESSAGES: usize = 8;

/// An object for the callback, or an object that the callback no longer needs.
#[derive(Debug)]
pub(super) enum Message {
    /// Another sound, made for this rate in hertz.
    Sound { sound: Sound, rate_hz: u32 },
    /// The program to switch to.
    Program(Program),
    /// The ring for a recording of the output.
    Tap(Tap),
}

/// The callback's end of a recording.
#[derive(Debug)]
pub(super) struct Tap {
    /// Interleaved samples.
    pub(super) ring: Producer<f32>,
    /// Whether the recording has ended.
    pub(super) is_over: Arc<AtomicBool>,
    /// Frames dropped because the ring was full.
    pub(super) dropped: Arc<AtomicU64>,
}

/// Plays one mono sound to two channels, with gliding gains and cross-fades between sounds.
///
/// Glides and cross-fades take 20 ms. The first samples fade in from silence.
#[derive(Debug)]
pub struct Renderer {
    /// The renderer's number among the supervisor's renderers.
    pub(super) number: u64,
    shared: Arc<Shared>,
    inbox: Consumer<Message>,
    outbox: Producer<Message>,
    rate_hz: u32,
    sound: Option<Sound>,
    /// Number of samples of the sound already played.
    position: u64,
    /// The next sound of a cross-fade, and the number of its samples already played.
    next: Option<(Sound, u64)>,
    glide: Glide,
    mixer: Mixer,
    programs: Programs,
    /// The volume of a program with two channels.
    volume: Glide,
    /// The volume at the last sample.
    last_volume: f32,
    meter: Meter,
    tap: Option<Tap>,
    mono: [f32; BLOCK],
    other: [f32; BLOCK],
    volumes: [f32; BLOCK],
    /// Two stereo blocks, for programs.
    scratch: [[f32; 2 * BLOCK]; 2],
}

/// The control side of a [`Renderer`], usable from any thread.
#[derive(Debug)]
pub struct Remote {
    pub(super) shared: Arc<Shared>,
    inbox: Producer<Message>,
    outbox: Consumer<Message>,
}

impl Renderer {
    /// Creates a renderer at `rate_hz` samples per second, for `sound` made at that rate, and its remote.
    pub fn new(sound: Option<Sound>, rate_hz: u32, law: PanningLaw) -> (Self, Remote) {
        Self::with_shared(Arc::new(Shared::new(law)), sound, rate_hz)
    }

    pub(super) fn with_shared(
        shared: Arc<Shared>,
        sound: Option<Sound>,
        rate_hz: u32,
    ) -> (Self, Remote) {
        let (to_inbox, inbox) = RingBuffer::new(MESSAGES);
        // Room for all objects in use: queued messages, a fading sound, a tap.
        let (outbox, from_outbox) = RingBuffer::new(2 * MESSAGES);
        let renderer = Self {
            number: 0,
            shared: Arc::clone(&shared),
            inbox,
            outbox,
            rate_hz,
            sound,
            position: 0,
            next: None,
            glide: Glide::new(fade_length(rate_hz)),
            mixer: silent_mixer(),
            programs: Programs::default(),
            volume: Glide::new(fade_length(rate_hz)),
            last_volume: 0.0,
            meter: Meter::new(rate_hz),
            tap: None,
            mono: [0.0; BLOCK],
            other: [0.0; BLOCK],
            volumes: [0.0; BLOCK],
            scratch: [[0.0; 2 * BLOCK]; 2],
        };
        let remote = Remote {
            shared,
            inbox: to_inbox,
            outbox: from_outbox,
        };
        (renderer, remote)
    }

    /// Samples per second.
    pub fn rate_hz(&self) -> u32 {
        self.rate_hz
    }

    /// Playback position of the sound, in seconds.
    pub fn position_s(&self) -> f64 {
        let newest = self.next.as_ref().map_or(self.position, |next| next.1);
        newest as f64 / f64::from(self.rate_hz)
    }

    /// Switches to another rate with a sound made for it. Frees the old objects, so the callback must not call this
    /// function.
    pub(super) fn change_rate(&mut self, rate_hz: u32, sound: Option<Sound>) {
        self.settle();
        let position = (self.position_s() * f64::from(rate_hz)).round() as u64;
        self.rate_hz = rate_hz;
        self.position = position;
        self.sound = sound.map(|mut sound| {
            sound.seek(position);
            sound
        });
        self.meter = Meter::new(rate_hz);
    }

    /// Applies all queued messages at once, without a fade. Frees the old objects, so the callback must not call this
    /// function.
    fn settle(&mut self) {
        if let Some((sound, played)) = self.next.take() {
            self.sound = Some(sound);
            self.position = played;
        }
        while let Ok(message) = self.inbox.pop() {
            match message {
                Message::Sound { sound, rate_hz } if rate_hz == self.rate_hz => {
                    self.sound = Some(sound);
                    self.position = 0;
                }
                Message::Program(program) if program.fits(self.rate_hz) => {
                    self.programs.set(program);
                }
                Message::Sound { .. } | Message::Program(_) => {}
                Message::Tap(tap) => self.tap = Some(tap),
            }
        }
    }

    /// Starts from silence, as after a gap. A new sound starts from its beginning: `newest` if present, otherwise the
    /// last sound queued in the meantime. Frees the old objects, so the callback must not call this function.
    pub(super) fn begin(&mut self, newest: Option<Sound>) {
        self.settle();
        if newest.is_some() {
            self.sound = newest;
            self.position = 0;
        }
        self.glide = Glide::new(fade_length(self.rate_hz));
        self.volume = Glide::new(fade_length(self.rate_hz));
        self.last_volume = 0.0;
        self.mixer = silent_mixer();
    }

    /// Switches to another program at once. Frees the old objects, so the callback must not call this function.
    pub(super) fn set_program(&mut self, program: Program) {
        self.programs.set(program);
    }

    /// Overwrites `out` with the next samples, interleaved (left, right, …).
    pub fn fill(&mut self, out: &mut [f32]) {
        for block in out.chunks_mut(2 * BLOCK) {
            let count = block.len() / 2;
            let (stereo, odd) = block.split_at_mut(2 * count);
            odd.fill(0.0);
            self.take_messages();
            self.fill_mono(count);
            self.mix(stereo);
            self.play(stereo);
            self.meter.take(stereo, &self.shared);
            self.record(stereo);
        }
    }

    /// Overwrites `out` with the next samples for a device of `channels` channels. A single channel gets the mean of
    /// left and right. With several channels, the first two get left and right, and the other channels get silence.
    pub fn fill_device<T: Sample + FromSample<f32>>(&mut self, out: &mut [T], channels: usize) {
        let mut stereo = [0.0; 2 * BLOCK];
        for block in out.chunks_mut(BLOCK * channels.max(1)) {
            let stereo = &mut stereo[..2 * (block.len() / channels.max(1))];
            self.fill(stereo);
            let frames = block.chunks_mut(channels.max(1));
            for (frame, pair) in frames.zip(stereo.as_chunks::<2>().0) {
                spread(*pair, frame);
            }
        }
    }

    fn take_messages(&mut self) {
        // A fade is finished before the next fade begins.
        while self.next.is_none() && !self.programs.is_fading() && self.outbox.slots() >= MESSAGES {
            match self.inbox.pop() {
                Ok(Message::Sound { sound, rate_hz }) if rate_hz == self.rate_hz => {
                    self.next = Some((sound, 0));
                }
                // The sound was made for the previous device. Opening the current device supplied a sound of its own.
                Ok(stale @ Message::Sound { .. }) => self.hand_out(stale),
                Ok(Message::Program(program)) if program.fits(self.rate_hz) => {
                    self.programs.fade_to(program);
                }
                Ok(stale @ Message::Program(_)) => self.hand_out(stale),
                Ok(Message::Tap(tap)) => {
                    if let Some(before) = self.tap.replace(tap) {
                        self.hand_out(Message::Tap(before));
                    }
                }
                Err(_) => return,
            }
        }
    }

    fn hand_out(&mut self, message: Message) {
        // The queue always has room: see `take_messages`.
        let _ = self.outbox.push(message);
    }

    /// Computes the next samples of the sound, or of two cross-fading sounds.
    fn fill_mono(&mut self, count: usize) {
        let length = fade_length(self.rate_hz) as u64;
        let mono = &mut self.mono[..count];
        match &mut self.sound {
            Some(sound) => sound.fill(mono),
            None => mono.fill(0.0),
        }
        self.position += count as u64;
        let Some((next, played)) = &mut self.next else {
            return;
        };
        let other = &mut self.other[..count];
        next.fill(other);
        for (i, (sample, &mut other)) in mono.iter_mut().zip(other).enumerate() {
            let share = (*played + i as u64 + 1).min(length) as f32 / length as f32;
            *sample += (other - *sample) * share;
        }
        *played += count as u64;
        if *played >= length {
            self.swap_sounds();
        }
    }

    fn swap_sounds(&mut self) {
        let Some((sound, played)) = self.next.take() else {
            return;
        };
        self.position = played;
        if let Some(sound) = self.sound.replace(sound) {
            let rate_hz = self.rate_hz;
            self.hand_out(Message::Sound { sound, rate_hz });
        }
    }

    fn mix(&mut self, stereo: &mut [f32]) {
        self.glide.aim(self.shared.target());
        let count = stereo.len() / 2;
        let mut done = 0;
        while done < count {
            let (step, gains) = self.glide.advance(count - done);
            let end = done + step;
            let (mono, stereo) = (&self.mono[done..end], &mut stereo[2 * done..2 * end]);
            let mixed = self.mixer.mix_to(mono, gains, stereo);
            debug_assert!(mixed.is_ok(), "there are two samples for each one");
            done = end;
        }
        if self.glide.is_silent() && self.shared.is_muted.load(Relaxed) {
            self.shared.has_faded.store(true, Relaxed);
        }
    }

    /// Plays the program that replaces the mono sound, if any.
    fn play(&mut self, stereo: &mut [f32]) {
        let count = stereo.len() / 2;
        self.fill_volumes(count);
        let length = fade_length(self.rate_hz);
        let volumes = &self.volumes[..count];
        if let Some(ended) = self
            .programs
            .play(stereo, volumes, &mut self.scratch, length)
        {
            self.hand_out(Message::Program(ended));
        }
    }

    /// Computes the volume of each of the next samples.
    fn fill_volumes(&mut self, count: usize) {
        self.volume.aim(self.shared.volume_target());
        let mut done = 0;
        while done < count {
            let (step, gains) = self.volume.advance(count - done);
            let (start, change) = (self.last_volume, gains.left - self.last_volume);
            for (index, volume) in self.volumes[done..done + step].iter_mut().enumerate() {
                *volume = start + change * (index + 1) as f32 / step as f32;
            }
            self.last_volume = gains.left;
            done += step;
        }
    }

    fn record(&mut self, stereo: &[f32]) {
        let Some(tap) = &mut self.tap else {
            return;
        };
        if tap.is_over.load(Relaxed) {
            if let Some(tap) = self.tap.take() {
                self.hand_out(Message::Tap(tap));
            }
        } else if tap.ring.push_entire_slice(stereo).is_err() {
            tap.dropped.fetch_add(stereo.len() as u64 / 2, Relaxed);
        }
    }
}

impl Remote {
    /// Same as [`Live::set_panning`](super::Live::set_panning).
    pub fn set_panning(&self, left: f64, right: f64) {
        self.shared.set_pan(Panning { left, right }.pan() as f32);
    }

    /// Same as [`Live::set_volume`](super::Live::set_volume).
    pub fn set_volume(&self, volume: f32) {
        self.shared.set_volume(volume);
    }

    /// Same as [`Live::set_law`](super::Live::set_law).
    pub fn set_law(&self, law: PanningLaw) {
        self.shared.set_law(law);
    }

    /// Same as [`Live::levels`](super::Live::levels).
    pub fn levels(&self) -> [f32; 2] {
        self.shared.levels()
    }

    /// Fades to a sound made for `rate_hz`; returns false if the queue is full. The renderer does not play a sound made
    /// for another rate.
    pub fn set_sound(&mut self, sound: Sound, rate_hz: u32) -> bool {
        self.send(Message::Sound { sound, rate_hz }).is_ok()
    }

    /// Fades to a stereo signal made for `rate_hz` in place of the mono sound and its pan, or back to the mono sound
    /// (`None`); returns false if the queue is full.
    pub fn set_stereo(&mut self, signal: Option<Box<dyn StereoSignal>>, rate_hz: u32) -> bool {
        let program = match signal {
            None => Program::Balance,
            Some(signal) => Program::Stereo { signal, rate_hz },
        };
        self.send(Message::Program(program)).is_ok()
    }

    /// Queues a message; returns the message if the queue is full.
    pub(super) fn send(&mut self, message: Message) -> Result<(), Message> {
        let sent = self.inbox.push(message);
        sent.map_err(|rtrb::PushError::Full(message)| message)
    }

    /// Frees the objects that the renderer no longer needs; returns their number.
    pub fn collect(&mut self) -> usize {
        let mut count = 0;
        while self.outbox.pop().is_ok() {
            count += 1;
        }
        count
    }
}

/// Length of a gain change in samples.
fn fade_length(rate_hz: u32) -> usize {
    (rate_hz / FADES_HZ).max(1) as usize
}

/// A mixer that starts from silence; a new mixer would start at its first gains.
fn silent_mixer() -> Mixer {
    let mut mixer = Mixer::new(PanningLaw::default());
    let mixed = mixer.mix_to(&[0.0], Gains::SILENT, &mut [0.0; 2]);
    debug_assert!(mixed.is_ok(), "there are two samples for one");
    mixer
}

fn spread<T: Sample + FromSample<f32>>(pair: [f32; 2], frame: &mut [T]) {
    match frame {
        [] => {}
        [only] => *only = T::from_sample((pair[0] + pair[1]) / 2.0),
        [left, right, others @ ..] => {
            *left = T::from_sample(pair[0]);
            *right = T::from_sample(pair[1]);
            others.fill(T::EQUILIBRIUM);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::audio::Sound;

    /// Protects a sound sent after the last callback: it plays as soon as playback resumes. A sound made for another
    /// rate does not play.
    #[test]
    fn a_sound_that_waited_is_heard_at_its_own_rate_alone() {
        for (made_hz, is_heard) in [(Sound::SAMPLE_RATE, true), (44_100, false)] {
            let (mut renderer, mut remote) =
                Renderer::new(None, Sound::SAMPLE_RATE, PanningLaw::Linear);
            let sound = Sound::parse("noise", made_hz).unwrap();
            assert!(remote.set_sound(sound, made_hz));
            renderer.begin(None);
            let mut out = [0.0; 2 * BLOCK];
            renderer.fill(&mut out);
            let is_sounding = out.iter().any(|&sample| sample != 0.0);
            assert_eq!(is_sounding, is_heard, "{made_hz} Hz");
        }
    }
}
