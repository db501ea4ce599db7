//! Octave bands of frequency.

/// How many octave bands there are.
pub const BAND_COUNT: usize = 8;

/// Their centres in hertz (ISO 266): those for which absorption is commonly published.
pub const BANDS_HZ: [f64; BAND_COUNT] = [63.0, 125.0, 250.0, 500.0, 1e3, 2e3, 4e3, 8e3];

/// A number for each octave band.
pub type Bands = [f64; BAND_COUNT];
