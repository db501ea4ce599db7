//! Lines of sight past fields: whether a solid is on a line, and where the line enters it.
//!
//! A march that steps by the distance takes 1/√h steps past a curved surface at the height h. Here a step also uses the
//! slope along the line, and a bound of the second derivative (`hollow.rs`). The number of steps then grows with log h:
//!
//! - Beside a convex solid the distance is convex along a line, so that the secant through the last two points is a lower
//!   bound beyond them. The line is free up to the zero of the secant, and free to its end if the secant rises.
//! - With a bound b of the second derivative, the line is free up to the zero of the parabola that bends by −b.
//! - Fields that are not convex have a minimum step. A minimum between two such steps is refined. A part of a solid that
//!   is thinner than this step can be missed where it stands on a surface of the same field that the line passes at less
//!   than the step. The parts of a union are tested one by one, so that none hides another.

use super::false_position::root;
use super::hollow::Hollow;
use crate::scene::{Bounds3, Shape};
use glam::DVec3;

/// Maximum value at a point on the surface, as a share of the extent.
const TOUCH: f64 = 1e-12;

/// Minimum step of fields that are not convex, as a share of the length of the line.
const LEAST_STEP: f64 = 1e-3;

/// Distance ahead at which the value is sampled to decide whether a line that starts on a surface enters the solid, as a
/// share of the extent.
const AHEAD: f64 = 1e-8;

/// Maximum number of steps. A line takes some tens.
const STEPS: usize = 20_000;

/// Maximum number of points at which a minimum is refined.
const REFINED: usize = 40;

/// Distance of these points from the ends of the interval, as a share of its width.
const INNER: f64 = 0.02;

/// Share of the smaller distance at the ends of an interval above which its lower bound counts as free: the distance is not
/// exactly convex.
const CLEAR: f64 = 0.5;

/// Greatest length of a secant, as a multiple of the width of the interval beside it.
const NEAR: f64 = 2.0;

/// Margin of bounding boxes, as a share of the extent.
const SPARE: f64 = 1e-5;

/// A part of a field: a solid that is united with the other parts.
#[derive(Clone, Debug)]
pub(super) struct SightPart {
    shape: Shape,
    inverse_lipschitz: f64,
    bounds: Bounds3,
    extent: f64,
    hollow: Option<Hollow>,
}

/// A line through a part.
struct Line<'a> {
    part: &'a SightPart,
    origin: DVec3,
    /// A unit vector.
    direction: DVec3,
    /// Maximum distance of a point on the surface in metres.
    touch: f64,
    /// Minimum step in metres.
    least: f64,
}

/// A point of a line.
#[derive(Clone, Copy, Debug)]
struct Sample {
    /// Distance along the line in metres.
    t: f64,
    /// A lower bound of the distance to the solid in metres.
    distance: f64,
}

impl SightPart {
    /// The parts of a field.
    pub fn all(field: &Shape) -> Vec<SightPart> {
        let parts = field.united();
        parts.into_iter().map(SightPart::new).collect()
    }

    fn new(shape: &Shape) -> SightPart {
        let properties = shape.properties();
        let extent = Some(shape.extent()).filter(|e| *e > 0.0).unwrap_or(1.0);
        SightPart {
            shape: shape.clone(),
            inverse_lipschitz: 1.0 / properties.lipschitz,
            bounds: properties.bounds.grown(DVec3::splat(SPARE * extent)),
            extent,
            hollow: Hollow::in_air(shape).map(|hollow| hollow.scaled(properties.lipschitz)),
        }
    }

    /// Distance in metres from `origin` along a unit vector to the point where the line enters the solid; `None` if it does
    /// not within `until` metres.
    pub fn enters(&self, origin: DVec3, direction: DVec3, until: f64) -> Option<f64> {
        let (from, to) = within(&self.bounds, origin, direction, until)?;
        let size = self.extent.max(origin.abs().max_element());
        let touch = TOUCH * size;
        let is_convex = self.is_convex();
        let line = Line {
            part: self,
            origin,
            direction,
            touch,
            least: match is_convex {
                true => touch,
                false => LEAST_STEP * (to - from),
            },
        };
        line.enters(from, to)
    }

