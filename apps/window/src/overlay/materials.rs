//! The choice of each surface's material.

use super::super::keys::Action;
use super::{HudState, style};
use echomarch::scene::Material;
use egui::{ComboBox, Ui};

/// Maximum number of surfaces listed. Further surfaces are not shown, because a longer menu is impractical.
const MOST_SURFACES: usize = 64;

/// Draws a menu of the surfaces, and a menu of materials for the chosen surface.
pub fn draw(ui: &mut Ui, hud: &HudState, actions: &mut Vec<Action>) {
    style::heading(ui, "MATERIAL");
    let surfaces = &hud.world.base.surfaces;
    if surfaces.is_empty() {
        return;
    }
    let id = ui.scope_id().with("surface");
    let chosen: usize = ui.data(|data| data.get_temp(id)).unwrap_or(0);
    let mut chosen = chosen.min(surfaces.len() - 1);
    let label = |index: usize| match &surfaces[index].name {
        Some(name) => style::plain(name),
        None => format!("surface {}", index + 1),
    };
    ui.horizontal(|ui| {
        ComboBox::from_id_salt("surface")
            .width(96.0)
            .truncate()
            .selected_text(label(chosen))
            .show_ui(ui, |ui| {
                for index in 0..surfaces.len().min(MOST_SURFACES) {
                    ui.selectable_value(&mut chosen, index, label(index));
                }
            });
        materials(ui, hud, chosen, actions);
    });
    ui.data_mut(|data| data.insert_temp(id, chosen));
}

fn materials(ui: &mut Ui, hud: &HudState, surface: usize, actions: &mut Vec<Action>) {
    let scene = &hud.world.base;
    let now = scene.surfaces[surface].material.as_deref();
    let own = scene.materials.keys().map(String::as_str);
    let known = Material::BUILTIN.iter().map(|material| material.name);
    ComboBox::from_id_salt("material")
        .width(96.0)
        .truncate()
        .selected_text(now.map_or("reflects all".to_owned(), style::plain))
        .show_ui(ui, |ui| {
            if ui.selectable_label(now.is_none(), "reflects all").clicked() {
                actions.push(Action::Material(surface, None));
            }
            for name in own.chain(known) {
                let label = ui.selectable_label(now == Some(name), style::plain(name));
                if label.clicked() {
                    actions.push(Action::Material(surface, Some(name.to_owned())));
                }
            }
        });
}
