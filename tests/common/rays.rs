//! An independent reference for rooms that contain boxes and scattering materials: rays in `f64`, without any code of
//! the tracer.
//!
//! A ray that crosses the listener's sphere along a chord of length s adds its energy × s ÷ (rays × open volume), at
//! the time of the chord's middle. A share of the reflections is scattered by Lambert's law; the others are specular.

use super::Random;
use glam::DVec3;
use std::f64::consts::PI;

/// Speed of sound in metres per second.
pub const SPEED: f64 = 343.0;

/// Width of a time bin in seconds.
const BIN_S: f64 = 1e-4;

/// Number of batches from which errors are estimated.
const BATCHES: usize = 16;

/// Energy below which a ray is no longer traced.
const LEAST_ENERGY: f64 = 1e-7;

/// Absorption and scattering coefficients of a surface, each 0 to 1.
#[derive(Clone, Copy, Debug)]
pub struct Wall {
    pub absorption: f64,
    pub scattering: f64,
}

/// A room centred on the origin that contains solid boxes, each given by its centre and size in metres.
#[derive(Clone, Debug)]
pub struct RoomWithBoxes {
    pub size: DVec3,
    pub walls: Wall,
    pub boxes: Vec<(DVec3, DVec3, Wall)>,
    pub source: DVec3,
    pub listener: DVec3,
    pub radius: f64,
}

/// The estimate of a figure, and its standard deviation.
pub type Estimate = (f64, f64);

/// The figures G, C50 and C80 in decibels, and Ts in seconds.
pub type Sums = [Estimate; 4];

/// Energy of the rays at the listener, by batch and time bin.
pub struct Echoes {
    batches: Vec<Vec<f64>>,
}

impl RoomWithBoxes {
    /// Whether a position is inside a solid.
    pub fn is_solid(&self, place: DVec3) -> bool {
        let inside = |middle: DVec3, size: DVec3| (place - middle).abs().cmplt(0.5 * size).all();
        let in_box = self
            .boxes
            .iter()
            .any(|(middle, size, _)| inside(*middle, *size));
        in_box || !inside(DVec3::ZERO, self.size)
    }

    /// Traces `rays` rays for `seconds` seconds.
    pub fn echoes(&self, rays: usize, seconds: f64, seed: u64) -> Echoes {
        let mut random = Random(seed);
        let open = self.open_volume(&mut random);
        let bins = (seconds / BIN_S) as usize;
        let mut batches = vec![vec![0.0; bins]; BATCHES];
        let share = BATCHES as f64 / (rays as f64 * open);
        for ray in 0..rays {
            let batch = &mut batches[ray % BATCHES];
            self.follow(&mut random, seconds, &mut |at_s, energy| {
                if let Some(bin) = batch.get_mut((at_s / BIN_S) as usize) {
                    *bin += energy * share;
                }
            });
        }
        Echoes { batches }
    }

    fn open_volume(&self, random: &mut Random) -> f64 {
        const PLACES: usize = 200_000;
        let is_open = |_: &usize| {
            let place = loop {
                let place = DVec3::from_array([(); 3].map(|()| random.signed()));
                if place.length_squared() <= 1.0 {
                    break place;
                }
            };
            !self.is_solid(self.listener + self.radius * place)
        };
        let open = (0..PLACES).filter(is_open).count();
        4.0 / 3.0 * PI * self.radius.powi(3) * open as f64 / PLACES as f64
    }

    fn follow(&self, random: &mut Random, seconds: f64, take: &mut dyn FnMut(f64, f64)) {
        let (mut place, mut direction) = (self.source, random.direction());
        let (mut flown, mut energy) = (0.0, 1.0);
        while flown < seconds * SPEED && energy > LEAST_ENERGY {
            let (length, normal, wall) = self.hit(place, direction);
            let to_listener = self.listener - place;
            let middle = to_listener.dot(direction);
            let beside = to_listener.length_squared() - middle * middle;
            if beside < self.radius * self.radius {
                let half = (self.radius * self.radius - beside).sqrt();
                let (from, to) = ((middle - half).max(0.0), (middle + half).min(length));
                if to > from {
                    take((flown + 0.5 * (from + to)) / SPEED, energy * (to - from));
                }
            }
            flown += length;
            place += direction * length;
            energy *= 1.0 - wall.absorption;
            direction = match random.unit() < wall.scattering {
                true => (normal + random.direction()).normalize(),
                false => direction - 2.0 * direction.dot(normal) * normal,
            };
        }
    }

    /// Returns the length of the flight to the next hit, the normal at the hit, and the surface.
    fn hit(&self, place: DVec3, direction: DVec3) -> (f64, DVec3, Wall) {
        let half = 0.5 * self.size;
        let mut nearest = (f64::INFINITY, DVec3::ZERO, self.walls);
        for axis in 0..3 {
            let plane = half[axis].copysign(direction[axis]);
            let length = ((plane - place[axis]) / direction[axis]).max(0.0);
            if length < nearest.0 {
                nearest = (
                    length,
                    -DVec3::AXES[axis] * direction[axis].signum(),
                    self.walls,
                );
            }
        }
        for (middle, size, wall) in &self.boxes {
            let (near, far) = (place - *middle, 0.5 * *size);
            let (mut enters, mut leaves, mut face) = (f64::NEG_INFINITY, f64::INFINITY, 0);
            for axis in 0..3 {
                let at = |side: f64| (side - near[axis]) / direction[axis];
                let (first, last) = (
                    at(far[axis]).min(at(-far[axis])),
                    at(far[axis]).max(at(-far[axis])),
                );
                if first > enters {
                    (enters, face) = (first, axis);
                }
                leaves = leaves.min(last);
            }
            if enters < leaves && enters > 1e-9 && enters < nearest.0 {
                nearest = (enters, -DVec3::AXES[face] * direction[face].signum(), *wall);
            }
        }
        nearest
    }
}

impl Echoes {
    /// The figures, with times counted from `origin_s` seconds, and their standard deviations by the jackknife over the
    /// batches.
    pub fn sums(&self, origin_s: f64) -> Sums {
        let without = |left_out: Option<usize>| {
            let kept = (0..BATCHES).filter(|batch| Some(*batch) != left_out);
            let count = kept.clone().count() as f64;
            let bin = |bin: usize| kept.clone().map(|b| self.batches[b][bin]).sum::<f64>() / count;
            let (mut sum, mut within, mut moment) = (0.0, [0.0; 2], 0.0);
            for number in 0..self.batches[0].len() {
                let energy = bin(number);
                let after_s = ((number as f64 + 0.5) * BIN_S - origin_s).max(0.0);
                sum += energy;
                moment += energy * after_s;
                for (within, limit_s) in within.iter_mut().zip([0.05, 0.08]) {
                    *within += if after_s < limit_s { energy } else { 0.0 };
                }
            }
            let decibels = |ratio: f64| 10.0 * ratio.log10();
            let clarity = within.map(|early| decibels(early / (sum - early)));
            [
                decibels(sum * 4.0 * PI * 100.0),
                clarity[0],
                clarity[1],
                moment / sum,
            ]
        };
        let all = without(None);
        let some: Vec<[f64; 4]> = (0..BATCHES).map(|batch| without(Some(batch))).collect();
        std::array::from_fn(|figure| {
            let off = |some: &[f64; 4]| (some[figure] - all[figure]).powi(2);
            let variance = some.iter().map(off).sum::<f64>() * (1.0 - 1.0 / BATCHES as f64);
            (all[figure], variance.sqrt())
        })
    }
}
