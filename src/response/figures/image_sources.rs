//! The exact figures of a rectangular room, from its image sources.

use super::Figures;
use crate::geometry::{ImageSource, ShoeboxEnergies};
use crate::response::echogram::MAX_BINS;
use crate::response::error::{bad, check_speed};
use crate::response::{Echogram, ImpulseSettings, ResponseError, Tap};
use glam::DVec3;

/// Maximum number of reflections of image sources that become taps. The decay of all further image sources is smooth.
const TAPS_ORDER: u32 = 12;

/// Cell lengths in seconds for all further image sources. The shortest length with which the record fits into an
/// echogram is used. Each length divides 10 ms, so that the limits of clarity are edges.
const CELLS_S: [f64; 4] = [1e-4, 2e-4, 5e-4, 1e-3];

impl Figures {
    /// Computes the exact figures of a rectangular room, for a record of `seconds` after the source's impulse and a
    /// speed of sound in metres per second, as a reference for results in such a room. Image sources of up to twelve
    /// reflections are taps; all others are summed in cells of 0.1 ms (up to 1 ms in records of more than 6.5 s).
    ///
    /// # Errors
    /// [`ResponseError::BadLength`] for a length that is not above 0 s, or more than
    /// [`ImpulseSettings::MAX_SECONDS`](crate::response::ImpulseSettings::MAX_SECONDS); [`ResponseError::BadNumber`]
    /// for a speed that is not above 0, and for a room so small that it has too many image sources.
    pub fn of_image_sources(
        room: &ShoeboxEnergies,
        speed_m_per_s: f64,
        seconds: f64,
    ) -> Result<Figures, ResponseError> {
        check_speed(speed_m_per_s)?;
        let fits = |cell_s: &&f64| seconds > 0.0 && seconds <= **cell_s * MAX_BINS as f64;
        let cell_s = CELLS_S
            .iter()
            .find(fits)
            .filter(|_| seconds <= ImpulseSettings::MAX_SECONDS);
        let cell_s = *cell_s.ok_or(ResponseError::BadLength { seconds })?;
        let direct_s = room.direct_m() / speed_m_per_s;
        let tap = |image: &ImageSource| Tap {
            seconds: image.length_m / speed_m_per_s,
            energy: image.energy,
            direction: image.direction,
        };
        // In a small room a long record has too many image sources to sum.
        let too_many = |_| {
            let must = "so short that there are at most 1e12 image sources";
            bad(
                "the length of a record of this room in seconds",
                must,
                seconds,
            )
        };
        let images = room.images(TAPS_ORDER).map_err(too_many)?;
        let taps: Vec<Tap> = images.iter().map(tap).collect();
        let [cell_m, length_m] = [cell_s, seconds].map(|seconds| seconds * speed_m_per_s);
        let late = room.energies_by_length(cell_m, length_m, Some(TAPS_ORDER));
        let late = late.map_err(too_many)?;
        let mut echogram = Echogram::with_edge_at(direct_s, cell_s, 1)?;
        for (cell, energy) in late.energies.iter().enumerate() {
            let seconds = late.middle_m(cell) / speed_m_per_s;
            echogram.add(0, seconds, energy, DVec3::ZERO)?;
        }
        Ok(Figures::new(&taps, &echogram, Some(direct_s), seconds))
    }
}
