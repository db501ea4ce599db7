//! Traces waves in an empty rectangular room, in `f64`: straight lines through the unfolded room.

use crate::acoustics::Arrival;
use crate::bands::{BAND_COUNT, Bands};
use crate::rng::{hash, unit_interval};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// An empty room about the origin, with a source and a listener that is completely inside.
#[derive(Clone, Debug)]
pub(super) struct Room {
    pub(super) size: DVec3,
    pub(super) source: DVec3,
    pub(super) listener: DVec3,
    pub(super) radius: f64,
    /// Absorption of the walls at −x, +x, −y, +y, −z, +z; below 1.
    pub(super) absorption: [Bands; 6],
}

/// A line on its way through the copies of the room.
struct Line {
    direction: DVec3,
    crossed: [u32; 3],
    /// Metres to the next wall along each axis, and between walls.
    ahead_m: [f64; 3],
    apart_m: [f64; 3],
}

impl Room {
    /// Follows `waves` random waves for `length_m` metres, and passes on each crossing of the
    /// listener with more than `early_order` reflections.
    pub(super) fn trace(
        &self,
        waves: u32,
        length_m: f64,
        early_order: Option<u32>,
        seed: u64,
        take: &mut dyn FnMut(Arrival),
    ) {
        let volume = 4.0 / 3.0 * PI * self.radius.powi(3);
        let share = 1.0 / (volume * f64::from(waves));
        for wave in 0..waves {
            let mut line = self.line(random_direction(seed, wave));
            loop {
                let order: u32 = line.crossed.iter().sum();
                if let Some((middle_m, chord_m)) = self.crossing(&line)
                    && middle_m < length_m
                    && early_order.is_none_or(|early| order > early)
                {
                    let reflectance = self.reflectance(&line);
                    take(Arrival {
                        wave,
                        is_early: false,
                        reflections: order,
                        length_m: middle_m,
                        direction: line.folded_direction(),
                        energy: reflectance.map(|reflectance| reflectance * chord_m * share),
                    });
                }
                if line.advance() > length_m {
                    break;
                }
            }
        }
    }

    fn line(&self, direction: DVec3) -> Line {
        let axes = [0, 1, 2];
        let wall = |axis: usize| self.size[axis] / 2.0 * direction[axis].signum();
        Line {
            direction,
            crossed: [0; 3],
            ahead_m: axes.map(|axis| (wall(axis) - self.source[axis]) / direction[axis]),
            apart_m: axes.map(|axis| self.size[axis] / direction[axis].abs()),
        }
    }

    /// Metres to the middle of the chord through the listener in this copy, and length of the
    /// chord.
    fn crossing(&self, line: &Line) -> Option<(f64, f64)> {
        let image: [f64; 3] = std::array::from_fn(|axis| {
            let number = f64::from(line.crossed[axis]) * line.direction[axis].signum();
            let place = self.listener[axis];
            let mirrored = if line.crossed[axis] % 2 == 1 {
                -place
            } else {
                place
            };
            number * self.size[axis] + mirrored
        });
        let offset = DVec3::from(image) - self.source;
        let middle_m = offset.dot(line.direction);
        let miss = offset - middle_m * line.direction;
        let half_squared = self.radius * self.radius - miss.length_squared();
        (half_squared > 0.0 && middle_m > 0.0).then(|| (middle_m, 2.0 * half_squared.sqrt()))
    }

    fn reflectance(&self, line: &Line) -> Bands {
        let mut exponents = [0.0; BAND_COUNT];
        for axis in 0..3 {
            let (first, second) = (line.crossed[axis].div_ceil(2), line.crossed[axis] / 2);
            let upper_first = line.direction[axis] > 0.0;
            let (upper, lower) = if upper_first {
                (first, second)
            } else {
                (second, first)
            };
            for (band, exponent) in exponents.iter_mut().enumerate() {
                *exponent += f64::from(lower) * (1.0 - self.absorption[2 * axis][band]).ln()
                    + f64::from(upper) * (1.0 - self.absorption[2 * axis + 1][band]).ln();
            }
        }
        exponents.map(f64::exp)
    }
}

impl Line {
    /// Moves to the next copy, and returns the distance of its start.
    fn advance(&mut self) -> f64 {
        let nearer = |a, b| {
            if self.ahead_m[b] < self.ahead_m[a] {
                b
            } else {
                a
            }
        };
        let axis = nearer(nearer(0, 1), 2);
        let begins_m = self.ahead_m[axis];
        self.crossed[axis] += 1;
        self.ahead_m[axis] += self.apart_m[axis];
        begins_m
    }

    /// The direction in the original room.
    fn folded_direction(&self) -> DVec3 {
        let sign = |axis: usize| {
            if self.crossed[axis] % 2 == 1 {
                -1.0
            } else {
                1.0
            }
        };
        self.direction * DVec3::new(sign(0), sign(1), sign(2))
    }
}

/// Evenly distributed over the sphere, by Archimedes' cylinder.
fn random_direction(seed: u64, wave: u32) -> DVec3 {
    let key = hash(seed).wrapping_add(2 * u64::from(wave));
    let z = 2.0 * unit_interval(hash(key)) - 1.0;
    let (sin, cos) = (TAU * unit_interval(hash(key.wrapping_add(1)))).sin_cos();
    let across = (1.0 - z * z).sqrt();
    DVec3::new(across * cos, across * sin, z)
}
