//! Checks the measurements of a set.

use super::{
    HRIR_RATES_HZ, HrirError, LONGEST_DELAY_S, LOUDEST, MAX_DIRECTIONS, MAX_SAMPLES, MAX_VALUES,
    MeasuredHrir,
};

/// The number of samples of each response, if all numbers are in range.
pub(super) fn check(rate_hz: u32, measured: &[MeasuredHrir]) -> Result<usize, HrirError> {
    if !HRIR_RATES_HZ.contains(&rate_hz) {
        return Err(HrirError::BadRate { rate_hz });
    }
    let samples = measured.first().map_or(0, |first| first.ears[0].len());
    sizes(measured.len(), samples)?;
    for (index, measured) in measured.iter().enumerate() {
        one(index, measured, samples)?;
    }
    Ok(samples)
}

/// Rejects sets that are too large.
pub(super) fn sizes(directions: usize, samples: usize) -> Result<(), HrirError> {
    if !(1..=MAX_DIRECTIONS).contains(&directions) {
        return Err(HrirError::BadCount { count: directions });
    }
    if !(1..=MAX_SAMPLES).contains(&samples) {
        return Err(HrirError::BadLength { samples });
    }
    let values = 2 * directions as u64 * samples as u64;
    if values > MAX_VALUES {
        return Err(HrirError::TooLarge { values });
    }
    Ok(())
}

fn one(index: usize, measured: &MeasuredHrir, expected: usize) -> Result<(), HrirError> {
    let from = measured.from;
    if !from.is_finite() || from.try_normalize().is_none() {
        return Err(HrirError::BadDirection { index, from });
    }
    for ear in &measured.ears {
        let samples = ear.len();
        if samples != expected {
            return Err(HrirError::UnevenLength {
                index,
                samples,
                expected,
            });
        }
        let is_good = |sample: &f32| sample.is_finite() && sample.abs() <= LOUDEST;
        if let Some(value) = ear.iter().find(|sample| !is_good(sample)) {
            return Err(HrirError::BadSample {
                index,
                value: *value,
            });
        }
    }
    let is_good = |seconds: &f64| seconds.abs() <= LONGEST_DELAY_S;
    match measured.delays_s.into_iter().find(|delay| !is_good(delay)) {
        Some(seconds) => Err(HrirError::BadDelay { index, seconds }),
        None => Ok(()),
    }
}
