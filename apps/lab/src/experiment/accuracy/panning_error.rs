//! Compares the panning of many frames with the panning of the exact geometry: biases, spread and efficiency. The times
//! of the same frames are also returned.
//!
//! # Theory
//! A frame's panning is a Monte Carlo estimate. Its mean square error relative to the limit of many waves is MSE =
//! (mean − limit)² + spread²; more waves reduce only the second term. (Over n frames, the spread is estimated with n −
//! 1 and the error is a plain mean, so spread² enters the error with the factor (n − 1) ÷ n.) The first term is the
//! square of the *limit bias*, which is known only to within spread ÷ √n. The *twin bias* is the difference from the
//! exact panning of the same start directions. It does not contain their randomness, and depends only on the tracing.
//! The *efficiency* of a setting is 1 ÷ (mean square error × time). The efficiency is independent of the number of
//! waves while the spread of independent directions dominates (Veach 1997, section 2.4.1). It falls with the number of
//! waves once bias dominates.

use super::report::{PanningError, Speed};
use super::sweep::Case;
use super::truth::Truth;
use crate::stats::{mean, median};
use echomarch::Error;
use echomarch::tracer::{Frame, Panning, Settings, Tracer};

/// The frames of one case, each with a different seed.
#[derive(Clone, Default)]
pub struct Frames {
    total_ms: Vec<f64>,
    march_ms: Vec<f64>,
    pans: Vec<f64>,
    exact_pans: Vec<f64>,
}

/// Runs cases with the same number of waves in turns, with one frame per seed, after one warm-up frame for each case.
/// Running in turns spreads disturbances of the machine equally over all cases.
///
/// # Errors
/// Errors of [`Tracer::frame`].
pub fn run_in_turns(
    tracer: &mut Tracer,
    truth: &Truth,
    cases: &[Case],
    seeds: u32,
    progress: &mut dyn FnMut(),
) -> Result<Vec<Frames>, Error> {
    for case in cases {
        tracer.frame(truth.scene, &case.settings)?;
    }
    let mut frames = vec![Frames::default(); cases.len()];
    for seed in 1..=seeds {
        for (case, frames) in cases.iter().zip(&mut frames) {
            let settings = case.settings.clone().with_seed(seed);
            frames.add(&tracer.frame(truth.scene, &settings)?);
        }
        progress();
    }
    Ok(frames)
}

/// Computes the exact panning of the same start directions for each of the first `seeds` frames.
///
/// # Errors
/// Errors of [`Tracer::frame`].
pub fn find_twins(
    tracer: &mut Tracer,
    truth: &mut Truth,
    cases: &[Case],
    seeds: u32,
    frames: &mut [Frames],
) -> Result<(), Error> {
    for (case, frames) in cases.iter().zip(frames) {
        let alike = cases
            .iter()
            .filter(|c| c.settings.directions == case.settings.directions);
        let most = alike.map(|c| c.settings.iterations).max().unwrap_or(1);
        for seed in 1..=seeds.min(frames.pans.len() as u32) {
            let settings = case.settings.clone().with_seed(seed);
            let pan = truth.pan_of_twins(tracer, &settings, most)?;
            frames.exact_pans.push(pan);
        }
    }
    Ok(())
}

impl Frames {
    fn add(&mut self, frame: &Frame) {
        self.total_ms.push(frame.milliseconds.total);
        self.march_ms.push(frame.milliseconds.march);
        self.pans.push(frame.panning.pan());
    }

    /// The median times.
    pub fn speed(&self, settings: &Settings) -> Speed {
        let total_ms = median(self.total_ms.iter().copied());
        let segments = f64::from(settings.waves) * f64::from(settings.iterations);
        Speed {
            total_ms,
            march_ms: median(self.march_ms.iter().copied()),
            million_per_second: segments / (1e3 * total_ms),
            evaluations_per_flight: 0.0,
            frames: self.total_ms.len() as u32,
        }
    }

