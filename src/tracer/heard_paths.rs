//! The search for waves that reach the listener, and the paths of these waves.

use super::{Fate, Settings, Tracer, Wave};
use crate::error::Error;
use crate::scene::Pair;
use glam::Vec3;

/// Traces waves with one seed after another, and stores the start directions of waves that reached the listener and of
/// some others. The paths are found by tracing these directions again.
#[derive(Clone, Debug, Default)]
pub struct HeardSearch {
    /// Start directions of waves that reached the listener.
    pub heard: Vec<Vec3>,
    /// Start directions of other waves.
    pub others: Vec<Vec3>,
    /// Number of seeds with which waves were traced.
    pub searches: u32,
}

/// Maximum number of stored directions.
#[derive(Clone, Copy, Debug)]
pub struct MostKept {
    pub heard: usize,
    pub others: usize,
}

impl HeardSearch {
    /// Traces the waves of `settings` once, and stores the first start directions of each kind. Each further call uses
    /// the next seed.
    ///
    /// # Errors
    /// The errors of [`Tracer::frame`].
    pub fn search(
        &mut self,
        tracer: &mut Tracer,
        pair: Pair,
        settings: &Settings,
        most: MostKept,
    ) -> Result<(), Error> {
        let settings = Settings {
            seed: settings.seed.wrapping_add(self.searches),
            ..settings.clone()
        };
        self.searches += 1;
        let (_, waves) = tracer.frame_with_waves(pair, &settings)?;
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

/// Waves traced at a time. About 10 MB are read back for this number.
const AT_A_TIME: u32 = 1 << 18;

/// Waves that reached the listener, and their paths.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct HeardPaths {
    /// States as [`Tracer::paths`] returns them, but only of waves that reached the listener. Empty if no wave reached
    /// the listener.
    pub paths: Vec<Vec<Wave>>,
    /// Number of waves that were traced to find the paths.
    pub traced: u64,
}

impl HeardPaths {
    /// Number of paths.
    pub fn count(&self) -> usize {
        self.paths.first().map_or(0, Vec::len)
    }

    /// Adds one wave, given by the states of all waves as [`Tracer::paths`] returns them.
    fn add(&mut self, states: &[Vec<Wave>], wave: usize) {
        self.paths.resize_with(states.len(), Vec::new);
        for (all, state) in self.paths.iter_mut().zip(states) {
            all.push(state[wave]);
        }
    }

    /// Implements [`Tracer::heard_paths`].
    pub(super) fn search(
        tracer: &mut Tracer,
        pair: Pair,
        settings: &Settings,
        wanted: usize,
        most: u64,
    ) -> Result<HeardPaths, Error> {
        let (mut found, mut search) = (HeardPaths::default(), HeardSearch::default());
        let at_a_time = settings.waves.min(AT_A_TIME);
        let settings = settings.clone().with_waves(at_a_time);
        while found.count() < wanted && found.traced < most {
            let most = MostKept {
                heard: wanted - found.count(),
                others: 0,
            };
            search.search(tracer, pair, &settings, most)?;
            found.traced += u64::from(settings.waves);
            let starts = std::mem::take(&mut search.heard);
            if !starts.is_empty() {
                let states = tracer.trace_directions(pair, &settings, &starts)?;
                // A direction that is normalised again may differ by one rounding, so the wave is checked again.
                let heard = (0..starts.len()).filter(|&wave| reaches_listener(&states, wave));
                heard.for_each(|wave| found.add(&states, wave));
            }
        }
        Ok(found)
    }
}

/// Whether a wave of [`Tracer::paths`] reached the listener before any other end.
fn reaches_listener(states: &[Vec<Wave>], wave: usize) -> bool {
    let fates = states.iter().map(|waves| waves[wave].fate());
    fates
        .into_iter()
        .find(|fate| *fate != Fate::Travelling)
        .is_some_and(|fate| fate == Fate::Listener)
}
