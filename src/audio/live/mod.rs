//! Live output: plays a sound, and its panning may change during playback.
//!
//! # Theory
//! A sound system requests blocks of samples from a *callback*, on a thread that must never be late: a late block is an
//! audible gap. The callback here therefore never allocates, locks or waits ([`Renderer`]). It receives pan, volume and
//! law as single atomic values, and sounds and recordings through lock-free rings. A *supervisor* thread frees the
//! objects that the callback no longer needs, opens the device, and reopens it when it is lost. `docs/audio.md`
//! describes how the threads work together.
//!
//! ```no_run
//! use echomarch::audio::live::{Live, LiveOptions};
//!
//! let live = Live::start("speech".parse()?, LiveOptions::default());
//! live.set_panning(1.0, 3.0); // the sums from the left and from the right
//! std::thread::sleep(std::time::Duration::from_secs(2));
//! println!("{:?}", live.status());
//! # Ok::<(), echomarch::audio::AudioError>(())
//! ```

mod device;
mod error;
mod link;
#[doc(hidden)]
pub mod probe;
mod recording;
mod renderer;
mod shared;
mod sources;
mod stages;
mod supervisor;

pub use device::{DeviceInfo, list_devices};
pub use error::LiveError;
pub use renderer::{Remote, Renderer};
pub use sources::{SoundSource, StereoSource};

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Arc, Mutex, mpsc};
use std::thread::{self, JoinHandle};

use self::link::Command;
use self::recording::Recording;
use self::shared::Shared;
use self::supervisor::{Common, State, Supervisor, lock};
use super::PanningLaw;
use crate::tracer::Panning;

/// Initial options of live output.
#[derive(Debug, Clone, PartialEq)]
pub struct LiveOptions {
    /// Name or id of the output device; `None` for the system's default.
    pub device: Option<String>,
    /// Number of frames per request of the device; 1024 by default. With fewer frames, changes are audible sooner, but
    /// blocks may be late on a busy machine.
    pub buffer_frames: u32,
    /// The panning law.
    pub law: PanningLaw,
    /// The volume at the start, as in [`Live::set_volume`]; 1 by default.
    pub volume: f32,
}

impl Default for LiveOptions {
    fn default() -> Self {
        Self {
            device: None,
            buffer_frames: 1024,
            law: PanningLaw::default(),
            volume: 1.0,
        }
    }
}

/// The status of live output.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct LiveStatus {
    /// The device in use; `None` while no device is open and the output is silent.
    pub device: Option<String>,
    /// Sample rate in hertz; without a device, the last device's rate.
    pub sample_rate: u32,
    /// Number of frames in the device's last request; 0 before its first request.
    pub buffer_frames: u32,
    /// Latency in milliseconds from computing a sample to hearing it, as the sound system reports it for the first
    /// sample of a block; `None` if the sound system does not report it.
    pub latency_ms: Option<f64>,
    /// Milliseconds from setting a pan until a block is computed with it, smoothed over the most recent pans; `None`
    /// before the first pan.
    pub pan_waited_ms: Option<f64>,
    /// Under-runs reported by the sound system. PulseAudio reports none.
    pub under_runs: u64,
    /// Number of blocks requested more than two block lengths after the previous block: a device with a buffer of two
    /// blocks has then run out of samples.
    pub late_callbacks: u64,
    /// Number of times that a device was opened, without the first time.
    pub restarts: u64,
    /// Number of times that an open device was lost: it was removed, or stopped requesting sound.
    pub losses: u64,
    /// Whether the output is being recorded.
    pub is_recording: bool,
    /// Frames that the current or last recording lost because the disk was too slow.
    pub dropped_frames: u64,
    /// Whether a sound is loaded; false if loading at the device's rate failed.
    pub has_sound: bool,
    /// The last error, as a sentence. It is kept after recovery.
    pub last_error: Option<String>,
    /// The last error of a sound or a recording, as a sentence. The device may continue to play after this error.
    /// `None` after the next successful load or start of a recording.
    pub notice: Option<String>,
}

/// A sound that plays on a device until this value is dropped.
///
/// All methods may be called from any thread. No method waits for the callback, and setters return at once.
#[derive(Debug)]
pub struct Live {
    common: Common,
    supervisor: Option<JoinHandle<()>>,
}

