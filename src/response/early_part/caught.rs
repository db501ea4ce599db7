//! Compares exact paths with the waves of these paths that hit the listener's sphere.
//!
//! Exact paths lead to the listener's centre, while waves give a mean over its sphere. The difference between the
//! figures of the paths and the figures of the paths' mean over the sphere (`sphere_mean.rs`) is part of the figures'
//! error. If a surface on a path focuses sound, the mean is taken from the waves, because the energy varies strongly
//! between points near a caustic. If the energy of the waves of all paths differs from the mean by more than three
//! standard deviations, the excess is also part of the error.
//!
//! The waves do not bend. If edges change the paths, the means and the waves are changed by the same factors, and the paths
//! around obstacles are part of all compared figures. The errors of these paths are part of the figures' error too.

use super::EarlyPart;
use crate::bands::{self, BAND_COUNT, Bands};
use crate::response::exact_paths::SpecularPath;
use crate::response::source_sound::{HeardPath, Medium, passing};
use crate::response::{Arrival, Echogram, Figures, Record, Tap};
use crate::scene::Pair;

/// Number of standard deviations of the waves' energy beyond which a difference counts.
const BEYOND_NOISE: f64 = 3.0;

/// The mean square of a sphere's chords over the square of their mean, for uniformly distributed chords.
const CHORD_SPREAD: f64 = 9.0 / 8.0;

/// The early part of a response: its exact paths, and the waves that the paths replace.
pub(in crate::response) struct Caught {
    pub part: EarlyPart,
    /// The sound along all exact paths, with the effect of edges near each path.
    paths: Vec<HeardPath>,
    /// The energy of each path, relative to that without edges, by band.
    changes: Vec<Bands>,
    /// The sound along the paths around and through obstacles.
    hidden: Vec<HeardPath>,
    /// For each surface, whether it focuses sound.
    gather: Vec<bool>,
    /// The paths' mean over the listener's sphere, without paths at foci and over surfaces that focus sound.
    means: Vec<Tap>,
}

impl Caught {
    /// `straight` are the exact paths of `part`, and `paths` the same paths with the effect of edges.
    pub fn new(
        (pair, medium): (Pair, &Medium),
        part: EarlyPart,
        (straight, paths): (&[HeardPath], Vec<HeardPath>),
        hidden: Vec<HeardPath>,
    ) -> Caught {
        let surfaces = pair.scene.surfaces.iter();
        let change = |(straight, bent): (&HeardPath, &HeardPath)| -> Bands {
            std::array::from_fn(|band| match straight.energy[band] > 0.0 {
                true => bent.energy[band] / straight.energy[band],
                false => 1.0,
            })
        };
        let mut caught = Caught {
            changes: straight.iter().zip(&paths).map(change).collect(),
            paths,
            hidden,
            part,
            gather: surfaces.map(|one| one.shape.gathers_sound()).collect(),
            means: Vec::new(),
        };
        let is_left_out = |path: &SpecularPath| caught.is_left_out(path);
        caught.means =
            caught
                .part
                .mean_taps(pair, medium, (&caught.paths, &caught.changes), &is_left_out);
        caught
    }

    /// The figures of the exact paths and the echogram. Their errors include the differences described at the top of
    /// this module. The record ends at `ends_s` seconds.
    pub fn in_errors(
        &self,
        (pair, medium): (Pair, &Medium),
        figures: Figures,
        (echogram, ends_s): (&Echogram, f64),
    ) -> Figures {
        let is_gathered = |path: &SpecularPath| self.is_gathered(path);
        let left_out = self.taps(&|path| self.is_left_out(path));
        let by_means = [&self.means[..], &left_out].concat();
        let mut figures =
            figures.with_differences(Record::new(&by_means, echogram, ends_s), &bands::ALL);
        let mut all = self.paths.iter().chain(&self.hidden);
        if all.any(|heard| heard.errors_db != [0.0; BAND_COUNT]) {
            let all = self.uncertain();
            figures = figures.with_differences(Record::new(&all, echogram, ends_s), &bands::ALL);
        }
        if self.gather.contains(&true) {
            let exact = self.taps(&|path| path.is_focus || !is_gathered(path));
            let of_waves = self.with_waves(medium, echogram, &|path| path.is_some_and(is_gathered));
            figures = figures.with_differences(Record::new(&exact, &of_waves, ends_s), &bands::ALL);
        }
        let excess = self.excess(pair, medium, ends_s);
        if excess == [0.0; BAND_COUNT] {
            return figures;
        }
        let is_other = |path: Option<&SpecularPath>| path.is_none_or(|path| !is_gathered(path));
        let of_waves = self.with_waves(medium, echogram, &is_other);
        figures.with_differences(Record::new(&left_out, &of_waves, ends_s), &excess)
    }

