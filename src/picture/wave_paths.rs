//! The paths of waves, drawn on a plan and coloured by the waves' fates.

use super::marks::{colour, paint, polyline, round, stroke};
use super::plan::Plan;
use crate::scene::Scene;
use crate::trace::{Fate, Wave};
use glam::{Vec2, Vec3};
use tiny_skia::{GradientStop, LinearGradient, Paint, PixmapMut, Point, SpreadMode, Transform};

/// Waves that reached the listener: vermilion.
const REACHED: [u8; 3] = [213, 94, 0];
/// Waves that are still travelling.
const TRAVELLING: [u8; 3] = [120, 128, 136];
/// Waves that are dead: bluish green.
const DEAD: [u8; 3] = [0, 158, 115];

/// Length of the stub that shows the direction of a dead wave, as a share of the width.
const STUB: f32 = 0.16;

/// One wave's line.
struct Line {
    fate: Fate,
    points: Vec<Vec2>,
    /// World position and direction where the wave died.
    stub: Option<(Vec3, Vec3)>,
}

/// The drawing style of a fate.
pub(super) struct Style {
    pub fate: Fate,
    pub colour: [u8; 3],
    pub opacity: f32,
    /// Width in the plan's stroke unit.
    pub width: f32,
    /// The text in the legend.
    pub meaning: &'static str,
}

/// The styles, in drawing order.
pub(super) const STYLES: [Style; 3] = [
    Style {
        fate: Fate::Dead,
        colour: DEAD,
        opacity: 0.7,
        width: 1.1,
        meaning: "gone: met nothing more",
    },
    Style {
        fate: Fate::Travelling,
        colour: TRAVELLING,
        opacity: 0.55,
        width: 0.9,
        meaning: "travelling at the end",
    },
    Style {
        fate: Fate::Listener,
        colour: REACHED,
        opacity: 0.95,
        width: 1.9,
        meaning: "reached the listener",
    },
];

/// Draws the waves of [`crate::Tracer::paths`], those that reached the listener on top. Returns their fates.
pub(super) fn draw(
    canvas: &mut PixmapMut,
    plan: &Plan,
    scene: &Scene,
    states: &[Vec<Wave>],
) -> Vec<Fate> {
    let waves = states.first().map_or(0, Vec::len);
    // A source in a solid sends no waves: all are dead from the start.
    let lines: Vec<Line> = (0..waves)
        .filter(|&wave| states[0][wave].fate() != Fate::Dead)
        .map(|wave| follow(plan, scene.source.position, states, wave))
        .collect();
    let unit = plan.stroke();
    for style in &STYLES {
        let pen = round(style.width * unit);
        for line in lines.iter().filter(|line| line.fate == style.fate) {
            let path = polyline(&line.points);
            stroke(canvas, path, &paint(style.colour, style.opacity), &pen);
            if let Some((from, direction)) = line.stub {
                draw_stub(canvas, plan, from, direction, style.opacity);
            }
        }
    }
    lines.iter().map(|line| line.fate).collect()
}

/// The positions of one wave until it reached the listener or died. The later steps of a dead wave
/// (it is marched again from the origin) do not belong to its path.
fn follow(plan: &Plan, source: Vec3, states: &[Vec<Wave>], wave: usize) -> Line {
    let mut line = Line {
        fate: Fate::Travelling,
        points: vec![plan.pixel(source)],
        stub: None,
    };
    let mut last = (source, Vec3::ZERO);
    for (iteration, waves) in states.iter().enumerate() {
        let state = &waves[wave];
        if iteration == 0 {
            last.1 = state.start_direction;
            continue;
        }
        line.fate = match state.fate() {
            Fate::NotFinite => Fate::Dead,
            fate => fate,
        };
        if line.fate == Fate::Dead {
            line.stub = Some(last);
            break;
        }
        line.points.push(plan.pixel(state.position));
        last = (state.position, state.direction);
        if line.fate == Fate::Listener {
            break;
        }
    }
    line
}

/// A line that fades along the direction in which a wave was lost.
fn draw_stub(canvas: &mut PixmapMut, plan: &Plan, from: Vec3, direction: Vec3, opacity: f32) {
    let length = STUB * plan.width as f32 * plan.metres;
    let start = plan.pixel(from);
    let end = plan.pixel(from + length * direction);
    let stops = vec![
        GradientStop::new(0.0, colour(DEAD, opacity)),
        GradientStop::new(1.0, colour(DEAD, 0.0)),
    ];
    let gradient = LinearGradient::new(
        Point::from_xy(start.x, start.y),
        Point::from_xy(end.x, end.y),
        stops,
        SpreadMode::Pad,
        Transform::identity(),
    );
    // `None` for a stub of zero length.
    if let Some(shader) = gradient {
        let fading = Paint {
            shader,
            anti_alias: true,
            ..Paint::default()
        };
        let pen = round(1.1 * plan.stroke());
        stroke(canvas, polyline(&[start, end]), &fading, &pen);
    }
}
