//! The keys, all of them, in the middle of the window.

use super::super::keys::{Action, HELP};
use super::{Facts, style};
use egui::{Grid, RichText, Ui};

/// Points of the window's height that are not for the keys.
const HEADING: f32 = 80.0;

/// Shows the keys; a button closes them.
pub fn draw(ui: &Ui, facts: &Facts, actions: &mut Vec<Action>) {
    style::sheet(ui, "help", |ui| {
        ui.set_width(310.0);
        ui.horizontal(|ui| {
            ui.heading("Echomarch");
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if ui.button("Close (F1)").clicked() {
                    actions.push(Action::Help);
                }
            });
        });
        ui.label(
            RichText::new("Sound reaches you by waves that walls mirror.").color(style::FAINT),
        );
        super::scrolled(ui, facts, HEADING, keys);
    });
}

fn keys(ui: &mut Ui) {
    for (title, keys) in HELP {
        ui.add_space(4.0);
        ui.label(RichText::new(title).color(style::BRIGHT));
        Grid::new(title)
            .num_columns(2)
            .min_col_width(92.0)
            .spacing([10.0, 2.0])
            .show(ui, |ui| {
                for (key, what) in keys {
                    ui.label(RichText::new(*key).strong());
                    ui.label(*what);
                    ui.end_row();
                }
            });
    }
}
