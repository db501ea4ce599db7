//! Scene files with a base, written.

use super::base_scene::{ValueFile, base_beside};
use super::{folder_of, options, text_of};
use crate::scene::{BUILTIN_NAMES, SceneError};
use glam::Vec3;
use ron::value::RawValue;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Component, Path, PathBuf};

/// A scene file with a base, to be written: what is not set is as in the base.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct BasedScene {
    base: String,
    /// These three as they stand in the file.
    name: Option<String>,
    source: Option<String>,
    listener: Option<String>,
    values: BTreeMap<String, f32>,
}

/// What a scene file with a base says.
#[derive(Deserialize)]
#[serde(rename = "Scene")]
struct Parts<'a> {
    base: String,
    #[serde(borrow, default)]
    name: Option<&'a RawValue>,
    #[serde(borrow, default)]
    source: Option<&'a RawValue>,
    #[serde(borrow, default)]
    listener: Option<&'a RawValue>,
    #[serde(default)]
    values: Vec<ValueFile>,
}

impl BasedScene {
    /// A file in `folder` whose scene is that of `origin`, a built-in scene's name or a file.
    /// Where that file has a base itself, its base is taken, with all that it changes: files
    /// that are made of each other make no chain.
    ///
    /// # Errors
    /// [`SceneError::Unreadable`], [`SceneError::NoBase`] for a path that no scene file can name.
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
        let Ok(parts) = options().from_str::<Parts>(&text) else {
            return Ok(on(relative(folder, path)?));
        };
        let base = match base_beside(path, &parts.base) {
            Some(file) => relative(folder, &file)?,
            None => parts.base,
        };
        let as_said = |part: Option<&RawValue>| part.map(|part| part.trim().to_string());
        Ok(BasedScene {
            base,
            name: as_said(parts.name),
            source: as_said(parts.source),
            listener: as_said(parts.listener),
            values: parts.values.into_iter().map(ValueFile::pair).collect(),
        })
    }

    /// Puts the source at a place in metres, where it stands still.
    pub fn put_source(&mut self, position: Vec3) {
        self.source = Some(format!("Source(position: {})", point(position)));
    }

    /// Puts the listener where this one stands and looks, without a path.
    pub fn put_listener(&mut self, listener: &crate::scene::Listener) {
        self.listener = Some(format!(
            "Listener(position: {}, yaw: {}, pitch: {}, radius: {})",
            point(listener.position),
            listener.yaw.to_degrees(),
            listener.pitch.to_degrees(),
            listener.radius
        ));
    }

    /// Sets a named value in the unit of the base's file.
    pub fn set_value(&mut self, name: &str, value: f32) {
        self.values.insert(name.to_owned(), value);
    }

    /// The file's text, with these lines as a comment before it.
    pub fn text(&self, comment: &str) -> String {
        let mut text = String::new();
        // Writing to a string never fails.
        for line in comment.lines() {
            let _ = writeln!(text, "// {line}");
        }
        let _ = writeln!(text, "Scene(\n    base: {},", quoted(&self.base));
        let parts = [
            ("name", &self.name),
            ("source", &self.source),
            ("listener", &self.listener),
        ];
        for (field, value) in parts {
            if let Some(value) = value {
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

/// A string in RON, which has the escapes of Rust.
fn quoted(text: &str) -> String {
    format!("{text:?}")
}

/// The way from a folder to a file, as a scene file there names it.
fn relative(folder: &Path, file: &Path) -> Result<String, SceneError> {
    let refused = || SceneError::NoBase {
        folder: folder.to_owned(),
        base: file.to_owned(),
    };
    let name = file.file_name().ok_or_else(refused)?;
    // The file itself may be a link: what it names is looked for beside the link.
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
        // On another drive.
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
