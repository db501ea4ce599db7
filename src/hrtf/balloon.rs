//! Measured directivities: energies in a set of directions, interpolated between them.
//!
//! The amplitude of a direction, which is the root of its energy, is interpolated linearly on the facets between the
//! measured directions, with the weights of `facets.rs`. Next to a null, amplitudes change more evenly than energies
//! do. The energies of each band are then divided by their mean over the sphere.

use super::facet_index::IndexedFacets;
use super::facets::place;
use crate::bands::{self, BAND_COUNT, BANDS_HZ, Bands};
use crate::sampling::lattice;
use glam::{DVec3, I64Vec3};
use rayon::prelude::*;
use std::collections::HashMap;
use std::fmt;

/// Number of directions over which the mean energy is taken. For a directivity with lobes of 10° the error of the mean
/// is below 0.01 %.
const MEAN_DIRECTIONS: u64 = 1 << 16;

/// A measured directivity.
///
/// ```
/// use echomarch::scene::Balloon;
/// use echomarch::glam::DVec3;
///
/// // Twice the energy ahead as behind, measured in six directions.
/// let axes = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
/// let energy = |direction: DVec3| [1.5 + 0.5 * direction.x; 8];
/// let balloon = Balloon::new("horn", axes.map(|axis| (axis, energy(axis))))?;
/// let [ahead, behind] = [DVec3::X, DVec3::NEG_X].map(|axis| balloon.factor(axis)[4]);
/// assert!((ahead / behind - 2.0).abs() < 1e-9);
/// # Ok::<(), echomarch::scene::BalloonError>(())
/// ```
#[derive(Clone)]
pub struct Balloon {
    name: String,
    facets: IndexedFacets,
    /// The root of the factor of each measured direction.
    amplitudes: Vec<Bands>,
}

/// The reason why measurements are not a directivity.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BalloonError {
    /// No direction, or more than [`Balloon::MAX_DIRECTIONS`].
    #[error(
        "{count} measured directions: a directivity must have 1 to {}",
        Balloon::MAX_DIRECTIONS
    )]
    BadCount {
        /// Number of directions.
        count: usize,
    },
    /// A direction that is not a finite vector, or has length zero.
    #[error("measurement {index} has the direction {direction:?}, which must be finite and not 0")]
    BadDirection {
        /// Index of the measurement, from 0.
        index: usize,
        /// The direction.
        direction: DVec3,
    },
    /// An energy that is below 0, or greater than [`Balloon::MAX_ENERGY`].
    #[error(
        "measurement {index} has the energy {energy} at {band_hz} Hz: it must be 0 to {:e}",
        Balloon::MAX_ENERGY
    )]
    BadEnergy {
        /// Index of the measurement, from 0.
        index: usize,
        /// Centre frequency of the octave band, in hertz.
        band_hz: f64,
        /// The energy.
        energy: f64,
    },
    /// No direction has energy in a band, or all energy lies in a lobe that is too narrow for the mean over the sphere.
    #[error("the energy at {band_hz} Hz is 0 in all directions")]
    Silent {
        /// Centre frequency of the octave band, in hertz.
        band_hz: f64,
    },
}

impl Balloon {
    /// Maximum number of directions. The densest measurements have about 20,000.
    pub const MAX_DIRECTIONS: usize = 1 << 16;

    /// Maximum energy of a measurement. The unit of the energies is arbitrary.
    pub const MAX_ENERGY: f64 = 1e60;

    /// Creates a directivity from directions and their energies by band. The directions have any length, and are in the
    /// axes of the source: x ahead, y to the left, z up. The unit of the energies is arbitrary in each band. If several
    /// measurements have the same direction, the mean of their energies is used. The name is that of the SOFA file in
    /// reports and scene files.
    ///
    /// # Errors
    /// [`BalloonError`].
    pub fn new(
        name: impl Into<String>,
        measured: impl IntoIterator<Item = (DVec3, Bands)>,
    ) -> Result<Balloon, BalloonError> {
        let (directions, energies) = merged(measured)?;
        let count = directions.len();
        if !(1..=Balloon::MAX_DIRECTIONS).contains(&count) {
            return Err(BalloonError::BadCount { count });
        }
        let roots = energies.iter().map(|energies| energies.map(f64::sqrt));
        let mut amplitudes: Vec<Bands> = roots.collect();
        // Amplitudes of any unit then have a mean square that is neither 0 nor infinite.
        let unit = greatest(&amplitudes);
        check_heard(&unit)?;
        scale(&mut amplitudes, &unit);
        let mut balloon = Balloon {
            name: name.into(),
            facets: IndexedFacets::new(directions),
            amplitudes,
        };
        let mean = balloon.mean();
        // A lobe that is narrower than the distance between the directions of the mean may be missed.
        check_heard(&mean)?;
        scale(&mut balloon.amplitudes, &mean.map(f64::sqrt));
        Ok(balloon)
    }

