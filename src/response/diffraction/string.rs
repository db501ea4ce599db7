//! Taut strings: the shortest ways from source to listener around what stands between them.
//!
//! A string in one half-plane through the line from source to listener is found by a *tent*: two straight legs over an
//! apex, which is raised until both legs are free, and then lowered along the leg that touches until the other leg
//! touches too. The points of contact are those of the taut string; between them it lies on the solid. The lengths in
//! half-planes all around the line give the local shortest ways.
//!
//! Only lines of sight are asked for: a string passes no wall, however thin, and needs no list of edges.

use super::space::Space;
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// Number of half-planes in which strings are sought. A gap narrower than 22.5° as seen from the line can be missed.
const HALF_PLANES: usize = 16;

/// First height of a tent, as a share of the distance between its ends.
const LOWEST: f64 = 0.01;
/// Greatest height of a tent, as a share of the distance between its ends.
const HIGHEST: f64 = 4.0;

/// Factor between the heights that are tried: an opening between two obstacles is found if its farther rim is that much
/// farther from the line than the nearer one.
const RAISED: f64 = 1.25;

/// Feet of tents, as shares of the distance between their ends, where no tent over the middle of the solid is free: over
/// either end, and beyond. They find the way for ends close to a wall, which leaves at a right angle or backwards.
const FURTHER_FEET: [f64; 4] = [0.0, 1.0, -1.0, 2.0];

/// Error of a tent's height as a share of the distance between its ends, while half-planes are compared.
const COARSE: f64 = 1e-3;
/// Error of a tent's height as a share of the distance between its ends: 1 µm at 100 m.
const FINE: f64 = 1e-8;
/// The middle of the solid, and [`FURTHER_FEET`].
const ALL_FEET: usize = 1 + FURTHER_FEET.len();

/// Contacts nearer to each other than this share of the distance between the ends, times the square root of the error,
/// are one contact: a leg that dips into a smooth solid by the error is in it for a length that grows with the root.
const APART: f64 = 0.1;

/// Contacts of a string with solids that are followed between its first and its last.
const MOST_INNER_DEPTH: u32 = 2;

/// A string from source to listener.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TautString {
    /// Points in world metres: the source, the contacts with solids, the listener. Contacts lie in the air, within the
    /// error of a tent's height above the solid.
    pub points: Vec<DVec3>,
    /// Azimuth of the half-plane about the line from source to listener, in radians.
    pub azimuth: f64,
}

impl TautString {
    /// Length in metres.
    pub fn length_m(&self) -> f64 {
        length(&self.points)
    }
}

/// Length of a polyline in metres.
pub(super) fn length(points: &[DVec3]) -> f64 {
    points.windows(2).map(|leg| leg[0].distance(leg[1])).sum()
}

/// The half-planes about the line between two points.
pub(super) struct HalfPlanes {
    source: DVec3,
    listener: DVec3,
    axes: [DVec3; 2],
}

impl HalfPlanes {
    /// The half-planes about the line from source to listener; `None` if the points coincide.
    pub fn between(source: DVec3, listener: DVec3) -> Option<HalfPlanes> {
        let along = (listener - source).try_normalize()?;
        // Upwards where the line is not vertical: azimuth 0 is the way over an obstacle.
        let up = [DVec3::Y, DVec3::X]
            .into_iter()
            .map(|up| up.reject_from_normalized(along))
            .find(|up| up.length_squared() > 0.01)?
            .normalize();
        Some(HalfPlanes {
            source,
            listener,
            axes: [up, along.cross(up)],
        })
    }

    /// Unit vector from the line into the half-plane of an azimuth.
    pub fn upwards(&self, azimuth: f64) -> DVec3 {
        let turned = DVec2::from_angle(azimuth);
        self.axes[0] * turned.x + self.axes[1] * turned.y
    }

    /// Azimuth of a point about the line.
    pub fn azimuth_of(&self, point: DVec3) -> f64 {
        let from = point - self.source;
        from.dot(self.axes[1]).atan2(from.dot(self.axes[0]))
    }

    /// The taut string in one half-plane; `None` if no tent up to the greatest height is free.
    pub fn string(&self, space: &impl Space, azimuth: f64) -> Option<TautString> {
        self.string_within(space, azimuth, FINE, ALL_FEET)
    }

    fn string_within(
        &self,
        space: &impl Space,
        azimuth: f64,
        error: f64,
        feet: usize,
    ) -> Option<TautString> {
        let plane = Plane {
            space,
            up: self.upwards(azimuth),
            error,
            feet,
        };
        let contacts = plane.contacts(self.source, self.listener, MOST_INNER_DEPTH)?;
        let mut points = vec![self.source];
        points.extend(contacts);
        points.push(self.listener);
        Some(TautString { points, azimuth })
    }

