//! What the listener's sphere catches of the sound whose exact paths are known.
//!
//! These lead to the listener's centre, and all else is a mean over its sphere. Where the two differ by more than the
//! noise of the waves, near a caustic of a curved mirror or where something hides a part of the sphere, the figures
//! hold for neither of them: what they would be by the waves is a part of their error then.

use super::Medium;
use super::early::{EarlyPart, HeardPath};
use crate::acoustics::{Echogram, Figures, Tap};
use crate::bands::{self, BAND_COUNT, Bands};
use crate::scene::{Scene, Surface};
use std::f64::consts::PI;

/// Standard deviations of what the waves bring beyond which a difference is none of noise.
const BEYOND_NOISE: f64 = 3.0;

/// The mean square of a chord of a sphere over the square of its mean, of chords that are spread evenly.
const CHORD_SPREAD: f64 = 9.0 / 8.0;

/// Terms of a series that converges where the source is not in the sphere.
const TERMS: u32 = 64;

/// The early part, as exact paths and as the waves that stand for them.
pub(super) struct Caught<'a> {
    pub scene: &'a Scene,
    pub medium: &'a Medium,
    pub part: &'a EarlyPart,
    pub paths: &'a [HeardPath],
    /// Waves that were traced.
    pub waves: u32,
}

impl Caught<'_> {
    /// The figures of the exact paths and the echogram of all else, with what they would be by the waves alone as an
    /// error, in the bands in which these bring other energy. The record ends after so many seconds.
    pub fn in_errors(&self, figures: Figures, echogram: &Echogram, ends_s: f64) -> Figures {
        let gathers = |surface: &Surface| surface.shape.gathers_sound();
        // Where sound is gathered each path differs, even where the sum of all does not.
        let differ = match self.scene.surfaces.iter().any(gathers) {
            true => [true; BAND_COUNT],
            false => self.differ(),
        };
        if !differ.contains(&true) {
            return figures;
        }
        let mut of_waves = echogram.clone();
        let caught = self.part.caught();
        caught.for_each(|arrival| self.medium.add(&mut of_waves, arrival));
        let foci = self.paths.iter().filter(|heard| heard.path.is_focus);
        let foci: Vec<Tap> = foci.map(HeardPath::tap).collect();
        figures.with_differences((&foci, &of_waves, ends_s), differ)
    }

    /// In which bands the exact paths bring other energy than the waves. Foci count as what their waves bring.
    fn differ(&self) -> [bool; BAND_COUNT] {
        let radius_m = f64::from(self.scene.listener.radius);
        let cross_section = PI * radius_m * radius_m;
        let mut surplus = [0.0; BAND_COUNT];
        let mut variance = [0.0; BAND_COUNT];
        for heard in self.paths.iter().filter(|heard| !heard.path.is_focus) {
            let mean = mean_over_sphere(radius_m / heard.path.length_m);
            bands::add(&mut surplus, &heard.energy.map(|energy| energy * mean));
            // Waves that pass on average, and what one of them brings.
            let passing = f64::from(self.waves) * cross_section * heard.path.spreading;
            let of_path = heard.energy.map(|e| CHORD_SPREAD * e * e / passing);
            bands::add(&mut variance, &of_path);
        }
        for arrival in self.part.caught() {
            let heard: Bands = self.medium.heard(arrival);
            bands::add(&mut surplus, &heard.map(|energy| -energy));
        }
        std::array::from_fn(|band| surplus[band].abs() > BEYOND_NOISE * variance[band].sqrt())
    }
}

/// The mean of 1/r² over a sphere of `share` of the distance of its centre, times the square of this.
fn mean_over_sphere(share: f64) -> f64 {
    if share >= 1.0 {
        return 1.0;
    }
    let term = |k: u32| 3.0 * share.powi(2 * k as i32) / f64::from((2 * k + 1) * (2 * k + 3));
    (0..TERMS).map(term).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects near sources from a difference that is none: the mean of 1/r² over a sphere, by sums over shells.
    #[test]
    fn the_mean_over_a_sphere_is_that_of_its_shells() {
        for share in [0.01, 0.3, 0.9] {
            let shells = 2000;
            // Over a shell of radius s about a place at distance 1 the mean is artanh(s)/s.
            let of_shell = |shell: u32| {
                let s = share * (f64::from(shell) + 0.5) / f64::from(shells);
                s * s * s.atanh() / s
            };
            let sum: f64 = (0..shells).map(of_shell).sum();
            let mean = sum * 3.0 / (share * share * f64::from(shells));
            assert!(
                (mean_over_sphere(share) / mean - 1.0).abs() < 1e-5,
                "{share}"
            );
        }
        assert_eq!(mean_over_sphere(2.0), 1.0);
    }
}
