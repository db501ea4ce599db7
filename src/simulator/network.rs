//! The late part of all sources: a feedback delay network.
//!
//! # Method
//! Sixteen delay lines feed back through an orthogonal matrix (Hadamard), so that without filters no energy is lost
//! (Jot and Chaigne, *Digital delay networks for designing artificial reverberators*, AES 90, 1991). An absorbent
//! filter follows each line. In a time d, sound that decays by 60 dB in T loses 60 d/T dB: the filter is a gain and
//! seven shelving filters of first order at the edges of the octaves, whose gains are fitted to the loss at the centres
//! of all eight bands (Välimäki and Liski, *Accurate cascade graphic equalizer*, IEEE SPL 24, 2017,
//! solve peaking filters in this way). Coefficients run linearly to their next values.
//!
//! # Cost
//! All filters of a stage run side by side for the sixteen lines.

use super::encoder::{Gains, MOST_CHANNELS, Planes};
use super::voice::without_denormals;
use crate::bands::{BAND_COUNT, BANDS_HZ, Bands};
use num_complex::Complex64;
use std::f64::consts::{PI, SQRT_2};

/// Number of delay lines.
pub(super) const LINES: usize = 16;

/// Lengths of the lines in seconds: prime numbers of samples at 48 kHz, so that few echoes coincide. The sum, 0.5 s,
/// is the number of modes for each hertz: more than the ear resolves in rooms that decay in less than 5 s.
const LENGTHS: [usize; LINES] = [
    887, 971, 1063, 1151, 1229, 1327, 1423, 1499, 1579, 1667, 1759, 1861, 1951, 2039, 2131, 2239,
];

/// The sampling rate of [`LENGTHS`] in hertz.
const LENGTHS_HZ: f64 = 48_000.0;

/// Time in seconds from the input to the first output.
pub(super) const FIRST_S: f64 = LENGTHS[0] as f64 / LENGTHS_HZ;

/// Number of shelving filters: one between every two bands.
const SHELVES: usize = BAND_COUNT - 1;

/// Shortest decay time in seconds: that of a furnished small room is 0.2 s.
const SHORTEST_S: f64 = 0.05;

/// Longest decay time in seconds.
const LONGEST_S: f64 = 60.0;

/// Steps of the solution for the shelves. The gains in decibels are nearly additive, so that few steps suffice.
const STEPS: usize = 8;

/// Weight of the squared gain of a shelf, relative to that of a band's mean error. Decays that change smoothly from
/// octave to octave stay within 1 %; the shelves have at most 40 dB for decay times between 0.05 and 60 s.
const PENALTY: f64 = 1e-3;

/// Least loss of a band in decibels whose relative error counts.
const LEAST_LOSS_DB: f64 = 1e-6;

/// The least loss at any frequency, relative to that of the slowest band. Below the lowest band, decays may go on to
/// become slower.
const LEAST_SHARE: f64 = 0.5;

/// Number of frequencies at which the greatest gain of a filter is sought, five in an octave, and the lowest of them in
/// hertz. The shelves change over octaves.
const TONES: usize = 60;
const LOWEST_HZ: f64 = 10.0;

/// Time in seconds in which coefficients run to their next values.
const GLIDE_S: f64 = 0.1;

/// One number for each line.
type Each = [f32; LINES];

/// The filters of all lines.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Absorption {
    gain: Each,
    /// For each shelf: both coefficients of the input, and the one of the output.
    shelves: [[Each; 3]; SHELVES],
}

/// A shelving filter of first order: 1 at low frequencies.
#[derive(Clone, Copy)]
struct Shelf([f64; 3]);

impl Shelf {
    /// A shelf at an edge in hertz whose gain at high frequencies is `gain`.
    fn new(edge_hz: f64, gain: f64, rate_hz: f64) -> Shelf {
        let warped = 1.0 / (PI * (edge_hz / rate_hz).min(0.49)).tan();
        let root = gain.sqrt();
        let (zero, pole) = (root * warped, warped / root);
        let scale = 1.0 / (1.0 + pole);
        Shelf([
            (1.0 + zero) * scale,
            (1.0 - zero) * scale,
            (1.0 - pole) * scale,
        ])
    }

