//! The bands, ears and steps of rendering, and the fit of four gains to the eight of a way.

use crate::bands::{BAND_COUNT, BANDS_HZ, Bands};
use num_complex::Complex64;
use std::f64::consts::PI;

/// Left and right.
pub(super) const EARS: usize = 2;

/// Number of samples that are rendered in one step.
pub(super) const CHUNK: usize = 128;

/// Number of bands of a delay line.
pub(super) const BANDS: usize = 4;

/// One sample, or one gain, for each band.
pub(super) type Frame = [f32; BANDS];

/// Edges in hertz between the bands.
const EDGES_HZ: [f64; BANDS - 1] = [177.0, 707.0, 2828.0];

/// Steps of the fit of four gains to eight.
const STEPS: usize = 6;

/// The pole of the filter at each edge, as the share of a step that it takes in one sample.
pub(super) fn poles(rate_hz: f64) -> [f64; BANDS - 1] {
    EDGES_HZ.map(|edge| 1.0 - (-2.0 * PI * (edge / rate_hz).min(0.45)).exp())
}

/// The response of each band at a frequency.
fn responses(hertz: f64, rate_hz: f64) -> [Complex64; BANDS] {
    let late = Complex64::from_polar(1.0, -2.0 * PI * hertz / rate_hz);
    let lows = poles(rate_hz).map(|pole| pole / (1.0 - (1.0 - pole) * late));
    let one = Complex64::new(1.0, 0.0);
    [lows[0], lows[1] - lows[0], lows[2] - lows[1], one - lows[2]]
}

/// The fit of four gains to eight, at a sampling rate.
#[derive(Clone, Debug)]
pub(super) struct Fit {
    responses: [[Complex64; BANDS]; BAND_COUNT],
}

impl Fit {
    pub fn new(rate_hz: u32) -> Fit {
        let rate = f64::from(rate_hz);
        Fit {
            responses: BANDS_HZ.map(|hertz| responses(hertz.min(0.45 * rate), rate)),
        }
    }

    /// The gains of the four bands whose sum has these amplitudes at the centres of the octaves, as nearly as possible.
    pub fn gains(&self, wanted: &Bands) -> Frame {
        let pair = |band: usize| [wanted[2 * band], wanted[2 * band + 1]];
        let mean = |[a, b]: [f64; 2]| (0.5 * (a * a + b * b)).sqrt();
        let mut gains: [f64; BANDS] = std::array::from_fn(|band| mean(pair(band)));
        for _ in 0..STEPS {
            let found: Bands = std::array::from_fn(|octave| {
                let products = self.responses[octave].iter().zip(&gains);
                products
                    .map(|(response, gain)| response * gain)
                    .sum::<Complex64>()
                    .norm()
            });
            for (band, gain) in gains.iter_mut().enumerate() {
                let has = mean([found[2 * band], found[2 * band + 1]]);
                if has > 0.0 {
                    *gain *= (mean(pair(band)) / has).clamp(0.5, 2.0);
                }
            }
        }
        gains.map(|gain| gain as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE_HZ: u32 = 48_000;

    /// Protects the colour of walls and air: four fitted gains reproduce eight amplitudes to 1.5 dB.
    #[test]
    fn four_gains_stand_for_eight() {
        let fit = Fit::new(RATE_HZ);
        let cases: [Bands; 4] = [
            [1.0; BAND_COUNT],
            [1.0, 0.95, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4],
            [0.9, 0.8, 0.7, 0.5, 0.4, 0.35, 0.3, 0.3],
            [0.3, 0.4, 0.5, 0.6, 0.7, 0.7, 0.7, 0.7],
        ];
        for wanted in cases {
            let gains = fit.gains(&wanted);
            for (octave, wanted) in wanted.iter().enumerate() {
                let products = fit.responses[octave].iter().zip(gains);
                let found = products.map(|(response, gain)| response * f64::from(gain));
                let off = 20.0 * (found.sum::<Complex64>().norm() / wanted).log10();
                assert!(off.abs() < 1.5, "{octave}: {off} dB");
            }
        }
    }
}
