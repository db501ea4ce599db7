//! The onset: the first part of a record, which may be traced with more waves than the rest.
//!
//! Where surfaces scatter, waves are resampled, and their number stays the same along the whole decay. A few thousand
//! waves then determine T20 and T30. EDT and the energy ratios depend on the first part of the record, where single
//! arrivals are strong, and take more waves. Waves that end after the onset take a fraction of the time.
//!
//! The bins of the onset hold the mean over all waves, the later bins the mean over the waves that are followed to the
//! end (`tally.rs`). A wave has the same batch in both parts, so that the spread of the batches contains the noise of
//! both.

use super::Heard;
use crate::scene::Pair;
use crate::shader::Materials;
use crate::tracer::{self, ArrivalSettings, Directions};
use std::ops::Range;

/// The waves of the onset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::response) struct Onset {
    /// Number of waves that are followed through the onset, including the late waves, which are followed to the record's
    /// end.
    pub waves: u32,
    /// Length of the onset after the direct sound, in seconds.
    pub seconds: f64,
}

/// The least length of an onset in seconds: the limit of C80.
const LEAST_S: f64 = 0.08;

/// The greatest share of the record for which an onset is traced separately. A longer one saves little time.
const MOST: f64 = 0.5;

impl Onset {
    /// Share of the record that the onset takes. EDT is measured over 10 dB, a sixth of the 60 dB that a record contains.
    pub const SHARE: f64 = 1.0 / 6.0;

    /// Length in seconds of the onset of a record of `seconds`, and its share of the record. `None` if the pair cannot
    /// have an onset with more waves: its waves must scatter in all bands, or else pilot waves may decide about their starts;
    /// and the source must radiate evenly, or else its directivity decides.
    pub fn of_record(
        pair: Pair,
        directions: Directions,
        direct_s: f64,
        seconds: f64,
    ) -> Option<(f64, f64)> {
        let scatters = |bands: &Range<usize>| Materials::of(pair.scene, bands.clone()).scatter();
        let starts_evenly = pair.source.directivity.is_omnidirectional()
            && directions == Directions::Random
            && tracer::resampled_band_groups(pair.scene)
                .iter()
                .all(scatters);
        let length_s = (Onset::SHARE * seconds).max(LEAST_S);
        let share = (direct_s + length_s) / seconds;
        (starts_evenly && share <= MOST).then_some((length_s, share))
    }

    /// The settings of arrivals that end after the onset of all listeners.
    pub(super) fn settings(&self, heard: &[Heard], how: &ArrivalSettings) -> ArrivalSettings {
        // A wave crosses the near side of the sphere before the time of its arrival, and the far side after it.
        let ends_s = |one: &Heard| {
            let sphere_s = f64::from(one.late.radius_m) / one.medium.speed;
            one.medium.direct_s + self.seconds + sphere_s
        };
        let latest_s = heard.iter().map(ends_s).fold(0.0, f64::max);
        ArrivalSettings {
            seconds: latest_s.min(how.seconds),
            ..how.clone()
        }
    }
}