    fn is_convex(&self) -> bool {
        self.hollow.is_some_and(|hollow| hollow.bend == 0.0)
    }
}

impl Line<'_> {
    fn at(&self, t: f64) -> Sample {
        let value = self.part.shape.value(self.origin + t * self.direction);
        Sample {
            t,
            distance: value * self.part.inverse_lipschitz,
        }
    }

    fn enters(&self, from: f64, to: f64) -> Option<f64> {
        let mut here = match self.start(from, to)? {
            Start::InAir(sample) => sample,
            Start::Enters(t) => return Some(t),
        };
        let mut passed: [Option<Sample>; 2] = [None; 2];
        // Whether the line is known to be free up to `here`.
        let mut is_known = true;
        for _ in 0..STEPS {
            let slope = passed[1].map(|last| last.slope_to(here));
            if self.part.is_convex() && slope.is_some_and(|slope| slope >= 0.0) {
                return None;
            }
            if here.distance <= self.touch && self.falls(here) {
                return Some(here.t);
            }
            if here.t >= to {
                return self.dips(passed, here, None).filter(|_| !is_known);
            }
            let safe = self.safe_step(here, passed[1]);
            let step = safe.max(self.least);
            let next = self.at((here.t + step).min(to));
            if next.distance < -self.touch {
                return Some(self.root(here, next));
            }
            if !is_known && let Some(entry) = self.dips(passed, here, Some(next)) {
                return Some(entry);
            }
            is_known = step <= safe;
            passed = [passed[1], Some(here)];
            here = next;
        }
        None
    }

    /// The first sample in the air from `from` on. A start on the surface or in the solid can be the result of rounding: the
    /// line is blocked there only if it leads further in.
    fn start(&self, from: f64, to: f64) -> Option<Start> {
        let mut t = from;
        for _ in 0..STEPS {
            let sample = self.at(t);
            if sample.distance > self.touch {
                return Some(Start::InAir(sample));
            }
            if self.falls(sample) {
                return Some(Start::Enters(t));
            }
            t += sample.distance.abs().max(self.least);
            if t > to {
                return None;
            }
        }
        None
    }

    /// Whether the distance falls beyond a sample.
    fn falls(&self, sample: Sample) -> bool {
        self.at(sample.t + AHEAD * self.part.extent).distance < sample.distance
    }

    /// Length in metres behind a sample that is free, with the sample before it.
    fn safe_step(&self, here: Sample, last: Option<Sample>) -> f64 {
        let distance = here.distance.max(self.touch);
        let (Some(last), Some(hollow)) = (last, self.part.hollow) else {
            return distance;
        };
        if distance > hollow.reach_m {
            return distance;
        }
        let Hollow { bend, reach_m } = hollow;
        // The slope at the sample is at least this one.
        let slope = last.slope_to(here) - 0.5 * bend * (here.t - last.t);
        // The zero of distance + slope s − bend s²/2.
        let root = (slope * slope + 2.0 * bend * distance).sqrt();
        let step = 2.0 * distance / (root - slope);
        distance.max(step.min(reach_m))
    }

    /// The point at which the line enters a solid between the last of the samples `passed` and `here`, if both are in the
    /// air. `next` is the sample behind them.
    ///
    /// The distance is taken as convex there: it lies above the secants through the samples before and behind.
    fn dips(
        &self,
        [before, last]: [Option<Sample>; 2],
        here: Sample,
        next: Option<Sample>,
    ) -> Option<f64> {
        let mut gap = Gap {
            from: last?,
            to: here,
            falling: -1.0,
            rising: 1.0,
        };
        if gap.from.distance + gap.to.distance >= gap.width() {
            return None;
        }
        // A secant over a much longer part of the line, or of a greater slope, belongs to another surface.
        let near = NEAR * gap.width();
        let own = gap.from.slope_to(here);
        if let Some(before) = before.filter(|before| gap.from.t - before.t <= near) {
            gap.falling = Some(before.slope_to(gap.from))
                .filter(|slope| *slope <= own)
                .unwrap_or(-1.0);
        }
        if let Some(next) = next.filter(|next| next.t - here.t <= near) {
            gap.rising = Some(here.slope_to(next))
                .filter(|slope| *slope >= own)
                .unwrap_or(1.0);
        }
        let mut waiting = vec![gap];
        for _ in 0..REFINED {
            let gap = waiting.pop()?;
            let clear = CLEAR * gap.from.distance.min(gap.to.distance);
            let lowest = gap.lowest().filter(|lowest| lowest.distance < clear);
            let Some(lowest) = lowest.filter(|_| gap.width() > self.touch) else {
                continue;
            };
            let inner = INNER * gap.width();
            let sample = self.at(lowest.t.clamp(gap.from.t + inner, gap.to.t - inner));
            if sample.distance < -self.touch {
                return Some(self.root(gap.from, sample));
            }
            let [before, behind] = gap.split(sample);
            waiting.extend([behind, before]);
        }
        None
    }

    /// The point between a sample in the air and one in the solid at which the line enters the solid.
    fn root(&self, air: Sample, solid: Sample) -> f64 {
        let ends = [air, solid].map(|sample| (sample.t, sample.distance));
        root(|t| self.at(t).distance, ends, self.touch)
    }
}

