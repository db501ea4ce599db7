//! Measures of samples.
#![allow(dead_code)] // Each test program uses only some of these.

/// The largest difference between a sample and the next.
pub fn largest_step(samples: &[f32]) -> f32 {
    samples
        .windows(2)
        .fold(0.0, |most, pair| most.max((pair[1] - pair[0]).abs()))
}

/// The root mean square.
pub fn rms(samples: &[f32]) -> f64 {
    let squares: f64 = samples.iter().map(|&s| f64::from(s).powi(2)).sum();
    (squares / samples.len() as f64).sqrt()
}
