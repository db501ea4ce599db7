//! Diffracted paths: sound that bends around what hides the source from the listener.
//!
//! # Method
//! Strings are pulled taut from the source to the listener around the solids between them (`string.rs`). Each local
//! shortest string is a path. At each of its contacts the line of the edge and the angles of its faces are measured on
//! the distances of the scene (`edge.rs`), and give the exact pressure behind a wedge (`wedge.rs`). Several contacts
//! multiply (Pierce, *Diffraction of sound around corners and over wide barriers*, JASA 55, 1974). No list of edges is
//! needed, so that everything with a distance bends sound.
//!
//! # Limits
//! Round bodies have no edges: a string that touches one gives no path. Several contacts in a row are right to 1 or 2 dB,
//! and only if they are some wavelengths apart.
//!
//! # Deviations
//! The thesis has no diffraction. The faces' angles are measured at the distance to which sound of a wavelength
//! perceives a surface, half a Fresnel zone: a rounding, or a step, that is smaller than that does not count.
//!
//! # Cost
//! Some 600 lines of sight, if the source is hidden; one, if it is not.

mod edge;
mod space;
mod string;
#[cfg(test)]
mod tests;
mod wedge;

use crate::bands::{BAND_COUNT, BANDS_HZ, Bands};
use crate::geometry::ExactScene;
use edge::{Edge, shorten};
use glam::DVec3;
use num_complex::Complex64;
use space::Space;
use std::f64::consts::{PI, TAU};
use string::{HalfPlanes, TautString};
use wedge::{Wedge, shadow_function};

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

/// Turn of the half-plane in radians over which the direction of an edge is measured.
const TURN: f64 = 0.01;

/// Searches for the stationary way over the edges of a string: one is enough for straight edges.
const MOST_SEARCHES: usize = 4;

/// Distance from the surface, as a share of the path's length, up to which a point counts as on it.
const ON_SURFACE: f64 = 1e-5;

/// Distance from an edge at which its faces are measured at most, as a share of the shorter leg.
const MOST_OF_LEG: f64 = 0.7;

/// Distance from a contact at which the normals on either side are compared, as a share of the shorter leg, and the
/// factor of a second, smaller distance: the normals of an edge differ as much there, those of a round body less.
const BESIDE: f64 = 1e-3;
const NEARER: f64 = 0.125;

/// Step of the differences for a normal, as a share of the distance from the contact.
const NORMAL_STEP: f64 = 1e-3;

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
    let mut bends: Vec<Bend> = Vec::new();
    for string in planes.shortest(exact) {
        let Some(bend) = Bend::of(exact, &planes, string) else {
            continue;
        };
        if !bends.iter().any(|other| other.is_same(&bend)) {
            bends.push(bend);
        }
    }
    let paths = bends.iter();
    paths
        .filter_map(|bend| bend.path(exact, speed, &coefficients))
        .collect()
}

/// A taut string over edges.
struct Bend {
    /// Source, contacts, listener.
    points: Vec<DVec3>,
    /// One edge for each contact.
    edges: Vec<Edge>,
}

impl Bend {
    /// Moves the contacts of a string to the stationary way over their edges.
    fn of(space: &impl Space, planes: &HalfPlanes, coarse: TautString) -> Option<Bend> {
        let mut azimuth = coarse.azimuth;
        let mut last = None;
        for _ in 0..MOST_SEARCHES {
            let string = planes.string(space, azimuth)?;
            let edges = edges(space, planes, &string)?;
            let mut points = string.points.clone();
            shorten(&mut points, &edges);
            let bend = Bend { points, edges };
            if !bend.is_sharp(space) {
                return None;
            }
            if bend.is_on_solid(space) {
                return Some(bend.at_contacts());
            }
            // The edge is curved or ends: the search goes on where the straight one had its shortest way.
            azimuth = planes.azimuth_of(bend.points[1]);
            last.get_or_insert(Bend {
                points: string.points,
                edges: bend.edges,
            });
        }
        // The way round a corner, which is not stationary along either edge.
        last.map(Bend::at_contacts)
    }

    fn at_contacts(mut self) -> Bend {
        for (edge, point) in self.edges.iter_mut().zip(&self.points[1..]) {
            edge.point = *point;
        }
        self
    }

    /// Whether all contacts are edges.
    fn is_sharp(&self, space: &impl Space) -> bool {
        self.points.windows(3).all(|legs| {
            let [before, contact, after] = [legs[0], legs[1], legs[2]];
            let beside = BESIDE * before.distance(contact).min(after.distance(contact));
            let turn = |beside: f64| {
                let normal = |towards: DVec3| {
                    let point = contact + (towards - contact).normalize_or_zero() * beside;
                    normal(space, point, NORMAL_STEP * beside)
                };
                normal(before).angle_between(normal(after))
            };
            turn(NEARER * beside) > 0.5 * turn(beside)
        })
    }

    /// Whether all contacts lie on surfaces, and nothing is in the way.
    fn is_on_solid(&self, space: &impl Space) -> bool {
        let error = ON_SURFACE * string::length(&self.points);
        let contacts = &self.points[1..self.points.len() - 1];
        contacts
            .iter()
            .all(|point| space.distance(*point).abs() <= error)
            && self.is_free(space, error)
    }

