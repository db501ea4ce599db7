//! Splits a signal into its octave bands by zero-phase filters: scaling each band separately has
//! the same effect as [`ImpulseResponse`](crate::acoustics::ImpulseResponse) has on a tap.

use super::convolution::{BLOCK, Kernel};
use crate::acoustics::tap_filter_gain;
use crate::bands::BAND_COUNT;
use realfft::RealFftPlanner;
use std::f64::consts::PI;

/// Delay of the split signal in samples: the filters reach this far to both sides (21 ms at 48 kHz). If 63 Hz and 125
/// Hz differ by 20 dB they would have to reach further: the weaker of the two is then up to 0.7 dB off. From 250 Hz on
/// the error is 0.05 dB.
pub(super) const DELAY: usize = 2 * BLOCK;

/// The share of this reach in which the filters are not tapered.
const FLAT: f64 = 0.75;

const LENGTH: usize = 2 * DELAY;

/// Partitions of the filters.
pub(super) const PARTITIONS: usize = LENGTH / BLOCK;

/// The filters of all bands, one channel each.
pub(super) fn filters(rate_hz: u32) -> Kernel {
    let filters: Vec<Vec<f32>> = (0..BAND_COUNT)
        .map(|band| filter(band, rate_hz.into()))
        .collect();
    Kernel::new(&filters)
}

/// The filter of a band: its zero-phase response, delayed, cut and windowed.
fn filter(band: usize, rate_hz: f64) -> Vec<f32> {
    // Long enough to keep the cut-off part from folding in.
    let length = 8 * LENGTH;
    let inverse = RealFftPlanner::<f64>::new().plan_fft_inverse(length);
    let mut spectrum = inverse.make_input_vec();
    for (bin, value) in spectrum.iter_mut().enumerate() {
        *value = tap_filter_gain(band, bin as f64 * rate_hz / length as f64).into();
    }
    let mut samples = inverse.make_output_vec();
    let done = inverse.process(&mut spectrum, &mut samples);
    debug_assert!(done.is_ok(), "the spectrum is that of a real signal");
    let sample = |index: usize| {
        let offset = index as f64 - DELAY as f64;
        let from_zero = (index + length - DELAY) % length;
        let beyond = (offset.abs() / DELAY as f64 - FLAT).max(0.0) / (1.0 - FLAT);
        let fade = 0.5 + 0.5 * (PI * beyond).cos();
        (samples[from_zero] / length as f64 * fade) as f32
    };
    (0..LENGTH).map(sample).collect()
}
