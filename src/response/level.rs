//! How loud, how late and from where a source is heard: one level for all bands.

use super::{Response, heard_path};
use crate::acoustics::strength_db;
use crate::bands;
use crate::scene::Listener;
use glam::DVec3;

/// What is heard of a source, in few numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Level {
    /// Strength *G* of all energy, of the mean of the bands: decibels against the same source without
    /// its `level_db` 10 m off in the open.
    pub g_db: f64,
    /// When the first sound arrives, in seconds after the source's impulse: exactly for the direct
    /// sound and exact paths, else by the echogram's bin.
    pub delay_s: f64,
    /// Where the energy comes from on average, to the right of the listener's gaze, in radians from −π
    /// to π: that of the sum of energy × direction over all arrivals.
    pub azimuth: f64,
    /// The same above the plane of the listener's ears, in radians.
    pub elevation: f64,
    /// How much of a direction there is in it, 0 to 1: the length of that sum against the energy. 1 is
    /// all from there, 0 is as much from everywhere as from nowhere.
    pub one_sided: f64,
}

impl Response {
    /// How loud, how late and from where the source is heard by `listener`, the one that was traced;
    /// `None` where nothing arrives.
    pub fn level(&self, listener: &Listener) -> Option<Level> {
        let g_db = strength_db(bands::mean(&self.energy()))?;
        let delay_s = self.figures.begins_s?;
        let flow = self.flow();
        let (azimuth, elevation) = heard_path::comes_from(listener, -flow);
        let energy: f64 = self.energy().iter().sum();
        Some(Level {
            g_db,
            delay_s,
            azimuth,
            elevation,
            one_sided: (flow.length() / energy).min(1.0),
        })
    }

    /// Energy × direction of flight of all that arrives, the sum of the bands, in 1/m².
    fn flow(&self) -> DVec3 {
        let paths = self.paths.iter();
        let exact: DVec3 = paths
            .map(|path| path.path.arrival_direction * path.energy.iter().sum::<f64>())
            .sum();
        let bins = 0..self.echogram.bins();
        let late: DVec3 = bins.flat_map(|bin| self.echogram.flow(bin)).sum();
        exact + late
    }
}
