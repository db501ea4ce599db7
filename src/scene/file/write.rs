//! Writes scene files that have a base.

use super::base_scene::{ValueFile, base_beside};
use super::serialise::{listeners, sources};
use super::text::RawFields;
use super::{folder_of, options, text_of};
use crate::scene::notation::Written;
use crate::scene::{BUILTIN_NAMES, Scene, SceneError};
use glam::Vec3;
use ron::ser::PrettyConfig;
use ron::value::RawValue;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Component, Path, PathBuf};

/// A scene file with a base, to be written; values that are not set are the base's.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BasedScene {
    base: String,
    /// The text of each field except the values.
    fields: BTreeMap<&'static str, String>,
    values: BTreeMap<String, f32>,
}

/// The fields of a scene file with a base, in the order in which they are written.
const FIELDS: [&str; 7] = [
    "name",
    "materials",
    "air",
    "source",
    "sources",
    "listener",
    "listeners",
];

/// The fields of a source that remain when it is moved.
#[derive(Default, Deserialize)]
#[serde(rename = "Source")]
struct KeptSource<'a> {
    #[serde(borrow)]
    name: Option<&'a RawValue>,
    #[serde(borrow)]
    level_db: Option<&'a RawValue>,
}

/// The fields of a listener that remain when it is moved.
#[derive(Default, Deserialize)]
#[serde(rename = "Listener")]
struct KeptListener<'a> {
    #[serde(borrow)]
    name: Option<&'a RawValue>,
}

impl BasedScene {
    /// Starts a file in `folder` with the scene of `origin`, a built-in scene's name or a file. If
    /// that file has a base itself, its base is used together with all its changes, so that files
    /// made from each other do not form a chain.
    ///
    /// # Errors
    /// [`SceneError::Unreadable`]; [`SceneError::NoBase`] for a path that no scene file can name.
    pub fn of(origin: &str, folder: &Path) -> Result<BasedScene, SceneError> {
        let on = |base: String| BasedScene {
            base,
            ..BasedScene::default()
        };
        if BUILTIN_NAMES.contains(&origin) {
            return Ok(on(origin.to_owned()));
        }
        let path = Path::new(origin);
        let text = text_of(path)?;
        let Some(said) = BasedScene::read(&text) else {
            return Ok(on(relative(folder, path)?));
        };
        let base = match base_beside(path, &said.base) {
            Some(file) => relative(folder, &file)?,
            None => said.base,
        };
        Ok(BasedScene { base, ..said })
    }

    /// The content of a file; `None` if it has no base.
    fn read(text: &str) -> Option<BasedScene> {
        let said = RawFields::of(text)?;
        let fields = FIELDS.into_iter().filter_map(|field| {
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
        })
    }

    /// Moves the first source to its place in `scene`, without a path. The other sources of `scene`
    /// must be those of this file.
    pub fn put_source(&mut self, scene: &Scene) {
        if let Some(list) = self.fields.get_mut("sources") {
            *list = in_ron(&sources(scene));
            return;
        }
        let kept: KeptSource = self.said("source");
        let kept = again([("name", kept.name), ("level_db", kept.level_db)]);
        let position = point(scene.source.position);
        let text = format!("Source({kept}position: {position})");
        self.fields.insert("source", text);
    }

    /// Gives the first listener the position and direction that it has in `scene`, without a path.
    /// The other listeners of `scene` must be those of this file.
    pub fn put_listener(&mut self, scene: &Scene) {
        if let Some(list) = self.fields.get_mut("listeners") {
            *list = in_ron(&listeners(scene));
            return;
        }
        let kept: KeptListener = self.said("listener");
        let kept = again([("name", kept.name)]);
        let listener = &scene.listener;
        let text = format!(
            "Listener({kept}position: {}, yaw: {}, pitch: {}, radius: {})",
            point(listener.position),
            listener.yaw.to_degrees(),
            listener.pitch.to_degrees(),
            listener.radius
        );
        self.fields.insert("listener", text);
    }

    /// The file's value of a field; the default if the file leaves it to the base.
    fn said<'a, T: Deserialize<'a> + Default>(&'a self, field: &str) -> T {
        let said = self.fields.get(field).map_or("()", String::as_str);
        // Fields that were parsed before have this form.
        options().from_str(said).unwrap_or_default()
    }

    /// Sets a named value in the unit of the base's file.
    pub fn set_value(&mut self, name: &str, value: f32) {
        self.values.insert(name.to_owned(), value);
    }

    /// The file's text after these comment lines.
    pub fn text(&self, comment: &str) -> String {
        let mut text = String::new();
        // Writing to a string never fails.
        for line in comment.lines() {
            let _ = writeln!(text, "// {line}");
        }
        let _ = writeln!(text, "Scene(\n    base: {},", quoted(&self.base));
        for field in FIELDS {
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

/// Fields with their original text, each followed by a comma.
fn again<const N: usize>(fields: [(&str, Option<&RawValue>); N]) -> String {
    let said = fields.into_iter().filter_map(|(field, value)| {
        let value = value?.trim();
        Some(format!("{field}: {value}, "))
    });
    said.collect()
}

/// A list as a scene file writes it, in one line.
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

/// A string in RON, with escapes as in Rust.
fn quoted(text: &str) -> String {
    format!("{text:?}")
}

/// The relative path from a folder to a file, as a scene file there names it.
fn relative(folder: &Path, file: &Path) -> Result<String, SceneError> {
    let refused = || SceneError::NoBase {
        folder: folder.to_owned(),
        base: file.to_owned(),
    };
    let name = file.file_name().ok_or_else(refused)?;
    // The file itself may be a link: names in it are relative to the folder of the link.
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
    match BUILTIN_NAMES.contains(&way) {
        true => Ok(format!("./{way}")),
        false => Ok(way.to_owned()),
    }
}

/// A folder's real path; the current one where the path is empty.
fn real(folder: &Path) -> Option<PathBuf> {
    let folder = match folder.as_os_str().is_empty() {
        true => Path::new("."),
        false => folder,
    };
    std::fs::canonicalize(folder).ok()
}
