//! The paths of waves that reach the listener.

use super::Tracer;
use crate::error::Error;
use crate::scene::Scene;
use crate::trace::heard_search::{HeardSearch, MostKept};
use crate::trace::{Fate, Settings, Wave};

/// Waves that are traced at a time: what is read back of them is some 10 MB.
const AT_A_TIME: u32 = 1 << 18;

/// Waves that reached the listener, and their ways there.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct HeardPaths {
    /// As [`Tracer::paths`] gives them, of waves that reached the listener alone; empty
    /// without any.
    pub paths: Vec<Vec<Wave>>,
    /// Waves that were traced to find them.
    pub traced: u64,
}

impl HeardPaths {
    /// How many there are.
    pub fn count(&self) -> usize {
        self.paths.first().map_or(0, Vec::len)
    }

    /// Adds one wave of what [`Tracer::paths`] gave.
    fn add(&mut self, states: &[Vec<Wave>], wave: usize) {
        self.paths.resize_with(states.len(), Vec::new);
        for (all, state) in self.paths.iter_mut().zip(states) {
            all.push(state[wave]);
        }
    }
}

impl Tracer {
    /// Follows `wanted` waves that reach the listener: traces the waves of `settings`, then
    /// those of the next seeds, until there are so many or `most` waves were traced.
    ///
    /// In the profile `thesis` a wave that died and is marched again is none of them.
    ///
    /// # Errors
    /// As [`Tracer::frame`].
    pub fn heard_paths(
        &mut self,
        scene: &Scene,
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
            search.search(self, scene, &settings, most)?;
            found.traced += u64::from(settings.waves);
            let starts = std::mem::take(&mut search.heard);
            if !starts.is_empty() {
                let states = self.trace_directions(scene, &settings, &starts)?;
                // Made a unit vector once more a direction may differ by a rounding.
                let heard = (0..starts.len()).filter(|&wave| reaches_listener(&states, wave));
                heard.for_each(|wave| found.add(&states, wave));
            }
        }
        Ok(found)
    }
}

/// Whether a wave of [`Tracer::paths`] reached the listener before it died.
fn reaches_listener(states: &[Vec<Wave>], wave: usize) -> bool {
    let fates = states.iter().map(|waves| waves[wave].fate());
    fates
        .into_iter()
        .find(|fate| *fate != Fate::Travelling)
        .is_some_and(|fate| fate == Fate::Listener)
}
