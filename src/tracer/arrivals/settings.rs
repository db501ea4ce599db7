//! Settings of arrivals, the waves to follow and their starts, and counts.

use super::super::TraceError;
use super::super::settings::Settings;
use super::{ITERATIONS_IN_CHUNK, RECORDS};
use crate::bands::{self, BAND_COUNT, Bands};
use glam::Vec3;
use std::ops::Range;

/// Settings of arrivals in addition to [`Settings`](crate::Settings). From the latter, the waves, their directions and
/// the algorithm are used.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ArrivalSettings {
    /// Time in seconds: waves are followed until they have flown the distance that sound travels in
    /// this time.
    pub seconds: f64,
    /// Maximum reflections of an early arrival: 3 by default.
    pub early_order: u32,
    /// Maximum iterations of a wave, 1 … [`Settings::MAX_ITERATIONS`]; the upper limit by default. A wave ends after
    /// this number even if it has not flown for the whole time.
    pub iterations: u32,
    /// Numbers of the octave bands that are traced: all by default. The energies of the other bands are 0.
    pub(crate) bands: Range<usize>,
    /// The waves of a block are followed while together they have more than this share of their initial energy in at
    /// least one band. The share is 0 by default.
    pub(crate) least_energy: f64,
    /// Maximum iterations in a chunk.
    pub(crate) iterations_in_chunk: u32,
    /// Whether waves are replaced by waves of about equal energy where surfaces scatter. The fates of single waves then
    /// have no meaning.
    pub(crate) resamples: bool,
    /// Maximum recorded crossings of a wave in a pass.
    pub(crate) records: u32,
    /// Maximum outputs of a pass, within the driver's limit.
    pub(crate) outputs: u32,
}

impl ArrivalSettings {
    /// The defaults for this time in seconds.
    pub fn new(seconds: f64) -> ArrivalSettings {
        ArrivalSettings {
            seconds,
            early_order: 3,
            iterations: Settings::MAX_ITERATIONS,
            bands: 0..BAND_COUNT,
            least_energy: 0.0,
            iterations_in_chunk: ITERATIONS_IN_CHUNK,
            resamples: false,
            records: RECORDS,
            outputs: u32::MAX,
        }
    }

    setters! {
        /// Sets the maximum reflections of an early arrival.
        pub fn with_early_order(order: u32) => early_order;

        /// Sets the limit of iterations.
        pub fn with_iterations(iterations: u32) => iterations;

        /// Sets the bands that the waves carry.
        pub(crate) fn with_bands(bands: Range<usize>) => bands;

        /// Sets the share of their initial energy at which waves are no longer followed.
        pub(crate) fn with_least_energy(share: f64) => least_energy;
    }

    /// Checks every number against its range.
    ///
    /// # Errors
    /// [`TraceError::BadSetting`] with the name, the range and the value.
    pub fn validate(&self) -> Result<(), TraceError> {
        let bad =
            |what, must: String, value: String| Err(TraceError::BadSetting { what, must, value });
        if !(self.seconds > 0.0 && self.seconds <= MOST_SECONDS) {
            let must = format!("greater than 0 and at most {MOST_SECONDS}");
            return bad(
                "time of arrivals in seconds",
                must,
                self.seconds.to_string(),
            );
        }
        if !(1..=Settings::MAX_ITERATIONS).contains(&self.iterations) {
            let must = format!("1 to {}", Settings::MAX_ITERATIONS);
            return bad("iterations of arrivals", must, self.iterations.to_string());
        }
        Ok(())
    }
}

/// The longest time that may be requested, in seconds: longer than any room reverberates.
const MOST_SECONDS: f64 = 1000.0;

/// The waves whose arrivals are traced.
pub(crate) enum WavesToFollow<'a> {
    /// The waves with these numbers, in the directions that the settings determine. Each wave carries 1/N of the
    /// energy, where N is the number of waves in the settings.
    Numbers(Range<u32>),
    /// Waves numbered from 0. A function returns the starts of a range of numbers.
    Starts {
        /// Number of waves.
        waves: u32,
        /// Returns the starts of the waves with these numbers. The number of waves in the settings is ignored.
        of: &'a dyn Fn(Range<u32>) -> Vec<Start>,
    },
}

/// The start of a wave at the source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Start {
    /// Direction of the wave: a unit vector in world axes.
    pub direction: Vec3,
    /// Importance weight: the density of uniform directions divided by the density with which this direction was drawn.
    /// The mean of all weights is 1, unless all have a common factor.
    pub weight: f32,
}

