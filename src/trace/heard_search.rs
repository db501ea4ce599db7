//! The search for waves that reach the listener.

use super::{Fate, Settings, Tracer};
use crate::error::Error;
use crate::scene::Scene;
use glam::Vec3;

/// Traces waves with one seed after another, and keeps the start directions of those searched
/// for. Tracing these again gives their paths.
#[derive(Clone, Debug, Default)]
pub struct HeardSearch {
    /// Of waves that reached the listener.
    pub heard: Vec<Vec3>,
    /// Of other waves.
    pub others: Vec<Vec3>,
    /// Times that waves were traced.
    pub searches: u32,
}

/// Directions that are kept at most.
#[derive(Clone, Copy, Debug)]
pub struct MostKept {
    pub heard: usize,
    pub others: usize,
}

impl HeardSearch {
    /// Traces the waves of `settings`, each time with the next seed, and keeps the first ones
    /// of them.
    ///
    /// # Errors
    /// As [`Tracer::frame`].
    pub fn search(
        &mut self,
        tracer: &mut Tracer,
        scene: &Scene,
        settings: &Settings,
        most: MostKept,
    ) -> Result<(), Error> {
        let settings = Settings {
            seed: settings.seed.wrapping_add(self.searches),
            ..settings.clone()
        };
        self.searches += 1;
        let (_, waves) = tracer.frame_with_waves(scene, &settings)?;
        for wave in waves {
            let (kept, most) = match wave.fate() {
                Fate::Listener => (&mut self.heard, most.heard),
                Fate::Dead | Fate::Travelling | Fate::NotFinite => (&mut self.others, most.others),
            };
            if kept.len() < most {
                kept.push(wave.start_direction);
            }
        }
        Ok(())
    }
}
