//! The sound of the window: applies the gains, and reports the device's status.
//!
//! With the feature `audio`, sound is played through [`echomarch::audio::live`]. Without this feature the window is
//! silent, and a message states the reason.

use super::DemoOptions;
use super::ears::Ears;
use echomarch::audio::PanningLaw;
#[cfg(feature = "audio")]
use echomarch::audio::live::{Live, LiveOptions, LiveStatus};
use echomarch::scene::Scene;
use echomarch::tracer::Panning;
use serde::Serialize;
use std::path::Path;
#[cfg(feature = "audio")]
use std::sync::Weak;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The sounds that can be chosen in the window, besides the sound given at the start.
pub const SOUNDS: [&str; 5] = ["speech", "noise", "sine:220", "sine:440", "sine:880"];

/// The status of the sound.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SoundStatus {
    /// The status as one line of text.
    pub text: String,
    /// Whether sound is audible.
    pub is_heard: bool,
    /// Sample rate in hertz.
    pub sample_rate: Option<u32>,
    /// Buffer size of the device in samples.
    pub buffer: Option<u32>,
    /// Number of late buffers: reported as late by the device, or delayed by more than two buffer lengths.
    pub underruns: u64,
    /// Number of times that the device was reopened.
    pub restarts: u64,
    /// Time that the gains waited for the sound thread, in milliseconds.
    pub gains_to_buffer: Option<f64>,
    /// Time from the sound thread to the ear, in milliseconds, as reported by the device.
    pub buffer_to_device: Option<f64>,
    /// Whether a recording is in progress.
    pub is_recording: bool,
    /// Number of audio frames lost by the current or last recording.
    pub dropped_frames: u64,
}

/// The sound output.
pub struct Speaker {
    law: PanningLaw,
    panning: Panning,
    /// Whether full listening is played.
    is_in_full: bool,
    volume: Arc<Volume>,
    /// The last pan of the played levels.
    #[cfg(feature = "audio")]
    played_pan: Option<f32>,
    #[cfg(feature = "audio")]
    live: Option<Arc<Live>>,
}

/// The loudness of the output. The first response opens it from the thread of the ears, because the first picture takes
/// seconds on a software renderer.
struct Volume {
    #[cfg(feature = "audio")]
    live: Option<Weak<Live>>,
    state: Mutex<VolumeState>,
}

#[derive(Clone, Copy)]
struct VolumeState {
    /// Whether the first response, or the first frame of waves, is known. The output is silent before.
    has_begun: bool,
    /// The chosen loudness, 0 to 1.
    chosen: f32,
}

impl Volume {
    fn state(&self) -> VolumeState {
        *self.lock()
    }

    fn lock(&self) -> MutexGuard<'_, VolumeState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Changes the state, and passes the loudness to the device once the sound has begun.
    fn change(&self, change: impl FnOnce(&mut VolumeState)) {
        let mut state = self.lock();
        change(&mut state);
        #[cfg(feature = "audio")]
        if state.has_begun
            && let Some(live) = self.live.as_ref().and_then(Weak::upgrade)
        {
            live.set_volume(state.chosen);
        }
    }

    fn begin(&self) {
        self.change(|state| state.has_begun = true);
    }
}

/// The level below which the balance of both channels is not shown, 0 to 1: −60 dB.
#[cfg(feature = "audio")]
const SILENT_LEVEL: f32 = 1e-3;

impl Speaker {
    /// Starts the sound. This call never fails: without a device the window is silent and reports the reason.
    pub fn start(options: &DemoOptions) -> Speaker {
        #[cfg(feature = "audio")]
        let live = start(options).map(Arc::new);
        Speaker {
            law: law_of(options),
            panning: Panning::default(),
            is_in_full: false,
            volume: Arc::new(Volume {
                #[cfg(feature = "audio")]
                live: live.as_ref().map(Arc::downgrade),
                state: Mutex::new(VolumeState {
                    has_begun: false,
                    chosen: options.volume,
                }),
            }),
            #[cfg(feature = "audio")]
            played_pan: None,
            #[cfg(feature = "audio")]
            live,
        }
    }

    /// Fades the sound in, because it is known where it comes from.
    pub fn begin(&self) {
        if !self.volume.state().has_begun {
            self.volume.begin();
        }
    }

