//! Selects the part of a report that the document and the plot show.

use super::report::{Cell, LocaliseReport, Plateau, SceneReport};

/// Numbers of iterations (those of the thesis) for the plateaus along the number of waves, if they were measured.
const ITERATIONS: [u32; 2] = [4, 8];
/// Number of waves for the plateaus along the number of iterations, if it was measured.
const WAVES: u32 = 65_536;

/// The rows of the first sound. The rows of other sounds differ only by rounding errors.
pub(super) fn first_sound(scene: &SceneReport) -> impl Iterator<Item = &Cell> {
    let first = scene.cells.first().map(|cell| cell.sound.as_str());
    scene
        .cells
        .iter()
        .filter(move |cell| Some(cell.sound.as_str()) == first)
}

/// The number to show in a panel or table: `wanted` if it was measured, otherwise the largest measured number. `None`
/// if nothing was measured.
pub(super) fn measured(scene: &SceneReport, wanted: u32, count: fn(&Cell) -> u32) -> Option<u32> {
    let counts = || scene.cells.iter().map(count);
    counts()
        .find(|&found| found == wanted)
        .or_else(|| counts().max())
}

/// The plateaus of the first sound at the thesis' numbers of iterations and at one number of waves, with the profiles
/// side by side.
pub(super) fn shown_plateaus(report: &LocaliseReport) -> Vec<&Plateau> {
    let mut shown = Vec::new();
    for scene in &report.scenes {
        let first = scene.cells.first().map(|cell| cell.sound.as_str());
        let iterations = ITERATIONS.map(|wanted| measured(scene, wanted, |of| of.iterations));
        let waves = measured(scene, WAVES, |of| of.waves);
        let is_shown = |plateau: &&Plateau| {
            let fixed = Some(plateau.fixed);
            plateau.scene == scene.scene
                && Some(plateau.sound.as_str()) == first
                && match plateau.along {
                    "waves" => iterations.contains(&fixed),
                    _ => waves == fixed,
                }
        };
        let mut here: Vec<&Plateau> = report.plateaus.iter().filter(is_shown).collect();
        here.sort_by_key(|of| (of.of, of.along, of.fixed));
        shown.extend(here);
    }
    shown
}
