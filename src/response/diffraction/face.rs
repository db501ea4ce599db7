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
use super::ring::{self, Detours, all_samples};
use super::samples::Samples;
use super::string::length;
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

/// The place of a point of the face's plane.
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
    /// The reflection at point `index` of a way from a source to a listener, both included. `normal` is that of the face.
    /// `None` if the way has no direction there.
    pub fn on_way(points: &[DVec3], index: usize, normal: DVec3) -> Option<Reflection> {
        let (before, after) = (&points[..=index], &points[index..]);
        let away = *after.get(1)? - after[0];
        Some(Reflection {
            point: after[0],
            away: away.try_normalize()?,
            normal,
            before_m: length(before),
            after_m: length(after),
        })
    }

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
                    let (beyond, end) = bisect(next, on_face, error, is_on);
                    if self.place(beyond) == Place::Solid {
                        return None;
                    }
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
        let [above, below] = [step, -step].map(|height| {
            self.exact
                .surface_distance(point + self.reflection.normal * height)
        });
        above - below > GOES_ON * 2.0 * step
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests;
    use super::*;
    use std::f64::consts::PI;

    const SOURCE: DVec3 = DVec3::new(-0.7, 2.0, 0.4);
    const LISTENER: DVec3 = DVec3::new(1.1, 3.0, 0.2);

    /// The reflection of a pair at the plane y = 0.
    fn reflection(source: DVec3, listener: DVec3) -> Reflection {
        let point = source
            .lerp(listener, source.y / (source.y + listener.y))
            .with_y(0.0);
        Reflection {
            point,
            away: (listener - point).normalize(),
            normal: DVec3::Y,
            before_m: source.distance(point),
            after_m: point.distance(listener),
        }
    }

    /// The level in dB of the reflection at a box whose top is at y = 0, relative to an endless face.
    fn level_db(size: [f64; 2], middle: [f64; 2], ends: (DVec3, DVec3), k: f64) -> f64 {
        let ([width, depth], [x, z]) = (size, middle);
        let surface =
            format!("Surface(shape: Box(size: ({width}, 1, {depth})), position: ({x}, -0.5, {z}))");
        let rim = FaceRim::about(&tests::exact(&surface, ends), &reflection(ends.0, ends.1));
        20.0 * rim.pressure(k).norm().log10()
    }

    /// ∫ exp(ix²) dx between two limits, by the trapezoidal rule.
    fn fresnel([from, to]: [f64; 2]) -> Complex64 {
        const STEPS: usize = 20_000;
        let width = (to - from) / STEPS as f64;
        let at = |step: f64| Complex64::cis((from + step * width).powi(2));
        let inner: Complex64 = (1..STEPS).map(|step| at(step as f64)).sum();
        (inner + 0.5 * (at(0.0) + at(STEPS as f64))) * width
    }

    /// Protects the reflections at panels of any width: Fresnel's integral over a rectangle, for a pair right above it, within
    /// 5 % of the pressure at an endless face.
    #[test]
    fn panels_reflect_as_the_integral_of_fresnel_states() {
        let ends = (2.0 * DVec3::Y, 3.0 * DVec3::Y);
        for size in [[0.2, 40.0], [0.5, 0.7], [1.5, 0.6]] {
            for k in [2.0_f64, 6.0, 20.0] {
                let reach_m = 2.0 * 3.0 / (2.0 + 3.0);
                let scale = (0.5 * k / reach_m).sqrt();
                let share = |width: f64| fresnel([-0.5, 0.5].map(|end| end * width * scale)).norm();
                let exact = share(size[0]) * share(size[1]) / PI;
                let found = 10.0_f64.powf(level_db(size, [0.0; 2], ends, k) / 20.0);
                assert!(
                    (found - exact).abs() < 0.05,
                    "{size:?}, k = {k}: {found}, exact {exact}"
                );
            }
        }
    }

    /// Protects the place where a reflection ends: half its pressure is left at the end of a face, all of it far from the
    /// ends.
    #[test]
    fn half_of_a_reflection_is_left_at_the_end_of_a_face() {
        let point = reflection(SOURCE, LISTENER).point;
        let middle = [point.x + 50.0 - 1e-2, point.z];
        let half_db = level_db([100.0, 100.0], middle, (SOURCE, LISTENER), 10.0);
        assert!((half_db + 6.02).abs() < 0.5, "{half_db} dB");
        let all_db = level_db([100.0, 100.0], [0.0; 2], (SOURCE, LISTENER), 10.0);
        assert!(all_db.abs() < 0.5, "{all_db} dB");
    }

    /// Protects reciprocity and scaling: a reflection has the same level if source and listener change places, and for twice
    /// the lengths at half the frequency.
    #[test]
    fn ends_of_faces_know_no_direction_and_no_scale() {
        let (size, middle) = ([0.9, 1.7], [0.1, 0.3]);
        let there = level_db(size, middle, (SOURCE, LISTENER), 5.0);
        let back = level_db(size, middle, (LISTENER, SOURCE), 5.0);
        assert!((there - back).abs() < 1e-6, "{there} and {back} dB");
        let twice = |values: [f64; 2]| values.map(|value| 2.0 * value);
        let ends = (2.0 * SOURCE, 2.0 * LISTENER);
        let scaled = level_db(twice(size), twice(middle), ends, 2.5);
        assert!((there - scaled).abs() < 1e-3, "{there} and {scaled} dB");
    }

    /// Protects faces that end at another solid, as a floor at a wall, and faces of several solids in contact: they have no
    /// end there.
    #[test]
    fn faces_go_on_at_walls_and_over_joints() {
        let floor =
            |x: f64| format!("Surface(shape: Box(size: (2, 1, 60)), position: ({x}, -0.5, 0))");
        let floors = format!("{}, {}, {}", floor(-1.0), floor(1.0), floor(3.0));
        let walls = "Surface(shape: Box(size: (1, 9, 60)), position: (-2.5, 0, 0)), \
                     Surface(shape: Box(size: (1, 9, 60)), position: (4.5, 0, 0))";
        let ends = (SOURCE, LISTENER);
        let exact = tests::exact(&format!("{floors}, {walls}"), ends);
        let rim = FaceRim::about(&exact, &reflection(SOURCE, LISTENER));
        let level = 20.0 * rim.pressure(10.0).norm().log10();
        assert!(level.abs() < 0.5, "{level} dB");
    }
}
