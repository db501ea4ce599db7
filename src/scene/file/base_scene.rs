//! Scenes based on other scenes: reads and writes files that name a base and list the differences from it.
//!
//! ```ron
//! Scene(
//!     base: "hall.ron",
//!     listener: Listener(position: (0, 1.5, 4), yaw: 30),
//!     values: [Value("door", 60)],
//! )
//! ```
//!
//! A scene always has exactly the surfaces of its base, so that a chain of files needs memory for only one list of
//! surfaces.

use super::per_band::{OfBands, SceneScattering};
use super::serialise::{degrees, listeners, sources};
use super::sources_and_listeners::{ListenerFile, Placed, Several, SourceFile, one_form};
use super::surfaces::{AirFile, Materials};
use super::text::{Place, RawFields, Refused, place_of};
use super::{folder_of, malformed, options, parse, text_of};
use crate::bands::Bands;
use crate::scene::check::twice;
use crate::scene::notation::{Attached, FixedRadius, Name, Written};
use crate::scene::{Directivity, FIELDS, Named, Scene, SceneError, ValueRange, named};
use glam::Vec3;
use ron::ser::PrettyConfig;
use ron::value::RawValue;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

/// Maximum number of bases in a chain. Chains are written by hand, and each file may have the maximum size.
const MOST_BASES: usize = 8;

/// The canonical paths of a chain of files, from the requested scene to the file that is being read.
#[derive(Clone, Debug, Default)]
pub(super) struct Chain {
    files: Vec<PathBuf>,
    bases: usize,
    /// The scattering that the first file of the chain with this field states.
    scattering: Option<Bands>,
}

impl Chain {
    /// A chain that consists of one file.
    pub fn at(path: &Path) -> Chain {
        Chain {
            files: std::fs::canonicalize(path).into_iter().collect(),
            ..Chain::default()
        }
    }

    /// Returns the chain extended by this base, or the reason why the extension is not possible.
    pub fn down_to(&self, base: &Path) -> Result<Chain, String> {
        let real = std::fs::canonicalize(base).ok();
        if real.as_ref().is_some_and(|real| self.files.contains(real)) {
            let base = base.display();
            return Err(format!("the base {base} is itself based on this scene"));
        }
        if self.bases == MOST_BASES {
            return Err(format!("a chain of bases has at most {MOST_BASES} scenes"));
        }
        let files = self.files.iter().cloned().chain(real);
        Ok(Chain {
            files: files.collect(),
            bases: self.bases + 1,
            scattering: self.scattering,
        })
    }

    pub fn scattering(&self) -> Option<Bands> {
        self.scattering
    }

    /// Returns the chain below a file with this scattering.
    fn below(&self, own: Option<&OfBands<SceneScattering>>) -> Chain {
        Chain {
            scattering: self.scattering.or(own.map(|own| own.bands)),
            ..self.clone()
        }
    }
}

/// The content of a scene file that has a base.
#[derive(Deserialize)]
#[serde(rename = "Scene", deny_unknown_fields)]
pub(super) struct BasedFile<'a> {
    #[serde(borrow)]
    base: &'a RawValue,
    #[serde(default)]
    name: Name,
    #[serde(default)]
    materials: Materials,
    #[serde(default)]
    ranges: BTreeMap<String, ValueRange>,
    scattering: Option<OfBands<SceneScattering>>,
    air: Option<AirFile>,
    source: Option<SourceFile>,
    sources: Option<Several<SourceFile>>,
    listener: Option<ListenerFile<Option<FixedRadius>>>,
    listeners: Option<Several<ListenerFile<FixedRadius>>>,
    /// Each entry is a [`ValueFile`].
    #[serde(borrow, default)]
    values: Vec<&'a RawValue>,
}

/// The name of a value of the base, and its new number in the unit of a scene file.
#[derive(Deserialize)]
#[serde(rename = "Value")]
struct ValueFile(Name, f32);

impl ValueFile {
    fn pair(self) -> (String, f32) {
        (self.0.0, self.1)
    }
}

/// The only field of a scene file that is read to find its base.
#[derive(Deserialize)]
#[serde(rename = "Scene")]
struct Head<'a> {
    #[serde(borrow)]
    base: Option<&'a RawValue>,
}

