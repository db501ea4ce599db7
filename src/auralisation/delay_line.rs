//! A delay line: the most recent samples of a signal in bands, readable at fractional delays.

use std::f64::consts::PI;

/// Number of samples used on each side of a read position.
pub(super) const REACH: usize = 8;

/// Number of weighted samples per read.
const WIDTH: usize = 2 * REACH;

/// Number of positions between two samples with stored weights; interpolation between these positions has an error of
/// about −100 dB.
const PHASES: usize = 256;

/// Weights of the samples around a position.
type Weights = [f32; WIDTH];

/// A signal of `BANDS` bands.
#[derive(Debug)]
pub(super) struct DelayLine<const BANDS: usize> {
    /// A ring whose length is a power of two.
    frames: Vec<[f32; BANDS]>,
    /// Total frames written.
    written: u64,
    weights: Vec<Weights>,
}

impl<const BANDS: usize> DelayLine<BANDS> {
    /// Creates a silent line. Delays of up to `longest` samples can be read, and blocks of up to `block` samples
    /// written.
    pub fn new(longest: usize, block: usize) -> Self {
        let length = (longest + block + WIDTH).next_power_of_two();
        Self {
            frames: vec![[0.0; BANDS]; length],
            written: 0,
            weights: (0..=PHASES).map(weights).collect(),
        }
    }

    /// Writes the next frames, from each band's samples.
    pub fn write(&mut self, bands: &[&[f32]; BANDS]) {
        let mask = self.frames.len() - 1;
        let length = bands[0].len();
        for index in 0..length {
            let at = (self.written as usize + index) & mask;
            self.frames[at] = bands.map(|samples| samples[index]);
        }
        self.written += length as u64;
    }

    /// The frame that lies `delay` + [`REACH`] samples before a frame. That frame was written `back` frames before the
    /// newest.
    pub fn read(&self, back: usize, delay: f64) -> [f32; BANDS] {
        let whole = delay.ceil();
        let place = (whole - delay) * PHASES as f64;
        let phase = (place as usize).min(PHASES - 1);
        let share = (place - phase as f64) as f32;
        let (near, far) = (&self.weights[phase], &self.weights[phase + 1]);
        // The newest weighted frame is 2 REACH − 1 frames after the oldest.
        let age = back + whole as usize + WIDTH;
        let oldest = (self.written as usize).wrapping_sub(age);
        let mask = self.frames.len() - 1;
        let mut sum = [0.0; BANDS];
        for index in 0..WIDTH {
            let weight = near[index] + share * (far[index] - near[index]);
            let frame = &self.frames[oldest.wrapping_add(index) & mask];
            for (sum, sample) in sum.iter_mut().zip(frame) {
                *sum += weight * sample;
            }
        }
        sum
    }
}

/// A sinc function with Blackman's window. Its centre is `phase` / [`PHASES`] samples after sample [`REACH`] − 1.
fn weights(phase: usize) -> Weights {
    let place = (REACH - 1) as f64 + phase as f64 / PHASES as f64;
    let weight = |index: usize| {
        let offset = index as f64 - place;
        let turn = PI * offset;
        let edge = turn / (REACH as f64 + 0.5);
        let window = 0.42 + 0.5 * edge.cos() + 0.08 * (2.0 * edge).cos();
        if offset == 0.0 {
            return 1.0;
        }
        window * turn.sin() / turn
    };
    let weights: [f64; WIDTH] = std::array::from_fn(weight);
    // Normalised so that a constant signal is unchanged.
    let sum: f64 = weights.iter().sum();
    weights.map(|weight| (weight / sum) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Protects amplitude and phase of reads between samples, to 0.1 dB below 15 kHz at 48 kHz.
    #[test]
    fn a_sine_is_read_between_samples() {
        for turns in [0.001, 0.02, 0.1, 0.25, 15.0 / 48.0] {
            let sine = |time: f64| (TAU * turns * time).sin();
            let samples: Vec<f32> = (0..200).map(|time| sine(f64::from(time)) as f32).collect();
            let mut line = DelayLine::<1>::new(64, 200);
            line.write(&[&samples]);
            for step in 0..500 {
                let (back, delay) = (step % 50, step as f64 * 0.1237);
                let read = line.read(back, delay)[0];
                let time = 199.0 - back as f64 - REACH as f64 - delay;
                let error = f64::from(read) - sine(time);
                assert!(error.abs() < 0.01, "{turns} {delay}: {error}");
            }
        }
    }

    /// Protects integer delays: they return the samples themselves.
    #[test]
    fn a_whole_delay_is_exact() {
        let samples: Vec<f32> = (0..100).map(|index| index as f32).collect();
        let mut line = DelayLine::<1>::new(64, 100);
        line.write(&[&samples]);
        for delay in 0..64 {
            let read = line.read(3, f64::from(delay))[0];
            assert!((read - (96 - REACH as i32 - delay) as f32).abs() < 1e-4);
        }
    }
}
