//! Diffracted paths: sound that bends around what hides the source from the listener.
//!
//! # Method
//! Strings are pulled taut from the source to the listener around the solids between them (`string.rs`), in half-planes
//! all around the line between them. Each local shortest string is a path (`bend`). It turns at edges and along curved
//! surfaces (`turn.rs`, `profile.rs`). At an edge the angles of the faces are measured on the distances of the scene
//! (`edge.rs`), and give the exact pressure behind a wedge (`wedge.rs`). Along a curved surface the sound creeps
//! (`round.rs`). Several turns multiply (Pierce, *Diffraction of sound around corners and over wide barriers*, JASA 55,
//! 1974), the ends of faces next to the string count too (`brink.rs`), and the half-planes beside a string show where its
//! edges end and where several strings share a focus (`ring.rs`). The pressures of all paths are added (`ways.rs`), and each
//! path has a share of the energy (`energies.rs`). No list
//! of edges is needed, so that everything with a distance bends sound.
//!
//! # Accuracy
//! Root mean square of the errors in octave bands from 63 Hz to 8 kHz down to −35 dB, of places drawn at random (see
//! docs/acoustics.md): wedges 0.01 dB, balls 0.4 dB, endless cylinders 0.3 dB; thick bars 0.9 dB from 125 Hz to 4 kHz.
//!
//! # Deviations
//! The thesis has no diffraction. The faces' angles are measured at the distance to which sound of a wavelength
//! perceives a surface, half a Fresnel zone: a rounding, or a step, that is smaller than that does not count.
//!
//! # Cost
//! Some 2,000 to 7,500 lines of sight if the source is hidden: milliseconds on one core. If it is not, some 30 for each
//! half-plane, for the edges beside the way, and further ones around each edge that is found.

mod bend;
mod beyond;
mod brink;
mod completed;
mod curvature;
#[cfg(test)]
mod doorways;
mod edge;
mod energies;
mod errors;
mod face;
mod images;
mod interference;
mod lit;
mod mirrored;
mod narrow;
mod profile;
mod rim;
mod ring;
mod round;
mod samples;
mod space;
mod string;
mod tent;
#[cfg(test)]
mod tests;
mod touch;
mod turn;
mod ways;
mod wedge;

use crate::bands::{BAND_COUNT, Bands};
use crate::geometry::ExactScene;
use bend::Bend;
use face::FaceRim;
pub(super) use face::Reflection;
use glam::DVec3;
use interference::band_mean;
pub(super) use interference::in_samples;
pub(super) use lit::Change;
use lit::Lit;
pub(super) use mirrored::Mirror;
use mirrored::MirroredSpace;
use num_complex::Complex64;
use space::Space;
use string::HalfPlanes;
use ways::Ways;
use wedge::behind_screen;

/// The world positions of source and listener in metres.
pub(super) type Ends = (DVec3, DVec3);

/// A path that bends at edges.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct DiffractedPath {
    /// The points at which it bends or is reflected, in world metres.
    pub points: Vec<DVec3>,
    /// The numbers of the surfaces at these points, from 1.
    pub surfaces: Vec<u32>,
    /// The indices of the points at which it is reflected.
    pub reflections: Vec<usize>,
    /// Length in metres.
    pub length_m: f64,
    /// Unit vector in world axes, at the source.
    pub departure: DVec3,
    /// Unit vector of flight in world axes, at the listener.
    pub arrival_direction: DVec3,
    /// Energy density at the listener by band, in 1/m² for a source of power 1, without the losses in the air and at
    /// reflections.
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
/// `coefficients` are the pressure reflection coefficients of a surface, by its number, at a point, and by band.
///
/// The energies do not change if source and listener change places: the search always begins at the same end.
pub(super) fn around(
    exact: &ExactScene,
    ends: Ends,
    speed: f64,
    coefficients: impl Fn(u32, DVec3) -> Bands,
) -> Vec<DiffractedPath> {
    from_either_end(ends, |ends| {
        let ways = ways_around(exact, ends);
        ways.map_or(Vec::new(), |ways| ways.paths(exact, speed, coefficients))
    })
}

/// The paths that a search from the same end of a pair gives, as paths from the source to the listener.
fn from_either_end(
    ends: Ends,
    search: impl FnOnce(Ends) -> Vec<DiffractedPath>,
) -> Vec<DiffractedPath> {
    let paths = search(in_order(ends));
    match in_order(ends) == ends {
        true => paths,
        false => paths.into_iter().map(DiffractedPath::reversed).collect(),
    }
}

/// The ends of a way, first that at which the search begins: that with the smaller x, or at the same x with the smaller y,
/// or z.
fn in_order((source, listener): Ends) -> Ends {
    match source.to_array() <= listener.to_array() {
        true => (source, listener),
        false => (listener, source),
    }
}

