//! The frames' times by part, against the time that a frame may take.

use super::super::report::{FrameTimes, medians};
use super::{Facts, style};
use egui::{Color32, Pos2, Rect, RichText, Sense, Ui, Vec2};

/// A part of a frame's time: its name, its colour and where it is found.
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

/// Frames shown; one bar each.
pub const FRAMES: usize = 100;

/// Milliseconds at the top, as a share of the time that a frame may take.
const TOP: f64 = 1.5;

/// Draws one bar a frame and the legend with medians.
pub fn draw(ui: &mut Ui, facts: &Facts) {
    let shown = &facts.times[facts.times.len().saturating_sub(FRAMES)..];
    let middle = medians(shown);
    ui.set_width(style::RIGHT);
    ui.horizontal(|ui| {
        let fps = 1000.0 / middle.whole.max(1e-3);
        let colour = if middle.whole > 1.02 * facts.target {
            style::BAD
        } else {
            style::BRIGHT
        };
        ui.label(
            RichText::new(format!("{fps:.0} fps"))
                .color(colour)
                .strong(),
        );
        let [width, height] = facts.drawn.size;
        let text = format!("picture {width}×{height}");
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.label(RichText::new(text).color(style::FAINT));
        });
    });
    bars(ui, facts, shown);
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 7.0;
        for (name, colour, of) in PARTS {
            // No line breaks between a name and its number.
            let text = format!("{name}\u{a0}{:.1}", of(&middle));
            ui.label(
                RichText::new(text.replace(' ', "\u{a0}"))
                    .color(colour)
                    .small(),
            );
        }
    });
}

fn bars(ui: &mut Ui, facts: &Facts, shown: &[FrameTimes]) {
    let size = Vec2::new(style::RIGHT, 52.0);
    let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 2, Color32::from_black_alpha(120));
    let height = |ms: f64| (ms / (TOP * facts.target)) as f32 * rect.height();
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
    let y = rect.bottom() - height(facts.target);
    painter.hline(rect.x_range(), y, (1.0, style::BAD));
    painter.text(
        Pos2::new(rect.right() - 3.0, y - 1.0),
        egui::Align2::RIGHT_BOTTOM,
        format!("{:.1} ms", facts.target),
        egui::FontId::proportional(9.0),
        style::BAD,
    );
}
