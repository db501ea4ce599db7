//! Room acoustic figures by octave band (ISO 3382-1:2009), and their errors from the finite number
//! of waves.

use super::{Echogram, Tap, check_taps};
use crate::bands::BAND_COUNT;
use crate::serialised::finite;
use decay::{Decay, most_tail_share};
use pieces::Piece;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;
use uncertainty::{Halves, Noisy};

mod decay;
mod demand;
mod differences;
#[cfg(any(test, feature = "reference"))]
mod image_sources;
mod pieces;
mod precision;
#[cfg(test)]
mod tests;
mod uncertainty;

#[cfg(test)]
pub(super) use demand::Need;
pub(super) use demand::{Demand, Growth, Parts};
pub(crate) use differences::Differences;
pub(crate) use pieces::Record;
use precision::Arrivals;
pub use precision::Precision;
pub(crate) use precision::Withheld;
pub(crate) use uncertainty::{CommonErrors, uncertain_energy};

/// Distance in metres at which the direct sound in a free field has a strength *G* of 0 dB.
const STRENGTH_DISTANCE_M: f64 = 10.0;

fn decibels(ratio: f64) -> f64 {
    10.0 * ratio.log10()
}

/// Minimum number of arrivals of equal energy ([`Echogram::effective_arrivals`]) after the end of a reported decay.
/// With fewer arrivals, a wave that returns repeatedly, or a single strong wave, may cause a larger error than the
/// batches show: with 50 arrivals, T30 was 5 % off at a stated error of 1.3 % in an uneven room. Without arrivals, the
/// decay would be known only from exact paths, which end at their maximum order.
const LEAST_ARRIVALS: f64 = 500.0;

/// The figures of a band, by ISO 3382-1. `None` if the decay is too short or too noisy, or if the figure is not
/// defined: no decay time without an echo, no clarity without late sound.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
#[non_exhaustive]
pub struct BandFigures {
    /// Early decay time in seconds: six times the decay from 0 dB to −10 dB.
    #[serde(serialize_with = "finite")]
    pub edt_s: Option<f64>,
    /// Reverberation time in seconds from the decay from −5 dB to −25 dB.
    #[serde(serialize_with = "finite")]
    pub t20_s: Option<f64>,
    /// Reverberation time in seconds from the decay from −5 dB to −35 dB.
    #[serde(serialize_with = "finite")]
    pub t30_s: Option<f64>,
    /// Clarity in decibels: energy within 50 ms of the direct sound relative to later energy.
    #[serde(serialize_with = "finite")]
    pub c50_db: Option<f64>,
    /// Clarity in decibels, divided at 80 ms.
    #[serde(serialize_with = "finite")]
    pub c80_db: Option<f64>,
    /// Definition: the share of the energy within 50 ms, 0 … 1.
    #[serde(serialize_with = "finite")]
    pub d50: Option<f64>,
    /// Centre time in seconds after the direct sound.
    #[serde(serialize_with = "finite")]
    pub ts_s: Option<f64>,
    /// Strength in decibels relative to the same source at 10 m in a free field.
    #[serde(serialize_with = "finite")]
    pub g_db: Option<f64>,
}

