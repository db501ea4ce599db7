//! Level, delay and direction of a source's sound: one level for all bands.

use super::{Response, heard_path};
use crate::acoustics::strength_db;
use crate::bands;
use crate::scene::Listener;
use glam::DVec3;

/// A source's sound at the listener, in few numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Level {
    /// Strength *G* of all energy, averaged over the bands: decibels relative to the same source without its `level_db`
    /// at 10 m in the open.
    pub g_db: f64,
    /// Arrival of the first sound, in seconds after the source's impulse: exact for the direct
    /// sound and exact paths, otherwise the echogram's bin.
    pub delay_s: f64,
    /// Mean direction that the energy comes from, to the right of the listener's gaze, in radians from −π to π: that of
    /// the sum of energy × direction over all arrivals.
    pub azimuth: f64,
    /// The same, above the plane of the listener's ears, in radians.
    pub elevation: f64,
    /// Directionality of the sound, 0 to 1: the length of that sum over the energy. 1 means all from one direction, 0
    /// from no preferred one.
    pub one_sided: f64,
}

impl Response {
    /// Level, delay and direction of the source's sound at `listener`, the one that was traced; `None` without
    /// arrivals.
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

    /// Energy × direction of flight, summed over all arrivals and bands, in 1/m².
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
