//! Scene files in RON.
//!
//! The types here are what the text says (degrees, full sizes); they turn into
//! the plain [`Scene`] at once. Every number is checked while it is read, so that
//! an error points at its line and column. See `docs/scene-format.md`.

mod base_scene;
mod hints;
mod serialise;
mod surface;
#[cfg(feature = "demo")]
mod write;

use super::{Key, Listener, Path, Scene, SceneError, Source};
use crate::input::read_text;
use crate::scene::notation::{Attached, Degrees, Finite, FixedRadius, Name, Point};
use crate::text::in_a_line;
use base_scene::{BasedFile, Chain};
use glam::Vec3;
use serde::Deserialize;
use std::path;
use surface::SurfaceFile;

pub(super) use base_scene::bases_of;
#[cfg(feature = "demo")]
pub(crate) use write::BasedScene;

/// Bytes of a scene file at the most: 100,000 key frames are 2 MB, and what a text of this size
/// can say (a shape in six bytes) fits into a gigabyte of memory.
const LARGEST_FILE: u64 = 4 << 20;

/// How deep the text may be nested; a shape within a shape takes four or five of it. It keeps
/// a text from filling the stack.
const DEEPEST: usize = 512;

impl Scene {
    /// Reads a scene file, its base, and the files that each names from its own folder.
    ///
    /// # Errors
    /// [`SceneError::Unreadable`], [`SceneError::Malformed`] with line and column,
    /// [`SceneError::Attached`] for the files that it names, or what
    /// [`Scene::check`] refuses.
    pub fn from_file(path: &path::Path) -> Result<Scene, SceneError> {
        let scene = scene_of_file(path, &text_of(path)?, &Chain::at(path))?;
        scene.check()?;
        Ok(scene)
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
        Scene::from_ron_in(text, origin, path::Path::new(""))
    }

    /// As [`Scene::from_ron`]; the files that it names are in `folder`.
    ///
    /// # Errors
    /// As of [`Scene::from_file`].
    pub fn from_ron_in(text: &str, origin: &str, folder: &path::Path) -> Result<Scene, SceneError> {
        let files = Attached::in_folder(origin, folder);
        let scene = parse(text, &files, &Chain::default())?;
        scene.check()?;
        Ok(scene)
    }

    /// Reads a scene whose files stand within the program.
    pub(super) fn from_embedded(
        text: &str,
        origin: &str,
        files: &'static [(&'static str, &'static str)],
    ) -> Result<Scene, SceneError> {
        let files = Attached::embedded(origin, files);
        let scene = parse(text, &files, &Chain::default())?;
        scene.check()?;
        Ok(scene)
    }
}

/// The text of a scene file, as it stands but for a byte-order mark, which some editors put
/// before it.
fn text_of(path: &path::Path) -> Result<String, SceneError> {
    read_text(path, LARGEST_FILE).map_err(|source| SceneError::Unreadable {
        path: path.to_owned(),
        source,
    })
}

/// The folder that a file lies in; the current one for a name alone.
fn folder_of(path: &path::Path) -> &path::Path {
    path.parent().unwrap_or(path::Path::new(""))
}

/// The scene of a file with this text, not yet checked as a whole.
fn scene_of_file(path: &path::Path, text: &str, chain: &Chain) -> Result<Scene, SceneError> {
    let files = Attached::in_folder(&path.display().to_string(), folder_of(path));
    let mut scene = parse(text, &files, chain)?;
    if scene.name.is_empty()
        && let Some(stem) = path.file_stem()
    {
        scene.name = in_a_line(&stem.to_string_lossy()).into_owned();
    }
    Ok(scene)
}

fn options() -> ron::Options {
    ron::Options::default()
        .with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME)
        .with_recursion_limit(DEEPEST)
}

/// The scene that the text says, not yet checked as a whole.
fn parse(text: &str, files: &Attached, chain: &Chain) -> Result<Scene, SceneError> {
    // Some editors put a byte-order mark before the text.
    let text = text.trim_start_matches('\u{feff}');
    let error = match options().from_str::<SceneFile>(text) {
        Ok(file) => return file.scene(files),
        Err(error) => error,
    };
    if !base_scene::has_base(text, &error.code) {
        return Err(from_ron(files, text, &error));
    }
    let file: BasedFile = options()
        .from_str(text)
        .map_err(|error| from_ron(files, text, &error))?;
    file.scene(text, files, chain)
}