    /// The pan of the sound that is played, −1 to 1: with a device from the levels of both channels by the law of
    /// constant power, kept during pauses; otherwise the pan of the last frame. `None` before any sound.
    pub fn played_pan(&mut self) -> Option<f32> {
        #[cfg(feature = "audio")]
        if let Some(live) = &self.live
            && live.status().device.is_some()
        {
            let [left, right] = live.levels();
            if left.max(right) > SILENT_LEVEL {
                self.played_pan = Some(pan_of_levels(left, right, self.played_law()));
            }
            return self.played_pan;
        }
        self.volume
            .state()
            .has_begun
            .then(|| self.panning.pan() as f32)
    }

    /// The law of the played channels.
    #[cfg(feature = "audio")]
    fn played_law(&self) -> PanningLaw {
        match self.is_in_full {
            true => PanningLaw::ConstantPower,
            false => self.law,
        }
    }

    /// Sets the panning of the last frame. The call takes no lock.
    pub fn set_panning(&mut self, panning: Panning) {
        self.panning = panning;
        #[cfg(feature = "audio")]
        if let Some(live) = &self.live {
            live.set_panning(panning.left, panning.right);
        }
    }

    /// Sets the panning law.
    pub fn set_law(&mut self, law: PanningLaw) {
        self.law = law;
        #[cfg(feature = "audio")]
        if let Some(live) = &self.live {
            live.set_law(law);
        }
    }

    /// Sets the loudness, 0 to 1.
    pub fn set_volume(&self, volume: f32) {
        self.volume.change(|state| state.chosen = volume);
    }

    /// Changes the sound.
    ///
    /// # Errors
    /// The reason, in one sentence.
    pub fn set_sound(&mut self, sound: &str) -> Result<(), String> {
        #[cfg(feature = "audio")]
        if let Some(live) = &self.live {
            live.set_sound(sound.parse().map_err(to_sentence)?);
        }
        // Without the feature `audio`, the choice of sound has no effect.
        let _ = sound;
        Ok(())
    }

    /// Plays the sources of a scene in full listening, instead of one sound with its pan. The first response begins the
    /// sound.
    pub fn play_in_full(&mut self, ears: &Ears, scene: &Scene, sound: &str) {
        self.is_in_full = true;
        #[cfg(feature = "audio")]
        if let Some(live) = &self.live
            && let Ok(spec) = sound.parse()
        {
            let volume = Arc::clone(&self.volume);
            live.set_stereo(Some(ears.source(scene, &spec)));
            ears.when_heard(move || volume.begin());
        }
        // Without the feature `audio`, the window is silent.
        let _ = (ears, scene, sound);
    }

    /// Plays one sound with its pan.
    pub fn play_balance(&mut self) {
        self.is_in_full = false;
        #[cfg(feature = "audio")]
        if let Some(live) = &self.live {
            live.set_stereo(None);
        }
    }

    /// The level of each channel, 0 to 1: the played level, or without a player the level computed from the gains.
    pub fn levels(&self) -> [f32; 2] {
        #[cfg(feature = "audio")]
        if let Some(live) = &self.live
            && live.status().device.is_some()
        {
            return live.levels();
        }
        let gains = self.law.gains(self.panning.pan() as f32);
        [gains.left, gains.right].map(|gain| gain * self.volume.state().chosen)
    }

    /// The status of the sound.
    pub fn status(&self) -> SoundStatus {
        #[cfg(feature = "audio")]
        if let Some(live) = &self.live {
            return of_live(&live.status());
        }
        SoundStatus {
            text: SILENT.into(),
            ..SoundStatus::default()
        }
    }

    /// Begins a recording, or ends the one in progress. Returns the number of audio frames that the recording lost.
    ///
    /// # Errors
    /// The reason, in one sentence.
    pub fn record(&mut self, path: Option<&Path>) -> Result<u64, String> {
        #[cfg(feature = "audio")]
        if let Some(live) = &self.live {
            match path {
                Some(path) => live.start_recording(path).map_err(to_sentence)?,
                None => {
                    let frames = live.stop_recording().map_err(to_sentence)?;
                    if frames == 0 {
                        return Err("it is empty: no sound device played".to_owned());
                    }
                }
            }
            return Ok(live.status().dropped_frames);
        }
        let _ = path;
        Err(format!("{SILENT}: nothing to record"))
    }
}

/// The initial panning law.
fn law_of(options: &DemoOptions) -> PanningLaw {
    let usual = PanningLaw::for_profile(options.settings.profile());
    options.law.unwrap_or(usual)
}

