//! Text on plans and maps: the font, the names of sources and listeners, the scale bar and the legend of paths.

use super::marks::{INK, PLATE, PLATE_COLOUR, STYLES, Style, rectangle};
use super::plan::Plan;
use crate::scene::Scene;
use crate::tracer::Fate;
use glam::Vec3;
use tiny_skia::PixmapMut;

/// Dots from one letter's left edge to the next.
pub(super) const ADVANCE: usize = 6;

/// Writes `text` with dots of `dot` pixels, from the upper left.
pub(super) fn write(canvas: &mut PixmapMut, text: &str, left: f32, top: f32, dot: f32) {
    for (place, letter) in text.chars().enumerate() {
        for (row, bits) in dots(letter).into_iter().enumerate() {
            for column in (0..5).filter(|column| bits >> (4 - column) & 1 == 1) {
                let x = left + dot * (ADVANCE * place + column) as f32;
                rectangle(canvas, [x, top + dot * row as f32, dot, dot], INK, 1.0);
            }
        }
    }
}

/// The letters, each with its seven rows of five dots: lower case, digits, and the capitals of units and figures.
const LETTERS: &str = "\
0 01110 10001 10011 10101 11001 10001 01110
1 00100 01100 00100 00100 00100 00100 01110
2 01110 10001 00001 00110 01000 10000 11111
3 11111 00010 00100 00010 00001 10001 01110
4 00010 00110 01010 10010 11111 00010 00010
5 11111 10000 11110 00001 00001 10001 01110
6 00110 01000 10000 11110 10001 10001 01110
7 11111 00001 00010 00100 01000 01000 01000
8 01110 10001 10001 01110 10001 10001 01110
9 01110 10001 10001 01111 00001 00010 01100
+ 00000 00100 00100 11111 00100 00100 00000
, 00000 00000 00000 00000 01100 00100 01000
- 00000 00000 00000 11111 00000 00000 00000
. 00000 00000 00000 00000 00000 01100 01100
/ 00000 00001 00010 00100 01000 10000 00000
: 00000 01100 01100 00000 01100 01100 00000
B 11110 10001 10001 11110 10001 10001 11110
G 01110 10001 10000 10111 10001 10001 01111
H 10001 10001 10001 11111 10001 10001 10001
a 00000 00000 01110 00001 01111 10001 01111
b 10000 10000 11110 10001 10001 10001 11110
c 00000 00000 01110 10001 10000 10001 01110
d 00001 00001 01101 10011 10001 10001 01111
e 00000 00000 01110 10001 11111 10000 01110
f 00110 01001 01000 11100 01000 01000 01000
g 00000 00000 01111 10001 01111 00001 01110
h 10000 10000 11110 10001 10001 10001 10001
i 00100 00000 01100 00100 00100 00100 01110
j 00010 00000 00110 00010 00010 10010 01100
k 10000 10000 10010 10100 11000 10100 10010
l 01100 00100 00100 00100 00100 00100 01110
m 00000 00000 11010 10101 10101 10101 10101
n 00000 00000 11110 10001 10001 10001 10001
o 00000 00000 01110 10001 10001 10001 01110
p 00000 00000 11110 10001 11110 10000 10000
q 00000 00000 01111 10001 01111 00001 00001
r 00000 00000 10110 11001 10000 10000 10000
s 00000 00000 01110 10000 01110 00001 11110
t 01000 01000 11100 01000 01000 01001 00110
u 00000 00000 10001 10001 10001 10011 01101
v 00000 00000 10001 10001 10001 01010 00100
w 00000 00000 10001 10001 10101 10101 01010
x 00000 00000 10001 01010 00100 01010 10001
y 00000 00000 10001 10001 01111 00001 01110
z 00000 00000 11111 00010 00100 01000 11111
T 11111 00100 00100 00100 00100 00100 00100
C 01110 10001 10000 10000 10000 10001 01110
D 11110 10001 10001 10001 10001 10001 11110
E 11111 10000 10000 11110 10000 10000 11111
";

