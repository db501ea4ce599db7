//! Energy over time as ordered pieces, which are exact taps and bins; and the time origin of figures.
//!
//! ISO 3382-1 counts from the direct sound, and takes the response to start where it is less than 20 dB below its
//! maximum. Without a direct sound, waves that cross the rim of the listener's sphere may arrive long before the sound
//! at its centre, and the time of the first of these waves depends on the number of waves. Exact paths therefore
//! determine the origin. Without paths a share of the energy determines it.

use crate::bands::{self, BAND_COUNT, Bands};
use crate::response::{Echogram, Tap};

/// Energy that arrives evenly over a time interval, or at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Piece {
    /// Seconds after the direct sound.
    pub(super) begins_s: f64,
    /// End in seconds after the direct sound, not before `begins_s`.
    pub(super) ends_s: f64,
    /// Energy in 1/m².
    pub(super) energy: Bands,
}

/// The recorded sound: exact taps and an echogram, until an end in seconds after the source's impulse.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Record<'a> {
    pub(crate) taps: &'a [Tap],
    pub(crate) echogram: &'a Echogram,
    pub(crate) ends_s: f64,
}

impl<'a> Record<'a> {
    pub(crate) fn new(taps: &'a [Tap], echogram: &'a Echogram, ends_s: f64) -> Record<'a> {
        Record {
            taps,
            echogram,
            ends_s,
        }
    }

    /// All energy that arrives after `begins_s`, as pieces without gaps, in order of time. Earlier energy is added at
    /// the beginning. A tap within a bin splits the bin.
    ///
    /// `energy` returns the energy of a bin.
    pub(super) fn pieces(&self, begins_s: f64, energy: impl Fn(usize) -> Bands) -> Vec<Piece> {
        let length_s = self.ends_s - begins_s;
        let instant = |tap: &Tap| Piece {
            begins_s: (tap.seconds - begins_s).max(0.0),
            ends_s: (tap.seconds - begins_s).max(0.0),
            energy: tap.energy,
        };
        let mut instants: Vec<Piece> = self.taps.iter().map(instant).collect();
        instants.retain(|piece| piece.begins_s <= length_s);
        instants.sort_by(|a, b| a.begins_s.total_cmp(&b.begins_s));
        let mut instants = instants.into_iter().peekable();
        let mut found = Vec::with_capacity(self.echogram.bins() + 2 * instants.len());
        for mut rest in self.bins(begins_s, energy) {
            while let Some(tap) = instants.next_if(|tap| tap.begins_s < rest.ends_s) {
                let (before, after) = parted(rest, tap.begins_s);
                found.extend([before, tap]);
                rest = after;
            }
            found.push(rest);
        }
        found.extend(instants);
        found
    }

    /// The bins as pieces from `begins_s` to the end, and an empty piece after the last bin.
    fn bins(&self, begins_s: f64, energy: impl Fn(usize) -> Bands) -> Vec<Piece> {
        let (echogram, length_s) = (self.echogram, self.ends_s - begins_s);
        let edge = |bin: usize| (echogram.edge_s(bin) - begins_s).clamp(0.0, length_s);
        let piece = |bin: usize| Piece {
            begins_s: edge(bin),
            ends_s: edge(bin + 1),
            energy: energy(bin),
        };
        let begun = (0..echogram.bins()).take_while(|bin| echogram.edge_s(*bin) < self.ends_s);
        let mut found: Vec<Piece> = begun.map(piece).collect();
        found.push(Piece {
            begins_s: found.last().map_or(0.0, |piece| piece.ends_s),
            ends_s: length_s,
            energy: [0.0; BAND_COUNT],
        });
        found
    }

    /// The time origin: the arrival of the direct sound. Without direct sound, the origin is the arrival of the first
    /// exact path that is less than 20 dB below the strongest path or bin. Without such a path, or if 10 % of all
    /// energy arrives before that path, the origin is the time when 1 % of all energy has arrived. `None` if nothing
    /// arrives.
    ///
    /// `energy` returns the energy of a bin. Energies are compared as means over the bands.
    pub(super) fn origin(
        &self,
        direct_s: Option<f64>,
        energy: impl Fn(usize) -> Bands,
    ) -> Option<Origin> {
        let exact = |seconds| Origin {
            seconds,
            within_s: 0.0,
        };
        if let Some(seconds) = direct_s {
            return Some(exact(seconds));
        }
        let pieces = self.pieces(0.0, energy);
        let energies = || pieces.iter().map(|piece| bands::mean(&piece.energy));
        let total: f64 = energies().sum();
        let least = START_SHARE * energies().fold(0.0, f64::max);
        let starts = |piece: &&Piece| {
            let energy = bands::mean(&piece.energy);
            is_instant(piece) && energy > 0.0 && energy >= least
        };
        let first_path = pieces.iter().find(starts);
        let is_first = |path: &&Piece| {
            let before = pieces
                .iter()
                .take_while(|piece| piece.ends_s < path.begins_s);
            let before: f64 = before.map(|piece| bands::mean(&piece.energy)).sum();
            before <= SHARE_BEFORE_PATH * total
        };
        let any = || passes(&pieces, START_SHARE * total, self.echogram.bin_s());
        let path = first_path.filter(is_first);
        path.map(|path| exact(path.begins_s)).or_else(any)
    }
}

