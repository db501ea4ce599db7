//! The controls: scene, algorithm, waves, sound, and adaptation.

use super::super::adapt::{MOST_WAVES, SCALES};
use super::super::keys::Action;
use super::super::sound::SOUNDS;
use super::super::state::Choices;
use super::{HudState, materials, style};
use echomarch::audio::PanningLaw;
use echomarch::auralisation::Listen;
use echomarch::response::ResponseSettings;
use echomarch::scene::Scene;
use echomarch::tracer::{Algorithm, Profile};
use echomarch_walk::{Part, Parts, ValueSlider, World};
use egui::{Button, ComboBox, DragValue, RichText, Slider, SliderClamping, Ui, Vec2};

/// The explanation of the least level.
const LEAST_LEVEL: &str = "a source is never quieter than this level relative to its direct sound in the open: \
                           a floor for games, not physics";

/// Limits of the size of texts and panels, relative to the size for the screen.
pub const TEXT_SIZES: std::ops::RangeInclusive<f32> = 0.75..=2.5;

/// Draws all controls.
pub fn draw(ui: &mut Ui, hud: &HudState, chosen: &mut Choices, actions: &mut Vec<Action>) {
    scene(ui, hud, chosen, actions);
    ui.separator();
    waves(ui, chosen, actions);
    ui.separator();
    sound(ui, hud, chosen, actions);
    if hud.ears.is_some() {
        ui.separator();
        materials::draw(ui, hud, actions);
    }
    ui.separator();
    frame(ui, hud, chosen);
}

/// A slider that does not clamp a value outside its range until the user moves the slider.
fn slider<'a, T: egui::emath::Numeric>(
    value: &'a mut T,
    range: std::ops::RangeInclusive<T>,
) -> Slider<'a> {
    Slider::new(value, range).clamping(SliderClamping::Edits)
}

fn scene(ui: &mut Ui, hud: &HudState, chosen: &mut Choices, actions: &mut Vec<Action>) {
    style::heading(ui, "SCENE");
    let world = hud.world;
    ui.horizontal(|ui| {
        scenes(ui, hud, actions);
        if ui.button("save").on_hover_text("F5").clicked() {
            actions.push(Action::Save);
        }
    });
    ui.horizontal(|ui| {
        if ui.button("start over").clicked() {
            actions.push(Action::StartOver);
        }
        let carry = if world.carrying {
            "put source down"
        } else {
            "carry source"
        };
        if ui.button(carry).clicked() {
            actions.push(Action::PickUp);
        }
    });
    ui.horizontal(|ui| {
        ui.checkbox(&mut chosen.paths, "paths in the plan");
        if world.moves() {
            let text = if world.paused { "go on" } else { "hold" };
            let button = Button::new(text).min_size(Vec2::new(36.0, 0.0));
            if ui.add(button).clicked() {
                actions.push(Action::Pause);
            }
            ui.monospace(format!("{:4.1} s", world.looped()));
        }
    });
    for slider in &world.sliders {
        value(ui, world, slider, actions);
    }
}

/// The list of scenes: the built-in scenes, then files.
fn scenes(ui: &mut Ui, hud: &HudState, actions: &mut Vec<Action>) {
    let world = hud.world;
    let mut choose = |ui: &mut Ui, name: &str, shown: &str| {
        let is_this = world.name == name;
        let label = ui.selectable_label(is_this, shown);
        if label.on_hover_text(style::plain(name)).clicked() && !is_this {
            actions.push(Action::Scene(name.to_owned()));
        }
    };
    ComboBox::from_id_salt("scene")
        .width(118.0)
        .truncate()
        .selected_text(style::plain(&world.base.name))
        .show_ui(ui, |ui| {
            for name in Scene::BUILTIN_NAMES {
                choose(ui, name, name);
            }
            ui.separator();
            for file in hud.files {
                let name = std::path::Path::new(file).file_name();
                let shown = name.unwrap_or_default().to_string_lossy();
                choose(ui, file, &style::plain(&shown));
            }
            style::note(ui, "files: drop them on the window", style::FAINT, 1);
        });
}

/// The slider of a named value, in the unit of the scene file.
fn value(ui: &mut Ui, world: &World, of: &ValueSlider, actions: &mut Vec<Action>) {
    let mut value = world.value_of(of);
    let slider = slider(&mut value, of.range.clone())
        .logarithmic(of.is_logarithmic)
        .max_decimals(3)
        .step_by(of.step.map_or(0.0, f64::from))
        .suffix(match of.unit {
            "m" => " m",
            other => other,
        });
    if style::slider(ui, &style::plain(&of.name), slider).changed() {
        actions.push(Action::Set(of.name.clone(), value));
    }
}