fn from_ron(files: &Attached, text: &str, error: &ron::error::SpannedError) -> SceneError {
    let start = error.span.start;
    let message = match (&error.code, hints::about_shape(text, error)) {
        (_, Some(hint)) => hint,
        (ron::Error::ExceededRecursionLimit, _) => "shapes are nested too deeply here".to_owned(),
        (code, None) => code.to_string(),
    };
    malformed(files, start.line, start.col, &message)
}

/// An error at a line and a column, each counted from 1.
fn malformed(files: &Attached, line: usize, column: usize, message: &str) -> SceneError {
    SceneError::Malformed {
        origin: files.origin().to_owned(),
        line,
        column,
        message: in_a_line(message).into_owned(),
    }
}

#[derive(Deserialize)]
#[serde(rename = "Scene", deny_unknown_fields)]
struct SceneFile {
    #[serde(default)]
    name: Name,
    surfaces: Vec<SurfaceFile>,
    source: SourceFile,
    listener: ListenerFile<FixedRadius>,
}

#[derive(Deserialize)]
#[serde(rename = "Source", deny_unknown_fields)]
struct SourceFile {
    #[serde(default)]
    position: Option<Point>,
    #[serde(default)]
    path: Option<PathFile>,
}

/// A listener, whose radius is `R`: it may be left out where a base has one.
#[derive(Deserialize)]
#[serde(
    rename = "Listener",
    deny_unknown_fields,
    bound = "R: Deserialize<'de>"
)]
struct ListenerFile<R> {
    #[serde(default)]
    position: Option<Point>,
    #[serde(default)]
    yaw: Option<Degrees>,
    #[serde(default)]
    pitch: Option<Degrees>,
    radius: R,
    #[serde(default)]
    path: Option<PathFile>,
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

impl PathFile {
    fn path(&self) -> Path {
        self.0.clone()
    }
}

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
        let surfaces: Result<_, _> = surfaces.map(|s| s.read(files)).collect();
        let mut source = Source::at(Vec3::ZERO);
        self.source.change(&mut source);
        let mut listener = Listener::at(Vec3::ZERO, self.listener.radius.0);
        self.listener.change(&mut listener);
        Ok(Scene::new(self.name.0, surfaces?, source, listener))
    }
}

impl SourceFile {
    /// Puts a source where the file says: without a position it is where its path begins.
    /// A source that is put somewhere has no path but the one said with it.
    fn change(&self, source: &mut Source) {
        if self.position.is_none() && self.path.is_none() {
            return;
        }
        source.path = self.path.as_ref().map(PathFile::path).unwrap_or_default();
        let start = source.path.at(0.0).map(|key| key.position);
        let position = self.position.map(|point| point.0).or(start);
        source.position = position.unwrap_or(source.position);
    }
}

impl<R: Copy + Into<Option<FixedRadius>>> ListenerFile<R> {
    /// Puts a listener where the file says: without a position it stands and looks as its path
    /// begins. A listener that is put somewhere has no path but the one said with it.
    fn change(&self, listener: &mut Listener) {
        if let Some(radius) = self.radius.into() {
            listener.radius = radius.0;
        }
        let [yaw, pitch] = [self.yaw, self.pitch];
        if self.position.is_none() && self.path.is_none() && yaw.is_none() && pitch.is_none() {
            return;
        }
        listener.path = self.path.as_ref().map(PathFile::path).unwrap_or_default();
        match (self.position, listener.path.at(0.0)) {
            (None, Some(key)) => {
                listener.position = key.position;
                (listener.yaw, listener.pitch) = (key.yaw, key.pitch);
            }
            (position, _) => {
                listener.position = position.map_or(listener.position, |point| point.0);
                listener.yaw = yaw.map_or(listener.yaw, |angle| angle.0);
                listener.pitch = pitch.map_or(listener.pitch, |angle| angle.0);
            }
        }
    }
}
