//! What surfaces leave of the energy of an exact path.

use crate::acoustics::early::SpecularPath;
use crate::bands::{self, BAND_COUNT, Bands};
use crate::scene::{Material, Scene};
use std::f64::consts::PI;

/// The share of the energy that is mirrored at all surfaces of a path, by band.
pub(super) fn reflectance_of(scene: &Scene, path: &SpecularPath) -> Bands {
    let at: Vec<(u32, Option<u8>)> = reflections(path).collect();
    reflectance(scene, &at)
}

/// The share of the energy that is mirrored at these surfaces and walls, by band.
pub(super) fn reflectance(scene: &Scene, at: &[(u32, Option<u8>)]) -> Bands {
    along(scene, at.iter().copied(), |material, band| {
        (1.0 - material.absorption[band]) * (1.0 - material.scattering[band])
    })
}

/// The surfaces and walls that a path is mirrored at.
pub(super) fn reflections(path: &SpecularPath) -> impl Iterator<Item = (u32, Option<u8>)> {
    path.surfaces
        .iter()
        .copied()
        .zip(path.walls.iter().copied())
}

/// The share of waves that are not scattered at these surfaces and walls, of the mean of the bands.
pub(super) fn mirrored_share(scene: &Scene, at: impl Iterator<Item = (u32, Option<u8>)>) -> f64 {
    let mirrored = |material: &Material, band: usize| 1.0 - material.scattering[band];
    bands::mean(&along(scene, at, mirrored))
}

/// How many of `waves` waves pass a listener of this radius along a path, on average.
pub(super) fn passing(scene: &Scene, path: &SpecularPath, radius_m: f64, waves: u32) -> f64 {
    let mirrored = path.spreading * mirrored_share(scene, reflections(path));
    f64::from(waves) * PI * radius_m * radius_m * mirrored
}

/// What is left after these surfaces and walls, by what the material of each leaves in a band.
fn along(
    scene: &Scene,
    at: impl Iterator<Item = (u32, Option<u8>)>,
    left: impl Fn(&Material, usize) -> f64,
) -> Bands {
    let mut all = [1.0; BAND_COUNT];
    for (surface, wall) in at {
        let index = surface as usize - 1;
        let Some(material) = scene.material(index, wall.map(usize::from)) else {
            continue;
        };
        for (band, all) in all.iter_mut().enumerate() {
            *all *= left(material, band);
        }
    }
    all
}
