//! The ends of a plane face that reflects: a face that is small beside the wavelength reflects less.
//!
//! # Theory
//! The face is an opening in a screen between the image of the source and the listener: what is beside it does not
//! reflect. The pressure behind an opening is the free one, less a wave from its rim (Kirchhoff's integral as Maggi and
//! Rubinowicz transform it, Born and Wolf, *Principles of Optics*, section 8.9). In half-planes at the azimuth φ about the
//! line from the image to the listener, with the detour δ over the rim,
//!
//! ```text
//! p = 1 − 1/2π ∫ exp(ikδ(φ)) dφ
//! ```
//!
//! relative to an endless face: a half at a straight end of the face, and 0 for a narrow face between two ends.
//!
//! # Deviations
//! The angle to the next face does not count, unless it is so flat that the face goes on. A gap in a face counts as its
//! end.

use super::mirrored::on_face_m;
use super::ring::{self, Detours, Samples, all_samples};
use super::tent::bisect;
use crate::geometry::ExactScene;
use glam::DVec3;
use num_complex::Complex64;

/// Distance from the reflection at which the search for the end of a face begins, as a share of the shorter leg.
const FIRST: f64 = 0.02;
/// Factor between distances that are tried.
const LONGER: f64 = 1.5;
/// Distance from the reflection at which the search ends, as a share of the way: the wave from the rim is weak there.
const FAR: f64 = 10.0;
/// Error of the end, as a share of its distance from the reflection.
const END_ERROR: f64 = 1e-4;
/// Cosine of the angle between a face and the next one up to which the next one continues it: 15°.
const GOES_ON: f64 = 0.966;
/// Distance past the end at which the next face is measured, as a share of the distance of the end.
const PAST: f64 = 0.05;

/// A reflection at a plane face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::response) struct Reflection {
    /// The point of reflection, in world metres.
    pub point: DVec3,
    /// Unit vector of flight away from the face.
    pub away: DVec3,
    /// Unit vector from the solid into the air.
    pub normal: DVec3,
    /// Length of the path from the source to the face in metres.
    pub before_m: f64,
    /// Length of the path from the face to the listener in metres.
    pub after_m: f64,
}

/// The rim of a face about a reflection.
pub(super) struct FaceRim {
    samples: Vec<Samples>,
}

/// Where a point of the face's plane lies.
#[derive(PartialEq)]
enum Place {
    Face,
    Air,
    Solid,
}

impl FaceRim {
    /// The rim of the face about a reflection.
    pub fn about(exact: &ExactScene, reflection: &Reflection) -> FaceRim {
        let detours = reflection.detours(|along| {
            let search = Search {
                exact,
                reflection,
                along,
                error_m: on_face_m(exact),
            };
            search.end_m()
        });
        FaceRim {
            samples: all_samples(&detours),
        }
    }

    /// Whether the face has no end.
    pub fn is_endless(&self) -> bool {
        self.samples.is_empty()
    }

    /// The pressure of the reflection for the wave number `k`, relative to an endless face.
    pub fn pressure(&self, k: f64) -> Complex64 {
        1.0 - ring::sum(&self.samples, k)
    }
}

impl Reflection {
    /// The detours over the ends of the face in all half-planes, from their distances in metres along a unit vector.
    ///
    /// The half-planes of the reverse path cut the face along the same lines.
    fn detours(&self, end_m: impl Fn(DVec3) -> Option<f64>) -> Detours {
        let steep = self.away.dot(self.normal);
        let along = (self.away - self.normal * steep).try_normalize();
        let along = along.unwrap_or_else(|| self.normal.any_orthonormal_vector());
        let across = self.normal.cross(along);
        let from = self.point - self.away * self.before_m;
        let to = self.point + self.away * self.after_m;
        let length = self.before_m + self.after_m;
        ring::detours(|azimuth| {
            let (sine, cosine) = azimuth.sin_cos();
            let direction = (along * cosine + across * (sine * steep)).try_normalize()?;
            let end = self.point + direction * end_m(direction)?;
            Some(from.distance(end) + end.distance(to) - length)
        })
    }
}

/// The search for the end of a face along a line.
struct Search<'a> {
    exact: &'a ExactScene,
    reflection: &'a Reflection,
    along: DVec3,
    /// Distance in metres up to which a point lies on the face.
    error_m: f64,
}

impl Search<'_> {
    /// The distance of the end from the reflection in metres; `None` if the face goes on up to another solid, or far.
    fn end_m(&self) -> Option<f64> {
        let Reflection {
            before_m, after_m, ..
        } = *self.reflection;
        let mut on_face = 0.0;
        let mut next = FIRST * before_m.min(after_m);
        while next < FAR * (before_m + after_m) {
            match self.place(next) {
                Place::Solid => return None,
                Place::Air => {
                    let error = END_ERROR * next;
                    let is_on = |metres: f64| self.place(metres) == Place::Face;
                    let (end, _) = bisect(next, on_face, error, is_on);
                    if !self.goes_on(end * (1.0 + PAST)) {
                        return Some(end);
                    }
                }
                Place::Face => {}
            }
            on_face = next;
            next *= LONGER;
        }
        None
    }

    fn at(&self, metres: f64) -> DVec3 {
        self.reflection.point + self.along * metres
    }

    fn place(&self, metres: f64) -> Place {
        match self.exact.surface_distance(self.at(metres)) {
            distance if distance > self.error_m => Place::Air,
            distance if distance < -self.error_m => Place::Solid,
            _ => Place::Face,
        }
    }

    /// Whether the next face continues this one.
    fn goes_on(&self, metres: f64) -> bool {
        let point = self.at(metres);
        let step = 0.1 * self.exact.surface_distance(point);
        let [above, below] = [step, -step]
            .map(|height| self.exact.surface_distance(point + self.reflection.normal * height));
        above - below > GOES_ON * 2.0 * step
    }
}
