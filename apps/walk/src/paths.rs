//! The waves whose paths the plan shows: waves that reach the listener first, then some others.

use echomarch::Error;
use echomarch::glam::Vec3;
use echomarch::internals::platform::Instant;
use echomarch::scene::{Pair, Surface};
use echomarch::tracer::{HeardSearch, MostKept, Profile, Settings, Tracer, Wave};
use std::time::Duration;

/// Maximum number of paths shown. More paths would cover each other.
const SHOWN: MostKept = MostKept {
    heard: 16,
    others: 48,
};
/// Maximum number of iterations in a path.
pub const PATH_ITERATIONS: u32 = 16;
/// Maximum number of waves in one search for heard waves. Tracing them usually takes about one millisecond.
const AT_A_TIME: u32 = 2048;
/// Maximum number of waves in one search with the profile `thesis`, which takes dozens of times longer per wave.
const THESIS_AT_A_TIME: u32 = 256;
/// Minimum number of waves in one search, and the number in the first search.
const LEAST_AT_A_TIME: u32 = 64;
/// Maximum number of searches in one scene.
const SEARCHES: u32 = 32;
/// Search time per frame. The next frame continues the search.
const AT_MOST: Duration = Duration::from_millis(2);
/// Maximum duration of one search. The number of waves is reduced to keep it, so that an expensive field does not delay
/// the pictures.
const LONGEST_SEARCH: Duration = Duration::from_millis(10);

/// The paths shown, which are cached until the scene or the settings change.
#[derive(Default)]
pub struct Paths {
    states: Vec<Vec<Wave>>,
    /// The input of the last trace.
    of: Option<(Traced, Settings)>,
    search: HeardSearch,
    /// Number of waves in the next search; `None` before the first search of a scene.
    at_a_time: Option<u32>,
}

/// The parts of a scene that determine the paths of its waves. The listener's gaze has no effect on them.
struct Traced {
    surfaces: Vec<Surface>,
    source: Vec3,
    listener: Vec3,
    radius: f32,
}

impl Traced {
    fn of(pair: Pair) -> Traced {
        Traced {
            surfaces: pair.scene().surfaces.clone(),
            source: pair.source().position,
            listener: pair.listener().position,
            radius: pair.listener().radius,
        }
    }

    fn is_of(&self, pair: Pair) -> bool {
        self.source == pair.source().position
            && self.listener == pair.listener().position
            && self.radius == pair.listener().radius
            && self.surfaces == pair.scene().surfaces
    }
}

impl Paths {
    /// The states of the waves, in the form that [`Tracer::paths`] returns.
    pub fn states(&self) -> &[Vec<Wave>] {
        &self.states
    }

    /// Whether no paths have been traced yet.
    pub fn are_none(&self) -> bool {
        self.states.is_empty()
    }

    /// Number of paths that reached the listener.
    pub fn heard(&self) -> usize {
        let ends = self.states.last().map_or(&[][..], Vec::as_slice);
        let heard = ends
            .iter()
            .filter(|wave| wave.fate() == echomarch::tracer::Fate::Listener);
        heard.count()
    }

    /// Removes the paths of the previous scene.
    pub fn forget(&mut self) {
        *self = Paths::default();
    }

    /// Searches for waves that reach the listener, and traces the paths of these waves and of some others. The first
    /// search of a call is always completed, however long it takes.
    ///
    /// # Errors
    /// The errors of [`Tracer::frame`].
    pub fn follow(
        &mut self,
        tracer: &mut Tracer,
        pair: Pair,
        settings: &Settings,
    ) -> Result<(), Error> {
        let most = match settings.profile() {
            Profile::Thesis => THESIS_AT_A_TIME,
            _ => AT_A_TIME,
        };
        let settings = settings.clone().with_waves(most);
        let same = self
            .of
            .as_ref()
            .is_some_and(|(known, how)| *how == settings && known.is_of(pair));
        if !same {
            self.of = Some((Traced::of(pair), settings.clone()));
            self.search = HeardSearch::default();
        }
        if !self.is_searching() {
            return Ok(());
        }
        let began = Instant::now();
        while self.is_searching() {
            let waves = self.at_a_time.unwrap_or(LEAST_AT_A_TIME).min(most);
            let settings = settings.clone().with_waves(waves);
            let searching = Instant::now();
            self.search.search(tracer, pair, &settings, SHOWN)?;
            self.at_a_time = Some(next_search(waves, searching.elapsed()));
            if began.elapsed() > AT_MOST {
                break;
            }
        }
        let directions = [self.search.heard.as_slice(), &self.search.others].concat();
        self.states = tracer.trace_directions(pair, &settings, &directions)?;
        Ok(())
    }

    fn is_searching(&self) -> bool {
        self.search.heard.len() < SHOWN.heard && self.search.searches < SEARCHES
    }
}

/// The number of waves in the next search, a power of two, after a search of `before` waves that took `took`.
fn next_search(before: u32, took: Duration) -> u32 {
    let fit = f64::from(before) * LONGEST_SEARCH.as_secs_f64() / took.as_secs_f64();
    let fit = (fit as u32).clamp(LEAST_AT_A_TIME, AT_A_TIME);
    // Rounding to a power of two avoids new textures for small changes of the number.
    1 << fit.ilog2()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the pictures from waiting for the paths in an expensive field, and cheap scenes from needlessly small
    /// searches.
    #[test]
    fn a_search_is_as_large_as_its_time_allows() {
        let after = |before, ms| next_search(before, Duration::from_millis(ms));
        assert_eq!(after(64, 0), AT_A_TIME);
        assert_eq!(after(2048, 10), 2048);
        assert_eq!(after(2048, 11), 1024);
        assert_eq!(after(512, 30), 128);
        assert_eq!(after(64, 5000), LEAST_AT_A_TIME);
    }
}
