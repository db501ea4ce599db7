//! The panel section for full listening: each source's level, and the energy against time.

use super::{HudState, style};
use echomarch::auralisation::HeardSource;
use echomarch_walk::{EarsStatus, QUIETEST_DB};
use egui::{Pos2, Rect, Sense, Shape, Stroke, Ui, Vec2};

/// Height of the curve in points.
const CURVE: f32 = 44.0;

/// Maximum number of sources listed. Further sources are not shown.
const MOST_SOURCES: usize = 6;

/// Number of rows for the kinds of paths of a source: all kinds with their levels need two.
const KIND_ROWS: usize = 2;

/// Draws the section if full listening is on.
pub fn draw(ui: &mut Ui, hud: &HudState) {
    let Some(ears) = hud.ears else {
        return;
    };
    style::heading(ui, "HEARD IN FULL");
    let sources = hud.world.now.sources.iter().enumerate();
    for (number, source) in sources.take(MOST_SOURCES) {
        let name = match &source.name {
            Some(name) => style::plain(name),
            None => format!("source {}", number + 1),
        };
        let heard = ears.sources.get(number);
        style::row(ui, &name, level(heard));
        let kinds = heard.map_or_else(String::new, HeardSource::to_string);
        style::note(ui, &kinds, style::FAINT, KIND_ROWS);
    }
    curve(ui, ears);
    let times = format!("{:.0} + {:.0} ms", ears.trace_ms, ears.late_ms);
    style::row(ui, "trace, late part", times);
    style::row(ui, "waves for echoes", waves(ears));
    let gain = match ears.sources.is_empty() {
        true => "–".to_owned(),
        false => format!("{:+.1} dB", ears.gain_db),
    };
    style::row(ui, "gain of the scene", gain);
    limiter(ui, ears);
    ui.separator();
}

/// Shows whether the limiter works: it does where the listener is nearer to a source than the gain of the scene allows.
fn limiter(ui: &mut Ui, ears: &EarsStatus) {
    let (text, colour) = match ears.limited_db {
        0.0 => ("rests".to_owned(), style::TEXT),
        by => (format!("−{by:.1} dB"), style::BAD),
    };
    style::coloured_row(ui, "limiter", text, colour);
}

/// Formats the number of waves. If the time limit of one second reduced it, the requested number follows.
fn waves(ears: &EarsStatus) -> String {
    match (ears.waves, ears.waves_asked) {
        (0, _) => "–".to_owned(),
        (waves, asked) if waves < asked => format!("{waves} of {asked}"),
        (waves, _) => waves.to_string(),
    }
}

/// Formats a source's level. The level is unknown before the first trace.
fn level(heard: Option<&HeardSource>) -> String {
    let Some(heard) = heard else {
        return "–".to_owned();
    };
    let sight = if heard.is_direct { "" } else { ", hidden" };
    match heard.level_db {
        Some(level_db) => format!("G {level_db:+.1} dB, {} paths{sight}", heard.paths),
        None => "nothing arrives".to_owned(),
    }
}

/// The energy of all sources against time, in decibels.
fn curve(ui: &mut Ui, ears: &EarsStatus) {
    let size = Vec2::new(ui.available_width(), CURVE);
    let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
    let painter = ui.painter();
    let ground = [rect.left_bottom(), rect.right_bottom()];
    painter.line_segment(ground, (1.0, style::FAINT));
    let count = ears.curve.len().max(1);
    let point = |(index, decibels): (usize, &f32)| {
        let along = (index as f32 + 0.5) / count as f32;
        let up = 1.0 - decibels / QUIETEST_DB as f32;
        let x = rect.left() + along * rect.width();
        Pos2::new(x, rect.bottom() - up * rect.height())
    };
    let points: Vec<Pos2> = ears.curve.iter().enumerate().map(point).collect();
    painter.add(Shape::line(points, Stroke::new(1.2, style::REACHED)));
    label(ui, rect, &format!("{:.1} s", ears.curve_s));
}

fn label(ui: &Ui, rect: Rect, text: &str) {
    let font = egui::FontId::monospace(9.0);
    let at = rect.right_top();
    let painter = ui.painter();
    painter.text(at, egui::Align2::RIGHT_TOP, text, font, style::FAINT);
}
