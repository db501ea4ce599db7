//! Energy against time as pieces: exact taps and bins, in order.

use crate::acoustics::{Echogram, Tap};
use crate::bands::{BAND_COUNT, Bands};

/// Energy that arrives evenly from one time to another, or at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Piece {
    /// Seconds after the direct sound.
    pub(super) begins_s: f64,
    /// End in seconds after the direct sound, not before `begins_s`.
    pub(super) ends_s: f64,
    /// Energy in 1/m².
    pub(super) energy: Bands,
}

/// Times of a record, in seconds after the source's impulse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Span {
    pub(super) begins_s: f64,
    pub(super) ends_s: f64,
}

/// All energy that arrives within `span`, without gaps, in order of time. Earlier energy counts at
/// its beginning. A tap within a bin splits the bin.
///
/// `energy` returns the energy of a bin.
pub(super) fn pieces(
    taps: &[Tap],
    echogram: &Echogram,
    energy: impl Fn(usize) -> Bands,
    span: Span,
) -> Vec<Piece> {
    let length_s = span.ends_s - span.begins_s;
    let mut instants: Vec<Piece> = taps.iter().map(|tap| instant(tap, span)).collect();
    instants.retain(|piece| piece.begins_s <= length_s);
    instants.sort_by(|a, b| a.begins_s.total_cmp(&b.begins_s));
    let mut instants = instants.into_iter().peekable();
    let mut found = Vec::with_capacity(echogram.bins() + 2 * instants.len());
    for bin in bins(echogram, energy, span) {
        let mut rest = bin;
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

fn instant(tap: &Tap, span: Span) -> Piece {
    let seconds = (tap.seconds - span.begins_s).max(0.0);
    Piece {
        begins_s: seconds,
        ends_s: seconds,
        energy: tap.energy,
    }
}

/// The bins as pieces from the beginning of the span to its end, and an empty piece after the last.
fn bins(echogram: &Echogram, energy: impl Fn(usize) -> Bands, span: Span) -> Vec<Piece> {
    let length_s = span.ends_s - span.begins_s;
    let edge = |bin: usize| {
        let edge_s = echogram.first_s() + bin as f64 * echogram.bin_s() - span.begins_s;
        edge_s.clamp(0.0, length_s)
    };
    let begun = |bin: &usize| echogram.first_s() + *bin as f64 * echogram.bin_s() < span.ends_s;
    let mut found: Vec<Piece> = (0..echogram.bins())
        .take_while(begun)
        .map(|bin| Piece {
            begins_s: edge(bin),
            ends_s: edge(bin + 1),
            energy: energy(bin),
        })
        .collect();
    let last_s = found.last().map_or(0.0, |piece| piece.ends_s);
    found.push(Piece {
        begins_s: last_s,
        ends_s: length_s,
        energy: [0.0; BAND_COUNT],
    });
    found
}

/// The parts of a piece before and after a time in it.
fn parted(piece: Piece, at_s: f64) -> (Piece, Piece) {
    let length_s = piece.ends_s - piece.begins_s;
    let share = if length_s > 0.0 {
        ((at_s - piece.begins_s) / length_s).clamp(0.0, 1.0)
    } else {
        1.0
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
