//! Where is the source? The thesis' second experiment, for an observer and for people.
//!
//! Sjöberg (2011, section 4.1 and the head of 4.3) sketches a psychometric experiment: two
//! scenes, two sounds between 200 and 1000 Hz, fixed positions, a listener whose gaze is the
//! screen's, headphones, a form that asks for the place of the source, several counts of
//! waves and iterations. The text that this port was made from ends before its form and its
//! outcome.
//!
//! # Method
//! - *For machines*: an [`Observer`] answers from the levels of the rendered channels alone.
//!   [`run`] measures its error in the open, where it has to be right, and in rooms, for each
//!   sound, profile, count of waves and of iterations, over several seeds and three ways to
//!   face ([`facings`]). Every answer is compared with two truths: the *source*, the lateral
//!   angle of the straight way to it; and the *limit*, what the observer answers to the
//!   converged panning of `hybrid` after as many iterations. A trial in which nothing is heard
//!   has no answer and is counted apart.
//! - *For people*: [`form`] writes the sounds and a page that plays them and takes the
//!   answers; [`score`] reads these.
//!
//! The theory is in [`observer`]'s header, the intervals' in [`statistics`]'.
//!
//! # Deviations from the thesis
//! The listener also faces two other ways, so that the source is left, ahead and right; the
//! observer is an addition. The form is not the thesis' own, whose questions are not known.

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

pub use crate::rng::Random;
pub use answers::{
    Answer, AnswersError, FORMAT, MOST_CONFIDENT, MOST_TRIALS, Session, StimulusInfo, TrialAnswer,
    VERSION,
};
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

use crate::audio::{PanningLaw, SoundSpec};
use crate::scene::Scene;
use crate::trace::{Profile, Settings};

/// How far the source of the open field is, in metres.
pub const OPEN_DISTANCE_M: f64 = 5.0;

/// The most waves × iterations of a setting: 1,048,576 waves for 8 iterations, the thesis'
/// largest.
pub const MOST_WORK: u64 = 8 << 20;

/// One setting in the open.
#[derive(Clone, Debug)]
pub struct OpenCase {
    /// Profile and counts.
    pub settings: Settings,
    /// Whether there is a ground that reflects.
    pub ground: bool,
}

/// What to run.
#[derive(Clone, Debug)]
pub struct LocaliseOptions {
    /// The rooms.
    pub scenes: Vec<Scene>,
    /// What the source plays.
    pub sounds: Vec<SoundSpec>,
    /// The algorithms.
    pub profiles: Vec<Profile>,
    /// Counts of waves.
    pub waves: Vec<u32>,
    /// Counts of iterations. Settings of more than [`MOST_WORK`] are left out, and reported.
    pub iterations: Vec<u32>,
    /// Frames of each setting and facing, a seed each.
    pub seeds: u32,
    /// How panning values become levels.
    pub law: PanningLaw,
    /// How much of a sound the observer hears, in seconds.
    pub sound_seconds: f64,
    /// Waves and frames of the converged panning.
    pub limit: (u32, u32),
    /// With what to run in the open.
    pub open: Vec<OpenCase>,
    /// Where the source is in the open, in degrees.
    pub azimuths_deg: Vec<f64>,
}

impl LocaliseOptions {
    /// The thesis' scenes and sounds, its counts of waves, and iterations around its 4 and 8:
    /// some minutes on two cores.
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

    /// The same with few settings and seeds: seconds.
    pub fn quick(self) -> LocaliseOptions {
        LocaliseOptions {
            waves: vec![1024, 16_384, 65_536],
            iterations: vec![4, 8],
            seeds: 3,
            limit: (1 << 18, 4),
            ..self
        }
    }

    /// Waves and iterations, by waves: another count takes other textures.
    fn counts(&self) -> impl Iterator<Item = (u32, u32)> {
        let of = |&waves| self.iterations.iter().map(move |&count| (waves, count));
        self.waves.iter().flat_map(of)
    }

    /// Settings that are too large to be run: of more than [`MOST_WORK`] waves × iterations.
    pub fn left_out(&self) -> Vec<(u32, u32)> {
        let is_large = |&(waves, iterations): &(u32, u32)| too_large(waves, iterations);
        self.counts().filter(is_large).collect()
    }

    /// Every profile with every count.
    fn settings(&self) -> Vec<Settings> {
        let mut all = Vec::new();
        for (waves, iterations) in self.counts() {
            if too_large(waves, iterations) {
                continue;
            }
            let of = |&profile: &Profile| {
                let settings = Settings::new(profile);
                settings.with_waves(waves).with_iterations(iterations)
            };
            all.extend(self.profiles.iter().map(of));
        }
        all
    }

    /// Steps that [`run`] reports.
    fn steps(&self) -> u64 {
        const FACINGS: u64 = 3;
        let cells = self.settings().len() as u64;
        self.open.len() as u64 + self.scenes.len() as u64 * (FACINGS + cells)
    }
}

fn too_large(waves: u32, iterations: u32) -> bool {
    u64::from(waves) * u64::from(iterations) > MOST_WORK
}

/// The thesis' two scenes.
pub const ROOMS: [&str; 2] = ["corner", "obstacles"];

/// Two sounds mainly between 200 and 1000 Hz, one that says something and one that does not.
pub const SOUNDS: [&str; 2] = ["speech", "sine:500"];
