//! What is heard, as samples.

use crate::{listen, profile, scene, thrown};
use echomarch::audio::SoundSpec;
use echomarch::walkthrough::{HeardMessage, Mix};
use wasm_bindgen::prelude::*;

/// Mixes into slices.
#[wasm_bindgen]
pub struct MixOfPage {
    mix: Mix,
}

#[wasm_bindgen]
impl MixOfPage {
    /// The sounds of a scene's sources at so many samples a second.
    #[wasm_bindgen(constructor)]
    pub fn new(text: &str, name: &str, sound: &str, rate_hz: u32) -> Result<MixOfPage, JsError> {
        let mix = Mix::new(&scene(text, name)?, &sound_of(sound)?, rate_hz).map_err(thrown)?;
        Ok(MixOfPage { mix })
    }

    /// Another scene or another sound; what was played fades out first.
    pub fn set_scene(&mut self, text: &str, name: &str, sound: &str) -> Result<(), JsError> {
        let (scene, sound) = (scene(text, name)?, sound_of(sound)?);
        self.mix.set_scene(&scene, &sound).map_err(thrown)
    }

    /// What is listened to: `full` or `balance`.
    pub fn set_listen(&mut self, name: &str) -> Result<(), JsError> {
        self.mix.set_listen(listen(name)?);
        Ok(())
    }

    /// Loudness, 0 to 1.
    pub fn set_volume(&mut self, volume: f32) {
        self.mix.set_volume(volume);
    }

    /// The balance, −1 to 1, as waves of that profile give it.
    pub fn set_pan(&mut self, of: &str, pan: f32) -> Result<(), JsError> {
        self.mix.set_pan(profile(of)?, pan);
        Ok(())
    }

    /// Glides to what is heard of a source; false, and nothing changes, if too much is under way: it has to be told
    /// again. What is told of a source that the scene does not have any more is dropped.
    pub fn hear(
        &mut self,
        source: u32,
        echoes: Vec<f64>,
        late: Option<Vec<f32>>,
        glide_s: f64,
    ) -> bool {
        let message = HeardMessage {
            source: source as usize,
            echoes,
            late,
            glide_s,
        };
        self.mix.hear(message).unwrap_or(true)
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
