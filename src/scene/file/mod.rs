//! Scene files in RON.
//!
//! The types here are what the text says (degrees, full sizes); they turn into
//! the plain [`Scene`] at once. Every number is checked while it is read, so that
//! an error points at its line and column. See `docs/scene-format.md`.

mod attached;
mod build;
mod numbers;
mod shapes;

use super::{Key, Listener, Path, Scene, SceneError, Source};
use crate::input::read_text;
use crate::text::in_a_line;
use attached::Attached;
use numbers::{Angle, Degrees, Finite, FixedRadius, Metres, Name, Point, Vector};
use serde::Deserialize;
use shapes::ShapeFile;

/// Bytes of a scene file at the most: 100,000 key frames are 2 MB, and what a text of this size
/// can say (a shape in six bytes) fits into a gigabyte of memory.
const LARGEST_FILE: u64 = 4 << 20;

/// How deep the text may be nested; a shape within a shape takes four or five of it. It keeps
/// a text from filling the stack.
const DEEPEST: usize = 512;

impl Scene {
    /// Reads a scene file, and the files that it names from the same folder.
    ///
    /// # Errors
    /// [`SceneError::Unreadable`], [`SceneError::Malformed`] with line and column,
    /// [`SceneError::Attached`] for the files that it names, or what
    /// [`Scene::check`] refuses.
    pub fn from_file(path: &std::path::Path) -> Result<Scene, SceneError> {
        let text = Scene::text_of_file(path)?;
        let folder = path.parent().unwrap_or(std::path::Path::new(""));
        let files = Attached::in_folder(&path.display().to_string(), folder);
        let mut scene = parse(&text, &files)?;
        if scene.name.is_empty()
            && let Some(stem) = path.file_stem()
        {
            scene.name = in_a_line(&stem.to_string_lossy()).into_owned();
        }
        scene.check()?;
        Ok(scene)
    }

    /// The text of a scene file, as it stands.
    ///
    /// # Errors
    /// [`SceneError::Unreadable`], also for a file of more than 4 MiB.
    pub fn text_of_file(path: &std::path::Path) -> Result<String, SceneError> {
        read_text(path, LARGEST_FILE).map_err(|source| SceneError::Unreadable {
            path: path.to_owned(),
            source,
        })
    }

    /// Reads a scene from RON text; `origin` is what errors call it. Files that it names
    /// are looked for from the current folder.
    ///
    /// ```
    /// let text = "Scene(
    ///     surfaces: [Surface(shape: Plane, position: (0, -2, 0))],
    ///     source: Source(position: (0, 0, -5)),
    ///     listener: Listener(position: (0, 0, 0), radius: 1),
    /// )";
    /// let scene = echomarch::Scene::from_ron(text, "doc")?;
    /// assert_eq!(scene.surfaces.len(), 1);
    /// # Ok::<(), echomarch::Error>(())
    /// ```
    ///
    /// # Errors
    /// As of [`Scene::from_file`].
    pub fn from_ron(text: &str, origin: &str) -> Result<Scene, SceneError> {
        Scene::from_ron_in(text, origin, std::path::Path::new(""))
    }

    /// As [`Scene::from_ron`]; the files that it names are in `folder`.
    ///
    /// # Errors
    /// As of [`Scene::from_file`].
    pub fn from_ron_in(
        text: &str,
        origin: &str,
        folder: &std::path::Path,
    ) -> Result<Scene, SceneError> {
        let scene = parse(text, &Attached::in_folder(origin, folder))?;
        scene.check()?;
        Ok(scene)
    }

    /// Reads a scene whose files stand within the program.
    pub(super) fn from_embedded(
        text: &str,
        origin: &str,
        files: &'static [(&'static str, &'static str)],
    ) -> Result<Scene, SceneError> {
        let scene = parse(text, &Attached::embedded(origin, files))?;
        scene.check()?;
        Ok(scene)
    }
}

