//! Colours, sizes and common elements of the panels.

use egui::text::{LayoutJob, TextWrapping};
use egui::{
    Align2, Area, Color32, Context, CornerRadius, FontId, Frame, Id, Margin, Response, RichText,
    Sense, Slider, TextStyle, Ui, Vec2, Visuals,
};

/// Width of the panel on the left, in points.
pub const LEFT: f32 = 236.0;
/// Width of the panel on the right, in points.
pub const RIGHT: f32 = 200.0;
/// Height of the panel of frame times, in points.
pub const TIMES: f32 = 126.0;
/// Padding within a panel's edge, in points.
pub const INNER: f32 = 7.0;
/// Horizontal padding of a line of text on its own background, in points.
pub const LINE_INNER: f32 = 8.0;
/// Width of the label before a slider, in points.
pub const LABEL: f32 = 58.0;
/// Width of a slider, in points.
const SLIDER: f32 = 66.0;
/// Width of the number beside a slider, in points, with space for seven digits.
const NUMBER: f32 = 62.0;
/// Height of a row, in points.
pub const ROW: f32 = 15.0;
/// Height of a row of small text, in points.
const SMALL_ROW: f32 = 12.0;

/// Normal text.
pub const TEXT: Color32 = Color32::from_rgb(214, 220, 226);
/// Less important text.
pub const FAINT: Color32 = Color32::from_rgb(146, 155, 164);
/// Highlighted text.
pub const BRIGHT: Color32 = Color32::from_rgb(255, 214, 130);
/// The source.
pub const SOURCE: Color32 = Color32::from_rgb(240, 176, 40);
/// The listener.
pub const LISTENER: Color32 = Color32::from_rgb(86, 180, 233);
/// Waves that reached the listener.
pub const REACHED: Color32 = Color32::from_rgb(255, 128, 44);
/// Waves that are travelling.
pub const TRAVELLING: Color32 = Color32::from_rgb(150, 160, 170);
/// Waves that are dead.
pub const DEAD: Color32 = Color32::from_rgb(40, 190, 145);
/// The direct sound.
pub const DIRECT: Color32 = Color32::from_rgb(245, 245, 245);
/// Exact paths over reflections.
pub const MIRRORED: Color32 = Color32::from_rgb(240, 228, 66);
/// Paths around obstacles.
pub const DIFFRACTED: Color32 = Color32::from_rgb(240, 100, 200);
/// Paths through solids.
pub const TRANSMITTED: Color32 = Color32::from_rgb(150, 140, 255);
/// Errors.
pub const BAD: Color32 = Color32::from_rgb(255, 96, 84);
/// Background of a text in the plan.
pub const BEHIND_TEXT: Color32 = Color32::from_rgba_premultiplied(11, 14, 18, 176);
/// Background of a panel.
const BACK: Color32 = Color32::from_rgba_premultiplied(16, 20, 24, 214);

/// Sets the fonts and colours. Call it once.
pub fn set_style(context: &Context) {
    let mut visuals = Visuals {
        override_text_color: Some(TEXT),
        ..Visuals::dark()
    };
    let widgets = &mut visuals.widgets;
    widgets.inactive.weak_bg_fill = Color32::from_rgb(54, 63, 72);
    widgets.inactive.bg_fill = Color32::from_rgb(54, 63, 72);
    widgets.hovered.weak_bg_fill = Color32::from_rgb(72, 84, 96);
    context.set_visuals(visuals);
    context.all_styles_mut(|style| {
        let sizes = [
            (TextStyle::Small, 9.5),
            (TextStyle::Body, 11.5),
            (TextStyle::Button, 11.5),
            (TextStyle::Heading, 15.0),
        ];
        for (text, size) in sizes {
            style.text_styles.insert(text, FontId::proportional(size));
        }
        style
            .text_styles
            .insert(TextStyle::Monospace, FontId::monospace(10.5));
        style.spacing.item_spacing = Vec2::new(6.0, 3.0);
        style.spacing.interact_size.y = 15.0;
        style.spacing.slider_width = 96.0;
        style.spacing.button_padding = Vec2::new(5.0, 1.0);
        style.interaction.selectable_labels = false;
        // The scroll bar of overflowing content stays visible when the pointer is elsewhere.
        style.spacing.scroll.dormant_handle_opacity = 0.7;
        style.spacing.scroll.floating_allocated_width = 4.0;
    });
}

/// The frame around every panel.
pub fn frame() -> Frame {
    Frame::new()
        .fill(BACK)
        .corner_radius(CornerRadius::same(5))
        .inner_margin(Margin::same(INNER as i8))
}

/// A panel anchored to a position in the window.
pub fn panel(ui: &Ui, name: &str, at: Align2, offset: Vec2, add: impl FnOnce(&mut Ui)) {
    let area = Area::new(Id::unique(name)).anchor(at, offset);
    at_once(ui, name, area, |ui| {
        frame().show(ui, add);
    });
}

