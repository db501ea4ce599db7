//! Full listening for the page.

use crate::{scene, settings, thrown};
use echomarch::Scene;
use echomarch::gl::Context;
use echomarch::glam::Vec3;
use echomarch_walk::{Ears, HeardMessage, WalkState, Walker};
use wasm_bindgen::prelude::*;
use web_sys::WebGl2RenderingContext;

/// Traces full listening on an off-screen canvas.
#[wasm_bindgen]
pub struct EarsOfPage {
    ears: Ears,
    base: Option<Scene>,
    is_new_mix: bool,
    rate_hz: u32,
}

/// The response of one source.
#[wasm_bindgen]
pub struct HeardByPage {
    message: HeardMessage,
}

#[wasm_bindgen]
impl EarsOfPage {
    /// Creates ears on the context of a worker, for a mix with the sample rate `rate_hz`.
    #[wasm_bindgen(constructor)]
    pub fn new(gl: WebGl2RenderingContext, rate_hz: u32) -> Result<EarsOfPage, JsError> {
        let context = Context::from_webgl2(gl).map_err(thrown)?;
        Ok(EarsOfPage {
            ears: Ears::new(&context).map_err(thrown)?,
            base: None,
            is_new_mix: true,
            rate_hz,
        })
    }

    /// Sets the scene for a new mix.
    pub fn set_scene(&mut self, text: &str, name: &str) -> Result<(), JsError> {
        self.base = Some(scene(text, name)?);
        self.is_new_mix = true;
        Ok(())
    }

    /// Traces each source in the given state of the scene. The state has the named values, the time along the paths in
    /// seconds, the listener (x, y, z, yaw, pitch) and the first source (x, y, z). Returns the responses that have
    /// changed.
    #[allow(clippy::too_many_arguments)]
    pub fn hear(
        &mut self,
        names: Vec<String>,
        values: &[f32],
        seconds: f64,
        listener: &[f32],
        source: &[f32],
        profile: &str,
        waves: u32,
    ) -> Result<Vec<HeardByPage>, JsError> {
        let Some(base) = &self.base else {
            return Ok(Vec::new());
        };
        let standing = WalkState {
            values: names.into_iter().zip(values.iter().copied()).collect(),
            seconds,
            walker: walker(listener),
            source: position(source),
        };
        let scene = standing.scene(base).map_err(thrown)?;
        let settings = settings(profile, waves, 1)?;
        let heard = self
            .ears
            .hear(&scene, &settings, self.rate_hz, self.is_new_mix)
            .map_err(thrown)?;
        self.is_new_mix = false;
        Ok(heard
            .into_iter()
            .map(|message| HeardByPage { message })
            .collect())
    }

    /// Three numbers for each source in the last call of `hear`: its strength G in decibels (NaN for silence), the
    /// number of exact paths, and 1 if the direct sound is among them.
    pub fn sources(&self) -> Vec<f64> {
        let numbers = |source: &echomarch::response::HeardSource| {
            let level = source.level_db.unwrap_or(f64::NAN);
            let direct = if source.is_direct { 1.0 } else { 0.0 };
            [level, source.paths as f64, direct]
        };
        self.ears.sources().iter().flat_map(numbers).collect()
    }

    /// Duration of the last trace, and of its late part, in milliseconds.
    pub fn milliseconds(&self) -> Vec<f64> {
        self.ears.milliseconds().to_vec()
    }
}

#[wasm_bindgen]
impl HeardByPage {
    /// Index of the source, from 0.
    #[wasm_bindgen(getter)]
    pub fn source(&self) -> u32 {
        self.message.source as u32
    }

    /// The echoes of the source, encoded as numbers.
    #[wasm_bindgen(getter)]
    pub fn echoes(&self) -> Vec<f64> {
        self.message.echoes.clone()
    }

    /// The samples of the late part; `None` if the late part is unchanged.
    #[wasm_bindgen(getter)]
    pub fn late(&self) -> Option<Vec<f32>> {
        self.message.late.clone()
    }

    /// Glide time from the previous echoes to these, in seconds.
    #[wasm_bindgen(getter)]
    pub fn glide_s(&self) -> f64 {
        self.message.glide_s
    }
}

fn position(numbers: &[f32]) -> Option<Vec3> {
    let [x, y, z, ..] = *numbers else {
        return None;
    };
    Some(Vec3::new(x, y, z))
}

fn walker(numbers: &[f32]) -> Option<Walker> {
    let [_, _, _, yaw, pitch] = *numbers else {
        return None;
    };
    let position = position(numbers)?;
    Some(Walker {
        position,
        yaw,
        pitch,
    })
}