/// The text of the `base` field, if the file has one.
fn base_of(text: &str) -> Option<&RawValue> {
    let head: Head = options().from_str(text).ok()?;
    head.base
}

/// Whether a text names a base, given the error from reading the text as a scene without a base.
pub(super) fn has_base(text: &str, error: &ron::Error) -> bool {
    let is_met = matches!(error, ron::Error::NoSuchStructField { found, outer, .. }
        if found == "base" && outer.as_deref() == Some("Scene"));
    is_met || base_of(text).is_some()
}

impl BasedFile<'_> {
    /// Builds the base and applies the changes of this file.
    pub fn scene(self, text: &str, files: &Attached, chain: &Chain) -> Result<Scene, SceneError> {
        let chain = &chain.below(self.scattering.as_ref());
        let mut scene = self.base(text, files, chain)?;
        let changed = self.change(&mut scene, files);
        changed.map_err(|refused| refused.in_text(text, files))?;
        self.set_values(&mut scene, text, files)?;
        let Some(first) = self.values.first() else {
            return Ok(scene);
        };
        let Err(refused) = scene.check() else {
            return Ok(scene);
        };
        // If the base itself is valid, the error is in the values of this file.
        self.base(text, files, chain)?.check()?;
        Err(at_value(text, files, first, refused.to_string()))
    }

    /// Applies all changes except the named values.
    fn change(&self, scene: &mut Scene, files: &Attached) -> Result<(), Refused> {
        if !self.name.0.is_empty() {
            scene.name.clone_from(&self.name.0);
        }
        let materials = self.materials.scattering_by(scene.scattering);
        scene.materials.extend(materials);
        scene.set_material_drivers(&self.materials.names(), self.materials.drivers());
        let ranges = self.ranges.iter();
        scene
            .value_ranges
            .extend(ranges.map(|(name, range)| (name.clone(), *range)));
        if let Some(air) = &self.air {
            scene.air = Some(air.change(scene.air));
        }
        one_form::<SourceFile>(self.source.is_some(), self.sources.is_some())?;
        if let (Some(source), Some(first)) = (&self.source, scene.sources.first_mut()) {
            source.change(first, files)?;
            let names = scene.sources.iter().map(|source| &source.name);
            once_each::<SourceFile>(names)?;
        }
        if let Some(sources) = &self.sources {
            let sources = sources.iter().map(|source| source.read(files));
            scene.sources = sources.collect::<Result<_, SceneError>>()?;
        }
        one_form::<ListenerFile<FixedRadius>>(self.listener.is_some(), self.listeners.is_some())?;
        if let (Some(listener), Some(first)) = (&self.listener, scene.listeners.first_mut()) {
            listener.change(first);
            let names = scene.listeners.iter().map(|listener| &listener.name);
            once_each::<ListenerFile<FixedRadius>>(names)?;
        }
        if let Some(listeners) = &self.listeners {
            scene.listeners = listeners.iter().map(ListenerFile::read).collect();
        }
        Ok(())
    }

    /// The scene of the base, without the checks of the whole scene.
    fn base(&self, text: &str, files: &Attached, chain: &Chain) -> Result<Scene, SceneError> {
        let refused = |why: String| at_value(text, files, self.base, why);
        let name: String = options()
            .from_str(self.base.get_ron())
            .map_err(|error| refused(error.code.to_string()))?;
        let path = match named(&name, files.folder()) {
            Named::BuiltIn(scene) => return built_in(&name, scene?, chain),
            Named::Unknown(error) => return Err(refused(error.to_string())),
            Named::File(path) => path,
        };
        let chain = chain.down_to(&path).map_err(&refused)?;
        let text = text_of(&path).map_err(|error| match error {
            SceneError::Unreadable { path, source } => {
                refused(format!("cannot read the base {}: {source}", path.display()))
            }
            other => other,
        })?;
        super::scene_of_file(&path, &text, &chain)
    }

    fn set_values(
        &self,
        scene: &mut Scene,
        text: &str,
        files: &Attached,
    ) -> Result<(), SceneError> {
        let mut set = BTreeMap::new();
        let mut places = BTreeMap::new();
        for said in &self.values {
            let refused = |why: String| at_value(text, files, said, why);
            let ValueFile(Name(name), value) = options()
                .from_str(said.get_ron())
                .map_err(|error| refused(error.code.to_string()))?;
            if !value.is_finite() {
                return Err(refused(format!("a value must be finite, not {value}")));
            }
            if places.insert(name.clone(), *said).is_some() {
                return Err(refused(format!("the value {name:?} is set twice")));
            }
            set.insert(name, value);
        }
        scene.set_values(&set).map_err(|error| {
            let place = match &error {
                SceneError::UnknownValue { name, .. } => places.get(name),
                _ => None,
            };
            match place {
                Some(said) => at_value(text, files, said, error.to_string()),
                None => error,
            }
        })
    }
}

