//! Scene files in RON.
//!
//! The types here are the content of the text (degrees, full sizes); they are converted to the
//! plain [`Scene`] at once. Every number is checked while it is read, so that an error points at
//! its line and column. See `docs/scene-format.md`.

mod air;
mod base_scene;
mod chain;
mod hints;
mod material;
mod older_forms;
mod raw_fields;
mod serialise;
mod sources_and_listeners;
mod surface;
mod text_places;
mod write;

use super::check::NOT_A_ROOM;
use super::{Scene, SceneError};
use crate::file_input::{MalformedText, read_text};
use crate::ron_error;
use crate::scene::notation::{Attached, FixedRadius, Name};
use crate::text::in_a_line;
use air::AirFile;
use base_scene::BasedFile;
use chain::Chain;
use material::Materials;
use older_forms::Modern;
use serde::Deserialize;
use sources_and_listeners::{ListenerFile, Several, SourceFile};
use std::iter::once;
use std::path;
use surface::SurfaceFile;
use text_places::{Place, Refused};

#[doc(hidden)]
pub use base_scene::bases_of;
#[doc(hidden)]
pub use write::BasedScene;

/// Maximum size of a scene file in bytes: 100,000 key frames are 2 MB, and the content of a text of
/// this size (a shape in six bytes) fits into a gigabyte of memory.
const LARGEST_FILE: u64 = 4 << 20;

/// Maximum nesting of the text, which protects the stack; a shape within a shape takes four or five
/// levels.
const DEEPEST: usize = 512;

impl Scene {
    /// Reads a scene file, its base, and the files that each names from its own folder.
    ///
    /// # Errors
    /// [`SceneError::Unreadable`], [`SceneError::Malformed`] with line and column,
    /// [`SceneError::Attached`] for the files that it names, or what
    /// [`Scene::check`] rejects.
    pub fn from_file(path: &path::Path) -> Result<Scene, SceneError> {
        let scene = scene_of_file(path, &text_of(path)?, &Chain::at(path))?;
        scene.check()?;
        Ok(scene)
    }

    /// Reads a scene from RON text; `origin` is its name in errors. Files that it names are
    /// relative to the current folder.
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
    /// As for [`Scene::from_file`].
    pub fn from_ron(text: &str, origin: &str) -> Result<Scene, SceneError> {
        Scene::from_ron_in(text, origin, path::Path::new(""))
    }

    /// Reads a scene as [`Scene::from_ron`] does; the files that it names are in `folder`.
    ///
    /// # Errors
    /// As for [`Scene::from_file`].
    pub fn from_ron_in(text: &str, origin: &str, folder: &path::Path) -> Result<Scene, SceneError> {
        let files = Attached::in_folder(origin, folder);
        let scene = parse(text, &files, &Chain::default())?;
        scene.check()?;
        Ok(scene)
    }

    /// Reads a scene whose files are embedded in the program.
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

/// The text of a scene file, unchanged except for a byte-order mark, which some editors put before
/// it.
fn text_of(path: &path::Path) -> Result<String, SceneError> {
    read_text(path, LARGEST_FILE).map_err(|source| SceneError::Unreadable {
        path: path.to_owned(),
        source,
    })
}

/// The folder of a file; the current one for a bare name.
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

/// The scene of the text, not yet checked as a whole.
fn parse(text: &str, files: &Attached, chain: &Chain) -> Result<Scene, SceneError> {
    // Some editors put a byte-order mark before the text.
    let modern = Modern::of(text.trim_start_matches('\u{feff}'));
    parse_modern(&modern.text, files, chain)
        .map_err(|error| modern.in_text_as_it_was(error, files.origin()))
}

/// The scene of a text whose operators are all in the current form.
fn parse_modern(text: &str, files: &Attached, chain: &Chain) -> Result<Scene, SceneError> {
    let error = match options().from_str::<SceneFile>(text) {
        Ok(file) => {
            let scene = file.scene(files);
            return scene.map_err(|refused| refused.in_text(text, files));
        }
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
    let message = match (&error.code, hints::about_part(text, error)) {
        (_, Some(hint)) => hint,
        (ron::Error::ExceededRecursionLimit, _) => "shapes are nested too deeply here".to_owned(),
        (_, None) => ron_error::sentence(text, error, ron_error::SCENE),
    };
    malformed(files, start.line, start.col, &message)
}

/// An error at a line and a column, each counted from 1.
fn malformed(files: &Attached, line: usize, column: usize, message: &str) -> SceneError {
    SceneError::Malformed(MalformedText {
        origin: files.origin().to_owned(),
        line,
        column,
        message: in_a_line(message).into_owned(),
    })
}

#[derive(Deserialize)]
#[serde(rename = "Scene", deny_unknown_fields)]
struct SceneFile {
    #[serde(default)]
    name: Name,
    surfaces: Vec<SurfaceFile>,
    #[serde(default)]
    materials: Materials,
    #[serde(default)]
    air: Option<AirFile>,
    #[serde(default)]
    source: Option<SourceFile>,
    #[serde(default)]
    sources: Option<Several<SourceFile>>,
    #[serde(default)]
    listener: Option<ListenerFile<FixedRadius>>,
    #[serde(default)]
    listeners: Option<Several<ListenerFile<FixedRadius>>>,
}

impl SceneFile {
    /// The scene, with the files that it names.
    fn scene(self, files: &Attached) -> Result<Scene, Refused> {
        let sources = Several::needed(self.source, self.sources)?;
        let listeners = Several::needed(self.listener, self.listeners)?;
        let surfaces = self.surfaces.into_iter();
        let surfaces: Result<_, SceneError> = surfaces.map(|s| s.read(files)).collect();
        let (source, further_sources) = sources.read(SourceFile::read);
        let (listener, further_listeners) = listeners.read(ListenerFile::read);
        let mut scene = Scene::new(self.name.0, surfaces?, source, listener);
        scene.further_sources = further_sources;
        scene.further_listeners = further_listeners;
        scene.materials = self.materials.0;
        scene.air = self.air.map(|air| air.change(None));
        check_materials(&scene)?;
        Ok(scene)
    }
}

/// Checks that every material named by a surface or a wall exists, and that only rooms have walls.
fn check_materials(scene: &Scene) -> Result<(), Refused> {
    for (surface, of) in scene.surfaces.iter().enumerate() {
        let walls = of.walls.iter().enumerate();
        let walls = walls.map(|(wall, name)| (Some(wall), name));
        for (wall, name) in once((None, &of.material)).chain(walls) {
            let Some(name) = name else {
                continue;
            };
            let place = Place::Material { surface, wall };
            if wall.is_some() && !of.has_walls() {
                return Err(Refused::At(place, NOT_A_ROOM.to_owned()));
            }
            let found = scene.find_material(name);
            found.map_err(|why| Refused::At(place, why))?;
        }
    }
    Ok(())
}
