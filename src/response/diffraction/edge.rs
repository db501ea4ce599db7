//! Edges at the contacts of a taut string: their lines, the stationary way over them, and the angles of their faces.

use super::space::Space;
use super::wedge::Wedge;
use glam::DVec3;
use std::f64::consts::PI;

/// A straight edge near a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Edge {
    /// A point on the edge, in world metres.
    pub point: DVec3,
    /// Unit vector along the edge.
    pub along: DVec3,
}

/// Least turn of the half-plane in radians over which the direction of an edge is measured, and the greatest.
pub(super) const TURN: f64 = 0.01;
const MOST_TURN: f64 = 1.2;

/// Least distance of the two points between which the direction of an edge is measured, as a share of the distance between
/// source and listener: tents that graze an edge touch it with an error of a hundredth of this distance.
const LEAST_SHIFT: f64 = 1e-4;

/// Turn of the half-plane in radians over which the direction of an edge is measured that lies `height_m` metres from the line
/// between two points, `apart_m` metres from each other.
pub(super) fn turn_for(height_m: f64, apart_m: f64) -> f64 {
    (LEAST_SHIFT * apart_m)
        .atan2(height_m)
        .clamp(TURN, MOST_TURN)
}

/// Searches for the stationary way over edges: one is enough for straight edges.
pub(super) const MOST_SEARCHES: usize = 4;

/// Distance from the surface, as a share of the way's length, up to which a point counts as on it.
pub(super) const ON_SURFACE: f64 = 1e-5;

/// Cosine of the angle between edges up to which they are parallel: 8°.
const PARALLEL: f64 = 0.99;

/// Distance from an edge at which its faces are measured at most, as a share of the shorter leg.
const MOST_OF_LEG: f64 = 0.7;

/// Distance in metres from an edge at which sound of the wave number `k` perceives its faces: half a Fresnel zone of a way
/// with these lengths in metres before and after the edge, within the leg of `shorter_m` metres.
pub(super) fn face_distance_m(k: f64, [before, after]: [f64; 2], shorter_m: f64) -> f64 {
    let zone = 0.5 * (2.0 * PI / k * before * after / (before + after)).sqrt();
    zone.min(MOST_OF_LEG * shorter_m)
}

/// Passes of the search for the stationary way over several edges: each pass moves one contact after the other to the
/// best place, and the error falls by a constant factor.
const PASSES: usize = 64;

/// Moves the contacts in `points` (source, contacts, listener) along their edges to the shortest way.
pub(super) fn shorten(points: &mut [DVec3], edges: &[Edge]) {
    let passes = match edges.len() {
        1 => 1,
        _ => PASSES,
    };
    for _ in 0..passes {
        for (index, edge) in edges.iter().enumerate() {
            points[index + 1] = edge.shortest(points[index], points[index + 2]);
        }
    }
}

impl Edge {
    /// The point of the edge on the shortest way from `a` to `b`: both legs meet the edge at the same angle (Fermat).
    pub fn shortest(&self, a: DVec3, b: DVec3) -> DVec3 {
        let (along_a, off_a) = self.split(a);
        let (along_b, off_b) = self.split(b);
        let (a_m, b_m) = (off_a.length(), off_b.length());
        let sum = a_m + b_m;
        let along = match sum > 0.0 {
            true => (along_a * b_m + along_b * a_m) / sum,
            false => 0.5 * (along_a + along_b),
        };
        self.point + self.along * along
    }

    /// The part of a vector at right angles to the edge.
    pub fn across(&self, vector: DVec3) -> DVec3 {
        vector - self.along * vector.dot(self.along)
    }

    /// Whether a point lies within `near_m` metres of the edge's line.
    pub fn is_near(&self, point: DVec3, near_m: f64) -> bool {
        self.split(point).1.length() < near_m
    }

    /// Whether two edges are parallel.
    pub fn is_parallel_to(&self, other: &Edge) -> bool {
        self.along.dot(other.along).abs() > PARALLEL
    }

    /// Distance of a point along the edge, and its vector from the edge.
    fn split(&self, point: DVec3) -> (f64, DVec3) {
        let from = point - self.point;
        let along = from.dot(self.along);
        (along, from - self.along * along)
    }

    /// The wedge of air around the edge between the ends of its two legs. `outwards` points away
    /// from the solid; `radius` is the distance from the edge, in metres, at which the faces are sought.
    ///
    /// `None` if an end lies on the edge's line, no face is found, or the faces leave no air between them.
    pub fn wedge(
        &self,
        space: &impl Space,
        [a, b]: [DVec3; 2],
        outwards: DVec3,
        radius: f64,
    ) -> Option<Wedge> {
        let (along_a, off_a) = self.split(a);
        let (along_b, off_b) = self.split(b);
        let towards_a = off_a.try_normalize()?;
        let towards_b = off_b.try_normalize()?;
        let side = self.along.cross(towards_a);
        let angle = towards_b.dot(side).atan2(towards_b.dot(towards_a));
        let turn = outwards.dot(side).signum();
        let through_air = turn * (turn * angle).rem_euclid(2.0 * PI);
        // From each leg on, away from the other.
        let face_a = self.face(space, towards_a, side * -turn, radius)?;
        let side_b = self.along.cross(towards_b);
        let face_b = self.face(space, towards_b, side_b * turn, radius)?;
        let air_angle = face_a + through_air.abs() + face_b;
        (air_angle > 0.0).then(|| Wedge {
            air_angle,
            source_m: off_a.length(),
            source_angle: face_a,
            receiver_m: off_b.length(),
            receiver_angle: face_a + through_air.abs(),
            along_m: (along_b - along_a).abs(),
        })
    }

    /// Unit vectors along the face that lies beside the leg to `end`, at right angles to the edge, and out of the solid
    /// there. `outwards` points from the edge away from the solid.
    pub fn face_beside(
        &self,
        space: &impl Space,
        (end, outwards): (DVec3, DVec3),
        radius: f64,
    ) -> Option<(DVec3, DVec3)> {
        let towards = self.split(end).1.try_normalize()?;
        let away = self.along.cross(towards);
        let side = away * -outwards.dot(away).signum();
        let (sine, cosine) = self.face(space, towards, side, radius)?.sin_cos();
        Some((
            towards * cosine + side * sine,
            towards * sine - side * cosine,
        ))
    }

    /// The angle in radians from the direction `x` towards `y` at which the circle about the edge enters a solid, up to
    /// half a turn.
    fn face(&self, space: &impl Space, x: DVec3, y: DVec3, radius: f64) -> Option<f64> {
        let mut angle = 0.0_f64;
        for _ in 0..MOST_STEPS {
            let point = self.point + (x * angle.cos() + y * angle.sin()) * radius;
            let clearance = space.distance(point) / radius;
            if clearance <= FACE_ERROR {
                return Some(angle);
            }
            // A chord is shorter than its arc: no step passes a surface.
            angle += clearance;
            if angle > PI {
                return None;
            }
        }
        Some(angle)
    }
}

/// Error of a face's angle in radians: it changes a level by less than 0.01 dB.
const FACE_ERROR: f64 = 1e-4;
/// Steps in search of a face.
const MOST_STEPS: usize = 200;