/// The figures of all bands, with their errors.
///
/// # Method
/// - The time counts from the direct sound. Without direct sound, it counts from the first tap that is less than 20 dB
///   below the strongest tap or bin (ISO 3382-1 takes a response to start 20 dB below its maximum). If 10 % of the
///   energy arrives before this tap, or there are no taps, it counts from the time when 1 % of all energy has arrived.
///   The energy of a bin is spread evenly over the bin, the energy of a tap arrives at one instant.
/// - The decay curve is the backward integral of the energy (M. R. Schroeder, JASA 37, 1965). The energy after the
///   record's end is added as an exponential decay at the rate of the record's last 10 dB (ISO 3382-1, 5.3.3). Without
///   this tail the decay would look too fast. Because the tail is an estimate, a decay counts only if the record ends
///   at least 10 dB below the decay's lower limit (EDT −20 dB, T20 −35 dB, T30 −45 dB), and a sum of energies counts
///   only if at most 1 % of it lies beyond the record. If the second half of the record is not 5 dB below the first,
///   the tail cannot be estimated, and there are no figures.
/// - Decay times are least-squares fits to the curve in decibels, with equal weight at every instant.
///
/// # Errors
/// Figures are not linear in the energies, and decay times jump when a limit moves from one echo to the next. A figure
/// is therefore computed from all batches, and again from orthogonal halves of the batches and the halves' complements
/// (P. J. McCarthy, *Pseudo-replication: half samples*, Review of the International Statistical Institute 37, 1969):
/// with n batches, from 2 (n − 1) halves. The variance of a figure is the mean square difference between the halves'
/// values and the value from all batches. For a sum of energies this is the variance of the batches' mean. For other
/// figures it also includes the curvature and the bias, because a half differs from all waves as much as all waves
/// differ from the truth. Exact taps are in each half, and have no error.
///
/// The variance has n − 1 degrees of freedom. Student's t widens the error by t(97.5 %)/2, so that twice the error
/// contains the truth in 95 % of cases (16 batches: by 6.6 %). If fewer waves arrived than there are batches, counted
/// as waves of equal energy, the number of waves determines the degrees of freedom; a single arrival counts as two. A
/// figure that is missing in one of the halves is not reported, because its decay is too noisy.
///
/// A decay time is reported if its error from the noise of the waves alone is at most 5 % of the decay time, the just
/// noticeable difference. If there are batches, at least 500 waves of equal energy must also arrive after the end of its decay (a few strong waves
/// count for less). EDT is not reported if it is longer than twice the record.
///
/// The error does not include errors common to all waves, such as paths that a wave cannot take. A
/// [`Response`](crate::response::Response) adds the known effects of the listener's size and the effect of one further
/// arrival. In bands with fewer than 64 arrivals the response reports C50, C80 and G only with errors of at most 1 dB,
/// D50 only with at most 0.05 and Ts only with at most 10 ms.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[non_exhaustive]
pub struct Figures {
    /// The figures by band.
    pub bands: [BandFigures; BAND_COUNT],
    /// The errors of the figures, in the same units: one standard deviation. `None` if the figure is missing, and with
    /// fewer than two batches.
    pub errors: [BandFigures; BAND_COUNT],
    /// The share of the energy in the tail after the record; `None` if the tail cannot be estimated.
    pub cut_off: [Option<f64>; BAND_COUNT],
    /// Time origin of the figures: seconds after the source's impulse. `None` if nothing arrived.
    #[serde(serialize_with = "finite")]
    pub begins_s: Option<f64>,
    /// The error of `begins_s`, one standard deviation in seconds: 0 for the direct sound. The errors of the figures
    /// include it. `None` if nothing arrived.
    #[serde(serialize_with = "finite")]
    pub begins_error_s: Option<f64>,
    /// The noise of each figure by band, in the order of [`BandFigures::NAMES`], also where the figure is withheld.
    #[doc(hidden)]
    #[serde(default)]
    pub precision: [[Precision; FIGURE_COUNT]; BAND_COUNT],
}

/// The number of figures in a list for computations.
pub(super) const FIGURE_COUNT: usize = 8;

/// The number of decay times, which come first in a list.
const DECAY_TIMES: usize = 3;

/// Levels in decibels between which decay times are evaluated.
const DECAYS_DB: [(f64, f64); DECAY_TIMES] = [(0.0, -10.0), (-5.0, -25.0), (-5.0, -35.0)];

type List = [Option<f64>; FIGURE_COUNT];

impl BandFigures {
    /// The names of the figures in files, in the order of the list.
    #[doc(hidden)]
    pub const NAMES: [&str; FIGURE_COUNT] = [
        "edt_s", "t20_s", "t30_s", "c50_db", "c80_db", "d50", "ts_s", "g_db",
    ];

    fn from_list(list: List) -> BandFigures {
        let [edt_s, t20_s, t30_s, c50_db, c80_db, d50, ts_s, g_db] = list;
        BandFigures {
            edt_s,
            t20_s,
            t30_s,
            c50_db,
            c80_db,
            d50,
            ts_s,
            g_db,
        }
    }

    /// The figures in the order of their names.
    #[doc(hidden)]
    pub fn list(&self) -> [Option<f64>; FIGURE_COUNT] {
        [
            self.edt_s,
            self.t20_s,
            self.t30_s,
            self.c50_db,
            self.c80_db,
            self.d50,
            self.ts_s,
            self.g_db,
        ]
    }
}

impl Figures {
    /// The strength *G* of an energy density in 1/m² for a source of power 1, in decibels relative to the
    /// same source 10 m away in the open (ISO 3382-1, A.2.1); `None` for silence.
    pub fn strength_db(energy: f64) -> Option<f64> {
        let reference = 1.0 / (4.0 * PI * STRENGTH_DISTANCE_M.powi(2));
        (energy > 0.0).then(|| decibels(energy / reference))
    }

    /// No figures.
    pub(crate) fn omitted() -> Figures {
        Figures {
            bands: Default::default(),
            errors: Default::default(),
            cut_off: [None; BAND_COUNT],
            begins_s: None,
            begins_error_s: None,
            precision: Default::default(),
        }
    }

