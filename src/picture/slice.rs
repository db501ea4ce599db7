//! The shader of a picture, the pass that draws it, and the plan of a scene.

use super::plan::{Bounds, Plan};
use super::{PictureError, labels, marks};
use crate::error::Error;
use crate::gl::{Context, Picture, Program, full_screen_pass_rows};
use crate::scene::{IntoPair, Scene, Viewpoint};
use crate::shader::{self, Structure};
use crate::tracer::{GpuScene, Settings, Tracer, Wave};
use image::RgbaImage;
use tiny_skia::PixmapMut;

/// Maximum pixels in one draw call: see [`full_screen_pass_rows`].
const PIXELS_PER_DRAW: u32 = 1 << 17;

/// A picture's program, with the scene data that it reads.
pub(super) struct Shader {
    pub program: Program,
    scene: GpuScene,
}

/// Compiles the shader of a picture with the distance functions of `scene`, and sets the scene's data.
pub(super) fn prepare(context: &Context, scene: &Scene, kind: Kind) -> Result<Shader, Error> {
    scene.validate()?;
    let structure = GpuScene::picture_structure(scene);
    let label = format!("{kind:?} of {}", scene.name);
    let text = || text(scene, &structure, kind);
    let program = GpuScene::picture_program(context, scene, &structure, &label, text)?;
    let mut on_gpu = GpuScene::new(context)?;
    on_gpu.set_picture(scene, structure, &program)?;
    Ok(Shader {
        program,
        scene: on_gpu,
    })
}

/// A kind of picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// [`first_person`](super::first_person).
    View,
    /// [`slice`](super::slice()).
    Slice,
}

/// The fragment shader of a picture, without the driver's header. Needs no context; the scene should have been
/// [checked](Scene::check).
pub fn shader_text(scene: &Scene, kind: Kind) -> String {
    text(scene, &GpuScene::picture_structure(scene), kind)
}

fn text(scene: &Scene, structure: &Structure, kind: Kind) -> String {
    let sources = match kind {
        Kind::View => shader::first_person(shader::source!("view/shading.glsl")).to_vec(),
        Kind::Slice => vec![shader::source!("view/slice.frag")],
    };
    shader::picture_text(scene, structure, sources)
}

/// Rejects invalid sizes before any memory is allocated.
pub(super) fn check_size(context: &Context, width: u32, height: u32) -> Result<(), PictureError> {
    let limit = context.limits().max_texture_size;
    if (1..=limit).contains(&width) && (1..=limit).contains(&height) {
        return Ok(());
    }
    Err(PictureError::size([width, height], limit))
}

/// Draws the program's picture at the given size, with the top row first.
pub(super) fn draw(
    context: &Context,
    shader: &Shader,
    width: u32,
    height: u32,
) -> Result<RgbaImage, Error> {
    check_size(context, width, height)?;
    let Shader { program, scene } = shader;
    scene.bind(program, 0);
    let picture = Picture::new(context, width, height)?;
    let rows = (PIXELS_PER_DRAW / width).max(1);
    for start in (0..height).step_by(rows as usize) {
        let band = start..start + rows;
        full_screen_pass_rows(context, program, &picture, width, height, band)?;
    }
    let pixels = picture.read_rgba8()?;
    let picture = RgbaImage::from_raw(width, height, pixels);
    let limit = context.limits().max_texture_size;
    Ok(picture.ok_or_else(|| PictureError::size([width, height], limit))?)
}

/// Options of a slice.
#[derive(Clone, Debug, PartialEq)]
pub struct SliceOptions {
    /// Width in pixels; the height follows from the bounds.
    pub width: u32,
    /// World y of the cut in metres; `None` for the height of the pair's listener.
    pub height: Option<f32>,
    /// The region shown; `None` for [`Bounds::of`] the scene.
    pub bounds: Option<Bounds>,
    /// Number of waves whose paths are drawn.
    pub paths: u32,
    /// Paths traced earlier, as returned by [`Tracer::paths`], drawn on top of the paths of `paths` waves.
    pub also: Vec<Vec<Wave>>,
    /// Settings for tracing the waves of `paths`. The number of waves is `paths`, not `settings.waves`.
    pub settings: Settings,
    /// Whether to draw a scale bar in the lower left, and a legend of the path colours in the upper left.
    pub scale_bar: bool,
}

impl Default for SliceOptions {
    /// A slice 800 pixels wide, at the listener's height, without paths, with a scale bar.
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
/// paths and the paths of waves are drawn on top, at any height. The waves are those of the pair. The scene's other
/// sources and listeners are paler. A scene without a source is also drawn. With a given height, a scene without a
/// listener is drawn as well.
///
/// # Errors
/// [`Error::Picture`] for an impossible size or bounds, [`Error::Scene`] and [`Error::Trace`] for
/// input that cannot be traced, [`Error::Gpu`] when the renderer fails.
pub fn slice<'a>(
    tracer: &mut Tracer,
    pair: impl IntoPair<'a>,
    options: &SliceOptions,
) -> Result<RgbaImage, Error> {
    slice_of(tracer, pair.viewpoint()?, options)
}

fn slice_of(
    tracer: &mut Tracer,
    seen: Viewpoint,
    options: &SliceOptions,
) -> Result<RgbaImage, Error> {
    let context = tracer.context().clone();
    let scene = seen.scene;
    scene.validate()?;
    let height = match options.height {
        Some(height) => height,
        None => seen.listener()?.position.y,
    };
    if !height.is_finite() {
        let what = format!("a height of {height}");
        return Err(PictureError::Bounds { what }.into());
    }
    let bounds = options.bounds.unwrap_or_else(|| Bounds::of(scene, height));
    check_size(&context, options.width, 1)?;
    let plan = Plan::new(bounds, options.width)?;
    let mut picture = cut(&context, scene, height, &plan)?;
    let paths = match options.paths {
        0 => Vec::new(),
        waves => tracer.paths(seen.pair()?, &options.settings.clone().with_waves(waves))?,
    };
    // For opaque pixels, premultiplied and plain colours are equal.
    if let Some(mut canvas) = PixmapMut::from_bytes(&mut picture, plan.width, plan.height) {
        let mut fates = Vec::new();
        if let Some(source) = seen.source {
            for paths in [&paths, &options.also] {
                let from = source.position;
                fates.extend(marks::draw_wave_paths(&mut canvas, &plan, from, paths));
            }
        }
        marks::draw(&mut canvas, &plan, seen);
        labels::draw_names(&mut canvas, &plan, scene);
        if options.scale_bar {
            labels::draw_scale_bar(&mut canvas, &plan);
            labels::draw_path_legend(&mut canvas, &plan, &fates);
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
    check_size(context, plan.width, plan.height)?;
    let shader = prepare(context, scene, Kind::Slice)?;
    let program = &shader.program;
    program.set_vec2("uCorner", plan.corner);
    program.set_f32("uMetres", plan.metres);
    program.set_f32("uHeight", height);
    program.set_f32("uRows", plan.height as f32);
    program.set_f32("uLine", 1.6 * plan.stroke());
    program.set_f32("uIsoline", isoline(plan.metres));
    draw(context, &shader, plan.width, plan.height)
}

/// Distance between isolines of the distance field in metres: 1, or more to leave 12 pixels between lines.
fn isoline(metres: f32) -> f32 {
    let least = 12.0 * metres;
    if (0.1..=1.0).contains(&least) {
        return 1.0;
    }
    10f32.powf(least.log10().ceil())
}
