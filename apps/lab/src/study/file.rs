//! The content of a study file (RON), and its canonical form for hashing.
//!
//! Omitted fields have defaults. `check` checks the range of every field. The reader reports syntax errors and unknown
//! names with line and column. See `docs/clusters.md`.

use super::StudyError;
use crate::text::in_a_line;
use echomarch::internals::file_input::{MalformedText, read_text};
use echomarch::internals::ron_error::{STUDY, sentence, unclosed_quote};
use echomarch::scene::Scene;
use echomarch::tracer::{Directions, Profile};
use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::collections::BTreeMap;
use std::fmt;
use std::path::{Path, PathBuf};

/// Maximum size of a study file, in bytes. A list of 20,000 positions takes 1 MiB.
const LARGEST_FILE: u64 = 4 << 20;

/// Name of the field of `Response` that users look for in other parts.
const ACCURACY: &str = "accuracy";

/// Maximum nesting depth of the text. A study has a depth of five.
const DEEPEST: usize = 32;

/// The content of a study file.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(rename = "Study", deny_unknown_fields)]
pub(super) struct StudyFile {
    #[serde(default)]
    pub name: String,
    pub scenes: Vec<SceneFile>,
    /// Times on the paths of the scenes, in seconds.
    #[serde(default)]
    pub times: Option<Numbers>,
    #[serde(default)]
    pub sources: Places,
    #[serde(default)]
    pub listeners: Places,
    /// Radius of every listener, in metres; `None` to keep the radius in each scene.
    #[serde(default)]
    pub listener_radius: Option<f32>,
    #[serde(default)]
    pub settings: SettingsFile,
    #[serde(default)]
    pub seeds: Seeds,
    #[serde(default)]
    pub keep: Keep,
}

/// A scene of a study, and its named values.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(rename = "Scene", deny_unknown_fields)]
pub(super) struct SceneFile {
    /// A built-in scene, or a file relative to the study's folder.
    pub of: String,
    #[serde(default)]
    pub values: BTreeMap<String, Numbers>,
}

/// The numbers along an axis of a study.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(rename = "form of numbers", deny_unknown_fields)]
pub(super) enum Numbers {
    List(Vec<f64>),
    /// `count` numbers with equal differences, including both ends.
    Range {
        from: f64,
        to: f64,
        count: u64,
    },
    /// `count` numbers with equal ratios, including both ends.
    Geometric {
        from: f64,
        to: f64,
        count: u64,
    },
}

/// The positions of a source or a listener, in metres.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
#[serde(rename = "form of places", deny_unknown_fields)]
pub(super) enum Places {
    /// The position of the scene's first source or listener.
    #[default]
    AsInScene,
    List(Vec<[f32; 3]>),
    /// A grid between two corners. x changes fastest, then z, then y.
    Grid {
        from: [f32; 3],
        to: [f32; 3],
        counts: [u64; 3],
    },
    /// `count` positions at equal distances along a polyline, including both ends.
    Path {
        through: Vec<[f32; 3]>,
        count: u64,
    },
}

/// The seeds of a study.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(rename = "form of seeds", deny_unknown_fields)]
pub(super) enum Seeds {
    List(#[serde(deserialize_with = "counts")] Vec<u32>),
    /// Consecutive whole numbers, starting at `from`.
    Range {
        from: u32,
        count: u64,
    },
}

impl Default for Seeds {
    fn default() -> Seeds {
        Seeds::List(vec![1])
    }
}

/// The settings of the waves.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(rename = "form of settings", deny_unknown_fields)]
pub(super) enum SettingsFile {
    /// All combinations of the given values.
    All {
        #[serde(default = "hybrid")]
        profiles: Vec<ProfileFile>,
        #[serde(default = "usual_waves", deserialize_with = "counts")]
        waves: Vec<u32>,
        #[serde(default = "usual_iterations", deserialize_with = "counts")]
        iterations: Vec<u32>,
        #[serde(default = "random")]
        directions: Vec<DirectionsFile>,
    },
    /// The cases of `echomarch accuracy`.
    Accuracy(Sweep),
}

impl Default for SettingsFile {
    fn default() -> SettingsFile {
        SettingsFile::All {
            profiles: hybrid(),
            waves: usual_waves(),
            iterations: usual_iterations(),
            directions: random(),
        }
    }
}

/// A sweep of `echomarch accuracy`.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
#[serde(rename = "sweep", rename_all = "lowercase")]
pub(super) enum Sweep {
    Short,
    Quick,
    Full,
}

#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
#[serde(rename = "profile", rename_all = "lowercase")]
pub(super) enum ProfileFile {
    Hybrid,
    March,
    Thesis,
}

#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
#[serde(rename = "kind of directions", rename_all = "lowercase")]
pub(super) enum DirectionsFile {
    Random,
    Fibonacci,
}

/// The results to keep for each point.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Keep {
    #[serde(default = "yes")]
    pub pan: bool,
    #[serde(default = "yes")]
    pub counts: bool,
    /// The panning of the same waves, traced exactly on the CPU.
    #[serde(default)]
    pub exact: bool,
    #[serde(default)]
    pub response: Option<ResponseFile>,
}

impl Default for Keep {
    fn default() -> Keep {
        Keep {
            pan: true,
            counts: true,
            exact: false,
            response: None,
        }
    }
}

