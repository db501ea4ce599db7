//! Energy over time, by band, in bins.

use super::error::{bad, check, check_speed};
use super::{Arrival, ResponseError};
use crate::bands::{self, BAND_COUNT, BANDS_HZ, Bands};
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::ops::{Range, RangeInclusive};

/// Maximum number of bins: 65 s at 1 ms, 80 MiB with 16 batches. Later arrivals are summed without their times
/// ([`Echogram::beyond`]).
pub(super) const MAX_BINS: usize = 1 << 16;

/// Minimum number of batches whose spread gives a number of independent waves: 16 batches give it to 37 %.
const LEAST_BATCHES: usize = 16;

/// The sound arriving at a listener over time: energy, and energy × direction, by octave band.
///
/// Energies are densities for a source of unit power, times the speed of sound, in 1/m²: the direct sound at r metres
/// has 1 / (4π r²). They are stored for each batch of waves, to estimate the errors of figures
/// ([`Figures`](super::Figures)). All sums are in `f64`, in the order of the additions.
///
/// ```
/// use echomarch::response::Echogram;
/// use echomarch::glam::DVec3;
///
/// // Bins of 1 ms; one batch.
/// let mut echogram = Echogram::new(0.001, 1)?;
/// echogram.add(0, 0.0105, &[0.25; 8], DVec3::X)?;
/// assert_eq!(echogram.bins(), 11);
/// assert_eq!(echogram.total(), [0.25; 8]);
/// # Ok::<(), echomarch::response::ResponseError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(try_from = "EchogramFile")]
pub struct Echogram {
    bin_s: f64,
    first_s: f64,
    batches: usize,
    /// Ordered by bin, and within each bin by batch.
    energies: Vec<Bands>,
    /// Sums of the squares of the added energies by bin, over all batches.
    squares: Vec<Bands>,
    /// Energy × direction of flight by bin and band, summed over all batches.
    flows: Vec<[DVec3; BAND_COUNT]>,
    beyond: Bands,
}

/// An [`Echogram`] as it is read, before its numbers are checked.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct EchogramFile {
    bin_s: f64,
    first_s: f64,
    batches: usize,
    energies: Vec<Bands>,
    squares: Vec<Bands>,
    flows: Vec<[DVec3; BAND_COUNT]>,
    beyond: Bands,
}

impl TryFrom<EchogramFile> for Echogram {
    type Error = ResponseError;

    fn try_from(file: EchogramFile) -> Result<Echogram, ResponseError> {
        let empty = Echogram::new(file.bin_s, file.batches)?;
        let bins = file.flows.len();
        let refused = |what, must, value| Err(ResponseError::BadNumber { what, must, value });
        if bins > MAX_BINS {
            return refused("the number of bins", "at most 65536", bins as f64);
        }
        if file.energies.len() != bins * file.batches || file.squares.len() != bins {
            let entries = file.energies.len() as f64;
            return refused(
                "the number of energies",
                "one for each bin and batch",
                entries,
            );
        }
        if !(0.0..=file.bin_s).contains(&file.first_s) {
            return refused(
                "the start of the first bin in seconds",
                "0 to a bin",
                file.first_s,
            );
        }
        Ok(Echogram {
            first_s: file.first_s,
            energies: file.energies,
            squares: file.squares,
            flows: file.flows,
            beyond: file.beyond,
            ..empty
        })
    }
}

/// One band of one bin, summed over all batches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EchogramRow {
    /// Middle of the bin: seconds from the source's impulse.
    pub time_s: f64,
    /// Centre of the octave band in hertz.
    pub band_hz: f64,
    /// Energy in 1/m².
    pub energy: f64,
    /// Energy × direction of flight in 1/m², world axes: it points away from the origin of the sound, and is as long as
    /// the energy if all sound comes from one direction.
    pub flow: DVec3,
}

impl EchogramRow {
    /// The columns' names in CSV.
    pub const COLUMNS: [&str; 6] = ["time_s", "band_hz", "energy", "x", "y", "z"];

