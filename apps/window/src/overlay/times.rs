//! The panel of frame times by part, with a line at the target frame time.

use super::super::report::{FrameTimes, medians};
use super::super::state::Choices;
use super::{HudState, style};
use egui::{Color32, Pos2, Rect, RichText, Sense, Ui, Vec2};

/// A part of the frame time: its name, its colour, and the function that returns it in milliseconds.
type Part = (&'static str, Color32, fn(&FrameTimes) -> f64);

const PARTS: [Part; 6] = [
    ("picture", Color32::from_rgb(86, 150, 220), |t| t.picture),
    ("waves", Color32::from_rgb(255, 140, 60), |t| t.waves),
    ("read back", Color32::from_rgb(245, 208, 90), |t| {
        t.read_back
    }),
    ("paths", Color32::from_rgb(190, 120, 200), |t| t.paths),
    ("panels", Color32::from_rgb(60, 180, 140), |t| t.overlay),
    ("swap", Color32::from_rgb(130, 140, 150), |t| t.swap),
];

/// Number of frames shown, with one bar for each frame.
pub const FRAMES: usize = 100;

/// Maximum width of the number of waves, in characters.
const WAVES_WIDTH: usize = 17;

/// The time at the top of the diagram, as a multiple of the target frame time.
const TOP: f64 = 1.5;

/// Draws the values that can adapt, one bar for each frame, and the legend with medians.
pub fn draw(ui: &mut Ui, hud: &HudState, chosen: &Choices) {
    let shown = &hud.times[hud.times.len().saturating_sub(FRAMES)..];
    let middle = medians(shown);
    ui.set_width(style::RIGHT);
    let fps = 1000.0 / middle.whole.max(1e-3);
    let colour = if middle.whole > 1.02 * hud.target {
        style::BAD
    } else {
        style::BRIGHT
    };
    let [width, height] = hud.drawn.size;
    let picture = format!("{width:>5}×{height:<5}");
    let waves = match hud.more_waves_asked {
        None => chosen.settings.waves.to_string(),
        Some(asked) => format!("{} of {asked}", chosen.settings.waves),
    };
    // Long numbers of waves are written without spaces, so that the panel keeps its width.
    let waves = match waves.len() > WAVES_WIDTH {
        true => waves.replace(" of ", "/"),
        false => waves,
    };
    let waves = format!("{waves:>WAVES_WIDTH$}");
    ui.horizontal(|ui| {
        ui.label(
            RichText::new(format!("{fps:3.0} fps"))
                .color(colour)
                .monospace(),
        );
        adapted(ui, "picture", &picture, chosen.picture_scale.is_none());
    });
    ui.horizontal(|ui| {
        adapted(ui, "waves", &waves, chosen.adapt_waves);
    });
    bars(ui, hud, shown);
    legend(ui, &middle);
}

/// Shows a number, and whether it adapts to the frame time.
fn adapted(ui: &mut Ui, name: &str, number: &str, follows: bool) {
    let (word, colour) = match follows {
        true => ("follows", style::BRIGHT),
        false => ("fixed  ", style::FAINT),
    };
    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
        ui.label(RichText::new(word).color(colour).monospace());
        ui.label(RichText::new(number).monospace());
        ui.label(RichText::new(name).color(style::FAINT));
    });
}

/// The colours and medians of the parts, each at a fixed position.
fn legend(ui: &mut Ui, middle: &FrameTimes) {
    const COLUMNS: usize = 3;
    const ROW: f32 = 13.0;
    let rows = PARTS.len().div_ceil(COLUMNS);
    let size = Vec2::new(style::RIGHT, ROW * rows as f32);
    let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
    let cell = Vec2::new(style::RIGHT / COLUMNS as f32, ROW);
    let painter = ui.painter_at(rect);
    for (index, (name, colour, of)) in PARTS.into_iter().enumerate() {
        let place = Vec2::new((index % COLUMNS) as f32, (index / COLUMNS) as f32);
        let place = Rect::from_min_size(rect.min + place * cell, cell);
        let font = egui::FontId::proportional(9.5);
        let left = egui::Align2::LEFT_CENTER;
        painter.text(place.left_center(), left, name, font, colour);
        let milliseconds = of(middle);
        let decimals = usize::from(milliseconds < 100.0);
        painter.text(
            place.right_center() - Vec2::new(6.0, 0.0),
            egui::Align2::RIGHT_CENTER,
            format!("{milliseconds:.decimals$}"),
            egui::FontId::monospace(9.5),
            colour,
        );
    }
}

fn bars(ui: &mut Ui, hud: &HudState, shown: &[FrameTimes]) {
    let size = Vec2::new(style::RIGHT, 40.0);
    let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 2, Color32::from_black_alpha(120));
    let height = |ms: f64| (ms / (TOP * hud.target)) as f32 * rect.height();
    let width = rect.width() / FRAMES as f32;
    for (index, times) in shown.iter().enumerate() {
        let left = rect.left() + index as f32 * width;
        let mut bottom = rect.bottom();
        for (_, colour, of) in PARTS {
            let top = bottom - height(of(times));
            let corners = [Pos2::new(left, top), Pos2::new(left + width, bottom)];
            painter.rect_filled(Rect::from_two_pos(corners[0], corners[1]), 0, colour);
            bottom = top;
        }
    }
    let y = rect.bottom() - height(hud.target);
    painter.hline(rect.x_range(), y, (1.0, style::BAD));
    painter.text(
        Pos2::new(rect.right() - 3.0, y - 1.0),
        egui::Align2::RIGHT_BOTTOM,
        format!("{:.1} ms", hud.target),
        egui::FontId::proportional(9.0),
        style::BAD,
    );
}
