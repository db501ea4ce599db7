//! The figures of a rectangular room by its image sources.

use super::{Figures, Tap};
use crate::acoustics::{AcousticsError, Echogram};
use crate::reference::{ImageSource, ShoeboxEnergies};
use glam::DVec3;

/// Reflections of the image sources that are told one by one; with more the decay is smooth.
const TAPS_ORDER: u32 = 12;

/// Seconds in which all further image sources are added up.
const CELL_S: f64 = 1e-4;

impl Figures {
    /// The exact figures of a rectangular room, for `seconds` after the source's impulse and a speed of sound in metres
    /// a second: image sources of up to twelve reflections one by one, all others in cells of 0.1 ms. What is found of
    /// such a room can be held against them.
    ///
    /// # Errors
    /// As [`Echogram::with_edge_at`]; bins of 0.1 ms and one batch are in its range.
    pub fn of_image_sources(
        room: &ShoeboxEnergies,
        speed_m_per_s: f64,
        seconds: f64,
    ) -> Result<Figures, AcousticsError> {
        let direct_s = room.direct_m() / speed_m_per_s;
        let tap = |image: &ImageSource| Tap {
            seconds: image.length_m / speed_m_per_s,
            energy: image.energy,
            direction: image.direction,
        };
        let taps: Vec<Tap> = room.images(TAPS_ORDER).iter().map(tap).collect();
        let [cell_m, length_m] = [CELL_S, seconds].map(|seconds| seconds * speed_m_per_s);
        let late = room.energies_by_length(cell_m, length_m, Some(TAPS_ORDER));
        let mut echogram = Echogram::with_edge_at(direct_s, CELL_S, 1)?;
        for (cell, energy) in late.energies.iter().enumerate() {
            let seconds = late.middle_m(cell) / speed_m_per_s;
            echogram.add(0, seconds, energy, DVec3::ZERO);
        }
        Ok(Figures::new(&taps, &echogram, Some(direct_s), seconds))
    }
}
