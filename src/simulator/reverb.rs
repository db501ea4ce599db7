//! The reverberation of a source: level, decay times by band, and their errors.
//!
//! # Method
//! Energies are counted in bins of 5 ms and 16 batches of waves. Most traces end after a fraction of a second. Some are
//! longer, with fewer waves, and only they count after the end of the short ones. The decay curve is the backward
//! integral of the energy (Schroeder 1965). Beyond the last bin the energy decays exponentially at the rate of the last
//! 10 dB. The decay time is that of the least-squares line through the curve from −5 dB to −35 dB, as T30.
//!
//! # Errors
//! Two parts are added as squares. The statistical part is the jackknife over the batches. The part of the
//! extrapolation is the greatest change of the result if the rate beyond the record is that of the part before the last
//! 10 dB, or if the rate goes on to change as it did between both parts, and 1 % for each decibel beyond the record. If
//! the energy does not fall within the record, the decay is unknown, and its error is half of it.

use crate::bands::{BAND_COUNT, Bands};
use crate::response::{Echogram, Tap, amplitude};

/// Length of a bin in seconds.
const BIN_S: f64 = 0.005;

/// Number of batches of waves.
pub(super) const BATCHES: usize = 16;

/// Student's t of 15 degrees of freedom at 97.5 %, divided by 2: twice the error contains the truth in 95 % of cases.
const STUDENT: f64 = 1.066;

/// Levels in decibels between which the decay time is evaluated.
const UPPER_DB: f64 = -5.0;
const LOWER_DB: f64 = -35.0;

/// The last decay of the record in decibels, whose rate goes on beyond the record.
const TAIL_DB: f64 = 10.0;

/// Minimum number of bins of a part whose rate is measured.
const LEAST_BINS: usize = 4;

/// Longest decay time in seconds. Without any absorption sound does not decay.
const LONGEST_S: f64 = 60.0;

/// Limits of the change of the rate beyond the record, relative to the rate of the last part.
const RATE_CHANGES: [f64; 2] = [0.4, 2.5];

/// Least relative error of a decay time: bins, the sphere of late arrivals and the line through a curve that is not
/// straight.
const LEAST_ERROR: f64 = 0.01;

/// Further relative error of a decay time for each decibel of its decay beyond the record: rooms with even walls decay
/// ever more slowly. In shoeboxes and between parallel walls it was 0.6 to 1.3 % for each decibel.
const ERROR_PER_DB: f64 = 0.01;

/// Relative error of a decay time if no decay was seen within the record. All energy beyond the record is then uncertain.
const UNKNOWN: f64 = 0.5;

/// Greatest relative error of an energy: 10 dB.
const MOST_ERROR: f64 = 0.9;

/// Earlier traces keep a share of their weight. In the late part they keep this power of that share, so that they count
/// for longer.
const FAR_FORGETS: f64 = 0.25;

/// Least error of a level in decibels.
const LEAST_ERROR_DB: f64 = 0.05;

/// The reverberation of a source at the listener: everything but the direct way.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Reverb {
    /// Amplitude of all reverberation by band, echoes included, relative to the direct sound at 1 m: the root of its
    /// energy. 0 where nothing reverberates.
    pub gain: Bands,
    /// Error of the gains in decibels, one standard deviation.
    pub gain_error_db: Bands,
    /// Time in seconds from the arrival of the direct sound, or from when it would arrive in the open, to the first
    /// reverberant sound.
    pub pre_delay_s: f64,
    /// Decay time by band in seconds for 60 dB, from the decay between −5 dB and −35 dB. At most 60 s; 0 where nothing
    /// reverberates.
    pub decay_s: Bands,
    /// Error of the decay times in seconds, one standard deviation.
    pub decay_error_s: Bands,
    /// Whether a part of the decay lies beyond the traced record, and is extrapolated.
    pub is_extrapolated: [bool; BAND_COUNT],
    /// Amplitude by band of the reverberation that is not among the listed echoes.
    pub(super) late_gain: Bands,
    /// Time in seconds after the source's impulse when a tenth of the late energy has arrived.
    pub(super) late_s: f64,
}

/// Energies of traces of the same length, weighted by their numbers of waves.
#[derive(Clone, Debug, Default)]
struct Sums {
    weight: f64,
    /// Number of bins that every trace has filled.
    known: usize,
    bins: Vec<[[f32; BAND_COUNT]; BATCHES]>,
}

/// The late energy of a source over several traces.
#[derive(Clone, Debug, Default)]
pub(super) struct DecayRecord {
    /// All traces, up to the end of the short ones.
    near: Sums,
    /// The long traces.
    far: Sums,
}

