//! What the listener's sphere catches of the sound whose exact paths are known.
//!
//! These lead to the listener's centre, and all else is a mean over its sphere. Where the two differ by more than the
//! noise of the waves, near a caustic of a curved mirror or where something hides a part of the sphere, the figures
//! hold for neither of them: what they would be by the waves is a part of their error then.

use super::early::{EarlyPart, HeardPath, passing};
use super::late_sphere::casts_shadows;
use super::medium::Medium;
use crate::acoustics::early::SpecularPath;
use crate::acoustics::{Arrival, Echogram, Figures, Tap};
use crate::bands::{self, BAND_COUNT};
use crate::scene::Scene;

/// Standard deviations of what the waves bring beyond which a difference counts.
const BEYOND_NOISE: f64 = 3.0;

/// The same where something may hide a part of the sphere: there a difference is likely, and some noise is better than an
/// error that is too small.
const BEYOND_NOISE_IN_SHADOWS: f64 = 1.0;

/// The mean square of a chord of a sphere over the square of its mean, of chords that are spread evenly.
const CHORD_SPREAD: f64 = 9.0 / 8.0;

/// The early part of a response: its exact paths, and the waves that they replace.
pub(super) struct Caught<'a> {
    pub scene: &'a Scene,
    pub medium: &'a Medium,
    pub part: &'a EarlyPart,
    pub paths: &'a [HeardPath],
    /// Waves that were traced.
    pub waves: u32,
}

/// Which of the exact paths are compared with their waves.
#[derive(Clone, Copy, PartialEq)]
enum Compared {
    All,
    /// Those over surfaces that gather sound.
    Gathered,
}

impl Caught<'_> {
    /// The figures of the exact paths and the echogram of all else, with what they would be by the waves of the paths as
    /// an error: of paths over surfaces that gather sound, and of all in the bands in which they bring other energy. The
    /// record ends after so many seconds.
    pub fn in_errors(&self, figures: Figures, echogram: &Echogram, ends_s: f64) -> Figures {
        let differ = self.differ();
        let gather = self.gathering_surfaces();
        let (compared, in_bands) = match (differ.contains(&true), gather.contains(&true)) {
            (true, gathers) => (Compared::All, differ.map(|differs| differs || gathers)),
            (false, true) => (Compared::Gathered, [true; BAND_COUNT]),
            (false, false) => return figures,
        };
        let is_gathered =
            |path: &SpecularPath| path.surfaces.iter().any(|n| gather[*n as usize - 1]);
        let is_compared = |path: Option<&SpecularPath>| match compared {
            Compared::All => true,
            Compared::Gathered => path.is_some_and(is_gathered),
        };
        let mut of_waves = echogram.clone();
        for (arrival, path) in self.part.caught().filter(|(_, path)| is_compared(*path)) {
            self.medium
                .add(&mut of_waves, &self.at_centre(arrival, path));
        }
        let is_exact = |path: &SpecularPath| path.is_focus || !is_compared(Some(path));
        let exact = self.paths.iter().filter(|heard| is_exact(&heard.path));
        let exact: Vec<Tap> = exact.map(HeardPath::tap).collect();
        figures.with_differences((&exact, &of_waves, ends_s), in_bands)
    }

    /// For each surface whether it gathers sound.
    fn gathering_surfaces(&self) -> Vec<bool> {
        let surfaces = self.scene.surfaces.iter();
        surfaces
            .map(|surface| surface.shape.gathers_sound())
            .collect()
    }

    /// In which bands the exact paths bring other energy than the waves. Foci count as what their waves bring.
    fn differ(&self) -> [bool; BAND_COUNT] {
        let mut surplus = [0.0; BAND_COUNT];
        let mut variance = [0.0; BAND_COUNT];
        for heard in self.paths.iter().filter(|heard| !heard.path.is_focus) {
            bands::add(&mut surplus, &heard.energy);
            let passing = passing(self.scene, &heard.path, self.radius_m(), self.waves);
            let of_path = heard.energy.map(|e| CHORD_SPREAD * e * e / passing);
            bands::add(&mut variance, &of_path);
        }
        for (arrival, path) in self.part.caught() {
            let heard = self.medium.heard(&self.at_centre(arrival, path));
            bands::add(&mut surplus, &heard.map(|energy| -energy));
        }
        let beyond = match casts_shadows(self.scene) {
            true => BEYOND_NOISE_IN_SHADOWS,
            false => BEYOND_NOISE,
        };
        std::array::from_fn(|band| surplus[band].abs() > beyond * variance[band].sqrt())
    }

    /// An arrival of this path with what it would bring to the listener's centre, if nothing hides a part of the sphere.
    fn at_centre(&self, arrival: &Arrival, path: Option<&SpecularPath>) -> Arrival {
        let length_m = path.map_or(arrival.length_m, |path| path.length_m);
        let mean = mean_over_sphere(self.radius_m() / length_m);
        Arrival {
            energy: arrival.energy.map(|energy| energy / mean),
            ..*arrival
        }
    }

    fn radius_m(&self) -> f64 {
        f64::from(self.scene.listener.radius)
    }
}

/// The mean of 1/r² over a sphere of `share` of the distance of its centre, times the square of this.
fn mean_over_sphere(share: f64) -> f64 {
    /// Below it the first two terms of the series in `share` are the mean, and the logarithm loses digits.
    const SMALL: f64 = 1e-3;
    let square = share * share;
    if share < SMALL {
        return 1.0 + square / 5.0;
    }
    let outside = match share == 1.0 {
        true => 0.0,
        false => (square - 1.0) / (2.0 * share) * ((share + 1.0) / (share - 1.0).abs()).ln(),
    };
    1.5 / square * (1.0 + outside)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects near sources from a difference that is none: the mean of 1/r² over a sphere, by sums over shells.
    #[test]
    fn the_mean_over_a_sphere_is_that_of_its_shells() {
        for share in [1e-4, 0.01, 0.3, 0.9, 1.5, 3.0] {
            let shells = 200_000;
            // Over a shell of radius s about a place at distance 1 the mean is ln((1 + s)/|1 − s|)/2s.
            let of_shell = |shell: u32| {
                let s = share * (f64::from(shell) + 0.5) / f64::from(shells);
                s * 0.5 * ((1.0 + s) / (1.0 - s).abs()).ln()
            };
            let sum: f64 = (0..shells).map(of_shell).sum();
            let mean = sum * 3.0 / (share * share * f64::from(shells));
            let found = mean_over_sphere(share);
            assert!(
                (found / mean - 1.0).abs() < 1e-4,
                "{share}: {found}, {mean}"
            );
        }
        assert_eq!(mean_over_sphere(1.0), 1.5);
    }
}