/// The results to keep of impulse responses.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(rename = "Response", deny_unknown_fields)]
pub(super) struct ResponseFile {
    #[serde(default = "usual_figures")]
    pub figures: Vec<FigureName>,
    #[serde(default = "usual_bands")]
    pub bands_hz: Vec<u32>,
    #[serde(default)]
    pub errors: bool,
    /// Time over which waves are traced; `None` to trace until all bands have decayed by 60 dB.
    #[serde(default)]
    pub seconds: Option<f64>,
    /// Maximum number of reflections of exact paths.
    #[serde(default)]
    pub order: Option<u32>,
    /// Whether the direct sound and reflections at plane faces bend around obstacles. `false` is not serialised, so that
    /// the hashes of studies without diffraction stay the same.
    #[serde(default, skip_serializing_if = "is_off")]
    pub diffraction: bool,
    /// Standard error of decay times as a share of the time: the number of waves grows until all figures have it. `None`
    /// to trace the waves of the settings; it is then not serialised, so that hashes stay the same.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub accuracy: Option<f64>,
    /// Length of the echogram bins in milliseconds; `None` to keep no echogram.
    #[serde(default)]
    pub echogram_ms: Option<u32>,
}

/// Whether a switch is off.
fn is_off(switch: &bool) -> bool {
    !switch
}

/// A figure of ISO 3382-1, in the order of [`BandFigures::NAMES`](echomarch::response::BandFigures).
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq, Serialize)]
#[serde(rename = "figure", rename_all = "lowercase")]
pub(super) enum FigureName {
    Edt,
    T20,
    T30,
    C50,
    C80,
    D50,
    Ts,
    G,
}

/// A whole number in any form that the command line accepts: `65536`, `65_536`, `1e6`.
struct Count(u32);

impl<'de> Deserialize<'de> for Count {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Count, D::Error> {
        from.deserialize_any(CountVisitor)
    }
}

struct CountVisitor;

impl Visitor<'_> for CountVisitor {
    type Value = Count;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a whole number, such as 65536, 65_536 or 1e6")
    }

    fn visit_u64<E: Error>(self, said: u64) -> Result<Count, E> {
        let count = u32::try_from(said).map(Count);
        count.map_err(|_| E::custom(format!("{said} is too large: at most {}", u32::MAX)))
    }

    fn visit_i64<E: Error>(self, said: i64) -> Result<Count, E> {
        let refused = |_| {
            E::custom(format!(
                "expected a whole number of 0 or more here, not {said}"
            ))
        };
        u64::try_from(said)
            .map_err(refused)
            .and_then(|said| self.visit_u64(said))
    }

    fn visit_f64<E: Error>(self, said: f64) -> Result<Count, E> {
        if said.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&said) {
            return Ok(Count(said as u32));
        }
        Err(E::custom(format!(
            "expected a whole number from 0 to {} here, such as 65536, 65_536 or 1e6, not {said}",
            u32::MAX
        )))
    }
}

/// A list of whole numbers.
fn counts<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<u32>, D::Error> {
    let counts = Vec::<Count>::deserialize(from)?;
    Ok(counts.into_iter().map(|count| count.0).collect())
}

fn yes() -> bool {
    true
}

fn hybrid() -> Vec<ProfileFile> {
    vec![ProfileFile::Hybrid]
}

fn random() -> Vec<DirectionsFile> {
    vec![DirectionsFile::Random]
}

fn usual_waves() -> Vec<u32> {
    vec![65_536]
}

fn usual_iterations() -> Vec<u32> {
    vec![8]
}

fn usual_figures() -> Vec<FigureName> {
    vec![FigureName::G, FigureName::T30, FigureName::C80]
}

/// The bands over which ISO 3382-1 (annex A) averages the figures of a hall.
fn usual_bands() -> Vec<u32> {
    vec![500, 1000]
}

impl From<ProfileFile> for Profile {
    fn from(said: ProfileFile) -> Profile {
        match said {
            ProfileFile::Hybrid => Profile::Hybrid,
            ProfileFile::March => Profile::March,
            ProfileFile::Thesis => Profile::Thesis,
        }
    }
}

impl From<DirectionsFile> for Directions {
    fn from(said: DirectionsFile) -> Directions {
        match said {
            DirectionsFile::Random => Directions::Random,
            DirectionsFile::Fibonacci => Directions::Fibonacci,
        }
    }
}

impl StudyFile {
    /// Reads a study file.
    pub fn read(path: &Path) -> Result<StudyFile, StudyError> {
        let text = read_text(path, LARGEST_FILE).map_err(|source| StudyError::Unreadable {
            path: path.to_owned(),
            source,
        })?;
        StudyFile::from_ron(&text, &path.display().to_string())
    }

    /// Reads a study from RON text. `origin` is its name in errors.
    pub fn from_ron(text: &str, origin: &str) -> Result<StudyFile, StudyError> {
        let options = ron::Options::default()
            .with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME)
            .with_recursion_limit(DEEPEST);
        // Some editors write a byte-order mark before the text.
        let text = text.trim_start_matches('\u{feff}');
        options.from_str(text).map_err(|error| {
            if let Some((place, told)) = unclosed_quote(text, &error) {
                let told = MalformedText::new(origin, (place.line, place.col), told);
                return StudyError::Malformed(told);
            }
            let mut message = in_a_line(&sentence(text, &error, STUDY)).into_owned();
            if matches!(&error.code, ron::Error::NoSuchStructField { found, .. } if found == ACCURACY)
            {
                message += "; the accuracy of responses is in keep: Keep(response: Response(accuracy: 0.02))";
            }
            let place = error.span.start;
            StudyError::Malformed(MalformedText::new(origin, (place.line, place.col), message))
        })
    }
}

/// The path of a scene file; `None` for a built-in scene.
pub(super) fn scene_file(of: &str, folder: &Path) -> Option<PathBuf> {
    (!Scene::BUILTIN_NAMES.contains(&of)).then(|| folder.join(of))
}
