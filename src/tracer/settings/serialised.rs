//! Settings as they are read.

use super::{Algorithm, Profile, Settings, ThesisOptions};
use crate::error::Error;
use crate::serialised::given;
use crate::shader::Directions;
use crate::tracer::TraceError;
use serde::Deserialize;

/// The fields of [`Settings`], each of which may be left out.
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
                    Err(super::bad(what, must, value))
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

    /// Protects settings that are kept in files: each is read as it was written, bit for bit.
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

    /// Protects settings from mistakes in a file: none is ignored, and the range is the same as in code.
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
