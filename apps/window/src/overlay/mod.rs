//! The panels over the picture: plan, meters, frame times, controls, help.

mod choices;
mod full_listening;
mod help;
mod labels;
mod materials;
mod meters;
mod plan;
mod style;
#[cfg(test)]
mod tests;
mod times;

pub use plan::Plan;
pub use style::set_style;

use super::keys::{Action, HINT};
use super::latency::Parts;
use super::report::FrameTimes;
use super::sound::SoundStatus;
use super::state::Choices;
use echomarch::internals::fields_cost::FieldsCost;
use echomarch::picture::Drawn;
use echomarch::tracer::{Frame, Wave};
use echomarch_walk::{EarsStatus, World};
use egui::{Align2, RichText, Ui, Vec2};

/// Space between panels and the window's edge, in points.
const MARGIN: f32 = 8.0;
/// Minimum width of a window that shows both side panels, in points.
const ROOM_FOR_BOTH: f32 = style::LEFT + style::RIGHT + 8.0 * MARGIN;
/// Minimum width of a window that shows the lines of text between both panels, in points.
const ROOM_FOR_LINE: f32 = ROOM_FOR_BOTH + 400.0;
/// Width that the left panel takes from the window, including margins, in points. Centred lines of text keep the same
/// distance from the right edge.
const SIDE: f32 = style::LEFT + 2.0 * style::INNER + 2.0 * MARGIN;
/// Width of the list of keys, including margins, in points.
const ROOM_FOR_HELP: f32 = help::WIDTH + 2.0 * style::INNER + 2.0 * MARGIN;
/// Height of a line of text on its own background, including the space above it, in points.
const ABOVE: f32 = 25.0;
/// Height of each further row of text, in points.
const ROW: f32 = 15.0;
/// Minimum height of a window that shows the frame times below the controls, in points.
const ROOM_FOR_TIMES: f32 = 330.0;

/// The space available in a window.
#[derive(Clone, Copy)]
struct Room {
    /// The window's size in points.
    size: Vec2,
    /// Whether the lines of text are below the panels, because they do not fit between them.
    is_narrow: bool,
    /// Maximum width of a line of text, in points.
    line: f32,
    /// Maximum number of rows of a message.
    rows: usize,
    /// Height reserved below the panels for the lines of text, in points.
    below: f32,
    /// Whether the help leaves no space for the panels.
    is_help_alone: bool,
}

impl Room {
    fn of(ui: &Ui, hud: &HudState, chosen: &Choices) -> Room {
        let scale = ui.ctx().pixels_per_point();
        let [width, height] = hud.window.map(|pixels| pixels as f32 / scale);
        let is_narrow = width < ROOM_FOR_LINE;
        let aside = if is_narrow || !chosen.panels {
            3.0 * MARGIN
        } else {
            2.0 * SIDE
        };
        let rows = match (chosen.help, is_narrow) {
            (true, _) => 1,
            (false, true) => 2,
            (false, false) => 4,
        };
        Room {
            size: Vec2::new(width, height),
            is_narrow,
            line: width - aside - 2.0 * style::LINE_INNER,
            rows,
            below: if is_narrow { 2.0 * ABOVE + ROW } else { 0.0 },
            is_help_alone: chosen.help && width < 2.0 * SIDE + ROOM_FOR_HELP,
        }
    }

    /// Whether the frame times fit below the controls.
    fn has_times(&self) -> bool {
        self.size.y >= ROOM_FOR_TIMES
    }
}

/// State that the panels show but do not change.
pub struct HudState<'a> {
    /// The scene in its current state.
    pub world: &'a World,
    /// The scene files that the user can choose.
    pub files: &'a [String],
    /// The last frame of waves.
    pub heard: Option<&'a Frame>,
    /// The paths of some waves: their states after each iteration.
    pub paths: &'a [Vec<Wave>],
    /// The times of the recent frames.
    pub times: &'a [FrameTimes],
    /// Target frame time in milliseconds.
    pub target: f64,
    /// The size and state of the picture as last drawn.
    pub drawn: Drawn,
    /// The requested number of waves, if it is larger than the number that fits the frame time.
    pub more_waves_asked: Option<u32>,
    /// The cost of the scene's marched fields; `None` without marched fields, and until the cost is measured.
    pub fields: Option<&'a FieldsCost>,
    /// The window's size in pixels.
    pub window: [u32; 2],
    /// Latency from a key to the ear.
    pub latency: Parts,
    /// The status of the sound.
    pub sound: &'a SoundStatus,
    /// Level of the left and the right channel, 0 to 1.
    pub levels: [f32; 2],
    /// The pan of the sound that is played, −1 to 1; `None` before any sound.
    pub played_pan: Option<f32>,
    /// The status of full listening, if it is on.
    pub ears: Option<&'a EarsStatus>,
    /// Number of frames after which GL reported an error; `None` if errors are not queried.
    pub gl_errors: Option<u64>,
    /// The message about the last action or error.
    pub message: Option<&'a str>,
    /// The reason why the current contents of the scene's file cannot be used.
    pub refusal: Option<&'a str>,
    /// Whether mouse look is on.
    pub mouse_looks: bool,
    /// GL_RENDERER.
    pub renderer: &'a str,
}

