//! The legend of the paths of waves on a plan: the meaning of their colours.

use super::font::{self, write};
use super::marks::{PLATE_COLOUR, rectangle};
use super::plan::Plan;
use super::wave_paths::{STYLES, Style};
use crate::trace::Fate;
use tiny_skia::PixmapMut;

/// Length of a line sample, in the plan's stroke unit.
const SAMPLE: f32 = 22.0;
const ROW: f32 = 16.0;

/// Minimum dots of a row: a letter has seven.
const ROW_DOTS: f32 = 10.0;

/// Minimum width of a sample in pixels: thinner ones are pale.
const LEAST_WIDTH: f32 = 2.0;

/// Opacity of the background: otherwise the plan's lines below it could be mistaken for samples.
const GROUND: f32 = 0.97;

/// Draws the line styles of these fates in the upper left corner.
pub(super) fn draw(canvas: &mut PixmapMut, plan: &Plan, fates: &[Fate]) {
    // In the order in which the lines overlap, the uppermost first.
    let styles = STYLES.iter().rev();
    let shown: Vec<&Style> = styles.filter(|style| fates.contains(&style.fate)).collect();
    let unit = plan.stroke();
    let dot = (1.6 * unit).round().max(1.0);
    let longest = shown.iter().map(|style| style.meaning.len()).max();
    let Some(longest) = longest else {
        return;
    };
    let row = (ROW * unit).max(ROW_DOTS * dot);
    let (left, top) = (16.0 * unit, 14.0 * unit);
    let text = left + (SAMPLE + 8.0) * unit;
    let plate = [
        left - 8.0 * unit,
        top - 7.0 * unit,
        (SAMPLE + 24.0) * unit + dot * (font::ADVANCE * longest) as f32,
        row * shown.len() as f32 + 10.0 * unit,
    ];
    rectangle(canvas, plate, PLATE_COLOUR, GROUND);
    for (index, style) in shown.into_iter().enumerate() {
        let middle = top + row * (index as f32 + 0.5) - 2.0 * unit;
        let thick = (1.6 * style.width * unit).max(LEAST_WIDTH);
        let sample = [left, middle - thick / 2.0, SAMPLE * unit, thick];
        rectangle(canvas, sample, style.colour, 1.0);
        write(
            canvas,
            style.meaning,
            text.round(),
            (middle - 3.5 * dot).round(),
            dot,
        );
    }
}
