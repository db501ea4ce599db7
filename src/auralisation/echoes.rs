//! Single echoes, including the direct sound, with gliding delays and amplitudes: read from a delay line, the last
//! seconds of a signal in bands, between its samples.

use std::f64::consts::PI;

use super::convolution::BLOCK;
use super::heard::Echo;
use super::{CHANNELS, MOST_ECHOES};

/// Maximum rate of change of a delay: beyond it (a source at a fifth of the speed of sound, 250
/// km/h) the echo fades out at its old delay and in at the new one.
const MOST_DOPPLER: f64 = 0.2;

/// Echoes that can sound at once: the current ones and the fading ones.
const VOICES: usize = 2 * MOST_ECHOES;

/// An amplitude for each band and channel.
type Amplitudes<const BANDS: usize> = [[f32; BANDS]; CHANNELS];

/// One echo.
#[derive(Clone, Debug)]
struct Voice<const BANDS: usize> {
    key: u64,
    delay: f64,
    amplitudes: Amplitudes<BANDS>,
    delay_target: f64,
    target: Amplitudes<BANDS>,
    /// Samples until the targets are reached.
    to_go: u32,
    /// Whether it fades out, after which its place is free.
    is_ending: bool,
}

/// All echoes of one source.
#[derive(Debug)]
pub(super) struct Echoes<const BANDS: usize> {
    line: DelayLine<BANDS>,
    voices: Vec<Voice<BANDS>>,
}

impl<const BANDS: usize> Echoes<BANDS> {
    /// Creates an empty set, for delays of up to `longest` samples.
    pub fn new(longest: usize) -> Self {
        Self {
            line: DelayLine::new(longest, BLOCK),
            voices: Vec::with_capacity(VOICES),
        }
    }

    /// Glides to other echoes within `samples` samples; 0 takes them at once. Does not allocate.
    pub fn glide_to(&mut self, echoes: &[Echo], samples: u32) {
        for voice in &mut self.voices {
            voice.end(samples);
        }
        for echo in echoes.iter().take(MOST_ECHOES) {
            let target = echo.amplitudes();
            let reach = MOST_DOPPLER * f64::from(samples);
            let goes_on = |voice: &&mut Voice<BANDS>| {
                voice.key == echo.key && (voice.delay - echo.delay).abs() <= reach
            };
            match self.voices.iter_mut().find(goes_on) {
                Some(voice) => voice.aim(echo.delay, target, samples),
                None => self.begin(echo, target, samples),
            }
        }
    }

    fn begin(&mut self, echo: &Echo, target: Amplitudes<BANDS>, samples: u32) {
        let mut voice = Voice {
            key: echo.key,
            delay: echo.delay,
            amplitudes: [[0.0; BANDS]; CHANNELS],
            delay_target: echo.delay,
            target,
            to_go: 0,
            is_ending: false,
        };
        voice.aim(echo.delay, target, samples);
        if self.voices.len() < VOICES {
            self.voices.push(voice);
            return;
        }
        // Updates came faster than fades: the faintest fading voice is replaced.
        let fading = self.voices.iter_mut().filter(|voice| voice.is_ending);
        if let Some(faintest) = fading.min_by(|a, b| a.power().total_cmp(&b.power())) {
            *faintest = voice;
        }
    }

    /// Takes the next block of each band, and adds the echoes to the channels. Does not allocate.
    pub fn render(&mut self, bands: &[&[f32]; BANDS], out: &mut [[f32; BLOCK]; CHANNELS]) {
        self.line.write(bands);
        for voice in &mut self.voices {
            voice.render(&self.line, out);
        }
        self.voices.retain(|voice| !voice.is_over());
    }
}

impl<const BANDS: usize> Voice<BANDS> {
    fn aim(&mut self, delay: f64, target: Amplitudes<BANDS>, samples: u32) {
        self.delay_target = delay;
        self.target = target;
        self.to_go = samples;
        self.is_ending = false;
        if samples == 0 {
            self.arrive();
        }
    }

    fn end(&mut self, samples: u32) {
        let delay = self.delay;
        self.aim(delay, [[0.0; BANDS]; CHANNELS], samples);
        self.is_ending = true;
    }

    fn arrive(&mut self) {
        self.delay = self.delay_target;
        self.amplitudes = self.target;
    }

    fn is_over(&self) -> bool {
        self.is_ending && self.to_go == 0
    }

    fn power(&self) -> f32 {
        self.amplitudes.as_flattened().iter().map(|a| a * a).sum()
    }

    fn render(&mut self, line: &DelayLine<BANDS>, out: &mut [[f32; BLOCK]; CHANNELS]) {
        let gliding = (self.to_go as usize).min(BLOCK);
        for index in 0..gliding {
            self.step();
            self.add(line, index, out);
        }
        if self.is_over() {
            return;
        }
        for index in gliding..BLOCK {
            self.add(line, index, out);
        }
    }

    /// Moves one sample closer to the targets.
    fn step(&mut self) {
        self.to_go -= 1;
        if self.to_go == 0 {
            return self.arrive();
        }
        let left = self.to_go + 1;
        self.delay += (self.delay_target - self.delay) / f64::from(left);
        let share = 1.0 / left as f32;
        let amplitudes = self.amplitudes.as_flattened_mut();
        for (amplitude, target) in amplitudes.iter_mut().zip(self.target.as_flattened()) {
            *amplitude += (target - *amplitude) * share;
        }
    }

    fn add(&self, line: &DelayLine<BANDS>, index: usize, out: &mut [[f32; BLOCK]; CHANNELS]) {
        let frame = line.read(BLOCK - 1 - index, self.delay);
        for (out, amplitudes) in out.iter_mut().zip(&self.amplitudes) {
            let sum: f32 = frame.iter().zip(amplitudes).map(|(s, a)| s * a).sum();
            out[index] += sum;
        }
    }
}

/// Samples used on each side of a read position.
pub(super) const REACH: usize = 8;

/// Number of samples weighted for a read.
const WIDTH: usize = 2 * REACH;

/// Positions between two samples for which weights are stored; between these they are interpolated,
/// to about −100 dB.
const PHASES: usize = 256;

/// Weights of the samples around a position.
type Weights = [f32; WIDTH];

/// A signal of `BANDS` bands.
#[derive(Debug)]
struct DelayLine<const BANDS: usize> {
    /// A ring whose length is a power of two.
    frames: Vec<[f32; BANDS]>,
    /// Total frames written.
    written: u64,
    weights: Vec<Weights>,
}

impl<const BANDS: usize> DelayLine<BANDS> {
    /// Creates a silent line; delays of up to `longest` samples can be read while blocks of up to `block` are written.
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

    /// The frame `delay` + [`REACH`] samples before the one that was written `back` frames before the newest.
    pub fn read(&self, back: usize, delay: f64) -> [f32; BANDS] {
        let whole = delay.ceil();
        let place = (whole - delay) * PHASES as f64;
        let phase = (place as usize).min(PHASES - 1);
        let share = (place - phase as f64) as f32;
        let (near, far) = (&self.weights[phase], &self.weights[phase + 1]);
        // The newest weighted frame is 2 REACH − 1 after the oldest.
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

/// A sinc function with Blackman's window around the position `phase` / [`PHASES`] after the sample
/// [`REACH`] − 1.
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

    /// Protects whole delays: they return the samples themselves.
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
