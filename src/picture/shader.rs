//! A picture's shader: its program, and the pass that draws it.

use super::PictureError;
use crate::error::Error;
use crate::gpu::{Context, Picture, Program, full_screen_pass_rows};
use crate::kernel::{self, Structure};
use crate::scene::Scene;
use crate::trace::GpuScene;
use image::RgbaImage;

/// Maximum pixels in one draw call: see [`full_screen_pass_rows`].
const PIXELS_PER_DRAW: u32 = 1 << 17;

/// A picture's program, and the scene that it reads.
pub(super) struct Shader {
    pub program: Program,
    scene: GpuScene,
}

/// The program of a picture's shader around the distance functions of `scene`, with the scene's
/// numbers set.
pub(super) fn program(context: &Context, scene: &Scene, kind: Kind) -> Result<Shader, Error> {
    scene.validate()?;
    let structure = GpuScene::picture_structure(scene);
    let label = format!("{kind:?} of {}", scene.name);
    let text = text(scene, &structure, kind);
    let program = GpuScene::picture_program(context, scene, &structure, &label, &text)?;
    let mut on_gpu = GpuScene::new(context)?;
    on_gpu.set_picture(scene, structure, &program)?;
    let listener = &scene.listener;
    program.set_vec4("uListener", listener.position.extend(listener.radius));
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

impl Kind {
    fn sources(self) -> Vec<kernel::Source> {
        match self {
            Kind::View => kernel::first_person(kernel::source!("view/shading.glsl")).to_vec(),
            Kind::Slice => vec![kernel::source!("view/slice.frag")],
        }
    }
}

/// The fragment shader of a picture, as it is compiled after the driver's own header. Needs no
/// context; the scene should have been [checked](Scene::check).
pub fn shader_text(scene: &Scene, kind: Kind) -> String {
    text(scene, &GpuScene::picture_structure(scene), kind)
}

fn text(scene: &Scene, structure: &Structure, kind: Kind) -> String {
    kernel::picture_text(scene, structure, kind.sources())
}

/// Rejects sizes that cannot be drawn, before anything is allocated.
pub(super) fn check_size(context: &Context, width: u32, height: u32) -> Result<(), PictureError> {
    let limit = context.limits().max_texture_size;
    if (1..=limit).contains(&width) && (1..=limit).contains(&height) {
        return Ok(());
    }
    Err(PictureError::Size {
        width,
        height,
        limit,
    })
}

/// Draws the program over a picture of the given size, whose top row comes first.
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
    let size = PictureError::Size {
        width,
        height,
        limit: context.limits().max_texture_size,
    };
    Ok(RgbaImage::from_raw(width, height, pixels).ok_or(size)?)
}
