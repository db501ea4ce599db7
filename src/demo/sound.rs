//! The sound of the window: gains in, what the device does out.

use super::DemoOptions;
use crate::audio::PanningLaw;
use crate::trace::Panning;
use serde::Serialize;

/// The sounds that can be chosen in the window, beside the one it was started with.
pub const SOUNDS: [&str; 4] = ["noise", "sine:220", "sine:440", "sine:880"];

/// How the sound fares.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SoundStatus {
    /// One line for people.
    pub text: String,
    /// Whether anything is to be heard.
    pub is_heard: bool,
    /// Buffers that came too late.
    pub underruns: u64,
    /// Milliseconds until the sound's thread has taken new gains.
    pub gains_to_buffer: Option<f64>,
    /// Milliseconds from there to the ear, as the device says.
    pub buffer_to_device: Option<f64>,
    /// Whether what is heard is recorded.
    pub is_recording: bool,
}

/// Where the gains go.
pub struct Speaker {
    law: PanningLaw,
    volume: f32,
    panning: Panning,
}

impl Speaker {
    /// Starts the sound. Never fails: without a device it is silent and says so.
    pub fn start(options: &DemoOptions) -> Speaker {
        Speaker {
            law: options.law,
            volume: options.volume,
            panning: Panning::default(),
        }
    }

    /// What arrived at the ears; takes no lock.
    pub fn set_panning(&mut self, panning: Panning) {
        self.panning = panning;
    }

    /// From pan to gains.
    pub fn set_law(&mut self, law: PanningLaw) {
        self.law = law;
    }

    /// Loudness, 0 to 1.
    pub fn set_volume(&mut self, volume: f32) {
        self.volume = volume;
    }

    /// Another sound. What is wrong with it, if it cannot be had.
    pub fn set_sound(&mut self, _sound: &str) -> Result<(), String> {
        Ok(())
    }

    /// Level of either channel, 0 to 1.
    pub fn levels(&self) -> [f32; 2] {
        let gains = self.law.gains(self.panning.pan() as f32);
        [gains.left, gains.right].map(|gain| gain * self.volume)
    }

    /// How it fares.
    pub fn status(&self) -> SoundStatus {
        SoundStatus {
            text: "silent: built without sound".into(),
            ..SoundStatus::default()
        }
    }

    /// Begins or ends a recording; what was done, for people.
    pub fn record(&mut self, _path: Option<&std::path::Path>) -> Result<(), String> {
        Err("built without sound: nothing to record".into())
    }
}
