//! Notes on decays that last longer than Eyring's formula predicts for a diffuse field.

use crate::bands::BANDS_HZ;
use crate::response::Response;
use crate::response::diagnosis::{Flutter, flutters};
use crate::scene::{Scene, Surface};

/// Returns a sentence for each pair of walls that causes a flutter echo.
pub(super) fn sentences(scene: &Scene, response: &Response) -> Vec<String> {
    let t30_s = response.figures.bands.map(|band| band.t30_s);
    let found = flutters(scene, t30_s);
    let Some(room) = scene.surfaces.first() else {
        return Vec::new();
    };
    let of = |flutter: &Flutter| sentence(room, flutter);
    found.iter().map(of).collect()
}

/// The sentence about a flutter echo in a room, the first surface of its scene.
fn sentence(room: &Surface, flutter: &Flutter) -> String {
    let figures = flutter.bands.iter().map(|of| {
        let hertz = BANDS_HZ[of.band];
        format!(
            "{:.2} s instead of {:.2} s at {hertz} Hz",
            of.t30_s, of.eyring_s
        )
    });
    let figures: Vec<String> = figures.collect();
    let [one, other] = flutter.walls.map(|wall| room.short_label(0, Some(wall)));
    let scatters = match flutter.nothing_scatters {
        true => "nothing scatters: give the scene a scattering, such as 0.1",
        false => "more scattering or absorption of one of these walls shortens T30",
    };
    format!(
        "T30 is more than 1.5 times Eyring's ({}): flutter echo between {one} and {other}; {scatters} (docs/scene-format.md)",
        figures.join(", ")
    )
}