fn waves(ui: &mut Ui, chosen: &mut Choices, actions: &mut Vec<Action>) {
    style::heading(ui, "WAVES");
    ui.horizontal(|ui| {
        for (key, profile) in [Profile::Thesis, Profile::March, Profile::Hybrid]
            .into_iter()
            .enumerate()
        {
            let text = RichText::new(format!("{} {profile}", key + 1));
            let is_this = chosen.settings.profile() == profile;
            if ui.selectable_label(is_this, text).clicked() {
                actions.push(Action::Profile(profile));
            }
        }
    });
    let settings = &mut chosen.settings;
    let most = MOST_WAVES.max(settings.waves);
    let number = slider(&mut settings.waves, 64..=most).logarithmic(true);
    if style::slider(ui, "waves", number).changed() {
        // After a manual change, the number of waves no longer adapts to the frame time.
        chosen.adapt_waves = false;
    }
    let text = "number follows the frame time";
    ui.checkbox(&mut chosen.adapt_waves, text)
        .on_hover_text("T: as many as fit, 4096 or more");
    let most = 64.max(settings.iterations);
    style::slider(ui, "iterations", slider(&mut settings.iterations, 1..=most));
    match &mut settings.algorithm {
        Algorithm::Thesis(thesis) => {
            let slider = slider(&mut thesis.min_distance, 0.001..=1.0);
            let slider = slider.custom_formatter(|metres, _| format!("{metres:.3} m"));
            let why =
                "a march ends at this distance from a surface: the thesis' only accuracy setting";
            style::slider(ui, "min. dist.", slider.logarithmic(true)).on_hover_text(why);
        }
        Algorithm::March => no_option(ui, "Newton's steps: no minimum distance"),
        Algorithm::Hybrid => no_option(ui, "closed form: no minimum distance"),
    }
}

/// Shows a line of text in place of an option that this algorithm lacks.
fn no_option(ui: &mut Ui, text: &str) {
    ui.horizontal(|ui| {
        ui.set_min_height(style::ROW);
        ui.label(RichText::new(text).color(style::FAINT).small());
    });
}

fn sound(ui: &mut Ui, hud: &HudState, chosen: &mut Choices, actions: &mut Vec<Action>) {
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
        let record = if hud.sound.is_recording {
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
    listening(ui, chosen, actions);
    let colour = if hud.sound.is_heard {
        style::FAINT
    } else {
        style::BRIGHT
    };
    style::note(ui, &hud.sound.text, colour, 2);
}

/// The choice between full listening and the balance, and the choice of the panning law.
fn listening(ui: &mut Ui, chosen: &mut Choices, actions: &mut Vec<Action>) {
    let now = chosen.listen();
    ui.horizontal(|ui| {
        for (listen, name) in [(Listen::Full, "full"), (Listen::Balance, "balance")] {
            let label = ui.selectable_label(now == listen, name);
            if label.on_hover_text("V").clicked() && now != listen {
                actions.push(Action::Listen);
            }
        }
    });
    if now == Listen::Full {
        return parts(ui, &mut chosen.parts);
    }
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
}

/// The switches of the parts of the sound, and the least level.
fn parts(ui: &mut Ui, parts: &mut Parts) {
    let switch = |ui: &mut Ui, parts: &mut Parts, index: usize| {
        let part = Part::ALL[index];
        let text = format!("{} {}", index + 4, part.name());
        ui.checkbox(parts.switch(part), text);
    };
    for pair in [[0, 1], [2, 3]] {
        ui.horizontal(|ui| pair.map(|index| switch(ui, parts, index)));
    }
    ui.horizontal(|ui| {
        switch(ui, parts, 4);
        let lowest_db = ResponseSettings::LOWEST_LEAST_LEVEL_DB;
        let level = DragValue::new(&mut parts.least_level_db);
        let level = level.range(lowest_db..=0.0).fixed_decimals(0);
        ui.add(level.suffix(" dB")).on_hover_text(LEAST_LEVEL);
    });
}

fn frame(ui: &mut Ui, hud: &HudState, chosen: &mut Choices) {
    style::heading(ui, "PICTURE");
    let mut follows = chosen.picture_scale.is_none();
    let drawn = hud.drawn.size[1] as f32 / hud.window[1].max(1) as f32;
    let mut share = chosen.picture_scale.unwrap_or(drawn);
    if ui
        .checkbox(&mut follows, "size follows the frame time")
        .clicked()
    {
        chosen.picture_scale = (!follows).then_some(share);
    }
    let size = slider(&mut chosen.text_size, TEXT_SIZES).fixed_decimals(2);
    let sized = style::slider(ui, "text size", size).on_hover_text("1 is the size for this screen");
    // A slider that changes its own size while it is dragged jumps under the pointer.
    chosen.is_sizing = sized.dragged();
    let range = SCALES[0]..=SCALES[SCALES.len() - 1];
    let slider = slider(&mut share, range).fixed_decimals(2);
    if style::slider(ui, "of window", slider).changed() {
        chosen.picture_scale = Some(share);
    }
    ui.horizontal(|ui| {
        ui.label("waves every");
        let every = egui::DragValue::new(&mut chosen.trace_every);
        ui.add(every.range(1..=60).clamp_existing_to_range(false));
        ui.label("pictures");
    });
    let (text, colour) = match hud.gl_errors {
        None => (hud.renderer.to_owned(), style::FAINT),
        Some(0) => (format!("{}; 0 GL errors", hud.renderer), style::FAINT),
        Some(some) => (format!("{}; {some} GL errors", hud.renderer), style::BAD),
    };
    style::note(ui, &text, colour, 1);
}
