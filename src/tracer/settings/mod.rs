//! Settings of traces: the constants of the thesis, and the numbers that the user chooses.
//!
//! An option cannot be set for an algorithm in which it has no meaning: [`Settings`] holds the options common to all
//! algorithms, and [`Algorithm`] those of one algorithm (`algorithm.rs`).

mod algorithm;

use super::TraceError;
use crate::error::Error;
use crate::serialised::given;
use crate::shader::Directions;
pub use algorithm::{Algorithm, Profile, ThesisOptions};
use serde::{Deserialize, Serialize};
use std::fmt;

/// The largest maximum distance that may be requested, in metres. Its square, and the square of a wave's position after
/// that distance, are still finite in `f32`.
const MAX_DISTANCE: f32 = 1e15;

/// The distance beyond which a wave of `march` and `hybrid` counts as dead, in metres. It is much greater than the
/// distance at which sound is audible, and its square is finite in `f32`.
const FAR: f32 = 1e9;

/// Default iterations in one pass of `march`. More iterations save no measurable time.
pub const MARCHES_PER_PASS: u32 = 8;

/// Distance beyond which a wave of `thesis` counts as dead, in metres (section 4.2.3).
const THESIS_MAX_DISTANCE: f32 = 300.0;

/// All input of a frame except the scene: the options common to all algorithms, and the [`Algorithm`] with its options.
///
/// ```
/// use echomarch::tracer::{Settings, ThesisOptions};
///
/// let fine = ThesisOptions::default().with_min_distance(0.001);
/// let settings = Settings::new(fine).with_waves(4096).with_seed(7);
/// assert!(settings.validate().is_ok());
/// ```
///
/// Serialised flat: the algorithm's options are next to its name, which is the field `profile`. Lengths are in metres.
/// A field that is left out has its default. Unknown fields, options of another algorithm and numbers out of range are
/// refused.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(try_from = "SettingsFile")]
#[non_exhaustive]
pub struct Settings {
    /// The algorithm and its options. To change to another algorithm, begin with [`Settings::new`] or
    /// [`Settings::with_profile`], because the defaults of the maximum distance and of the iterations in a pass depend
    /// on the algorithm.
    #[serde(flatten)]
    pub algorithm: Algorithm,
    /// Number of waves, 1 … [`Settings::MAX_WAVES`].
    pub waves: u32,
    /// Maximum number of marches of each wave, 1 … [`Settings::MAX_ITERATIONS`].
    pub iterations: u32,
    /// A wave that flies farther than this distance in one iteration is dead, in metres. The default is 300 in `thesis`
    /// (section 4.2.3) and 10^9 in the other algorithms.
    pub max_distance: f32,
    /// Seed of the random directions.
    pub seed: u32,
    /// The distribution of the start directions.
    pub directions: Directions,
    /// Maximum iterations in one pass. The thesis has 1, and more iterations save texture traffic. The number may be
    /// lower for a scene with long loops, because drivers silently leave loops after a maximum number of turns. The
    /// default is 1 in `thesis`, 8 in `march` and [`Settings::MAX_ITERATIONS`] in `hybrid`.
    pub iterations_per_pass: u32,
    /// Whether the panning texture is summed on the GPU and read back as one texel.
    pub sum_on_gpu: bool,
    /// Whether to count evaluations of the distance, instead of marches of length zero and marches that reached the
    /// step limit.
    pub count_evaluations: bool,
}

impl Default for Settings {
    fn default() -> Settings {
        Settings::hybrid()
    }
}

impl Settings {
    /// The maximum number of waves in one frame: 2^24, which take a pair of textures of 4096 × 4096 texels.
    pub const MAX_WAVES: u32 = 1 << 24;

    /// The maximum number of iterations. The two counters of a wave share the 24 bits of one float, 12 bits each.
    pub const MAX_ITERATIONS: u32 = 4095;

