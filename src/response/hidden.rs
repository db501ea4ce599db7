//! The sound of a source that is hidden from the listener: paths around what is in the way.

use super::diffraction::{self, DiffractedPath};
use super::source_sound::{HeardPath, Medium, PathKind, comes_from};
use crate::bands::{self, BAND_COUNT, Bands};
use crate::error::Error;
use crate::response::exact_paths::{EarlyPaths, SpecularPath};
use crate::scene::{Pair, Scene};
use std::f64::consts::PI;

/// The paths around what hides the source of a pair from its listener, by length; none if they see each other, or if
/// either is in a solid.
pub(super) fn paths_around(pair: Pair, medium: &Medium) -> Result<Vec<HeardPath>, Error> {
    let early = EarlyPaths::new(pair)?;
    let ends = early.ends(pair);
    if !early.is_open(ends.source) || !early.is_open(ends.listener) {
        return Ok(Vec::new());
    }
    let faces = |surface: u32| pressure_reflection(pair.scene, surface);
    let ends = (ends.source, ends.listener);
    let paths = diffraction::around(early.exact(), ends, medium.speed, faces);
    let mut heard: Vec<HeardPath> = paths
        .into_iter()
        .map(|path| heard(pair, medium, path))
        .collect();
    heard.sort_by(|a, b| a.delay_s.total_cmp(&b.delay_s));
    Ok(heard)
}

/// The share of the pressure that a surface reflects, by band: 1 for a surface without a material.
fn pressure_reflection(scene: &Scene, surface: u32) -> Bands {
    let index = (surface as usize).checked_sub(1);
    let material = index.and_then(|index| scene.material(index, None));
    material.map_or([1.0; BAND_COUNT], |material| {
        material.absorption.map(|share| (1.0 - share).sqrt())
    })
}

fn heard(pair: Pair, medium: &Medium, path: DiffractedPath) -> HeardPath {
    let emitted = path.energy.map(|energy| energy * medium.level);
    let (azimuth, elevation) = comes_from(pair.listener, -path.arrival_direction);
    let length_m = path.length_m;
    HeardPath {
        kind: PathKind::Diffracted,
        path: SpecularPath {
            walls: vec![None; path.surfaces.len()],
            surfaces: path.surfaces,
            points: path.points,
            length_m,
            departure: path.departure,
            arrival_direction: path.arrival_direction,
            spreading: 1.0 / (4.0 * PI * length_m * length_m),
            is_focus: false,
            found_by: 0,
            is_searched: true,
        },
        delay_s: length_m / medium.speed,
        energy: bands::through_air(&emitted, &medium.air, length_m),
        azimuth,
        elevation,
    }
}