    /// The values in these columns.
    pub fn values(&self) -> [f64; 6] {
        let DVec3 { x, y, z } = self.flow;
        [self.time_s, self.band_hz, self.energy, x, y, z]
    }
}

impl Echogram {
    /// The shortest and the longest time bin in seconds. The shortest bin has a few samples of sound, and the longest
    /// bin still resolves a decay.
    pub const BINS_S: RangeInclusive<f64> = 1e-4..=0.1;

    /// The minimum and maximum number of batches, which must be a power of two: figures are computed from orthogonal
    /// halves of the batches.
    pub const BATCHES: RangeInclusive<usize> = 1..=256;

    /// Creates an empty echogram with bins of `bin_s` seconds, one of which begins at 0 s.
    ///
    /// # Errors
    /// [`ResponseError::BadBin`] unless `bin_s` is in [`Echogram::BINS_S`], [`ResponseError::BadBatches`]
    /// unless `batches` is a power of two in [`Echogram::BATCHES`].
    pub fn new(bin_s: f64, batches: usize) -> Result<Echogram, ResponseError> {
        if !Echogram::BINS_S.contains(&bin_s) {
            return Err(ResponseError::BadBin { bin_s });
        }
        if !Echogram::BATCHES.contains(&batches) || !batches.is_power_of_two() {
            return Err(ResponseError::BadBatches { batches });
        }
        Ok(Echogram {
            bin_s,
            first_s: 0.0,
            batches,
            energies: Vec::new(),
            squares: Vec::new(),
            flows: Vec::new(),
            beyond: [0.0; BAND_COUNT],
        })
    }

    /// Like [`new`](Self::new), with a bin's edge at `edge_s` seconds. If `edge_s` is the arrival time of the direct
    /// sound, and 10 ms is a multiple of `bin_s`, the time limits of C50, C80 and D50 are also edges, and no limit lies
    /// within a bin. No bin begins before 0 s: the first bin begins between 0 s and one bin later, and also contains
    /// earlier arrivals.
    ///
    /// # Errors
    /// The errors of [`new`](Self::new). An edge that is not finite counts as 0 s.
    pub fn with_edge_at(
        edge_s: f64,
        bin_s: f64,
        batches: usize,
    ) -> Result<Echogram, ResponseError> {
        let mut echogram = Echogram::new(bin_s, batches)?;
        if edge_s.is_finite() {
            echogram.first_s = (edge_s - (edge_s / bin_s).floor() * bin_s).clamp(0.0, bin_s);
        }
        Ok(echogram)
    }

    /// Adds energy that arrives `seconds` after the source's impulse, flying along `direction` (a unit vector, world
    /// axes; shorter if the sound comes from several sides). Arrivals before the first bin count in the first bin.
    /// Arrivals beyond 65,536 bins, or at an infinite time, are added to [`beyond`](Self::beyond).
    ///
    /// # Errors
    /// [`ResponseError::NoSuchBatch`]; [`ResponseError::BadNumber`] for a time that is not a number, an energy that is
    /// not 0 to 10⁶⁰, and a direction longer than 1. After an error the echogram is unchanged.
    pub fn add(
        &mut self,
        batch: usize,
        seconds: f64,
        energy: &Bands,
        direction: DVec3,
    ) -> Result<(), ResponseError> {
        let batches = self.batches;
        if batch >= batches {
            return Err(ResponseError::NoSuchBatch { batch, batches });
        }
        if seconds.is_nan() {
            return Err(bad(
                "the time of an arrival in seconds",
                "a number",
                seconds,
            ));
        }
        check(energy, direction)?;
        let place = (seconds - self.first_s) / self.bin_s;
        if place >= MAX_BINS as f64 {
            bands::add(&mut self.beyond, energy);
            return Ok(());
        }
        // A negative index becomes 0.
        let bin = place as usize;
        self.grow(bin + 1);
        bands::add(&mut self.energies[bin * self.batches + batch], energy);
        bands::add(
            &mut self.squares[bin],
            &energy.map(|energy| energy * energy),
        );
        for (flow, energy) in self.flows[bin].iter_mut().zip(energy) {
            *flow += direction * *energy;
        }
        Ok(())
    }

