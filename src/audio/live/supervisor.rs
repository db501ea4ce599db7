//! The supervisor thread: opens the device, loads sounds, frees the objects that the callback no longer needs, and
//! reopens the device when it is lost.

use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use super::LiveError;
use super::device::{self, ANSWER_LIMIT, Found, drop_elsewhere, within};
use super::link::{Command, Link, Slot};
use super::recording::Recording;
use super::renderer::{Message, Remote, Renderer, Tap};
use super::shared::Shared;
use super::sources::{SoundSource, StereoSource};
use super::stages::Program;
use crate::audio::Sound;

/// Interval at which the thread checks the stream.
const TICK: Duration = Duration::from_millis(20);
/// A stream is lost if its callbacks stop for this time.
const STALL: Duration = Duration::from_secs(1);
/// A newly opened stream is lost if its first callback takes longer than this.
const FIRST_CALLBACK: Duration = Duration::from_secs(3);
/// Waiting times between attempts to open a device: the first and the longest.
const RETRY: (Duration, Duration) = (Duration::from_millis(100), Duration::from_secs(5));
/// A stream that has run for this time does not count as a failed attempt.
const PROVEN: Duration = Duration::from_secs(2);
/// Duration of a fade-out before closing, in addition to the buffers: the glide and a small margin.
const FADE_OUT: Duration = Duration::from_millis(25);
/// Limit of the wait in addition to two buffers, one until the callback has faded and one until its output has been
/// heard. A stream that hangs must not delay the end.
const FADE_OUT_LIMIT: Duration = Duration::from_millis(100);
/// Interval at which the fade-out is checked.
const FADE_OUT_GLANCE: Duration = Duration::from_millis(2);

/// The supervisor's status; never locked by the callback.
#[derive(Debug, Default)]
pub(super) struct State {
    pub(super) device: Option<String>,
    pub(super) rate_hz: u32,
    pub(super) restarts: u64,
    pub(super) losses: u64,
    /// Whether the renderer has a sound.
    pub(super) has_sound: bool,
    pub(super) last_error: Option<String>,
    /// The last error that does not concern the device.
    pub(super) notice: Option<String>,
    pub(super) recording: Option<Recording>,
    /// Frames lost by the last finished recording.
    pub(super) dropped: u64,
}

impl State {
    pub(super) fn new() -> Self {
        Self {
            rate_hz: Sound::SAMPLE_RATE,
            ..Self::default()
        }
    }
}

/// Locks the state, which stays valid after a panic in another thread.
pub(super) fn lock(state: &Mutex<State>) -> MutexGuard<'_, State> {
    state.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Data that the supervisor shares with [`Live`](super::Live).
#[derive(Debug, Clone)]
pub(super) struct Common {
    pub(super) shared: Arc<Shared>,
    pub(super) state: Arc<Mutex<State>>,
    pub(super) is_stopping: Arc<AtomicBool>,
    pub(super) commands: Sender<Command>,
}

pub(super) struct Supervisor {
    common: Common,
    commands: Receiver<Command>,
    slot: Arc<Slot>,
    drop_queue: Arc<Slot>,
    remote: Remote,
    /// The number of the remote's renderer.
    renderer: u64,
    rate_hz: u32,
    source: SoundSource,
    /// The stereo source that replaces the sound, if any.
    stereo: Option<StereoSource>,
    device: Option<String>,
    buffer_frames: u32,
    stream: Option<OpenStream>,
    generation: u64,
    /// The sound loaded last. It waits until a stream is open and the queue has room.
    waiting: Option<Sound>,
    /// The program that replaces the sound. It waits until a stream is open and the queue has room.
    program: Option<Program>,
    /// The tap of a recording. It waits until a stream is open and the queue has room.
    tap: Option<Tap>,
    next_try: Instant,
    delay: Duration,
    has_played: bool,
}

struct OpenStream {
    stream: cpal::Stream,
    name: String,
    opened: Instant,
    /// The number of callbacks, and the time at which this number last changed.
    callbacks: u64,
    seen: Instant,
    has_called: bool,
}

