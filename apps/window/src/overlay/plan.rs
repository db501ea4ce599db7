//! The scene from above: walls from the distance function, sources, listeners, the paths of some waves, and the exact
//! paths of full listening.

use super::labels::{free_place, round_length};
use super::{HudState, style};
use echomarch::picture::Bounds;
use echomarch::response::PathKind;
use echomarch::scene::{Listener, Scene};
use echomarch::tracer::{Fate, Wave};
use echomarch_walk::{Cut, DrawnPath, STUB, listener_names, source_names, way};
use egui::{
    Color32, ColorImage, Context, Pos2, Rect, RichText, Sense, Shape, Stroke, TextureHandle,
    TextureOptions, Ui, Vec2,
};
use glam::Vec3;

/// Height of the plan's box, in points. The height is the same for every scene.
const HEIGHT: f32 = 210.0;

/// The plan, whose texture is cached until the scene changes.
#[derive(Default)]
pub struct Plan {
    texture: Option<TextureHandle>,
    cut: Cut,
}

impl Plan {
    /// Draws the plan as large as its box allows. The box fills the available width.
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
        if let Some(source) = scene.sources.first().filter(|_| paths) {
            let stub = STUB * size.x;
            let exact = hud.ears.map_or(&[][..], |ears| &ears.paths);
            let opacity = if exact.is_empty() { 1.0 } else { BESIDE_EXACT };
            let start = (source.position, stub);
            painter.extend(path_shapes(hud.paths, start, opacity, place));
            painter.extend(exact_shapes(exact, place));
        }
        marks(&painter, scene, scale, place);
        let bar = scale_bar(&painter, rect, scale);
        names(&painter, scene, scale, place, (rect, bar));
        if hud.ears.is_some() {
            legend(ui);
        }
    }

    /// Recomputes the cut through the scene if the scene has changed. Returns the bounds of the plan.
    fn refresh(&mut self, context: &Context, name: &str, scene: &Scene) -> Bounds {
        if self.cut.refresh(name, scene) {
            let image = self.cut.image();
            let image = ColorImage::from_rgb([image.width, image.height], &image.rgb);
            let options = TextureOptions::LINEAR;
            match &mut self.texture {
                Some(texture) => texture.set(image, options),
                None => self.texture = Some(context.load_texture("plan", image, options)),
            }
        }
        self.cut.bounds()
    }
}

/// The kinds of exact paths in the plan, in the order of the legend, with their colours.
const KINDS: [(PathKind, Color32); 4] = [
    (PathKind::Direct, style::DIRECT),
    (PathKind::Mirrored, style::MIRRORED),
    (PathKind::Diffracted, style::DIFFRACTED),
    (PathKind::Transmitted, style::TRANSMITTED),
];

/// Width of the line of an exact path, in points. The line is wider than those of waves.
const EXACT_WIDTH: f32 = 1.6;

/// Opacity of the paths of waves beside exact paths.
const BESIDE_EXACT: f32 = 0.35;

/// Draws one line for each exact path, from its source over its points to the listener. The first paths, which are not
/// mirrored, are on top.
fn exact_shapes(paths: &[DrawnPath], place: impl Fn(Vec3) -> Pos2) -> Vec<Shape> {
    let line = |path: &DrawnPath| {
        let (_, colour) = KINDS.into_iter().find(|(kind, _)| *kind == path.kind)?;
        let points = path.points.iter().map(|&point| place(point)).collect();
        Some(Shape::line(points, Stroke::new(EXACT_WIDTH, colour)))
    };
    paths.iter().rev().filter_map(line).collect()
}

/// Names the colours of exact paths.
fn legend(ui: &mut Ui) {
    ui.horizontal(|ui| {
        for (kind, colour) in KINDS {
            ui.label(RichText::new(kind.name()).color(colour).small());
        }
    });
}

/// Opacity of the marks of all listeners except the first, whose sound is played.
const FURTHER: f32 = 0.4;

/// Draws the sources, the first listener, and the other listeners in a paler colour.
fn marks(painter: &egui::Painter, scene: &Scene, scale: f32, place: impl Fn(Vec3) -> Pos2) {
    if let Some((walker, others)) = scene.listeners.split_first() {
        for listener in others {
            let at = place(listener.position);
            listener_mark(painter, listener, at, scale, FURTHER);
        }
        listener_mark(painter, walker, place(walker.position), scale, 1.0);
    }
    for source in &scene.sources {
        let at = place(source.position);
        painter.circle_filled(at, 6.5, style::SOURCE.gamma_multiply(0.3));
        painter.circle(at, 3.5, style::SOURCE, Stroke::new(1.0, Color32::BLACK));
    }
}