    /// An echogram with the same bins and batches, and no arrivals.
    pub(crate) fn without_arrivals(&self) -> Echogram {
        Echogram {
            energies: Vec::new(),
            squares: Vec::new(),
            flows: Vec::new(),
            beyond: [0.0; BAND_COUNT],
            ..*self
        }
    }

    /// Adds the arrivals of another echogram with the same bins and batches, scaled by `shares` in each band.
    pub(crate) fn add_scaled(&mut self, other: &Echogram, shares: &Bands) {
        debug_assert!(
            (self.first_s, self.bin_s, self.batches) == (other.first_s, other.bin_s, other.batches)
        );
        self.grow(other.bins());
        let scaled = |bands: &Bands| std::array::from_fn(|band| bands[band] * shares[band]);
        let twice_scaled = |bands: &Bands| scaled(&scaled(bands));
        for (own, other) in self.energies.iter_mut().zip(&other.energies) {
            bands::add(own, &scaled(other));
        }
        for (own, other) in self.squares.iter_mut().zip(&other.squares) {
            bands::add(own, &twice_scaled(other));
        }
        for (own, other) in self.flows.iter_mut().zip(&other.flows) {
            for band in 0..BAND_COUNT {
                own[band] += other[band] * shares[band];
            }
        }
        bands::add(&mut self.beyond, &scaled(&other.beyond));
    }

    /// Scales the energies of the bins before `until` by `before`, and those of the later bins by `after`.
    pub(crate) fn scale_parts(&mut self, until: usize, before: f64, after: f64) {
        let factor = |bin: usize| if bin < until { before } else { after };
        for (index, energy) in self.energies.iter_mut().enumerate() {
            let factor = factor(index / self.batches);
            energy.iter_mut().for_each(|energy| *energy *= factor);
        }
        for (bin, (squares, flows)) in self.squares.iter_mut().zip(&mut self.flows).enumerate() {
            let factor = factor(bin);
            squares
                .iter_mut()
                .for_each(|square| *square *= factor.powi(2));
            flows.iter_mut().for_each(|flow| *flow *= factor);
        }
        self.beyond.iter_mut().for_each(|energy| *energy *= after);
    }

    /// Number of bins that end at this time in seconds, or earlier.
    pub(crate) fn bins_before(&self, seconds: f64) -> usize {
        let bins = (seconds - self.first_s) / self.bin_s;
        bins.clamp(0.0, MAX_BINS as f64) as usize
    }

    /// Allocates `bins` bins.
    fn grow(&mut self, bins: usize) {
        if bins <= self.flows.len() {
            return;
        }
        self.flows.resize(bins, [DVec3::ZERO; BAND_COUNT]);
        self.squares.resize(bins, [0.0; BAND_COUNT]);
        self.energies.resize(bins * self.batches, [0.0; BAND_COUNT]);
    }

    /// Adds a wave's crossing of the listener. Its batch is the wave's number modulo the number of batches, its time
    /// the path length divided by the speed of sound. The air attenuates its energy by the factor exp(−`air_per_m` ×
    /// length).
    ///
    /// # Errors
    /// [`ResponseError::BadNumber`] for a speed that is not above 0, and the errors of [`add`](Self::add).
    pub fn add_arrival(
        &mut self,
        arrival: &Arrival,
        speed_m_per_s: f64,
        air_per_m: &Bands,
    ) -> Result<(), ResponseError> {
        check_speed(speed_m_per_s)?;
        let energy = bands::through_air(&arrival.energy, air_per_m, arrival.length_m);
        let seconds = arrival.length_m / speed_m_per_s;
        let batch = arrival.wave as usize % self.batches;
        self.add(batch, seconds, &energy, arrival.direction)
    }

