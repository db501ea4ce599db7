//! Tents: two straight legs over an apex in one half-plane. A tent that is lowered onto a solid touches it where the taut
//! string does.

use super::profile::Profile;
use super::space::Space;
use super::turn::Contact;
use glam::DVec3;
use std::f64::consts::PI;

/// First height of a tent, as a share of the distance between its ends.
pub(super) const LOWEST: f64 = 0.01;

/// Greatest height of a tent, as a share of the distance between its ends.
pub(super) const HIGHEST: f64 = 4.0;

/// Factor between the heights that are tried: an opening between two obstacles is found if its farther rim is that much
/// farther from the line than the nearer one.
const RAISED: f64 = 1.25;

/// Directions in half a turn in which an end looks for a corner.
const SIGHTS: u32 = 32;

/// Ratio of two depths of sight at which there is a corner between both.
const DEEPER: f64 = 1.02;

/// Depth up to which corners are sought, as a share of the distance between the ends.
const DEEPEST: f64 = 4.0;

/// Halvings of the angle between two directions in search of a corner: 1e-5 rad remain.
const CORNER_STEPS: u32 = 14;

/// Places beyond a corner at which a tent has its apex, as shares of the depth of sight behind it.
const BEYOND_CORNER: [f64; 4] = [0.001, 0.1, 0.4, 0.8];

/// Contacts nearer to each other than this share of the distance between the ends, times the square root of the error,
/// are one contact: a leg that dips into a smooth solid by the error is in it for a length that grows with the root.
const APART: f64 = 0.1;

/// Maximum height, as a share of the distance between the ends, of the point where the legs over two contacts meet, if
/// both are one contact. The profile between them begins 4e-8 of the distance above them, so that lower points would
/// only show rounding.
const ONE_CONTACT: f64 = 1e-6;

/// Greatest distance between two contacts that can be one, as a share of the distance between the ends.
const TOGETHER: f64 = 1e-3;

/// Greatest length of a rounded edge, as a share of the distance to the next edge, that is not resolved by a profile.
const ROUNDED: f64 = 0.02;

/// A half-plane in which a string is sought.
pub(super) struct Plane<'a, S> {
    pub space: &'a S,
    /// Unit vector from the straight line into the half-plane.
    pub up: DVec3,
    /// Error of a tent's height, as a share of the distance between its ends.
    pub error: f64,
    /// Feet of tents that are tried where no tent over the middle of the solid is free, as shares of the distance between
    /// its ends.
    pub feet: &'a [f64],
    /// Whether a tent over a corner that both ends see is tried where no tent over these feet is free.
    pub seeks_corners: bool,
}