    /// The shelf with this number, with a gain in decibels.
    fn of_db(shelf: usize, gain_db: f64, rate_hz: f64) -> Shelf {
        Shelf::new(edge_hz(shelf), 10_f64.powf(gain_db / 20.0), rate_hz)
    }

    fn gain_db(&self, hertz: f64, rate_hz: f64) -> f64 {
        let late = Complex64::from_polar(1.0, -2.0 * PI * hertz / rate_hz);
        let [b0, b1, a1] = self.0;
        let gain = (b0 + b1 * late) / (1.0 + a1 * late);
        20.0 * gain.norm().log10()
    }
}

/// The edge in hertz between a band and the next.
fn edge_hz(shelf: usize) -> f64 {
    BANDS_HZ[shelf] * SQRT_2
}

/// The broadband gain and the gains of the shelves in decibels.
type FilterGains = (f64, [f64; SHELVES]);

/// The gains of a filter that loses these decibels at the centres of the bands, as nearly as shelves of first order can:
/// least squares of the relative errors, with a penalty on the gains of shelves. Without the penalty, shelves that work
/// against each other become so strong that their rounding errors grow from pass to pass. Between and
/// beyond the bands, no frequency loses less than half as much as the slowest band, so that sound never grows.
fn solve(wanted_db: &Bands, rate_hz: f64) -> FilterGains {
    let mut now = (wanted_db[0], [0.0; SHELVES]);
    let weights = wanted_db.map(|wanted_db| 1.0 / wanted_db.abs().max(LEAST_LOSS_DB));
    let mean = weights.iter().sum::<f64>() / BAND_COUNT as f64;
    for _ in 0..STEPS {
        // The shape of each shelf at its present gain, per decibel.
        let shapes: [Bands; SHELVES] = std::array::from_fn(|shelf| {
            let gain_db: f64 = now.1[shelf];
            let gain_db = if gain_db.abs() < 0.01 { 0.01 } else { gain_db };
            let filter = Shelf::of_db(shelf, gain_db, rate_hz);
            BANDS_HZ.map(|centre| filter.gain_db(centre.min(0.45 * rate_hz), rate_hz) / gain_db)
        });
        // How an unknown changes the gain of a band, weighted. The first unknown is the broadband gain.
        let factor = |unknown: usize, band: usize| match unknown {
            0 => weights[band],
            shelf => weights[band] * shapes[shelf - 1][band],
        };
        let mut rows = [[0.0; BAND_COUNT + 1]; BAND_COUNT];
        for (index, row) in rows.iter_mut().enumerate() {
            for (column, value) in row.iter_mut().enumerate() {
                let products = (0..BAND_COUNT).map(|band| match column {
                    BAND_COUNT => factor(index, band) * weights[band] * wanted_db[band],
                    _ => factor(index, band) * factor(column, band),
                });
                *value = products.sum();
            }
            if index > 0 {
                row[index] += PENALTY * mean * mean;
            }
        }
        let Some(found) = eliminate(rows) else {
            break;
        };
        now.0 = found[0];
        now.1.copy_from_slice(&found[1..]);
    }
    let slowest_db = wanted_db.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    now.0 -= (peak_db(&now, rate_hz) - LEAST_SHARE * slowest_db).max(0.0);
    now
}