    /// The defaults of an algorithm: 65,536 waves and 8 iterations in random directions.
    pub fn new(algorithm: impl Into<Algorithm>) -> Settings {
        let algorithm = algorithm.into();
        let (max_distance, iterations_per_pass) = match algorithm {
            Algorithm::Hybrid => (FAR, Settings::MAX_ITERATIONS),
            Algorithm::March => (FAR, MARCHES_PER_PASS),
            Algorithm::Thesis(_) => (THESIS_MAX_DISTANCE, 1),
        };
        Settings {
            algorithm,
            waves: 65_536,
            iterations: 8,
            max_distance,
            seed: 1,
            directions: Directions::Random,
            iterations_per_pass,
            sum_on_gpu: false,
            count_evaluations: false,
        }
    }

    /// The settings of `hybrid`: a closed form for each surface that has one, and all iterations in one pass.
    pub fn hybrid() -> Settings {
        Settings::new(Profile::Hybrid)
    }

    /// The settings of `march`: accurate sphere tracing with Newton steps, projection onto surfaces, exact normals, no
    /// limit at 300 m, and eight iterations in a pass.
    pub fn march() -> Settings {
        Settings::new(Profile::March)
    }

    /// The settings of `thesis`: the algorithm of the thesis with its constants ([`ThesisOptions`]).
    pub fn thesis() -> Settings {
        Settings::new(Profile::Thesis)
    }

    /// The name of the algorithm.
    pub fn profile(&self) -> Profile {
        self.algorithm.profile()
    }

    /// Changes the algorithm and sets all of its defaults. The settings of the waves are kept.
    #[must_use]
    pub fn with_profile(self, profile: Profile) -> Settings {
        Settings {
            waves: self.waves,
            iterations: self.iterations,
            seed: self.seed,
            directions: self.directions,
            sum_on_gpu: self.sum_on_gpu,
            count_evaluations: self.count_evaluations,
            ..Settings::new(profile)
        }
    }

    setters! {
        /// Sets the number of waves.
        pub fn with_waves(waves: u32) => waves;

        /// Sets the number of iterations.
        pub fn with_iterations(iterations: u32) => iterations;

        /// Sets the seed.
        pub fn with_seed(seed: u32) => seed;

        /// Sets the maximum distance of an iteration, in metres.
        pub fn with_max_distance(metres: f32) => max_distance;

        /// Sets the distribution of the start directions.
        pub fn with_directions(directions: Directions) => directions;

        /// Sets the maximum iterations in one pass.
        pub fn with_iterations_per_pass(iterations: u32) => iterations_per_pass;

        /// Chooses whether the panning is summed on the GPU.
        pub fn with_sum_on_gpu(sum_on_gpu: bool) => sum_on_gpu;

        /// Chooses whether evaluations of the distance are counted.
        pub fn with_count_evaluations(count_evaluations: bool) => count_evaluations;
    }

    /// Checks every number against its range.
    ///
    /// # Errors
    /// [`TraceError::BadSetting`] with the name, the range and the value.
    pub fn validate(&self) -> Result<(), TraceError> {
        in_range("waves", self.waves, Settings::MAX_WAVES)?;
        in_range("iterations", self.iterations, Settings::MAX_ITERATIONS)?;
        positive("maximum distance in metres", self.max_distance)?;
        if self.max_distance > MAX_DISTANCE {
            let must = format!("at most {MAX_DISTANCE}");
            return Err(bad("maximum distance in metres", must, self.max_distance));
        }
        let per_pass = self.iterations_per_pass;
        in_range("iterations in a pass", per_pass, Settings::MAX_ITERATIONS)?;
        self.algorithm.validate(self.max_distance)
    }
}

fn in_range(what: &'static str, value: u32, most: u32) -> Result<(), TraceError> {
    if (1..=most).contains(&value) {
        return Ok(());
    }
    Err(bad(what, format!("1 to {most}"), value))
}

