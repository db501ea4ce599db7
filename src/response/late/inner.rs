//! The inner sphere: the same waves in a smaller sphere about the listener, as a check of the sphere of late arrivals.
//!
//! Where surfaces focus sound, the energy may vary within the sphere of late arrivals. The difference between the
//! figures of the two spheres shows this. The spread of the batches gives the noise of the difference. The square of the
//! difference less its variance estimates the square of the bias, which becomes part of the errors. If the differences
//! exceed their noise and the accepted bias in most bands, the sphere of late arrivals is rejected, and the arrivals in
//! the inner sphere take the place of the others. Their bias is the difference times
//! [`LateSphere::bias_of_difference`]; if this exceeds the accepted bias too, the waves are traced again through the
//! listener's own sphere.

use super::LateSphere;
use crate::bands::BAND_COUNT;
use crate::response::{Arrival, Differences, Echogram, Record};

/// The late arrivals of the same waves in both spheres.
#[derive(Clone, Debug)]
pub(in crate::response) struct Difference {
    /// The arrivals in the sphere of the figures.
    pub counted: Echogram,
    /// The arrivals in the other sphere.
    pub other: Echogram,
}

/// A sphere is rejected if the squares of a figure's differences exceed this multiple of their variances, on the average
/// over the bands: four standard deviations.
const MOST_TIMES_VARIANCE: f64 = 16.0;

/// The part of an arrival that crosses the inner sphere; `None` if it misses it.
pub(super) fn within(arrival: &Arrival) -> Option<Arrival> {
    (arrival.inner > 0.0).then(|| Arrival {
        energy: arrival.energy.map(|energy| arrival.inner * energy),
        ..*arrival
    })
}

impl Difference {
    /// The bias of the figures of a record in this sphere, from the differences of the figures if the late arrivals are
    /// those in the other sphere.
    pub fn bias(&self, late: &LateSphere, record: &Record, direct_s: Option<f64>) -> Differences {
        let mut other = record.echogram.clone();
        other.add_scaled(&self.counted, &[-1.0; BAND_COUNT]);
        other.add_scaled(&self.other, &[1.0; BAND_COUNT]);
        let other = Record::new(record.taps, &other, record.ends_s);
        Differences::between(record, &other, direct_s).scaled(late.bias_of_difference())
    }
}

/// Whether the arrivals in a sphere must not be used: the bias of its figures exceeds its noise and the accepted bias, a
/// share of decay times. A smaller bias only becomes part of the errors.
pub(in crate::response) fn are_biased(bias: &Differences, accepted_bias: f64) -> bool {
    bias.exceed(MOST_TIMES_VARIANCE, accepted_bias)
}
