//! The sound of a source that is hidden from the listener: paths around what is in the way, and the path through it.

use super::diffraction::{self, DiffractedPath};
use super::source_sound::{HeardPath, Medium, PathKind, comes_from};
use super::transmission;
use crate::bands::{self, BAND_COUNT, Bands};
use crate::error::Error;
use crate::response::exact_paths::{EarlyPaths, SpecularPath};
use crate::scene::{IntoPair, Pair, Scene};
use glam::DVec3;
use std::f64::consts::PI;

/// What diffraction does to the sound of a pair, without reflections: the paths around what hides the source, by length,
/// and the energy of the direct sound by band, relative to that in the open. No paths if the pair is in sight.
///
/// # Errors
/// The errors of [`Scene::validate`].
#[doc(hidden)]
pub fn diffracted<'a>(pair: impl IntoPair<'a>) -> Result<(Vec<HeardPath>, Bands), Error> {
    let pair = pair.chosen()?;
    let medium = Medium::of(pair);
    let around = paths_around(pair, &medium)?;
    let beside = match around.is_empty() {
        true => beside(pair, &medium)?,
        false => [0.0; BAND_COUNT],
    };
    Ok((around, beside))
}

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
        .map(|path| Path::from(path).heard(pair, medium))
        .collect();
    heard.sort_by(|a, b| a.delay_s.total_cmp(&b.delay_s));
    Ok(heard)
}

/// The energy of the direct sound by band, relative to that in the open, with the edges beside its way: 1 without edges.
pub(super) fn beside(pair: Pair, medium: &Medium) -> Result<Bands, Error> {
    let early = EarlyPaths::new(pair)?;
    let ends = early.ends(pair);
    let faces = |surface: u32| pressure_reflection(pair.scene, surface);
    let ends = (ends.source, ends.listener);
    Ok(diffraction::beside(
        early.exact(),
        ends,
        medium.speed,
        faces,
    ))
}

/// The share of the pressure that a surface reflects, by band: 1 for a surface without a material.
fn pressure_reflection(scene: &Scene, surface: u32) -> Bands {
    let index = (surface as usize).checked_sub(1);
    let material = index.and_then(|index| scene.material(index, None));
    material.map_or([1.0; BAND_COUNT], |material| {
        material.absorption.map(|share| (1.0 - share).sqrt())
    })
}

/// The path straight through what hides the source of a pair from its listener; `None` if nothing passes, or if either
/// is in a solid. `around` are the paths around the obstacle: it intercepts only the rest of the front.
pub(super) fn path_through(
    pair: Pair,
    medium: &Medium,
    around: &[HeardPath],
) -> Result<Option<HeardPath>, Error> {
    let early = EarlyPaths::new(pair)?;
    let ends = early.ends(pair);
    if !early.is_open(ends.source) || !early.is_open(ends.listener) {
        return Ok(None);
    }
    let passed = transmission::through(pair.scene, early.exact(), (ends.source, ends.listener));
    Ok(passed.map(|passed| {
        let (direction, length_m) = (ends.listener - ends.source).normalize_and_length();
        let detour = |path: &HeardPath| path.path.length_m - length_m;
        let detours: Vec<f64> = around.iter().map(detour).collect();
        let intercepted = diffraction::intercepted(&detours, medium.speed);
        let arriving = intercepted.map(|share| share * spreading(length_m));
        let path = Path {
            kind: PathKind::Transmitted,
            points: passed.points,
            surfaces: passed.surfaces,
            length_m,
            departure: direction,
            arrival_direction: direction,
            energy: std::array::from_fn(|band| arriving[band] * passed.share[band]),
            errors_db: [0.0; BAND_COUNT],
        };
        path.heard(pair, medium)
    }))
}

/// Energy density in 1/m² at a distance in metres from a source of power 1.
fn spreading(length_m: f64) -> f64 {
    1.0 / (4.0 * PI * length_m * length_m)
}

/// A path from a hidden source.
struct Path {
    kind: PathKind,
    points: Vec<DVec3>,
    surfaces: Vec<u32>,
    length_m: f64,
    departure: DVec3,
    arrival_direction: DVec3,
    /// Energy density at the listener by band, in 1/m² for an omnidirectional source of power 1, without the loss in
    /// the air.
    energy: Bands,
    errors_db: Bands,
}

impl From<DiffractedPath> for Path {
    fn from(path: DiffractedPath) -> Path {
        Path {
            kind: PathKind::Diffracted,
            points: path.points,
            surfaces: path.surfaces,
            length_m: path.length_m,
            departure: path.departure,
            arrival_direction: path.arrival_direction,
            energy: path.energy,
            errors_db: path.errors_db,
        }
    }
}

impl Path {
    /// The sound along the path, with the source's level and directivity, and the loss in the air.
    fn heard(self, pair: Pair, medium: &Medium) -> HeardPath {
        let radiated = pair.source.factor(self.departure);
        let emitted = std::array::from_fn(|band| self.energy[band] * radiated[band] * medium.level);
        let (azimuth, elevation) = comes_from(pair.listener, -self.arrival_direction);
        let length_m = self.length_m;
        HeardPath {
            kind: self.kind,
            path: SpecularPath {
                walls: vec![None; self.surfaces.len()],
                surfaces: self.surfaces,
                points: self.points,
                length_m,
                departure: self.departure,
                arrival_direction: self.arrival_direction,
                spreading: spreading(length_m),
                is_focus: false,
                found_by: 0,
                is_searched: true,
            },
            delay_s: length_m / medium.speed,
            energy: bands::through_air(&emitted, &medium.air, length_m),
            errors_db: self.errors_db,
            azimuth,
            elevation,
        }
    }
}
