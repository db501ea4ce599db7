//! Curvature of surfaces at the contacts of a string: whether a string that hardly turns touches an edge or a round body.

use super::space::Space;
use super::string::{FINE, TautString};
use super::turn::Turn;
use glam::DVec3;

/// Distance over which the curvature of a surface is measured that a way only touches, as a share of the shorter leg.
const TOUCH: f64 = 1e-3;

/// Greatest curvature of a round body, times that distance: an edge of 340° or less has more.
const ROUND_TOUCH: f64 = 0.1;

/// Least distance over which curvature is measured, in errors of a contact: at an edge, a shorter one may lie on one face.
const CONTACT_ERRORS: f64 = 30.0;

/// The turns of a string. Where it touches a round body so little that the error of its contacts parts them, they are one
/// turn.
pub(super) fn turns_of(space: &impl Space, string: &TautString) -> Vec<Turn> {
    let turns = string.turns();
    let [first, .., last] = &turns[..] else {
        return turns;
    };
    let legs = [
        string.source.distance(first.entry),
        string.listener.distance(last.exit),
    ];
    if first.entry.distance(last.exit) > TOUCH * legs[0].min(legs[1]) {
        return turns;
    }
    let middle = turns[turns.len() / 2].middle;
    let touch = Turn::along(string.source, &[middle], string.listener);
    let least_m = least_curvature_step_m(string.source.distance(string.listener));
    let ends = [string.source, middle, string.listener];
    let touch = on_surface(space, &touch, &ends, least_m);
    match touch.arc_m > 0.0 {
        true => vec![touch],
        false => turns,
    }
}

/// Least distance in metres over which curvature is measured at a contact, for ends `apart_m` metres apart.
pub(super) fn least_curvature_step_m(apart_m: f64) -> f64 {
    CONTACT_ERRORS * FINE * apart_m
}

/// A turn with the curvature of the surface, where the string touches a round body so little that it has one contact.
/// `legs` are the turn and the points before and after it.
pub(super) fn on_surface(space: &impl Space, turn: &Turn, legs: &[DVec3], least_m: f64) -> Turn {
    let shorter = legs[0]
        .distance(turn.middle)
        .min(legs[2].distance(turn.middle));
    let step = TOUCH * shorter;
    let along = (legs[2] - legs[0]).normalize_or_zero();
    if turn.arc_m > 0.0 || step < least_m {
        return *turn;
    }
    let curvature = curvature(space, turn.middle, along, step);
    // An arc is shorter than the legs: a contact on a plane has a curvature by rounding alone.
    let is_round = curvature * shorter > turn.angle && curvature * step < ROUND_TOUCH;
    match is_round {
        true => turn.with_radius(1.0 / curvature),
        false => *turn,
    }
}

/// Curvature of a surface at a point on it along a unit vector, in 1/m, by differences over `step` metres; 0 where it is
/// hollow.
pub(super) fn curvature(space: &impl Space, point: DVec3, along: DVec3, step: f64) -> f64 {
    let at = |offset: DVec3| space.distance(point + offset * step);
    let slope = |axis: DVec3| (at(axis) - at(-axis)) / (2.0 * step);
    let slope = DVec3::new(slope(DVec3::X), slope(DVec3::Y), slope(DVec3::Z)).length();
    let second = (at(along) + at(-along) - 2.0 * at(DVec3::ZERO)) / (step * step);
    (second / slope.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0 / step)
}
