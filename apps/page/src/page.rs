//! The picture, the plan, and the frames of waves.

use crate::{scene, settings, thrown};
use echomarch::gl::Context;
use echomarch::glam::Vec3;
use echomarch_walk::{MoveInput, ValueSlider, Visit, Walker, listener_names, source_names};
use wasm_bindgen::prelude::*;
use web_sys::WebGl2RenderingContext;

/// A walk through a scene on the page's canvas.
#[wasm_bindgen]
pub struct Page {
    context: Context,
    visit: Visit,
}

/// The scene from above.
#[wasm_bindgen]
pub struct PlanOfPage {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// The minimum world x and z, then the maximum world x and z, in metres.
    #[wasm_bindgen(getter_with_clone)]
    pub bounds: Vec<f32>,
    /// Red, green, blue and opacity of each pixel; empty if the plan is unchanged since the last call.
    #[wasm_bindgen(getter_with_clone)]
    pub rgba: Vec<u8>,
}

#[wasm_bindgen]
impl Page {
    /// Starts a walk through a scene on the context of a canvas.
    #[wasm_bindgen(constructor)]
    pub fn new(gl: WebGl2RenderingContext, text: &str, name: &str) -> Result<Page, JsError> {
        let context = Context::from_webgl2(gl).map_err(thrown)?;
        let visit = Visit::new(&context, scene(text, name)?).map_err(thrown)?;
        Ok(Page { context, visit })
    }

    /// The renderer's name, as reported by the driver.
    pub fn renderer(&self) -> String {
        self.context.renderer().to_owned()
    }

    /// Whether the renderer runs on the CPU.
    pub fn is_software(&self) -> bool {
        self.context.is_software()
    }

    /// Changes to another scene, or to another text of the current scene.
    pub fn set_scene(&mut self, text: &str, name: &str) -> Result<(), JsError> {
        self.visit.set_scene(scene(text, name)?).map_err(thrown)
    }

    /// Opens a scene in its initial state: listener, source and values are those of its text.
    pub fn open_scene(&mut self, text: &str, name: &str) -> Result<(), JsError> {
        self.visit.open_scene(scene(text, name)?).map_err(thrown)
    }

    /// Sets the settings for tracing.
    pub fn set_settings(&mut self, of: &str, waves: u32, iterations: u32) -> Result<(), JsError> {
        let settings = settings(of, waves, iterations)?;
        self.visit.set_settings(settings).map_err(thrown)
    }

    /// Advances time by `seconds`. `moves` has five numbers from −1 to 1: forward, right, up, turn to the right, tilt
    /// upwards.
    pub fn pass(&mut self, moves: &[f32], run: bool, seconds: f64) {
        let of = |index: usize| moves.get(index).copied().unwrap_or_default();
        let input = MoveInput {
            forward: of(0),
            right: of(1),
            up: of(2),
            turn: of(3),
            tilt: of(4),
            run,
        };
        self.visit.pass(&input, seconds);
    }

    /// Rotates the gaze to the right and upwards, by angles in radians.
    pub fn look(&mut self, right: f32, up: f32) {
        self.visit.look(right, up);
    }

    /// Picks the source up, or puts it down.
    pub fn pick_up_or_put_down(&mut self) {
        self.visit.pick_up_or_put_down();
    }

    /// Pauses or resumes the moving objects.
    pub fn pause_or_go_on(&mut self) {
        self.visit.pause_or_go_on();
    }

    /// Resets the source, the listener and the time to their initial state.
    pub fn start_over(&mut self) {
        self.visit.start_over();
    }

    /// The listener's position in metres and gaze in radians: x, y, z, yaw, pitch.
    pub fn listener(&self) -> Vec<f32> {
        let Some(walker) = self.visit.scene().listeners.first() else {
            return Vec::new();
        };
        let [x, y, z] = walker.position.to_array();
        vec![x, y, z, walker.yaw, walker.pitch]
    }

    /// Whether the listener has moved or turned since the start.
    pub fn has_walked(&self) -> bool {
        self.visit.walker().is_some()
    }

    /// Radius of the listener's sphere in metres.
    pub fn radius(&self) -> f32 {
        let walker = self.visit.scene().listeners.first();
        walker.map_or(0.0, |walker| walker.radius)
    }

    /// Sets the listener's position and gaze.
    pub fn stand(&mut self, x: f32, y: f32, z: f32, yaw: f32, pitch: f32) {
        let position = Vec3::new(x, y, z);
        let are_numbers = position.is_finite() && yaw.is_finite() && pitch.is_finite();
        if are_numbers {
            self.visit.stand(Walker {
                position,
                yaw,
                pitch,
            });
        }
    }

    /// The positions of the sources in metres, three numbers each.
    pub fn sources(&self) -> Vec<f32> {
        let sources = &self.visit.scene().sources;
        sources
            .iter()
            .flat_map(|source| source.position.to_array())
            .collect()
    }

    /// The warnings about the places of sources and listeners, such as a listener inside a solid.
    pub fn warnings_of_places(&self) -> Vec<String> {
        let warnings = self.visit.scene().warnings_of_places();
        warnings.iter().map(ToString::to_string).collect()
    }