impl Sums {
    /// Counts the earlier traces as this share of themselves.
    fn fade(&mut self, keep: f64) {
        if keep <= 0.0 {
            *self = Sums::default();
            return;
        }
        self.weight *= keep;
        let all = self.bins.iter_mut().flatten().flatten();
        all.for_each(|energy| *energy *= keep as f32);
    }

    /// Adds the energies from `from_s` to `ends_s`.
    fn add(&mut self, echogram: &Echogram, from_s: f64, ends_s: f64, weight: f64) {
        self.weight += weight;
        self.known = ((ends_s - from_s) / BIN_S).max(0.0) as usize;
        self.bins.resize(self.known, [[0.0; BAND_COUNT]; BATCHES]);
        for bin in 0..echogram.bins() {
            let middle_s = echogram.first_s() + (bin as f64 + 0.5) * echogram.bin_s();
            let place = ((middle_s - from_s) / BIN_S).max(0.0) as usize;
            let Some(sums) = self.bins.get_mut(place) else {
                break;
            };
            for (batch, sums) in sums.iter_mut().enumerate() {
                let energy = echogram.batch_energy(bin, batch);
                for (sum, energy) in sums.iter_mut().zip(energy) {
                    *sum += (weight * energy) as f32;
                }
            }
        }
    }

    /// The energy of a bin and band, without one batch.
    fn energy(&self, bin: usize, band: usize, without: Option<usize>) -> f64 {
        if self.weight <= 0.0 {
            return 0.0;
        }
        let Some(batches) = self.bins.get(bin) else {
            return 0.0;
        };
        let sum: f32 = batches.iter().map(|batch| batch[band]).sum();
        let sum = match without {
            Some(batch) => {
                let share = BATCHES as f32 / (BATCHES - 1) as f32;
                (sum - batches[batch][band]).max(0.0) * share
            }
            None => sum,
        };
        f64::from(sum) / self.weight
    }
}

/// One trace.
pub(super) struct Trace<'a> {
    pub echogram: &'a Echogram,
    /// Number of waves for late arrivals.
    pub waves: u32,
    /// End of the record, and the end of short records, in seconds.
    pub ends_s: f64,
    pub short_s: f64,
    /// Arrival of the direct sound, in the open.
    pub direct_s: f64,
}

impl DecayRecord {
    /// Adds a trace; `keep` is the share of the earlier traces that still counts.
    pub fn add(&mut self, trace: &Trace, keep: f64) {
        self.near.fade(keep);
        // Late sound changes less from place to place.
        self.far.fade(keep.powf(FAR_FORGETS));
        let weight = f64::from(trace.waves);
        let short_s = trace.ends_s.min(trace.short_s);
        self.near
            .add(trace.echogram, trace.direct_s, short_s, weight);
        if trace.ends_s > trace.short_s {
            self.far
                .add(trace.echogram, trace.direct_s, trace.ends_s, weight);
        }
    }

    /// Number of waves that count.
    pub fn waves(&self) -> f64 {
        self.near.weight
    }

    /// Whether long traces count.
    pub fn is_long(&self) -> bool {
        self.far.weight > 0.0
    }

    /// Number of bins with known energies.
    fn known(&self) -> usize {
        self.near.known.max(match self.is_long() {
            true => self.far.known,
            false => 0,
        })
    }

    /// The energies of a band by bin, with the taps, without one batch.
    fn energies(&self, taps: &[f64], band: usize, without: Option<usize>) -> Vec<f64> {
        let energy = |bin: usize| {
            let late = match bin < self.near.known {
                true => self.near.energy(bin, band, without),
                false => self.far.energy(bin, band, without),
            };
            late + taps[bin]
        };
        (0..self.known()).map(energy).collect()
    }

