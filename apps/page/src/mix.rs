//! The sound of the page as samples.

use crate::{listen, profile, scene, thrown};
use echomarch::audio::SoundSpec;
use echomarch_walk::{HeardMessage, Mix};
use wasm_bindgen::prelude::*;

/// Mixes all sources into blocks of samples.
#[wasm_bindgen]
pub struct MixOfPage {
    mix: Mix,
}

#[wasm_bindgen]
impl MixOfPage {
    /// Creates a mix for a scene's sources with the sample rate `rate_hz`.
    #[wasm_bindgen(constructor)]
    pub fn new(text: &str, name: &str, sound: &str, rate_hz: u32) -> Result<MixOfPage, JsError> {
        let mix = Mix::new(&scene(text, name)?, &sound_of(sound)?, rate_hz).map_err(thrown)?;
        Ok(MixOfPage { mix })
    }

    /// Changes to another scene or another sound. The previous sound fades out first.
    pub fn set_scene(&mut self, text: &str, name: &str, sound: &str) -> Result<(), JsError> {
        let (scene, sound) = (scene(text, name)?, sound_of(sound)?);
        self.mix.set_scene(&scene, &sound).map_err(thrown)
    }

    /// Sets the listening mode: `full` or `balance`.
    pub fn set_listen(&mut self, name: &str) -> Result<(), JsError> {
        self.mix.set_listen(listen(name)?);
        Ok(())
    }

    /// Sets the volume, 0 to 1.
    pub fn set_volume(&mut self, volume: f32) {
        self.mix.set_volume(volume);
    }

    /// Sets the pan of the balance, −1 to 1 (NaN before the first frame of waves), with the panning law of the profile `of`.
    pub fn set_pan(&mut self, of: &str, pan: f32) -> Result<(), JsError> {
        self.mix.set_pan(profile(of)?, pan);
        Ok(())
    }

    /// Glides to a new response of a source. If too many glides are in progress, returns false and changes nothing; the
    /// caller must call it again later. A response of a source that no longer exists is discarded.
    pub fn hear(
        &mut self,
        source: u32,
        echoes: Vec<f64>,
        late: Option<Vec<f32>>,
        gain: f32,
        glide_s: f64,
    ) -> bool {
        let message = HeardMessage {
            source: source as usize,
            echoes,
            late,
            gain,
            glide_s,
        };
        self.mix.hear(message).unwrap_or(true)
    }

    /// The largest attenuation by the limiter since the last call, in decibels, 0 or more.
    pub fn limited_db(&self) -> f32 {
        self.mix.limited_db()
    }

    /// Whether the scene is heard: a response, or the pan of its balance, is played.
    pub fn is_heard(&self) -> bool {
        self.mix.is_heard()
    }

    /// The next samples of both channels, interleaved.
    pub fn fill(&mut self, frames: usize) -> Vec<f32> {
        let mut stereo = vec![0.0; 2 * frames];
        self.mix.fill(&mut stereo);
        stereo
    }
}

fn sound_of(name: &str) -> Result<SoundSpec, JsError> {
    name.parse().map_err(thrown)
}
