//! Sound that arrives at a listener: waves that cross its sphere, and exact taps.

use crate::bands::Bands;
use glam::DVec3;

/// Maximum rate of change of a delay (a source that moves at a fifth of the speed of sound, 250 km/h). If a delay
/// changes faster, the echo fades out at the old delay and in at the new one.
#[cfg(any(feature = "audio", feature = "simulator"))]
pub(crate) const MOST_DOPPLER: f64 = 0.2;

/// One crossing of the listener's sphere by a wave.
///
/// The listener is transparent. A crossing is one sample of the energy density at the listener. Its expected value over
/// the waves is the mean density over the sphere's open volume (M. Vorländer, *Auralization*, 2008, section 11.3:
/// detectors with a volume).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival {
    /// The wave's number.
    pub wave: u32,
    /// Whether the wave was never scattered and has at most as many reflections as exact paths may have. An exact path
    /// replaces such a wave.
    pub is_early: bool,
    /// Number of reflections before the crossing, mirrored and scattered.
    pub reflections: u32,
    /// Length in metres from the source to the middle of the chord through the sphere. The middle is the chord's
    /// closest point to the sphere's centre. For mirrored waves this length equals the length of the path to the centre
    /// up to an error of b² / 2 l (b: distance at which the wave passes the centre, l: metres from the source's image).
    pub length_m: f64,
    /// Direction of flight: a unit vector, world axes.
    pub direction: DVec3,
    /// The contribution of this crossing to the energy density for a source of unit power, times the speed of sound, in
    /// 1/m²: directivity × reflectances × chord ÷ (open volume of the sphere × waves). The directivity is the source's
    /// factor in the wave's start direction. The attenuation in air is not included.
    pub energy: Bands,
    /// The contribution to the energy density in an inner sphere, as a multiple of `energy`: 0 if the wave does not
    /// cross this sphere, and 1 without such a sphere.
    pub(crate) inner: f64,
    /// The index of the sphere among the detectors that share the waves.
    pub(crate) detector: u32,
}

/// Sound that arrives at one instant, known exactly: the direct sound, or an early echo.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tap {
    /// Seconds from the source's impulse.
    pub seconds: f64,
    /// Energy density for a source of unit power, times the speed of sound, in 1/m², with all
    /// losses: 1 / (4π r²) for the direct sound at r metres in still, lossless air.
    pub energy: Bands,
    /// Direction of flight at the listener: a unit vector, world axes.
    pub direction: DVec3,
}
