//! What can be chosen: scene, algorithm, waves, sound, and what adapts.

use super::super::adapt::{MOST_WAVES, SCALES};
use super::super::keys::Action;
use super::super::sound::SOUNDS;
use super::super::state::Choices;
use super::{Facts, style};
use crate::audio::PanningLaw;
use crate::scene::BUILTIN_NAMES;
use crate::trace::Profile;
use egui::{ComboBox, RichText, Slider, SliderClamping, Ui};

/// Metres of the shell at the slider's end.
const WIDEST_SHELL: f64 = 1e8;

/// Draws all controls.
pub fn draw(ui: &mut Ui, facts: &Facts, chosen: &mut Choices, actions: &mut Vec<Action>) {
    scene(ui, facts, chosen, actions);
    ui.separator();
    waves(ui, chosen, actions);
    ui.separator();
    sound(ui, facts, chosen, actions);
    ui.separator();
    frame(ui, facts, chosen);
}

/// A slider that leaves a value beyond its ends alone until it is drawn.
fn slider<'a, T: egui::emath::Numeric>(
    value: &'a mut T,
    range: std::ops::RangeInclusive<T>,
) -> Slider<'a> {
    Slider::new(value, range).clamping(SliderClamping::Edits)
}

fn scene(ui: &mut Ui, facts: &Facts, chosen: &mut Choices, actions: &mut Vec<Action>) {
    style::heading(ui, "SCENE");
    let world = facts.world;
    ui.horizontal(|ui| {
        ComboBox::from_id_salt("scene")
            .width(118.0)
            .selected_text(&world.base.name)
            .show_ui(ui, |ui| {
                for name in BUILTIN_NAMES {
                    let is_this = world.name == name;
                    if ui.selectable_label(is_this, name).clicked() && !is_this {
                        actions.push(Action::Scene(name.to_owned()));
                    }
                }
            });
        if ui.button("save").on_hover_text("F5").clicked() {
            actions.push(Action::Save);
        }
    });
    ui.horizontal(|ui| {
        let carry = if world.carrying {
            "put source down"
        } else {
            "carry source"
        };
        if ui.button(carry).clicked() {
            actions.push(Action::PickUp);
        }
        if ui.button("start over").clicked() {
            actions.push(Action::StartOver);
        }
    });
    ui.horizontal(|ui| {
        ui.checkbox(&mut chosen.paths, "paths in the plan");
        if world.moves() {
            let text = if world.paused { "go on" } else { "hold" };
            if ui.button(text).clicked() {
                actions.push(Action::Pause);
            }
            ui.monospace(format!("{:.1} s", world.looped()));
        }
    });
}

fn waves(ui: &mut Ui, chosen: &mut Choices, actions: &mut Vec<Action>) {
    style::heading(ui, "WAVES");
    ui.horizontal(|ui| {
        for (key, profile) in [Profile::Thesis, Profile::March, Profile::Hybrid]
            .into_iter()
            .enumerate()
        {
            let text = RichText::new(format!("{} {profile}", key + 1));
            let is_this = chosen.settings.profile == profile;
            if ui.selectable_label(is_this, text).clicked() {
                actions.push(Action::Profile(profile));
            }
        }
    });
    let settings = &mut chosen.settings;
    ui.add_enabled_ui(!chosen.adapt_waves, |ui| {
        let most = MOST_WAVES.max(settings.waves);
        let slider = slider(&mut settings.waves, 64..=most);
        ui.add(slider.logarithmic(true).text("waves"));
    });
    ui.checkbox(&mut chosen.adapt_waves, "waves follow the frame time");
    let most = 64.max(settings.iterations);
    ui.add(slider(&mut settings.iterations, 1..=most).text("iterations"));
    match settings.profile {
        Profile::Thesis => {
            let slider = slider(&mut settings.min_distance, 0.001..=1.0);
            let slider = slider.custom_formatter(|metres, _| format!("{metres:.3} m"));
            let slider = slider.logarithmic(true).text("min. dist.");
            let why = "a march ends this near to a surface: the thesis' only measure of accuracy";
            ui.add(slider).on_hover_text(why);
        }
        Profile::March => {
            let slider = slider(&mut settings.min_distance, 0.001..=WIDEST_SHELL as f32);
            let slider = slider.custom_formatter(|metres, _| shell(metres));
            let why = "within this distance of a surface steps are Newton's, along the ray";
            ui.add(slider.logarithmic(true).text("shell"))
                .on_hover_text(why);
        }
        _ => {
            let text = "closed form: no minimum distance";
            ui.label(RichText::new(text).color(style::FAINT).small());
        }
    }
}

/// The width of the shell where steps are Newton's. As wide as the slider goes it is all of
/// the scene.
fn shell(metres: f64) -> String {
    if metres >= WIDEST_SHELL {
        return "all".to_owned();
    }
    let decimals = if metres < 1.0 { 3 } else { 0 };
    format!("{metres:.decimals$} m")
}

fn sound(ui: &mut Ui, facts: &Facts, chosen: &mut Choices, actions: &mut Vec<Action>) {
    style::heading(ui, "SOUND");
    ui.horizontal(|ui| {
        ComboBox::from_id_salt("sound")
            .width(104.0)
            .selected_text(&chosen.sound)
            .show_ui(ui, |ui| {
                for name in SOUNDS {
                    let is_this = chosen.sound == name;
                    if ui.selectable_label(is_this, name).clicked() && !is_this {
                        actions.push(Action::Sound(name.to_owned()));
                    }
                }
            });
        let record = if facts.sound.is_recording {
            "stop"
        } else {
            "record"
        };
        if ui.button(record).on_hover_text("F9").clicked() {
            actions.push(Action::Record);
        }
    });
    ui.horizontal(|ui| {
        ui.add(Slider::new(&mut chosen.volume, 0.0..=1.0).show_value(false));
        ui.label("volume");
        ui.checkbox(&mut chosen.muted, "mute");
    });
    ui.horizontal(|ui| {
        for (law, name) in [
            (PanningLaw::Linear, "linear"),
            (PanningLaw::ConstantPower, "constant power"),
        ] {
            if ui.selectable_label(chosen.law() == law, name).clicked() {
                chosen.chosen_law = Some(law);
            }
        }
    });
    let colour = if facts.sound.is_heard {
        style::FAINT
    } else {
        style::BRIGHT
    };
    ui.label(RichText::new(&facts.sound.text).color(colour).small());
}

fn frame(ui: &mut Ui, facts: &Facts, chosen: &mut Choices) {
    style::heading(ui, "PICTURE");
    let mut follows = chosen.picture_scale.is_none();
    if ui
        .checkbox(&mut follows, "size follows the frame time")
        .clicked()
    {
        let share = facts.drawn.size[1] as f32 / facts.window[1].max(1) as f32;
        chosen.picture_scale = (!follows).then_some(share);
    }
    if let Some(scale) = &mut chosen.picture_scale {
        let range = SCALES[0]..=SCALES[SCALES.len() - 1];
        ui.add(slider(scale, range).text("of window"));
    }
    ui.horizontal(|ui| {
        ui.label("waves every");
        let every = egui::DragValue::new(&mut chosen.trace_every);
        ui.add(every.range(1..=60).clamp_existing_to_range(false));
        ui.label("pictures");
    });
    let (text, colour) = match facts.gl_errors {
        None => (facts.renderer.to_owned(), style::FAINT),
        Some(0) => (format!("{}; 0 GL errors", facts.renderer), style::FAINT),
        Some(some) => (format!("{}; {some} GL errors", facts.renderer), style::BAD),
    };
    ui.label(RichText::new(text).color(colour).small());
}