    /// Whether the legs are free, if each contact is lifted off the solid by `lift` metres.
    fn is_free(&self, space: &impl Space, lift: f64) -> bool {
        let last = self.points.len() - 1;
        let lifted = |index: usize| {
            let point = self.points[index];
            if index == 0 || index == last {
                return point;
            }
            let outwards = (point - self.points[index - 1]).normalize_or_zero()
                + (point - self.points[index + 1]).normalize_or_zero();
            point + outwards.normalize_or_zero() * lift
        };
        (0..last).all(|index| space.is_free(lifted(index), lifted(index + 1)))
    }

    /// Whether two strings have the same contacts.
    fn is_same(&self, other: &Bend) -> bool {
        let near = ON_SURFACE.sqrt() * string::length(&self.points);
        let pairs = self.points.iter().zip(&other.points);
        self.points.len() == other.points.len()
            && pairs.into_iter().all(|(a, b)| a.distance(*b) < near)
    }

    fn path(
        &self,
        exact: &ExactScene,
        speed: f64,
        coefficients: impl Fn(u32) -> Bands,
    ) -> Option<DiffractedPath> {
        let last = self.points.len() - 1;
        let contacts = &self.points[1..last];
        let surfaces: Vec<u32> = contacts.iter().map(|point| exact.nearest(*point)).collect();
        let faces: Vec<Bands> = surfaces
            .iter()
            .map(|surface| coefficients(*surface))
            .collect();
        let length = string::length(&self.points);
        let mut energy = [0.0; BAND_COUNT];
        for (band, energy) in energy.iter_mut().enumerate() {
            let faces: Vec<f64> = faces.iter().map(|face| face[band]).collect();
            for factor in IN_BAND {
                let k = TAU * BANDS_HZ[band] * factor / speed;
                *energy += self.pressure(exact, k, &faces)?.norm_sqr() / IN_BAND.len() as f64;
            }
            *energy /= 4.0 * PI * length * length;
        }
        Some(DiffractedPath {
            points: contacts.to_vec(),
            surfaces,
            length_m: length,
            departure: (self.points[1] - self.points[0]).try_normalize()?,
            arrival_direction: (self.points[last] - self.points[last - 1]).try_normalize()?,
            energy,
        })
    }

    /// Pressure at the listener for the wave number `k`, relative to that of the source in the open at the string's
    /// length.
    fn pressure(&self, space: &impl Space, k: f64, faces: &[f64]) -> Option<Complex64> {
        let mut product = Complex64::ONE;
        for (index, (edge, coefficient)) in self.edges.iter().zip(faces).enumerate() {
            let wedge = self.wedge(space, index, edge, k)?;
            let diffracted = wedge.diffracted(k).sum([*coefficient; 2]);
            product *= diffracted * (wedge.length_m() / wedge.apart_m());
            // On a face between two edges sound and its reflection are one.
            product *= if index > 0 { 0.5 } else { 1.0 };
        }
        Some(product)
    }

    /// The wedge at a contact: its legs are as long as the string on either side, in the directions of the neighbouring
    /// contacts.
    fn wedge(&self, space: &impl Space, index: usize, edge: &Edge, k: f64) -> Option<Wedge> {
        let contact = index + 1;
        let before = string::length(&self.points[..=contact]);
        let after = string::length(&self.points[contact..]);
        let end = |neighbour: usize, length: f64| {
            let towards = (self.points[neighbour] - edge.point).try_normalize()?;
            Some(edge.point + towards * length)
        };
        let ends = [end(contact - 1, before)?, end(contact + 1, after)?];
        let zone = 0.5 * (TAU / k * before * after / (before + after)).sqrt();
        let legs = [contact - 1, contact + 1].map(|other| self.points[other].distance(edge.point));
        let radius = zone.min(MOST_OF_LEG * legs[0].min(legs[1]));
        edge.wedge(space, ends, true, radius)
    }
}

/// Unit normal of the surface nearest to a point, by differences over `step` metres.
fn normal(space: &impl Space, point: DVec3, step: f64) -> DVec3 {
    let slope =
        |axis: DVec3| space.distance(point + axis * step) - space.distance(point - axis * step);
    DVec3::new(slope(DVec3::X), slope(DVec3::Y), slope(DVec3::Z)).normalize_or(DVec3::Y)
}

/// The edges at the contacts of a string, from the string in a half-plane next to its own.
fn edges(space: &impl Space, planes: &HalfPlanes, string: &TautString) -> Option<Vec<Edge>> {
    let contacts = &string.points[1..string.points.len() - 1];
    let beside = |turn: f64| planes.string(space, string.azimuth + turn);
    let other = [TURN, -TURN]
        .into_iter()
        .find_map(|turn| beside(turn).filter(|other| other.points.len() == string.points.len()))?;
    let edge = |(index, point): (usize, &DVec3)| {
        Some(Edge {
            point: *point,
            along: (other.points[index + 1] - point).try_normalize()?,
        })
    };
    contacts.iter().enumerate().map(edge).collect()
}
