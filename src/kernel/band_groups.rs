//! Which octave bands one set of waves can carry.
//!
//! A reflection sends a wave one way for all bands. Where bands scatter by different shares its energy makes up for
//! that (`materials.rs`), and spreads by a factor with each reflection: after many of them few waves would carry
//! nearly all energy of a band. Such bands are traced by waves of their own.

use super::materials::{materials_met, mean_scattering};
use crate::bands::{BAND_COUNT, Bands};
use crate::scene::{Material, Scene};
use std::ops::Range;

/// Evaluated range of a decay, as a share of the energy: 30 dB.
const DECAYED: f64 = 1e-3;

/// Growth of the mean square of energies over such a decay, at most: to twice, as if half the waves were left.
const MOST_GROWTH: f64 = 2.0;

/// Groups of bands, each of which is traced by waves of its own: one where all scatter alike.
pub fn band_groups(scene: &Scene) -> Vec<Range<usize>> {
    let materials: Vec<&Material> = materials_met(scene).collect();
    let fit = |bands: &Range<usize>| materials.iter().all(|m| scatters_alike(m, bands));
    let mut groups = Vec::new();
    let mut first = 0;
    for end in 1..=BAND_COUNT {
        if end == BAND_COUNT || !fit(&(first..end + 1)) {
            groups.push(first..end);
            first = end;
        }
    }
    groups
}

/// Whether waves that scatter by the mean share of these bands can carry each of them.
fn scatters_alike(material: &Material, bands: &Range<usize>) -> bool {
    let scattering = &material.scattering;
    if bands
        .clone()
        .all(|band| scattering[band] == scattering[bands.start])
    {
        return true;
    }
    let share = mean_scattering(material, bands);
    let is_alike = |band: usize| {
        // The mean over both ways of the squared energies, (1 − s)² / (1 − p) + s² / p, is 1 and this.
        let growth = (scattering[band] - share).powi(2) / (share * (1.0 - share));
        reflections(&material.absorption, band) * growth.ln_1p() <= MOST_GROWTH.ln()
    };
    bands.clone().all(is_alike)
}

/// Reflections after which so little is left; infinitely many where all is reflected.
fn reflections(absorption: &Bands, band: usize) -> f64 {
    DECAYED.ln() / (-absorption[band]).ln_1p()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::WALL_COUNT;
    use crate::scene::shape::Room;
    use crate::{Listener, Source, Surface};
    use glam::Vec3;

    fn groups(materials: &[(f64, Bands)]) -> Vec<Range<usize>> {
        let size = Vec3::splat(9.0);
        let mut surfaces = Vec::new();
        let mut named = Vec::new();
        for (number, (absorption, scattering)) in materials.iter().enumerate() {
            let name = format!("m{number}");
            surfaces.push(Surface::new(Room { size }).with_material(&*name));
            let scattering = *scattering;
            let material = Material {
                scattering,
                ..Material::absorbing(*absorption)
            };
            named.push((name, material));
        }
        let (source, listener) = (Source::at(Vec3::ZERO), Listener::at(Vec3::X, 0.3));
        let mut scene = Scene::new("groups", surfaces, source, listener);
        scene.materials.extend(named);
        band_groups(&scene)
    }

    /// Protects bands from waves whose energies spread, and time from being spent where they do not.
    #[test]
    fn bands_that_scatter_alike_are_traced_together() {
        let rising: Bands = std::array::from_fn(|band| band as f64 / 7.0);
        let slightly = rising.map(|share| 0.4 + 0.02 * share);
        let stepped: Bands = std::array::from_fn(|band| if band < 3 { 0.1 } else { 0.6 });
        let low_alone: Bands = std::array::from_fn(|band| if band == 0 { 0.0 } else { 0.3 });
        let whole = |bands: Range<usize>| vec![bands];
        assert_eq!(groups(&[]), whole(0..8));
        assert_eq!(groups(&[(0.1, [0.3; BAND_COUNT])]), whole(0..8));
        assert_eq!(groups(&[(0.1, rising)]).len(), 8);
        // A material that absorbs everything scatters nothing, and one that absorbs little is met often.
        assert_eq!(groups(&[(1.0, rising)]), whole(0..8));
        assert_eq!(groups(&[(0.2, slightly)]), whole(0..8));
        assert!(groups(&[(0.0, slightly)]).len() > 1);
        assert_eq!(groups(&[(0.1, stepped)]), [0..3, 3..8]);
        // A material that no wave meets has no influence: here that of a room whose walls all have another.
        let mut scene = Scene::builtin("shoebox").expect("a built-in scene");
        let rising = Material {
            scattering: rising,
            ..Material::absorbing(0.1)
        };
        scene.materials.insert("rising".to_owned(), rising);
        scene
            .materials
            .insert("mirror".to_owned(), Material::MIRROR);
        scene.surfaces[0].material = Some("rising".to_owned());
        assert_eq!(band_groups(&scene).len(), 8);
        for wall in 0..WALL_COUNT {
            let room = scene.surfaces[0].clone();
            scene.surfaces[0] = room.with_wall_material(wall, "mirror").unwrap();
        }
        assert_eq!(band_groups(&scene), whole(0..8));
        assert_eq!(
            groups(&[(0.1, stepped), (0.1, low_alone)]),
            [0..1, 1..3, 3..8]
        );
    }
}