/// Height of the texts in the plan, in points.
const PLAN_TEXT: f32 = 9.0;

/// Share of the plan's width that the bar of its scale may have.
const BAR_SHARE: f32 = 0.3;

/// Draws a bar of a round length in metres in the lower left corner. Returns its place with its text.
fn scale_bar(painter: &egui::Painter, rect: Rect, scale: f32) -> Rect {
    let metres = round_length(BAR_SHARE * rect.width() / scale);
    let start = rect.left_bottom() + Vec2::new(5.0, -4.0);
    let end = start + Vec2::new(metres * scale, 0.0);
    painter.line_segment([start, end], Stroke::new(2.0, style::TEXT));
    let font = egui::FontId::proportional(PLAN_TEXT);
    let at = start - Vec2::new(0.0, 2.0);
    let text = format!("{metres} m");
    let text = painter.text(at, egui::Align2::LEFT_BOTTOM, text, font, style::TEXT);
    text.union(Rect::from_two_pos(start, end).expand(2.0))
}

/// Names the sources and the listeners. No two texts overlap; a name without a free place is left out.
fn names(
    painter: &egui::Painter,
    scene: &Scene,
    scale: f32,
    place: impl Fn(Vec3) -> Pos2,
    (rect, bar): (Rect, Rect),
) {
    let sources = scene.sources.iter().zip(source_names(scene));
    let sources = sources.map(|(source, name)| (place(source.position), 6.5, name));
    let listeners = scene.listeners.iter().zip(listener_names(scene));
    let listeners = listeners
        .map(|(listener, name)| (place(listener.position), radius_of(listener, scale), name));
    let marks: Vec<(Pos2, f32, String)> = sources.chain(listeners).collect();
    let mark = |(at, _, _): &(Pos2, f32, String)| Rect::from_center_size(*at, Vec2::splat(9.0));
    let mut taken: Vec<Rect> = marks.iter().map(mark).chain([bar]).collect();
    for (at, radius, name) in marks {
        let font = egui::FontId::proportional(PLAN_TEXT);
        let galley = painter.layout_no_wrap(style::plain(&name), font, style::TEXT);
        let Some(free) = free_place(at, galley.size(), radius + 3.0, &taken, rect) else {
            continue;
        };
        painter.rect_filled(free, 2.0, style::BEHIND_TEXT);
        painter.galley(free.min, galley, style::TEXT);
        taken.push(free);
    }
}

/// Draws a listener with its gaze direction and sphere.
fn listener_mark(painter: &egui::Painter, of: &Listener, at: Pos2, scale: f32, opacity: f32) {
    let colour = style::LISTENER.gamma_multiply(opacity);
    let radius = radius_of(of, scale);
    let line = Stroke::new(1.0, colour);
    painter.circle(at, radius, colour.gamma_multiply(0.25), line);
    let (sin, cos) = of.yaw.sin_cos();
    let gaze = Vec2::new(sin, -cos);
    painter.arrow(at, gaze * (radius + 9.0), Stroke::new(2.0, colour));
    painter.circle_filled(at, 3.0, colour);
}

/// Radius of a listener's mark, in points.
fn radius_of(listener: &Listener, scale: f32) -> f32 {
    (scale * listener.radius).max(3.0)
}

/// Draws one line for each wave; waves that reached the listener are drawn on top. The waves start at the source, and
/// the line of a dead wave ends after `stub` metres.
fn path_shapes(
    states: &[Vec<Wave>],
    (source, stub): (Vec3, f32),
    opacity: f32,
    place: impl Fn(Vec3) -> Pos2,
) -> Vec<Shape> {
    let waves = states.first().map_or(0, Vec::len);
    let followed: Vec<(Fate, Vec<Vec3>)> = (0..waves)
        .map(|wave| way(states, wave, source, stub))
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
        let colour = colour.gamma_multiply(opacity);
        let is_drawn_so = |of: &Fate| match of {
            // Waves with values that are not finite are drawn as dead waves.
            Fate::NotFinite => fate == Fate::Dead,
            of => *of == fate,
        };
        for (_, points) in followed.iter().filter(|(of, _)| is_drawn_so(of)) {
            let points = points.iter().map(|&point| place(point)).collect();
            shapes.push(Shape::line(points, Stroke::new(width, colour)));
        }
    }
    shapes
}