impl Supervisor {
    pub(super) fn new(
        common: Common,
        commands: Receiver<Command>,
        source: SoundSource,
        device: Option<String>,
        buffer_frames: u32,
    ) -> Self {
        let shared = Arc::clone(&common.shared);
        let (renderer, remote) = Renderer::with_shared(shared, None, Sound::SAMPLE_RATE);
        Self {
            common,
            commands,
            slot: Arc::new(Slot::new(Some(Box::new(renderer)))),
            drop_queue: Arc::new(Slot::new(None)),
            remote,
            renderer: 0,
            rate_hz: Sound::SAMPLE_RATE,
            source,
            stereo: None,
            device,
            buffer_frames: buffer_frames.max(1),
            stream: None,
            generation: 0,
            waiting: None,
            program: None,
            tap: None,
            next_try: Instant::now(),
            delay: RETRY.0,
            has_played: false,
        }
    }

    /// Runs the thread until it receives `Command::Stop`.
    pub(super) fn run(mut self) {
        self.change_sound(self.source.clone());
        loop {
            if self.stream.is_none() && Instant::now() >= self.next_try {
                self.try_to_open();
            }
            match self.commands.recv_timeout(TICK) {
                Ok(Command::Stop) | Err(RecvTimeoutError::Disconnected) => break,
                Ok(command) => self.handle(command),
                Err(RecvTimeoutError::Timeout) => {}
            }
            self.deliver();
            self.watch();
        }
        self.fade_out();
        self.close();
    }

    fn handle(&mut self, command: Command) {
        match command {
            Command::Sound(source) => self.change_sound(source),
            Command::Stereo(source) => {
                self.stereo = source;
                self.program = Some(self.make_program());
            }
            Command::Device(device) => {
                self.device = device;
                self.fade_out();
                self.close();
                self.delay = RETRY.0;
                self.next_try = Instant::now();
            }
            Command::Notice(text) => self.note(text),
            Command::Lost { generation, reason } if generation == self.generation => {
                self.lose(reason);
            }
            // The loss of a stream that is already closed needs no action. `deliver` starts recordings, and `run`
            // handles `Stop`.
            Command::Lost { .. } | Command::Record | Command::Stop => {}
        }
    }

    /// Loads a sound and sends it to the callback. If several sounds are waiting, only the last sound is kept.
    fn change_sound(&mut self, source: SoundSource) {
        match source.sound(self.rate_hz) {
            Ok(sound) => {
                self.source = source;
                self.waiting = Some(sound);
                let mut state = lock(&self.common.state);
                state.has_sound = true;
                state.notice = None;
            }
            Err(error) => self.note(error.to_string()),
        }
    }

    /// The program to play, made for the current rate.
    fn make_program(&self) -> Program {
        let rate_hz = self.rate_hz;
        match &self.stereo {
            None => Program::Balance,
            Some(source) => Program::Stereo {
                signal: source.signal(rate_hz),
                rate_hz,
            },
        }
    }

    /// Reports an error of a sound or a recording.
    fn note(&self, text: String) {
        let mut state = lock(&self.common.state);
        state.last_error = Some(text.clone());
        state.notice = Some(text);
    }

    fn tell(&self, error: &LiveError) {
        lock(&self.common.state).last_error = Some(error.to_string());
    }

    /// Sends waiting objects to the callback of an open stream, and frees returned objects.
    fn deliver(&mut self) {
        self.remote.collect();
        drop(self.drop_queue.take());
        if self.stream.is_none() {
            return;
        }
        if self.tap.is_none() {
            let recording = &mut lock(&self.common.state).recording;
            self.tap = recording
                .as_mut()
                .and_then(|recording| recording.begin(&self.common.commands));
        }
        if let Some(tap) = self.tap.take()
            && !tap.is_over.load(Relaxed)
            && let Err(Message::Tap(tap)) = self.remote.send(Message::Tap(tap))
        {
            self.tap = Some(tap);
        }
        let rate_hz = self.rate_hz;
        if let Some(sound) = self.waiting.take()
            && let Err(Message::Sound { sound, .. }) =
                self.remote.send(Message::Sound { sound, rate_hz })
        {
            self.waiting = Some(sound);
        }
        if let Some(program) = self.program.take()
            && let Err(Message::Program(program)) = self.remote.send(Message::Program(program))
        {
            self.program = Some(program);
        }
    }

