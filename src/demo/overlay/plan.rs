//! The scene from above: walls by the distance function, the source, the listener, and the
//! paths of some waves.

use super::{HudState, style};
use crate::picture::Bounds;
use crate::scene::{Scene, Surface};
use crate::trace::{Fate, Wave};
use egui::{
    Color32, ColorImage, Context, Pos2, Rect, Sense, Shape, Stroke, TextureHandle, TextureOptions,
    Ui, Vec2,
};
use glam::Vec3;

/// Texels of the plan on its longer side.
const TEXELS: usize = 220;
/// Height of the plan's box, in points: the same for every scene.
const HEIGHT: f32 = 210.0;
/// A change of the listener's height that cuts the scene anew, in metres.
const LEVEL: f32 = 0.25;
/// Length of a dead wave's stub, as a share of the plan's width.
const STUB: f32 = 0.12;

/// The plan, kept while what it shows stands still.
#[derive(Default)]
pub struct Plan {
    texture: Option<TextureHandle>,
    cut: Option<Cut>,
}

/// What the picture of the plan depends on.
#[derive(Clone, PartialEq)]
struct Cut {
    scene: String,
    surfaces: Vec<Surface>,
    level: i32,
    bounds: Bounds,
}

impl Plan {
    /// Draws the plan as large as its box allows, which is as wide as there is room.
    pub fn draw(&mut self, ui: &mut Ui, hud: &HudState, paths: bool) {
        let scene = &hud.world.now;
        let bounds = self.refresh(ui.ctx(), &hud.world.name, scene);
        let size = bounds.max - bounds.min;
        let width = ui.available_width();
        let scale = (width / size.x).min(HEIGHT / size.y);
        let room = Vec2::new(width, HEIGHT);
        let (whole, _) = ui.allocate_exact_size(room, Sense::hover());
        let rect = Rect::from_center_size(whole.center(), scale * Vec2::new(size.x, size.y));
        let painter = ui.painter_at(rect);
        if let Some(texture) = &self.texture {
            let all = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
            painter.image(texture.id(), rect, all, Color32::WHITE);
        }
        let place = |p: Vec3| {
            let offset = glam::Vec2::new(p.x, p.z) - bounds.min;
            rect.min + scale * Vec2::new(offset.x, offset.y)
        };
        if paths {
            let stub = STUB * size.x;
            painter.extend(path_shapes(hud.paths, scene.source.position, stub, place));
        }
        marks(&painter, scene, scale, place);
        let corner = rect.left_bottom() + Vec2::new(5.0, -2.0);
        let text = format!("{:.0} × {:.0} m", size.x, size.y);
        let font = egui::FontId::proportional(9.0);
        painter.text(corner, egui::Align2::LEFT_BOTTOM, text, font, style::TEXT);
    }

    /// Cuts the scene anew if it has changed; the part of the world that is shown.
    fn refresh(&mut self, context: &Context, name: &str, scene: &Scene) -> Bounds {
        let old = self.cut.as_ref().filter(|cut| cut.scene == name);
        let height = scene.listener.position.y;
        let level = (height / LEVEL).round() as i32;
        // What is shown only grows, lest the plan slide about under whoever walks.
        let bounds = match old {
            Some(cut) if holds(cut.bounds, scene) => cut.bounds,
            Some(cut) => around(cut.bounds, Bounds::of(scene, height)),
            None => Bounds::of(scene, height),
        };
        let is_same = old.is_some_and(|cut| {
            (cut.level, cut.bounds) == (level, bounds) && cut.surfaces == scene.surfaces
        });
        if !is_same {
            let image = sample(scene, bounds, height);
            let options = TextureOptions::LINEAR;
            match &mut self.texture {
                Some(texture) => texture.set(image, options),
                None => self.texture = Some(context.load_texture("plan", image, options)),
            }
            self.cut = Some(Cut {
                scene: name.to_owned(),
                surfaces: scene.surfaces.clone(),
                level,
                bounds,
            });
        }
        bounds
    }
}

/// Whether source and listener lie in what is shown.
fn holds(bounds: Bounds, scene: &Scene) -> bool {
    [scene.source.position, scene.listener.position]
        .iter()
        .all(|p| {
            (bounds.min.x..=bounds.max.x).contains(&p.x)
                && (bounds.min.y..=bounds.max.y).contains(&p.z)
        })
}

fn around(a: Bounds, b: Bounds) -> Bounds {
    Bounds {
        min: a.min.min(b.min),
        max: a.max.max(b.max),
    }
}

/// The cut at a height, by the distance function on the CPU.
fn sample(scene: &Scene, bounds: Bounds, height: f32) -> ColorImage {
    let size = bounds.max - bounds.min;
    let metres = size.max_element() / TEXELS as f32;
    let texels = |length: f32| ((length / metres).round() as usize).clamp(1, TEXELS);
    let (width, rows) = (texels(size.x), texels(size.y));
    let mut pixels = Vec::with_capacity(width * rows);
    for row in 0..rows {
        for column in 0..width {
            let at = glam::Vec2::new(column as f32 + 0.5, row as f32 + 0.5) * metres + bounds.min;
            let nearest = scene.surface_distance(Vec3::new(at.x, height, at.y));
            pixels.push(shade(nearest.distance / metres, nearest.object));
        }
    }
    ColorImage::new([width, rows], pixels)
}

