//! The sound of the window: receives the gains, reports the device's status.
//!
//! With the feature `audio` sound is played through [`echomarch::audio::live`]; without this
//! feature the window is silent and a message states why.

use super::DemoOptions;
use super::ears::Ears;
use echomarch::audio::PanningLaw;
#[cfg(feature = "audio")]
use echomarch::audio::live::{Live, LiveOptions, LiveStatus};
use echomarch::scene::Scene;
use echomarch::tracer::Panning;
use serde::Serialize;
use std::path::Path;

/// The sounds that can be chosen in the window, besides the one it was started with.
pub const SOUNDS: [&str; 5] = ["speech", "noise", "sine:220", "sine:440", "sine:880"];

/// The status of the sound.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SoundStatus {
    /// One line for people.
    pub text: String,
    /// Whether sound is audible.
    pub is_heard: bool,
    /// Samples a second.
    pub sample_rate: Option<u32>,
    /// Buffer size of the device in samples.
    pub buffer: Option<u32>,
    /// Number of late buffers: reported as late by the device, or delayed by more than two buffers.
    pub underruns: u64,
    /// Number of times that the device was reopened.
    pub restarts: u64,
    /// Milliseconds that the gains waited for the sound thread to take them.
    pub gains_to_buffer: Option<f64>,
    /// Milliseconds from the sound thread to the ear, as reported by the device.
    pub buffer_to_device: Option<f64>,
    /// Whether a recording is in progress.
    pub is_recording: bool,
    /// Frames lost by the present or last recording.
    pub dropped_frames: u64,
}

/// The sound output.
pub struct Speaker {
    law: PanningLaw,
    volume: f32,
    panning: Panning,
    #[cfg(feature = "audio")]
    live: Option<Live>,
}

impl Speaker {
    /// Starts the sound. Never fails: without a device the window is silent and reports that.
    pub fn start(options: &DemoOptions) -> Speaker {
        let speaker = Speaker {
            law: law_of(options),
            volume: options.volume,
            panning: Panning::default(),
            #[cfg(feature = "audio")]
            live: start(options),
        };
        #[cfg(feature = "audio")]
        if let Some(live) = &speaker.live {
            live.set_volume(options.volume);
        }
        speaker
    }

    /// Sets the panning from the last frame; takes no lock.
    pub fn set_panning(&mut self, panning: Panning) {
        self.panning = panning;
        #[cfg(feature = "audio")]
        if let Some(live) = &self.live {
            live.set_panning(panning.left, panning.right);
        }
    }

    /// Sets the law from pan to gains.
    pub fn set_law(&mut self, law: PanningLaw) {
        self.law = law;
        #[cfg(feature = "audio")]
        if let Some(live) = &self.live {
            live.set_law(law);
        }
    }

    /// Sets the loudness, 0 to 1.
    pub fn set_volume(&mut self, volume: f32) {
        self.volume = volume;
        #[cfg(feature = "audio")]
        if let Some(live) = &self.live {
            live.set_volume(volume);
        }
    }

    /// Changes the sound.
    ///
    /// # Errors
    /// The error as a sentence.
    pub fn set_sound(&mut self, sound: &str) -> Result<(), String> {
        #[cfg(feature = "audio")]
        if let Some(live) = &self.live {
            live.set_sound(sound.parse().map_err(to_sentence)?);
        }
        // Without audio only the name is kept.
        let _ = sound;
        Ok(())
    }

    /// Plays the sources of a scene in full listening, in place of one sound with its pan.
    pub fn play_in_full(&mut self, ears: &Ears, scene: &Scene, sound: &str) {
        #[cfg(feature = "audio")]
        if let Some(live) = &self.live
            && let Ok(spec) = sound.parse()
        {
            live.set_stereo(Some(ears.source(scene, &spec)));
        }
        // Without audio nothing is played.
        let _ = (ears, scene, sound);
    }

    /// Plays one sound with its pan.
    pub fn play_balance(&mut self) {
        #[cfg(feature = "audio")]
        if let Some(live) = &self.live {
            live.set_stereo(None);
        }
    }

    /// The level of each channel, 0 to 1: as played, or as computed from the gains.
    pub fn levels(&self) -> [f32; 2] {
        #[cfg(feature = "audio")]
        if let Some(live) = &self.live
            && live.status().device.is_some()
        {
            return live.levels();
        }
        let gains = self.law.gains(self.panning.pan() as f32);
        [gains.left, gains.right].map(|gain| gain * self.volume)
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

    /// Begins a recording, or ends the one in progress; returns the number of frames that it lost.
    ///
    /// # Errors
    /// The reason as a sentence.
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

/// The initial law.
fn law_of(options: &DemoOptions) -> PanningLaw {
    let usual = PanningLaw::for_profile(options.settings.profile());
    options.law.unwrap_or(usual)
}

/// The message without audio.
#[cfg(not(feature = "audio"))]
const SILENT: &str = "silent: built without sound";
/// The message without a player.
#[cfg(feature = "audio")]
const SILENT: &str = "silent: the sound is unknown";

#[cfg(feature = "audio")]
fn start(options: &DemoOptions) -> Option<Live> {
    let live = LiveOptions {
        device: options.device.clone(),
        buffer_frames: options.buffer,
        law: law_of(options),
    };
    // The sound was checked when it was typed.
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

    /// Protects the panel's message: an earlier loss of the device is no longer shown, and a sound
    /// that could not be loaded is reported although the device plays.
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