impl Live {
    /// Starts to play `sound`, panned to the centre and at the volume of `options`.
    ///
    /// This function never fails. Without a device, or if opening it fails, the sound pauses, the output is silent, and
    /// [`status`](Self::status) contains the reason; the device is retried from time to time. If loading the sound
    /// fails, the output is silent as well.
    pub fn start(sound: SoundSource, options: LiveOptions) -> Self {
        let (commands, receiver) = mpsc::channel();
        let common = Common {
            shared: Arc::new(Shared::new(options.law)),
            state: Arc::new(Mutex::new(State::new())),
            is_stopping: Arc::new(AtomicBool::new(false)),
            commands,
        };
        common.shared.set_volume(options.volume);
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

    /// Sets the sums of the sound that arrived from the left and from the right, as in a frame's [`Panning`]. The gains
    /// glide to the new values within 20 ms.
    pub fn set_panning(&self, left: f64, right: f64) {
        let pan = Panning { left, right }.pan();
        self.common.shared.set_pan(pan as f32);
    }

    /// Sets the panning law; the gains glide to the new values.
    pub fn set_law(&self, law: PanningLaw) {
        self.common.shared.set_law(law);
    }

    /// Sets the factor of both channels, 0 (silence) to 1; the volume glides to it.
    pub fn set_volume(&self, volume: f32) {
        self.common.shared.set_volume(volume);
    }

    /// Cross-fades to the start of another sound, within 20 ms after it is loaded.
    ///
    /// If loading fails, the old sound continues and [`status`](Self::status) contains the reason.
    pub fn set_sound(&self, sound: SoundSource) {
        self.send(Command::Sound(sound));
    }

    /// Cross-fades within 20 ms to a sound of two channels, or back to the mono sound and its pan (`None`). The volume
    /// applies to both.
    pub fn set_stereo(&self, source: Option<StereoSource>) {
        self.send(Command::Stereo(source));
    }

    /// Switches to the device with this name or id, or to the system's default. The sound fades out and continues on
    /// that device.
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

    /// Level (RMS) of left and right over the last complete 50 ms, relative to full scale 1; 0 without a device.
    pub fn levels(&self) -> [f32; 2] {
        let shared = &self.common.shared;
        // A callback that ends late may still report levels after the device was closed.
        if shared.is_open.load(Relaxed) {
            shared.levels()
        } else {
            [0.0; 2]
        }
    }

    /// Starts to write the output to a WAV file of 32-bit float samples, at the device's rate.
    ///
    /// The recording pauses while there is no device. It ends if the device comes back at a rate that differs from the
    /// file's rate, if the disk is full, or after 4 GiB. [`status`](Self::status) reports the reason, and a new
    /// recording may then begin.
    ///
    /// Until the file is complete, its name is `path` followed by `-`, six letters and `.part.wav`. Except for the last
    /// second, it is playable at any time.
    ///
    /// # Errors
    /// [`LiveError::AlreadyRecording`], or the errors of [`WavWriter::create_at`](super::WavWriter::create_at).
    pub fn start_recording(&self, path: &Path) -> Result<(), LiveError> {
        let mut state = lock(&self.common.state);
        if let Some(over) = state.recording.take_if(|recording| recording.is_over()) {
            drop(state);
            // The error that ended the recording was reported when it happened.
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

    /// Completes the recording and returns the number of frames in the file.
    /// [`LiveStatus::dropped_frames`] counts lost frames.
    ///
    /// # Errors
    /// [`LiveError::NotRecording`], [`LiveError::Audio`] if writing to the disk failed, or
    /// [`LiveError::Thread`].
    pub fn stop_recording(&self) -> Result<u64, LiveError> {
        let mut state = lock(&self.common.state);
        let recording = state.recording.take().ok_or(LiveError::NotRecording)?;
        state.dropped = recording.dropped();
        drop(state);
        recording.finish()
    }

    fn send(&self, command: Command) {
        // Without a supervisor the output is already silent, and the status contains the reason.
        let _ = self.common.commands.send(command);
    }
}

impl Drop for Live {
    /// Fades out, closes the device, and completes a recording in progress.
    fn drop(&mut self) {
        self.common.is_stopping.store(true, Relaxed);
        self.send(Command::Stop);
        if let Some(supervisor) = self.supervisor.take() {
            // After a panic of the supervisor there is nothing left to close.
            let _ = supervisor.join();
        }
        // Callers that must know whether the file is complete stop the recording themselves.
        let _ = self.stop_recording();
    }
}
