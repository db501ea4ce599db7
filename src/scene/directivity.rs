//! Directivity of sources: the power that a source radiates in each direction, by octave band.
//!
//! The factor D of a direction is the energy in this direction relative to that of an omnidirectional source with the
//! same power. Its mean over the sphere is 1 in each band, so the directivity does not change the power of a source.
//!
//! - The first-order patterns have the pressure a + (1 − a) cos θ, where θ is the angle from the source's axis. Their
//!   factor is D = (a + (1 − a) cos θ)² / (a² + (1 − a)²/3) (H. F. Olson, *Acoustical Engineering*, 1957). The
//!   supercardioid has the greatest ratio of the energies to the front and to the rear, the hypercardioid the greatest
//!   factor on the axis (G. W. Elko, *Superdirectional microphone arrays*, 2000).
//! - A [`Balloon`] is measured.

pub use crate::hrtf::balloon::{Balloon, BalloonError};

use crate::bands::{self, BAND_COUNT, Bands, PerBand};
use glam::DVec3;
use std::ops::RangeInclusive;
use std::sync::Arc;

/// Range of the omnidirectional share of the pressure.
pub(super) const OMNI_SHARES: RangeInclusive<f64> = 0.0..=1.0;

/// The omnidirectional share of a supercardioid, (√3 − 1)/2.
const SUPERCARDIOID: f64 = 0.366_025_403_784_438_6;

/// The power that a source radiates in each direction, by octave band.
///
/// ```
/// use echomarch::scene::Directivity;
/// use echomarch::glam::DVec3;
///
/// let ahead = Directivity::CARDIOID.factor(DVec3::X);
/// assert!((ahead[4] - 3.0).abs() < 1e-12);
/// assert_eq!(Directivity::CARDIOID.factor(DVec3::NEG_X)[4], 0.0);
/// ```
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub enum Directivity {
    /// The same power in all directions.
    #[default]
    Omnidirectional,
    /// The pressure is a + (1 − a) cos θ, with the omnidirectional share a of each band, 0 to 1, and the angle θ from
    /// the source's axis.
    FirstOrder(Bands),
    /// A measured directivity.
    Balloon(Arc<Balloon>),
}

impl Directivity {
    /// First order with the omnidirectional share 0.7.
    pub const SUBCARDIOID: Directivity = Directivity::FirstOrder([0.7; BAND_COUNT]);
    /// First order with the omnidirectional share 0.5: silent to the rear.
    pub const CARDIOID: Directivity = Directivity::FirstOrder([0.5; BAND_COUNT]);
    /// First order with the omnidirectional share (√3 − 1)/2: the greatest ratio of front to rear.
    pub const SUPERCARDIOID: Directivity = Directivity::FirstOrder([SUPERCARDIOID; BAND_COUNT]);
    /// First order with the omnidirectional share 0.25: the greatest factor on the axis, 4.
    pub const HYPERCARDIOID: Directivity = Directivity::FirstOrder([0.25; BAND_COUNT]);
    /// First order without an omnidirectional share: silent to the sides.
    pub const FIGURE8: Directivity = Directivity::FirstOrder([0.0; BAND_COUNT]);

    /// First order with this omnidirectional share of the pressure, for all bands or for each.
    pub fn first_order(omni_share: impl PerBand) -> Directivity {
        Directivity::FirstOrder(omni_share.per_band())
    }

    /// The energy in a direction by band, relative to an omnidirectional source with the same power. The direction is
    /// in the axes of the source, and has any length: x ahead, y to the left, z up. For a zero vector the factor is 1.
    pub fn factor(&self, direction: DVec3) -> Bands {
        let Some(direction) = direction.try_normalize() else {
            return bands::ALL;
        };
        match self {
            Directivity::Omnidirectional => bands::ALL,
            Directivity::FirstOrder(shares) => shares.map(|share| first_order(share, direction.x)),
            Directivity::Balloon(balloon) => balloon.factor(direction),
        }
    }

    /// The greatest factor of all directions, by band.
    pub fn greatest_factor(&self) -> Bands {
        match self {
            Directivity::Omnidirectional => bands::ALL,
            Directivity::FirstOrder(shares) => shares.map(|share| first_order(share, 1.0)),
            Directivity::Balloon(balloon) => balloon.greatest_factor(),
        }
    }

