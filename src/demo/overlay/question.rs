//! The panel of the localisation experiment: the plan to answer on, and what else is asked.

use super::super::question::Question;
use super::{Facts, style};
use crate::experiment::localise::sitting::Put;
use crate::experiment::localise::{MOST_CONFIDENT, Side};
use egui::{
    Align2, Button, Color32, ColorImage, Painter, Pos2, Rect, RichText, Sense, Stroke,
    TextureHandle, TextureOptions, Ui, Vec2,
};
use glam::DVec2;

/// Sides of the plan at the most, in points.
const PLAN: Vec2 = Vec2::new(330.0, 250.0);

/// What a person does while a question is put.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Asked {
    /// Play the sound.
    Play,
    /// Mark a place, in metres to the right and ahead.
    Mark(DVec2),
    /// Move the mark by so many steps to the right and ahead.
    Nudge(DVec2),
    /// It comes from that side.
    Side(Side),
    /// So sure: 1 … [`MOST_CONFIDENT`].
    Confidence(u32),
    /// Keep the answer and go on.
    Lock,
}

/// The plan of the trial that it was drawn for.
#[derive(Default)]
pub struct Paper {
    texture: Option<(u32, TextureHandle)>,
}

/// Draws the panel; what was done comes out.
pub fn draw(ui: &mut Ui, facts: &Facts, question: &Question, paper: &mut Paper) -> Vec<Asked> {
    let mut asked = Vec::new();
    let offset = Vec2::splat(super::MARGIN);
    style::panel(ui, "question", Align2::LEFT_TOP, offset, |ui| {
        ui.set_width(PLAN.x);
        let height = facts.window[1] as f32 / ui.ctx().pixels_per_point();
        super::scrolled(ui, height - 6.0 * super::MARGIN, |ui| {
            content(ui, question, paper, &mut asked);
        });
    });
    asked
}

fn content(ui: &mut Ui, question: &Question, paper: &mut Paper, asked: &mut Vec<Asked>) {
    let [answered, all] = question.progress();
    let Some(put) = question.put() else {
        ui.heading(format!("All {all} are answered"));
        if !question.is_saved() {
            ui.label(RichText::new("The last answers could not be written to").color(style::BAD));
            ui.label(RichText::new(question.file()).strong());
            ui.label("Closing the window (Ctrl+Q) tries once more.");
            return;
        }
        ui.label("Thank you. Your answers are kept in");
        ui.label(RichText::new(question.file()).strong());
        ui.label("Ctrl+Q closes the window.");
        return;
    };
    ui.horizontal(|ui| {
        ui.heading("Where does it come from?");
        ui.label(RichText::new(format!("{} of {all}", answered + 1)).color(style::FAINT));
    });
    play(ui, question, asked);
    ui.label(
        RichText::new("Mark on the plan where the sound is. The arrow is where you look.").small(),
    );
    paper.draw(ui, question, put, asked);
    sides(ui, question, asked);
    confidence(ui, question, asked);
    lock(ui, question, asked);
    let text = "Ctrl+Q ends: the same command goes on with the next.";
    ui.label(RichText::new(text).color(style::FAINT).small());
}

fn play(ui: &mut Ui, question: &Question, asked: &mut Vec<Asked>) {
    ui.horizontal(|ui| {
        let text = if question.is_playing() {
            "playing …"
        } else {
            "Play (Space)"
        };
        if ui.button(text).clicked() {
            asked.push(Asked::Play);
        }
        let times = match question.plays() {
            0 => "headphones on, face the screen; − and + make it softer, louder".to_owned(),
            1 => "played once".to_owned(),
            times => format!("played {times} times"),
        };
        ui.label(RichText::new(times).color(style::FAINT));
    });
}