    /// Whether a surface on the path focuses sound.
    fn is_gathered(&self, path: &SpecularPath) -> bool {
        let mut surfaces = path.surfaces.iter();
        surfaces.any(|number| self.gather[*number as usize - 1])
    }

    /// Whether the mean over the sphere leaves the path out.
    fn is_left_out(&self, path: &SpecularPath) -> bool {
        path.is_focus || self.is_gathered(path)
    }

    /// The exact paths for which `is_taken` holds, and those around and through obstacles, as taps.
    fn taps(&self, is_taken: &dyn Fn(&SpecularPath) -> bool) -> Vec<Tap> {
        let taken = self.paths.iter().filter(|heard| is_taken(&heard.path));
        let all = taken.chain(&self.hidden);
        all.map(HeardPath::tap_of_energy).collect()
    }

    /// All paths as taps, those around obstacles or beside edges louder by one standard deviation of their errors: half of
    /// the half-width of the interval that contains 95 %.
    fn uncertain(&self) -> Vec<Tap> {
        let tap = |heard: &HeardPath| {
            let louder =
                |band: usize| heard.energy[band] * 10.0_f64.powf(0.05 * heard.errors_db[band]);
            Tap {
                energy: std::array::from_fn(louder),
                ..heard.tap_of_energy()
            }
        };
        self.paths.iter().chain(&self.hidden).map(tap).collect()
    }

    /// The waves that the paths replace, with the changes of the paths, and their paths.
    fn waves(&self) -> impl Iterator<Item = (Arrival, Option<&SpecularPath>)> {
        self.part.caught().map(|(arrival, path)| match path {
            Some(path) => {
                let changes = &self.changes[path];
                let energy = std::array::from_fn(|band| arrival.energy[band] * changes[band]);
                let changed = Arrival { energy, ..*arrival };
                (changed, Some(&self.paths[path].path))
            }
            None => (*arrival, None),
        })
    }

    /// The echogram plus the waves of the paths for which `is_taken` holds.
    fn with_waves(
        &self,
        medium: &Medium,
        echogram: &Echogram,
        is_taken: &dyn Fn(Option<&SpecularPath>) -> bool,
    ) -> Echogram {
        let mut with_waves = echogram.clone();
        for (arrival, _) in self.waves().filter(|(_, path)| is_taken(*path)) {
            medium.add(&mut with_waves, &arrival);
        }
        with_waves
    }

    /// The difference between the paths' mean energy and the energy of their waves, for arrivals before the record's
    /// end, without the paths that the mean leaves out. Returned is the share of the difference that exceeds the noise,
    /// in each band.
    fn excess(&self, pair: Pair, medium: &Medium, ends_s: f64) -> Bands {
        let is_left_out = |path: &SpecularPath| self.is_left_out(path);
        let heard = self.means.iter().filter(|mean| mean.seconds <= ends_s);
        let mut surplus = bands::sum(heard.map(|mean| &mean.energy));
        let is_compared = |arrival: &Arrival, path: Option<&SpecularPath>| {
            arrival.length_m / medium.speed <= ends_s && !path.is_some_and(is_left_out)
        };
        for (arrival, path) in self.waves() {
            if is_compared(&arrival, path) {
                let heard = medium.heard(&arrival);
                bands::add(&mut surplus, &heard.map(|energy| -energy));
            }
        }
        let mut variance = [0.0; BAND_COUNT];
        let radius_m = f64::from(pair.listener.radius);
        let compared = self.paths.iter().filter(|heard| heard.delay_s <= ends_s);
        for heard in compared.filter(|heard| !is_left_out(&heard.path)) {
            let with = (radius_m, self.part.waves());
            let passing = passing(pair.scene, self.part.groups(), &heard.path, with);
            let of_path = heard.energy.map(|e| CHORD_SPREAD * e * e / passing);
            bands::add(&mut variance, &of_path);
        }
        std::array::from_fn(|band| {
            let noise = BEYOND_NOISE * variance[band].sqrt();
            let beyond = surplus[band].abs() - noise;
            if beyond > 0.0 {
                beyond / surplus[band].abs()
            } else {
                0.0
            }
        })
    }
}