    /// Reads a SOFA file (AES69) of the convention FreeFieldDirectivityTF or SimpleFreeFieldHRIR.
    ///
    /// # Errors
    /// [`SofaError`](crate::hrtf::SofaError): the file and the problem with it.
    #[cfg(feature = "sofa")]
    pub fn read_sofa(path: &std::path::Path) -> Result<Balloon, crate::hrtf::SofaError> {
        super::sofa::read_balloon(path)
    }

    /// Name in reports and scene files: the path of a file.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The same directivity with another name.
    pub(crate) fn with_name(&self, name: String) -> Balloon {
        Balloon {
            name,
            ..self.clone()
        }
    }

    /// The measured directions: unit vectors in the axes of the source.
    pub fn directions(&self) -> &[DVec3] {
        self.facets.directions()
    }

    /// The energy in a direction by band, relative to an omnidirectional source with the same power. The direction is
    /// in the axes of the source, and has any length. For a zero vector the factor is 1.
    pub fn factor(&self, direction: DVec3) -> Bands {
        let Some(direction) = direction.try_normalize() else {
            return bands::ALL;
        };
        let mut sum = [0.0; BAND_COUNT];
        for (index, weight) in self.facets.around(direction) {
            // Unused entries have the weight 0, and may have any index.
            if weight > 0.0 {
                let own = self.amplitudes[index].map(|amplitude| weight * amplitude);
                bands::add(&mut sum, &own);
            }
        }
        sum.map(|amplitude| amplitude * amplitude)
    }

    /// The greatest factor of all directions, by band.
    pub(crate) fn greatest_factor(&self) -> Bands {
        greatest(&self.amplitudes).map(|amplitude| amplitude * amplitude)
    }

    /// Whether all bands have the same factors.
    pub(crate) fn is_grey(&self) -> bool {
        let is_grey = |of: &Bands| *of == [of[0]; BAND_COUNT];
        self.amplitudes.iter().all(is_grey)
    }

    /// The directions and the roots of their factors, as little-endian `f64`.
    pub(crate) fn to_bytes(&self) -> Vec<u8> {
        let directions = self.directions().iter().flat_map(|d| d.to_array());
        let amplitudes = self.amplitudes.iter().flatten().copied();
        directions
            .chain(amplitudes)
            .flat_map(f64::to_le_bytes)
            .collect()
    }

    /// The mean over the sphere, by band.
    fn mean(&self) -> Bands {
        let directions: Vec<DVec3> = lattice(MEAN_DIRECTIONS).collect();
        let factors: Vec<Bands> = directions.par_iter().map(|d| self.factor(*d)).collect();
        bands::sum(&factors).map(|sum| sum / MEAN_DIRECTIONS as f64)
    }
}

/// Balloons with the same energies are equal. Their names may differ, because scenes in different folders name the same
/// file differently.
impl PartialEq for Balloon {
    fn eq(&self, other: &Balloon) -> bool {
        self.amplitudes == other.amplitudes && self.directions() == other.directions()
    }
}

/// Omits the energies.
impl fmt::Debug for Balloon {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Balloon")
            .field("name", &self.name)
            .field("directions", &self.directions().len())
            .finish_non_exhaustive()
    }
}

/// The distinct directions as unit vectors, in order, and the mean energies of their measurements.
fn merged(
    measured: impl IntoIterator<Item = (DVec3, Bands)>,
) -> Result<(Vec<DVec3>, Vec<Bands>), BalloonError> {
    let mut known: HashMap<I64Vec3, usize> = HashMap::new();
    let (mut directions, mut sums, mut counts) = (Vec::new(), Vec::new(), Vec::new());
    for (index, (direction, energies)) in measured.into_iter().enumerate() {
        check(index, &energies)?;
        let Some(unit) = direction.try_normalize() else {
            return Err(BalloonError::BadDirection { index, direction });
        };
        let at = *known.entry(place(unit)).or_insert(directions.len());
        if at == directions.len() {
            directions.push(unit);
            sums.push([0.0; BAND_COUNT]);
            counts.push(0.0);
        }
        bands::add(&mut sums[at], &energies);
        counts[at] += 1.0;
    }
    let means = sums.iter().zip(&counts);
    let means = means.map(|(sum, count): (&Bands, &f64)| sum.map(|sum| sum / count));
    Ok((directions, means.collect()))
}

fn check(index: usize, energies: &Bands) -> Result<(), BalloonError> {
    let range = 0.0..=Balloon::MAX_ENERGY;
    let band = energies.iter().position(|energy| !range.contains(energy));
    band.map_or(Ok(()), |band| {
        Err(BalloonError::BadEnergy {
            index,
            band_hz: BANDS_HZ[band],
            energy: energies[band],
        })
    })
}

