//! Diffracted paths: sound that bends around what hides the source from the listener.
//!
//! # Method
//! Strings are pulled taut from the source to the listener around the solids between them (`string.rs`), in half-planes
//! all around the line between them. Each local shortest string is a path (`bend.rs`). It turns at edges and along curved
//! surfaces (`turn.rs`, `profile.rs`). At an edge the angles of the faces are measured on the distances of the scene
//! (`edge.rs`), and give the exact pressure behind a wedge (`wedge.rs`). Along a curved surface the sound creeps
//! (`round.rs`). Several turns multiply (Pierce, *Diffraction of sound around corners and over wide barriers*, JASA 55,
//! 1974), the ends of faces next to the string count too (`brink.rs`), and the half-planes beside a string show where its
//! edges end and where several strings share a focus (`ring.rs`). The pressures of all paths are added (`ways.rs`). No list
//! of edges is needed, so that everything with a distance bends sound.
//!
//! # Accuracy
//! Root mean square of the errors in octave bands from 63 Hz to 8 kHz down to −35 dB, of places drawn at random (see
//! docs/acoustics.md): wedges 0.02 dB, balls 0.5 dB, endless cylinders 0.5 dB; thick bars 1.0 dB from 125 Hz to 4 kHz.
//!
//! # Deviations
//! The thesis has no diffraction. The faces' angles are measured at the distance to which sound of a wavelength
//! perceives a surface, half a Fresnel zone: a rounding, or a step, that is smaller than that does not count.
//!
//! # Cost
//! Some 1,500 to 4,500 lines of sight, if the source is hidden; one, if it is not.

mod bend;
mod brink;
mod edge;
mod profile;
mod ring;
mod round;
mod space;
mod string;
#[cfg(test)]
mod tests;
mod turn;
mod ways;
mod wedge;

use crate::bands::{BANDS_HZ, Bands};
use crate::geometry::ExactScene;
use bend::Bend;
use glam::DVec3;
use num_complex::Complex64;
use space::Space;
use std::f64::consts::TAU;
use string::HalfPlanes;
use ways::Ways;
use wedge::shadow_function;

/// A path that bends at edges.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct DiffractedPath {
    /// The points at which it bends, in world metres.
    pub points: Vec<DVec3>,
    /// The numbers of the surfaces at these points, from 1.
    pub surfaces: Vec<u32>,
    /// Length in metres.
    pub length_m: f64,
    /// Unit vector in world axes, at the source.
    pub departure: DVec3,
    /// Unit vector of flight in world axes, at the listener.
    pub arrival_direction: DVec3,
    /// Energy density at the listener by band, in 1/m² for a source of power 1, without the loss in the air.
    pub energy: Bands,
}

/// Frequencies in an octave band at which the energy is computed, as factors of its centre.
const IN_BAND: [f64; 3] = [0.793_700_525_984_099_7, 1.0, 1.259_921_049_894_873_2];

/// The share of the energy of the straight front that an obstacle intercepts, by band, if the ways around it are
/// longer than the straight way by `detours_m` metres.
///
/// Each way leaves the part of the front open that a half plane leaves open, ½ erfc(√(−ikδ)) of the pressure for a
/// detour of δ (Fresnel's integral). The obstacle intercepts the rest: a quarter of the energy at an edge, nearly
/// nothing if it is much narrower than a Fresnel zone, and all deep in its shadow.
pub(super) fn intercepted(detours_m: &[f64], speed: f64) -> Bands {
    let pressure = |k: f64| {
        let open = |detour: &f64| {
            let phase = k * detour.max(0.0);
            0.5 * Complex64::cis(phase) * shadow_function(phase.sqrt())
        };
        Complex64::ONE - detours_m.iter().map(open).sum::<Complex64>()
    };
    BANDS_HZ.map(|hertz| {
        let energy = |factor: f64| pressure(TAU * hertz * factor / speed).norm_sqr();
        IN_BAND.map(energy).iter().sum::<f64>() / IN_BAND.len() as f64
    })
}

/// The diffracted paths from a source to a listener in the air that do not see each other; none if they do.
///
/// `coefficients` are the pressure reflection coefficients of a surface, by its number and by band.
pub(super) fn around(
    exact: &ExactScene,
    (source, listener): (DVec3, DVec3),
    speed: f64,
    coefficients: impl Fn(u32) -> Bands,
) -> Vec<DiffractedPath> {
    if exact.is_free(source, listener) {
        return Vec::new();
    }
    let Some(planes) = HalfPlanes::between(source, listener) else {
        return Vec::new();
    };
    let ways = Ways::around(exact, &planes);
    let energies = ways.energies(exact, speed, coefficients);
    let paths = ways.bends.iter().zip(energies);
    paths
        .filter_map(|(way, energy)| DiffractedPath::along(&way.bend, exact, energy))
        .collect()
}

impl DiffractedPath {
    fn along(bend: &Bend, exact: &ExactScene, energy: Bands) -> Option<DiffractedPath> {
        let last = bend.points.len() - 1;
        let points: Vec<DVec3> = bend.turns.iter().map(|turn| turn.middle).collect();
        Some(DiffractedPath {
            surfaces: points.iter().map(|point| exact.nearest(*point)).collect(),
            points,
            length_m: bend.length_m,
            departure: (bend.points[1] - bend.points[0]).try_normalize()?,
            arrival_direction: (bend.points[last] - bend.points[last - 1]).try_normalize()?,
            energy,
        })
    }
}