/// The greatest gain in decibels at any frequency.
fn peak_db((broad_db, steps_db): &FilterGains, rate_hz: f64) -> f64 {
    let shelves = steps_db.iter().enumerate();
    let shelves: Vec<Shelf> = shelves
        .map(|(shelf, gain_db)| Shelf::of_db(shelf, *gain_db, rate_hz))
        .collect();
    let octaves = (0.5 * rate_hz / LOWEST_HZ).log2();
    let tones = (0..=TONES).map(|tone| LOWEST_HZ * (octaves * tone as f64 / TONES as f64).exp2());
    let gain_db = |hertz: f64| {
        let all = shelves.iter().map(|shelf| shelf.gain_db(hertz, rate_hz));
        broad_db + all.sum::<f64>()
    };
    tones.map(gain_db).fold(*broad_db, f64::max)
}

/// The solution of linear equations, with the right sides in the last column; `None` if it is not unique.
fn eliminate(mut rows: [[f64; BAND_COUNT + 1]; BAND_COUNT]) -> Option<[f64; BAND_COUNT]> {
    for column in 0..BAND_COUNT {
        let pivot = (column..BAND_COUNT)
            .max_by(|a, b| rows[*a][column].abs().total_cmp(&rows[*b][column].abs()))?;
        rows.swap(column, pivot);
        let of_pivot = rows[column];
        if of_pivot[column].abs() < 1e-9 {
            return None;
        }
        for (index, row) in rows.iter_mut().enumerate() {
            if index != column {
                let factor = row[column] / of_pivot[column];
                for (value, pivot) in row.iter_mut().zip(&of_pivot) {
                    *value -= factor * pivot;
                }
            }
        }
    }
    Some(std::array::from_fn(|index| {
        rows[index][BAND_COUNT] / rows[index][index]
    }))
}

/// The length of a line in samples.
fn length(line: usize, rate_hz: f64) -> usize {
    ((LENGTHS[line] as f64 * rate_hz / LENGTHS_HZ).round() as usize).max(1)
}

impl Absorption {
    /// The filters for these decay times in seconds by band, at a rate in hertz.
    pub fn new(decay_s: &Bands, rate_hz: u32) -> Absorption {
        let rate = f64::from(rate_hz);
        let mut all = Absorption {
            gain: [0.0; LINES],
            shelves: [[[0.0; LINES]; 3]; SHELVES],
        };
        for line in 0..LINES {
            let delay_s = length(line, rate) as f64 / rate;
            let loss_db = |time_s: f64| -60.0 * delay_s / time_s.clamp(SHORTEST_S, LONGEST_S);
            let (broad_db, steps_db) = solve(&decay_s.map(loss_db), rate);
            all.gain[line] = 10_f64.powf(broad_db / 20.0) as f32;
            for (shelf, step_db) in steps_db.into_iter().enumerate() {
                let Shelf(numbers) = Shelf::of_db(shelf, step_db, rate);
                for (number, value) in numbers.into_iter().enumerate() {
                    all.shelves[shelf][number][line] = value as f32;
                }
            }
        }
        all
    }

    /// All coefficients in one order.
    fn numbers(&mut self) -> impl Iterator<Item = &mut f32> {
        let shelves = self.shelves.iter_mut().flatten().flatten();
        self.gain.iter_mut().chain(shelves)
    }
}

/// The energy of a channel with gain 1 after an impulse of energy 1, by band, for a sound that decays in these times: the
/// impulse passes all lines again and again, and each channel has the energy of all lines.
pub(super) fn energy(decay_s: &Bands) -> Bands {
    let mean_s = LENGTHS.iter().sum::<usize>() as f64 / LENGTHS_HZ / LINES as f64;
    decay_s.map(|time_s| {
        let time_s = time_s.clamp(SHORTEST_S, LONGEST_S);
        // Each pass leaves the share exp(−2 × passes).
        let pass = 10_f64.powf(-6.0 * mean_s / time_s);
        pass / (1.0 - pass)
    })
}

/// The network.
#[derive(Debug)]
pub(super) struct Network {
    lines: Vec<Vec<f32>>,
    /// Index of the next sample of each line.
    at: [usize; LINES],
    absorption: Absorption,
    step: Absorption,
    /// Number of samples until the coefficients reach their next values.
    to_go: u32,
    glide: u32,
    next: Absorption,
    states: [Each; SHELVES],
    /// The factors of the lines in each channel.
    channels: Vec<Each>,
}

