//! What was set up by hand as a scene file, and as a command line.
//!
//! The file is the scene's own text with source and listener put where they are now; all
//! else stays as it was written, comments included.

use super::text::{field, inside, named_values};
use crate::output::{OutputError, write_whole};
use crate::scene::{Scene, SceneError, Source};
use crate::trace::{Directions, Profile, Settings};
use glam::Vec3;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Names of files that are tried for one stem.
const NAMES_AT_MOST: u32 = 9999;

/// A scene that could not be saved.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SaveError {
    /// The text has no source or listener that could be found in it.
    #[error("cannot save the scene: its text has no {0} that could be replaced")]
    NoField(&'static str),
    /// What was written is not the scene that is heard.
    #[error("cannot save the scene: its text with the new places would be another scene")]
    Differs,
    /// What was written is no scene at all.
    #[error("cannot save the scene: {0}")]
    NotAScene(#[from] SceneError),
    /// All names are taken.
    #[error("cannot save the scene: {}-1.ron and those after it are all taken", .0.display())]
    NoName(PathBuf),
    /// The file cannot be written.
    #[error(transparent)]
    Write(#[from] OutputError),
}

/// The text that a scene was read from: a built-in one's, or a file's.
///
/// # Errors
/// As [`Scene::load`].
pub fn text_of(name_or_file: &str) -> Result<String, SceneError> {
    if let Some(text) = Scene::builtin_text(name_or_file) {
        return Ok(text.to_owned());
    }
    Scene::text_of_file(Path::new(name_or_file))
}

/// What was moved by hand; the rest stays as the text has it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moved {
    /// Where the source was put, in world metres.
    pub source: Option<Vec3>,
    /// Where the listener stands and looks: metres; yaw and pitch in radians.
    pub listener: Option<(Vec3, f32, f32)>,
}

/// `text` with what was moved in its new place. What was moved has no path any more.
///
/// # Errors
/// [`SaveError::NoField`].
pub fn with_places(text: &str, moved: &Moved) -> Result<String, SaveError> {
    let mut text = text.to_owned();
    if let Some(position) = moved.source {
        let fields = [("position", Some(point(position))), ("path", None)];
        text = with_fields(&text, "source", &fields)?;
    }
    if let Some((position, yaw, pitch)) = moved.listener {
        let fields = [
            ("position", Some(point(position))),
            ("yaw", Some(yaw.to_degrees().to_string())),
            ("pitch", Some(pitch.to_degrees().to_string())),
            ("path", None),
        ];
        text = with_fields(&text, "listener", &fields)?;
    }
    Ok(text)
}

/// `text`, loaded by the name or file `origin`, with named values in the unit of the file: the
/// surfaces are then those of `scene`.
///
/// # Errors
/// [`SaveError::Differs`] where they would not be, [`SaveError::NotAScene`].
pub fn with_values(
    text: &str,
    origin: &str,
    values: &[(String, f32)],
    scene: &Scene,
) -> Result<String, SaveError> {
    if values.is_empty() {
        return Ok(text.to_owned());
    }
    let mut new = text.to_owned();
    // From the end on, so that what is before stays where it is.
    for said in named_values(text).into_iter().rev() {
        let set = values.iter().find(|(name, _)| *name == said.name);
        if let Some((_, value)) = set {
            new.replace_range(said.number, &value.to_string());
        }
    }
    let folder = folder_of(Path::new(origin));
    let read = Scene::from_ron_in(&new, "the scene to be saved", folder)?;
    if read.surfaces != scene.surfaces {
        return Err(SaveError::Differs);
    }
    Ok(new)
}

/// Saves `text` with what was moved, to `path`, or else in the folder of `origin` (the name
/// or file that the text was loaded by) under the next free name `NAME-1.ron`.
///
/// What is to be written is read before, from the folder that it will lie in, where the files
/// that it names must be: it must be `scene` where that was moved, and all else as in `text`.
///
/// # Errors
/// [`SaveError`]; then nothing is left behind.
pub fn save(
    text: &str,
    origin: &str,
    moved: &Moved,
    scene: &Scene,
    path: Option<&Path>,
) -> Result<PathBuf, SaveError> {
    let path = match path {
        Some(path) => path.to_owned(),
        None => free_file(folder_of(Path::new(origin)), &stem(&scene.name), "ron")
            .ok_or_else(|| SaveError::NoName(stem(&scene.name).into()))?,
    };
    let new = with_places(text, moved)?;
    let read = |text: &str| Scene::from_ron_in(text, "the scene to be saved", folder_of(&path));
    if !is_same(&read(&new)?, &read(text)?, scene, moved) {
        return Err(SaveError::Differs);
    }
    write_whole(&path, |out| out.write_all(new.as_bytes()))?;
    Ok(path)
}

/// Whether what was `read` is as it stands `now` where it was moved, but for the rounding of
/// degrees, and as it was `written` in all else.
fn is_same(read: &Scene, written: &Scene, now: &Scene, moved: &Moved) -> bool {
    let near = |a: f32, b: f32| (a - b).abs() < 1e-4;
    let source = match moved.source {
        None => read.source == written.source,
        Some(_) => read.source == Source::at(now.source.position),
    };
    let (a, b) = (&read.listener, &now.listener);
    let listener = match moved.listener {
        None => *a == written.listener,
        Some(_) => {
            let is_there = a.position == b.position && near(a.yaw, b.yaw) && near(a.pitch, b.pitch);
            is_there && a.path.is_empty() && a.radius == b.radius
        }
    };
    source && listener && read.surfaces == written.surfaces && read.name == written.name
}

/// The folder that a file lies in; the one worked in for a name alone.
fn folder_of(file: &Path) -> &Path {
    file.parent().unwrap_or(Path::new(""))
}

/// The first name `STEM-1.ENDING` in a folder that is free.
pub fn free_file(folder: &Path, stem: &str, ending: &str) -> Option<PathBuf> {
    (1..NAMES_AT_MOST)
        .map(|number| folder.join(format!("{stem}-{number}.{ending}")))
        .find(|path| !path.exists())
}

/// A scene's name as a part of a file's.
fn stem(scene: &str) -> String {
    scene
        .chars()
        .map(|c| {
            if c.is_alphanumeric() || c == '-' {
                c
            } else {
                '_'
            }
        })
        .collect()
}

fn point(p: Vec3) -> String {
    format!("({}, {}, {})", p.x, p.y, p.z)
}

/// `text` with fields of the structure `name` replaced, added or (`None`) left out.
fn with_fields(
    text: &str,
    name: &'static str,
    fields: &[(&str, Option<String>)],
) -> Result<String, SaveError> {
    let missing = || SaveError::NoField(name);
    let outer = inside(text, 0).ok_or_else(missing)?;
    let value = field(text, outer, name).ok_or_else(missing)?.value;
    let mut inner = inside(text, value.start)
        .filter(|inner| inner.end <= value.end)
        .ok_or_else(missing)?;
    let mut text = text.to_owned();
    for (key, new) in fields {
        let old = field(&text, inner.clone(), key);
        let length = text.len();
        match (old, new) {
            (Some(old), Some(new)) => text.replace_range(old.value, new),
            (Some(old), None) => text.replace_range(old.whole, ""),
            (None, Some(new)) => text.insert_str(inner.start, &format!("{key}: {new}, ")),
            (None, None) => {}
        }
        inner.end = inner.end + text.len() - length;
    }
    Ok(text)
}

/// The `trace` call that traces what the window traced, so many seconds on the scene's paths
/// if it has any, and with these named values.
pub fn trace_call(
    scene: &str,
    seconds: Option<f64>,
    values: &[(String, f32)],
    settings: &Settings,
) -> String {
    let usual = Settings::of(settings.profile);
    let mut call = format!(
        "echomarch trace {} --profile {} --waves {} --iterations {}",
        quoted(scene),
        settings.profile,
        settings.waves,
        settings.iterations
    );
    let mut add = |option: &str, value: &dyn std::fmt::Display| {
        let _ = write!(call, " --{option} {value}");
    };
    if let Some(seconds) = seconds {
        add("time", &seconds);
    }
    for (name, value) in values {
        add("set", &quoted(&format!("{name}={value}")));
    }
    if settings.seed != usual.seed {
        add("seed", &settings.seed);
    }
    if settings.directions != Directions::Random {
        add("directions", &settings.directions);
    }
    let is_march = settings.profile == Profile::March;
    if settings.profile != Profile::Hybrid && settings.min_distance != usual.min_distance {
        add("min-distance", &settings.min_distance);
    }
    if settings.max_distance != usual.max_distance {
        add("max-distance", &settings.max_distance);
    }
    if settings.iterations_per_pass != usual.iterations_per_pass {
        add("iterations-per-pass", &settings.iterations_per_pass);
    }
    for (option, is_set) in [
        ("sum-on-gpu", settings.sum_on_gpu),
        ("difference-normals", is_march && !settings.exact_normals),
        ("no-landing", is_march && !settings.landing),
    ] {
        if is_set {
            let _ = write!(call, " --{option}");
        }
    }
    call
}

/// A word as a shell takes it.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "._-/+=".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::BUILTIN_NAMES;

    /// Protects the list above from a built-in scene that it lacks: that one could not be saved.
    #[test]
    fn every_built_in_scene_has_its_text() {
        for name in BUILTIN_NAMES {
            let scene = Scene::from_ron(&text_of(name).unwrap(), name).unwrap();
            assert_eq!(scene.source, Scene::builtin(name).unwrap().source);
        }
    }

    /// Protects every built-in scene: saved with new places it is the same scene in these places, without paths.
    #[test]
    fn places_are_replaced_and_all_else_stays() {
        let (source, listener) = (Vec3::new(1.5, -0.25, 1e-3), Vec3::new(-3.0, 0.5, 4.0));
        let moved = Moved {
            source: Some(source),
            listener: Some((listener, 0.5, -0.25)),
        };
        for name in BUILTIN_NAMES {
            let text = text_of(name).unwrap();
            let read = Scene::from_ron(&with_places(&text, &moved).unwrap(), name).unwrap();
            let mut expected = Scene::builtin(name).unwrap();
            expected.source = crate::scene::Source::at(source);
            expected.listener.position = listener;
            (expected.listener.yaw, expected.listener.pitch) = (0.5, -0.25);
            expected.listener.path = crate::scene::Path::default();
            assert!(is_same(&read, &expected, &expected, &moved), "{name}");
            assert_eq!(read.surfaces, expected.surfaces);
            assert!(read.source.path.is_empty() && read.listener.path.is_empty());
            assert_eq!(with_places(&text, &Moved::default()).unwrap(), text);
        }
    }

    /// Protects texts that are written otherwise: brackets in strings and comments, no names, no comma at the end.
    #[test]
    fn strings_and_comments_are_no_brackets() {
        let text = r#"/* ( */ (surfaces: [Surface(name: "a ) \" source: (", shape: Plane, position: (0, -2, 0))], // )
            source: (path: [Key(time: 0, position: (1, 1, 1))], position: (0, 0, -5)), listener: Listener(radius: 1))"#;
        let moved = Moved {
            source: Some(Vec3::ONE),
            listener: Some((Vec3::X, 0.0, 0.0)),
        };
        let read = Scene::from_ron(&with_places(text, &moved).unwrap(), "text").unwrap();
        assert_eq!(read.source, crate::scene::Source::at(Vec3::ONE));
        assert_eq!(read.listener.position, Vec3::X);
        assert!(with_places("Scene(surfaces: [])", &moved).is_err());
        assert!(with_places("(((", &moved).is_err());
    }

    /// Protects values that were set from being lost in the file: each stands where the text had it, in its unit,
    /// whatever stands around it.
    #[test]
    fn values_are_written_where_they_stand() {
        let text = r#"Scene(
            surfaces: [
                Surface(name: "Value(\"a\", 1)", shape: Sphere(radius: Value("a", /* , */ 1))),
                Surface(shape: Box(size: (1, 2, Value ( "a" , 1 , ))), rotation: (0, Value("b c", 30), 0)),
            ],
            source: Source(position: (0, 0, -5)), listener: Listener(position: (0, 0, 5), radius: 1))"#;
        let mut scene = Scene::from_ron(text, "text").unwrap();
        let values = [("a".to_owned(), 2.5), ("b c".to_owned(), -60.0)];
        for (name, value) in &values {
            scene.set_value(name, *value).unwrap();
        }
        let new = with_values(text, "text", &values, &scene).unwrap();
        let read = Scene::from_ron(&new, "text").unwrap();
        assert_eq!(read.surfaces, scene.surfaces);
        assert!(
            new.contains(r#"Value(\"a\", 1)"#) && new.contains(r#"Value("b c",-60)"#),
            "{new}"
        );
        let wrong = with_values(text, "text", &values[..1], &scene);
        assert!(matches!(wrong, Err(SaveError::Differs)));
        assert_eq!(with_values(text, "text", &[], &scene).unwrap(), text);
    }

    /// Protects the file from being another scene than the one heard.
    #[test]
    fn a_file_that_would_differ_is_not_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("saved.ron");
        let text = text_of("corner").unwrap();
        let scene = Scene::builtin("corner").unwrap();
        let moved = Moved {
            source: Some(Vec3::ONE),
            listener: None,
        };
        let refused = save(&text, "corner", &moved, &scene, Some(&path));
        assert!(matches!(refused, Err(SaveError::Differs)) && !path.exists());
        save(&text, "corner", &Moved::default(), &scene, Some(&path)).unwrap();
        assert_eq!(Scene::from_file(&path).unwrap().surfaces, scene.surfaces);
    }

    /// Protects scenes that name files: the new one lies beside the old one, where they are found, and nowhere
    /// else.
    #[test]
    fn a_scene_that_names_files_is_saved_where_they_are() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("mine.ron");
        let ball = "float field(vec3 p) { return length(p) - 1.0; }";
        std::fs::write(folder.path().join("ball.glsl"), ball).unwrap();
        let field = "Field(file: \"ball.glsl\", lipschitz: 1, size: (3, 3, 3))";
        let text = format!(
            "Scene(surfaces: [Surface(shape: {field})], source: Source(position: (0, 0, -5)), \
             listener: Listener(position: (0, 0, 5), radius: 1))"
        );
        std::fs::write(&file, &text).unwrap();
        let scene = Scene::from_file(&file).unwrap();
        let origin = file.to_str().unwrap();
        let saved = save(&text, origin, &Moved::default(), &scene, None).unwrap();
        assert_eq!(saved, folder.path().join("mine-1.ron"));
        assert_eq!(Scene::from_file(&saved).unwrap().surfaces, scene.surfaces);
        let elsewhere = tempfile::tempdir().unwrap();
        let path = elsewhere.path().join("x.ron");
        let refused = save(&text, origin, &Moved::default(), &scene, Some(&path));
        assert!(matches!(refused, Err(SaveError::NotAScene(_))) && !path.exists());
    }

    /// Protects the line from what a shell would take apart, and from options that go without saying.
    #[test]
    fn the_call_says_what_is_not_usual() {
        let usual = trace_call("corner", None, &[], &Settings::default());
        let expected = "echomarch trace corner --profile hybrid --waves 65536 --iterations 8";
        assert_eq!(usual, expected);
        let mut settings = Settings::thesis().with_seed(3);
        settings.min_distance = 0.01;
        settings.sum_on_gpu = true;
        let values = [("the door".to_owned(), 60.5), ("gap".to_owned(), -2.0)];
        let call = trace_call("my room's.ron", Some(2.5), &values, &settings);
        assert!(call.starts_with(r"echomarch trace 'my room'\''s.ron' --profile thesis"));
        assert!(
            call.ends_with("--time 2.5 --set 'the door=60.5' --set gap=-2 --seed 3 --min-distance 0.01 --sum-on-gpu"),
            "{call}"
        );
    }
}
