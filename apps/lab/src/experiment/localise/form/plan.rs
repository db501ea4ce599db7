//! The two pictures for a person's answer: the room from above with the gaze upwards, and the view along the gaze.
//! Neither picture shows the source.

use super::super::observer::horizontal_axes;
use echomarch::Error;
use echomarch::gl::Context;
use echomarch::picture::{Bounds, PictureError, RgbaImage, ViewOptions, first_person};
use echomarch::scene::{Scene, Source};
use glam::{DVec2, DVec3};
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder, Rgba};

/// Width of a plan in pixels.
const WIDTH: u32 = 560;

/// Colours of solids, of their outlines, and of the air.
const SOLID: [f64; 3] = [205.0, 211.0, 219.0];
const LINE: [f64; 3] = [70.0, 78.0, 88.0];
const AIR: [f64; 3] = [255.0, 255.0, 255.0];
/// Colour of the area outside the drawn part of the world.
const OUTSIDE: [f64; 3] = [232.0, 234.0, 237.0];

/// Half of the width of an outline, in pixels.
const HALF_LINE: f64 = 1.3;

/// The pictures for one facing of the listener. Lengths are in metres from the listener, with x to the right and y
/// ahead.
#[derive(Debug)]
pub struct Plan {
    /// The smallest x and y of the plan.
    pub min: DVec2,
    /// The largest x and y of the plan.
    pub max: DVec2,
    /// The listener's radius in metres.
    pub radius: f64,
    /// The plan as PNG.
    pub plan_png: Vec<u8>,
    /// The view as PNG.
    pub view_png: Vec<u8>,
}

impl Plan {
    /// Draws the plan at the height of the ears, and draws the view.
    ///
    /// # Errors
    /// [`Error::Picture`], [`Error::Gpu`] and [`Error::Scene`].
    pub fn new(context: &Context, scene: &Scene) -> Result<Plan, Error> {
        let listener = &scene.listeners[0];
        let mut seen = unlit(scene);
        // The bounds must not depend on the source, because they would reveal its position.
        let lamp = std::mem::replace(&mut seen.sources[0], Source::at(listener.position));
        let bounds = Bounds::of(&seen, listener.position.y);
        seen.sources[0] = lamp;
        let (min, max) = seen_by(scene, bounds);
        let plan = draw(scene, bounds, min, max);
        let options = ViewOptions {
            width: 640,
            height: 360,
            ..ViewOptions::default()
        };
        let view = first_person(context, &seen, &options)?;
        Ok(Plan {
            min,
            max,
            radius: listener.radius.into(),
            plan_png: png(&plan)?,
            view_png: png(&view)?,
        })
    }
}

/// Returns the scene with its source replaced by a lamp behind and above the listener, so that the light does not
/// reveal the source.
fn unlit(scene: &Scene) -> Scene {
    let listener = &scene.listeners[0];
    let behind = listener.up() - listener.forward();
    let mut unlit = scene.clone();
    unlit.sources[0] = Source::at(listener.position + 0.5 * listener.radius * behind);
    unlit
}

/// The smallest rectangle in the listener's horizontal plane that contains these bounds of the world.
fn seen_by(scene: &Scene, bounds: Bounds) -> (DVec2, DVec2) {
    let (right, ahead) = horizontal_axes(scene);
    let listener = scene.listeners[0].position.as_dvec3();
    let corner = |x: f32, z: f32| {
        let offset = DVec3::new(x.into(), listener.y, z.into()) - listener;
        DVec2::new(offset.dot(right), offset.dot(ahead))
    };
    let corners = [
        corner(bounds.min.x, bounds.min.y),
        corner(bounds.min.x, bounds.max.y),
        corner(bounds.max.x, bounds.min.y),
        corner(bounds.max.x, bounds.max.y),
    ];
    let first = (corners[0], corners[0]);
    corners.into_iter().fold(first, |(min, max), corner| {
        (min.min(corner), max.max(corner))
    })
}

/// Draws the cut through the scene. The area outside `bounds` is grey.
fn draw(scene: &Scene, bounds: Bounds, min: DVec2, max: DVec2) -> RgbaImage {
    let (right, ahead) = horizontal_axes(scene);
    let listener = scene.listeners[0].position.as_dvec3();
    let metres = (max.x - min.x) / f64::from(WIDTH);
    let height = ((max.y - min.y) / metres).round().clamp(1.0, 4096.0) as u32;
    RgbaImage::from_fn(WIDTH, height, |column, row| {
        let x = min.x + metres * (f64::from(column) + 0.5);
        let y = max.y - metres * (f64::from(row) + 0.5);
        let point = (listener + x * right + y * ahead).as_vec3();
        let is_inside = (bounds.min.x..=bounds.max.x).contains(&point.x)
            && (bounds.min.y..=bounds.max.y).contains(&point.z);
        if !is_inside {
            return colour(OUTSIDE);
        }
        let pixels = f64::from(scene.surface_distance(point).distance) / metres;
        let solid = mix(AIR, SOLID, (0.5 - pixels).clamp(0.0, 1.0));
        let line = (HALF_LINE + 0.5 - pixels.abs()).clamp(0.0, 1.0);
        colour(mix(solid, LINE, line))
    })
}

fn mix(from: [f64; 3], to: [f64; 3], share: f64) -> [f64; 3] {
    std::array::from_fn(|i| from[i] + share * (to[i] - from[i]))
}

fn colour([red, green, blue]: [f64; 3]) -> Rgba<u8> {
    Rgba([
        red.round() as u8,
        green.round() as u8,
        blue.round() as u8,
        255,
    ])
}

fn png(picture: &RgbaImage) -> Result<Vec<u8>, Error> {
    let mut bytes = Vec::new();
    let (width, height) = picture.dimensions();
    PngEncoder::new(&mut bytes)
        .write_image(picture.as_raw(), width, height, ExtendedColorType::Rgba8)
        .map_err(PictureError::from)?;
    Ok(bytes)
}