    /// Length of a bin in seconds.
    pub fn bin_s(&self) -> f64 {
        self.bin_s
    }

    /// Beginning of the first bin in seconds: at least 0, and less than the length of a bin.
    pub fn first_s(&self) -> f64 {
        self.first_s
    }

    /// Beginning of a bin in seconds.
    pub(super) fn edge_s(&self, bin: usize) -> f64 {
        self.first_s + bin as f64 * self.bin_s
    }

    /// Number of bins, up to the last bin with an arrival.
    pub fn bins(&self) -> usize {
        self.flows.len()
    }

    /// Number of batches of the waves.
    pub fn batches(&self) -> usize {
        self.batches
    }

    /// The energy of a bin in 1/m², summed over all batches; 0 for other bins.
    pub fn energy(&self, bin: usize) -> Bands {
        bands::sum(self.in_bin(bin))
    }

    /// The energy of a bin in 1/m² from one batch; 0 for other bins and batches.
    pub fn batch_energy(&self, bin: usize, batch: usize) -> Bands {
        let found = self.in_bin(bin).get(batch);
        found.copied().unwrap_or([0.0; BAND_COUNT])
    }

    /// The energy of a bin × direction of flight in 1/m² by band, summed over all batches, world axes.
    pub fn flow(&self, bin: usize) -> [DVec3; BAND_COUNT] {
        let found = self.flows.get(bin);
        found.copied().unwrap_or([DVec3::ZERO; BAND_COUNT])
    }

    /// The sum of the energies of all bins in 1/m².
    pub fn total(&self) -> Bands {
        bands::sum(&self.energies)
    }

    /// Number of arrivals of equal energy whose sum would be as noisy as the arrivals of a band in bins that begin at
    /// `from_s` seconds or later: (Σ e)² / Σ e² (L. Kish, *Survey Sampling*, 1965, section 11.7). 0 without arrivals,
    /// and for a band number out of range.
    pub fn effective_arrivals(&self, band: usize, from_s: f64) -> f64 {
        if band >= BAND_COUNT {
            return 0.0;
        }
        let later = self.bins_from(from_s);
        let in_bin = |bin: usize| -> f64 { self.in_bin(bin).iter().map(|of| of[band]).sum() };
        let sum: f64 = later.clone().map(in_bin).sum();
        let squares = self.squares(band, later);
        if squares > 0.0 {
            sum * sum / squares
        } else {
            0.0
        }
    }

    /// Number of independent waves of equal energy whose sum would be as noisy as the energy of a band in bins that begin
    /// at `from_s` seconds or later: the number of batches times the squared mean of their energies over the variance.
    /// Waves that arrive repeatedly, and copies of a wave, count once. `None` without energy, if all batches are equal,
    /// and with fewer than [`LEAST_BATCHES`] batches.
    pub(super) fn independent_waves(&self, band: usize, from_s: f64) -> Option<f64> {
        let mut energies = vec![0.0; self.batches()];
        for bin in self.bins_from(from_s) {
            for (energy, of) in energies.iter_mut().zip(self.in_bin(bin)) {
                *energy += of[band];
            }
        }
        let batches = energies.len() as f64;
        let mean = energies.iter().sum::<f64>() / batches;
        let squares = energies.iter().map(|energy| (energy - mean).powi(2));
        let variance = squares.sum::<f64>() / (batches - 1.0);
        let is_known = energies.len() >= LEAST_BATCHES && mean > 0.0 && variance > 0.0;
        is_known.then(|| batches * mean * mean / variance)
    }

    /// The bins that begin at `from_s` seconds or later.
    pub(super) fn bins_from(&self, from_s: f64) -> Range<usize> {
        let first = ((from_s - self.first_s) / self.bin_s).ceil().max(0.0) as usize;
        first.min(self.bins())..self.bins()
    }

