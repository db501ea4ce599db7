//! Finds the number of waves or iterations beyond which a larger number gives no improvement.
//!
//! A number is as good as the largest number if its figure does not exceed the larger of two bounds. The first bound is
//! the upper end of the confidence interval at the largest number. The second bound is the figure at the largest number
//! plus [`AUDIBLE_DEG`], because a smaller difference is inaudible. The plateau begins at the smallest number from
//! which on all numbers are as good as the largest. If only the largest number satisfies this, the beginning of the
//! plateau is unknown.

use super::report::{Cell, Plateau, SceneReport};
use super::statistics::Figure;

/// The minimum audible angle ahead, in degrees (Mills 1958): the smallest change of direction of a tone of 250 to 1000
/// Hz that people notice in natural hearing. Levels alone allow no smaller angle.
pub const AUDIBLE_DEG: f64 = 1.0;

/// An axis: its name, and the functions that return a cell's number on this axis and on the other axis.
type Axis = (&'static str, fn(&Cell) -> u32, fn(&Cell) -> u32);

const WAVES: Axis = ("waves", |cell| cell.waves, |cell| cell.iterations);
const ITERATIONS: Axis = ("iterations", |cell| cell.iterations, |cell| cell.waves);

/// A figure: its name, and the function that returns it from a cell.
type Measure = (&'static str, fn(&Cell) -> Option<Figure>);

const SOURCE: Measure = ("source", |cell| Some(cell.source?.median_abs));
const LIMIT: Measure = ("limit", |cell| Some(cell.limit?.median_abs));
const SPREAD: Measure = ("spread", |cell| cell.source?.spread);

/// The combinations of axis and figure to examine. The limit is not examined along iterations, because each number of
/// iterations has its own limit.
const LOOKS: [(Axis, Measure); 5] = [
    (WAVES, SOURCE),
    (WAVES, LIMIT),
    (WAVES, SPREAD),
    (ITERATIONS, SOURCE),
    (ITERATIONS, SPREAD),
];

/// Share of unheard trials from which on a number of waves or iterations has no figure.
const MOST_UNHEARD: f64 = 0.5;

/// The plateaus of every scene, sound and profile, along the number of waves and along the number of iterations. There
/// is one plateau for each value of the other number, if at least three steps were measured.
pub fn find(scenes: &[SceneReport]) -> Vec<Plateau> {
    let mut found = Vec::new();
    for scene in scenes {
        for (sound, profile) in kinds(&scene.cells) {
            let of = |cell: &&Cell| cell.sound == sound && cell.profile == profile;
            let cells: Vec<&Cell> = scene.cells.iter().filter(of).collect();
            for (axis, measure) in &LOOKS {
                found.extend(along(&scene.scene, &cells, axis, measure));
            }
        }
    }
    found
}

/// Every combination of sound and profile, in order.
fn kinds(cells: &[Cell]) -> Vec<(&str, &str)> {
    let mut kinds = Vec::new();
    for cell in cells {
        let kind = (cell.sound.as_str(), cell.profile.as_str());
        if !kinds.contains(&kind) {
            kinds.push(kind);
        }
    }
    kinds
}

fn along(scene: &str, cells: &[&Cell], axis: &Axis, measure: &Measure) -> Vec<Plateau> {
    const LEAST_COUNTS: usize = 3;
    let (name, growing, fixed) = axis;
    let mut values: Vec<u32> = cells.iter().map(|cell| fixed(cell)).collect();
    values.sort_unstable();
    values.dedup();
    let plateau_at = |value: u32| {
        let mut row: Vec<&Cell> = cells
            .iter()
            .copied()
            .filter(|c| fixed(c) == value)
            .collect();
        row.sort_by_key(|cell| growing(cell));
        let last = (row.len() >= LEAST_COUNTS).then(|| row.last().copied())??;
        let steps: Vec<Step> = row
            .iter()
            .map(|cell| Step {
                count: growing(cell),
                figure: measure.1(cell).filter(|_| cell.unheard < MOST_UNHEARD),
            })
            .collect();
        Some(Plateau {
            scene: scene.to_owned(),
            sound: last.sound.clone(),
            profile: last.profile.clone(),
            of: measure.0,
            along: name,
            fixed: value,
            count: plateau(&steps),
            least: least(&steps),
            largest: growing(last),
            there: measure.1(last),
        })
    };
    values.into_iter().filter_map(plateau_at).collect()
}

/// One step along an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Step {
    /// Number of waves or iterations.
    count: u32,
    /// The figure; `None` if too many trials were unheard.
    figure: Option<Figure>,
}

/// The smallest number from which on every figure is as good as the figure at the largest number; `None` if the largest
/// number has no figure. `steps` are sorted by number. A step without a figure interrupts the plateau.
fn plateau(steps: &[Step]) -> Option<u32> {
    let last = steps.last()?.figure?;
    let high = last.interval_deg.map_or(last.deg, |[_, high]| high);
    let highest = high.max(last.deg + AUDIBLE_DEG);
    let settled = steps
        .iter()
        .rev()
        .take_while(|step| step.figure.is_some_and(|figure| figure.deg <= highest));
    settled.last().map(|step| step.count)
}

/// The number with the smallest figure, among the steps that have a figure.
fn least(steps: &[Step]) -> Option<u32> {
    let heard = steps
        .iter()
        .filter_map(|step| Some((step.count, step.figure?.deg)));
    let least = heard.min_by(|a, b| a.1.total_cmp(&b.1));
    least.map(|(count, _)| count)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(count: u32, deg: f64, half: f64) -> Step {
        let interval_deg = Some([deg - half, deg + half]);
        let figure = Some(Figure { deg, interval_deg });
        Step { count, figure }
    }

    /// Protects the plateau: a small number that is good by chance does not begin a plateau, and a step in which
    /// nothing is heard interrupts it.
    #[test]
    fn the_plateau_begins_where_all_that_follow_are_as_good() {
        let mut steps = [5.5, 9.0, 6.9, 5.0].map(|deg| step(0, deg, 2.0));
        for (count, step) in [1, 2, 4, 8].into_iter().zip(&mut steps) {
            step.count = count;
        }
        assert_eq!((plateau(&steps), least(&steps)), (Some(4), Some(8)));
        steps[2].figure = None;
        assert_eq!(plateau(&steps), Some(8));
        steps[3].figure = None;
        assert_eq!((plateau(&steps), least(&steps)), (None, Some(1)));
        assert_eq!(plateau(&[]), None);
    }

    /// Protects against a missed plateau if the last confidence interval is narrower than the audible angle.
    #[test]
    fn what_nobody_hears_is_as_good() {
        let steps = |third| [step(1, 4.0, 0.1), step(2, third, 0.1), step(4, 0.2, 0.1)];
        assert_eq!(plateau(&steps(1.19)), Some(2));
        assert_eq!(plateau(&steps(1.21)), Some(4));
        let unsure = [step(1, 3.0, 0.1), step(2, 0.2, 4.0)];
        assert_eq!(plateau(&unsure), Some(1));
    }
}
