//! The decay of one band: backward integration (Schroeder 1965), the tail after the record, and the figures that ISO
//! 3382-1 derives from the decay.

use super::pieces::Piece;
use std::f64::consts::LN_10;

/// The last decay of the record, in decibels, from which the tail is extrapolated, by ISO 3382-1:2009, 5.3.3.
const TAIL_DECAY_DB: f64 = 10.0;

/// Factor by which the tail's window shrinks in each step of the search. The resulting rounding of the window is small
/// compared with the noise of the energies, and about 200 steps lead from a whole record to a bin.
const WINDOW_STEP: f64 = 0.97;

/// Decibels by which the record must end below the lower limit of a decay: ISO 3382-1:2009 requires this distance
/// between that limit and the noise.
const MARGIN_DB: f64 = 10.0;

/// Maximum share of a sum of energies that may lie beyond the record: an error of a fifth in the tail then amounts to
/// 0.01 dB.
const TAIL_SHARE: f64 = 0.01;

/// Minimum length of a decay in bins: a shorter decay depends on the bin, not on the room.
const LEAST_BINS: f64 = 3.0;

/// Nodes and weights of the three-point Gauss–Legendre rule on 0 … 1: exact for polynomials of
/// degree 5.
const GAUSS: [(f64, f64); 3] = [
    (0.112_701_665_379_258_3, 5.0 / 18.0),
    (0.5, 8.0 / 18.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];

/// Maximum share of its energy that the curve loses in a piece whose level is taken as a straight line. The mean level of
/// such a piece is then exact to 0.0005 dB (share² / 24, the next term of the logarithm's series).
const STRAIGHT: f64 = 0.05;

/// The decay curve of one band.
pub(super) struct Decay<'a> {
    pieces: &'a [Piece],
    band: usize,
    /// Energy in 1/m² from the beginning of each piece on, and at the record's end.
    remaining: Vec<f64>,
    tail: Tail,
    bin_s: f64,
}

/// The energy after the record, as an exponential decay.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Tail {
    /// Energy in 1/m².
    energy: f64,
    /// Time in seconds in which the energy falls by a factor of e.
    time_s: f64,
}

/// A line fitted to a part of the curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Line {
    /// Time in seconds of a decay by 60 dB.
    pub(super) time_s: f64,
    /// End of the part, in seconds after the direct sound.
    pub(super) ends_s: f64,
}

const NO_TAIL: Tail = Tail {
    energy: 0.0,
    time_s: 0.0,
};

/// Greatest share of all energy beyond the record for a decay to this level in decibels.
pub(super) fn most_tail_share(lower_db: f64) -> f64 {
    10_f64.powf((lower_db - MARGIN_DB) / 10.0)
}