    /// Whether the factor is 1 in all directions.
    pub fn is_omnidirectional(&self) -> bool {
        match self {
            Directivity::Omnidirectional => true,
            Directivity::FirstOrder(shares) => shares.iter().all(|share| *share == 1.0),
            Directivity::Balloon(_) => false,
        }
    }

    /// Whether all bands have the same factors.
    pub(crate) fn is_grey(&self) -> bool {
        match self {
            Directivity::Omnidirectional => true,
            Directivity::FirstOrder(shares) => *shares == [shares[0]; BAND_COUNT],
            Directivity::Balloon(balloon) => balloon.is_grey(),
        }
    }

    /// The name of the kind in a scene file.
    pub fn kind(&self) -> &'static str {
        match self {
            Directivity::Omnidirectional => "Omnidirectional",
            Directivity::FirstOrder(_) => "FirstOrder",
            Directivity::Balloon(_) => "Balloon",
        }
    }
}

/// Two balloons are equal if they have the same energies, regardless of their files.
impl PartialEq for Directivity {
    fn eq(&self, other: &Directivity) -> bool {
        match (self, other) {
            (Directivity::Omnidirectional, Directivity::Omnidirectional) => true,
            (Directivity::FirstOrder(a), Directivity::FirstOrder(b)) => a == b,
            // Sources are compared in every frame, and a balloon may be large.
            (Directivity::Balloon(a), Directivity::Balloon(b)) => Arc::ptr_eq(a, b) || a == b,
            _ => false,
        }
    }
}

/// The factor of a first-order pattern at an angle from the axis with this cosine.
fn first_order(share: f64, cosine: f64) -> f64 {
    let gradient = 1.0 - share;
    let mean = share * share + gradient * gradient / 3.0;
    (share + gradient * cosine).powi(2) / mean
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::lattice;

    /// All patterns with a name.
    const NAMED: [(Directivity, f64); 5] = [
        (Directivity::SUBCARDIOID, 0.7),
        (Directivity::CARDIOID, 0.5),
        (Directivity::SUPERCARDIOID, SUPERCARDIOID),
        (Directivity::HYPERCARDIOID, 0.25),
        (Directivity::FIGURE8, 0.0),
    ];

    /// Protects the power of a source: the mean of the factors over the sphere is 1 for every pattern.
    #[test]
    fn a_pattern_does_not_change_the_power() {
        const COUNT: u64 = 20_000;
        let mixed = Directivity::first_order([1.0, 0.9, 0.7, 0.5, 0.4, 0.25, 0.1, 0.0]);
        for pattern in NAMED.map(|(pattern, _)| pattern).iter().chain([&mixed]) {
            let factors: Vec<Bands> = lattice(COUNT).map(|d| pattern.factor(d)).collect();
            for sum in bands::sum(&factors) {
                assert!((sum / COUNT as f64 - 1.0).abs() < 1e-6, "{pattern:?}");
            }
        }
    }

    /// Protects the patterns: the amplitudes relative to the axis are a + (1 − a) cos θ, and the named patterns have
    /// their known nulls and factors on the axis.
    #[test]
    fn patterns_have_their_shapes() {
        for (pattern, share) in NAMED {
            for degrees in (0..=180).step_by(15) {
                let (sin, cos) = f64::from(degrees).to_radians().sin_cos();
                for turned in [DVec3::new(cos, sin, 0.0), DVec3::new(cos, 0.0, -sin)] {
                    let relative = pattern.factor(turned * 3.0)[2] / pattern.factor(DVec3::X)[2];
                    let amplitude: f64 = share + (1.0 - share) * cos;
                    assert!((relative - amplitude * amplitude).abs() < 1e-12);
                }
            }
        }
        let on_axis = |pattern: Directivity| pattern.greatest_factor()[0];
        assert!((on_axis(Directivity::CARDIOID) - 3.0).abs() < 1e-12);
        assert!((on_axis(Directivity::HYPERCARDIOID) - 4.0).abs() < 1e-12);
        assert!((on_axis(Directivity::FIGURE8) - 3.0).abs() < 1e-12);
        let null = (-SUPERCARDIOID / (1.0 - SUPERCARDIOID)).acos().to_degrees();
        assert!((null - 125.26).abs() < 0.01, "{null}");
    }
}