/// The start of a line.
enum Start {
    InAir(Sample),
    /// The line enters the solid at this distance in metres.
    Enters(f64),
}

impl Sample {
    /// Mean slope to a later sample.
    fn slope_to(self, later: Sample) -> f64 {
        (later.distance - self.distance) / (later.t - self.t)
    }
}

/// The part of a line between two samples.
#[derive(Clone, Copy, Debug)]
struct Gap {
    from: Sample,
    to: Sample,
    /// Slopes of the secants that end at `from` and begin at `to`.
    falling: f64,
    rising: f64,
}

impl Gap {
    fn width(&self) -> f64 {
        self.to.t - self.from.t
    }

    /// The point where the secants meet, if they meet between the samples.
    fn lowest(&self) -> Option<Sample> {
        let Gap {
            from,
            to,
            falling,
            rising,
        } = *self;
        if falling >= 0.0 || rising <= 0.0 {
            return None;
        }
        let along = (from.distance - to.distance + rising * self.width()) / (rising - falling);
        Some(Sample {
            t: from.t + along,
            distance: from.distance + falling * along,
        })
    }

    /// The parts before and behind a sample between the ends.
    fn split(self, sample: Sample) -> [Gap; 2] {
        let left = Gap {
            to: sample,
            rising: sample.slope_to(self.to),
            ..self
        };
        let right = Gap {
            from: sample,
            falling: self.from.slope_to(sample),
            ..self
        };
        [left, right]
    }
}

/// The part of a line up to `until` metres that lies in a box, as distances in metres.
fn within(bounds: &Bounds3, origin: DVec3, direction: DVec3, until: f64) -> Option<(f64, f64)> {
    let inverse = direction.recip();
    let (low, high) = (
        (bounds.min - origin) * inverse,
        (bounds.max - origin) * inverse,
    );
    let from = low.min(high).max_element().max(0.0);
    let to = low.max(high).min_element().min(until);
    (from <= to).then_some((from, to))
}

#[cfg(test)]
mod tests {
    use super::super::marched::MarchedField;
    use crate::scene::shape::tests::table::{Entry, on_cpu};
    use crate::test_common::Random;
    use glam::DVec3;

    /// Depth in the solid, as a share of the line's length, of a part that a line of sight may miss.
    const MISSED: f64 = 1e-9;

