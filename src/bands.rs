//! Octave bands of frequency.

/// Number of octave bands.
pub const BAND_COUNT: usize = 8;

/// Centre frequencies in hertz (ISO 266), for which absorption is commonly published.
pub const BANDS_HZ: [f64; BAND_COUNT] = [63.0, 125.0, 250.0, 500.0, 1e3, 2e3, 4e3, 8e3];

/// One number per octave band.
pub type Bands = [f64; BAND_COUNT];

/// One number for all octave bands, or one number for each.
pub trait PerBand {
    /// The number of each band.
    fn per_band(self) -> Bands;
}

impl PerBand for f64 {
    fn per_band(self) -> Bands {
        [self; BAND_COUNT]
    }
}

impl PerBand for f32 {
    fn per_band(self) -> Bands {
        f64::from(self).per_band()
    }
}

impl PerBand for Bands {
    fn per_band(self) -> Bands {
        self
    }
}

impl PerBand for [f32; BAND_COUNT] {
    fn per_band(self) -> Bands {
        self.map(f64::from)
    }
}

/// The weight 1 in each band.
pub(crate) const ALL: Bands = [1.0; BAND_COUNT];

/// Adds `more` to `sum`, band by band.
#[doc(hidden)]
pub fn add(sum: &mut Bands, more: &Bands) {
    for (sum, more) in sum.iter_mut().zip(more) {
        *sum += more;
    }
}

/// The sum of numbers, band by band.
pub(crate) fn sum<'a>(all: impl IntoIterator<Item = &'a Bands>) -> Bands {
    let mut sum = [0.0; BAND_COUNT];
    all.into_iter().for_each(|bands| add(&mut sum, bands));
    sum
}

/// The greater value of each band.
pub(crate) fn greater(a: Bands, b: Bands) -> Bands {
    std::array::from_fn(|band| a[band].max(b[band]))
}

/// The mean over the bands, each with the same weight.
#[doc(hidden)]
pub fn mean(bands: &Bands) -> f64 {
    bands.iter().sum::<f64>() / BAND_COUNT as f64
}

/// Energies after `length_m` metres of air: each is multiplied by exp(−`air_per_m` × length) (ISO 9613-1 gives the
/// attenuation in decibels: m = α ln 10 / 10).
pub(crate) fn through_air(energy: &Bands, air_per_m: &Bands, length_m: f64) -> Bands {
    // Without attenuation the factor is 1. A response has about a million arrivals, so skipping the exponentials saves
    // time.
    if *air_per_m == [0.0; BAND_COUNT] {
        return *energy;
    }
    std::array::from_fn(|band| match energy[band] {
        // Other waves carry this band.
        0.0 => 0.0,
        energy => energy * (-air_per_m[band] * length_m).exp(),
    })
}