/// The rows of the matrix that are the signs of the lines in each channel, so that all channels differ.
const MASKS: [u32; MOST_CHANNELS] = [5, 11, 3, 6, 9, 12, 10, 15, 1, 2, 4, 8, 7, 13, 14, 0];

/// The signs of the lines in a row of the Hadamard matrix.
fn signs(mask: u32) -> Each {
    std::array::from_fn(|line| match (line as u32 & mask).count_ones() % 2 {
        0 => 1.0,
        _ => -1.0,
    })
}

impl Network {
    /// A silent network that decays in these times in seconds, with the amplitudes of the first `count` channels.
    pub fn new(decay_s: &Bands, rate_hz: u32, count: usize, channels: &Gains) -> Network {
        let absorption = Absorption::new(decay_s, rate_hz);
        let rate = f64::from(rate_hz);
        Network {
            lines: (0..LINES)
                .map(|line| vec![0.0; length(line, rate)])
                .collect(),
            at: [0; LINES],
            step: absorption.clone(),
            next: absorption.clone(),
            absorption,
            to_go: 0,
            glide: ((GLIDE_S * rate) as u32).max(1),
            states: [[0.0; LINES]; SHELVES],
            channels: channels
                .iter()
                .take(count)
                .zip(MASKS)
                .map(|(gain, mask)| signs(mask).map(|sign| gain * sign))
                .collect(),
        }
    }

    /// Lets the filters run to other ones. Does not allocate.
    pub fn glide_to(&mut self, next: &Absorption) {
        self.next.clone_from(next);
        self.step.clone_from(next);
        let glide = self.glide as f32;
        for (step, now) in self.step.numbers().zip(self.absorption.numbers()) {
            *step = (*step - *now) / glide;
        }
        self.to_go = self.glide;
    }

    /// Adds the network's output for the next samples of its input to all channels. Does not allocate.
    pub fn add(&mut self, input: &[f32], planes: &mut Planes) {
        for (index, input) in input.iter().enumerate() {
            if self.to_go > 0 {
                self.glide();
            }
            let values = self.next_sample(*input);
            for (factors, plane) in self.channels.iter().zip(&mut *planes) {
                let products = values
                    .iter()
                    .zip(factors)
                    .map(|(value, factor)| value * factor);
                plane[index] += products.sum::<f32>();
            }
        }
        for states in &mut self.states {
            *states = states.map(without_denormals);
        }
        if !self.states.iter().flatten().all(|state| state.is_finite()) {
            self.clear();
        }
    }

    /// Forgets all sound: a number that is not finite would stay for ever.
    fn clear(&mut self) {
        self.lines.iter_mut().for_each(|line| line.fill(0.0));
        self.states = [[0.0; LINES]; SHELVES];
    }

    fn glide(&mut self) {
        self.to_go -= 1;
        if self.to_go == 0 {
            self.absorption.clone_from(&self.next);
            return;
        }
        for (now, step) in self.absorption.numbers().zip(self.step.numbers()) {
            *now += *step;
        }
    }

    /// The outputs of all lines.
    fn next_sample(&mut self, input: f32) -> Each {
        let mut values: Each = std::array::from_fn(|line| self.lines[line][self.at[line]]);
        for (value, gain) in values.iter_mut().zip(&self.absorption.gain) {
            *value *= gain;
        }
        for (states, [b0, b1, a1]) in self.states.iter_mut().zip(&self.absorption.shelves) {
            for line in 0..LINES {
                let value = values[line];
                let out = b0[line] * value + states[line];
                states[line] = b1[line] * value - a1[line] * out;
                values[line] = out;
            }
        }
        let out = values;
        mix(&mut values);
        for line in 0..LINES {
            let place = &mut self.lines[line][self.at[line]];
            *place = without_denormals(values[line] + IN * input * SIGNS[line]);
            self.at[line] += 1;
            if self.at[line] == self.lines[line].len() {
                self.at[line] = 0;
            }
        }
        out
    }
}