/// The pan, −1 to 1, at which a law gives both channels these levels.
#[cfg(feature = "audio")]
fn pan_of_levels(left: f32, right: f32, law: PanningLaw) -> f32 {
    match law {
        PanningLaw::Linear => (right - left) / (right + left),
        PanningLaw::ConstantPower => right.atan2(left) / std::f32::consts::FRAC_PI_4 - 1.0,
    }
}

/// The message of a build without the feature `audio`.
#[cfg(not(feature = "audio"))]
const SILENT: &str = "silent: built without sound";
/// The message if there is no player.
#[cfg(feature = "audio")]
const SILENT: &str = "silent: the sound is unknown";

#[cfg(feature = "audio")]
fn start(options: &DemoOptions) -> Option<Live> {
    let live = LiveOptions {
        device: options.device.clone(),
        buffer_frames: options.buffer,
        law: law_of(options),
        volume: 0.0,
    };
    // The sound was checked when the options were parsed.
    options
        .sound
        .parse()
        .ok()
        .map(|sound| Live::start(sound, live))
}

#[cfg(feature = "audio")]
fn to_sentence(error: impl std::fmt::Display) -> String {
    error.to_string()
}

#[cfg(feature = "audio")]
fn of_live(status: &LiveStatus) -> SoundStatus {
    let text = match (&status.device, &status.last_error) {
        (Some(device), _) => {
            let buffer = status.buffer_frames;
            let khz = f64::from(status.sample_rate) / 1000.0;
            let late = status.under_runs + status.late_callbacks;
            let plays = format!("{device}: {khz} kHz, {buffer} frames, {late} late");
            match &status.notice {
                Some(notice) if status.has_sound => format!("{notice} ({plays})"),
                Some(notice) => format!("silent: {notice}"),
                None => plays,
            }
        }
        (None, Some(error)) => format!("silent: {error}"),
        (None, None) => "silent: no sound device yet".to_owned(),
    };
    let is_open = status.device.is_some();
    let is_heard = is_open && status.has_sound;
    SoundStatus {
        text,
        is_heard,
        sample_rate: is_open.then_some(status.sample_rate),
        buffer: is_open.then_some(status.buffer_frames),
        underruns: status.under_runs + status.late_callbacks,
        restarts: status.restarts,
        gains_to_buffer: status.pan_waited_ms.filter(|_| is_heard),
        buffer_to_device: status.latency_ms.filter(|_| is_heard),
        is_recording: status.is_recording,
        dropped_frames: status.dropped_frames,
    }
}

#[cfg(all(test, feature = "audio"))]
mod tests {
    use super::*;

    fn playing() -> LiveStatus {
        let mut status = LiveStatus::default();
        status.device = Some("Attic".to_owned());
        (status.sample_rate, status.buffer_frames) = (48_000, 1024);
        status.latency_ms = Some(20.0);
        status.late_callbacks = 2;
        status.has_sound = true;
        status.last_error = Some("the sound device Cellar is lost".to_owned());
        status
    }

    /// Protects the marker of the balance: it is at the pan whose gains the channels have, with both laws.
    #[test]
    fn the_marker_is_at_the_pan_of_the_levels() {
        for law in [PanningLaw::Linear, PanningLaw::ConstantPower] {
            for pan in [-1.0, -0.4, 0.0, 0.7, 1.0] {
                let gains = law.gains(pan);
                let found = pan_of_levels(0.1 * gains.left, 0.1 * gains.right, law);
                assert!((found - pan).abs() < 1e-5, "{law}: {found}, not {pan}");
            }
        }
    }

    /// Protects the panel's message: an earlier loss of the device is no longer shown. A sound that could not be loaded
    /// is reported even though the device plays.
    #[test]
    fn what_went_wrong_is_shown_while_a_device_is_open() {
        let well = of_live(&playing());
        assert!(well.is_heard && well.text == "Attic: 48 kHz, 1024 frames, 2 late");
        let notice = Some("cannot open the sound file drum.wav".to_owned());
        let mut status = playing();
        status.notice = notice;
        let old_sound = of_live(&status);
        assert!(old_sound.is_heard && old_sound.text.contains("drum.wav (Attic"));
        status.has_sound = false;
        let none = of_live(&status);
        assert!(!none.is_heard && none.text.contains("silent: cannot open"));
    }
}
