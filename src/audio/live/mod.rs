//! Live output: a sound that is heard while its panning changes.
//!
//! # Theory
//! A sound system requests blocks of samples from a *callback*, on a thread that must never be
//! late: a late block is a gap that is heard. So the callback here allocates nothing, locks
//! nothing and waits for nothing ([`Renderer`]). Pan, volume and law reach it as single atomic
//! values, sounds and recordings through rings without locks, and what it has done with is freed
//! by a *supervisor* thread, which also opens the device and opens it again when it is lost. How
//! the threads work together is described in `docs/audio.md`.
//!
//! ```no_run
//! use echomarch::audio::live::{Live, LiveOptions};
//!
//! let live = Live::start("speech".parse()?, LiveOptions::default());
//! live.set_panning(1.0, 3.0); // what arrived from the left and from the right
//! std::thread::sleep(std::time::Duration::from_secs(2));
//! println!("{:?}", live.status());
//! # Ok::<(), echomarch::audio::AudioError>(())
//! ```

mod command;
mod device;
mod error;
mod glide;
#[cfg(target_os = "linux")]
mod jack;
mod link;
mod meter;
#[doc(hidden)]
pub mod probe;
mod program;
mod recording;
mod renderer;
mod shared;
mod supervisor;
mod timeout;

pub use device::{DeviceInfo, list_devices};
pub use error::LiveError;
pub use renderer::{Remote, Renderer};

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Arc, Mutex, mpsc};
use std::thread::{self, JoinHandle};

use self::command::Command;
use self::recording::Recording;
use self::shared::Shared;
use self::supervisor::{Common, State, Supervisor, lock};
use super::{PanningLaw, SoundSource, StereoSource};
use crate::trace::Panning;

/// What live output starts with.
#[derive(Debug, Clone, PartialEq)]
pub struct LiveOptions {
    /// Name or id of the output device; none for the system's default.
    pub device: Option<String>,
    /// Frames that the device shall ask for at once; 1024 by default. Less is heard sooner, but a
    /// busy machine may be too late for it.
    pub buffer_frames: u32,
    /// How a pan becomes two gains.
    pub law: PanningLaw,
}

impl Default for LiveOptions {
    fn default() -> Self {
        Self {
            device: None,
            buffer_frames: 1024,
            law: PanningLaw::default(),
        }
    }
}

/// The status of live output.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct LiveStatus {
    /// The device that is played on; none while there is none, and all is silent.
    pub device: Option<String>,
    /// Samples a second, in hertz; without a device, of the last one.
    pub sample_rate: u32,
    /// Frames that the device requested last; 0 before it has.
    pub buffer_frames: u32,
    /// Milliseconds from when a sample is made to when it is heard, as the sound system reports it
    /// for the first sample of a block; none if it does not.
    pub latency_ms: Option<f64>,
    /// Milliseconds that pans wait until a block is made with them, smoothed over the last ones;
    /// none before the first.
    pub pan_waited_ms: Option<f64>,
    /// Under-runs reported by the sound system. PulseAudio reports none.
    pub under_runs: u64,
    /// Times that a block was requested later than the length of two blocks after the one before:
    /// a device that holds two has run dry then.
    pub late_callbacks: u64,
    /// Times that a device was opened after the first one.
    pub restarts: u64,
    /// Times that a device was lost while it was open: it went away, or took no more sound.
    pub losses: u64,
    /// Whether what is heard is being recorded.
    pub is_recording: bool,
    /// Frames that the recording, or else the last one, lost because the disk was too slow.
    pub dropped_frames: u64,
    /// Whether there is a sound to play: not, if none could be loaded at the device's rate.
    pub has_sound: bool,
    /// What went wrong last, as a sentence; it stays when all is well again.
    pub last_error: Option<String>,
    /// What went wrong last with a sound or a recording while the device may play on, as a
    /// sentence; none once a sound was loaded or a recording begun since.
    pub notice: Option<String>,
}

/// A sound that plays on a device until this is dropped.
///
/// All methods may be called from any thread, none waits for the callback, and those that set
/// something return at once.
#[derive(Debug)]
pub struct Live {
    common: Common,
    supervisor: Option<JoinHandle<()>>,
}

impl Live {
    /// Starts to play `sound`, in the middle and at full volume.
    ///
    /// This never fails: without a device, or with one that cannot be opened, nothing is heard,
    /// the sound pauses, and [`status`](Self::status) contains the reason; the device is retried
    /// from time to time. The same goes for a sound that cannot be loaded.
    pub fn start(sound: SoundSource, options: LiveOptions) -> Self {
        let (commands, receiver) = mpsc::channel();
        let common = Common {
            shared: Arc::new(Shared::new(options.law)),
            state: Arc::new(Mutex::new(State::new())),
            is_stopping: Arc::new(AtomicBool::new(false)),
            commands,
        };
        let LiveOptions {
            device,
            buffer_frames,
            ..
        } = options;
        let theirs = common.clone();
        let run = move || Supervisor::new(theirs, receiver, sound, device, buffer_frames).run();
        let thread = thread::Builder::new().name("echomarch-audio".to_owned());
        let supervisor = thread
            .spawn(run)
            .map_err(|source| {
                let error = LiveError::Thread { source };
                lock(&common.state).last_error = Some(error.to_string());
            })
            .ok();
        Self { common, supervisor }
    }

