//! Full listening for the page.

use crate::{scene, settings, thrown};
use echomarch::Scene;
use echomarch::gl::Context;
use echomarch::glam::Vec3;
use echomarch::response::PathKind;
use echomarch_walk::{Ears, HeardMessage, Parts, WalkState, Walker};
use wasm_bindgen::prelude::*;
use web_sys::WebGl2RenderingContext;

/// Sample rate of responses before the rate of the mix is known, which are not played.
const USUAL_RATE_HZ: u32 = 48_000;

/// Traces full listening on an off-screen canvas.
#[wasm_bindgen]
pub struct EarsOfPage {
    ears: Ears,
    parts: Parts,
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
    /// Creates ears on the context of a worker. `set_rate` must be called before their responses are played.
    #[wasm_bindgen(constructor)]
    pub fn new(gl: WebGl2RenderingContext) -> Result<EarsOfPage, JsError> {
        let context = Context::from_webgl2(gl).map_err(thrown)?;
        Ok(EarsOfPage {
            ears: Ears::new(&context).map_err(thrown)?,
            parts: Parts::default(),
            base: None,
            is_new_mix: true,
            rate_hz: USUAL_RATE_HZ,
        })
    }

    /// Sets the sample rate of the mix.
    pub fn set_rate(&mut self, rate_hz: u32) {
        self.rate_hz = rate_hz;
    }

    /// Sets the scene for a new mix.
    pub fn set_scene(&mut self, text: &str, name: &str) -> Result<(), JsError> {
        let base = scene(text, name)?;
        if self.base.as_ref() != Some(&base) {
            self.ears.forget_scene();
        }
        self.base = Some(base);
        self.is_new_mix = true;
        Ok(())
    }

    /// Sets the parts of the sound that are heard, and the least level of a source in decibels; NaN for none.
    pub fn set_parts(
        &mut self,
        diffraction: bool,
        transmission: bool,
        mirrored: bool,
        late: bool,
        least_level_db: f64,
    ) {
        let least_level_db = Some(least_level_db).filter(|level| !level.is_nan());
        self.parts = self.parts.with_least_level(least_level_db);
        self.parts.diffraction = diffraction;
        self.parts.transmission = transmission;
        self.parts.mirrored = mirrored;
        self.parts.late = late;
    }

    /// Traces each source in the given state of the scene. The state has the named values, the time along the paths in
    /// seconds, the listener (x, y, z, yaw, pitch) and the first source (x, y, z). Returns the responses that have
    /// changed. `is_sketch` traces no waves: the responses are those of [`Ears::sketch`].
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
        is_sketch: bool,
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
        let (parts, rate_hz) = (&self.parts, self.rate_hz);
        let heard = if is_sketch {
            self.ears.sketch(&scene, &settings, parts, rate_hz)
        } else {
            (self.ears).hear(&scene, &settings, parts, rate_hz, self.is_new_mix)
        };
        let heard = heard.map_err(thrown)?;
        if !is_sketch {
            self.is_new_mix = false;
        }
        Ok(heard
            .into_iter()
            .map(|message| HeardByPage { message })
            .collect())
    }

    /// Three numbers for each source in the last call of `hear`: its strength G in decibels (NaN for silence), the
    /// number of exact paths, and 1 if the direct sound is among them.
    pub fn sources(&self) -> Vec<f64> {
        let numbers = |source: &echomarch::auralisation::HeardSource| {
            let level = source.level_db.unwrap_or(f64::NAN);
            let direct = if source.is_direct { 1.0 } else { 0.0 };
            [level, source.paths as f64, direct]
        };
        self.ears.sources().iter().flat_map(numbers).collect()
    }

    /// For each source in the last call of `hear`: the paths by kind and the late part, with their levels, as text. If
    /// nothing arrives, the text names the likely reason.
    pub fn source_texts(&self) -> Vec<String> {
        let sources = self.ears.sources().iter().zip(self.ears.silences());
        let text = |(source, silence): (&echomarch::auralisation::HeardSource, &Option<String>)| {
            silence.clone().unwrap_or_else(|| source.to_string())
        };
        sources.map(text).collect()
    }

    /// The exact paths of the last call of `hear` for the plan, one after the other. Each has the index of its kind in
    /// `path_kinds`, the number of points, and the x and z of each point.
    pub fn paths(&self) -> Vec<f32> {
        let mut numbers = Vec::new();
        for path in self.ears.paths() {
            let Some(kind) = PathKind::ALL.iter().position(|kind| *kind == path.kind) else {
                continue;
            };
            numbers.extend([kind as f32, path.points.len() as f32]);
            numbers.extend(path.points.iter().flat_map(|point| [point.x, point.z]));
        }
        numbers
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

    /// The gain of the scene's sound, an amplitude factor.
    #[wasm_bindgen(getter)]
    pub fn gain(&self) -> f32 {
        self.message.gain
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
