//! How much sound passes through the solid of a material.

use crate::bands::{Bands, PerBand};
use std::ops::RangeInclusive;

/// Valid sound reduction indices in decibels: 200 dB is more than the range from the threshold of hearing to the
/// threshold of pain.
pub(crate) const REDUCTIONS_DB: RangeInclusive<f64> = 0.0..=200.0;

/// Valid thicknesses in metres to which a sound reduction index belongs: from a foil to a dam.
pub(crate) const THICKNESSES_M: RangeInclusive<f64> = 1e-5..=100.0;

/// Valid densities in kg/m³: from about that of air to above that of osmium (22,590 kg/m³), the densest element.
pub(crate) const DENSITIES: RangeInclusive<f64> = 1.0..=25_000.0;

/// Valid products of thickness and critical frequency in m·Hz. Published values are 12 (aluminium) to 55 (lead).
pub(crate) const COINCIDENCES: RangeInclusive<f64> = 1.0..=1000.0;

/// The sound that passes through the solid of a material, from the air before it to the air behind it.
///
/// ```
/// use echomarch::scene::{Material, Transmission};
/// let brickwork = Material::absorbing(0.03).transmitting(Transmission::of_density(1800.0));
/// // A partition with a measured index: 35 dB in every band, 0.1 m thick.
/// let partition = Material::absorbing(0.1).transmitting(Transmission::reduced_by(35.0, 0.1));
/// assert_ne!(brickwork.transmission, partition.transmission);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Transmission {
    /// A sound reduction index, measured or from a data sheet.
    Reduction {
        /// Sound reduction index R in decibels by octave band, 0 to 200.
        index_db: Bands,
        /// Thickness in metres to which the index belongs, 1e-5 to 100. A solid of another thickness has an index that
        /// differs by 20 lg(thickness / `thickness_m`) dB.
        thickness_m: f64,
    },
    /// The index follows from the mass per area, which is density times thickness.
    Mass {
        /// Density in kg/m³, 1 to 25,000.
        density: f64,
        /// Product of thickness and critical frequency in m·Hz, 1 to 1000. `None` for a solid without coincidence.
        coincidence: Option<f64>,
    },
}

impl Transmission {
    /// The transmission of a solid of `thickness_m` metres with a sound reduction index of `index_db` decibels, given
    /// as one number for all bands or one number per band.
    pub fn reduced_by(index_db: impl PerBand, thickness_m: f64) -> Transmission {
        Transmission::Reduction {
            index_db: index_db.per_band(),
            thickness_m,
        }
    }

    /// The transmission of a solid of `density` kg/m³, without coincidence.
    pub fn of_density(density: f64) -> Transmission {
        Transmission::Mass {
            density,
            coincidence: None,
        }
    }

    /// The first number that is out of range: its name, the range and the number.
    pub(super) fn bad_number(&self) -> Option<(&'static str, &'static str, f64)> {
        let (first, second) = match *self {
            Transmission::Reduction {
                index_db,
                thickness_m,
            } => {
                let is_bad = |index: &f64| !REDUCTIONS_DB.contains(index);
                let index = index_db.into_iter().find(is_bad);
                (
                    index.map(|index| ("reduction in decibels", "0 to 200", index)),
                    bad(thickness_m, &THICKNESSES_M)
                        .map(|metres| ("thickness in metres", "0.00001 to 100", metres)),
                )
            }
            Transmission::Mass {
                density,
                coincidence,
            } => (
                bad(density, &DENSITIES).map(|density| ("density in kg/m³", "1 to 25000", density)),
                coincidence
                    .and_then(|product| bad(product, &COINCIDENCES))
                    .map(|product| ("coincidence in m·Hz", "1 to 1000", product)),
            ),
        };
        first.or(second)
    }
}

/// The number, if it is out of range.
fn bad(value: f64, range: &RangeInclusive<f64>) -> Option<f64> {
    (!range.contains(&value)).then_some(value)
}