    /// Lines that start at random points in the air. Every second line is aimed at a point near the surface, the others
    /// at random points.
    fn lines(entry: &Entry, random: &mut Random) -> Vec<(DVec3, DVec3)> {
        let mut place = || 2.0 * entry.reach() * random.unit() * random.direction();
        let places: Vec<DVec3> = std::iter::repeat_with(&mut place).take(400).collect();
        let mut all = Vec::new();
        for pair in places.windows(2) {
            let aim = match all.len() % 2 {
                0 => pair[1],
                _ => onto_surface(entry, pair[1]),
            };
            all.push((pair[0], (aim - pair[0]).normalize_or(DVec3::X)));
        }
        all.retain(|(start, _)| entry.distance(*start) > 1e-3 * entry.reach());
        all
    }

    /// A point near the surface, within a hundred thousandth of the reach if the search converges.
    fn onto_surface(entry: &Entry, mut p: DVec3) -> DVec3 {
        for _ in 0..8 {
            let step = 1e-5 * entry.reach();
            let gradient = DVec3::from_array(DVec3::AXES.map(|axis| {
                (entry.distance(p + axis * step) - entry.distance(p - axis * step)) / (2.0 * step)
            }));
            p -= gradient * (entry.distance(p) / gradient.length_squared().max(1e-3));
        }
        p
    }

    /// The greatest depth on a line between two distances.
    fn depth(entry: &Entry, (start, direction): (DVec3, DVec3), [from, to]: [f64; 2]) -> f64 {
        let at = |index: usize| from + (to - from) * (index as f64 / 2000.0);
        let depths = (0..=2000).map(|index| -entry.distance(start + direction * at(index)));
        depths.fold(0.0, f64::max)
    }

    /// Protects lines of sight past every shape and operator: they enter solids where a march that steps by the distance
    /// enters them, and no line that this march finds blocked is free.
    #[test]
    fn lines_of_sight_end_where_a_march_ends() {
        let mut random = Random(3);
        let mut blocked = 0;
        for entry in on_cpu() {
            let field = MarchedField::new(&entry.field);
            for (start, direction) in lines(&entry, &mut random) {
                let until = 4.0 * entry.reach();
                let marched = field.intersect(start, direction, until);
                let seen = field.enters(start, direction, until);
                blocked += usize::from(seen.is_some());
                let [first, last] = match (marched, seen) {
                    (Some(a), Some(b)) => [a.min(b), a.max(b)],
                    (Some(a), None) => [a, a + 0.01 * until],
                    // The march gives up on lines that graze a surface.
                    (None, Some(b)) => [b, b + 1e-6 * until],
                    (None, None) => continue,
                };
                if last - first < 1e-6 * until && seen.is_some() {
                    continue;
                }
                let missed = depth(&entry, (start, direction), [first, last]);
                assert!(
                    missed < MISSED * until,
                    "{}: {marched:?} and {seen:?}, {missed} m deep, from {start} along {direction}",
                    entry.name
                );
            }
        }
        assert!(blocked > 3000, "{blocked}");
    }

    /// Protects thin parts of unions: a line just above the floor is blocked by a thin screen on it.
    #[test]
    fn parts_of_a_union_are_tested_apart() {
        use crate::scene::Shape;
        use crate::scene::shape::{Cuboid, Sphere};
        use glam::Vec3;
        let screen = Shape::from(Cuboid {
            size: Vec3::new(1e-4, 1.0, 1.0),
        });
        let floor = Shape::from(Cuboid {
            size: Vec3::new(10.0, 1.0, 10.0),
        });
        let ball = Shape::from(Sphere { radius: 0.1 }).translate([0.0, 3.0, 0.0]);
        let field = MarchedField::new(&Shape::union([
            screen.translate([0.0, 0.5, 0.0]),
            floor.translate([0.0, -0.5, 0.0]),
            ball,
        ]));
        // A tenth of a millimetre thick, a micrometre above the floor.
        let met = field.enters(DVec3::new(-4.0, 1e-6, 0.1), DVec3::X, 8.0);
        assert!(met.is_some_and(|t| (t - 3.99995).abs() < 1e-6), "{met:?}");
    }
}