/// A letter's seven rows of five dots. Other capitals are drawn in lower case, and unknown characters as a gap.
fn dots(letter: char) -> [u8; 7] {
    let find = |letter: char| LETTERS.lines().find_map(|line| line.strip_prefix(letter));
    let rows = find(letter).or_else(|| find(letter.to_ascii_lowercase()));
    let mut dots = [0; 7];
    for (dots, row) in dots
        .iter_mut()
        .zip(rows.unwrap_or_default().split_whitespace())
    {
        *dots = u8::from_str_radix(row, 2).unwrap_or(0);
    }
    dots
}

/// Maximum number of letters drawn of a name.
const LONGEST_NAME: usize = 24;

/// Writes the names of the sources if there are several sources, and the names of the listeners if there are several
/// listeners.
pub(super) fn draw_names(canvas: &mut PixmapMut, plan: &Plan, scene: &Scene) {
    let unit = plan.stroke();
    if scene.sources.len() > 1 {
        for (source, name) in scene.sources.iter().zip(scene.source_labels()) {
            write_beside(canvas, plan, source.position, 12.0 * unit, &name);
        }
    }
    if scene.listeners.len() > 1 {
        for (listener, name) in scene.listeners.iter().zip(scene.listener_labels()) {
            let right = plan.pixels(listener.radius) + 6.0 * unit;
            write_beside(canvas, plan, listener.position, right, &name);
        }
    }
}

/// Writes a name `right` pixels to the right of a world position.
fn write_beside(canvas: &mut PixmapMut, plan: &Plan, place: Vec3, right: f32, name: &str) {
    let dot = plan.dot();
    let middle = plan.pixel(place);
    let left = (middle.x + right).round();
    let top = (middle.y - 3.5 * dot).round();
    let shown: String = name.chars().take(LONGEST_NAME).collect();
    let width = dot * (ADVANCE * shown.chars().count()) as f32;
    let plate = [
        left - 2.0 * dot,
        top - 2.0 * dot,
        width + 3.0 * dot,
        11.0 * dot,
    ];
    rectangle(canvas, plate, PLATE_COLOUR, PLATE);
    write(canvas, &shown, left, top, dot);
}

/// Maximum length of the bar, as a share of the picture's width.
const LONGEST: f32 = 0.25;

/// Draws the bar in the lower left corner.
pub(super) fn draw_scale_bar(canvas: &mut PixmapMut, plan: &Plan) {
    let (length, fields) = nice_length(LONGEST * plan.width as f32 * plan.metres);
    let unit = plan.stroke();
    let dot = plan.dot();
    let label = label(length);
    let width = plan.pixels(length);
    let label_width = dot * (ADVANCE * label.len()) as f32;
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

/// The largest of 1, 2, 5, 10, 20, 50 … that is at most `most`, and the number of the bar's fields. The bar has one
/// field per metre for lengths up to 5 m.
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

/// Length of a line sample, in the plan's stroke unit.
const SAMPLE: f32 = 22.0;
const ROW: f32 = 16.0;

/// Row height in dots; a letter is seven dots high.
const ROW_DOTS: f32 = 10.0;

/// Minimum width of a sample in pixels: thinner lines look pale.
const LEAST_WIDTH: f32 = 2.0;

/// Opacity of the background: with a lower opacity, the plan's lines below it could be mistaken for samples.
const GROUND: f32 = 0.97;

/// Draws the line styles of these fates as a legend in the upper left corner.
pub(super) fn draw_path_legend(canvas: &mut PixmapMut, plan: &Plan, fates: &[Fate]) {
    // The legend has the order in which the lines overlap, the topmost first.
    let styles = STYLES.iter().rev();
    let shown: Vec<&Style> = styles.filter(|style| fates.contains(&style.fate)).collect();
    let unit = plan.stroke();
    let dot = plan.dot();
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
        (SAMPLE + 24.0) * unit + dot * (ADVANCE * longest) as f32,
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects titles and labels: each letter used in them has its own pattern of dots.
    #[test]
    fn letters_differ() {
        let letters = "abcdefghijklmnopqrstuvwxyz0123456789-.+:,/BCDEGHT";
        let drawn: Vec<[u8; 7]> = letters.chars().map(dots).collect();
        for (at, letter) in drawn.iter().enumerate() {
            assert_ne!(*letter, [0; 7], "{at}");
            assert!(!drawn[..at].contains(letter), "{at}");
        }
    }

    /// Protects the reader from a bar with an uneven length or a wrong label.
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
