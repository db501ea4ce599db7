//! The listener's view.

use super::{PictureError, shader};
use crate::error::Error;
use crate::gpu::Context;
use crate::scene::Scene;
use glam::Vec2;
use image::RgbaImage;

/// Radius of the ball that represents the source, as a share of the listener's radius, the only
/// length of a scene that gives its scale.
pub const SOURCE_SHARE: f32 = 0.12;

/// Options of a view.
#[derive(Clone, Debug, PartialEq)]
pub struct ViewOptions {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Vertical field of view in radians, above 0 and below π.
    pub field_of_view: f32,
}

impl Default for ViewOptions {
    /// 960 × 540 pixels over 70° from top to bottom.
    fn default() -> ViewOptions {
        ViewOptions {
            width: 960,
            height: 540,
            field_of_view: 70f32.to_radians(),
        }
    }
}

/// The scene as seen from the listener's position along its gaze direction. The listener is not
/// drawn; the source is a glowing ball that lights everything it can reach.
///
/// # Errors
/// [`Error::Picture`] for an impossible size or field of view, [`Error::Scene`] and
/// [`Error::Trace`] for a scene that cannot be drawn, [`Error::Gpu`] when the renderer fails.
pub fn first_person(
    context: &Context,
    scene: &Scene,
    options: &ViewOptions,
) -> Result<RgbaImage, Error> {
    let (width, height) = (options.width, options.height);
    shader::check_size(context, width, height)?;
    let half_height = (0.5 * options.field_of_view).tan();
    let possible = 0.0 < options.field_of_view && options.field_of_view < std::f32::consts::PI;
    if !(possible && half_height.is_finite() && half_height > 0.0) {
        let degrees = options.field_of_view.to_degrees();
        return Err(PictureError::FieldOfView { degrees }.into());
    }
    let shader = shader::program(context, scene, shader::Kind::View)?;
    let program = &shader.program;
    let listener = &scene.listener;
    program.set_vec3("uRight", listener.right());
    program.set_vec3("uUp", listener.up());
    program.set_vec3("uForward", listener.forward());
    let ball = scene.source.position.extend(SOURCE_SHARE * listener.radius);
    program.set_vec4("uSource", ball);
    program.set_vec2("uSize", Vec2::new(width as f32, height as f32));
    program.set_f32("uPixel", 2.0 * half_height / height as f32);
    shader::draw(context, &shader, width, height)
}