/// The diffracted paths from a source to a listener that are reflected at a plane face; none if its reflection reaches
/// the listener without bending. The energies do not change if source and listener change places.
pub(super) fn around_mirrored(
    exact: &ExactScene,
    mirror: Mirror,
    ends: Ends,
    speed: f64,
    coefficients: impl Fn(u32, DVec3) -> Bands,
) -> Vec<DiffractedPath> {
    let space = MirroredSpace {
        exact,
        mirror,
        has_ends: true,
    };
    from_either_end(ends, |ends| space.around(ends, speed, coefficients))
}

/// The change of the reflection at a plane face by the edges of obstacles beside its way.
pub(super) fn beside_mirrored(
    exact: &ExactScene,
    mirror: Mirror,
    ends: Ends,
    speed: f64,
    coefficients: impl Fn(u32, DVec3) -> Bands,
) -> Change {
    let space = MirroredSpace {
        exact,
        mirror,
        has_ends: false,
    };
    space.beside(in_order(ends), speed, coefficients)
}

/// The energy of a path over reflections at plane faces, relative to endless faces, by band.
pub(super) fn within_faces(exact: &ExactScene, reflections: &[Reflection], speed: f64) -> Bands {
    let rims = reflections.iter().map(|at| FaceRim::about(exact, at));
    let rims: Vec<FaceRim> = rims.filter(|rim| !rim.is_endless()).collect();
    let energy = |k: f64| rims.iter().map(|rim| rim.pressure(k).norm_sqr()).product();
    match rims.is_empty() {
        true => [1.0; BAND_COUNT],
        false => std::array::from_fn(|band| band_mean(band, speed, energy)),
    }
}

/// The ways from a source to a listener around what is between them; `None` if they see each other.
fn ways_around(space: &impl Space, (source, listener): Ends) -> Option<Ways> {
    if space.is_free(source, listener) {
        return None;
    }
    let planes = HalfPlanes::between(source, listener)?;
    let mut ways = Ways::around(space, &planes);
    for off in OFF_THE_EDGE {
        let Some(outwards) = ways.touched() else {
            break;
        };
        let moved = listener - outwards * (off * planes.apart_m());
        let moved = HalfPlanes::between(source, moved).map(|planes| Ways::around(space, &planes));
        // At a body that is thinner than the step the moved listener may see the source.
        ways = moved
            .filter(|moved| !moved.bends.is_empty())
            .unwrap_or(ways);
    }
    Some(ways)
}

/// The change of the direct sound by the edges beside the way from a source to a listener that see each other, with the
/// energy that reflections which end at these edges leave behind.
pub(super) fn beside(
    exact: &ExactScene,
    ends: Ends,
    speed: f64,
    coefficients: impl Fn(u32, DVec3) -> Bands,
) -> Change {
    let lit = Lit::between(exact, in_order(ends));
    lit.map_or(Change::NONE, |lit| lit.change(exact, speed, coefficients))
}

impl DiffractedPath {
    /// The path from the listener to the source.
    fn reversed(mut self) -> DiffractedPath {
        self.points.reverse();
        self.surfaces.reverse();
        let last = self.points.len().saturating_sub(1);
        let reflections = self.reflections.iter().rev();
        DiffractedPath {
            reflections: reflections.map(|point| last - point).collect(),
            departure: -self.arrival_direction,
            arrival_direction: -self.departure,
            ..self
        }
    }

    /// The path with the energy that the plane faces leave which reflect it, and whose normal this is.
    pub fn within_faces(
        mut self,
        exact: &ExactScene,
        normal: DVec3,
        (source, listener): Ends,
        speed: f64,
    ) -> DiffractedPath {
        let points = [&[source], &self.points[..], &[listener]].concat();
        let reflection = |index: &usize| Reflection::on_way(&points, index + 1, normal);
        let reflections = self.reflections.iter().filter_map(reflection);
        let shares = within_faces(exact, &reflections.collect::<Vec<_>>(), speed);
        for (energy, share) in self.energy.iter_mut().zip(shares) {
            *energy *= share;
        }
        self
    }

    /// The path along a bend, without energy.
    fn along(bend: &Bend, space: &impl Space) -> Option<DiffractedPath> {
        let last = bend.points.len() - 1;
        let points: Vec<DVec3> = bend.turns.iter().map(|turn| turn.middle).collect();
        Some(DiffractedPath {
            surfaces: points.iter().map(|point| space.nearest(*point)).collect(),
            points,
            reflections: Vec::new(),
            length_m: bend.length_m,
            departure: (bend.points[1] - bend.points[0]).try_normalize()?,
            arrival_direction: (bend.points[last] - bend.points[last - 1]).try_normalize()?,
            energy: [0.0; BAND_COUNT],
            errors_db: [0.0; BAND_COUNT],
        })
    }
}