    /// The panning over the seeds, compared with the limit.
    pub fn panning(&self, limit: f64) -> PanningError {
        let frames = self.pans.len().max(1) as f64;
        let mean_pan = mean(self.pans.iter().copied()).unwrap_or(0.0);
        let pairs = self.pans.iter().zip(&self.exact_pans);
        let differences: Vec<f64> = pairs.map(|(pan, exact)| pan - exact).collect();
        let twin_bias = mean(differences.iter().copied()).unwrap_or(0.0);
        let variance = self.mean_square(mean_pan);
        let mean_square = self.mean_square(limit);
        let seconds = 1e-3 * median(self.total_ms.iter().copied());
        PanningError {
            mean: mean_pan,
            limit_bias: mean_pan - limit,
            twin_bias,
            twin_seeds: differences.len() as u32,
            twin_bias_error: standard_error(&differences, twin_bias),
            spread: (variance * frames / (frames - 1.0).max(1.0)).sqrt(),
            rms: mean_square.sqrt(),
            efficiency: efficiency(mean_square, seconds),
            sum_error: None,
        }
    }

    /// Mean square error of the panning, relative to `limit`.
    pub fn mean_square(&self, limit: f64) -> f64 {
        mean(self.pans.iter().map(|pan| (pan - limit).powi(2))).unwrap_or(0.0)
    }
}

/// Standard error of the mean of these values; 0 for fewer than two.
fn standard_error(values: &[f64], mean_value: f64) -> f64 {
    let squares: f64 = values
        .iter()
        .map(|value| (value - mean_value).powi(2))
        .sum();
    let count = values.len() as f64;
    match values.len() {
        0 | 1 => 0.0,
        _ => (squares / (count - 1.0) / count).sqrt(),
    }
}

/// 1 ÷ (mean square error × seconds); 0 if the error or the time is 0 or missing.
fn efficiency(mean_square: f64, seconds: f64) -> f64 {
    let cost = mean_square * seconds;
    if cost > 0.0 { cost.recip() } else { 0.0 }
}

/// Relative difference between the sum of all arrivals on the GPU and on the CPU, from two frames with these settings.
///
/// # Errors
/// Errors of [`Tracer::frame`].
pub fn sum_error(tracer: &mut Tracer, truth: &Truth, settings: &Settings) -> Result<f64, Error> {
    let mut summed = |on_gpu| -> Result<Panning, Error> {
        let settings = settings.clone().with_sum_on_gpu(on_gpu);
        Ok(tracer.frame(truth.scene, &settings)?.panning)
    };
    let (cpu, gpu) = (summed(false)?, summed(true)?);
    let relative = |a: f64, b: f64| if b > 0.0 { (a - b).abs() / b } else { a.abs() };
    Ok(relative(gpu.left, cpu.left).max(relative(gpu.right, cpu.right)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the four errors of a panning value: they are not confused with each other.
    #[test]
    fn biases_spread_and_error_are_told_apart() {
        let frames = Frames {
            total_ms: vec![10.0; 2],
            march_ms: vec![5.0; 2],
            pans: vec![0.1, 0.3],
            exact_pans: vec![0.0, 0.2],
        };
        let error = frames.panning(0.2);
        assert!((error.twin_bias - 0.1).abs() < 1e-12);
        assert_eq!(error.twin_seeds, 2);
        assert!(error.twin_bias_error < 1e-12);
        assert!((standard_error(&[0.0, 2.0], 1.0) - 1.0).abs() < 1e-12);
        assert!(error.limit_bias.abs() < 1e-12);
        assert!((error.spread - 0.02f64.sqrt()).abs() < 1e-12);
        assert!((error.rms - 0.1).abs() < 1e-12);
        assert!((error.efficiency - 1e4).abs() < 1e-6);
        let error = frames.panning(0.15);
        assert!((error.limit_bias - 0.05).abs() < 1e-12);
        let square = error.limit_bias.powi(2) + error.spread.powi(2) / 2.0;
        assert!((error.rms.powi(2) - square).abs() < 1e-12);
        let speed = frames.speed(&Settings::thesis().with_waves(1000).with_iterations(10));
        assert!((speed.million_per_second - 1.0).abs() < 1e-12);
    }
}
