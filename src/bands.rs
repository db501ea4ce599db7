//! Octave bands of frequency.

/// How many octave bands there are.
pub const BAND_COUNT: usize = 8;

/// Their centres in hertz (ISO 266): those for which absorption is commonly published.
pub const BANDS_HZ: [f64; BAND_COUNT] = [63.0, 125.0, 250.0, 500.0, 1e3, 2e3, 4e3, 8e3];

/// A number for each octave band.
pub type Bands = [f64; BAND_COUNT];

/// Adds numbers, band by band.
pub(crate) fn add(sum: &mut Bands, more: &Bands) {
    for (sum, more) in sum.iter_mut().zip(more) {
        *sum += more;
    }
}

/// The mean over the bands, each with the same weight.
pub fn mean(bands: &Bands) -> f64 {
    bands.iter().sum::<f64>() / BAND_COUNT as f64
}

/// What the air leaves of energies on a way of `length_m` metres: exp(−`air_per_m` × length) of each
/// (ISO 9613-1 gives the attenuation in decibels: m = α ln 10 / 10).
pub(crate) fn through_air(energy: &Bands, air_per_m: &Bands, length_m: f64) -> Bands {
    // The factor is 1 without air, and a response has about a million arrivals.
    if *air_per_m == [0.0; BAND_COUNT] {
        return *energy;
    }
    std::array::from_fn(|band| energy[band] * (-air_per_m[band] * length_m).exp())
}