/// The share of the input's amplitude in each line: the energies add up to 1.
const IN: f32 = 0.25;

/// Signs of the input in the lines, so that the input does not leave as one echo.
const SIGNS: Each = {
    let mut signs = [1.0; LINES];
    let mut line = 0;
    while line < LINES {
        if line % 3 == 1 {
            signs[line] = -1.0;
        }
        line += 1;
    }
    signs
};

/// Multiplies by the orthogonal Hadamard matrix.
fn mix(values: &mut Each) {
    let mut half = 1;
    while half < LINES {
        for start in (0..LINES).step_by(2 * half) {
            for index in start..start + half {
                let (a, b) = (values[index], values[index + half]);
                values[index] = a + b;
                values[index + half] = a - b;
            }
        }
        half *= 2;
    }
    for value in values {
        *value *= 0.25;
    }
}

#[cfg(test)]
mod tests {
    use super::super::encoder::Encoder;
    use super::super::fit::CHUNK;
    use super::*;
    use crate::sampling::{hash, unit_interval};

    const RATE_HZ: u32 = 48_000;

    /// The gains of two ears.
    fn two() -> Gains {
        Encoder::Stereo.diffuse()
    }

    fn network(decay_s: &Bands) -> Network {
        Network::new(decay_s, RATE_HZ, 2, &two())
    }

    /// Both channels of a network for an input.
    fn play(network: &mut Network, input: &[f32]) -> Vec<[f32; 2]> {
        let mut out = Vec::new();
        for chunk in input.chunks(CHUNK) {
            let mut planes: Box<Planes> = Box::new([[0.0; CHUNK]; MOST_CHANNELS]);
            network.add(chunk, &mut planes);
            out.extend((0..chunk.len()).map(|index| [planes[0][index], planes[1][index]]));
        }
        out
    }

    /// The response of a network to an impulse, both channels, with denormals avoided by its length.
    fn response(decay_s: &Bands, seconds: f64) -> Vec<[f32; 2]> {
        let mut input = vec![0.0; (seconds * f64::from(RATE_HZ)) as usize];
        input[0] = 1.0;
        play(&mut network(decay_s), &input)
    }

    /// The gain in decibels of the filter of a line at a frequency: that of its response to an impulse.
    fn loss_db(absorption: &Absorption, line: usize, hertz: f64) -> f64 {
        let mut states = [0.0_f64; SHELVES];
        let mut sum = Complex64::default();
        for sample in 0..1 << 15 {
            let mut value = match sample {
                0 => f64::from(absorption.gain[line]),
                _ => 0.0,
            };
            for (state, numbers) in states.iter_mut().zip(&absorption.shelves) {
                let [b0, b1, a1] = numbers.map(|each| f64::from(each[line]));
                let out = b0 * value + *state;
                *state = b1 * value - a1 * out;
                value = out;
            }
            let turn = 2.0 * PI * hertz * f64::from(sample) / f64::from(RATE_HZ);
            sum += value * Complex64::from_polar(1.0, -turn);
        }
        20.0 * sum.norm().log10()
    }

    /// The decay time in seconds of energies in windows: from a line through the levels of −5 to −35 dB of their
    /// backward sums.
    fn decay_s(energies: &[f64], window_s: f64) -> f64 {
        let mut sums = energies.to_vec();
        for index in (0..sums.len() - 1).rev() {
            sums[index] += sums[index + 1];
        }
        let level =
            |(index, sum): (usize, &f64)| (index as f64 * window_s, 10.0 * (sum / sums[0]).log10());
        let levels = sums.iter().enumerate().map(level);
        let levels: Vec<(f64, f64)> = levels
            .filter(|(_, level)| (-35.0..=-5.0).contains(level))
            .collect();
        let count = levels.len() as f64;
        let mean_s = levels.iter().map(|(seconds, _)| seconds).sum::<f64>() / count;
        let moments = levels.iter().map(|(s, level)| (s - mean_s) * level);
        let squares = levels.iter().map(|(s, _)| (s - mean_s).powi(2));
        -60.0 * squares.sum::<f64>() / moments.sum::<f64>()
    }