/// Air dark, solids in their surface's hue, with a bright edge; `texels` is the distance.
fn shade(texels: f32, object: u32) -> Color32 {
    let air = Color32::from_rgb(30, 36, 42);
    let hue = 1.25 + 2.399_963_2 * (object as f32 - 1.0);
    let tint = |angle: f32, base: f32, chroma: f32| (base + chroma * (hue + angle).cos()) as u8;
    let tinted = |base, chroma| {
        Color32::from_rgb(
            tint(0.0, base, chroma),
            tint(-2.09, base, chroma),
            tint(2.09, base, chroma),
        )
    };
    let solid = tinted(92.0, 18.0);
    let edge = tinted(196.0, 30.0);
    let inside = (0.5 - texels).clamp(0.0, 1.0);
    let on_edge = inside * (0.5 + texels + 1.6).clamp(0.0, 1.0);
    air.lerp_to_gamma(solid, inside)
        .lerp_to_gamma(edge, on_edge)
}

/// Listener with its gaze and sphere, and the source.
fn marks(painter: &egui::Painter, scene: &Scene, scale: f32, place: impl Fn(Vec3) -> Pos2) {
    let listener = &scene.listener;
    let at = place(listener.position);
    let radius = (scale * listener.radius).max(3.0);
    painter.circle(
        at,
        radius,
        style::LISTENER.gamma_multiply(0.25),
        Stroke::new(1.0, style::LISTENER),
    );
    let (sin, cos) = listener.yaw.sin_cos();
    let gaze = Vec2::new(sin, -cos);
    painter.arrow(at, gaze * (radius + 9.0), Stroke::new(2.0, style::LISTENER));
    painter.circle_filled(at, 3.0, style::LISTENER);
    let source = place(scene.source.position);
    let halo = style::SOURCE.gamma_multiply(0.3);
    painter.circle_filled(source, 6.5, halo);
    painter.circle(source, 3.5, style::SOURCE, Stroke::new(1.0, Color32::BLACK));
}

/// One line for each wave; those that reached the listener lie on top.
fn path_shapes(
    states: &[Vec<Wave>],
    source: Vec3,
    stub: f32,
    place: impl Fn(Vec3) -> Pos2,
) -> Vec<Shape> {
    let waves = states.first().map_or(0, Vec::len);
    let followed: Vec<(Fate, Vec<Vec3>)> = (0..waves)
        .map(|wave| follow(states, wave, source, stub))
        .collect();
    let styles = [
        (Fate::Dead, style::DEAD.gamma_multiply(0.45), 0.8),
        (
            Fate::Travelling,
            style::TRAVELLING.gamma_multiply(0.16),
            0.7,
        ),
        (Fate::Listener, style::REACHED, 1.3),
    ];
    let mut shapes = Vec::new();
    for (fate, colour, width) in styles {
        for (_, points) in followed.iter().filter(|(of, _)| *of == fate) {
            let points = points.iter().map(|&point| place(point)).collect();
            shapes.push(Shape::line(points, Stroke::new(width, colour)));
        }
    }
    shapes
}

/// The places of one wave until it reached the listener or died.
fn follow(states: &[Vec<Wave>], wave: usize, source: Vec3, stub: f32) -> (Fate, Vec<Vec3>) {
    let mut points = vec![source];
    let mut heading = states[0][wave].start_direction;
    for waves in &states[1..] {
        let state = &waves[wave];
        match state.fate() {
            Fate::Dead | Fate::NotFinite => {
                let last = points[points.len() - 1];
                points.push(last + stub * heading);
                return (Fate::Dead, points);
            }
            Fate::Listener => {
                points.push(state.position);
                return (Fate::Listener, points);
            }
            Fate::Travelling => points.push(state.position),
        }
        heading = state.direction;
    }
    (Fate::Travelling, points)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the plan from showing walls elsewhere than they are heard.
    #[test]
    fn the_cut_shows_air_and_solid_where_they_are() {
        let scene = Scene::builtin("corner").unwrap();
        let bounds = Bounds {
            min: glam::Vec2::splat(-20.0),
            max: glam::Vec2::splat(20.0),
        };
        let image = sample(&scene, bounds, 0.0);
        assert_eq!(image.size, [TEXELS, TEXELS]);
        let at = |x: f32, z: f32| {
            let texel = |metres: f32| ((metres + 20.0) / 40.0 * TEXELS as f32) as usize;
            image.pixels[texel(z) * TEXELS + texel(x)]
        };
        let air = at(-8.0, -8.0);
        assert_eq!(at(10.0, 8.0), air);
        assert_ne!(at(7.5, -7.5), air);
        assert_ne!(at(-18.0, 0.0), air);
    }
}