/// Lays out all panels, and returns the requested actions.
pub fn draw(ui: &mut Ui, hud: &HudState, chosen: &mut Choices, plan: &mut Plan) -> Vec<Action> {
    let mut actions = Vec::new();
    if !chosen.is_sizing {
        let size = chosen.text_size;
        let (least, most) = (*choices::TEXT_SIZES.start(), *choices::TEXT_SIZES.end());
        ui.ctx().set_zoom_factor(size.clamp(least, most));
    }
    let room = Room::of(ui, hud, chosen);
    let panels = chosen.panels && !room.is_help_alone;
    if panels && room.size.x >= ROOM_FOR_BOTH {
        left(ui, hud, room, chosen, plan);
    }
    if panels {
        right(ui, hud, room, chosen, &mut actions);
    }
    if panels && room.has_times() {
        lower(ui, hud, room, chosen);
    }
    lines(ui, hud, room);
    if chosen.help {
        help::draw(ui, room.size, &mut actions);
    }
    actions
}

fn left(ui: &Ui, hud: &HudState, room: Room, chosen: &Choices, plan: &mut Plan) {
    style::panel(ui, "left", Align2::LEFT_TOP, Vec2::splat(MARGIN), |ui| {
        ui.set_width(style::LEFT);
        let most = room.size.y - room.below - 3.5 * MARGIN;
        scrolled(ui, most, |ui| {
            plan.draw(ui, hud, chosen.paths);
            ui.add_space(3.0);
            meters::draw(ui, hud);
            ui.separator();
            full_listening::draw(ui, hud);
            meters::heard(ui, hud);
        });
    });
}

fn right(ui: &Ui, hud: &HudState, room: Room, chosen: &mut Choices, actions: &mut Vec<Action>) {
    let offset = Vec2::new(-MARGIN, MARGIN);
    style::panel(ui, "right", Align2::RIGHT_TOP, offset, |ui| {
        ui.set_width(style::RIGHT);
        let times = if room.has_times() { style::TIMES } else { 0.0 };
        let most = room.size.y - room.below - times - 4.5 * MARGIN;
        scrolled(ui, most, |ui| {
            choices::draw(ui, hud, chosen, actions);
        });
    });
}

/// Adds content in an area of at most `most` points, with a scroll bar if the content is higher.
fn scrolled(ui: &mut Ui, most: f32, add: impl FnOnce(&mut Ui)) {
    let most = most.max(60.0);
    egui::ScrollArea::vertical()
        // Without this setting, the area would keep the height of the content of the first frame.
        .min_scrolled_height(most)
        .max_height(most)
        .show(ui, add);
}

fn lower(ui: &Ui, hud: &HudState, room: Room, chosen: &Choices) {
    let offset = Vec2::new(-MARGIN, -MARGIN - room.below);
    style::panel(ui, "lower", Align2::RIGHT_BOTTOM, offset, |ui| {
        times::draw(ui, hud, chosen);
    });
}

/// Draws the hint line, the last message above it, and the reason why the scene's file cannot be used. The reason is
/// shown until the file is corrected.
fn lines(ui: &Ui, hud: &HudState, room: Room) {
    let text = if hud.mouse_looks {
        "mouse look is on: Esc or a click ends it    WASD walk    F1 help"
    } else {
        HINT
    };
    let text = RichText::new(text).color(style::TEXT);
    line(ui, "hint", MARGIN, (room.line, 1), text);
    let most = (room.line, room.rows);
    let refusal = hud.refusal.map(|why| {
        let text = format!("{why} (the last scene stays)");
        RichText::new(text).color(style::BAD)
    });
    let is_above = !room.is_narrow && room.rows > 1;
    if let Some(text) = refusal.clone().filter(|_| is_above) {
        let offset = Vec2::new(0.0, MARGIN);
        style::line(ui, "refusal", Align2::CENTER_TOP, offset, most, text);
    }
    let message = hud
        .message
        .map(|message| RichText::new(message).color(style::BRIGHT));
    if let Some(text) = message.or(refusal.filter(|_| !is_above)) {
        line(ui, "message", MARGIN + ABOVE, most, text);
    }
}

/// Draws a centred line of text at the given distance from the lower edge. `most` is its maximum width and number of
/// rows.
fn line(ui: &Ui, name: &str, up: f32, most: (f32, usize), text: RichText) {
    let offset = Vec2::new(0.0, -up);
    style::line(ui, name, Align2::CENTER_BOTTOM, offset, most, text);
}
