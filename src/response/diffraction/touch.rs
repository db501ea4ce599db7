//! The edges that tents touch.

use super::edge::{Edge, turn_for};
use super::space::Space;
use super::string::{FINE, HalfPlanes, TautString};
use super::tent::bisect;
use glam::DVec3;
use std::ops::RangeInclusive;

/// Detour in metres from which edges beside a free way are left out: at 63 Hz they change the level by 1 dB at most.
pub(super) const MOST_DETOUR_M: f64 = 4.0;

/// Growth of this detour with the detour of the string, if the source is hidden: far edges that both ends see are louder
/// than a long string.
const BEYOND_STRING: f64 = 4.0;

/// Detour in metres from which edges beyond a string, or beside a free way, are left out.
pub(super) fn most_detour_m(planes: &HalfPlanes, above: Option<&TautString>) -> f64 {
    let string_m = above
        .filter(|_| !planes.are_beside())
        .map(TautString::length_m);
    let detour_m = string_m.map_or(0.0, |length_m| (length_m - planes.apart_m()).max(0.0));
    MOST_DETOUR_M + BEYOND_STRING * detour_m
}

/// Share of the way to a touch at which the touch in the half-plane half way lies on a straight edge: a half where the
/// half-plane turns little.
const HALF_WAY: RangeInclusive<f64> = 0.25..=0.75;

/// The point at which an obstacle above the straight line, or above a string, touches the lowest tent that it blocks. If a
/// tent touches a plane face, it is the end of the face for which `far` is least.
fn touched_by(
    space: &impl Space,
    planes: &HalfPlanes,
    (azimuth, above): (f64, Option<&TautString>),
    far: impl Fn(DVec3) -> f64,
) -> Option<DVec3> {
    let most_m = most_detour_m(planes, above);
    let touch = planes.beyond(space, azimuth, above, most_m)?;
    let (touch, along) = planes.on_face(space, azimuth, touch)?;
    let end = |along: DVec3| end_of_face(space, planes, (touch, along), most_m);
    let ends = [along, -along].into_iter().filter_map(end);
    let nearest = ends.min_by(|a, b| far(*a).total_cmp(&far(*b)));
    Some(nearest.unwrap_or(touch))
}

/// The point at which an obstacle touches the lowest tent that it blocks, or the end of a plane face there with the shortest
/// detour.
pub(super) fn touched(
    space: &impl Space,
    planes: &HalfPlanes,
    tent: (f64, Option<&TautString>),
) -> Option<DVec3> {
    touched_by(space, planes, tent, |end| planes.detour_m(end))
}

/// The edge that a tent touches, and whether it is straight there. Its direction is that between the tents in half-planes that
/// are turned by at least `least` radians, and by half of this turn.
pub(super) fn edge_at(
    space: &impl Space,
    planes: &HalfPlanes,
    (azimuth, above): (f64, Option<&TautString>),
    least: f64,
) -> Option<(Edge, bool)> {
    let point = touched(space, planes, (azimuth, above))?;
    let turn = turn_for(planes.height_m(point), planes.apart_m()).max(least);
    // The detours over both ends of a face may be equal: the other touch lies on the same edge as this one.
    let beside = |turn: f64| {
        let tent = (azimuth + turn, above);
        let other = touched_by(space, planes, tent, |end| end.distance(point))?;
        Some(other - point).filter(|along| *along != DVec3::ZERO)
    };
    // Beyond the end of an edge, tents touch another edge.
    let is_straight = |turn: f64, along: DVec3| {
        let half = beside(0.5 * turn);
        half.is_some_and(|half| {
            half.angle_between(along) < STRAIGHT
                && HALF_WAY.contains(&(half.length() / along.length()))
        })
    };
    let mut all = [turn, -turn]
        .into_iter()
        .filter_map(|turn| Some((turn, beside(turn)?)));
    let first = all.next()?;
    let straight = [first]
        .into_iter()
        .chain(all)
        .find(|(turn, along)| is_straight(*turn, *along));
    let (_, along) = straight.unwrap_or(first);
    let along = along.normalize();
    Some((Edge { point, along }, straight.is_some()))
}

/// Angle in radians between lines to neighbouring touches up to which they lie on a straight edge.
const STRAIGHT: f64 = 0.01;

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
    (touch, along): (DVec3, DVec3),
    most_m: f64,
) -> Option<DVec3> {
    let error = ON_FACE * planes.apart_m();
    let height = |metres: f64| space.distance(touch + along * metres);
    let mut on_face = 0.0;
    let mut next = FIRST * planes.apart_m();
    while height(next) <= error {
        if height(next) < -error || planes.detour_m(touch + along * next) > most_m {
            return None;
        }
        on_face = next;
        next *= LONGER;
    }
    let (_, end) = bisect(next, on_face, error, |metres| height(metres) <= error);
    // A curved surface leaves its tangent before.
    (height(0.5 * end) < 0.1 * error).then(|| touch + along * end)
}