    /// Sets what arrived from the left and from the right: the sums of a frame's [`Panning`]. The
    /// gains glide there within 20 ms.
    pub fn set_panning(&self, left: f64, right: f64) {
        let pan = Panning { left, right }.pan();
        self.common.shared.set_pan(pan as f32);
    }

    /// Sets how a pan becomes two gains, which glide there.
    pub fn set_law(&self, law: PanningLaw) {
        self.common.shared.set_law(law);
    }

    /// Sets a factor on both channels, 0 (silence) to 1, which glides there.
    pub fn set_volume(&self, volume: f32) {
        self.common.shared.set_volume(volume);
    }

    /// Cross-fades to the start of another sound, within 20 ms after it is loaded.
    ///
    /// If it cannot be loaded, the old one continues and [`status`](Self::status) contains the reason.
    pub fn set_sound(&self, sound: SoundSource) {
        self.send(Command::Sound(sound));
    }

    /// Cross-fades to a sound of two channels, or back to the one sound and its pan (`None`), within
    /// 20 ms. The volume counts for both.
    pub fn set_stereo(&self, source: Option<StereoSource>) {
        self.send(Command::Stereo(source));
    }

    /// Plays on the device of this name or id, or on the system's default. The sound fades out and
    /// continues there.
    pub fn set_device(&self, device: Option<String>) {
        self.send(Command::Device(device));
    }

    /// The current status.
    pub fn status(&self) -> LiveStatus {
        let shared = &self.common.shared;
        let state = lock(&self.common.state);
        let recording = state.recording.as_ref();
        LiveStatus {
            device: state.device.clone(),
            sample_rate: state.rate_hz,
            buffer_frames: shared.callback_frames.load(Relaxed),
            latency_ms: shared.latency_ms(),
            pan_waited_ms: shared.pan_waited_ms(),
            under_runs: shared.under_runs.load(Relaxed),
            late_callbacks: shared.late_callbacks.load(Relaxed),
            restarts: state.restarts,
            losses: state.losses,
            is_recording: recording.is_some_and(|recording| !recording.is_over()),
            dropped_frames: recording.map_or(state.dropped, Recording::dropped),
            has_sound: state.has_sound,
            last_error: state.last_error.clone(),
            notice: state.notice.clone(),
        }
    }

    /// Level (RMS) of left and right over the last whole 50 ms, of full scale 1; 0 without a
    /// device.
    pub fn levels(&self) -> [f32; 2] {
        let shared = &self.common.shared;
        // A callback that ends late may still tell levels after the device was closed.
        if shared.is_open.load(Relaxed) {
            shared.levels()
        } else {
            [0.0; 2]
        }
    }

    /// Starts to write what is heard to a WAV file of 32-bit float samples, at the device's rate.
    ///
    /// While there is no device nothing is heard, and nothing written. If the device comes back at
    /// another rate than what was written the recording ends, as it does when the disk is full or
    /// after 4 GiB; [`status`](Self::status) reports that. The next recording may then begin.
    ///
    /// Until the file is complete it is called as `path`, with `-`, six letters and `.part.wav`
    /// at the end; it is playable up to the last second.
    ///
    /// # Errors
    /// [`LiveError::AlreadyRecording`], or as
    /// [`WavWriter::create_at`](super::WavWriter::create_at).
    pub fn start_recording(&self, path: &Path) -> Result<(), LiveError> {
        let mut state = lock(&self.common.state);
        if let Some(over) = state.recording.take_if(|recording| recording.is_over()) {
            drop(state);
            // What ended it was told when it happened.
            let _ = over.finish();
            state = lock(&self.common.state);
        }
        if state.recording.is_some() {
            return Err(LiveError::AlreadyRecording);
        }
        state.recording = Some(Recording::new(path, state.rate_hz)?);
        state.notice = None;
        drop(state);
        self.send(Command::Record);
        Ok(())
    }

    /// Completes the recording; the frames in the file. Lost frames are counted by
    /// [`LiveStatus::dropped_frames`].
    ///
    /// # Errors
    /// [`LiveError::NotRecording`], [`LiveError::Audio`] if the disk rejected, or
    /// [`LiveError::Thread`].
    pub fn stop_recording(&self) -> Result<u64, LiveError> {
        let mut state = lock(&self.common.state);
        let recording = state.recording.take().ok_or(LiveError::NotRecording)?;
        state.dropped = recording.dropped();
        drop(state);
        recording.finish()
    }

    fn send(&self, command: Command) {
        // Without a supervisor all is silent already, and the status says so.
        let _ = self.common.commands.send(command);
    }
}

impl Drop for Live {
    /// Fades out, closes the device, and completes a recording.
    fn drop(&mut self) {
        self.common.is_stopping.store(true, Relaxed);
        self.send(Command::Stop);
        if let Some(supervisor) = self.supervisor.take() {
            // If it panicked there is nothing left to close.
            let _ = supervisor.join();
        }
        // Whoever wants to know whether the file is complete stops the recording.
        let _ = self.stop_recording();
    }
}