impl Paper {
    /// The plan with the gaze upwards; a click marks where the sound seems to be.
    fn draw(&mut self, ui: &mut Ui, question: &Question, put: Put, asked: &mut Vec<Asked>) {
        let plan = put.plan;
        let size = plan.max - plan.min;
        let scale = (PLAN.x / size.x as f32).min(PLAN.y / size.y as f32);
        let room = scale * Vec2::new(size.x as f32, size.y as f32);
        let (rect, response) = ui.allocate_exact_size(room, Sense::click_and_drag());
        self.refresh(ui, put);
        let painter = ui.painter_at(rect);
        if let Some((_, texture)) = &self.texture {
            let all = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
            painter.image(texture.id(), rect, all, Color32::WHITE);
        }
        let to_screen = |place: DVec2| {
            let x = (place.x - plan.min.x) as f32;
            let y = (plan.max.y - place.y) as f32;
            rect.min + scale * Vec2::new(x, y)
        };
        listener(&painter, to_screen(DVec2::ZERO), scale * plan.radius as f32);
        if let Some(mark) = question.draft.mark {
            cross(&painter, to_screen(DVec2::ZERO), to_screen(mark));
        }
        if let Some(at) = response.interact_pointer_pos() {
            let offset = (at - rect.min) / scale;
            let x = plan.min.x + f64::from(offset.x);
            let y = plan.max.y - f64::from(offset.y);
            asked.push(Asked::Mark(DVec2::new(x, y).clamp(plan.min, plan.max)));
        }
    }

    /// Loads the plan of another trial.
    fn refresh(&mut self, ui: &Ui, put: Put) {
        if self
            .texture
            .as_ref()
            .is_some_and(|(of, _)| *of == put.number)
        {
            return;
        }
        // The program wrote it itself a moment ago.
        let Ok(picture) = image::load_from_memory(&put.plan.plan_png) else {
            return;
        };
        let picture = picture.to_rgba8();
        let size = [picture.width() as usize, picture.height() as usize];
        let image = ColorImage::from_rgba_unmultiplied(size, picture.as_raw());
        let texture = ui
            .ctx()
            .load_texture("paper", image, TextureOptions::LINEAR);
        self.texture = Some((put.number, texture));
    }
}

/// The listener from above, with the gaze upwards.
fn listener(painter: &Painter, at: Pos2, radius: f32) {
    let radius = radius.max(4.0);
    let blue = Color32::from_rgb(20, 100, 180);
    painter.circle(at, radius, blue.gamma_multiply(0.2), Stroke::new(1.0, blue));
    painter.arrow(at, Vec2::new(0.0, -(radius + 12.0)), Stroke::new(2.0, blue));
}

/// The mark, and the way to it.
fn cross(painter: &Painter, from: Pos2, at: Pos2) {
    let red = Color32::from_rgb(200, 40, 30);
    painter.line_segment([from, at], Stroke::new(1.0, red.gamma_multiply(0.6)));
    painter.circle(at, 6.0, red.gamma_multiply(0.3), Stroke::new(2.0, red));
}

fn sides(ui: &mut Ui, question: &Question, asked: &mut Vec<Asked>) {
    ui.horizontal(|ui| {
        for (side, text) in [
            (Side::Left, "left (A)"),
            (Side::Centre, "ahead or behind (W)"),
            (Side::Right, "right (D)"),
        ] {
            let is_this = question.draft.side == Some(side);
            if ui.selectable_label(is_this, text).clicked() {
                asked.push(Asked::Side(side));
            }
        }
    });
}

fn confidence(ui: &mut Ui, question: &Question, asked: &mut Vec<Asked>) {
    ui.horizontal(|ui| {
        ui.label("a guess");
        for confidence in 1..=MOST_CONFIDENT {
            let is_this = question.draft.confidence == Some(confidence);
            if ui
                .selectable_label(is_this, confidence.to_string())
                .clicked()
            {
                asked.push(Asked::Confidence(confidence));
            }
        }
        ui.label("certain");
    });
}

fn lock(ui: &mut Ui, question: &Question, asked: &mut Vec<Asked>) {
    let missing = question.missing();
    ui.horizontal(|ui| {
        let button = Button::new("Lock and go on (Enter)");
        if ui.add_enabled(missing.is_empty(), button).clicked() {
            asked.push(Asked::Lock);
        }
        let text = match missing.is_empty() {
            true => "a locked answer stays".to_owned(),
            false => format!("first {}", missing.join(", ")),
        };
        ui.label(RichText::new(text).color(style::FAINT).small());
    });
}
