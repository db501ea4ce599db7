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

use super::air::AirFile;
use super::chain::{Chain, MOST_BASES};
use super::material::Materials;
use super::sources_and_listeners::{ListenerFile, Placed, Several, SourceFile, one_form};
use super::text_places::{Place, Refused, place_of};
use super::{malformed, options, text_of};
use crate::scene::builtin::{self, Named};
use crate::scene::check::twice;
use crate::scene::notation::{Attached, FixedRadius, Name};
use crate::scene::{Scene, SceneError};
use ron::value::RawValue;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

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
    #[serde(default)]
    air: Option<AirFile>,
    #[serde(default)]
    source: Option<SourceFile>,
    #[serde(default)]
    sources: Option<Several<SourceFile>>,
    #[serde(default)]
    listener: Option<ListenerFile<Option<FixedRadius>>>,
    #[serde(default)]
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
    #[serde(borrow, default)]
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Path as KeyPath, SceneWatch, Source};
    use glam::Vec3;

    const HALL: &str = r#"Scene(
        surfaces: [
            Surface(shape: Room(size: (20, 6, 20))),
            Surface(name: "door", shape: Box(size: (Value("width", 2), 3, 1)), rotation: (0, Value("door", 30), 0)),
        ],
        source: Source(path: [Key(time: 0, position: (0, 0, -6)), Key(time: 2, position: (1, 0, -6))]),
        listener: Listener(position: (0, 0, 6), radius: 1, yaw: 10, pitch: 5, path: [Key(time: 1, position: (0, 0, 5))]),
    )"#;

    /// A folder with `hall.ron`; other files are written next to it.
    struct Folder(tempfile::TempDir);

    impl Folder {
        fn new() -> Folder {
            let folder = Folder(tempfile::tempdir().unwrap());
            folder.write("hall.ron", HALL);
            folder
        }

        fn path(&self, name: &str) -> PathBuf {
            self.0.path().join(name)
        }

        fn write(&self, name: &str, text: &str) {
            let path = self.path(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        }

        /// Reads a scene file `small.ron` with this text.
        fn read(&self, text: &str) -> Result<Scene, SceneError> {
            self.write("small.ron", text);
            Scene::from_file(&self.path("small.ron"))
        }

        /// The error, without the folder.
        fn refused(&self, text: &str) -> String {
            let said = self.read(text).unwrap_err().to_string();
            said.replace(&format!("{}/", self.0.path().display()), "")
        }
    }

    /// Protects the rule of a base: what is named is changed, everything else is the base's.
    #[test]
    fn only_what_is_named_differs_from_the_base() {
        let folder = Folder::new();
        let hall = Scene::from_file(&folder.path("hall.ron")).unwrap();
        assert_eq!(folder.read(r#"Scene(base: "hall.ron")"#).unwrap(), hall);
        assert_eq!(hall.name, "hall");

        let mut expected = hall.clone();
        expected.name = "small".into();
        expected.source = Source::at(Vec3::Y);
        expected.set_value("door", 60.0).unwrap();
        let text = r#"// The base may stand anywhere.
            (values: [Value("door", 60)], source: (position: (0, 1, 0)), name: "small", base: "hall.ron")"#;
        assert_eq!(folder.read(text).unwrap(), expected);

        // A listener with a given position has no path; a radius alone does not move it.
        let listener = |said: &str| {
            let text = format!(r#"Scene(base: "hall.ron", listener: Listener({said}))"#);
            folder.read(&text).unwrap().listener
        };
        let mut turned = hall.listener.clone();
        turned.yaw = 0.5f32.to_degrees().to_radians();
        turned.path = KeyPath::default();
        let read = listener(&format!("yaw: {}", 0.5f32.to_degrees()));
        assert_eq!(read, turned);
        let mut wide = hall.listener.clone();
        wide.radius = 2.5;
        assert_eq!(listener("radius: 2.5"), wide);
        let walks = listener("path: [Key(time: 0, position: (3, 0, 0), yaw: 90)]");
        assert_eq!(walks.position, Vec3::new(3.0, 0.0, 0.0));
        assert_eq!((walks.yaw, walks.pitch), (90f32.to_radians(), 0.0));
    }

    /// Protects names: a built-in scene first, then a file in the folder of the one that names it; an
    /// embedded text has no files.
    #[test]
    fn a_base_is_a_built_in_scene_or_a_file_beside() {
        let folder = Folder::new();
        let corner = Scene::builtin("corner").unwrap();
        folder.write("corner", HALL);
        folder.write("in/deep.ron", r#"Scene(base: "../hall.ron")"#);
        assert_eq!(folder.read(r#"Scene(base: "corner")"#).unwrap(), corner);
        let hall = folder.read(r#"Scene(base: "in/deep.ron")"#).unwrap();
        assert_eq!(hall.surfaces.len(), 2);
        let file = folder.read(r#"Scene(base: "./corner")"#).unwrap();
        assert_eq!(file.surfaces, hall.surfaces);
        let text = r#"Scene(base: "menger", listener: Listener(radius: 0.5))"#;
        let menger = Scene::from_ron(text, "text").unwrap();
        assert_eq!(menger.user_fields().count(), 1);
        assert_eq!(menger.listener.radius, 0.5);
    }

    /// Each error names the file that it is in, and the line there.
    #[test]
    fn errors_point_at_their_own_file_and_line() {
        let folder = Folder::new();
        folder.write("broken.ron", "Scene(\n  surfaces: [],\n  sorce: 1)");
        folder.write(
            "empty.ron",
            &HALL.replace("surfaces: [", "surfaces: [], old: ["),
        );
        folder.write(
            "none.ron",
            "Scene(surfaces: [], source: Source(), listener: Listener(radius: 1))",
        );
        for (text, told) in [
            (
                "Scene(\n  base: \"hall.ron\",\n  listner: Listener(yaw: 3))",
                "small.ron:3:3: there is no field `listner`",
            ),
            (
                "Scene(base: \"hall.ron\",\n listener: Listener(radius: -1))",
                "small.ron:2:29: a radius in metres",
            ),
            (
                "Scene(base: \"hall.ron\", surfaces: [])",
                "small.ron:1:25: there is no field `surfaces`",
            ),
            (
                "Scene(surfaces: [], base: \"hall.ron\")",
                "small.ron:1:7: there is no field `surfaces`",
            ),
            (
                "Scene(name: \"a\", source: Source(position: (0, 1, 0)))",
                "small.ron:1:53: `surfaces` is missing",
            ),
            (
                "Scene(\n\n  base:  \"gone.ron\")",
                "small.ron:3:10: cannot read the base gone.ron: No such file",
            ),
            (
                "Scene(base: \"cornr\")",
                "small.ron:1:13: there is no scene \"cornr\"",
            ),
            ("Scene(base: 3)", "small.ron:1:13: "),
            (
                "Scene(base: \"broken.ron\")",
                "broken.ron:3:3: there is no field `sorce`",
            ),
            (
                "Scene(base: \"empty.ron\")",
                "empty.ron:2:23: there is no field `old`",
            ),
            (
                "Scene(base: \"none.ron\")",
                "scene \"none\" has no surfaces",
            ),
            (
                "Scene(base: \"hall.ron\", values: [\n Value(\"door\", 1),\n Value(\"dor\", 1)])",
                "small.ron:3:2: scene \"hall\" has no value named \"dor\"",
            ),
            (
                "Scene(base: \"hall.ron\", values: [Value(\"door\", 1), Value(\"door\", 2)])",
                "small.ron:1:52: the value \"door\" is set twice",
            ),
            (
                "Scene(base: \"hall.ron\", values: [Value(\"door\", 1e99)])",
                "small.ron:1:34: a value must be finite",
            ),
            (
                "Scene(base: \"hall.ron\",\n values: [Value(\"width\", -2)])",
                "small.ron:2:11: scene \"hall\"",
            ),
        ] {
            let said = folder.refused(text);
            assert!(said.starts_with(told), "{text}: {said}");
        }
    }

    /// Protects against endless and deep chains: a cycle is reported, also through links, and so are nine bases.
    #[test]
    fn chains_of_bases_have_an_end() {
        let folder = Folder::new();
        let based_on = |base: &str| format!("Scene(base: \"{base}\")");
        assert_eq!(
            folder.refused(&based_on("small.ron")),
            "small.ron:1:13: the base small.ron is itself based on this scene"
        );
        folder.write("other.ron", &based_on("small.ron"));
        assert_eq!(
            folder.refused(&based_on("other.ron")),
            "other.ron:1:13: the base small.ron is itself based on this scene"
        );
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink("small.ron", folder.path("link.ron")).unwrap();
            let said = folder.refused(&based_on("link.ron"));
            assert!(said.ends_with("the base link.ron is itself based on this scene"));
            std::fs::hard_link(folder.path("small.ron"), folder.path("hard.ron")).unwrap();
            let said = folder.refused(&based_on("hard.ron"));
            assert!(said.contains("based on"), "{said}");
            std::os::unix::fs::symlink("/dev/zero", folder.path("zero.ron")).unwrap();
            let said = folder.refused(&based_on("zero.ron"));
            assert!(
                said.ends_with("it is a device, not a regular file"),
                "{said}"
            );
        }
        folder.write("1.ron", &based_on("hall.ron"));
        for number in 2..=8 {
            let text = based_on(&format!("{}.ron", number - 1));
            folder.write(&format!("{number}.ron"), &text);
        }
        assert!(folder.read(&based_on("7.ron")).is_ok());
        assert_eq!(
            folder.refused(&based_on("8.ron")),
            "1.ron:1:13: more than 8 scenes are based on each other"
        );
    }

    /// Protects a running program: a base is an input like the file that names it, and its changes are
    /// noticed.
    #[test]
    fn a_base_is_watched_and_never_replaced() {
        let folder = Folder::new();
        let text = r#"Scene(base: "hall.ron", name: "small")"#;
        folder.write("small.ron", text);
        let path = folder.path("small.ron");
        let (mut watch, first) = SceneWatch::open(path.to_str().unwrap()).unwrap();
        assert_eq!(watch.files().count(), 2);
        assert!(crate::file_input::is_input(&folder.path("hall.ron")));
        let mut settled = || (0..3).find_map(|_| watch.poll());
        folder.write("hall.ron", &HALL.replace("radius: 1,", "radius: 1.5,"));
        assert_eq!(settled().unwrap().unwrap().listener.radius, 1.5);
        folder.write("hall.ron", "Scene(");
        assert!(settled().unwrap().is_err());
        folder.write("hall.ron", HALL);
        assert_eq!(settled().unwrap().unwrap(), first);
    }
}