    /// The sum of the squared energies of a band's arrivals in these bins, in 1/m⁴.
    pub(super) fn squares(&self, band: usize, bins: Range<usize>) -> f64 {
        let known = bins.start.min(self.bins())..bins.end.min(self.bins());
        self.squares[known].iter().map(|bands| bands[band]).sum()
    }

    /// The energy in 1/m² of arrivals after the last bin.
    pub fn beyond(&self) -> Bands {
        self.beyond
    }

    /// The rows of a table, by time and then by band.
    pub fn rows(&self) -> impl Iterator<Item = EchogramRow> + '_ {
        (0..self.bins()).flat_map(move |bin| {
            let (energy, flow) = (self.energy(bin), self.flow(bin));
            let time_s = self.first_s + (bin as f64 + 0.5) * self.bin_s;
            (0..BAND_COUNT).map(move |band| EchogramRow {
                time_s,
                band_hz: BANDS_HZ[band],
                energy: energy[band],
                flow: flow[band],
            })
        })
    }

    /// The energies of a bin by batch; empty for other bins.
    fn in_bin(&self, bin: usize) -> &[Bands] {
        let begins = bin.saturating_mul(self.batches);
        let ends = begins.saturating_add(self.batches);
        self.energies.get(begins..ends).unwrap_or(&[])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AIRLESS: Bands = [0.0; BAND_COUNT];

    fn arrival(wave: u32, length_m: f64) -> Arrival {
        Arrival {
            inner: 1.0,
            detector: 0,
            wave,
            is_early: false,
            reflections: 1,
            length_m,
            direction: DVec3::X,
            energy: std::array::from_fn(|band| (band + 1) as f64),
        }
    }

    /// Protects the assignment of a crossing to its bin and batch, and the sums.
    #[test]
    fn a_crossing_falls_into_its_bin_and_batch() {
        let mut echogram = Echogram::new(1e-3, 4).expect("a good bin");
        echogram
            .add_arrival(&arrival(6, 3.5), 1000.0, &AIRLESS)
            .unwrap();
        echogram
            .add_arrival(&arrival(1, 3.75), 1000.0, &AIRLESS)
            .unwrap();
        echogram
            .add_arrival(&arrival(1, 0.5), 1000.0, &AIRLESS)
            .unwrap();
        assert_eq!((echogram.bins(), echogram.batches()), (4, 4));
        assert_eq!(echogram.batch_energy(3, 2)[0], 1.0);
        assert_eq!(echogram.batch_energy(3, 1)[7], 8.0);
        assert_eq!(echogram.batch_energy(3, 0), [0.0; BAND_COUNT]);
        assert_eq!(echogram.energy(3)[1], 4.0);
        assert_eq!(echogram.flow(3)[1], DVec3::X * 4.0);
        assert_eq!(echogram.total()[2], 9.0);
        assert_eq!(echogram.energy(4), [0.0; BAND_COUNT]);
    }

    /// Protects the number of independent waves: repeated arrivals of a wave count once, also where the number of arrivals
    /// of equal energy is far greater.
    #[test]
    fn repeated_arrivals_of_a_wave_are_one_independent_wave() {
        const BATCHES: usize = 16;
        const EACH: usize = 50;
        let mut random = fastrand::Rng::with_seed(1);
        let mut counts = Vec::new();
        for _ in 0..200 {
            let mut echogram = Echogram::new(1e-3, BATCHES).expect("a good bin");
            for _ in 0..100 {
                let batch = random.usize(..BATCHES);
                for _ in 0..EACH {
                    let seconds = 0.1 * random.f64();
                    echogram
                        .add(batch, seconds, &[1.0; BAND_COUNT], DVec3::X)
                        .unwrap();
                }
            }
            assert!((echogram.effective_arrivals(0, 0.0) - 5000.0).abs() < 1e-6);
            counts.extend(echogram.independent_waves(0, 0.0));
        }
        assert_eq!(counts.len(), 200);
        counts.sort_by(f64::total_cmp);
        assert!((counts[100] / 100.0 - 1.0).abs() < 0.15, "{}", counts[100]);
        let silent = Echogram::new(1e-3, BATCHES).expect("a good bin");
        assert_eq!(silent.independent_waves(0, 0.0), None);
    }

    /// Protects the loss in air: by band, and by the length of the path.
    #[test]
    fn air_takes_its_share() {
        let mut echogram = Echogram::new(1e-3, 1).expect("a good bin");
        let mut air = AIRLESS;
        air[7] = 0.02;
        echogram
            .add_arrival(&arrival(0, 100.0), 343.0, &air)
            .unwrap();
        assert_eq!(echogram.total()[6], 7.0);
        assert!((echogram.total()[7] - 8.0 * (-2.0_f64).exp()).abs() < 1e-12);
    }

    /// Protects bin edges at the direct sound, and times before 0 s.
    #[test]
    fn a_bin_begins_at_the_edge_that_was_asked_for() {
        let mut echogram = Echogram::with_edge_at(0.0123, 1e-3, 1).expect("a good bin");
        assert!((echogram.first_s() - 0.3e-3).abs() < 1e-15);
        let one = [1.0; BAND_COUNT];
        echogram.add(0, 0.0122, &one, DVec3::Y).unwrap();
        echogram.add(0, 0.0124, &one, DVec3::Y).unwrap();
        echogram.add(0, -1.0, &one, DVec3::Y).unwrap();
        let filled: Vec<usize> = (0..20)
            .filter(|&bin| echogram.energy(bin)[0] > 0.0)
            .collect();
        assert_eq!(filled, [0, 11, 12]);
    }

    /// Protects memory from times that are too late for any echogram.
    #[test]
    fn what_is_too_late_has_no_bin() {
        let mut echogram = Echogram::new(1e-3, 1).expect("a good bin");
        let one = [1.0; BAND_COUNT];
        for seconds in [1e9, f64::INFINITY] {
            echogram.add(0, seconds, &one, DVec3::Y).unwrap();
        }
        assert_eq!((echogram.bins(), echogram.beyond()[0]), (0, 2.0));
    }

    /// Protects the effective number of arrivals: arrivals of equal energy count fully, while a strong arrival among
    /// weak arrivals counts as about one.
    #[test]
    fn strong_arrivals_count_for_few() {
        let mut echogram = Echogram::new(1e-3, 4).expect("a good bin");
        for wave in 0..8 {
            echogram
                .add_arrival(&arrival(wave, 100.0 + f64::from(wave)), 1000.0, &AIRLESS)
                .unwrap();
        }
        assert!((echogram.effective_arrivals(3, 0.0) - 8.0).abs() < 1e-12);
        assert!((echogram.effective_arrivals(3, 0.104) - 4.0).abs() < 1e-12);
        assert_eq!(echogram.effective_arrivals(3, 0.2), 0.0);
        assert_eq!(echogram.effective_arrivals(8, 0.0), 0.0);
        echogram
            .add(0, 0.105, &[1e6; BAND_COUNT], DVec3::X)
            .unwrap();
        assert!((echogram.effective_arrivals(3, 0.0) - 1.0).abs() < 1e-3);
    }

    /// Protects the two parts of a record: each is scaled by its own factor, the squares of the energies twice.
    #[test]
    fn the_parts_of_a_record_are_scaled_separately() {
        let mut echogram = Echogram::new(1e-3, 2).expect("a good bin");
        for bin in [1, 4] {
            let seconds = (f64::from(bin) + 0.5) * 1e-3;
            let energy = [4.0; BAND_COUNT];
            echogram.add(1, seconds, &energy, DVec3::X).unwrap();
        }
        let energy = [1.0; BAND_COUNT];
        echogram.add(0, f64::INFINITY, &energy, DVec3::X).unwrap();
        echogram.scale_parts(echogram.bins_before(0.004), 0.5, 0.25);
        let energies = [0, 1, 2, 3, 4].map(|bin| echogram.energy(bin)[0]);
        assert_eq!(energies, [0.0, 2.0, 0.0, 0.0, 1.0]);
        assert_eq!(echogram.flow(1)[7], DVec3::X * 2.0);
        assert_eq!((echogram.squares[1][0], echogram.squares[4][0]), (4.0, 1.0));
        assert_eq!(echogram.beyond()[3], 0.25);
        assert_eq!(
            (echogram.bins_before(-1.0), echogram.bins_before(1e9)),
            (0, MAX_BINS)
        );
    }

    /// Protects the refusal of invalid bins and batches.
    #[test]
    fn bad_numbers_are_refused() {
        for bin_s in [0.0, 1.0, -1e-3, f64::NAN] {
            assert!(Echogram::new(bin_s, 16).is_err());
        }
        for batches in [0, 15, 512] {
            let refused = Echogram::new(1e-3, batches);
            assert_eq!(refused, Err(ResponseError::BadBatches { batches }));
        }
    }

    /// Protects sums and figures from numbers that are not valid energies, times or directions: all are rejected, and
    /// the echogram stays empty.
    #[test]
    fn what_no_sound_has_is_refused() {
        let mut echogram = Echogram::new(1e-3, 4).expect("a good bin");
        let one = [1.0; BAND_COUNT];
        let refused = echogram.add(4, 0.01, &one, DVec3::X);
        let (batch, batches) = (4, 4);
        assert_eq!(refused, Err(ResponseError::NoSuchBatch { batch, batches }));
        assert!(echogram.add(0, f64::NAN, &one, DVec3::X).is_err());
        for value in [-1.0, f64::NAN, f64::INFINITY, 1e200] {
            let mut energy = one;
            energy[7] = value;
            assert!(echogram.add(0, 0.01, &energy, DVec3::X).is_err(), "{value}");
        }
        for direction in [DVec3::splat(f64::NAN), DVec3::X * 2.0] {
            assert!(echogram.add(0, 0.01, &one, direction).is_err());
        }
        for speed in [0.0, -343.0, f64::NAN, f64::INFINITY] {
            let refused = echogram.add_arrival(&arrival(0, 1.0), speed, &AIRLESS);
            assert!(refused.is_err(), "{speed}");
        }
        assert_eq!(echogram, Echogram::new(1e-3, 4).expect("a good bin"));
    }

    /// Protects tables from times before the source's impulse, for direct sounds of any distance.
    #[test]
    fn no_row_has_a_negative_time() {
        for edge_s in [0.0, 0.2e-3, 8.949e-3, 0.0123, -0.4e-3, 1e-3] {
            let mut echogram = Echogram::with_edge_at(edge_s, 1e-3, 1).expect("a good bin");
            let one = [1.0; BAND_COUNT];
            echogram.add(0, 0.0, &one, DVec3::X).unwrap();
            let first = echogram.rows().next().expect("a bin");
            assert!((0.0..=1e-3).contains(&echogram.first_s()), "{edge_s}");
            assert!(first.time_s > 0.0 && first.energy == 1.0, "{edge_s}");
            let bins = (edge_s - echogram.first_s()) / 1e-3;
            assert!((bins - bins.round()).abs() < 1e-9, "{edge_s}");
        }
    }

    /// Protects the columns of the table.
    #[test]
    fn rows_go_by_time_and_band() {
        let mut echogram = Echogram::new(1e-3, 2).expect("a good bin");
        let energy = std::array::from_fn(|band| band as f64);
        echogram.add(1, 1.2e-3, &energy, DVec3::NEG_Z).unwrap();
        let rows: Vec<EchogramRow> = echogram.rows().collect();
        assert_eq!(rows.len(), 16);
        assert_eq!(rows[10].values(), [1.5e-3, 250.0, 2.0, -0.0, -0.0, -2.0]);
    }
}
