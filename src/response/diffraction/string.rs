//! Taut strings: the shortest ways from source to listener around what stands between them.
//!
//! A string in one half-plane through the line from source to listener is found by a *tent*: two straight legs over an
//! apex, which is raised until both legs are free, and then lowered along the leg that touches until the other leg
//! touches too (`tent.rs`). The points of contact are those of the taut string; between them it lies on the solid. The lengths in
//! half-planes all around the line give the local shortest ways.
//!
//! Only lines of sight are asked for: a string passes no wall, however thin, and needs no list of edges.

use super::edge::Edge;
use super::round::Arc;
use super::space::Space;
use super::tent::{LOWEST, Plane, bisect};
use super::turn::{Contact, Turn};
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// Number of half-planes in which strings are sought. A gap narrower than 11.25° as seen from the line can be missed.
pub(super) const HALF_PLANES: usize = 32;
/// Angle between neighbouring half-planes in radians.
pub(super) const STEP: f64 = TAU / HALF_PLANES as f64;

/// Factor between the heights of tents that are tried in search of an obstacle beyond a free one.
const RAISED_BEYOND: f64 = 1.5;

/// Error of the height of the tent with the greatest detour, as a share of that of the tent before.
const GREATEST_ERROR: f64 = 0.01;

/// Height of the first tent above a string, as a share of the distance between its ends, and the number of heights that
/// are tried. The height above the string doubles from one to the next.
const OVER: f64 = 1e-4;
const OVER_STEPS: u32 = 12;

/// Foot of the tents beside a free way, as a share of the distance between their ends.
const MIDDLE: f64 = 0.5;

/// Feet of tents, as shares of the distance between their ends, where no tent over the middle of the solid is free: over
/// either end, and beyond. They find the way for ends close to a wall, which leaves at a right angle or backwards.
const FURTHER_FEET: [f64; 4] = [0.0, 1.0, -1.0, 2.0];

/// Error of a tent's height as a share of the distance between its ends, while half-planes are compared: the error of
/// a string's phase is below 0.01 rad at 8 kHz and 10 m.
const COARSE: f64 = 1e-5;
/// Error of a tent's height as a share of the distance between its ends: 1 µm at 100 m.
pub(super) const FINE: f64 = 1e-8;

/// Number of places along a free way at which the distance to surfaces is measured.
const CLEAR_PLACES: usize = 32;

/// Greatest detour of a tent over an edge near one end, as a multiple of the detour over the edge itself.
const TENT_OVER_EDGE: f64 = 3.0;

/// Length of the sum of the unit vectors from both ends to a string's contacts up to which it is straight.
const STRAIGHT: f64 = 1e-3;

/// Contacts of a string with solids that are followed between its first and its last.
const MOST_INNER_DEPTH: u32 = 2;

/// A string from source to listener.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TautString {
    /// Source in world metres.
    pub source: DVec3,
    /// Contacts with solids.
    pub contacts: Vec<Contact>,
    /// Listener in world metres.
    pub listener: DVec3,
    /// Azimuth of the half-plane about the line from source to listener, in radians.
    pub azimuth: f64,
}

impl TautString {
    /// Length in metres.
    pub fn length_m(&self) -> f64 {
        let turns = self.turns();
        let arcs: f64 = turns.iter().map(|turn| turn.arc_m).sum();
        let mut from = self.source;
        let mut straight = 0.0;
        for turn in &turns {
            straight += from.distance(turn.entry);
            from = turn.exit;
        }
        straight + arcs + from.distance(self.listener)
    }

    /// The apex of the tent over the first and the last contact, from the source, and the unit vector in whose direction
    /// tents become longer the fastest: x is along the line from source to listener, y away from it. `None` if the legs do
    /// not meet.
    pub fn tent(&self) -> Option<[DVec2; 2]> {
        let line = self.listener - self.source;
        let along = line.try_normalize()?;
        let flat = |point: DVec3| {
            let from = point - self.source;
            DVec2::new(from.dot(along), from.reject_from_normalized(along).length())
        };
        let [first, last] = [self.contacts.first()?, self.contacts.last()?];
        let [first, last] = [flat(first.point), flat(last.point)];
        let end = DVec2::new(line.length(), 0.0);
        let [rising, falling] = [first, last - end].map(DVec2::normalize_or_zero);
        let outwards = rising + falling;
        if outwards.y < STRAIGHT {
            return Some([first, DVec2::Y]);
        }
        let metres = end.perp_dot(falling) / rising.perp_dot(falling);
        (metres > 0.0).then(|| [rising * metres, outwards.normalize()])
    }

