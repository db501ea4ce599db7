//! The waves whose paths the plan shows: those that are heard first, and some others.

use crate::error::Error;
use crate::platform::Instant;
use crate::scene::Scene;
use crate::trace::{HeardSearch, MostKept, Profile, Settings, Tracer, Wave};
use std::time::Duration;

/// Paths that are shown at most: more cover each other.
const SHOWN: MostKept = MostKept {
    heard: 16,
    others: 48,
};
/// Iterations that the paths are followed for at most.
pub(crate) const PATH_ITERATIONS: u32 = 16;
/// Waves that are traced at a time to find heard ones: about a millisecond of them.
const AT_A_TIME: u32 = 2048;
/// The same in the profile `thesis`, whose waves take some dozen times as long.
const THESIS_AT_A_TIME: u32 = 256;
/// Times that waves are traced for one scene at most.
const SEARCHES: u32 = 32;
/// After so long a search continues in another frame.
const AT_MOST: Duration = Duration::from_millis(2);

/// The paths shown, kept while what they depend on stands still.
#[derive(Default)]
pub struct Paths {
    states: Vec<Vec<Wave>>,
    /// What they were traced in, and how.
    of: Option<(Scene, Settings)>,
    search: HeardSearch,
}

impl Paths {
    /// As [`Tracer::paths`] gives them.
    pub fn states(&self) -> &[Vec<Wave>] {
        &self.states
    }

    /// Whether none were followed yet.
    #[cfg(feature = "demo")]
    pub fn are_none(&self) -> bool {
        self.states.is_empty()
    }

    /// How many reached the listener.
    #[cfg(feature = "demo")]
    pub fn heard(&self) -> usize {
        let ends = self.states.last().map_or(&[][..], Vec::as_slice);
        let heard = ends
            .iter()
            .filter(|wave| wave.fate() == crate::trace::Fate::Listener);
        heard.count()
    }

    /// Another scene has come.
    pub fn forget(&mut self) {
        *self = Paths::default();
    }

    /// Looks for waves that are heard in the scene, and follows them and some others: the first
    /// ones of all that are traced, however much time there is.
    ///
    /// # Errors
    /// As [`Tracer::frame`].
    pub fn follow(
        &mut self,
        tracer: &mut Tracer,
        scene: &Scene,
        settings: &Settings,
    ) -> Result<(), Error> {
        let settings = Settings {
            // However many are heard, these are others.
            waves: match settings.profile() {
                Profile::Thesis => THESIS_AT_A_TIME,
                _ => AT_A_TIME,
            },
            ..settings.clone()
        };
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

/// Whether waves go the same ways in two scenes: a gaze changes none.
fn sounds_alike(a: &Scene, b: &Scene) -> bool {
    a.source.position == b.source.position
        && a.listener.position == b.listener.position
        && a.listener.radius == b.listener.radius
        && a.surfaces == b.surfaces
}
