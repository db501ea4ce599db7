//! The edges that tents touch.

use super::edge::{Edge, TURN};
use super::space::Space;
use super::string::{FINE, HalfPlanes, TautString};
use super::tent::bisect;
use glam::DVec3;

/// Detour in metres from which edges beside the way are left out: at 63 Hz they change the level by 1 dB at most.
pub(super) const MOST_DETOUR_M: f64 = 4.0;

/// Directions along a face.
pub(super) const SIDES: [f64; 2] = [1.0, -1.0];

/// The point at which an obstacle above the straight line, or above a string, touches the lowest tent that it blocks. If a
/// tent touches a plane face, it is the end of the face with the shortest detour, of those on these sides. Also the side.
pub(super) fn touched(
    space: &impl Space,
    planes: &HalfPlanes,
    (azimuth, above): (f64, Option<&TautString>),
    sides: &[f64],
) -> Option<(DVec3, f64)> {
    let touch = planes.beyond(space, azimuth, above, MOST_DETOUR_M)?;
    let along = planes.along_face(space, azimuth, touch)?;
    let end = |side: &f64| Some((end_of_face(space, planes, touch, along * *side)?, *side));
    let ends = sides.iter().filter_map(end);
    let nearest = ends.min_by(|a, b| planes.detour_m(a.0).total_cmp(&planes.detour_m(b.0)));
    Some(nearest.unwrap_or((touch, sides[0])))
}

/// The edge that a tent touches, from the tents in two half-planes next to each other.
pub(super) fn edge_at(
    space: &impl Space,
    planes: &HalfPlanes,
    (azimuth, above): (f64, Option<&TautString>),
) -> Option<Edge> {
    let (point, side) = touched(space, planes, (azimuth, above), &SIDES)?;
    let beside = |turn: f64| {
        let (other, _) = touched(space, planes, (azimuth + turn, above), &[side])?;
        (other - point).try_normalize()
    };
    // Beyond the end of an edge, tents touch another edge.
    let is_straight = |turn: f64, along: DVec3| {
        let half = beside(0.5 * turn);
        half.is_some_and(|half| half.angle_between(along) < STRAIGHT)
    };
    let mut all = [TURN, -TURN]
        .into_iter()
        .filter_map(|turn| Some((turn, beside(turn)?)));
    let first = all.next()?;
    let along = match is_straight(first.0, first.1) {
        true => first.1,
        false => all
            .find(|(turn, along)| is_straight(*turn, *along))
            .map_or(first.1, |(_, along)| along),
    };
    Some(Edge { point, along })
}

/// Angle in radians between lines to neighbouring touches up to which they lie on a straight edge.
pub(super) const STRAIGHT: f64 = 0.01;

/// Distance at which the search for the end of a face begins, as a share of the distance between source and listener, and
/// the factor between distances that are tried.
const FIRST: f64 = 0.01;
const LONGER: f64 = 1.5;
/// Distance from a face up to which a point is on it, as a share of the distance between source and listener.
const ON_FACE: f64 = 10.0 * FINE;

/// The end of a plane face along a unit vector from a point on it; `None` if the surface is curved, or goes on.
fn end_of_face(
    space: &impl Space,
    planes: &HalfPlanes,
    touch: DVec3,
    along: DVec3,
) -> Option<DVec3> {
    let error = ON_FACE * planes.apart_m();
    let height = |metres: f64| space.distance(touch + along * metres);
    let mut on_face = 0.0;
    let mut next = FIRST * planes.apart_m();
    while height(next) <= error {
        if height(next) < -error || planes.detour_m(touch + along * next) > MOST_DETOUR_M {
            return None;
        }
        on_face = next;
        next *= LONGER;
    }
    let (_, end) = bisect(next, on_face, error, |metres| height(metres) <= error);
    // A curved surface leaves its tangent before.
    (height(0.5 * end) < 0.1 * error).then(|| touch + along * end)
}
