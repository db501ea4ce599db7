//! Errors of the energies along ways around obstacles.

use super::bend::Bend;
use crate::bands::{BAND_COUNT, Bands};

/// Half-widths in decibels, by band, of the intervals that contain 95 % of the errors of levels, measured on places drawn
/// at random: behind a straight edge; behind 600 balls and 40 cylinders; over two edges, against the boundary-element
/// values of bars; and where a second obstacle is beyond the first, against those of a doorway (`tests/diffraction`).
const EDGE_ERRORS_DB: Bands = [0.1; BAND_COUNT];
const ROUND_ERRORS_DB: Bands = [1.6, 1.1, 0.8, 0.7, 0.7, 0.7, 0.6, 0.5];
pub(super) const TWO_EDGES_ERRORS_DB: Bands = [4.0, 3.5, 2.0, 1.5, 1.5, 1.7, 2.0, 2.5];
pub(super) const GAP_ERRORS_DB: Bands = [4.0, 4.0, 2.0, 2.5, 4.5, 6.0, 10.0, 10.0];

/// Half-widths in decibels of the intervals that contain 95 % of the errors of the energy of one way, by band.
pub(super) fn errors_of_bend_db(bend: &Bend) -> Bands {
    match (bend.turns.len(), bend.is_plain()) {
        (1, true) => EDGE_ERRORS_DB,
        (1, false) if bend.turns[0].arc_m > 0.0 => ROUND_ERRORS_DB,
        _ => TWO_EDGES_ERRORS_DB,
    }
}