/// A built-in scene with the scattering that a chain states.
fn built_in(name: &str, scene: Scene, chain: &Chain) -> Result<Scene, SceneError> {
    match (chain.scattering, Scene::builtin_text(name)) {
        (Some(_), Some(text)) => parse(text, &Attached::embedded(name, FIELDS), chain),
        _ => Ok(scene),
    }
}

/// An error at the position of a value in the text.
fn at_value(text: &str, files: &Attached, value: &RawValue, why: String) -> SceneError {
    let (line, column) = place_of(text, value);
    malformed(files, line, column, &why)
}

/// Rejects a name of the first source or listener that another source or listener already has.
fn once_each<'a, T: Placed>(
    names: impl Iterator<Item = &'a Option<String>>,
) -> Result<(), Refused> {
    let Some(name) = twice(names.map(Option::as_ref)) else {
        return Ok(());
    };
    let why = format!("two of the {} are called {name:?}", T::SEVERAL);
    Err(Refused::At(Place::Field(T::ONE), why))
}

/// Returns the chain of files that a scene file is based on, up to the first file that cannot be read.
pub fn bases_of(path: &Path) -> Vec<PathBuf> {
    let mut bases = Vec::new();
    let mut path = path.to_owned();
    while bases.len() <= MOST_BASES {
        let Some(base) = text_of(&path).ok().and_then(|text| {
            let name: String = options().from_str(base_of(&text)?.get_ron()).ok()?;
            base_beside(&path, &name)
        }) else {
            break;
        };
        bases.push(base.clone());
        path = base;
    }
    bases
}

/// The file that a scene file names as its base; `None` if the base is a built-in scene.
fn base_beside(path: &Path, name: &str) -> Option<PathBuf> {
    match named(name, Some(folder_of(path))) {
        Named::File(path) => Some(path),
        Named::BuiltIn(_) | Named::Unknown(_) => None,
    }
}

/// A scene file with a base, to be written. Values that are not set here come from the base.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BasedScene {
    base: String,
    /// The folder of the file.
    folder: PathBuf,
    /// The text of each field except `values`.
    fields: BTreeMap<&'static str, String>,
    values: BTreeMap<String, f32>,
}

/// The fields of a scene file with a base, in the order of writing.
const WRITTEN_FIELDS: [&str; 8] = [
    "name",
    "materials",
    "scattering",
    "air",
    "source",
    "sources",
    "listener",
    "listeners",
];

/// The fields of a source that do not change when the source moves, and its path.
#[derive(Default, Deserialize)]
#[serde(rename = "Source")]
struct KeptSource<'a> {
    #[serde(borrow)]
    name: Option<&'a RawValue>,
    #[serde(borrow)]
    level_db: Option<&'a RawValue>,
    #[serde(borrow)]
    yaw: Option<&'a RawValue>,
    #[serde(borrow)]
    pitch: Option<&'a RawValue>,
    #[serde(borrow)]
    directivity: Option<&'a RawValue>,
    #[serde(borrow)]
    path: Option<&'a RawValue>,
}

/// The fields of a listener that do not change when the listener moves.
#[derive(Default, Deserialize)]
#[serde(rename = "Listener")]
struct KeptListener<'a> {
    #[serde(borrow)]
    name: Option<&'a RawValue>,
}