/// The scene that the text says, not yet checked as a whole.
fn parse(text: &str, files: &Attached) -> Result<Scene, SceneError> {
    let options = ron::Options::default()
        .with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME)
        .with_recursion_limit(DEEPEST);
    // Some editors put a byte-order mark before the text.
    let text = text.trim_start_matches('\u{feff}');
    let file: SceneFile = options.from_str(text).map_err(|error| {
        let start = error.span.start;
        let message = match error.code {
            ron::Error::ExceededRecursionLimit => "shapes are nested too deeply here".to_owned(),
            code => in_a_line(&code.to_string()).into_owned(),
        };
        SceneError::Malformed {
            origin: files.origin().to_owned(),
            line: start.line,
            column: start.col,
            message,
        }
    })?;
    file.scene(files)
}

#[derive(Deserialize)]
#[serde(rename = "Scene", deny_unknown_fields)]
struct SceneFile {
    #[serde(default)]
    name: Name,
    surfaces: Vec<SurfaceFile>,
    source: SourceFile,
    listener: ListenerFile,
}

#[derive(Deserialize)]
#[serde(rename = "Surface", deny_unknown_fields)]
struct SurfaceFile {
    #[serde(default)]
    name: Option<Name>,
    shape: ShapeFile,
    #[serde(default)]
    position: Vector<Metres>,
    /// Right-handed turns about x, then y, then z, of the world's axes.
    #[serde(default)]
    rotation: Vector<Angle>,
    #[serde(default)]
    turns: bool,
}

#[derive(Deserialize)]
#[serde(rename = "Source", deny_unknown_fields)]
struct SourceFile {
    #[serde(default)]
    position: Option<Point>,
    #[serde(default)]
    path: PathFile,
}

#[derive(Deserialize)]
#[serde(rename = "Listener", deny_unknown_fields)]
struct ListenerFile {
    #[serde(default)]
    position: Option<Point>,
    #[serde(default)]
    yaw: Degrees,
    #[serde(default)]
    pitch: Degrees,
    radius: FixedRadius,
    #[serde(default)]
    path: PathFile,
}

#[derive(Deserialize)]
#[serde(rename = "Key", deny_unknown_fields)]
struct KeyFile {
    time: Finite,
    position: Point,
    #[serde(default)]
    yaw: Degrees,
    #[serde(default)]
    pitch: Degrees,
}

/// Keys whose times strictly increase.
#[derive(Default, Deserialize)]
#[serde(try_from = "Vec<KeyFile>")]
struct PathFile(Path);

impl TryFrom<Vec<KeyFile>> for PathFile {
    type Error = String;
    fn try_from(keys: Vec<KeyFile>) -> Result<PathFile, String> {
        let keys = keys.iter().map(Key::from).collect();
        match Path::new(keys) {
            Some(path) => Ok(PathFile(path)),
            None => Err("the times of a path's keys must increase".to_owned()),
        }
    }
}

impl From<&KeyFile> for Key {
    fn from(key: &KeyFile) -> Key {
        Key {
            time: key.time.0,
            position: key.position.0,
            yaw: key.yaw.0,
            pitch: key.pitch.0,
        }
    }
}

impl SceneFile {
    /// The scene, with the files that it names.
    fn scene(self, files: &Attached) -> Result<Scene, SceneError> {
        let surfaces = self.surfaces.into_iter();
        let surfaces: Result<_, _> = surfaces.map(|s| build::surface(s, files)).collect();
        Ok(Scene {
            name: self.name.0,
            surfaces: surfaces?,
            source: Source::from(self.source),
            listener: Listener::from(self.listener),
        })
    }
}

impl From<SourceFile> for Source {
    fn from(file: SourceFile) -> Source {
        let start = file.path.0.at(0.0).map(|key| key.position);
        Source {
            position: file.position.map(|p| p.0).or(start).unwrap_or_default(),
            path: file.path.0,
        }
    }
}

impl From<ListenerFile> for Listener {
    fn from(file: ListenerFile) -> Listener {
        let start = file.path.0.at(0.0);
        let standing = Listener {
            position: file.position.unwrap_or_default().0,
            yaw: file.yaw.0,
            pitch: file.pitch.0,
            radius: file.radius.0,
            path: file.path.0,
        };
        match start {
            Some(key) if file.position.is_none() => Listener {
                position: key.position,
                yaw: key.yaw,
                pitch: key.pitch,
                ..standing
            },
            _ => standing,
        }
    }
}