impl<'a> Decay<'a> {
    /// Creates the decay of a band. `None` without energy, or if the tail cannot be estimated: if the energy of the
    /// record's second half is not 5 dB below that of the first half, the record does not decay by 10 dB.
    pub(super) fn new(pieces: &'a [Piece], band: usize, bin_s: f64) -> Option<Decay<'a>> {
        let mut remaining = vec![0.0; pieces.len() + 1];
        for (index, piece) in pieces.iter().enumerate().rev() {
            remaining[index] = remaining[index + 1] + piece.energy[band];
        }
        let mut decay = Decay {
            pieces,
            band,
            remaining,
            tail: NO_TAIL,
            bin_s,
        };
        if decay.remaining[0] <= 0.0 {
            return None;
        }
        decay.tail = decay.find_tail()?;
        for energy in &mut decay.remaining {
            *energy += decay.tail.energy;
        }
        Some(decay)
    }

    /// Time in seconds from the direct sound to the record's end.
    pub(super) fn length_s(&self) -> f64 {
        self.pieces.last().map_or(0.0, |piece| piece.ends_s)
    }

    /// Estimates the energy after the record. As in ISO 3382-1, it decays at the rate of the last 10 dB of the record.
    /// That rate is found from two adjacent windows of equal length at the end of the record. The length of the windows
    /// is chosen so that their energies differ by 5 dB.
    fn find_tail(&self) -> Option<Tail> {
        let ratio = 10_f64.powf(TAIL_DECAY_DB / 2.0 / 10.0);
        let ends_s = self.length_s();
        let energies = |window_s: f64| {
            let last = self.from(ends_s - window_s);
            (self.from(ends_s - 2.0 * window_s) - last, last)
        };
        let decays = |window_s: f64| {
            let (before, last) = energies(window_s);
            before >= ratio * last
        };
        let mut window_s = ends_s / 2.0;
        if !decays(window_s) {
            return None;
        }
        while window_s * WINDOW_STEP >= self.bin_s && decays(window_s * WINDOW_STEP) {
            window_s *= WINDOW_STEP;
        }
        let (before, last) = energies(window_s);
        if last <= 0.0 {
            return Some(NO_TAIL);
        }
        Some(Tail {
            energy: last * last / (before - last),
            time_s: window_s / (before / last).ln(),
        })
    }

    /// Energy in 1/m² that arrives after a time within the record.
    pub(super) fn from(&self, seconds: f64) -> f64 {
        let after = self.pieces.partition_point(|piece| piece.ends_s < seconds);
        let Some(piece) = self.pieces.get(after) else {
            return self.tail.energy;
        };
        self.within(after, piece, seconds)
    }

    /// Energy in 1/m² that arrives after a time within a piece.
    fn within(&self, index: usize, piece: &Piece, seconds: f64) -> f64 {
        let length_s = piece.ends_s - piece.begins_s;
        if length_s <= 0.0 || seconds <= piece.begins_s {
            return self.remaining[index];
        }
        let share = (seconds - piece.begins_s) / length_s;
        (1.0 - share).mul_add(piece.energy[self.band], self.remaining[index + 1])
    }

    /// All energy in 1/m², including the tail; `None` if too large a share lies beyond the record.
    pub(super) fn total(&self) -> Option<f64> {
        let total = self.remaining[0];
        (self.tail.energy <= TAIL_SHARE * total).then_some(total)
    }

    /// The share of all energy beyond the record.
    pub(super) fn tail_share(&self) -> f64 {
        self.tail.energy / self.remaining[0]
    }

    /// Energies in 1/m² before and after a time. `None` if there is no energy after that time, or if too large a share
    /// of the energy lies beyond the record.
    pub(super) fn parted_at(&self, seconds: f64) -> Option<(f64, f64)> {
        if seconds > self.length_s() {
            return None;
        }
        let late = self.from(seconds);
        let told = late > 0.0 && self.tail.energy <= TAIL_SHARE * late;
        told.then(|| (self.remaining[0] - late, late))
    }

    /// The centre of the energy in seconds after the direct sound.
    pub(super) fn centre_s(&self) -> Option<f64> {
        let total = self.total()?;
        let middle = |piece: &Piece| (piece.begins_s + piece.ends_s) / 2.0;
        let moments = |piece: &Piece| middle(piece) * piece.energy[self.band];
        let tail = self.tail.energy * (self.length_s() + self.tail.time_s);
        Some((self.pieces.iter().map(moments).sum::<f64>() + tail) / total)
    }

    /// The least-squares line through the curve in decibels between two levels (both negative or 0, the upper level
    /// first).
    pub(super) fn line(&self, upper_db: f64, lower_db: f64) -> Option<Line> {
        if self.tail_share() > most_tail_share(lower_db) {
            return None;
        }
        let (begins_s, ends_s) = (self.reaches_s(upper_db)?, self.reaches_s(lower_db)?);
        let length_s = ends_s - begins_s;
        if length_s < LEAST_BINS * self.bin_s {
            return None;
        }
        let middle_s = (begins_s + ends_s) / 2.0;
        let moment = self.level_moment(begins_s, ends_s, middle_s);
        let slope_db_per_s = moment / (length_s.powi(3) / 12.0);
        (slope_db_per_s < 0.0).then(|| Line {
            time_s: -60.0 / slope_db_per_s,
            ends_s,
        })
    }

    /// The first time at which the curve is at or below a level.
    fn reaches_s(&self, level_db: f64) -> Option<f64> {
        if level_db >= 0.0 {
            return Some(0.0);
        }
        let wanted = self.remaining[0] * 10_f64.powf(level_db / 10.0);
        // The curve never rises.
        let next = self.remaining.partition_point(|&energy| energy > wanted);
        let index = next.checked_sub(1)?;
        let piece = self.pieces.get(index)?;
        let share = (self.remaining[index] - wanted) / piece.energy[self.band];
        Some(piece.begins_s + share.clamp(0.0, 1.0) * (piece.ends_s - piece.begins_s))
    }

    /// The integral of level × (time − `middle_s`) between two times, in dB s². `middle_s` is midway, so that the reference
    /// of the level has no influence.
    fn level_moment(&self, begins_s: f64, ends_s: f64, middle_s: f64) -> f64 {
        let first = self
            .pieces
            .partition_point(|piece| piece.ends_s <= begins_s);
        let mut sum = 0.0;
        for (index, piece) in self.pieces.iter().enumerate().skip(first) {
            if piece.begins_s >= ends_s {
                break;
            }
            if piece.begins_s == piece.ends_s {
                continue;
            }
            let (from_s, to_s) = (piece.begins_s.max(begins_s), piece.ends_s.min(ends_s));
            let [first, last] = [from_s, to_s].map(|at_s| self.within(index, piece, at_s));
            if first - last <= STRAIGHT * last {
                let (length_s, centre_s) = (to_s - from_s, (from_s + to_s) / 2.0);
                let energy = (first + last) / 2.0;
                let fall = (first - last) / energy;
                sum += length_s * (energy.ln() * (centre_s - middle_s) - fall * length_s / 12.0);
                continue;
            }
            for (node, weight) in GAUSS {
                let at_s = from_s + node * (to_s - from_s);
                // The natural logarithm takes half the time of the decimal one.
                let level = self.within(index, piece, at_s).ln();
                sum += weight * (to_s - from_s) * level * (at_s - middle_s);
            }
        }
        10.0 / LN_10 * sum
    }
}
