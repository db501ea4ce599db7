//! The part of a report that its text and its plot show.

use super::report::{Cell, LocaliseReport, Plateau, SceneReport};

/// Iterations of the plateaus along waves, where they were measured: the thesis' own.
const ITERATIONS: [u32; 2] = [4, 8];
/// Waves of the plateaus along iterations, where they were measured.
const WAVES: u32 = 65_536;

/// Rows of the first sound: the others' are the same but for rounding.
pub(super) fn first_sound(scene: &SceneReport) -> impl Iterator<Item = &Cell> {
    let first = scene.cells.first().map(|cell| cell.sound.as_str());
    scene
        .cells
        .iter()
        .filter(move |cell| Some(cell.sound.as_str()) == first)
}

/// The count that a panel or table is about: the wanted one if it was measured, otherwise the
/// largest that was; none if nothing was measured.
pub(super) fn measured(scene: &SceneReport, wanted: u32, count: fn(&Cell) -> u32) -> Option<u32> {
    let counts = || scene.cells.iter().map(count);
    counts()
        .find(|&found| found == wanted)
        .or_else(|| counts().max())
}

/// The plateaus of the first sound at the thesis' iterations and at many waves, the profiles
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
