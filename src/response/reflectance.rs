//! The share of energy that surfaces reflect along an exact path.

use crate::acoustics::early::SpecularPath;
use crate::bands::{self, BAND_COUNT, Bands};
use crate::scene::{Material, Scene};
use std::f64::consts::PI;

/// The share of the energy that all surfaces of a path reflect specularly, by band.
pub(super) fn reflectance_of(scene: &Scene, path: &SpecularPath) -> Bands {
    let at: Vec<(u32, Option<u8>)> = reflections(path).collect();
    reflectance(scene, &at)
}

/// The share of the energy that these surfaces and walls reflect specularly, by band.
pub(super) fn reflectance(scene: &Scene, at: &[(u32, Option<u8>)]) -> Bands {
    along(scene, at.iter().copied(), |material, band| {
        (1.0 - material.absorption[band]) * (1.0 - material.scattering[band])
    })
}

/// The surfaces and walls that reflect a path.
pub(super) fn reflections(path: &SpecularPath) -> impl Iterator<Item = (u32, Option<u8>)> {
    path.surfaces
        .iter()
        .copied()
        .zip(path.walls.iter().copied())
}

/// The share of waves not scattered at these surfaces and walls, averaged over the bands.
pub(super) fn mirrored_share(scene: &Scene, at: impl Iterator<Item = (u32, Option<u8>)>) -> f64 {
    let mirrored = |material: &Material, band: usize| 1.0 - material.scattering[band];
    bands::mean(&along(scene, at, mirrored))
}

/// Mean number of waves, out of `waves`, that cross a listener of this radius along a path.
pub(super) fn passing(scene: &Scene, path: &SpecularPath, radius_m: f64, waves: u32) -> f64 {
    let mirrored = path.spreading * mirrored_share(scene, reflections(path));
    f64::from(waves) * PI * radius_m * radius_m * mirrored
}

/// The product of a property of the materials of these surfaces and walls, by band.
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
