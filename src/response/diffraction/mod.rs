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
//! Some 1,500 to 4,500 lines of sight if the source is hidden. If it is not, some 30 for each half-plane, for the edges beside
//! the way.

mod bend;
mod brink;
mod edge;
mod interference;
mod profile;
mod rim;
mod ring;
mod round;
mod space;
mod string;
#[cfg(test)]
mod tests;
mod turn;
mod ways;
mod wedge;

use crate::bands::{BAND_COUNT, Bands};
use crate::geometry::ExactScene;
use bend::Bend;
use glam::DVec3;
use interference::{Sound, band_mean};
use num_complex::Complex64;
use rim::Rim;
use space::Space;
use string::HalfPlanes;
use ways::Ways;
use wedge::behind_screen;

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
    /// Half-widths in decibels of the intervals that contain 95 % of the errors of the energies.
    pub errors_db: Bands,
}

/// Distances by which the listener is moved if an edge lies on the line from the source, as shares of the distance between
/// both: at the first, which is enough but at very thin plates, levels change by less than 0.01 dB.
const OFF_THE_EDGE: [f64; 3] = [1e-4, 1e-3, 1e-2];

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
            Complex64::cis(phase) * behind_screen(phase)
        };
        Complex64::ONE - detours_m.iter().map(open).sum::<Complex64>()
    };
    std::array::from_fn(|band| band_mean(band, speed, |k| pressure(k).norm_sqr()))
}

/// The diffracted paths from a source to a listener in the air that do not see each other; none if they do.
///
/// `coefficients` are the pressure reflection coefficients of a surface, by its number and by band.
///
/// The energies do not change if source and listener change places: the search always begins at the same end.
pub(super) fn around(
    exact: &ExactScene,
    (source, listener): (DVec3, DVec3),
    speed: f64,
    coefficients: impl Fn(u32) -> Bands,
) -> Vec<DiffractedPath> {
    if is_in_order(source, listener) {
        return around_from(exact, (source, listener), speed, coefficients);
    }
    let paths = around_from(exact, (listener, source), speed, coefficients);
    paths.into_iter().map(DiffractedPath::reversed).collect()
}

/// Whether the first of two points is the one at which a search begins: that with the smaller x, or at the same x with the
/// smaller y, or z.
fn is_in_order(a: DVec3, b: DVec3) -> bool {
    a.to_array() <= b.to_array()
}

fn around_from(
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
    let mut ways = Ways::around(exact, &planes);
    for off in OFF_THE_EDGE {
        let Some(outwards) = ways.touched() else {
            break;
        };
        let moved = listener - outwards * (off * planes.apart_m());
        let moved = HalfPlanes::between(source, moved).map(|planes| Ways::around(exact, &planes));
        // At a body that is thinner than the step the moved listener may see the source.
        ways = moved
            .filter(|moved| !moved.bends.is_empty())
            .unwrap_or(ways);
    }
    let energies = ways.energies(exact, speed, coefficients);
    let errors_db = ways.errors_db();
    let paths = ways.bends.iter().zip(energies);
    paths
        .filter_map(|(way, energy)| DiffractedPath::along(&way.bend, exact, (energy, errors_db)))
        .collect()
}

/// The energy of the direct sound, relative to that in the open, by band, with the edges beside the way from a source to
/// a listener that see each other, and the energy that reflections which end at these edges leave behind.
pub(super) fn beside(
    exact: &ExactScene,
    (source, listener): (DVec3, DVec3),
    speed: f64,
    coefficients: impl Fn(u32) -> Bands,
) -> Bands {
    let (source, listener) = match is_in_order(source, listener) {
        true => (source, listener),
        false => (listener, source),
    };
    let Some(planes) = HalfPlanes::between(source, listener) else {
        return [1.0; BAND_COUNT];
    };
    let mut rims = Rim::all(exact, &planes, &[]);
    if let Some(touched) = rims.iter().find(|rim| rim.touches_the_straight_way()) {
        // The half-planes of an edge on the line between source and listener are not defined.
        let moved = listener + touched.inwards() * (OFF_THE_EDGE[0] * planes.apart_m());
        let planes = HalfPlanes::between(source, moved);
        rims = planes.map_or(Vec::new(), |planes| Rim::all(exact, &planes, &[]));
    }
    let faces: Vec<Bands> = rims
        .iter()
        .map(|rim| coefficients(exact.nearest(rim.point())))
        .collect();
    std::array::from_fn(|band| {
        band_mean(band, speed, |k| {
            let mut sounds = vec![Sound {
                pressure: Complex64::ONE,
                length_m: planes.apart_m(),
            }];
            let mut reflected = 0.0;
            for (rim, face) in rims.iter().zip(&faces) {
                let Some(added) = rim.added(exact, k, face[band]) else {
                    continue;
                };
                reflected += added.reflected.norm_sqr();
                sounds.push(Sound {
                    pressure: added.direct,
                    length_m: rim.length_m,
                });
            }
            interference::energy(&sounds, k) + reflected
        })
    })
}

impl DiffractedPath {
    /// The path from the listener to the source.
    fn reversed(mut self) -> DiffractedPath {
        self.points.reverse();
        self.surfaces.reverse();
        DiffractedPath {
            departure: -self.arrival_direction,
            arrival_direction: -self.departure,
            ..self
        }
    }

    fn along(
        bend: &Bend,
        exact: &ExactScene,
        (energy, errors_db): (Bands, Bands),
    ) -> Option<DiffractedPath> {
        let last = bend.points.len() - 1;
        let points: Vec<DVec3> = bend.turns.iter().map(|turn| turn.middle).collect();
        Some(DiffractedPath {
            surfaces: points.iter().map(|point| exact.nearest(*point)).collect(),
            points,
            length_m: bend.length_m,
            departure: (bend.points[1] - bend.points[0]).try_normalize()?,
            arrival_direction: (bend.points[last] - bend.points[last - 1]).try_normalize()?,
            energy,
            errors_db,
        })
    }
}
