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
//!   face ([`facings`]). Every answer is held against two truths: the *source*, the lateral
//!   angle of the straight way to it; and the *limit*, what the observer answers to the
//!   converged panning of `hybrid` after as many iterations, which is the best that any
//!   panning by level can do.
//! - *For people*: [`form`] writes the sounds and a page that plays them and takes the
//!   answers; [`score`] reads these.
//!
//! The theory is in [`observer`]'s header, the intervals' in [`statistics`]'.
//!
//! # Deviations from the thesis
//! The listener also faces two other ways, so that the source is left, ahead and right; the
//! observer is an addition. The form is not the thesis' own, whose questions are not known.

mod answers;
mod csv;
pub mod form;
mod listen;
mod markdown;
pub mod observer;
mod plateaus;
mod plot;
mod random;
mod report;
pub mod score;
pub mod sitting;
pub mod statistics;
mod sweep;

pub use answers::{
    Answer, AnswersError, FORMAT, MOST_CONFIDENT, Session, StimulusInfo, TrialAnswer, VERSION,
};
pub use csv::{COLUMNS, write_csv};
pub use listen::{Converged, Heard, LoadedSound, converge, facings, listen, observe, source_at};
pub use markdown::markdown;
pub use observer::{CENTRE_DEG, Levels, Observer, Side};
pub use plot::plot_svg;
pub use random::Random;
pub use report::{
    Cell, FacingReport, LimitReport, LocaliseReport, OpenAzimuth, OpenReport, Plateau, SceneReport,
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
    /// Counts of iterations. Settings of more than [`MOST_WORK`] are left out.
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
    pub open: Vec<Settings>,
    /// Where the source is in the open, in degrees.
    pub azimuths_deg: Vec<f64>,
}

impl LocaliseOptions {
    /// The thesis' scenes and sounds, its counts of waves, and iterations around its 4 and 8:
    /// some minutes on two cores.
    pub fn new(scenes: Vec<Scene>, sounds: Vec<SoundSpec>) -> LocaliseOptions {
        let open = Profile::ALL.map(|profile| Settings::of(profile).with_iterations(1));
        let ground = Settings::hybrid();
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
            open: open.into_iter().chain([ground]).collect(),
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

    /// Every profile with every count, by waves: another count takes other textures.
    fn settings(&self) -> Vec<Settings> {
        let mut all = Vec::new();
        for &waves in &self.waves {
            for &iterations in &self.iterations {
                if u64::from(waves) * u64::from(iterations) > MOST_WORK {
                    continue;
                }
                let of = |&profile: &Profile| {
                    let settings = Settings::of(profile);
                    settings.with_waves(waves).with_iterations(iterations)
                };
                all.extend(self.profiles.iter().map(of));
            }
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

/// The thesis' two scenes.
pub const ROOMS: [&str; 2] = ["corner", "obstacles"];

/// Two sounds mainly between 200 and 1000 Hz, one that says something and one that does not.
pub const SOUNDS: [&str; 2] = ["speech", "sine:500"];