impl<S: Space> Plane<'_, S> {
    /// The contacts of the taut string from `a` to `b`, without its ends; empty if no solid is in the way.
    pub fn contacts(&self, a: DVec3, b: DVec3, depth: u32) -> Option<Vec<Contact>> {
        let Some(at) = self.space.between(a, b) else {
            return Some(Vec::new());
        };
        let length = a.distance(b);
        let behind = self.space.between(b, a)?;
        let middle = 0.5 * (at.metres / length + 1.0 - behind.metres / length);
        let feet = [&[middle], self.feet].concat();
        self.contacts_over(a, b, (&feet, 0.0), depth)
    }

    /// The contacts of the taut string from `a` to `b` over what blocks a tent of the height `blocked` over the first of
    /// these feet.
    pub fn contacts_over(
        &self,
        a: DVec3,
        b: DVec3,
        (feet, blocked): (&[f64], f64),
        depth: u32,
    ) -> Option<Vec<Contact>> {
        let length = a.distance(b);
        let along = (b - a) / length;
        let up = self.up.reject_from_normalized(along).try_normalize()?;
        let apex = |foot: f64, height: f64| a + along * (foot * length) + up * (height * length);
        let is_free = |foot: f64, height: f64| self.space.is_seen_from([a, b], apex(foot, height));
        let first =
            |foot: &f64| Some((*foot, first_free(blocked, |height| is_free(*foot, height))?));
        let over_corner = || {
            let apex = self.over_corner([a, b], up)? - a;
            Some((apex.dot(along) / length, (blocked, apex.dot(up) / length)))
        };
        let is_open = |(_, (blocked, free)): &(f64, (f64, f64))| blocked < free;
        let (foot, (blocked, free)) = feet
            .iter()
            .find_map(first)
            .or_else(|| over_corner().filter(is_open))?;
        let is_free = |height: f64| is_free(foot, height);
        let apex = |height: f64| apex(foot, height);
        let (blocked, free) = bisect(blocked, free, self.error, is_free);
        let (low, top) = (apex(blocked), apex(free));
        let mut lowered = match self.space.between(a, low) {
            Some(_) => self.lowered(a, low, top, b),
            None => self.lowered(b, low, top, a).reversed(),
        };
        let [first, last] = lowered.contacts[..] else {
            return Some(lowered.contacts.into_iter().map(Contact::at).collect());
        };
        let is_flat = height_over([first, last], lowered.apex) < ONE_CONTACT * length;
        if is_flat && first.distance(last) < TOGETHER * length {
            return Some(vec![Contact::at(0.5 * (first + last))]);
        }
        // The line between the contacts lies on the solid: it is lifted by the error of the contacts.
        let lift = up * (4.0 * self.error * length);
        let profile = Profile::cast(
            self.space,
            [first + lift, lowered.apex + lift, last + lift],
            up,
        );
        if let Some(contacts) = profile.and_then(|profile| profile.followed([first, last])) {
            return Some(contacts);
        }
        if depth == 0 {
            return Some(lowered.contacts.drain(..).map(Contact::at).collect());
        }
        let inner = self.contacts(first + lift, last + lift, depth - 1);
        // A ray along a face may end on it: a string has no contact below the line between its neighbours.
        let above = up.reject_from_normalized((last - first).normalize_or_zero());
        let is_above = |contact: &Contact| (contact.point - first).dot(above) > 0.0;
        let mut found = vec![Contact::at(first)];
        found.extend(inner.unwrap_or_default().into_iter().filter(is_above));
        found.push(Contact::at(last));
        follow_ends(&mut found);
        Some(found)
    }

    /// A point that both ends see, just beyond a corner at which the sight of one of them becomes deeper; `None` if there is
    /// none, or if no corners are sought. In a narrow corridor only tents over its inner corner are free.
    fn over_corner(&self, [a, b]: [DVec3; 2], up: DVec3) -> Option<DVec3> {
        if !self.seeks_corners {
            return None;
        }
        [(a, b), (b, a)]
            .into_iter()
            .find_map(|(from, other)| self.over_corner_seen_from(from, other, up))
    }

    /// The point beyond the first corner that `a` sees, counted from the direction of `b` on.
    fn over_corner_seen_from(&self, a: DVec3, b: DVec3, up: DVec3) -> Option<DVec3> {
        let towards = (b - a).normalize_or_zero();
        let most_m = DEEPEST * a.distance(b);
        let direction = |angle: f64| towards * angle.cos() + up * angle.sin();
        let depth_m = |angle: f64| {
            let obstacle = self.space.first(a, direction(angle), most_m);
            obstacle.map_or(most_m, |obstacle| obstacle.metres)
        };
        let mut below = (0.0, depth_m(0.0));
        for index in 1..=SIGHTS {
            let above = PI * f64::from(index) / f64::from(SIGHTS);
            let above = (above, depth_m(above));
            let corner = corner_between([below, above], depth_m);
            below = above;
            let Some([(_, near_m), (angle, far_m)]) = corner else {
                continue;
            };
            let apex = |share: f64| a + direction(angle) * (near_m + (far_m - near_m) * share);
            let mut apexes = BEYOND_CORNER.into_iter().map(apex);
            let free = apexes.find(|apex| self.space.is_seen_from([a, b], *apex));
            if free.is_some() {
                return free;
            }
        }
        None
    }

    /// The contacts of the string from `a`, whose leg to `top` is free but whose leg to `low` is not, to `b`: the apex
    /// is lowered along the leg from `a` until the leg to `b` touches too, or until it reaches the contact.
    fn lowered(&self, a: DVec3, low: DVec3, top: DVec3, b: DVec3) -> Lowered {
        let length = a.distance(top);
        let contact = self.contact(a, low) * length / a.distance(low).max(f64::MIN_POSITIVE);
        let at = |metres: f64| a + (top - a) * (metres / length);
        let is_free = |metres: f64| self.space.is_free(b, at(metres));
        let single = Lowered {
            contacts: vec![at(contact)],
            apex: at(contact),
        };
        if is_free(contact) {
            return single;
        }
        let error = self.error * a.distance(b);
        let (blocked, free) = bisect(contact, length, error, is_free);
        let (low, top) = (at(blocked), at(free));
        let other = self.contact(b, low) * b.distance(top) / b.distance(low).max(f64::MIN_POSITIVE);
        let other = b + (top - b).normalize_or_zero() * other;
        match at(contact).distance(other) < APART * self.error.sqrt() * a.distance(b) {
            true => single,
            false => Lowered {
                contacts: vec![at(contact), other],
                apex: top,
            },
        }
    }

    /// The point at which the leg from `a` or from `b` to a blocked apex touches an obstacle.
    pub fn touched(&self, a: DVec3, apex: DVec3, b: DVec3) -> DVec3 {
        let from = match self.space.is_free(a, apex) {
            true => b,
            false => a,
        };
        from + (apex - from).normalize_or_zero() * self.contact(from, apex)
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

/// A tent that touches the solid with both legs.
struct Lowered {
    /// The points at which the legs touch: one if both touch at the same edge.
    contacts: Vec<DVec3>,
    /// The point at which the legs meet.
    apex: DVec3,
}

impl Lowered {
    fn reversed(mut self) -> Lowered {
        self.contacts.reverse();
        self
    }
}

/// Directions just before and beyond a corner between two directions, each an angle in radians with its depth of sight in
/// metres; `None` if sight becomes no deeper.
fn corner_between(
    [mut low, mut high]: [(f64, f64); 2],
    depth_m: impl Fn(f64) -> f64,
) -> Option<[(f64, f64); 2]> {
    let is_deeper = |[low, high]: [(f64, f64); 2]| high.1 >= low.1 * DEEPER;
    for _ in 0..CORNER_STEPS {
        if !is_deeper([low, high]) {
            return None;
        }
        let angle = 0.5 * (low.0 + high.0);
        let middle = (angle, depth_m(angle));
        // The part in which the depth grows more.
        match middle.1 * middle.1 > low.1 * high.1 {
            true => high = middle,
            false => low = middle,
        }
    }
    is_deeper([low, high]).then_some([low, high])
}

/// Height in metres of a point over the line through two others.
fn height_over([a, b]: [DVec3; 2], point: DVec3) -> f64 {
    let line = (b - a).normalize_or_zero();
    (point - a).reject_from(line).length()
}

/// Lets the string follow the surface next to its first and last contact if another contact is much nearer to them than
/// they are to each other: both lie on one rounded edge.
fn follow_ends(contacts: &mut [Contact]) {
    let Some(last) = contacts.len().checked_sub(1).filter(|last| *last >= 2) else {
        return;
    };
    let near = ROUNDED * contacts[0].point.distance(contacts[last].point);
    for index in [0, last - 1] {
        let apart = contacts[index].point.distance(contacts[index + 1].point);
        contacts[index].is_followed |= apart < near;
    }
}

/// The first of the rising heights above a blocked one that is free, and the one before it.
fn first_free(mut blocked: f64, is_free: impl Fn(f64) -> bool) -> Option<(f64, f64)> {
    let mut height = LOWEST.max(blocked * RAISED);
    while height <= HIGHEST {
        if is_free(height) {
            return Some((blocked, height));
        }
        blocked = height;
        height *= RAISED;
    }
    None
}

/// Narrows the interval between a blocked and a free value, whichever is greater, to `error`.
pub(super) fn bisect(
    mut blocked: f64,
    mut free: f64,
    error: f64,
    is_free: impl Fn(f64) -> bool,
) -> (f64, f64) {
    while (free - blocked).abs() > error {
        let middle = 0.5 * (blocked + free);
        if middle == blocked || middle == free {
            break;
        }
        match is_free(middle) {
            true => free = middle,
            false => blocked = middle,
        }
    }
    (blocked, free)
}