    /// The way along the surface of a string with a single turn.
    pub fn single_arc(&self) -> Option<Arc> {
        let turns = self.turns();
        let [turn] = &turns[..] else {
            return None;
        };
        let before_m = self.source.distance(turn.entry);
        let after_m = self.listener.distance(turn.exit);
        (turn.arc_m > 0.0).then(|| turn.arc(before_m, after_m))
    }

    /// The turns of the string, each at an edge or along a curved surface.
    pub fn turns(&self) -> Vec<Turn> {
        let mut turns = Vec::new();
        let mut first = 0;
        for (index, contact) in self.contacts.iter().enumerate() {
            if contact.is_followed && index + 1 < self.contacts.len() {
                continue;
            }
            let before = match first {
                0 => self.source,
                _ => self.contacts[first - 1].point,
            };
            let after = self.contacts.get(index + 1);
            let after = after.map_or(self.listener, |next| next.point);
            let points = self.contacts[first..=index].iter();
            let points: Vec<DVec3> = points.map(|contact| contact.point).collect();
            turns.push(Turn::along(before, &points, after));
            first = index + 1;
        }
        turns
    }
}

/// Removes the contacts at which the string does not turn: they lie at most `error_m`, the error of a tent's height, from
/// the line between their neighbours. A string along a face has such contacts anywhere on it. One contact always stays.
fn drop_straight(source: DVec3, contacts: &mut Vec<Contact>, listener: DVec3, error_m: f64) {
    let mut index = 0;
    while contacts.len() > 1 && index < contacts.len() {
        let before = index.checked_sub(1).map(|before| contacts[before]);
        let is_followed = contacts[index].is_followed || before.is_some_and(|c| c.is_followed);
        let before = before.map_or(source, |contact| contact.point);
        let after = contacts.get(index + 1);
        let after = after.map_or(listener, |contact| contact.point);
        let (along, point) = (after - before, contacts[index].point - before);
        let height_m = point.reject_from(along).length();
        match height_m <= 2.0 * error_m && !is_followed {
            true => drop(contacts.remove(index)),
            false => index += 1,
        }
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
    /// The half-planes in which strings lead around what is beside the straight way, if that is free, and the greatest detour
    /// in metres up to which it is beside.
    beside: Option<([bool; HALF_PLANES], f64)>,
    /// Height of tents over the middle up to which nothing touches them, as a share of the distance between their ends.
    clear: f64,
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
            beside: None,
            clear: 0.0,
        })
    }

    /// The half-planes about a free way, with the height up to which tents are known to be free by the distances at places
    /// along the way: each point of a tent lies in the clear ball about the place below it.
    pub fn of_free_way(self, space: &impl Space) -> HalfPlanes {
        let step = 0.5 / CLEAR_PLACES as f64;
        let clear = |place: usize| {
            let share = (2 * place + 1) as f64 * step;
            let radius = space.distance(self.source.lerp(self.listener, share));
            let rise = (share.min(1.0 - share) + step) / MIDDLE;
            (radius / self.apart_m() - step) / rise
        };
        let least = (0..CLEAR_PLACES).map(clear).fold(f64::INFINITY, f64::min);
        HalfPlanes {
            clear: least,
            ..self
        }
    }

    /// Half-planes in which strings lead around the far side of what is beside the straight way: in these half-planes, around
    /// the first obstacle above it that blocks a tent with a detour of at most `most_m` metres.
    pub fn around_what_is_beside(
        &self,
        half_planes: [bool; HALF_PLANES],
        most_m: f64,
    ) -> HalfPlanes {
        HalfPlanes {
            beside: Some((half_planes, most_m)),
            ..*self
        }
    }

    /// Whether strings lead around what is beside the straight way.
    pub fn are_beside(&self) -> bool {
        self.beside.is_some()
    }

    /// Whether an obstacle blocks the straight way, or a tent above it in the half-plane with this index.
    pub fn is_blocked(&self, space: &impl Space, index: usize) -> bool {
        let azimuth = index as f64 * STEP;
        self.beside.is_none_or(|(half_planes, most_m)| {
            half_planes[index] && self.beyond(space, azimuth, None, most_m).is_some()
        })
    }

    /// Distance between the points in metres.
    pub fn apart_m(&self) -> f64 {
        self.source.distance(self.listener)
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
        self.string_within(space, azimuth, FINE, (&FURTHER_FEET, true))
    }

    /// The same with the error and the effort of one of many half-planes.
    pub fn coarse_string(&self, space: &impl Space, azimuth: f64) -> Option<TautString> {
        self.string_within(space, azimuth, COARSE, (&[], false))
    }

    fn string_within(
        &self,
        space: &impl Space,
        azimuth: f64,
        error: f64,
        (feet, seeks_corners): (&[f64], bool),
    ) -> Option<TautString> {
        let plane = Plane {
            space,
            up: self.upwards(azimuth),
            error,
            feet,
            seeks_corners,
        };
        let mut contacts = match self.beside {
            Some((_, most_m)) => self.contacts_beside(&plane, most_m)?,
            None => plane.contacts(self.source, self.listener, MOST_INNER_DEPTH)?,
        };
        if contacts.is_empty() {
            return None;
        }
        drop_straight(
            self.source,
            &mut contacts,
            self.listener,
            error * self.apart_m(),
        );
        Some(TautString {
            source: self.source,
            contacts,
            listener: self.listener,
            azimuth,
        })
    }

    /// The contacts of the string around the far side of the first obstacle above the straight way.
    fn contacts_beside(&self, plane: &Plane<impl Space>, most_m: f64) -> Option<Vec<Contact>> {
        let tent = |height: f64| self.apex(MIDDLE, height, plane.up);
        let ends = [self.source, self.listener];
        let is_free =
            |height: f64| height < self.clear || plane.space.is_seen_from(ends, tent(height));
        let (blocked, _) = self.first_blocked(0.0, most_m, tent, is_free)?;
        let tents = (&[MIDDLE][..], blocked);
        plane.contacts_over(self.source, self.listener, tents, MOST_INNER_DEPTH)
    }

    /// The apex of a tent; foot and height are shares of the distance between the ends.
    fn apex(&self, foot: f64, height: f64, up: DVec3) -> DVec3 {
        self.source.lerp(self.listener, foot) + up * (height * self.apart_m())
    }

    /// The first of the heights above a free one that is blocked, and the one before it; `None` if all tents up to a
    /// detour of `most_m` metres are free.
    fn first_blocked(
        &self,
        mut free: f64,
        most_m: f64,
        apex: impl Fn(f64) -> DVec3,
        is_free: impl Fn(f64) -> bool,
    ) -> Option<(f64, f64)> {
        let is_near = |height: f64| self.detour_m(apex(height)) < most_m;
        let mut height = free.max(0.5 * LOWEST) * RAISED_BEYOND;
        while is_near(height) {
            if !is_free(height) {
                return Some((height, free));
            }
            free = height;
            height *= RAISED_BEYOND;
        }
        if !is_near(free) {
            return None;
        }
        let (_, highest) = bisect(height, free, GREATEST_ERROR * free, is_near);
        (!is_free(highest)).then_some((highest, free))
    }

    /// The strings in evenly spread half-planes, from azimuth 0.
    pub fn strings(&self, space: &impl Space) -> Vec<Option<TautString>> {
        let all = |feet: &[f64], seeks_corners: bool| -> Vec<Option<TautString>> {
            let string = |index: usize| {
                let azimuth = index as f64 * STEP;
                let string = || self.string_within(space, azimuth, COARSE, (feet, seeks_corners));
                self.is_sought(index).then(string).flatten()
            };
            (0..HALF_PLANES).map(string).collect()
        };
        let mut strings = all(&[], false);
        if strings.iter().all(Option::is_none) {
            strings = all(&FURTHER_FEET, false);
        }
        if strings.iter().all(Option::is_none) {
            strings = all(&[], true);
        }
        self.continue_beside(space, &mut strings);
        strings
    }

    /// Whether a string is sought in the half-plane with this index.
    pub fn is_sought(&self, index: usize) -> bool {
        self.beside
            .is_none_or(|(half_planes, _)| half_planes[index])
    }

    /// Seeks the missing strings again, with tents over those of the strings in neighbouring half-planes.
    fn continue_beside(&self, space: &impl Space, strings: &mut [Option<TautString>]) {
        for step in [1, HALF_PLANES - 1] {
            for start in 0..HALF_PLANES {
                let mut index = start;
                while let (Some(known), next) = (&strings[index], (index + step) % HALF_PLANES) {
                    if strings[next].is_some() || !self.is_sought(next) {
                        break;
                    }
                    let feet = known.tent().map(|[apex, _]| apex.x / self.apart_m());
                    let azimuth = next as f64 * STEP;
                    strings[next] =
                        self.string_within(space, azimuth, COARSE, (feet.as_slice(), false));
                    index = next;
                }
            }
        }
    }

    /// Source and listener in world metres.
    pub fn ends(&self) -> (DVec3, DVec3) {
        (self.source, self.listener)
    }

    /// Distance in metres of a point from the line between source and listener.
    pub fn height_m(&self, point: DVec3) -> f64 {
        let line = self.listener - self.source;
        (point - self.source).reject_from(line).length()
    }

    /// Difference in metres between the way over a point and the straight one.
    pub fn detour_m(&self, point: DVec3) -> f64 {
        let over = self.source.distance(point) + point.distance(self.listener);
        over - self.apart_m()
    }

    /// The point of a line in the half-plane of an azimuth; `None` if the line does not cross it.
    pub fn on_line(&self, line: &Edge, azimuth: f64) -> Option<DVec3> {
        let (up, normal) = (self.upwards(azimuth), self.upwards(azimuth + 0.25 * TAU));
        let steep = line.along.dot(normal);
        if steep.abs() < f64::EPSILON {
            return None;
        }
        let from = line.point - self.source;
        let point = line.point - line.along * (from.dot(normal) / steep);
        ((point - self.source).dot(up) > 0.0).then_some(point)
    }

    /// The point at which an obstacle touches the lowest tent that it blocks, in the half-plane of an azimuth: above the
    /// straight line, or above a string. `None` if the detour over this point is not below `most_m` metres, or if all tents
    /// are free.
    pub fn beyond(
        &self,
        space: &impl Space,
        azimuth: f64,
        above: Option<&TautString>,
        most_m: f64,
    ) -> Option<DVec3> {
        let length = self.apart_m();
        let plane = Plane {
            space,
            up: self.upwards(azimuth),
            error: FINE,
            feet: &[],
            seeks_corners: false,
        };
        let along = (self.listener - self.source) / length;
        let [base, outwards] = match above {
            Some(string) => string.tent()?,
            None => [DVec2::X * (MIDDLE * length), DVec2::Y],
        };
        let apex = |height: f64| {
            let at = base + outwards * (height * length);
            self.source + along * at.x + plane.up * at.y
        };
        let clear = if above.is_none() { self.clear } else { 0.0 };
        let ends = [self.source, self.listener];
        let is_free = |height: f64| height < clear || space.is_seen_from(ends, apex(height));
        let mut free = 0.0;
        if above.is_some() {
            // Contacts have errors.
            let mut steps = (0..OVER_STEPS).map(|step| OVER * f64::from(1 << step));
            free = steps.find(|height| is_free(*height))?;
        }
        let tents_m = TENT_OVER_EDGE * most_m;
        let (blocked, free) = self.first_blocked(free, tents_m, apex, is_free)?;
        let (blocked, _) = bisect(blocked, free, plane.error, is_free);
        let touch = plane.touched(self.source, apex(blocked), self.listener);
        (self.detour_m(touch) < most_m).then_some(touch)
    }

    /// A point on the surface that a tent touches, and a unit vector along the surface, both in the half-plane of an azimuth;
    /// `None` without a gradient.
    pub fn on_face(
        &self,
        space: &impl Space,
        azimuth: f64,
        touch: DVec3,
    ) -> Option<(DVec3, DVec3)> {
        let along = (self.listener - self.source).try_normalize()?;
        let up = self.upwards(azimuth);
        let step = COARSE * self.apart_m();
        let lifted = touch - up * (2.0 * step);
        let slope = |axis: DVec3| {
            let ends = [step, -step].map(|metres| space.distance(lifted + axis * metres));
            (ends[0] - ends[1]) / (2.0 * step)
        };
        let gradient = [slope(along), slope(up)];
        let face = (along * gradient[1] - up * gradient[0]).try_normalize()?;
        // A leg ends within its error above the surface.
        let outwards = along * gradient[0] + up * gradient[1];
        let point = touch - outwards * (space.distance(touch) / outwards.length_squared());
        Some((point, face))
    }
}
