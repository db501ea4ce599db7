//! The thesis' second experiment: localisation of the source, by an observer model and by people.
//!
//! Sjöberg (2011, section 4.1 and the beginning of 4.3) sketches a psychometric experiment: two scenes, two sounds
//! between 200 and 1000 Hz, fixed positions, a listener that faces the screen, headphones, a form with questions about
//! the position of the source, and several numbers of waves and iterations. The copy of the thesis that this port is
//! based on ends before the form and the results.
//!
//! # Method
//! - *Observer model*: an [`Observer`] answers only from the levels of the rendered channels. [`run`] measures its
//!   error in the open, where its answers must be right, and in rooms. It does so for each sound, profile, number of
//!   waves and number of iterations, over several seeds and three facings ([`facings`]). Every answer is compared with
//!   two truths: the *source*, which is the lateral angle of the direct path to the source; and the *limit*, which is
//!   the observer's answer to the converged panning of `hybrid` after the same number of iterations. A trial without
//!   arrivals has no answer, and is counted separately.
//! - *People*: [`form`] writes the sounds and a page that plays the sounds and records the answers; [`score`] evaluates
//!   the answers.
//!
//! The documentation of [`observer`] explains the theory, and that of [`statistics`] the confidence intervals.
//!
//! # Deviations from the thesis
//! The listener also faces two other directions, so that the source is left, ahead and right. The observer model is an
//! addition. The questions of the thesis' form are not known, so this form is a new one.

mod answers;
mod columns;
mod document;
pub mod form;
mod listen;
pub mod observer;
mod open_field;
mod plateaus;
mod plot;
mod report;
mod report_contents;
pub mod score;
pub mod statistics;
mod sweep;

pub use answers::{
    Answer, AnswersError, FORMAT, MOST_CONFIDENT, MOST_TRIALS, Session, StimulusInfo, TrialAnswer,
    VERSION,
};
pub use echomarch::internals::sampling::Random;
pub use listen::{
    Converged, Heard, LoadedSound, converge, facings, listen, observe, source_at, source_towards,
    without_ground,
};
pub use observer::{CENTRE_DEG, Levels, Observer, Side};
pub use plateaus::AUDIBLE_DEG;
pub use report::{
    Cell, FacingReport, LimitReport, LocaliseReport, OpenDirection, OpenReport, Plateau,
    SceneReport,
};
pub use sweep::run;

use echomarch::audio::{PanningLaw, SoundSpec};
use echomarch::scene::Scene;
use echomarch::tracer::{Profile, Settings};

/// Distance of the source in the open field, in metres.
pub const OPEN_DISTANCE_M: f64 = 5.0;

/// Maximum product of waves and iterations in a setting: 1,048,576 waves with 8 iterations, which is the largest in the
/// thesis.
pub const MOST_WORK: u64 = 8 << 20;

/// A setting for the open field.
#[derive(Clone, Debug)]
pub struct OpenCase {
    /// The profile, and the numbers of waves and iterations.
    pub settings: Settings,
    /// Whether there is a reflecting ground.
    pub ground: bool,
}

/// The options of a run.
#[derive(Clone, Debug)]
pub struct LocaliseOptions {
    /// The rooms.
    pub scenes: Vec<Scene>,
    /// The sounds that the source plays.
    pub sounds: Vec<SoundSpec>,
    /// The algorithms.
    pub profiles: Vec<Profile>,
    /// Numbers of waves.
    pub waves: Vec<u32>,
    /// Numbers of iterations. Settings with more than [`MOST_WORK`] waves × iterations are omitted, and listed in the
    /// report.
    pub iterations: Vec<u32>,
    /// Number of frames per setting and facing, each with a different seed.
    pub seeds: u32,
    /// The panning law.
    pub law: PanningLaw,
    /// Length of the sound for the observer model, in seconds.
    pub sound_seconds: f64,
    /// Number of waves and number of frames for the converged panning.
    pub limit: (u32, u32),
    /// The settings in the open.
    pub open: Vec<OpenCase>,
    /// Azimuths of the source in the open, in degrees.
    pub azimuths_deg: Vec<f64>,
}

