//! Turns of a taut string: at an edge, or along a curved surface.

use super::round::Arc;
use glam::DVec3;

/// Turn in radians up to which the apex of a turn is the point where its legs meet: beyond, they hardly do.
const MOST_APEX: f64 = 2.5;

/// A point at which a string touches a solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Contact {
    /// Position in world metres, within the error of a tent's height above the solid.
    pub point: DVec3,
    /// Whether the string follows a curved surface from here to the next contact.
    pub is_followed: bool,
}

impl Contact {
    /// A contact from which the string goes straight on.
    pub fn at(point: DVec3) -> Contact {
        Contact {
            point,
            is_followed: false,
        }
    }
}

/// A part of a string that touches a solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Turn {
    /// First point on the solid, in world metres.
    pub entry: DVec3,
    /// Last point on the solid.
    pub exit: DVec3,
    /// Point on the solid about half way.
    pub middle: DVec3,
    /// Point at which the legs would meet.
    pub apex: DVec3,
    /// Length on the solid in metres: 0 at an edge.
    pub arc_m: f64,
    /// Angle between the legs in radians.
    pub angle: f64,
    /// Integral of ρ^(−2/3) along the string in m^(1/3), where ρ is the radius of curvature: creeping waves decay by it.
    pub creeping: f64,
}

impl Turn {
    /// The turn at `points` of a string from `before` to `after`.
    pub fn along(before: DVec3, points: &[DVec3], after: DVec3) -> Turn {
        let (entry, exit) = match points {
            [first, .., last] => (*first, *last),
            [only] => (*only, *only),
            [] => (before, before),
        };
        let to_entry = (entry - before).normalize_or_zero();
        let from_exit = (after - exit).normalize_or_zero();
        let (arc_m, creeping) = curve(before, points, after);
        let angle = to_entry.angle_between(from_exit);
        let middle = points.get(points.len() / 2).copied().unwrap_or(entry);
        Turn {
            entry,
            exit,
            middle,
            apex: apex([entry, exit], to_entry, from_exit).unwrap_or(middle),
            arc_m,
            angle,
            creeping,
        }
    }

    /// The same turn along an arc of a radius in metres.
    pub fn with_radius(self, radius_m: f64) -> Turn {
        let arc_m = radius_m * self.angle;
        Turn {
            arc_m,
            creeping: (self.angle * self.angle * arc_m).cbrt(),
            ..self
        }
    }

    /// The way along the surface, with the lengths of the ways before and after it in metres.
    pub fn arc(&self, before_m: f64, after_m: f64) -> Arc {
        Arc {
            before_m,
            after_m,
            arc_m: self.arc_m,
            angle: self.angle,
            creeping: self.creeping,
        }
    }

    /// Mean radius of curvature in metres: 0 at an edge.
    pub fn radius_m(&self) -> f64 {
        match self.arc_m > 0.0 {
            true => self.arc_m / self.angle.max(f64::MIN_POSITIVE),
            false => 0.0,
        }
    }
}

/// Length of the curve through points on a solid in metres, and its integral of ρ^(−2/3) in m^(1/3).
fn curve(before: DVec3, points: &[DVec3], after: DVec3) -> (f64, f64) {
    let Some(last) = points.len().checked_sub(1).filter(|last| *last > 0) else {
        return (0.0, 0.0);
    };
    let turn_at = |index: usize| {
        let previous = match index {
            0 => before,
            _ => points[index - 1],
        };
        let next = points.get(index + 1).copied().unwrap_or(after);
        let (to, from) = (points[index] - previous, next - points[index]);
        to.angle_between(from)
    };
    let turns: Vec<f64> = (0..=last)
        .map(turn_at)
        .map(|turn| if turn.is_finite() { turn } else { 0.0 })
        .collect();
    let share = |index: usize| match index == 0 || index == last {
        true => turns[index],
        false => 0.5 * turns[index],
    };
    let mut sum = (0.0, 0.0);
    for index in 0..last {
        let chord = points[index].distance(points[index + 1]);
        let turn = share(index) + share(index + 1);
        // An arc is longer than its chord.
        let arc = chord * (1.0 + turn * turn / 24.0);
        sum.0 += arc;
        sum.1 += (turn * turn * arc).cbrt();
    }
    sum
}

/// The point where the line into a curve and the line out of it meet.
fn apex([entry, exit]: [DVec3; 2], to_entry: DVec3, from_exit: DVec3) -> Option<DVec3> {
    let chord = exit - entry;
    let (direction, width) = chord.normalize_and_length();
    if width == 0.0 {
        return Some(entry);
    }
    let rise = to_entry.angle_between(direction);
    let fall = direction.angle_between(from_exit);
    let is_met = rise + fall > 0.0 && rise + fall < MOST_APEX;
    is_met.then(|| entry + to_entry * (width * fall.sin() / (rise + fall).sin()))
}
