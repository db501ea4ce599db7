//! Edges that a string passes at a small distance: the far ends of the faces along which it leaves its first and last edge.
//!
//! A string over a thick obstacle touches one edge only if source or listener are high enough to see the other. The end
//! of the face between both still diffracts: at the boundary of its shadow it halves the pressure.

use super::edge::Edge;
use super::space::Space;
use super::tent::bisect;
use super::wedge::Wedge;
use glam::DVec3;
use num_complex::Complex64;
use std::f64::consts::PI;

/// Distance from the edge at which the search for the end of a face begins, as a share of the leg.
pub(super) const FIRST: f64 = 0.02;
/// Factor between distances that are tried.
const LONGER: f64 = 1.15;
/// Distance from the face, as a share of the distance from the edge, beyond which a point counts as past its end.
const PAST: f64 = 0.01;
/// Error of the end, as a share of the interval between two distances that are tried: less than a thousandth of the width.
const END_ERROR: f64 = 1.0 / 256.0;

/// The far end of a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Brink {
    /// The line of the end, parallel to the edge at which the face begins.
    edge: Edge,
    /// Unit vector out of the solid at the face.
    outwards: DVec3,
    /// Width of the face in metres.
    pub width_m: f64,
}

impl Brink {
    /// The end of the face of `edge` next to the leg that leads to `end`; `None` if the face is longer than the leg.
    pub fn beside(space: &impl Space, edge: &Edge, other: DVec3, end: DVec3) -> Option<Brink> {
        let leg_m = edge.point.distance(end);
        // In the shadow the solid is on the side of the other leg, which is turned by more than half a circle.
        let outwards = edge.point - other;
        let face = edge.face_beside(space, (end, outwards), FIRST * leg_m)?;
        Brink::of_face(space, edge, face, [FIRST * leg_m, leg_m])
    }

    /// The line of the end.
    pub fn edge(&self) -> Edge {
        self.edge
    }

    /// The end of the face with these unit vectors along it, away from the edge, and out of the solid; `None` if it is
    /// narrower than `least_m` or wider than `most_m` metres.
    pub fn of_face(
        space: &impl Space,
        edge: &Edge,
        (along_face, outwards): (DVec3, DVec3),
        [least_m, most_m]: [f64; 2],
    ) -> Option<Brink> {
        let is_past =
            |metres: f64| space.distance(edge.point + along_face * metres) > PAST * metres;
        let mut from = least_m;
        if is_past(from) {
            return None;
        }
        let mut to = from * LONGER;
        while !is_past(to) {
            from = to;
            to *= LONGER;
            if to > most_m {
                return None;
            }
        }
        let error = END_ERROR * (to - from);
        let (_, from) = bisect(to, from, error, |metres| !is_past(metres));
        // A point this far past the end is at the distance `PAST` from it.
        let width_m = from / (1.0 + PAST);
        let point = edge.point + along_face * width_m;
        Some(Brink {
            edge: Edge { point, ..*edge },
            outwards,
            width_m,
        })
    }

    /// The point of the line next to the leg from `start`, on the edge at which the face begins, to `end`.
    pub fn beside_leg(&self, start: DVec3, end: DVec3) -> DVec3 {
        self.edge.shortest(start, end)
    }

    /// The factor of the pressure at `end` for the wave number `k`, relative to an endless face. `before_m` is the length
    /// of the way up to the edge at `start`, and `face` the pressure reflection coefficient of the faces.
    pub fn factor(
        &self,
        space: &impl Space,
        (start, before_m): (DVec3, f64),
        end: DVec3,
        k: f64,
        face: f64,
    ) -> Option<Complex64> {
        let point = self.beside_leg(start, end);
        let (towards, between_m) = (start - point).normalize_and_length();
        let ends = [point + towards * (before_m + between_m), end];
        let radius = 0.5 * self.width_m.min(point.distance(end));
        let edge = Edge { point, ..self.edge };
        let wedge = edge.wedge(space, ends, self.outwards, radius)?;
        // The way arrives along the face, and the leg after it is free: rounding must not hide its end.
        let wedge = Wedge {
            air_angle: wedge.air_angle - wedge.source_angle,
            source_angle: 0.0,
            receiver_angle: (wedge.receiver_angle - wedge.source_angle).min(PI),
            ..wedge
        };
        Some(1.0 + wedge.diffracted(k).sum([face; 2]) / (1.0 + face))
    }
}