    /// Detects a stream whose callbacks have stopped.
    fn watch(&mut self) {
        let buffer = self.buffer();
        let Some(stream) = &mut self.stream else {
            return;
        };
        let callbacks = self.common.shared.callbacks.load(Relaxed);
        if callbacks != stream.callbacks {
            stream.callbacks = callbacks;
            stream.seen = Instant::now();
            stream.has_called = true;
        }
        let limit = if stream.has_called {
            STALL.max(4 * buffer)
        } else {
            FIRST_CALLBACK
        };
        if stream.seen.elapsed() > limit {
            let seconds = limit.as_secs_f64();
            self.lose(format!("it has taken no sound for {seconds:.1} s"));
        }
    }

    /// Closes a lost stream; it is reopened later.
    fn lose(&mut self, reason: String) {
        let Some(stream) = &self.stream else {
            return;
        };
        if stream.opened.elapsed() > PROVEN {
            self.delay = RETRY.0;
        }
        let device = stream.name.clone();
        self.tell(&LiveError::Lost { device, reason });
        lock(&self.common.state).losses += 1;
        self.close();
        self.retry_later();
    }

    fn retry_later(&mut self) {
        self.next_try = Instant::now() + self.delay;
        self.delay = (2 * self.delay).min(RETRY.1);
    }

    /// Fades out a playing sound, so that stopping does not click.
    fn fade_out(&self) {
        if self.stream.is_none() {
            return;
        }
        let shared = &self.common.shared;
        let limit = 2 * self.buffer() + FADE_OUT_LIMIT;
        let start = Instant::now();
        shared.is_muted.store(true, Relaxed);
        while !shared.has_faded.load(Relaxed) && start.elapsed() < limit {
            thread::sleep(FADE_OUT_GLANCE);
        }
        // The block with the end of the fade has just been computed.
        let latency = shared.latency_ms();
        let latency = latency.map_or(limit, |ms| Duration::from_secs_f64(ms / 1000.0));
        thread::sleep(latency.min(limit) + FADE_OUT);
    }

    /// The duration of the last block requested from the callback.
    fn buffer(&self) -> Duration {
        let frames = self.common.shared.callback_frames.load(Relaxed);
        Duration::from_secs_f64(f64::from(frames) / f64::from(self.rate_hz))
    }

    fn close(&mut self) {
        // From now on the stream's callback outputs silence, even if the callback ends much later.
        self.generation += 1;
        let shared = &self.common.shared;
        shared.generation.store(self.generation, Relaxed);
        if let Some(stream) = self.stream.take() {
            drop_elsewhere(stream.stream);
        }
        shared.is_open.store(false, Relaxed);
        shared.set_levels([0.0; 2]);
        shared.set_latency_us(None);
        shared.forget_pan();
        lock(&self.common.state).device = None;
    }

    fn try_to_open(&mut self) {
        match self.open() {
            Ok(stream) => {
                let mut state = lock(&self.common.state);
                state.device = Some(stream.name.clone());
                state.restarts += u64::from(self.has_played);
                drop(state);
                self.has_played = true;
                self.common.shared.is_open.store(true, Relaxed);
                self.stream = Some(stream);
                self.deliver();
            }
            Err(error) => {
                device::forget_broken(&error);
                self.tell(&error);
                self.close();
                self.retry_later();
            }
        }
    }