    /// The reverberation. `taps` are all exact paths, of which those in `direct` and `echoes` are not late.
    pub fn reverb(
        &self,
        taps: &[Tap],
        direct_energy: &Bands,
        late_taps: &Bands,
        direct_s: f64,
    ) -> Reverb {
        let known = self.known();
        let mut reverb = Reverb {
            pre_delay_s: self.pre_delay_s(taps, direct_s),
            late_s: direct_s + self.late_begins_s(),
            ..Reverb::default()
        };
        if known == 0 {
            return reverb;
        }
        for band in 0..BAND_COUNT {
            let mut of_taps = vec![0.0; known];
            for tap in taps {
                let bin = ((tap.seconds - direct_s) / BIN_S).max(0.0) as usize;
                of_taps[bin.min(known - 1)] += tap.energy[band];
            }
            let late = DecayRecord::late_of(&self.energies(&vec![0.0; known], band, None));
            let estimate =
                |without| Curve::new(self.energies(&of_taps, band, without)).estimate(Rate::Last);
            let all = self.energies(&of_taps, band, None);
            let wet = |total: f64| (total - direct_energy[band]).max(0.0);
            let found = Curve::new(all).estimate(Rate::Last);
            if wet(found.total) <= 1e-12 * found.total || found.total <= 0.0 {
                continue;
            }
            let parts: Vec<Estimate> = (0..BATCHES).map(|batch| estimate(Some(batch))).collect();
            let curve = Curve::new(self.energies(&of_taps, band, None));
            let others = [Rate::Before, Rate::Changing].map(|rate| curve.estimate(rate));
            let (decay_error, wet_error) = errors(&found, &parts, &others);
            reverb.decay_s[band] = found.decay_s;
            let least = LEAST_ERROR.hypot(ERROR_PER_DB * found.beyond_db);
            let unknown = if found.is_unknown { UNKNOWN } else { 0.0 };
            reverb.decay_error_s[band] = decay_error.hypot(least.max(unknown) * found.decay_s);
            let wet_error = match found.is_unknown {
                true => wet_error.hypot(found.tail),
                false => wet_error,
            };
            reverb.is_extrapolated[band] = found.is_extrapolated;
            let energy = wet(found.total);
            reverb.gain[band] = amplitude(energy);
            let error_db = -10.0 * (1.0 - (wet_error / energy).min(MOST_ERROR)).log10();
            reverb.gain_error_db[band] = error_db.hypot(LEAST_ERROR_DB);
            reverb.late_gain[band] = amplitude(late + found.tail + late_taps[band]);
        }
        reverb
    }

    fn late_of(energies: &[f64]) -> f64 {
        energies.iter().sum()
    }

    /// The first time with reverberation after the direct sound, in seconds.
    fn pre_delay_s(&self, taps: &[Tap], direct_s: f64) -> f64 {
        let of_taps = taps.iter().map(|tap| tap.seconds - direct_s);
        let has_energy =
            |bin: &usize| (0..BAND_COUNT).any(|band| self.near.energy(*bin, band, None) > 0.0);
        let of_bins = (0..self.near.known).find(has_energy);
        let of_bins = of_bins.map(|bin| bin as f64 * BIN_S);
        let after = of_taps.filter(|seconds| *seconds > 1e-6).chain(of_bins);
        after.reduce(f64::min).unwrap_or(0.0).max(0.0)
    }

    /// Time after the direct sound when a tenth of the late energy has arrived.
    fn late_begins_s(&self) -> f64 {
        let energy = |bin: usize| -> f64 {
            (0..BAND_COUNT)
                .map(|band| self.near.energy(bin, band, None))
                .sum()
        };
        let all: f64 = (0..self.near.known).map(energy).sum();
        let mut sum = 0.0;
        for bin in 0..self.near.known {
            sum += energy(bin);
            if sum > 0.1 * all {
                return bin as f64 * BIN_S;
            }
        }
        0.0
    }
}

/// The rate of the decay beyond the record.
#[derive(Clone, Copy, PartialEq)]
enum Rate {
    /// The rate of the last part.
    Last,
    /// The rate of the part before it.
    Before,
    /// As different from that of the last part as that was from the one before.
    Changing,
}

/// The result for one band.
#[derive(Clone, Copy)]
struct Estimate {
    decay_s: f64,
    /// Energy of the whole curve, and of its part beyond the record.
    total: f64,
    tail: f64,
    /// The part of the decay to −35 dB that lies beyond the record, in decibels.
    beyond_db: f64,
    is_extrapolated: bool,
    /// Whether the energy does not fall towards the end of the record.
    is_unknown: bool,
}

/// The decay of one band.
struct Curve {
    energies: Vec<f64>,
    /// Energy from the beginning of each bin to the end of the record.
    remaining: Vec<f64>,
}

impl Curve {
    fn new(energies: Vec<f64>) -> Curve {
        let mut remaining = vec![0.0; energies.len() + 1];
        for (index, energy) in energies.iter().enumerate().rev() {
            remaining[index] = remaining[index + 1] + energy;
        }
        Curve {
            energies,
            remaining,
        }
    }

    fn between(&self, from: usize, to: usize) -> f64 {
        self.remaining[from] - self.remaining[to]
    }