    /// The strings in evenly spread half-planes that are shorter than those in both neighbouring half-planes.
    pub fn shortest(&self, space: &impl Space) -> Vec<TautString> {
        let step = TAU / HALF_PLANES as f64;
        let all = |feet: usize| -> Vec<Option<TautString>> {
            let strings = (0..HALF_PLANES)
                .map(|index| self.string_within(space, index as f64 * step, COARSE, feet));
            strings.collect()
        };
        let mut strings = all(1);
        if strings.iter().all(Option::is_none) {
            strings = all(ALL_FEET);
        }
        let length = |index: usize| {
            let string = &strings[index % HALF_PLANES];
            string.as_ref().map_or(f64::INFINITY, TautString::length_m)
        };
        let is_shortest = |index: &usize| {
            let own = length(*index);
            own < length(index + HALF_PLANES - 1) && own <= length(index + 1)
        };
        let shortest = (0..HALF_PLANES).filter(is_shortest);
        shortest
            .filter_map(|index| strings[index].clone())
            .collect()
    }
}

/// A half-plane in which a string is sought.
struct Plane<'a, S> {
    space: &'a S,
    up: DVec3,
    /// Error of a tent's height, as a share of the distance between its ends.
    error: f64,
    /// Number of feet of tents that are tried.
    feet: usize,
}

impl<S: Space> Plane<'_, S> {
    /// The contacts of the taut string from `a` to `b`, without its ends; empty if no solid is in the way.
    fn contacts(&self, a: DVec3, b: DVec3, depth: u32) -> Option<Vec<DVec3>> {
        let Some(at) = self.space.between(a, b) else {
            return Some(Vec::new());
        };
        let length = a.distance(b);
        let along = (b - a) / length;
        let up = self.up.reject_from_normalized(along).try_normalize()?;
        let behind = self.space.between(b, a)?;
        let middle = 0.5 * (at.metres / length + 1.0 - behind.metres / length);
        let apex = |foot: f64, height: f64| a + along * (foot * length) + up * (height * length);
        let is_free = |foot: f64, height: f64| {
            let apex = apex(foot, height);
            self.space.is_free(a, apex) && self.space.is_free(b, apex)
        };
        let feet = [middle].into_iter().chain(FURTHER_FEET);
        let first = |foot: f64| Some((foot, first_free(|height| is_free(foot, height))?));
        let (foot, (blocked, free)) = feet.take(self.feet).find_map(first)?;
        let is_free = |height: f64| is_free(foot, height);
        let apex = |height: f64| apex(foot, height);
        let (blocked, free) = bisect(blocked, free, self.error, is_free);
        let (low, top) = (apex(blocked), apex(free));
        let found = match self.space.between(a, low) {
            Some(_) => self.lowered(a, low, top, b),
            None => {
                let mut found = self.lowered(b, low, top, a);
                found.reverse();
                found
            }
        };
        let [first, last] = found[..] else {
            return Some(found);
        };
        if depth == 0 {
            return Some(found);
        }
        // The line between the contacts lies on the solid: it is lifted by the error of the contacts.
        let lift = up * (4.0 * self.error * length);
        let inner = self.contacts(first + lift, last + lift, depth - 1);
        let inner = inner.unwrap_or_default();
        Some([first].into_iter().chain(inner).chain([last]).collect())
    }

    /// The contacts of the string from `a`, whose leg to `top` is free but whose leg to `low` is not, to `b`: the apex
    /// is lowered along the leg from `a` until the leg to `b` touches too, or until it reaches the contact.
    fn lowered(&self, a: DVec3, low: DVec3, top: DVec3, b: DVec3) -> Vec<DVec3> {
        let length = a.distance(top);
        let contact = self.contact(a, low) * length / a.distance(low).max(f64::MIN_POSITIVE);
        let at = |metres: f64| a + (top - a) * (metres / length);
        let is_free = |metres: f64| self.space.is_free(b, at(metres));
        if is_free(contact) {
            return vec![at(contact)];
        }
        let error = self.error * a.distance(b);
        let (blocked, free) = bisect(contact, length, error, is_free);
        let (low, top) = (at(blocked), at(free));
        let other = self.contact(b, low) * b.distance(top) / b.distance(low).max(f64::MIN_POSITIVE);
        let other = b + (top - b).normalize_or_zero() * other;
        match at(contact).distance(other) < APART * self.error.sqrt() * a.distance(b) {
            true => vec![at(contact)],
            false => vec![at(contact), other],
        }
    }

    /// Distance from `a` to the middle of the solid that the leg from `a` to `end` just touches.
    fn contact(&self, a: DVec3, end: DVec3) -> f64 {
        let length = a.distance(end);
        let Some(near) = self.space.between(a, end) else {
            return length;
        };
        let far = self.space.between(end, a);
        let far = far.map_or(near.metres, |far| length - far.metres);
        0.5 * (near.metres + far.max(near.metres))
    }
}

/// The first of the rising heights that is free, and the one before it.
fn first_free(is_free: impl Fn(f64) -> bool) -> Option<(f64, f64)> {
    let mut blocked = 0.0;
    let mut height = LOWEST;
    while height <= HIGHEST {
        if is_free(height) {
            return Some((blocked, height));
        }
        blocked = height;
        height *= RAISED;
    }
    None
}

/// Narrows the interval between a blocked and a free value to `error`.
fn bisect(
    mut blocked: f64,
    mut free: f64,
    error: f64,
    is_free: impl Fn(f64) -> bool,
) -> (f64, f64) {
    while free - blocked > error {
        let middle = 0.5 * (blocked + free);
        if middle <= blocked || middle >= free {
            break;
        }
        match is_free(middle) {
            true => free = middle,
            false => blocked = middle,
        }
    }
    (blocked, free)
}