    /// The other warnings about the scene, such as a box of `Rooms` without a way to the first one.
    pub fn warnings_of_shapes(&self) -> Vec<String> {
        let places = self.warnings_of_places();
        let warnings = self.visit.scene().warnings();
        let warnings = warnings.iter().map(ToString::to_string);
        warnings
            .filter(|warning| !places.contains(warning))
            .collect()
    }

    /// The names of the sources.
    pub fn source_names(&self) -> Vec<String> {
        source_names(self.visit.scene())
    }

    /// The names of the listeners; the first is the walker.
    pub fn listener_names(&self) -> Vec<String> {
        listener_names(self.visit.scene())
    }

    /// The positions of all listeners except the walker in metres, three numbers each.
    pub fn other_listeners(&self) -> Vec<f32> {
        let others = self.visit.scene().listeners.iter().skip(1);
        others
            .flat_map(|listener| listener.position.to_array())
            .collect()
    }

    /// The position of the first source in metres if the user has moved it or carries it; empty if the source follows
    /// its path.
    pub fn placed_source(&self) -> Vec<f32> {
        let placed = self.visit.placed_source();
        placed.map_or_else(Vec::new, |position| position.to_array().to_vec())
    }

    /// Sets the position of the first source.
    pub fn put_source(&mut self, x: f32, y: f32, z: f32) {
        let position = Vec3::new(x, y, z);
        if position.is_finite() {
            self.visit.put_source(position);
        }
    }

    /// Time along the scene's paths, in seconds.
    pub fn seconds(&self) -> f64 {
        self.visit.seconds()
    }

    /// The names of the scene's named values.
    pub fn value_names(&self) -> Vec<String> {
        self.visit
            .values()
            .map(|(slider, _)| slider.name.clone())
            .collect()
    }

    /// For each named value: its value, minimum, maximum and step (0 if the scene states none).
    pub fn values(&self) -> Vec<f32> {
        let numbers = |(slider, value): (&ValueSlider, f32)| {
            let (least, most) = (*slider.range.start(), *slider.range.end());
            [value, least, most, slider.step.unwrap_or(0.0)]
        };
        self.visit.values().flat_map(numbers).collect()
    }

    /// Sets a named value, in the unit of its file.
    pub fn set_value(&mut self, name: &str, value: f32) -> Result<(), JsError> {
        self.visit.set_value(name, value).map_err(thrown)
    }

    /// Traces waves for about `milliseconds` if the scene has changed. Returns whether a new frame is complete.
    pub fn trace(&mut self, milliseconds: f64) -> Result<bool, JsError> {
        let frame = self.visit.trace(milliseconds).map_err(thrown)?;
        Ok(frame.is_some())
    }

    /// The last frame as numbers: waves at the listener, dead, travelling, left, right, pan, milliseconds from start to
    /// result. Empty before the first frame of a scene.
    pub fn frame(&self) -> Vec<f64> {
        let Some(frame) = self.visit.frame() else {
            return Vec::new();
        };
        let (counts, panning) = (&frame.counts, &frame.panning);
        vec![
            counts.listener_hits as f64,
            counts.dead as f64,
            counts.travelling as f64,
            panning.left,
            panning.right,
            panning.pan(),
            frame.milliseconds.total,
        ]
    }

    /// Draws the listener's view on the canvas of `width` × `height` pixels. `scale` is the ratio of the picture's
    /// resolution to that of the canvas. Returns whether the picture is new.
    pub fn draw(&mut self, width: u32, height: u32, scale: f32) -> Result<bool, JsError> {
        self.visit.draw([width, height], scale).map_err(thrown)
    }

    /// The scene from above.
    pub fn plan(&mut self) -> PlanOfPage {
        let (plan, is_new) = self.visit.plan();
        let opaque = |rgb: &[u8]| [rgb[0], rgb[1], rgb[2], u8::MAX];
        let (min, max) = (plan.bounds.min, plan.bounds.max);
        PlanOfPage {
            width: plan.size[0] as u32,
            height: plan.size[1] as u32,
            bounds: vec![min.x, min.y, max.x, max.y],
            rgba: match is_new {
                true => plan.rgb.chunks_exact(3).flat_map(opaque).collect(),
                false => Vec::new(),
            },
        }
    }

    /// Paths of waves for the plan, one after the other. Each has a status (0 dead, 1 travelling, 2 at the listener),
    /// the number of points, and the x and z of each point.
    pub fn ways(&mut self) -> Result<Vec<f32>, JsError> {
        let mut numbers = Vec::new();
        for way in self.visit.ways().map_err(thrown)? {
            use echomarch::tracer::Fate;
            numbers.push(match way.fate {
                Fate::Dead | Fate::NotFinite => 0.0,
                Fate::Travelling => 1.0,
                Fate::Listener => 2.0,
            });
            numbers.push(way.points.len() as f32);
            numbers.extend(way.points.iter().flat_map(|point| [point.x, point.z]));
        }
        Ok(numbers)
    }
}