/// An opaque panel in the centre of the window, shifted down by `down` points.
pub fn sheet(ui: &Ui, name: &str, down: f32, add: impl FnOnce(&mut Ui)) {
    let offset = Vec2::new(0.0, down);
    let area = Area::new(Id::unique(name)).anchor(Align2::CENTER_CENTER, offset);
    at_once(ui, name, area, |ui| {
        frame().fill(BACK.to_opaque()).show(ui, add);
    });
}

/// Text on its own background, anchored to a position in the window. `most` is its maximum width in points and its
/// maximum number of rows. The text does not react to the mouse.
pub fn line(ui: &Ui, name: &str, at: Align2, offset: Vec2, most: (f32, usize), text: RichText) {
    let area = Area::new(Id::unique(name)).anchor(at, offset);
    at_once(ui, name, area.interactable(false), |ui| {
        label(ui, most, text)
    });
}

/// Draws an area completely in the first frame that requests it, so that a screenshot contains everything that is open.
/// By default, egui only measures the area in its first frame and then fades it in.
fn at_once(ui: &Ui, name: &str, area: Area, add: impl FnOnce(&mut Ui)) {
    let context = ui.ctx();
    let id = Id::unique(name);
    let before = context.memory(|memory| memory.area_rect(id));
    let shown = area.fade_in(false).show(context, add).response.rect;
    let has_grown = |old: egui::Rect| (old.size() - shown.size()).abs().max_elem() > 1.0;
    if before.is_none_or(has_grown) {
        context.request_discard("an area has been measured");
    }
}

fn label(ui: &mut Ui, (width, rows): (f32, usize), text: RichText) {
    Frame::new()
        .fill(BACK)
        .corner_radius(CornerRadius::same(5))
        .inner_margin(Margin::symmetric(LINE_INNER as i8, 3))
        .show(ui, |ui| {
            // A long sentence must wrap, although the area has no width yet.
            let text = egui::WidgetText::from(text);
            let job = text.into_layout_job(ui.style(), TextStyle::Body.into(), egui::Align::Center);
            let mut job = (*job).clone();
            job.wrap = TextWrapping {
                max_width: width,
                max_rows: rows,
                break_anywhere: false,
                overflow_character: Some('…'),
            };
            let galley = ui.ctx().fonts_mut(|fonts| fonts.layout_job(job));
            ui.label(galley);
        });
}

/// A row that begins with its name. The name column has the same width in all rows.
pub fn named<T>(ui: &mut Ui, name: &str, add: impl FnOnce(&mut Ui) -> T) -> T {
    ui.horizontal(|ui| {
        let size = Vec2::new(LABEL, ROW);
        let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
        let at = rect.left_center();
        let font = TextStyle::Body.resolve(ui.style());
        let painter = ui.painter_at(rect);
        let drawn = painter.text(at, Align2::LEFT_CENTER, name, font, TEXT);
        if drawn.width() > rect.width() {
            response.on_hover_text(name);
        }
        add(ui)
    })
    .inner
}

/// A slider in its own row. The parts of the row keep their positions, whatever the number.
pub fn slider(ui: &mut Ui, name: &str, slider: Slider) -> Response {
    named(ui, name, |ui| {
        ui.spacing_mut().slider_width = SLIDER;
        ui.spacing_mut().interact_size.x = NUMBER;
        ui.add(slider)
    })
}

/// Small text in a box with a fixed number of rows.
pub fn note(ui: &mut Ui, text: &str, colour: Color32, rows: usize) {
    let size = Vec2::new(ui.available_width(), SMALL_ROW * rows as f32);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    let mut job = LayoutJob::simple(
        text.to_owned(),
        TextStyle::Small.resolve(ui.style()),
        colour,
        rect.width(),
    );
    job.wrap.max_rows = rows;
    let galley = ui.ctx().fonts_mut(|fonts| fonts.layout_job(job));
    if galley.elided {
        response.on_hover_text(text);
    }
    ui.painter_at(rect).galley(rect.min, galley, colour);
}

/// Formats a name from a file in one line, whatever characters it contains.
pub fn plain(name: &str) -> String {
    echomarch::internals::text::in_a_line(name).into_owned()
}

/// A heading within a panel.
pub fn heading(ui: &mut Ui, text: &str) {
    ui.label(
        RichText::new(text)
            .color(FAINT)
            .text_style(TextStyle::Small),
    );
}

/// A row with two columns: a name in a fainter colour, and a value.
pub fn row(ui: &mut Ui, name: &str, value: impl Into<String>) {
    coloured_row(ui, name, value, TEXT);
}

/// A row as [`row`], with the value in a colour.
pub fn coloured_row(ui: &mut Ui, name: &str, value: impl Into<String>, colour: Color32) {
    ui.horizontal(|ui| {
        ui.label(RichText::new(name).color(FAINT));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.label(RichText::new(value).monospace().color(colour));
        });
    });
}