    /// Decay times that are even, fall, and have a maximum.
    const DECAYS: [Bands; 3] = [
        [1.0; BAND_COUNT],
        [2.2, 2.0, 1.8, 1.6, 1.4, 1.1, 0.8, 0.6],
        [0.8, 1.0, 1.3, 1.5, 1.4, 1.2, 0.9, 0.7],
    ];

    /// Protects the decay in each octave, to 2 %. All lines lose the same decibels in a second, and the matrix loses
    /// nothing, so that this loss is the decay.
    #[test]
    fn each_octave_decays_in_its_time() {
        for wanted in DECAYS {
            let absorption = Absorption::new(&wanted, RATE_HZ);
            for line in [0, 7, 15] {
                let delay_s = LENGTHS[line] as f64 / LENGTHS_HZ;
                for (band, wanted_s) in wanted.iter().enumerate() {
                    let found_s = -60.0 * delay_s / loss_db(&absorption, line, BANDS_HZ[band]);
                    let off = found_s / wanted_s - 1.0;
                    assert!(
                        off.abs() < 0.02,
                        "{} Hz: {found_s} s, not {wanted_s}",
                        BANDS_HZ[band]
                    );
                }
            }
        }
    }

    /// Protects the decay and the level that are heard: noise of 50 ms decays in the time of all bands, to 2 %, and has
    /// the stated energy, to 0.3 dB.
    #[test]
    fn noise_decays_in_time_and_at_level() {
        const DECAY_S: f64 = 0.8;
        let window = 960;
        let length = (1.2 * DECAY_S * f64::from(RATE_HZ)) as usize;
        let mut energies = vec![0.0; length / window];
        let mut given = 0.0;
        for seed in 0..12 {
            let mut network = network(&[DECAY_S; BAND_COUNT]);
            let mut input = vec![0.0; length];
            for (index, sample) in input[..2400].iter_mut().enumerate() {
                *sample = unit_interval(hash(hash(seed) ^ index as u64)) as f32 - 0.5;
                given += f64::from(*sample * *sample);
            }
            let out = play(&mut network, &input);
            for (energy, frames) in energies.iter_mut().zip(out.chunks_exact(window)) {
                *energy += frames
                    .iter()
                    .flatten()
                    .map(|s| f64::from(s * s))
                    .sum::<f64>();
            }
        }
        let total: f64 = energies.iter().sum();
        let expected = energy(&[DECAY_S; BAND_COUNT])[4];
        let level_db = 10.0 * (total / given / expected).log10();
        assert!(level_db.abs() < 0.3, "{level_db} dB");
        // After the noise has ended and filled all lines.
        let found_s = decay_s(&energies[6..], window as f64 / f64::from(RATE_HZ));
        assert!((found_s / DECAY_S - 1.0).abs() < 0.02, "{found_s} s");
    }