impl WavesToFollow<'_> {
    /// Number of the first wave.
    pub(in crate::tracer) fn first(&self) -> u32 {
        match self {
            WavesToFollow::Numbers(numbers) => numbers.start,
            WavesToFollow::Starts { .. } => 0,
        }
    }

    /// The numbers of the waves.
    fn numbers(&self) -> Range<u32> {
        match self {
            WavesToFollow::Numbers(numbers) => numbers.clone(),
            WavesToFollow::Starts { waves, .. } => 0..*waves,
        }
    }

    /// Number of waves.
    pub(in crate::tracer) fn count(&self) -> u32 {
        self.numbers().len() as u32
    }

    /// The numbers of the waves, divided into blocks of `waves` numbers.
    pub(in crate::tracer) fn blocks(&self, waves: u32) -> impl Iterator<Item = Range<u32>> {
        let Range { start, end } = self.numbers();
        let first = (start..end).step_by(waves as usize);
        first.map(move |first| first..first.saturating_add(waves).min(end))
    }

    /// The starts of these waves; `None` if the settings determine them.
    pub(in crate::tracer) fn starts(&self, numbers: &Range<u32>) -> Option<Vec<Start>> {
        match self {
            WavesToFollow::Numbers(_) => None,
            WavesToFollow::Starts { of, .. } => Some(of(numbers.clone())),
        }
    }
}

/// The fates of the waves whose arrivals were traced.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
#[non_exhaustive]
pub struct ArrivalCounts {
    /// Number of followed waves. If bands scatter differently, the waves of all groups of bands are added.
    pub waves: u64,
    /// Number of returned arrivals.
    pub arrivals: u64,
    /// Waves that hit no further surface, or never started because the source is in a solid.
    pub gone: u64,
    /// Waves that were given up because a march reached the step limit.
    pub step_limit_reached: u64,
    /// Waves that flew the requested distance. In a response, also waves whose energy became inaudible.
    pub flown: u64,
    /// Waves that were cut off after [`ArrivalSettings::iterations`].
    pub cut_off: u64,
    /// Distance from the source in metres within which at most one in a thousand waves was cut off. It is ∞, serialised
    /// as nothing, if at most one in a thousand waves was cut off in total.
    #[serde(with = "crate::serialised::infinite")]
    pub followed_m: f64,
    /// Maximum number of traced iterations over all blocks of waves.
    pub iterations: u32,
    /// Remaining energy of the waves that were cut off, by band, as a share of the source's energy.
    pub energy_under_way: Bands,
    /// Volume of the listener's sphere that is not in a solid, in m³. If several listeners share the waves, the volume
    /// of the first.
    pub open_volume_m3: f64,
}

impl ArrivalCounts {
    /// Counts without waves.
    pub(crate) fn of_none() -> ArrivalCounts {
        ArrivalCounts {
            followed_m: f64::INFINITY,
            ..ArrivalCounts::default()
        }
    }

    /// Adds the counts of other bands, or of other waves, with the same listener.
    pub(crate) fn and(mut self, others: ArrivalCounts) -> ArrivalCounts {
        self.waves += others.waves;
        self.arrivals += others.arrivals;
        self.gone += others.gone;
        self.step_limit_reached += others.step_limit_reached;
        self.flown += others.flown;
        self.cut_off += others.cut_off;
        self.followed_m = self.followed_m.min(others.followed_m);
        self.iterations = self.iterations.max(others.iterations);
        bands::add(&mut self.energy_under_way, &others.energy_under_way);
        self.open_volume_m3 = others.open_volume_m3;
        self
    }
}

/// The fates of a subset of the waves.
#[derive(Clone, Default)]
pub(crate) struct Followed {
    /// Counts, without [`followed_m`](ArrivalCounts::followed_m).
    pub counts: ArrivalCounts,
    /// Distances in metres that the cut-off waves had flown.
    pub cut_off_m: Vec<f64>,
}

/// One wave in this number may be cut off without a report. Beyond the distance at which these waves ended, at most a
/// thousandth of the energy is then missing (three thousandths with importance weights of up to 2.9).
const CUT_OFF_UNTOLD: usize = 1000;

impl Followed {
    /// Adds other waves with the same settings, of any number.
    pub fn and(mut self, mut others: Followed) -> Followed {
        // The energies are means over the waves.
        let all = (self.counts.waves + others.counts.waves).max(1) as f64;
        for counts in [&mut self.counts, &mut others.counts] {
            let share = counts.waves as f64 / all;
            counts.energy_under_way = counts.energy_under_way.map(|energy| energy * share);
        }
        self.counts = self.counts.and(others.counts);
        self.cut_off_m.extend(others.cut_off_m);
        self
    }

    /// Completes the counts.
    pub fn counts(mut self) -> ArrivalCounts {
        self.cut_off_m.sort_by(f64::total_cmp);
        let next = self
            .cut_off_m
            .get(self.counts.waves as usize / CUT_OFF_UNTOLD);
        self.counts.followed_m = next.copied().unwrap_or(f64::INFINITY);
        self.counts
    }
}