    /// Rate in 1/s between two adjacent parts of equal length that end at a bin.
    fn rate(&self, ends: usize, part: usize) -> Option<f64> {
        let (before, last) = (
            self.between(ends - 2 * part, ends - part),
            self.between(ends - part, ends),
        );
        (before > 0.0 && last > 0.0).then(|| (before / last).ln() / (part as f64 * BIN_S))
    }

    /// Length in bins of the two parts at the record's end that differ by half of [`TAIL_DB`].
    fn part(&self) -> usize {
        let ratio = 10_f64.powf(TAIL_DB / 20.0);
        let count = self.energies.len();
        let decays = |part: usize| {
            self.between(count - 2 * part, count - part)
                >= ratio * self.between(count - part, count)
        };
        let mut part = count / 2;
        while part > LEAST_BINS && decays(part * 31 / 32) && decays(part) {
            part = (part * 31 / 32).min(part - 1);
        }
        part
    }

    /// The rate of the decay beyond the record in 1/s.
    fn tail_rate(&self, which: Rate) -> Option<f64> {
        let (count, part) = (self.energies.len(), self.part());
        if part < LEAST_BINS {
            return None;
        }
        let last = self.rate(count, part)?;
        if which == Rate::Last {
            return Some(last);
        }
        // The part before the two last ones; if the record is too short, the first and the second half of both.
        let earlier = match count >= 4 * part {
            true => self.rate(count - 2 * part, part),
            false => self.rate(count - part, (count - part) / 2),
        };
        let earlier = earlier.filter(|rate| *rate > 0.0)?;
        let [least, most] = RATE_CHANGES;
        let change = (last / earlier).clamp(least, most);
        Some(match which {
            Rate::Before => last / change,
            _ => last * change,
        })
    }

    fn estimate(&self, rate: Rate) -> Estimate {
        let count = self.energies.len();
        let slowest = 6.0 * 10_f64.ln() / LONGEST_S;
        let part = self.part().max(1);
        let last = self.between(count - part.min(count), count);
        let seen = self.tail_rate(rate).or_else(|| self.tail_rate(Rate::Last));
        let rate = seen.unwrap_or(slowest).max(slowest);
        // The energy at the end is that of the last part, whose mean is half a part before the end.
        let mean = rate * part as f64 * BIN_S;
        let tail = match last > 0.0 {
            true => last / mean.exp_m1().max(1e-9),
            false => 0.0,
        };
        let total = self.remaining[0] + tail;
        let line = Line {
            curve: self,
            tail,
            rate,
            total,
        };
        let ends_s = line.reaches_s(LOWER_DB);
        Estimate {
            decay_s: line.decay_s().clamp(0.0, LONGEST_S),
            total,
            tail,
            beyond_db: (line.level_db(count as f64 * BIN_S) - LOWER_DB).max(0.0),
            is_extrapolated: ends_s > count as f64 * BIN_S,
            is_unknown: last > 0.0 && seen.is_none_or(|seen| seen <= slowest),
        }
    }
}

/// The curve in decibels, with its tail.
struct Line<'a> {
    curve: &'a Curve,
    tail: f64,
    rate: f64,
    total: f64,
}

impl Line<'_> {
    fn level_db(&self, seconds: f64) -> f64 {
        let place = seconds / BIN_S;
        let (bin, count) = (place as usize, self.curve.energies.len());
        let at = |bin: usize| 10.0 * ((self.curve.remaining[bin] + self.tail) / self.total).log10();
        if bin < count {
            let (share, next) = (place - bin as f64, at(bin + 1).max(-300.0));
            return at(bin) + share * (next - at(bin));
        }
        let beyond_s = seconds - count as f64 * BIN_S;
        at(count).max(-300.0) - 10.0 * self.rate * beyond_s / 10_f64.ln()
    }

    /// The first time at which the curve is at or below a level.
    fn reaches_s(&self, level_db: f64) -> f64 {
        let count = self.curve.energies.len();
        let wanted = self.total * 10_f64.powf(level_db / 10.0);
        let above = |energy: &f64| *energy + self.tail > wanted;
        let index = self.curve.remaining.partition_point(above);
        if index > count {
            let end_db = self.level_db(count as f64 * BIN_S);
            return count as f64 * BIN_S + (end_db - level_db) * 10_f64.ln() / (10.0 * self.rate);
        }
        let Some(before) = index.checked_sub(1) else {
            return 0.0;
        };
        let ends = [before, index].map(|bin| self.level_db(bin as f64 * BIN_S));
        let share = (ends[0] - level_db) / (ends[0] - ends[1]).max(1e-12);
        (before as f64 + share.clamp(0.0, 1.0)) * BIN_S
    }

    /// The decay time of the least-squares line between both levels.
    fn decay_s(&self) -> f64 {
        /// Number of points of the curve.
        const POINTS: usize = 120;
        let (begins_s, ends_s) = (self.reaches_s(UPPER_DB), self.reaches_s(LOWER_DB));
        let length_s = (ends_s - begins_s).max(BIN_S);
        let middle_s = begins_s + 0.5 * length_s;
        let (mut moment, mut squares) = (0.0, 0.0);
        for point in 0..POINTS {
            let at_s = begins_s + length_s * (point as f64 + 0.5) / POINTS as f64;
            moment += self.level_db(at_s) * (at_s - middle_s);
            squares += (at_s - middle_s).powi(2);
        }
        let slope = moment / squares;
        match slope < 0.0 {
            true => -60.0 / slope,
            false => LONGEST_S,
        }
    }
}