    fn open(&mut self) -> Result<OpenStream, LiveError> {
        let wanted = self.device.clone();
        let found = self.within(move || device::find(wanted.as_deref()))??;
        self.prepare(found.rate_hz());
        self.generation += 1;
        let shared = &self.common.shared;
        shared.generation.store(self.generation, Relaxed);
        shared.is_muted.store(false, Relaxed);
        shared.has_faded.store(false, Relaxed);
        let callbacks = shared.callbacks.load(Relaxed);
        let link = Link {
            slot: Arc::clone(&self.slot),
            drop_queue: Arc::clone(&self.drop_queue),
            shared: Arc::clone(shared),
            commands: self.common.commands.clone(),
            generation: self.generation,
        };
        let (name, frames) = (found.name.clone(), self.buffer_frames);
        let stream = self.within(move || Found::open(&found, frames, &link))??;
        let now = Instant::now();
        Ok(OpenStream {
            stream,
            name,
            opened: now,
            callbacks,
            seen: now,
            has_called: false,
        })
    }

    fn within<T: Send + 'static>(
        &self,
        work: impl FnOnce() -> T + Send + 'static,
    ) -> Result<T, LiveError> {
        let is_stopping = Arc::clone(&self.common.is_stopping);
        within(ANSWER_LIMIT, move || is_stopping.load(Relaxed), work)
    }

    /// Prepares the renderer to continue from silence at `rate_hz`.
    fn prepare(&mut self, rate_hz: u32) {
        let mut renderer = self.take_renderer();
        if renderer.rate_hz() != rate_hz {
            let sound = self.load_again(rate_hz);
            if self.waiting.is_some() {
                self.waiting = sound;
                renderer.change_rate(rate_hz, None);
            } else {
                renderer.change_rate(rate_hz, sound);
            }
            self.rate_hz = rate_hz;
            self.tell_rate(rate_hz);
            self.program = Some(self.make_program());
        }
        renderer.begin(self.waiting.take());
        if let Some(program) = self.program.take() {
            renderer.set_program(program);
        }
        self.slot.store(Some(renderer));
    }

    /// Loads the current sound at another rate.
    fn load_again(&self, rate_hz: u32) -> Option<Sound> {
        let loaded = self.source.sound(rate_hz);
        let mut state = lock(&self.common.state);
        if loaded.is_ok() && !state.has_sound {
            state.notice = None;
        }
        state.has_sound = loaded.is_ok();
        drop(state);
        loaded.map_err(|error| self.note(error.to_string())).ok()
    }

    /// Takes the renderer back from the last stream.
    fn take_renderer(&mut self) -> Box<Renderer> {
        for _ in 0..50 {
            // A replaced renderer that has been put back since then is freed.
            if let Some(renderer) = self.slot.take()
                && renderer.number == self.renderer
            {
                return renderer;
            }
            // A callback of the old stream is using it.
            thread::sleep(Duration::from_millis(5));
        }
        // The callback hangs and owns the renderer.
        let shared = Arc::clone(&self.common.shared);
        let sound = self.source.sound(self.rate_hz).ok();
        let (mut renderer, remote) = Renderer::with_shared(shared, sound, self.rate_hz);
        self.remote = remote;
        self.renderer += 1;
        renderer.number = self.renderer;
        renderer.set_program(self.make_program());
        self.end_recording();
        Box::new(renderer)
    }

    /// Ends the recording: its tap is lost with the hanging renderer.
    fn end_recording(&self) {
        let is_ended = match &lock(&self.common.state).recording {
            Some(recording) if recording.has_begun() && !recording.is_over() => {
                recording.end();
                true
            }
            _ => false,
        };
        if is_ended {
            self.note(LiveError::RecordingHeld.to_string());
        }
    }

    /// Passes the new rate to the recording. The recording ends if its file has another rate.
    fn tell_rate(&self, rate_hz: u32) {
        let mut state = lock(&self.common.state);
        state.rate_hz = rate_hz;
        let recording = state.recording.as_mut();
        let changed = recording.map_or(Ok(()), |recording| recording.change_rate(rate_hz));
        drop(state);
        if let Err(error) = changed {
            self.note(error.to_string());
        }
    }
}
