//! Scene files in RON: reading, and reloading after changes.
//!
//! The types in this module hold the content of the text (degrees, full sizes). They are immediately converted to the
//! plain [`Scene`]. Every number is checked while it is read, so that an error states its line and column. See
//! `docs/scene-format.md`.

mod base_scene;
mod per_band;
mod serialise;
mod sources_and_listeners;
mod surfaces;
#[cfg(test)]
mod tests;
mod text;

use super::check::{NOT_A_ROOM, no_such_group};
use super::{Scene, SceneError, ValueRange};
use crate::bands::Bands;
use crate::file_input::{MalformedText, read_text};
use crate::ron_error;
use crate::scene::notation::{Attached, FixedRadius, Form, Name};
use crate::scene::shape::{form_of, shape_names};
use crate::text::{in_a_line, nearest_or_all};
use base_scene::{BasedFile, Chain};
use per_band::{OfBands, SceneScattering};
use ron::error::{Error, SpannedError};
use serde::Deserialize;
use sources_and_listeners::{ListenerFile, Several, SourceFile};
use std::collections::BTreeMap;
use std::iter::once;
use std::path::{Path, PathBuf};
use std::time::SystemTime;
use surfaces::{AirFile, MaterialFile, Materials, SurfaceFile};
use text::{Modern, Place, Refused};

#[doc(hidden)]
pub use base_scene::{BasedScene, bases_of, path_from};

/// Maximum size of a scene file in bytes. 100,000 key frames take 2 MB. A text of this size needs at most a gigabyte of
/// memory when parsed (the shortest shape has six bytes).
const LARGEST_FILE: u64 = 4 << 20;

/// Maximum nesting depth of the text, which protects the stack. Each nested shape takes four or five levels.
const DEEPEST: usize = 512;

impl Scene {
    /// Reads a scene file, its base, and the other files that each of them names. File names are relative to the folder
    /// of the file that contains them.
    ///
    /// # Errors
    /// [`SceneError::Unreadable`], [`SceneError::Malformed`] with line and column, [`SceneError::Attached`] for the
    /// files that the scene names, and the errors of [`Scene::check`].
    pub fn from_file(path: &Path) -> Result<Scene, SceneError> {
        let scene = scene_of_file(path, &text_of(path)?, &Chain::at(path))?;
        scene.check()?;
        Ok(scene)
    }

    /// Reads a scene from RON text; `origin` is its name in errors. File names in the text are relative to the current
    /// folder.
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
    /// The errors of [`Scene::from_file`].
    pub fn from_ron(text: &str, origin: &str) -> Result<Scene, SceneError> {
        Scene::from_ron_in(text, origin, Path::new(""))
    }