/// The errors of the decay time in seconds, and of the energy.
fn errors(found: &Estimate, parts: &[Estimate], others: &[Estimate]) -> (f64, f64) {
    let of = |value: fn(&Estimate) -> f64| {
        let count = parts.len() as f64;
        let mean = parts.iter().map(value).sum::<f64>() / count;
        let squares: f64 = parts.iter().map(|part| (value(part) - mean).powi(2)).sum();
        let statistical = STUDENT * ((count - 1.0) / count * squares).sqrt();
        let changes = others
            .iter()
            .map(|other| (value(other) - value(found)).abs());
        statistical.hypot(changes.fold(0.0, f64::max))
    };
    (of(|one| one.decay_s), of(|one| one.total))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    /// The reverberation of a record of `ends_s` seconds whose energy by band falls like `energy(seconds)`.
    fn of_record(ends_s: f64, energy: impl Fn(f64) -> f64) -> Reverb {
        let mut echogram = Echogram::new(1e-3, BATCHES).expect("good numbers");
        let mut bin = 0;
        while (bin as f64) < ends_s * 1e3 {
            let at_s = (bin as f64 + 0.5) * 1e-3;
            let share = energy(at_s) / BATCHES as f64;
            for batch in 0..BATCHES {
                let added = echogram.add(batch, at_s, &[share; BAND_COUNT], DVec3::ZERO);
                added.expect("a good energy");
            }
            bin += 1;
        }
        let mut record = DecayRecord::default();
        let trace = Trace {
            echogram: &echogram,
            waves: 1000,
            ends_s,
            short_s: ends_s,
            direct_s: 0.0,
        };
        record.add(&trace, 0.0);
        record.reverb(&[], &[0.0; BAND_COUNT], &[0.0; BAND_COUNT], 0.0)
    }

    /// Protects decay times and levels of even decays, to 1 % and 0.1 dB, within the record and far beyond it, and the
    /// flag that distinguishes both. The truth is the integral of the decay.
    #[test]
    fn an_even_decay_is_continued() {
        for (decay_s, ends_s, is_beyond) in [(0.5, 0.8, false), (1.2, 0.8, false), (3.0, 0.8, true)]
        {
            let rate = 6.0 * 10_f64.ln() / decay_s;
            let found = of_record(ends_s, |seconds| (-rate * seconds).exp());
            assert!((found.decay_s[3] / decay_s - 1.0).abs() < 0.01, "{found:?}");
            assert_eq!(found.is_extrapolated[3], is_beyond, "{decay_s}");
            let level_db = 20.0 * (found.gain[3] / amplitude(1e3 / rate)).log10();
            assert!(level_db.abs() < 0.1, "{decay_s}: {level_db} dB");
        }
    }

    /// Protects games from false confidence: a decay that becomes slower after the record's end is off by at most twice
    /// the stated error, and a record without any decay states a large error.
    #[test]
    fn errors_contain_what_was_not_traced() {
        let two = |seconds: f64| (-6.9 * seconds).exp() + 0.03 * (-4.6 * seconds).exp();
        let [short, long] = [0.8, 6.0].map(|ends_s| of_record(ends_s, two));
        let off_s = (short.decay_s[0] - long.decay_s[0]).abs();
        assert!(short.is_extrapolated[0] && off_s < 2.0 * short.decay_error_s[0]);
        let even = of_record(0.8, |_| 1.0);
        assert!(even.decay_s[0] >= LONGEST_S && even.decay_error_s[0] >= 0.5 * LONGEST_S);
        assert!(even.gain_error_db[0] > 1.0);
    }
}
