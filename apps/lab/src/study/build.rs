//! Builds a study from the content of its file: loads its scenes and counts its points.

use super::check::{Checker, MOST_POINTS};
use super::columns::ResponseColumns;
use super::file::{Keep, ResponseFile, SceneFile, SettingsFile, StudyFile, Sweep};
use super::{Case, Kept, SceneAxis, Study, StudyError, hash};
use crate::experiment::accuracy;
use crate::of_first_pair;
use crate::text::in_a_line;
use echomarch::response::{Accuracy, ResponseSettings};
use echomarch::scene::{Scene, SceneError};
use echomarch::tracer::{Settings, TraceError};
use std::path::Path;

/// Reads a study from its file.
pub(super) fn from_file(path: &Path) -> Result<Study, StudyError> {
    let mut file = StudyFile::read(path)?;
    let origin = path.display().to_string();
    if file.name.is_empty()
        && let Some(stem) = path.file_stem()
    {
        file.name = in_a_line(&stem.to_string_lossy()).into_owned();
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    study(&file, &Checker { origin: &origin }, folder)
}

/// Builds the study of a file, whose scenes are in `folder`.
pub(super) fn study(
    file: &StudyFile,
    checker: &Checker,
    folder: &Path,
) -> Result<Study, StudyError> {
    checker.check(file)?;
    let mut study = Study {
        name: file.name.clone(),
        hash: String::new(),
        variants: scenes(file, checker, folder)?,
        times: file.times.clone(),
        settings: settings(&file.settings),
        sources: file.sources.clone(),
        listeners: file.listeners.clone(),
        listener_radius: file.listener_radius,
        seeds: file.seeds.clone(),
        keep: kept(&file.keep),
        each: 0,
        points: 0,
    };
    check_settings(&study, checker)?;
    count(&mut study, checker)?;
    study.hash = hash::of(file, &study, folder).map_err(|(path, source)| {
        // The file was readable when the study was read.
        StudyError::Unreadable { path, source }
    })?;
    Ok(study)
}

/// Loads every scene, and tests the numbers of its named values.
fn scenes(
    file: &StudyFile,
    checker: &Checker,
    folder: &Path,
) -> Result<Vec<SceneAxis>, StudyError> {
    let mut axes: Vec<SceneAxis> = Vec::new();
    for (at, said) in file.scenes.iter().enumerate() {
        let place = format!("scenes[{}]", at + 1);
        let refused = |source: SceneError| StudyError::Scene {
            origin: checker.origin.to_owned(),
            place: place.clone(),
            source: Box::new(source),
        };
        let scene = load(said, folder).map_err(refused)?;
        let first = axes.last().map_or(0, |before| before.end);
        let lengths = said.values.values().map(|numbers| numbers.len());
        let variants = product(lengths).and_then(|variants| first.checked_add(variants));
        let Some(end) = variants else {
            return too_many(checker, "more than can be counted");
        };
        try_values(&scene, said).map_err(refused)?;
        axes.push(SceneAxis {
            scene,
            values: said.values.clone(),
            first,
            end,
        });
    }
    Ok(axes)
}

fn load(said: &SceneFile, folder: &Path) -> Result<Scene, SceneError> {
    Ok(of_first_pair(Scene::load_in(&said.of, folder)?))
}

/// Maximum number of values of an axis that are tested before work begins. On longer axes, the ends and some values
/// between them are tested.
const MOST_TRIED: u64 = 16;

/// Sets each named value to the numbers of its axis, while all other values are those of the scene file. Values that
/// the scene rejects are thereby reported before the first point.
fn try_values(scene: &Scene, said: &SceneFile) -> Result<(), SceneError> {
    for (name, numbers) in &said.values {
        let tried = numbers.len().min(MOST_TRIED);
        for step in 0..tried {
            let last = (numbers.len() - 1) as u128;
            let at = last * u128::from(step) / u128::from((tried - 1).max(1));
            let mut changed = scene.clone();
            changed.set_value(name, numbers.get(at as u64) as f32)?;
            changed.check()?;
        }
    }
    Ok(())
}

fn settings(said: &SettingsFile) -> Vec<Case> {
    let SettingsFile::All {
        profiles,
        waves,
        iterations,
        directions,
    } = said
    else {
        return accuracy_cases(said);
    };
    let mut cases = Vec::new();
    for &profile in profiles {
        for &directions in directions {
            for &waves in waves {
                for &iterations in iterations {
                    let settings = Settings::new(echomarch::tracer::Profile::from(profile))
                        .with_waves(waves)
                        .with_iterations(iterations)
                        .with_directions(directions.into());
                    cases.push(Case {
                        label: None,
                        settings,
                    });
                }
            }
        }
    }
    cases
}

fn accuracy_cases(said: &SettingsFile) -> Vec<Case> {
    let cases = match said {
        SettingsFile::Accuracy(Sweep::Full) => accuracy::full(),
        SettingsFile::Accuracy(Sweep::Quick) => accuracy::quick(),
        SettingsFile::Accuracy(Sweep::Short) => accuracy::short(false),
        SettingsFile::All { .. } => Vec::new(),
    };
    let case = |case: accuracy::Case| Case {
        label: Some(case.label),
        settings: case.settings,
    };
    cases.into_iter().map(case).collect()
}

fn kept(said: &Keep) -> Kept {
    let response = |said: &ResponseFile| {
        let mut settings = ResponseSettings::default();
        settings.seconds = said.seconds;
        settings.order = said.order;
        settings.diffraction = said.diffraction;
        settings.accuracy = said.accuracy.map(Accuracy::new);
        (settings, ResponseColumns::of(said))
    };
    Kept {
        pan: said.pan,
        counts: said.counts,
        exact: said.exact,
        response: said.response.as_ref().map(response),
    }
}

/// Checks that every case can be traced. If responses are kept, also checks that every case supports responses.
fn check_settings(study: &Study, checker: &Checker) -> Result<(), StudyError> {
    for case in &study.settings {
        if let Err(error) = case.settings.validate() {
            let error = echomarch::Error::from(error);
            return checker.bad("settings", "what can be traced", error);
        }
        let Some((response, _)) = &study.keep.response else {
            continue;
        };
        let response = response.clone().with_trace_of_frames(&case.settings);
        if let Err(error) = response.validate() {
            let told = match &error {
                echomarch::Error::Trace(TraceError::NoArrivals { profile }) => profile.clone(),
                other => other.to_string(),
            };
            return checker.bad(
                "settings",
                "of hybrid or march where responses are kept",
                told,
            );
        }
    }
    Ok(())
}

fn product(lengths: impl IntoIterator<Item = u64>) -> Option<u64> {
    lengths
        .into_iter()
        .try_fold(1u64, |all, length| all.checked_mul(length))
}

fn count(study: &mut Study, checker: &Checker) -> Result<(), StudyError> {
    let times = study.times.as_ref().map_or(1, |times| times.len());
    let lengths = [
        Some(times),
        Some(study.settings.len() as u64),
        study.sources.len(),
        study.listeners.len(),
        Some(study.seeds.len()),
    ];
    let each = lengths.into_iter().collect::<Option<Vec<u64>>>();
    let each = each.and_then(product);
    let variants = study.variants.last().map_or(0, |last| last.end);
    match each.and_then(|each| Some((each, each.checked_mul(variants)?))) {
        Some((each, points)) if points <= MOST_POINTS => {
            (study.each, study.points) = (each, points);
            Ok(())
        }
        Some((_, points)) => too_many(checker, &points.to_string()),
        None => too_many(checker, "more than can be counted"),
    }
}

fn too_many<T>(checker: &Checker, count: &str) -> Result<T, StudyError> {
    let must = format!("at most {MOST_POINTS}");
    checker.bad("the number of points", must, count)
}
