//! The ranges of named values, for the sliders of the window and the page.

use super::{Scene, SceneError};
use serde::Deserialize;

/// A range as it is written in a file.
#[derive(Deserialize)]
#[serde(rename = "Range", deny_unknown_fields)]
struct RangeFile {
    min: f32,
    max: f32,
    step: Option<f32>,
}

impl TryFrom<RangeFile> for ValueRange {
    type Error = String;

    fn try_from(file: RangeFile) -> Result<ValueRange, String> {
        let RangeFile { min, max, step } = file;
        let range = ValueRange { min, max, step };
        range.check().map(|()| range)
    }
}

/// The range of a named value, in the unit of a scene file. It limits the value's slider in the window and the page; a
/// value set in another way may be outside.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(try_from = "RangeFile")]
pub struct ValueRange {
    /// The smallest value.
    pub min: f32,
    /// The largest value, above `min`.
    pub max: f32,
    /// The step between two values, above 0; `None` for any value.
    pub step: Option<f32>,
}

impl ValueRange {
    /// Checks the numbers; returns the rule that they break.
    pub(super) fn check(&self) -> Result<(), String> {
        let ValueRange { min, max, step } = *self;
        if !(min.is_finite() && max.is_finite() && min < max) {
            return Err(format!(
                "a Range must have a finite min below a finite max, not {min} and {max}"
            ));
        }
        match step {
            Some(step) if !(step.is_finite() && step > 0.0) => Err(format!(
                "the step of a Range must be finite and above 0, not {step}"
            )),
            _ => Ok(()),
        }
    }
}

impl Scene {
    /// Checks that each range belongs to a named value, and its numbers.
    pub(super) fn validate_value_ranges(&self) -> Result<(), SceneError> {
        if self.value_ranges.is_empty() {
            return Ok(());
        }
        let names = self.value_names();
        for (name, range) in &self.value_ranges {
            if names.binary_search(name).is_err() {
                return Err(self.unknown_value(name, &names));
            }
            if range.check().is_err() {
                let what = format!("the range of the value {name:?}");
                let must = "a finite min below a finite max, with a step above 0";
                return Err(self.bad_number(&what, must, format!("{range:?}")));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: &str = r#"Scene(
        surfaces: [Surface(shape: Sphere(radius: Value("size", 1)), position: (0, -9, 0))],
        ranges: {"size": Range(min: 0.5, max: 4, step: 0.25)},
        source: Source(position: (0, 1, -5)), listener: Listener(position: (0, 1, 5), radius: 1))"#;

    /// Protects the ranges of a file: they are read, written again, and refused for unknown names and impossible limits.
    #[test]
    fn ranges_of_values_are_read_written_and_checked() {
        let scene = Scene::from_ron(SCENE, "s").unwrap();
        let expected = ValueRange {
            min: 0.5,
            max: 4.0,
            step: Some(0.25),
        };
        assert_eq!(scene.value_ranges["size"], expected);
        let again = Scene::from_ron(&ron::to_string(&scene).unwrap(), "s").unwrap();
        assert_eq!(again.value_ranges, scene.value_ranges);
        for (from, to, says) in [
            ("\"size\": R", "\"sise\": R", "did you mean size?"),
            ("max: 4", "max: 0.5", "a finite min below"),
            ("step: 0.25", "step: 0", "step of a Range must be"),
        ] {
            let told = Scene::from_ron(&SCENE.replace(from, to), "s").unwrap_err();
            assert!(told.to_string().contains(says), "{told}");
        }
    }
}
