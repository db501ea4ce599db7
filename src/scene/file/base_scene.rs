//! Scenes based on others: a file that names its base, and its differences from it.
//!
//! ```ron
//! Scene(
//!     base: "hall.ron",
//!     listener: Listener(position: (0, 1.5, 4), yaw: 30),
//!     values: [Value("door", 60)],
//! )
//! ```
//!
//! The surfaces are always those of the base, so that a chain of files holds one list of them in
//! memory.

use super::sources_and_listeners::{ListenerFile, Placed, Several, SourceFile, one_form};
use super::surfaces::{AirFile, Materials};
use super::text::{Place, Refused, place_of};
use super::{malformed, options, text_of};
use crate::scene::builtin::{self, Named};
use crate::scene::check::twice;
use crate::scene::notation::{Attached, FixedRadius, Name};
use crate::scene::{Scene, SceneError};
use ron::value::RawValue;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Maximum number of scenes in a chain of bases: a chain is written by hand, and each of its files
/// may have the full size.
const MOST_BASES: usize = 8;

/// The files from the requested scene down to the one being read, by their real paths.
#[derive(Clone, Debug, Default)]
pub(super) struct Chain {
    files: Vec<PathBuf>,
    bases: usize,
}

impl Chain {
    /// A chain that begins at a file.
    pub fn at(path: &Path) -> Chain {
        Chain {
            files: std::fs::canonicalize(path).into_iter().collect(),
            bases: 0,
        }
    }

    /// The chain extended by this base, or why it cannot be.
    pub fn down_to(&self, base: &Path) -> Result<Chain, String> {
        let real = std::fs::canonicalize(base).ok();
        if real.as_ref().is_some_and(|real| self.files.contains(real)) {
            let base = base.display();
            return Err(format!("the base {base} is itself based on this scene"));
        }
        if self.bases == MOST_BASES {
            return Err(format!(
                "more than {MOST_BASES} scenes are based on each other"
            ));
        }
        let files = self.files.iter().cloned().chain(real);
        Ok(Chain {
            files: files.collect(),
            bases: self.bases + 1,
        })
    }
}

/// The content of a scene file with a base.
#[derive(Deserialize)]
#[serde(rename = "Scene", deny_unknown_fields)]
pub(super) struct BasedFile<'a> {
    #[serde(borrow)]
    base: &'a RawValue,
    #[serde(default)]
    name: Name,
    #[serde(default)]
    materials: Materials,
    air: Option<AirFile>,
    source: Option<SourceFile>,
    sources: Option<Several<SourceFile>>,
    listener: Option<ListenerFile<Option<FixedRadius>>>,
    listeners: Option<Several<ListenerFile<FixedRadius>>>,
    /// Each one is a [`ValueFile`].
    #[serde(borrow, default)]
    values: Vec<&'a RawValue>,
}

/// A named value of the base, set to a number in the unit of the base's file.
#[derive(Deserialize)]
#[serde(rename = "Value")]
pub(super) struct ValueFile(Name, f32);

impl ValueFile {
    pub fn pair(self) -> (String, f32) {
        (self.0.0, self.1)
    }
}

/// The part of a scene file that shows whether it has a base.
#[derive(Deserialize)]
#[serde(rename = "Scene")]
struct Head<'a> {
    #[serde(borrow)]
    base: Option<&'a RawValue>,
}

/// The text that names a scene file's base, if it has one.
fn base_of(text: &str) -> Option<&RawValue> {
    let head: Head = options().from_str(text).ok()?;
    head.base
}

/// Whether a text that cannot be read as a scene without a base names a base.
pub(super) fn has_base(text: &str, error: &ron::Error) -> bool {
    let is_met = matches!(error, ron::Error::NoSuchStructField { found, outer, .. }
        if found == "base" && outer.as_deref() == Some("Scene"));
    is_met || base_of(text).is_some()
}

impl BasedFile<'_> {
    /// The scene of the base with the changes applied.
    pub fn scene(self, text: &str, files: &Attached, chain: &Chain) -> Result<Scene, SceneError> {
        let mut scene = self.base(text, files, chain)?;
        let changed = self.change(&mut scene);
        changed.map_err(|refused| refused.in_text(text, files))?;
        self.set_values(&mut scene, text, files)?;
        let Some(first) = self.values.first() else {
            return Ok(scene);
        };
        let Err(refused) = scene.check() else {
            return Ok(scene);
        };
        // If the base itself is valid, the values are at fault.
        self.base(text, files, chain)?.check()?;
        Err(at_value(text, files, first, refused.to_string()))
    }

    /// Applies everything except the values.
    fn change(&self, scene: &mut Scene) -> Result<(), Refused> {
        if !self.name.0.is_empty() {
            scene.name.clone_from(&self.name.0);
        }
        scene.materials.extend(self.materials.0.clone());
        if let Some(air) = &self.air {
            scene.air = Some(air.change(scene.air));
        }
        one_form::<SourceFile>(self.source.is_some(), self.sources.is_some())?;
        if let Some(source) = &self.source {
            source.change(&mut scene.source);
            let names = scene.sources().map(|source| &source.name);
            once_each::<SourceFile>(names)?;
        }
        if let Some(sources) = &self.sources {
            (scene.source, scene.further_sources) = sources.read(SourceFile::read);
        }
        one_form::<ListenerFile<FixedRadius>>(self.listener.is_some(), self.listeners.is_some())?;
        if let Some(listener) = &self.listener {
            listener.change(&mut scene.listener);
            let names = scene.listeners().map(|listener| &listener.name);
            once_each::<ListenerFile<FixedRadius>>(names)?;
        }
        if let Some(listeners) = &self.listeners {
            (scene.listener, scene.further_listeners) = listeners.read(ListenerFile::read);
        }
        Ok(())
    }

    /// The base, not yet checked as a whole.
    fn base(&self, text: &str, files: &Attached, chain: &Chain) -> Result<Scene, SceneError> {
        let refused = |why: String| at_value(text, files, self.base, why);
        let name: String = options()
            .from_str(self.base.get_ron())
            .map_err(|error| refused(error.code.to_string()))?;
        let path = match builtin::named(&name, files.folder()) {
            Named::BuiltIn(scene) => return scene,
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

/// An error at a value of the text.
fn at_value(text: &str, files: &Attached, value: &RawValue, why: String) -> SceneError {
    let (line, column) = place_of(text, value);
    malformed(files, line, column, &why)
}

/// Rejects a name that both the first and one of the others have.
fn once_each<'a, T: Placed>(
    names: impl Iterator<Item = &'a Option<String>>,
) -> Result<(), Refused> {
    let Some(name) = twice(names.map(Option::as_ref)) else {
        return Ok(());
    };
    let why = format!("two of the {} are called {name:?}", T::SEVERAL);
    Err(Refused::At(Place::Field(T::ONE), why))
}

/// The files that a scene file is based on, as far as they can be read.
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

/// The file that a scene file names as its base; `None` for a built-in scene.
pub(super) fn base_beside(path: &Path, name: &str) -> Option<PathBuf> {
    match builtin::named(name, Some(super::folder_of(path))) {
        Named::File(path) => Some(path),
        Named::BuiltIn(_) | Named::Unknown(_) => None,
    }
}