/// Rejects a band whose greatest or mean energy is 0.
fn check_heard(bands: &Bands) -> Result<(), BalloonError> {
    match bands.iter().position(|number| *number == 0.0) {
        None => Ok(()),
        Some(band) => Err(BalloonError::Silent {
            band_hz: BANDS_HZ[band],
        }),
    }
}

fn greatest(amplitudes: &[Bands]) -> Bands {
    std::array::from_fn(|band| amplitudes.iter().map(|all| all[band]).fold(0.0, f64::max))
}

/// Divides all amplitudes by `unit`, which is above 0.
fn scale(amplitudes: &mut [Bands], unit: &Bands) {
    for amplitudes in amplitudes {
        *amplitudes = std::array::from_fn(|band| amplitudes[band] / unit[band]);
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::grid;
    use super::*;
    use crate::scene::Directivity;

    fn sampled(directions: Vec<DVec3>, pattern: &Directivity, unit: f64) -> Balloon {
        let energy = |d: DVec3| (d, pattern.factor(d).map(|factor| unit * factor));
        Balloon::new("sampled", directions.into_iter().map(energy)).expect("a good balloon")
    }

    /// Protects levels against direction: a balloon measured every 5° has the levels of the pattern within 0.1 dB, down
    /// to 20 dB below the axis, in any unit of the file.
    #[test]
    fn a_balloon_has_the_levels_of_its_source() {
        let pattern = Directivity::first_order([1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.25, 0.0]);
        for unit in [1.0, 1e-30, 1e30] {
            let balloon = sampled(grid(5), &pattern, unit);
            let greatest = pattern.greatest_factor();
            for direction in lattice(3000) {
                let (found, expected) = (balloon.factor(direction), pattern.factor(direction));
                for band in (0..BAND_COUNT).filter(|b| expected[*b] > 0.01 * greatest[*b]) {
                    let error_db = 10.0 * (found[band] / expected[band]).log10();
                    assert!(error_db.abs() < 0.1, "{direction}, {band}: {error_db} dB");
                }
            }
        }
    }

    /// Protects the power: the mean over the sphere is 1 in each band, for coarse and incomplete measurements too.
    #[test]
    fn a_balloon_does_not_change_the_power() {
        const COUNT: u64 = 30_011;
        let half = grid(15).into_iter().filter(|d| d.x > -0.01).collect();
        for directions in [grid(10), grid(45), half, vec![DVec3::Z]] {
            let balloon = sampled(directions, &Directivity::SUBCARDIOID, 7.0);
            let factors: Vec<Bands> = lattice(COUNT).map(|d| balloon.factor(d)).collect();
            for sum in bands::sum(&factors) {
                assert!((sum / COUNT as f64 - 1.0).abs() < 1e-3);
            }
        }
    }

    /// Protects repeated measurements, such as notes of an instrument: the mean of their energies is used.
    #[test]
    fn measurements_of_a_direction_are_averaged() {
        let energies = [(DVec3::X, 1.0), (DVec3::NEG_X, 2.0), (DVec3::X * 9.0, 5.0)];
        let measured = energies.map(|(direction, energy)| (direction, [energy; BAND_COUNT]));
        let balloon = Balloon::new("notes", measured).expect("a good balloon");
        assert_eq!(balloon.directions().len(), 2);
        let ratio = balloon.factor(DVec3::X)[3] / balloon.factor(DVec3::NEG_X)[3];
        assert!((ratio - 1.5).abs() < 1e-12, "{ratio}");
    }

    /// Protects callers from balloons without a direction, with impossible numbers, or with a silent band.
    #[test]
    fn bad_measurements_are_refused() {
        let one = [1.0; BAND_COUNT];
        let of = |measured: Vec<(DVec3, Bands)>| Balloon::new("bad", measured).unwrap_err();
        assert_eq!(of(Vec::new()), BalloonError::BadCount { count: 0 });
        for direction in [DVec3::ZERO, DVec3::NAN, DVec3::X * f64::INFINITY] {
            let refused = of(vec![(DVec3::X, one), (direction, one)]);
            assert!(matches!(
                refused,
                BalloonError::BadDirection { index: 1, .. }
            ));
        }
        for energy in [-1.0, f64::NAN, f64::INFINITY, 1e61] {
            let mut energies = one;
            energies[2] = energy;
            let said = of(vec![(DVec3::X, energies)]).to_string();
            assert!(said.contains("at 250 Hz"), "{said}");
        }
        let mut energies = one;
        energies[7] = 0.0;
        let refused = of(vec![(DVec3::X, energies)]);
        assert_eq!(refused, BalloonError::Silent { band_hz: 8e3 });
    }
}
