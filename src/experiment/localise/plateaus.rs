//! From which count of waves or iterations on more does not help.

use super::report::{Cell, Plateau, SceneReport};
use super::statistics::{ErrorFigures, Step, plateau};

/// What grows, by name, and how to read it and the other one off a cell.
type Axis = (&'static str, fn(&Cell) -> u32, fn(&Cell) -> u32);

const AXES: [Axis; 2] = [
    ("waves", |cell| cell.waves, |cell| cell.iterations),
    ("iterations", |cell| cell.iterations, |cell| cell.waves),
];

/// A truth, by name, and how to read the errors from it off a cell.
type Truth = (&'static str, fn(&Cell) -> &ErrorFigures);

const TRUTHS: [Truth; 2] = [
    ("source", |cell| &cell.source),
    ("limit", |cell| &cell.limit),
];

/// A count says nothing of where from this share of unheard trials on.
const MOST_UNHEARD: f64 = 0.5;

/// The plateaus of every scene, sound and profile, along waves and along iterations: one for
/// each value of the other that has three counts or more.
pub fn find(scenes: &[SceneReport]) -> Vec<Plateau> {
    let mut found = Vec::new();
    for scene in scenes {
        for (sound, profile) in kinds(&scene.cells) {
            let of = |cell: &&Cell| cell.sound == sound && cell.profile == profile;
            let cells: Vec<&Cell> = scene.cells.iter().filter(of).collect();
            for axis in &AXES {
                for truth in &TRUTHS {
                    found.extend(along(&scene.scene, &cells, axis, truth));
                }
            }
        }
    }
    found
}

/// Every sound and profile that there is, in order.
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

fn along(scene: &str, cells: &[&Cell], axis: &Axis, truth: &Truth) -> Vec<Plateau> {
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
            .map(|cell| step(growing(cell), cell, truth.1(cell)))
            .collect();
        Some(Plateau {
            scene: scene.to_owned(),
            sound: last.sound.clone(),
            profile: last.profile.clone(),
            against: truth.0,
            along: name,
            fixed: value,
            count: plateau(&steps),
            best: best(&steps),
            largest: growing(last),
            error: *truth.1(last),
        })
    };
    values.into_iter().filter_map(plateau_at).collect()
}

fn step(count: u32, cell: &Cell, error: &ErrorFigures) -> Step {
    Step {
        count,
        median_deg: error.median_abs_deg,
        interval_deg: (error.low_deg, error.high_deg),
        heard: cell.unheard < MOST_UNHEARD,
    }
}

/// The count with the smallest median error, of those that are heard.
fn best(steps: &[Step]) -> Option<u32> {
    let heard = steps.iter().filter(|step| step.heard);
    let best = heard.min_by(|a, b| a.median_deg.total_cmp(&b.median_deg));
    best.map(|step| step.count)
}