fn positive(what: &'static str, value: f32) -> Result<(), TraceError> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    Err(bad(what, "finite and greater than 0".to_owned(), value))
}

fn bad(what: &'static str, must: String, value: impl fmt::Display) -> TraceError {
    TraceError::BadSetting {
        what,
        must,
        value: value.to_string(),
    }
}

/// The fields of [`Settings`]. Each field may be left out.
#[derive(Deserialize)]
#[serde(default, deny_unknown_fields)]
#[derive(Default)]
pub(super) struct SettingsFile {
    #[serde(deserialize_with = "given")]
    profile: Option<Profile>,
    #[serde(deserialize_with = "given")]
    min_distance: Option<f32>,
    #[serde(deserialize_with = "given")]
    start_offset: Option<f32>,
    #[serde(deserialize_with = "given")]
    normal_step: Option<f32>,
    #[serde(deserialize_with = "given")]
    waves: Option<u32>,
    #[serde(deserialize_with = "given")]
    iterations: Option<u32>,
    #[serde(deserialize_with = "given")]
    max_distance: Option<f32>,
    #[serde(deserialize_with = "given")]
    seed: Option<u32>,
    #[serde(deserialize_with = "given")]
    directions: Option<Directions>,
    #[serde(deserialize_with = "given")]
    iterations_per_pass: Option<u32>,
    #[serde(deserialize_with = "given")]
    sum_on_gpu: Option<bool>,
    #[serde(deserialize_with = "given")]
    count_evaluations: Option<bool>,
}

impl SettingsFile {
    fn algorithm(&self) -> Result<Algorithm, TraceError> {
        let own = [
            ("min_distance", self.min_distance),
            ("start_offset", self.start_offset),
            ("normal_step", self.normal_step),
        ];
        match Algorithm::of(self.profile.unwrap_or(Settings::default().profile())) {
            Algorithm::Thesis(usual) => Ok(Algorithm::Thesis(ThesisOptions {
                min_distance: self.min_distance.unwrap_or(usual.min_distance),
                start_offset: self.start_offset.unwrap_or(usual.start_offset),
                normal_step: self.normal_step.unwrap_or(usual.normal_step),
            })),
            other => match own
                .iter()
                .find_map(|(name, value)| Some((*name, (*value)?)))
            {
                None => Ok(other),
                Some((what, value)) => {
                    let profile = other.profile();
                    let must = format!("left out in the profile {profile}");
                    Err(bad(what, must, value))
                }
            },
        }
    }
}

impl TryFrom<SettingsFile> for Settings {
    type Error = Error;

