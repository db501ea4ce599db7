//! The scale bar of a plan: fields of equal length, alternately black and white, and the total
//! length as text.

use super::font::{INK, write};
use super::marks::{PLATE, PLATE_COLOUR, rectangle};
use super::plan::Plan;
use tiny_skia::PixmapMut;

/// Maximum length of the bar, as a share of the picture's width.
const LONGEST: f32 = 0.25;

/// Draws the bar in the lower left corner.
pub(super) fn draw(canvas: &mut PixmapMut, plan: &Plan) {
    let (length, fields) = nice_length(LONGEST * plan.width as f32 * plan.metres);
    let unit = plan.stroke();
    let dot = (1.6 * unit).round().max(1.0);
    let label = label(length);
    let width = plan.pixels(length);
    let label_width = dot * (6 * label.len()) as f32;
    let (left, bottom) = (16.0 * unit, plan.height as f32 - 14.0 * unit);
    let bar = 7.0 * unit;
    let plate = [
        left - 8.0 * unit,
        bottom - bar - 7.0 * unit,
        width + label_width + 24.0 * unit,
        bar + 14.0 * unit,
    ];
    rectangle(canvas, plate, PLATE_COLOUR, PLATE);
    rectangle(canvas, [left, bottom - bar, width, bar], INK, 1.0);
    let field = width / fields as f32;
    let edge = (1.2 * unit).max(0.5);
    for index in (1..fields).step_by(2) {
        let x = left + index as f32 * field;
        let inner = [x, bottom - bar + edge, field - edge, bar - 2.0 * edge];
        rectangle(canvas, inner, PLATE_COLOUR, 1.0);
    }
    let x = (left + width + 8.0 * unit).round();
    write(
        canvas,
        &label,
        x,
        (bottom - bar / 2.0 - 3.5 * dot).round(),
        dot,
    );
}

/// The largest of 1, 2, 5, 10, 20, 50 … that is at most `most`, and the number of its fields: one
/// per metre for lengths up to 5 m.
fn nice_length(most: f32) -> (f32, u32) {
    let power = 10f32.powf(most.log10().floor());
    match most / power {
        share if share >= 5.0 => (5.0 * power, 5),
        share if share >= 2.0 => (2.0 * power, 2),
        _ => (power, 5),
    }
}

fn label(metres: f32) -> String {
    if metres >= 0.999 {
        format!("{metres:.0} m")
    } else if metres >= 0.00999 {
        format!("{:.0} cm", metres * 100.0)
    } else {
        String::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the reader from a bar with an odd length or label.
    #[test]
    fn lengths_are_round_and_labelled() {
        let cases = [
            (0.3, 0.2, "20 cm"),
            (1.0, 1.0, "1 m"),
            (4.9, 2.0, "2 m"),
            (8.2, 5.0, "5 m"),
            (99.0, 50.0, "50 m"),
            (250.0, 200.0, "200 m"),
        ];
        for (most, length, text) in cases {
            assert!((nice_length(most).0 - length).abs() < 1e-4, "{most}");
            assert_eq!(label(nice_length(most).0), text);
        }
    }
}