/// The parts of a piece before and after a time within it.
fn parted(piece: Piece, at_s: f64) -> (Piece, Piece) {
    let length_s = piece.ends_s - piece.begins_s;
    let share = match length_s > 0.0 {
        true => ((at_s - piece.begins_s) / length_s).clamp(0.0, 1.0),
        false => 1.0,
    };
    let at_s = at_s.clamp(piece.begins_s, piece.ends_s);
    let before = Piece {
        ends_s: at_s,
        energy: piece.energy.map(|energy| energy * share),
        ..piece
    };
    let after = Piece {
        begins_s: at_s,
        energy: piece.energy.map(|energy| energy * (1.0 - share)),
        ..piece
    };
    (before, after)
}

/// 20 dB: the sound starts with the first path that has this share of the largest energy of a path or bin. Without such
/// a path the sound starts when this share of all energy has arrived.
const START_SHARE: f64 = 0.01;

/// Maximum share of all energy (10 dB below the total) that may arrive before the path that is the origin. If more
/// energy arrives before that path, the sound starts earlier.
const SHARE_BEFORE_PATH: f64 = 0.1;

/// The time origin of a response.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Origin {
    /// Seconds after the source's impulse.
    pub seconds: f64,
    /// Length in seconds of the bin within which the origin is interpolated; 0 for an exact path.
    pub within_s: f64,
}

fn is_instant(piece: &Piece) -> bool {
    piece.begins_s == piece.ends_s
}

/// The time at which the sum of the energies of these pieces, in order of time, reaches `least`, within a bin of
/// `bin_s` seconds. `None` if the sum never reaches `least`, or is 0.
fn passes(pieces: &[Piece], least: f64, bin_s: f64) -> Option<Origin> {
    let mut arrived = 0.0;
    for piece in pieces {
        let energy = bands::mean(&piece.energy);
        if energy > 0.0 && arrived + energy >= least {
            let share = ((least - arrived) / energy).clamp(0.0, 1.0);
            return Some(Origin {
                seconds: piece.begins_s + share * (piece.ends_s - piece.begins_s),
                within_s: if is_instant(piece) { 0.0 } else { bin_s },
            });
        }
        arrived += energy;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    const BIN_S: f64 = 1e-3;

    fn tap(seconds: f64, energy: f64) -> Tap {
        Tap {
            seconds,
            energy: [energy; BAND_COUNT],
            direction: DVec3::X,
        }
    }

    fn origin_of(taps: &[Tap], arrivals: &[(f64, f64)], direct_s: Option<f64>) -> Option<Origin> {
        let mut echogram = Echogram::new(BIN_S, 1).expect("a good bin");
        for (seconds, energy) in arrivals {
            echogram
                .add(0, *seconds, &[*energy; BAND_COUNT], DVec3::X)
                .unwrap();
        }
        Record::new(taps, &echogram, 1.0).origin(direct_s, |bin| echogram.energy(bin))
    }

    /// Protects the origin from stray waves: neither the first arrival nor a faint path determines it, and the time of
    /// a path is not rounded to a bin.
    #[test]
    fn a_share_of_the_energy_decides() {
        let exact = |seconds| {
            Some(Origin {
                seconds,
                within_s: 0.0,
            })
        };
        let paths = [tap(0.02, 1e-3), tap(0.0354, 1.0), tap(0.04, 9.0)];
        let stray = [(0.0274, 0.2)];
        assert_eq!(origin_of(&paths, &stray, None), exact(0.0354));
        assert_eq!(origin_of(&paths, &stray, Some(0.01)), exact(0.01));
        assert_eq!(origin_of(&paths, &[], None), exact(0.0354));
        assert_eq!(origin_of(&[], &[], None), None);
    }

    /// Protects scattered sound that arrives before any path: the sound begins when 1 % of all energy has arrived,
    /// interpolated within a bin.
    #[test]
    fn sound_without_paths_begins_with_a_share_of_it() {
        let bins: Vec<(f64, f64)> = (0..50)
            .map(|bin| (0.0305 + f64::from(bin) * BIN_S, 1.0))
            .collect();
        let found = origin_of(&[], &bins, None).expect("an origin");
        assert!((found.seconds - 0.0305).abs() < 1e-9, "{found:?}");
        assert_eq!(found.within_s, BIN_S);
        let late = [tap(0.09, 10.0)];
        let found = origin_of(&late, &bins, None).expect("an origin");
        assert!((found.seconds - 0.0306).abs() < 1e-9, "{found:?}");
    }
}
