//! Effects on the sound between source and listener, except those of the surfaces.

use crate::acoustics::{Arrival, Echogram};
use crate::bands::{self, Bands};
use crate::scene::Scene;

/// Effects on the sound between source and listener, except those of the surfaces.
pub(super) struct Medium {
    /// Speed of sound in metres per second.
    pub speed: f64,
    /// Attenuation of energy by band, in 1/m.
    pub air: Bands,
    /// The source's level as a factor of energy.
    pub level: f64,
    /// Arrival of the direct sound if unobstructed, in seconds.
    pub direct_s: f64,
}

impl Medium {
    pub fn of(scene: &Scene) -> Medium {
        let speed = scene.speed_of_sound();
        let apart = scene.source.position.as_dvec3() - scene.listener.position.as_dvec3();
        Medium {
            speed,
            air: scene.air_attenuation(),
            level: 10_f64.powf(f64::from(scene.source.level_db) / 10.0),
            direct_s: apart.length() / speed,
        }
    }

    /// The energy of an arrival, with the source's level and the loss in the air.
    pub fn heard(&self, arrival: &Arrival) -> Bands {
        let emitted = arrival.energy.map(|energy| energy * self.level);
        bands::through_air(&emitted, &self.air, arrival.length_m)
    }

    /// Adds an arrival, with the source's level and the loss in the air. Ignores one with invalid numbers, from a
    /// faulty driver.
    pub fn add(&self, echogram: &mut Echogram, arrival: &Arrival) {
        let mut arrival = *arrival;
        arrival.energy = arrival.energy.map(|energy| energy * self.level);
        // The only error is that of invalid numbers.
        let _ = echogram.add_arrival(&arrival, self.speed, &self.air);
    }
}
