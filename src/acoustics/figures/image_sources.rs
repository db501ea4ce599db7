//! The figures of a rectangular room, from its image sources.

use super::{Figures, Tap};
use crate::acoustics::echogram::MAX_BINS;
use crate::acoustics::{AcousticsError, Echogram, MAX_SECONDS};
use crate::reference::{ImageSource, ShoeboxEnergies};
use glam::DVec3;

/// Maximum number of reflections of image sources that are taps; with more the decay is smooth.
const TAPS_ORDER: u32 = 12;

/// Cell lengths in seconds for all further image sources: the shortest with which the record fits into an
/// echogram is used. Each divides 10 ms, so that the limits of clarity are edges.
const CELLS_S: [f64; 4] = [1e-4, 2e-4, 5e-4, 1e-3];

impl Figures {
    /// The exact figures of a rectangular room, for `seconds` after the source's impulse and a speed of sound in metres
    /// a second: image sources of up to twelve reflections are taps, all others are summed in cells of 0.1 ms (up to 1
    /// ms in records of more than 6.5 s). Results for such a room can be compared with them.
    ///
    /// # Errors
    /// [`AcousticsError::BadLength`] for a length that is not above 0 s, or more than
    /// [`MAX_SECONDS`](crate::acoustics::MAX_SECONDS); [`AcousticsError::BadNumber`] for a speed that is not above 0, and
    /// for a room so small that its image sources are too many.
    pub fn of_image_sources(
        room: &ShoeboxEnergies,
        speed_m_per_s: f64,
        seconds: f64,
    ) -> Result<Figures, AcousticsError> {
        if !(speed_m_per_s > 0.0 && speed_m_per_s.is_finite()) {
            return Err(AcousticsError::BadNumber {
                what: "the speed of sound in m/s",
                must: "finite and above 0",
                value: speed_m_per_s,
            });
        }
        let fits = |cell_s: &&f64| seconds > 0.0 && seconds <= **cell_s * MAX_BINS as f64;
        let cell_s = CELLS_S.iter().find(fits).filter(|_| seconds <= MAX_SECONDS);
        let cell_s = *cell_s.ok_or(AcousticsError::BadLength { seconds })?;
        let direct_s = room.direct_m() / speed_m_per_s;
        let tap = |image: &ImageSource| Tap {
            seconds: image.length_m / speed_m_per_s,
            energy: image.energy,
            direction: image.direction,
        };
        // In a small room a long record has more image sources than can be summed.
        let too_many = |_| AcousticsError::BadNumber {
            what: "the length of a record of this room in seconds",
            must: "so short that there are at most 1e12 image sources",
            value: seconds,
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bands::BAND_COUNT;

    /// Protects the decay times of long records that need more cells than an echogram has bins: a longer record gives
    /// the same times.
    #[test]
    fn long_records_are_whole() {
        let size = DVec3::new(30.0, 12.0, 24.0);
        let (source, listener) = (DVec3::new(-8.0, 1.0, 5.0), DVec3::new(9.0, -1.0, -6.0));
        let room = ShoeboxEnergies::new(size, source, listener, &[[0.08; BAND_COUNT]; 6]);
        let room = room.expect("source and listener are in the room");
        let [short, long] = [6.5, 7.0].map(|seconds| {
            let figures = Figures::of_image_sources(&room, 343.0, seconds).expect("of that length");
            figures.bands[0].t30_s.expect("a decay of 45 dB")
        });
        assert!((long / short - 1.0).abs() < 1e-3, "{short} {long}");
        let refused = Figures::of_image_sources(&room, 343.0, 61.0);
        assert_eq!(refused, Err(AcousticsError::BadLength { seconds: 61.0 }));
    }
}
