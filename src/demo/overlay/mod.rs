//! The panels over the picture: plan, meters, times, choices, help.

mod choices;
mod help;
mod meters;
mod plan;
mod question;
mod style;
mod times;

pub use plan::Plan;
pub use question::{Asked, Paper, draw as draw_question};
pub use style::set_style;

use super::keys::{Action, HINT};
use super::latency::Parts;
use super::report::FrameTimes;
use super::sound::SoundStatus;
use super::state::{Choices, World};
use super::view::Drawn;
use crate::trace::{Frame, Wave};
use egui::{Align2, RichText, Ui, Vec2};

/// Space between panels and the window's edge, in points.
const MARGIN: f32 = 8.0;
/// Width that both side panels need, in points.
const ROOM_FOR_BOTH: f32 = style::LEFT + style::RIGHT + 8.0 * MARGIN;
/// Width that the line at the bottom needs beside both, in points.
const ROOM_FOR_LINE: f32 = ROOM_FOR_BOTH + 400.0;
/// From one line of text in the middle to the one above it, in points.
const ABOVE: f32 = 25.0;

/// What the panels show and nobody changes there.
pub struct Facts<'a> {
    /// The scene as it stands.
    pub world: &'a World,
    /// What was heard last.
    pub heard: Option<&'a Frame>,
    /// The paths of some waves, by iteration.
    pub paths: &'a [Vec<Wave>],
    /// The last frames' times.
    pub times: &'a [FrameTimes],
    /// Milliseconds that a frame may take.
    pub target: f64,
    /// What was drawn of the picture.
    pub drawn: Drawn,
    /// The window's size in pixels.
    pub window: [u32; 2],
    /// From a key to the ear.
    pub latency: Parts,
    /// The sound.
    pub sound: &'a SoundStatus,
    /// Level of the left and the right channel, 0 to 1.
    pub levels: [f32; 2],
    /// Frames after which GL reported an error; none where GL is not asked.
    pub gl_errors: Option<u64>,
    /// The last thing that was done or went wrong.
    pub message: Option<&'a str>,
    /// Why the scene's file as it is now is not what is seen.
    pub refusal: Option<&'a str>,
    /// Whether the mouse looks about.
    pub mouse_looks: bool,
    /// GL_RENDERER.
    pub renderer: &'a str,
}

/// Lays out everything; what was asked for comes out.
pub fn draw(ui: &mut Ui, facts: &Facts, chosen: &mut Choices, plan: &mut Plan) -> Vec<Action> {
    let mut actions = Vec::new();
    if chosen.panels && width(ui, facts) >= ROOM_FOR_BOTH {
        left(ui, facts, chosen, plan);
    }
    if chosen.panels {
        right(ui, facts, chosen, &mut actions);
        lower(ui, facts);
    }
    hint(ui, facts);
    if chosen.help {
        help::draw(ui, facts, &mut actions);
    }
    actions
}

fn left(ui: &Ui, facts: &Facts, chosen: &Choices, plan: &mut Plan) {
    style::panel(ui, "left", Align2::LEFT_TOP, Vec2::splat(MARGIN), |ui| {
        ui.set_width(style::LEFT);
        scrolled(ui, facts, 3.5 * MARGIN + below_panels(ui, facts), |ui| {
            plan.draw(ui, facts, chosen.paths);
            ui.add_space(3.0);
            meters::draw(ui, facts);
            ui.separator();
            meters::heard(ui, facts);
        });
    });
}

fn right(ui: &Ui, facts: &Facts, chosen: &mut Choices, actions: &mut Vec<Action>) {
    let offset = Vec2::new(-MARGIN, MARGIN);
    style::panel(ui, "right", Align2::RIGHT_TOP, offset, |ui| {
        ui.set_width(style::RIGHT);
        let below = style::TIMES + 4.5 * MARGIN + below_panels(ui, facts);
        scrolled(ui, facts, below, |ui| {
            choices::draw(ui, facts, chosen, actions);
        });
    });
}

/// The window's width in points.
fn width(ui: &Ui, facts: &Facts) -> f32 {
    facts.window[0] as f32 / ui.ctx().pixels_per_point()
}

/// Points below the panels that are left to the line in the middle, where it has no room
/// between them.
fn below_panels(ui: &Ui, facts: &Facts) -> f32 {
    match width(ui, facts) < ROOM_FOR_LINE {
        true => ABOVE,
        false => 0.0,
    }
}

/// As high as the window allows without so many points of it, and scrolled where that is too
/// little.
fn scrolled(ui: &mut Ui, facts: &Facts, without: f32, add: impl FnOnce(&mut Ui)) {
    let height = facts.window[1] as f32 / ui.ctx().pixels_per_point();
    let most = (height - without).max(80.0);
    egui::ScrollArea::vertical()
        // Else it would keep the height of the first frame's content.
        .min_scrolled_height(most)
        .max_height(most)
        .show(ui, add);
}

fn lower(ui: &Ui, facts: &Facts) {
    let offset = Vec2::new(-MARGIN, -MARGIN - below_panels(ui, facts));
    style::panel(ui, "lower", Align2::RIGHT_BOTTOM, offset, |ui| {
        times::draw(ui, facts);
    });
}

/// What stands below the question: how the sound fares, and the last message.
pub fn draw_below_question(ui: &Ui, facts: &Facts) {
    let text = RichText::new(&facts.sound.text).color(style::FAINT);
    line(ui, "hint", MARGIN, text);
    message(ui, facts);
}

/// The line that is always there, and the last message above it.
fn hint(ui: &Ui, facts: &Facts) {
    let text = if facts.mouse_looks {
        "the mouse looks about: Esc or a click frees it    WASD walk    F1 help"
    } else {
        HINT
    };
    line(ui, "hint", MARGIN, RichText::new(text).color(style::TEXT));
    message(ui, facts);
    if let Some(why) = facts.refusal {
        // It stands until the file is mended.
        let text = RichText::new(format!("{why} (the last scene stays)"));
        let text = text.color(style::BAD);
        style::line(
            ui,
            "refusal",
            Align2::CENTER_TOP,
            Vec2::new(0.0, MARGIN),
            text,
        );
    }
}

/// The last message, above the line at the bottom.
fn message(ui: &Ui, facts: &Facts) {
    if let Some(message) = facts.message {
        let text = RichText::new(message).color(style::BRIGHT);
        line(ui, "message", MARGIN + ABOVE, text);
    }
}

/// A line of text in the middle, that far from the lower edge.
fn line(ui: &Ui, name: &str, up: f32, text: RichText) {
    style::line(ui, name, Align2::CENTER_BOTTOM, Vec2::new(0.0, -up), text);
}