    fn try_from(file: SettingsFile) -> Result<Settings, Error> {
        let usual = Settings::new(file.algorithm()?);
        let settings = Settings {
            waves: file.waves.unwrap_or(usual.waves),
            iterations: file.iterations.unwrap_or(usual.iterations),
            max_distance: file.max_distance.unwrap_or(usual.max_distance),
            seed: file.seed.unwrap_or(usual.seed),
            directions: file.directions.unwrap_or(usual.directions),
            iterations_per_pass: file
                .iterations_per_pass
                .unwrap_or(usual.iterations_per_pass),
            sum_on_gpu: file.sum_on_gpu.unwrap_or(usual.sum_on_gpu),
            count_evaluations: file.count_evaluations.unwrap_or(usual.count_evaluations),
            ..usual
        };
        settings.validate()?;
        Ok(settings)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the results of `thesis` from the step limit: with the constants of the thesis no march reaches it.
    #[test]
    fn the_step_limit_leaves_the_thesis_alone() {
        let thesis = ThesisOptions::default();
        let limit = thesis.step_limit(THESIS_MAX_DISTANCE);
        assert!(limit as f32 > THESIS_MAX_DISTANCE / thesis.min_distance);
        let tiny = thesis.with_min_distance(1e-30);
        assert_eq!(
            tiny.step_limit(THESIS_MAX_DISTANCE),
            crate::shader::MAX_STEPS
        );
    }

    /// Protects the GPU from invalid settings.
    #[test]
    fn senseless_settings_are_refused() {
        let thesis = ThesisOptions::default();
        let wrong = [
            Settings::hybrid().with_waves(0),
            Settings::hybrid().with_waves(Settings::MAX_WAVES + 1),
            Settings::hybrid().with_iterations(0),
            Settings::hybrid().with_iterations(Settings::MAX_ITERATIONS + 1),
            Settings::hybrid().with_iterations_per_pass(0),
            Settings::hybrid().with_max_distance(f32::INFINITY),
            Settings::hybrid().with_max_distance(1e16),
            Settings::thesis().with_max_distance(0.1),
            Settings::new(thesis.with_min_distance(0.0)),
            Settings::new(thesis.with_min_distance(301.0)),
            Settings::new(thesis.with_start_offset(f32::NAN)),
            Settings::new(thesis.with_normal_step(-1.0)),
        ];
        for profile in Profile::ALL {
            assert!(Settings::new(profile).validate().is_ok());
        }
        for (index, settings) in wrong.iter().enumerate() {
            assert!(settings.validate().is_err(), "case {index}");
        }
    }

    /// Protects a change of the algorithm: the defaults that depend on the algorithm change too.
    #[test]
    fn another_profile_brings_its_own_defaults() {
        let asked = Settings::hybrid()
            .with_waves(99)
            .with_seed(3)
            .with_sum_on_gpu(true);
        let expected = Settings::thesis()
            .with_waves(99)
            .with_seed(3)
            .with_sum_on_gpu(true);
        assert_eq!(asked.with_profile(Profile::Thesis), expected);
    }

    /// Protects reports: the options of the algorithm are next to its name, and options of other algorithms are absent.
    #[test]
    fn settings_are_serialised_with_the_options_of_their_algorithm() {
        let json = |settings: &Settings| serde_json::to_value(settings).unwrap();
        let thesis = json(&Settings::thesis().with_seed(7));
        assert_eq!(thesis["profile"], "thesis");
        assert_eq!(thesis["seed"], 7);
        assert_eq!(thesis["directions"], "random");
        assert!(thesis["start_offset"].is_number());
        let hybrid = json(&Settings::hybrid());
        assert_eq!(hybrid["profile"], "hybrid");
        assert!(hybrid.get("min_distance").is_none());
    }

    /// Protects settings in files: settings that are written and read again are equal bit for bit.
    #[test]
    fn settings_round_trip() {
        let thesis = ThesisOptions::default().with_min_distance(0.1 + 1e-7);
        for settings in [
            Settings::default(),
            Settings::march().with_seed(7).with_max_distance(1.0 / 3.0),
            Settings::new(thesis).with_waves(64).with_iterations(3),
        ] {
            let text = serde_json::to_string(&settings).unwrap();
            let read: Settings = serde_json::from_str(&text).unwrap();
            assert_eq!(read, settings, "{text}");
        }
        assert_eq!(
            serde_json::from_str::<Settings>("{}").unwrap(),
            Settings::default()
        );
    }

    /// Protects from mistakes in a settings file: no mistake is ignored, and the ranges are the same as in code.
    #[test]
    fn wrong_settings_are_refused() {
        for (text, part) in [
            (r#"{"wavess": 64}"#, "wavess"),
            (r#"{"waves": 0}"#, "waves must be 1 to"),
            (r#"{"max_distance": null}"#, "null"),
            (r#"{"max_distance": 1e16}"#, "maximum distance"),
            (r#"{"profile": "fast"}"#, "fast"),
            (r#"{"min_distance": 0.1}"#, "min_distance must be left out"),
        ] {
            let error = serde_json::from_str::<Settings>(text).unwrap_err();
            assert!(error.to_string().contains(part), "{text}: {error}");
        }
    }
}
