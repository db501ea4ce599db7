//! The meters: left and right level, pan, counts of waves, and latency.

use super::{HudState, style};
use echomarch::internals::fields_cost::FieldsCost;
use egui::{Color32, CornerRadius, Pos2, Rect, Sense, Ui, Vec2};

/// Height of a meter in points.
const METER: f32 = 9.0;
/// Width of the number beside a meter, in points.
const NUMBER: f32 = 54.0;
/// Decibels at the left end of a meter.
const QUIETEST: f32 = -48.0;

/// Level meters for both channels, and a marker at the pan of the sound that is played.
pub fn draw(ui: &mut Ui, hud: &HudState) {
    for (name, level) in ["L", "R"].into_iter().zip(hud.levels) {
        ui.horizontal(|ui| {
            ui.monospace(name);
            meter(ui, level);
        });
    }
    ui.horizontal(|ui| {
        ui.monospace(" ");
        let width = ui.available_width() - NUMBER;
        let (rect, _) = ui.allocate_exact_size(Vec2::new(width, METER), Sense::hover());
        let painter = ui.painter();
        let line = [rect.left_center(), rect.right_center()];
        painter.line_segment(line, (1.0, style::FAINT));
        let middle = [rect.center_top(), rect.center_bottom()];
        painter.line_segment(middle, (1.0, style::FAINT));
        if let Some(pan) = hud.played_pan {
            let x = rect.center().x + 0.5 * pan * rect.width();
            painter.circle_filled(Pos2::new(x, rect.center().y), 4.5, style::LISTENER);
        }
        ui.monospace(
            hud.played_pan
                .map_or("–".to_owned(), |pan| format!("{pan:+.3}")),
        );
    });
}

fn meter(ui: &mut Ui, level: f32) {
    let decibels = 20.0 * level.max(1e-6).log10();
    let width = ui.available_width() - NUMBER;
    let (rect, _) = ui.allocate_exact_size(Vec2::new(width, METER), Sense::hover());
    let painter = ui.painter();
    let round = CornerRadius::same(2);
    painter.rect_filled(rect, round, Color32::from_gray(48));
    let share = ((decibels - QUIETEST) / -QUIETEST).clamp(0.0, 1.0);
    let size = Vec2::new(share * rect.width(), rect.height());
    let colour = if level > 0.98 {
        style::BAD
    } else {
        style::DEAD
    };
    painter.rect_filled(Rect::from_min_size(rect.min, size), round, colour);
    let text = if decibels > -99.0 {
        format!("{decibels:+4.0} dB")
    } else {
        " −∞ dB".to_owned()
    };
    ui.monospace(text);
}

/// The counts of waves by their final state, and the latency by part.
pub fn heard(ui: &mut Ui, hud: &HudState) {
    let counts = hud.heard.map(|heard| &heard.counts);
    let all = counts.map_or(0, |c| {
        c.listener_hits + c.dead + c.travelling + c.not_finite
    });
    let of = |count: Option<u64>| match count {
        None => "–".to_owned(),
        Some(count) => {
            let share = 100.0 * count as f64 / all.max(1) as f64;
            format!("{count} ({share:5.1} %)")
        }
    };
    for (name, count, colour) in [
        (
            "listener hits",
            counts.map(|c| c.listener_hits),
            style::REACHED,
        ),
        (
            "travelling",
            counts.map(|c| c.travelling),
            style::TRAVELLING,
        ),
        ("dead", counts.map(|c| c.dead), style::DEAD),
    ] {
        ui.horizontal(|ui| {
            let (dot, _) = ui.allocate_exact_size(Vec2::splat(8.0), Sense::hover());
            ui.painter().circle_filled(dot.center(), 3.5, colour);
            style::row(ui, name, of(count));
        });
    }
    for (name, count) in [
        (
            "iterations without a move",
            counts.map(|c| c.zero_length_passes),
        ),
        ("step limit reached", counts.map(|c| c.step_limit_reached)),
        ("not finite", counts.map(|c| c.not_finite)),
    ] {
        let text = count.map_or("–".to_owned(), |count| count.to_string());
        style::row(ui, name, text);
    }
    let percent = |cost: &FieldsCost| format!("{:.0} %", cost.shown_percent());
    let evaluations = |cost: &FieldsCost| format!("{:.1}", cost.evaluations_per_flight);
    let of = |value: Option<String>| value.unwrap_or("–".to_owned());
    style::row(ui, "fields, of the frame", of(hud.fields.map(percent)));
    style::row(ui, "evaluations a flight", of(hud.fields.map(evaluations)));
    ui.separator();
    latency(ui, hud);
}

fn latency(ui: &mut Ui, hud: &HudState) {
    let parts = &hud.latency;
    let text = |part: Option<f64>| part.map_or("–".to_owned(), |ms| format!("{ms:.1}"));
    style::heading(ui, "FROM KEY TO EAR, MILLISECONDS");
    for (name, part) in [
        ("key to trace, at most", parts.input_to_trace),
        ("trace to read-back", parts.trace_to_read_back),
        ("gains to sound buffer", parts.gains_to_buffer),
        ("buffer to device", parts.buffer_to_device),
    ] {
        style::row(ui, name, text(part));
    }
    let together = if parts.is_whole() {
        "together, at most"
    } else {
        "as far as known"
    };
    style::row(ui, together, format!("{:.1}", parts.total()));
}
