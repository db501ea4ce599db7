//! The inner sphere: the same waves in a smaller sphere about the listener, as a check of the sphere of late arrivals.
//!
//! Where surfaces focus sound, the energy may vary within the sphere of late arrivals. The difference between the
//! figures of the two spheres shows this. The spread of the batches gives the noise of the difference. The square of the
//! difference less its variance estimates the square of the bias, which becomes part of the errors. If the differences
//! exceed their noise and the accepted bias in most bands, the sphere of late arrivals is rejected, and the inner
//! sphere takes its place.

use crate::bands::BAND_COUNT;
use crate::response::source_sound::Medium;
use crate::response::{Arrival, Differences, Echogram, Record};

/// The late arrivals of the same waves in both spheres.
#[derive(Clone, Debug)]
pub(in crate::response) struct Difference {
    pub wide: Echogram,
    pub inner: Echogram,
}

/// The sphere of late arrivals is rejected if the squares of a figure's differences exceed this multiple of their
/// variances, on the average over the bands: four standard deviations.
const MOST_TIMES_VARIANCE: f64 = 16.0;

/// Adds the part of an arrival that crosses the inner sphere.
pub(super) fn add(inner: &mut Echogram, medium: &Medium, arrival: &Arrival) {
    if arrival.inner > 0.0 {
        let within = Arrival {
            energy: arrival.energy.map(|energy| arrival.inner * energy),
            ..*arrival
        };
        medium.add(inner, &within);
    }
}

impl Difference {
    /// The differences of the figures if the late arrivals of the record are those of the inner sphere.
    pub fn of_figures(&self, record: &Record, direct_s: Option<f64>) -> Differences {
        let mut inner = record.echogram.clone();
        inner.add_scaled(&self.wide, &[-1.0; BAND_COUNT]);
        inner.add_scaled(&self.inner, &[1.0; BAND_COUNT]);
        Differences::between(
            record,
            &Record::new(record.taps, &inner, record.ends_s),
            direct_s,
        )
    }
}

/// Whether the sphere of late arrivals must not be used: the differences exceed their noise, and the accepted bias, a
/// share of decay times. Smaller differences only become part of the errors.
pub(in crate::response) fn are_biased(differences: &Differences, accepted_bias: f64) -> bool {
    differences.exceed(MOST_TIMES_VARIANCE, accepted_bias)
}