    /// The figures of the arriving sound. `taps` are exact, and everything else is in `echogram`. The record ends
    /// `ends_s` seconds after the source's impulse. `direct_s` is the arrival time of the direct sound; without direct
    /// sound the times count from the beginning of the other sound (see *Method*). There are no figures if a tap has a
    /// time, an energy or a direction out of range.
    pub fn new(taps: &[Tap], echogram: &Echogram, direct_s: Option<f64>, ends_s: f64) -> Figures {
        let energy = |bin| echogram.energy(bin);
        let are_good = check_taps(taps).is_ok();
        let record = Record::new(taps, echogram, ends_s);
        let start = record.origin(direct_s, energy).filter(|_| are_good);
        let mut figures = Figures {
            begins_s: start.map(|start| start.seconds),
            begins_error_s: start.map(|_| 0.0),
            ..Figures::omitted()
        };
        let Some(start) = start.filter(|start| start.seconds < ends_s && ends_s.is_finite()) else {
            return figures;
        };
        let begins_s = start.seconds;
        let all = record.pieces(begins_s, energy);
        let (lists, decays_end_s, cut_off) = lists(&all, echogram.bin_s());
        let halves = Halves::new(&record, direct_s, Noisy::All);
        let has_batches = echogram.batches() > 1;
        for (band, list) in lists.iter().enumerate() {
            let arrivals = |after_s: f64| echogram.effective_arrivals(band, begins_s + after_s);
            let independent = |after_s: f64| echogram.independent_waves(band, begins_s + after_s);
            let arrivals = Arrivals {
                all: arrivals(0.0),
                after_decays: decays_end_s[band].map(arrivals),
                independent_waves: decays_end_s[band].map(independent),
            };
            let precision = Figures::precision_of(&halves, band, list, &arrivals);
            (figures.bands[band], figures.errors[band]) =
                Figures::reported(&precision, has_batches);
            figures.precision[band] = precision;
        }
        figures.cut_off = cut_off;
        figures.begins_error_s = Some(halves.error_of_start(start));
        match start.within_s > 0.0 {
            true => figures.with_start_within(&record, start.within_s),
            false => figures,
        }
    }
}

/// Ends of the evaluated decays of a band, in seconds after the direct sound.
type DecayEnds = [f64; DECAY_TIMES];

/// The figures of each band, the ends of their decays, and the share of the energy beyond the record.
fn lists(
    pieces: &[Piece],
    bin_s: f64,
) -> (
    [List; BAND_COUNT],
    [DecayEnds; BAND_COUNT],
    [Option<f64>; BAND_COUNT],
) {
    let mut lists = [[None; FIGURE_COUNT]; BAND_COUNT];
    let mut ends_s = [[0.0; DECAY_TIMES]; BAND_COUNT];
    let mut cut_off = [None; BAND_COUNT];
    for band in 0..BAND_COUNT {
        // Bands in which nothing differs, as those of a room with one absorption, have the same figures.
        if let Some(same) = band
            .checked_sub(1)
            .filter(|before| is_equal(pieces, [*before, band]))
        {
            (lists[band], ends_s[band], cut_off[band]) = (lists[same], ends_s[same], cut_off[same]);
            continue;
        }
        let Some(decay) = Decay::new(pieces, band, bin_s) else {
            continue;
        };
        (lists[band], ends_s[band]) = list(&decay);
        cut_off[band] = Some(decay.tail_share());
    }
    (lists, ends_s, cut_off)
}

/// Whether two bands have the same energy in all pieces.
fn is_equal(pieces: &[Piece], [one, other]: [usize; 2]) -> bool {
    let mut all = pieces.iter();
    all.all(|piece| piece.energy[one] == piece.energy[other])
}

impl Figures {
    /// Greatest share of a band's energy beyond the record with which T30 is defined.
    pub(crate) fn most_cut_off() -> f64 {
        let (_, lower_db) = DECAYS_DB[DECAY_TIMES - 1];
        most_tail_share(lower_db)
    }
}

/// The longest EDT, in multiples of the record's length. EDT is six times a decay of 10 dB, and exceeds the record's 60 dB
/// where the direct sound is weak. A record of half its length contains 30 dB of an even decay.
const MOST_EDT: f64 = 2.0;

fn list(decay: &Decay) -> (List, DecayEnds) {
    let clarity_db = |seconds: f64| {
        let (early, late) = decay.parted_at(seconds)?;
        Some(decibels(early / late))
    };
    let total = decay.total();
    let lines = DECAYS_DB.map(|(upper_db, lower_db)| decay.line(upper_db, lower_db));
    let [edt_s, t20_s, t30_s] = lines.map(|line| line.map(|line| line.time_s));
    let list = [
        edt_s.filter(|edt_s| *edt_s <= MOST_EDT * decay.length_s()),
        t20_s,
        t30_s,
        clarity_db(0.05),
        clarity_db(0.08),
        total.map(|total| 1.0 - decay.from(0.05) / total),
        decay.centre_s(),
        total.and_then(Figures::strength_db),
    ];
    (list, lines.map(|line| line.map_or(0.0, |line| line.ends_s)))
}