    /// Like [`Scene::from_ron`], with file names relative to `folder`.
    ///
    /// # Errors
    /// The errors of [`Scene::from_file`].
    pub fn from_ron_in(text: &str, origin: &str, folder: &Path) -> Result<Scene, SceneError> {
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

/// Reads the text of a scene file, without a byte-order mark.
fn text_of(path: &Path) -> Result<String, SceneError> {
    read_text(path, LARGEST_FILE).map_err(|source| SceneError::Unreadable {
        path: path.to_owned(),
        source,
    })
}

/// The folder of a file; an empty path (the current folder) for a bare file name.
fn folder_of(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new(""))
}

/// Reads the scene of a file with this text, without the checks of the whole scene.
fn scene_of_file(path: &Path, text: &str, chain: &Chain) -> Result<Scene, SceneError> {
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

/// Reads the scene of a text, without the checks of the whole scene.
fn parse(text: &str, files: &Attached, chain: &Chain) -> Result<Scene, SceneError> {
    // Some editors write a byte-order mark before the text.
    let modern = Modern::of(text.trim_start_matches('\u{feff}'));
    parse_modern(&modern.text, files, chain)
        .map_err(|error| modern.in_text_as_it_was(error, files.origin()))
}

/// Reads the scene of a text in the current notation of operators.
fn parse_modern(text: &str, files: &Attached, chain: &Chain) -> Result<Scene, SceneError> {
    let error = match options().from_str::<SceneFile>(text) {
        Ok(file) => {
            let scene = file.scene(files, chain.scattering());
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

fn from_ron(files: &Attached, text: &str, error: &SpannedError) -> SceneError {
    if let Some((place, told)) = ron_error::unclosed_quote(text, error) {
        return malformed(files, place.line, place.col, &told);
    }
    let start = error.span.start;
    let message = match (&error.code, about_part(text, error)) {
        (_, Some(hint)) => hint,
        (Error::ExceededRecursionLimit, _) => "shapes are nested too deeply here".to_owned(),
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
    ranges: BTreeMap<String, ValueRange>,
    scattering: Option<OfBands<SceneScattering>>,
    air: Option<AirFile>,
    source: Option<SourceFile>,
    sources: Option<Several<SourceFile>>,
    listener: Option<ListenerFile<FixedRadius>>,
    listeners: Option<Several<ListenerFile<FixedRadius>>>,
}

impl SceneFile {
    /// Converts the content to a scene, and reads the files that it names.
    /// `scattering` is the scattering that a scene based on this one states.
    fn scene(self, files: &Attached, scattering: Option<Bands>) -> Result<Scene, Refused> {
        let sources = Several::needed(self.source, self.sources)?;
        let listeners = Several::needed(self.listener, self.listeners)?;
        let surfaces = self.surfaces.into_iter().enumerate();
        let surfaces: Result<_, Refused> = surfaces
            .map(|(index, surface)| {
                let read = surface.read(files);
                read.map_err(|error| Refused::File(Place::Shape(index), error))
            })
            .collect();
        let sources: Result<_, SceneError> = sources.iter().map(|s| s.read(files)).collect();
        let own = self.scattering.map(|own| own.bands);
        let scattering = scattering.or(own).unwrap_or_default();
        let scene = Scene {
            name: self.name.0,
            surfaces: surfaces?,
            materials: self.materials.scattering_by(scattering).collect(),
            material_drivers: self.materials.drivers(),
            value_ranges: self.ranges,
            scattering,
            air: self.air.map(|air| air.change(None)),
            sources: sources?,
            listeners: listeners.iter().map(ListenerFile::read).collect(),
        };
        check_materials(&scene)?;
        Ok(scene)
    }
}

/// Checks that all materials of surfaces, walls and faces exist, that only rooms have walls, and that the faces exist.
fn check_materials(scene: &Scene) -> Result<(), Refused> {
    for (surface, of) in scene.surfaces.iter().enumerate() {
        let walls = of.walls.iter().enumerate();
        let walls = walls.map(|(wall, name)| (Some(wall), name));
        for (wall, name) in once((None, &of.material)).chain(walls) {
            let Some(name) = name else {
                continue;
            };
            let place = Place::Material { surface, wall };
            if wall.is_some() && !of.takes_walls() {
                return Err(Refused::At(place, NOT_A_ROOM.to_owned()));
            }
            let found = scene.find_material(name);
            found.map_err(|why| Refused::At(place, why))?;
        }
        let group = no_such_group(of);
        for (face, (name, material)) in of.faces.iter().enumerate() {
            let at = |why| Refused::At(Place::Face { surface, face }, why);
            if let Some((_, why)) = group.as_ref().filter(|(unknown, _)| unknown == name) {
                return Err(at(why.clone()));
            }
            scene.find_material(material).map_err(at)?;
        }
    }
    Ok(())
}

/// An error message with the correct notation, if the error concerns a shape, an operator, or another part with a name
/// and fields. RON's own message states only what the parser expected. The author of `Sphere(1)` or `Air(20)` needs the
/// correct notation.
fn about_part(text: &str, error: &SpannedError) -> Option<String> {
    match &error.code {
        Error::NoSuchEnumVariant { found, outer, .. } if outer.as_deref() == Some("Shape") => {
            Some(no_such_shape(found))
        }
        Error::ExpectedArray
        | Error::ExpectedComma
        | Error::ExpectedStructLike
        | Error::ExpectedNamedStructLike(_)
        | Error::InvalidIdentifier(_)
        | Error::SuggestRawIdentifier(_) => {
            let (before, behind) = text.split_at(ron_error::offset(text, error.span.start)?);
            if behind.trim_start().starts_with('#') {
                // A comment of another language.
                return None;
            }
            how_written(before, behind)
        }
        _ => None,
    }
}

fn no_such_shape(found: &str) -> String {
    let told = format!("there is no shape or operator `{found}`");
    nearest_or_all(&told, found, shape_names())
}

/// The correct notation of the part whose name precedes the error.
fn how_written(before: &str, behind: &str) -> Option<String> {
    let before = before.trim_end();
    let named = before.strip_suffix(['(', '[', '{']).unwrap_or(before);
    let named = named.trim_end();
    let begin = named.rfind(|c: char| !c.is_alphanumeric());
    let name = &named[begin.map_or(0, |at| at + 1)..];
    let form = form_of(name).or_else(|| form_of_sound(name))?;
    let has_bracket = behind.trim_start().starts_with(['(', '[', '{']);
    if form == Form::NameAlone && !has_bracket {
        // The error is that a part after the name is missing.
        return None;
    }
    Some(format!("{name} is written {}", form.written(name)))
}

/// The notation of sources, listeners, materials and air.
fn form_of_sound(name: &str) -> Option<Form> {
    match name {
        "Material" => Form::of::<MaterialFile>(),
        "Air" => Form::of::<AirFile>(),
        "Source" => Form::of::<SourceFile>(),
        "Listener" => Form::of::<ListenerFile<FixedRadius>>(),
        _ => None,
    }
}

/// Time of the last change of a file, and its length in bytes; `None` if the file does not exist.
type Stamp = Option<(SystemTime, u64)>;

/// Watches a scene file, its bases, and the files that they name for changes.
///
/// This type does not use OpenGL. [`tracer::Reloading`](crate::tracer::Reloading) also checks the scene with the
/// renderer. Polling takes a few microseconds per file.
pub struct SceneWatch {
    load: Box<dyn Fn() -> Result<Scene, SceneError>>,
    /// The scene file; `None` for a built-in scene.
    own: Option<PathBuf>,
    /// State of the files when they were last read.
    read: Vec<(PathBuf, Stamp)>,
    /// State of the files at the last poll, if it differs from `read`.
    found: Option<Vec<Stamp>>,
    /// Message of the last error; `None` after a scene was read.
    refused: Option<String>,
}

impl SceneWatch {
    /// Reads a scene like [`Scene::load`], and starts to watch its files.
    ///
    /// # Errors
    /// The errors of [`Scene::load`].
    pub fn open(name_or_file: &str) -> Result<(SceneWatch, Scene), SceneError> {
        let name = name_or_file.to_owned();
        SceneWatch::open_with(name_or_file, move || Scene::load(&name))
    }

    /// Watches a scene file that is read by `load`. This allows changes of the scene after reading.
    ///
    /// # Errors
    /// The errors of `load`.
    pub fn open_with(
        name_or_file: &str,
        load: impl Fn() -> Result<Scene, SceneError> + 'static,
    ) -> Result<(SceneWatch, Scene), SceneError> {
        let built_in = Scene::BUILTIN_NAMES.contains(&name_or_file);
        let own = (!built_in).then(|| PathBuf::from(name_or_file));
        let mut watch = SceneWatch {
            load: Box::new(load),
            read: own.iter().map(|path| (path.clone(), stamp(path))).collect(),
            own,
            found: None,
            refused: None,
        };
        let scene = (watch.load)()?;
        watch.keep(scene.files());
        Ok((watch, scene))
    }

    /// The watched files, the scene's own first; empty for a built-in scene.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        self.read.iter().map(|(path, _)| path.as_path())
    }

    /// Returns the scene or the error from reading it, once after each change; otherwise `None`.
    ///
    /// The scene is read when two consecutive polls find the same changed state, because an editor may still be
    /// writing. After an error, the folder of the scene file is watched too, so that the appearance of a missing file
    /// is noticed.
    pub fn poll(&mut self) -> Option<Result<Scene, SceneError>> {
        let now: Vec<Stamp> = self.read.iter().map(|(path, _)| stamp(path)).collect();
        if self.read.iter().map(|(_, stamp)| stamp).eq(&now) {
            self.found = None;
            return None;
        }
        if self.found.as_ref() != Some(&now) {
            self.found = Some(now);
            return None;
        }
        self.found = None;
        for ((_, read), now) in self.read.iter_mut().zip(now) {
            *read = now;
        }
        match (self.load)() {
            Ok(scene) => {
                self.refused = None;
                self.keep(scene.files());
                Some(Ok(scene))
            }
            Err(error) => {
                let sentence = error.to_string();
                let folders: Vec<PathBuf> = self.own.iter().map(|own| folder(own)).collect();
                let known = self.files().map(Path::to_owned).collect::<Vec<_>>();
                self.keep([known, folders].concat());
                // The change may concern another file in the folder. The error is then the same as before and is not
                // reported again.
                let is_news = self.refused.as_ref() != Some(&sentence);
                self.refused = Some(sentence);
                is_news.then_some(Err(error))
            }
        }
    }

    /// Watches the scene's own file, its bases and `files`. Files that are already watched keep their recorded state.
    fn keep(&mut self, files: Vec<PathBuf>) {
        let Some(own) = self.own.clone() else {
            return;
        };
        let before = std::mem::take(&mut self.read);
        let bases = bases_of(&own);
        for path in std::iter::once(own).chain(bases).chain(files) {
            if self.read.iter().any(|(known, _)| *known == path) {
                continue;
            }
            let known = before.iter().find(|(known, _)| *known == path);
            let read = known.map_or_else(|| stamp(&path), |(_, stamp)| *stamp);
            self.read.push((path, read));
        }
    }
}

fn stamp(path: &Path) -> Stamp {
    let about = std::fs::metadata(path).ok()?;
    Some((about.modified().ok()?, about.len()))
}

fn folder(file: &Path) -> PathBuf {
    match file.parent() {
        Some(folder) if folder != Path::new("") => folder.to_owned(),
        _ => PathBuf::from("."),
    }
}
