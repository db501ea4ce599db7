//! The plan of a scene.

use super::plan::{Bounds, Plan};
use super::{PictureError, marks, names, path_legend, scale_bar, shader, wave_paths};
use crate::error::Error;
use crate::gpu::Context;
use crate::scene::Scene;
use crate::trace::{Settings, Tracer, Wave};
use image::RgbaImage;
use tiny_skia::PixmapMut;

/// Options of a slice.
#[derive(Clone, Debug, PartialEq)]
pub struct SliceOptions {
    /// Width in pixels; the height follows from the bounds.
    pub width: u32,
    /// World y of the cut in metres; `None` for the listener's.
    pub height: Option<f32>,
    /// The part shown; `None` for [`Bounds::of`] the scene.
    pub bounds: Option<Bounds>,
    /// Number of waves whose paths are drawn.
    pub paths: u32,
    /// Previously traced paths, as returned by [`Tracer::paths`]; drawn over the others.
    pub also: Vec<Vec<Wave>>,
    /// Settings of these waves; `waves` is taken from `paths`.
    pub settings: Settings,
    /// Whether a scale bar is drawn in the lower left, and a legend of the path colours in the upper left.
    pub scale_bar: bool,
}

impl Default for SliceOptions {
    /// 800 pixels wide, at the listener's height, no paths, with a scale bar.
    fn default() -> SliceOptions {
        SliceOptions {
            width: 800,
            height: None,
            bounds: None,
            paths: 0,
            also: Vec::new(),
            settings: Settings::default(),
            scale_bar: true,
        }
    }
}

/// The scene cut at a height and seen from above: x to the right, z downwards. Listeners, sources, their key-framed
/// paths and the paths of waves are drawn on top, whatever their height. Waves are those of the first source and the
/// first listener; further sources and listeners are paler.
///
/// # Errors
/// [`Error::Picture`] for an impossible size or bounds, [`Error::Scene`] and [`Error::Trace`] for
/// input that cannot be traced, [`Error::Gpu`] when the renderer fails.
pub fn slice(
    tracer: &mut Tracer,
    scene: &Scene,
    options: &SliceOptions,
) -> Result<RgbaImage, Error> {
    let context = tracer.context().clone();
    scene.validate()?;
    let height = options.height.unwrap_or(scene.listener.position.y);
    if !height.is_finite() {
        let what = format!("a height of {height}");
        return Err(PictureError::Bounds { what }.into());
    }
    let bounds = options.bounds.unwrap_or_else(|| Bounds::of(scene, height));
    shader::check_size(&context, options.width, 1)?;
    let plan = Plan::new(bounds, options.width)?;
    let mut picture = cut(&context, scene, height, &plan)?;
    let paths = match options.paths {
        0 => Vec::new(),
        waves => tracer.paths(scene, &options.settings.clone().with_waves(waves))?,
    };
    // Opaque pixels are the same with and without premultiplied opacity.
    if let Some(mut canvas) = PixmapMut::from_bytes(&mut picture, plan.width, plan.height) {
        let mut fates = wave_paths::draw(&mut canvas, &plan, scene, &paths);
        fates.extend(wave_paths::draw(&mut canvas, &plan, scene, &options.also));
        marks::draw(&mut canvas, &plan, scene);
        names::draw(&mut canvas, &plan, scene);
        if options.scale_bar {
            scale_bar::draw(&mut canvas, &plan);
            path_legend::draw(&mut canvas, &plan, &fates);
        }
    }
    Ok(picture)
}

/// The scene cut at a height, without marks.
pub(super) fn cut(
    context: &Context,
    scene: &Scene,
    height: f32,
    plan: &Plan,
) -> Result<RgbaImage, Error> {
    shader::check_size(context, plan.width, plan.height)?;
    let shader = shader::program(context, scene, shader::Kind::Slice)?;
    let program = &shader.program;
    program.set_vec2("uCorner", plan.corner);
    program.set_f32("uMetres", plan.metres);
    program.set_f32("uHeight", height);
    program.set_f32("uRows", plan.height as f32);
    program.set_f32("uLine", 1.6 * plan.stroke());
    program.set_f32("uIsoline", isoline(plan.metres));
    shader::draw(context, &shader, plan.width, plan.height)
}

/// Metres between two lines of equal distance: 1, or more to leave 12 pixels between them.
fn isoline(metres: f32) -> f32 {
    let least = 12.0 * metres;
    if (0.1..=1.0).contains(&least) {
        return 1.0;
    }
    10f32.powf(least.log10().ceil())
}