impl BasedScene {
    /// Creates a file in `folder` based on `origin`, the name of a built-in scene or a file. If that file has a base
    /// itself, the new file has the same base and repeats all changes of `origin`. Files created from each other thus
    /// do not form a chain.
    ///
    /// # Errors
    /// [`SceneError::Unreadable`]; [`SceneError::NoBase`] for a path that cannot be written in a scene file.
    pub fn of(origin: &str, folder: &Path) -> Result<BasedScene, SceneError> {
        let on = |base: String| BasedScene {
            base,
            folder: folder.to_owned(),
            ..BasedScene::default()
        };
        if Scene::BUILTIN_NAMES.contains(&origin) {
            return Ok(on(origin.to_owned()));
        }
        let path = Path::new(origin);
        let text = text_of(path)?;
        let Some(said) = BasedScene::read(&text) else {
            return Ok(on(path_from(folder, path)?));
        };
        let base = match base_beside(path, &said.base) {
            Some(file) => path_from(folder, &file)?,
            None => said.base,
        };
        Ok(BasedScene {
            base,
            folder: folder.to_owned(),
            ..said
        })
    }

    /// The content of a file; `None` if the file has no base.
    fn read(text: &str) -> Option<BasedScene> {
        let said = RawFields::of(text)?;
        let fields = WRITTEN_FIELDS.into_iter().filter_map(|field| {
            let value = said.get(field)?;
            Some((field, value.trim().to_string()))
        });
        let values: Vec<ValueFile> = match said.get("values") {
            Some(_) => said.read("values")?,
            None => Vec::new(),
        };
        Some(BasedScene {
            base: said.read("base")?,
            fields: fields.collect(),
            values: values.into_iter().map(ValueFile::pair).collect(),
            ..BasedScene::default()
        })
    }

    /// Writes the position of the first source in `scene` to this file, without a path. The other sources of `scene`
    /// must equal those of this file.
    ///
    /// # Errors
    /// [`SceneError::NoBase`] for a measured directivity whose path cannot be written in a scene file.
    pub fn put_source(&mut self, scene: &Scene) -> Result<(), SceneError> {
        if self.fields.contains_key("sources") {
            let list = in_ron(&sources(&self.naming_directivities(scene)?));
            self.fields.insert("sources", list);
            return Ok(());
        }
        let Some(first) = scene.sources.first() else {
            return Ok(());
        };
        let said: KeptSource = self.said("source");
        let mut kept = again([("name", said.name), ("level_db", said.level_db)]);
        match said.path {
            // The angles may be those of the path.
            Some(_) => {
                for (name, angle) in [("yaw", first.yaw), ("pitch", first.pitch)] {
                    let _ = write!(kept, "{name}: {}, ", in_ron(&degrees(angle)));
                }
            }
            None => kept += &again([("yaw", said.yaw), ("pitch", said.pitch)]),
        }
        match (&first.directivity, said.directivity) {
            (Directivity::Balloon(balloon), Some(_)) => {
                let file = quoted(&path_from(&self.folder, Path::new(balloon.name()))?);
                let _ = write!(kept, "directivity: Balloon(file: {file}), ");
            }
            (_, directivity) => kept += &again([("directivity", directivity)]),
        }
        let position = point(first.position);
        let text = format!("Source({kept}position: {position})");
        self.fields.insert("source", text);
        Ok(())
    }

    /// The scene, in which the files of directivities are named relative to the folder of this file.
    fn naming_directivities(&self, scene: &Scene) -> Result<Scene, SceneError> {
        let mut scene = scene.clone();
        for source in &mut scene.sources {
            if let Directivity::Balloon(balloon) = &mut source.directivity {
                let name = path_from(&self.folder, Path::new(balloon.name()))?;
                *balloon = Arc::new(balloon.with_name(name));
            }
        }
        Ok(scene)
    }

    /// Writes the position and direction of the first listener in `scene` to this file, without a path. The other
    /// listeners of `scene` must equal those of this file.
    pub fn put_listener(&mut self, scene: &Scene) {
        if let Some(list) = self.fields.get_mut("listeners") {
            *list = in_ron(&listeners(scene));
            return;
        }
        let Some(listener) = scene.listeners.first() else {
            return;
        };
        let kept: KeptListener = self.said("listener");
        let kept = again([("name", kept.name)]);
        let text = format!(
            "Listener({kept}position: {}, yaw: {}, pitch: {}, radius: {})",
            point(listener.position),
            listener.yaw.to_degrees(),
            listener.pitch.to_degrees(),
            listener.radius
        );
        self.fields.insert("listener", text);
    }