    /// Protects listeners from sound that grows: decay times that jump from octave to octave, between the shortest and the
    /// longest possible ones, give filters that never amplify, and the sound of an impulse decays.
    #[test]
    fn sound_never_grows() {
        let mut cases: Vec<Bands> = vec![
            [0.98, 0.98, 0.56, 0.56, 0.33, 0.33, 0.25, 0.25],
            [0.05, 60.0, 0.05, 60.0, 0.05, 60.0, 0.05, 60.0],
            [60.0, 0.05, 60.0, 0.05, 60.0, 0.05, 60.0, 0.05],
            [5.0, 5.0, 5.0, 5.0, 0.2, 0.2, 0.2, 0.2],
            [0.3, 0.3, 0.3, 3.0, 0.3, 0.3, 0.3, 0.3],
            [0.05; BAND_COUNT],
            [60.0; BAND_COUNT],
        ];
        for case in 0..40_u64 {
            let random = |band: usize| unit_interval(hash(hash(case) ^ band as u64));
            cases.push(std::array::from_fn(|band| 0.1 * 80_f64.powf(random(band))));
        }
        for decay_s in cases {
            let slowest_s = decay_s.into_iter().fold(0.0, f64::max).min(2.0);
            let seconds = 2.5 * slowest_s.min(1.0) + 0.5;
            let out = response(&decay_s, seconds);
            let energy = |part: &[[f32; 2]]| -> f64 {
                part.iter().flatten().map(|s| f64::from(*s).powi(2)).sum()
            };
            let (first, last) = out.split_at(out.len() / 2);
            let (first, last) = (energy(first), energy(last));
            assert!(
                last.is_finite() && last < 1.001 * first,
                "{decay_s:?}: {first} {last}"
            );
        }
    }

    /// Protects the rest of the sound from one number that is not finite: the network begins again.
    #[test]
    fn a_broken_state_is_forgotten() {
        let mut network = network(&[1.0; BAND_COUNT]);
        play(&mut network, &[1.0; 4800]);
        network.lines[3][7] = f32::NAN;
        play(&mut network, &[0.0; 9600]);
        let out = play(&mut network, &[1.0; 4800]);
        assert!(out.iter().flatten().all(|sample| sample.is_finite()));
        assert!(out.iter().flatten().any(|sample| *sample != 0.0));
    }

    /// Protects the smoothness of the reverberation: after 100 ms, its samples are distributed like Gaussian noise, as
    /// in a convolution with shaped noise. The share beyond one standard deviation, in windows of 20 ms, is then 0.317
    /// (the echo density of Abel and Huang, AES 121, 2006, is 1).
    #[test]
    fn echoes_are_as_dense_as_noise() {
        let density = |samples: &[f64]| {
            let deviation =
                (samples.iter().map(|s| s * s).sum::<f64>() / samples.len() as f64).sqrt();
            let beyond = samples.iter().filter(|s| s.abs() > deviation).count();
            beyond as f64 / samples.len() as f64 / 0.317
        };
        let out = response(&[1.5; BAND_COUNT], 0.6);
        let left: Vec<f64> = out.iter().map(|pair| f64::from(pair[0])).collect();
        let noise: Vec<f64> = (0..960)
            .map(|index| {
                let sum: f64 = (0..12).map(|k| unit_interval(hash(hash(k) ^ index))).sum();
                sum - 6.0
            })
            .collect();
        assert!((density(&noise) - 1.0).abs() < 0.1);
        for window in left.chunks_exact(960).skip(10) {
            assert!(density(window) > 0.8, "{}", density(window));
        }
    }

    /// Protects the callback from clicks and from growing sound when the decay changes.
    #[test]
    fn the_decay_glides() {
        let mut network = network(&[0.5; BAND_COUNT]);
        // Whole periods, so that the tone continues from call to call.
        let step = 2.0 * std::f32::consts::PI * 200.0 / 24_000.0;
        let tone: Vec<f32> = (0..24_000).map(|i| (i as f32 * step).sin()).collect();
        let out = play(&mut network, &tone);
        let largest = |out: &[[f32; 2]]| {
            let steps = out.windows(2).map(|pair| (pair[1][0] - pair[0][0]).abs());
            steps.fold(0.0, f32::max)
        };
        let steady = largest(&out[12_000..]);
        network.glide_to(&Absorption::new(&[0.2; BAND_COUNT], RATE_HZ));
        let changed = play(&mut network, &tone[..12_000]);
        assert!(
            largest(&changed) < 1.1 * steady,
            "{} {steady}",
            largest(&changed)
        );
    }
}
