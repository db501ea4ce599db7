//! What lies between a source and what it brings to a listener, besides the surfaces.

use crate::acoustics::{Arrival, Echogram};
use crate::bands::{self, Bands};
use crate::scene::Scene;

/// What lies between a source and what it brings to a listener, besides the surfaces.
pub(super) struct Medium {
    /// Metres a second.
    pub speed: f64,
    /// Attenuation of energy by band, in 1/m.
    pub air: Bands,
    /// The source's level as a factor of energy.
    pub level: f64,
    /// When the direct sound arrives if nothing is in its way, in seconds.
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

    /// The energy of an arrival, with the source's level and the air's loss.
    pub fn heard(&self, arrival: &Arrival) -> Bands {
        let emitted = arrival.energy.map(|energy| energy * self.level);
        bands::through_air(&emitted, &self.air, arrival.length_m)
    }

    /// Adds an arrival, with the source's level and the air's loss. One whose numbers are none, by a driver that is wrong,
    /// counts nowhere.
    pub fn add(&self, echogram: &mut Echogram, arrival: &Arrival) {
        let mut arrival = *arrival;
        arrival.energy = arrival.energy.map(|energy| energy * self.level);
        // The only error is that of such numbers.
        let _ = echogram.add_arrival(&arrival, self.speed, &self.air);
    }
}
