//! The list of all keys, in the middle of the window.

use super::super::keys::{Action, HELP};
use super::{ABOVE, MARGIN, style};
use egui::{Grid, RichText, Ui, Vec2};

/// Width of the list, in points.
pub const WIDTH: f32 = 310.0;
/// Height of the sheet without its list of keys, in points.
const HEADING: f32 = 60.0;

/// Shows the keys in a window of the given size, in points. A button closes the list.
pub fn draw(ui: &Ui, window: Vec2, actions: &mut Vec<Action>) {
    // Height of the hint line at the lower edge and the message above it.
    let below = MARGIN + 2.0 * ABOVE;
    style::sheet(ui, "help", -0.5 * below, |ui| {
        ui.set_width(WIDTH.min(window.x - 2.0 * (style::INNER + MARGIN)));
        ui.horizontal(|ui| {
            ui.heading("Echomarch");
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if ui.button("Close (F1)").clicked() {
                    actions.push(Action::Help);
                }
            });
        });
        ui.label(
            RichText::new("Sound reaches you by waves that walls reflect.").color(style::FAINT),
        );
        super::scrolled(ui, window.y - below - HEADING - 2.0 * MARGIN, keys);
    });
}

fn keys(ui: &mut Ui) {
    for (title, keys) in HELP {
        ui.add_space(4.0);
        ui.label(RichText::new(title).color(style::BRIGHT));
        Grid::new(title)
            .num_columns(2)
            .min_col_width(92.0)
            .spacing([10.0, 0.0])
            .show(ui, |ui| {
                for (key, what) in keys {
                    ui.label(RichText::new(*key).strong());
                    ui.label(*what);
                    ui.end_row();
                }
            });
    }
}