impl LocaliseOptions {
    /// The thesis' scenes, sounds and numbers of waves, with numbers of iterations around its 4 and 8. A run takes some
    /// minutes on two cores.
    pub fn new(scenes: Vec<Scene>, sounds: Vec<SoundSpec>) -> LocaliseOptions {
        let case = |settings, ground| OpenCase { settings, ground };
        let straight = |profile| case(Settings::new(profile).with_iterations(1), true);
        let defaults = [false, true].map(|ground| case(Settings::hybrid(), ground));
        LocaliseOptions {
            scenes,
            sounds,
            profiles: Profile::ALL.to_vec(),
            waves: super::WAVE_COUNTS.to_vec(),
            iterations: vec![1, 2, 4, 8, 16],
            seeds: 5,
            law: PanningLaw::Linear,
            sound_seconds: 0.5,
            limit: (1 << 20, 8),
            open: Profile::ALL
                .into_iter()
                .map(straight)
                .chain(defaults)
                .collect(),
            azimuths_deg: (-8..=8).map(|tens| 10.0 * f64::from(tens)).collect(),
        }
    }

    /// Reduces the options to few settings and seeds, which take seconds.
    #[must_use]
    pub fn quick(self) -> LocaliseOptions {
        LocaliseOptions {
            waves: vec![1024, 16_384, 65_536],
            iterations: vec![4, 8],
            seeds: 3,
            limit: (1 << 18, 4),
            ..self
        }
    }

    /// Pairs of waves and iterations, sorted by waves, because a different number of waves needs different textures.
    fn counts(&self) -> impl Iterator<Item = (u32, u32)> {
        pairs(&self.waves, &self.iterations)
    }

    /// Settings that are omitted because they exceed [`MOST_WORK`] waves × iterations.
    pub fn left_out(&self) -> Vec<(u32, u32)> {
        let is_large = |&(waves, iterations): &(u32, u32)| too_large(waves, iterations);
        self.counts().filter(is_large).collect()
    }

    /// Every combination of profile, waves and iterations.
    fn settings(&self) -> Vec<Settings> {
        let counts = self.counts();
        combined(
            &self.profiles,
            counts.filter(|&(waves, iterations)| !too_large(waves, iterations)),
        )
    }

    /// Number of steps of a run, which [`run`] reports as the total.
    fn steps(&self) -> u64 {
        const FACINGS: u64 = 3;
        let cells = self.settings().len() as u64;
        self.open.len() as u64 + self.scenes.len() as u64 * (FACINGS + cells)
    }
}

/// All combinations of the numbers of waves and of iterations.
fn pairs(waves: &[u32], iterations: &[u32]) -> impl Iterator<Item = (u32, u32)> {
    let of = |&waves| iterations.iter().map(move |&count| (waves, count));
    waves.iter().flat_map(of)
}

/// The settings of every profile with each number of waves and iterations.
fn combined(profiles: &[Profile], counts: impl Iterator<Item = (u32, u32)>) -> Vec<Settings> {
    let of = |(waves, iterations): (u32, u32)| {
        let settings = profiles.iter().map(|&profile| Settings::new(profile));
        settings.map(move |settings| settings.with_waves(waves).with_iterations(iterations))
    };
    counts.flat_map(of).collect()
}

fn too_large(waves: u32, iterations: u32) -> bool {
    u64::from(waves) * u64::from(iterations) > MOST_WORK
}

/// The thesis' two scenes.
pub const ROOMS: [&str; 2] = ["corner", "obstacles"];

/// Two sounds with most of their energy between 200 and 1000 Hz. One of them is speech.
pub const SOUNDS: [&str; 2] = ["speech", "sine:500"];
