//! The waves whose paths the plan shows: first those that are heard, then some others.

use echomarch::Error;
use echomarch::internals::platform::Instant;
use echomarch::scene::Scene;
use echomarch::tracer::{HeardSearch, MostKept, Profile, Settings, Tracer, Wave};
use std::time::Duration;

/// Maximum number of paths shown: more would cover each other.
const SHOWN: MostKept = MostKept {
    heard: 16,
    others: 48,
};
/// Maximum number of iterations of the paths.
pub const PATH_ITERATIONS: u32 = 16;
/// Waves that are traced at a time to find heard ones: about a millisecond of them.
const AT_A_TIME: u32 = 2048;
/// The same in the profile `thesis`, whose waves take dozens of times longer.
const THESIS_AT_A_TIME: u32 = 256;
/// Maximum number of searches in one scene.
const SEARCHES: u32 = 32;
/// Time after which a search is continued in another frame.
const AT_MOST: Duration = Duration::from_millis(2);

/// The paths shown, cached while scene and settings are unchanged.
#[derive(Default)]
pub struct Paths {
    states: Vec<Vec<Wave>>,
    /// The scene and settings that they were traced with.
    of: Option<(Scene, Settings)>,
    search: HeardSearch,
}

impl Paths {
    /// The states in the form of [`Tracer::paths`].
    pub fn states(&self) -> &[Vec<Wave>] {
        &self.states
    }

    /// Whether there are no paths yet.
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

    /// Searches for waves that are heard in the scene, and follows them and some others. The first
    /// search is always completed, whatever its duration.
    ///
    /// # Errors
    /// As [`Tracer::frame`].
    pub fn follow(
        &mut self,
        tracer: &mut Tracer,
        scene: &Scene,
        settings: &Settings,
    ) -> Result<(), Error> {
        let settings = settings.clone().with_waves(match settings.profile() {
            Profile::Thesis => THESIS_AT_A_TIME,
            _ => AT_A_TIME,
        });
        let same = self
            .of
            .as_ref()
            .is_some_and(|(known, how)| *how == settings && sounds_alike(known, scene));
        if !same {
            self.of = Some((scene.clone(), settings.clone()));
            self.search = HeardSearch::default();
        }
        if !self.is_searching() {
            return Ok(());
        }
        let began = Instant::now();
        while self.is_searching() {
            self.search.search(tracer, scene, &settings, SHOWN)?;
            if began.elapsed() > AT_MOST {
                break;
            }
        }
        let directions = [self.search.heard.as_slice(), &self.search.others].concat();
        self.states = tracer.trace_directions(scene, &settings, &directions)?;
        Ok(())
    }

    fn is_searching(&self) -> bool {
        self.search.heard.len() < SHOWN.heard && self.search.searches < SEARCHES
    }
}

/// Whether waves take the same paths in two scenes: the gaze does not matter.
fn sounds_alike(a: &Scene, b: &Scene) -> bool {
    a.source.position == b.source.position
        && a.listener.position == b.listener.position
        && a.listener.radius == b.listener.radius
        && a.surfaces == b.surfaces
}