    /// The value of a field of the file; the default value if the file does not set the field.
    fn said<'a, T: Deserialize<'a> + Default>(&'a self, field: &str) -> T {
        let said = self.fields.get(field).map_or("()", String::as_str);
        // The text has already been parsed, so it is valid.
        options().from_str(said).unwrap_or_default()
    }

    /// Sets a named value, in the unit of a scene file.
    pub fn set_value(&mut self, name: &str, value: f32) {
        self.values.insert(name.to_owned(), value);
    }

    /// The text of the file, which begins with `comment` as comment lines.
    pub fn text(&self, comment: &str) -> String {
        let mut text = String::new();
        // Writing to a string never fails.
        for line in comment.lines() {
            let _ = writeln!(text, "// {line}");
        }
        let _ = writeln!(text, "Scene(\n    base: {},", quoted(&self.base));
        for field in WRITTEN_FIELDS {
            if let Some(value) = self.fields.get(field) {
                let _ = writeln!(text, "    {field}: {value},");
            }
        }
        if !self.values.is_empty() {
            text.push_str("    values: [\n");
            for (name, value) in &self.values {
                let _ = writeln!(text, "        Value({}, {value}),", quoted(name));
            }
            text.push_str("    ],\n");
        }
        text.push_str(")\n");
        text
    }
}

fn point(p: Vec3) -> String {
    format!("({}, {}, {})", p.x, p.y, p.z)
}

/// Formats fields with their original text, each followed by a comma.
fn again<const N: usize>(fields: [(&str, Option<&RawValue>); N]) -> String {
    let said = fields.into_iter().filter_map(|(field, value)| {
        let value = value?.trim();
        Some(format!("{field}: {value}, "))
    });
    said.collect()
}

/// Formats a list in the notation of a scene file, on one line.
fn in_ron(list: &Written) -> String {
    let notation = PrettyConfig::new()
        .struct_names(true)
        .compact_structs(true)
        .compact_arrays(true)
        .separate_tuple_members(false);
    // Writing to a string never fails.
    options()
        .to_string_pretty(list, notation)
        .unwrap_or_default()
}

/// Formats a string in RON, with the escapes of Rust.
fn quoted(text: &str) -> String {
    format!("{text:?}")
}

/// The relative path from a folder to a file, in the notation of a scene file in that folder.
///
/// # Errors
/// [`SceneError::NoBase`] for a path that cannot be written in a scene file.
pub fn path_from(folder: &Path, file: &Path) -> Result<String, SceneError> {
    let refused = || SceneError::NoBase {
        folder: folder.to_owned(),
        base: file.to_owned(),
    };
    let name = file.file_name().ok_or_else(refused)?;
    // The file may be a symbolic link. Paths in it are relative to the folder of the link, so only the folders are
    // canonicalised.
    let (from, to) = (real(folder), real(folder_of(file)));
    let (Some(from), Some(to)) = (from, to) else {
        return Err(refused());
    };
    let mut way = PathBuf::new();
    if from.components().next() == to.components().next() {
        let pairs = from.components().zip(to.components());
        let shared = pairs.take_while(|(a, b)| a == b).count();
        way.extend(from.components().skip(shared).map(|_| Component::ParentDir));
        way.extend(to.components().skip(shared));
    } else {
        // The file is on another drive.
        way.clone_from(&to);
    }
    way.push(name);
    let way = way.to_str().ok_or_else(refused)?;
    match Scene::BUILTIN_NAMES.contains(&way) {
        true => Ok(format!("./{way}")),
        false => Ok(way.to_owned()),
    }
}

/// The canonical path of a folder; an empty path is the current folder.
fn real(folder: &Path) -> Option<PathBuf> {
    let folder = match folder.as_os_str().is_empty() {
        true => Path::new("."),
        false => folder,
    };
    std::fs::canonicalize(folder).ok()
}
