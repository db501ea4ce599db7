//! Scenes: surfaces with their materials, air, sources, listeners.
//!
//! A [`Scene`] is plain data, independent of OpenGL. It is read from a RON file ([`Scene::load`]), built into the
//! library ([`Scene::builtin`]) or written in Rust. The module `shader` converts it to shader text and uniforms.
//! [`Scene::surface_distance`] and [`Pair::distance`] evaluate the same signed distance functions on the CPU.
//!
//! World axes: x to the right, y up, z towards the viewer (right-handed). Lengths are in metres. Angles are in radians
//! in code and in degrees in files.

mod air;
mod check;
mod directivity;
mod driven_numbers;
mod error;
mod file;
mod material;
mod material_values;
pub mod mesh;
mod motion;
mod notation;
mod pair;
pub mod shape;
mod sources_and_listeners;
mod surface;
mod transmission;
mod value_range;

pub use air::Air;
pub use directivity::{Balloon, BalloonError, Directivity};
#[doc(hidden)]
pub use driven_numbers::NamedValue;
pub use error::{SceneError, Warning};
#[doc(hidden)]
pub use file::BasedScene;
pub(crate) use file::SceneWatch;
#[doc(hidden)]
pub use file::{bases_of, path_from};
pub use material::{BuiltinMaterial, Material};
pub use material_values::{MaterialDriver, MaterialNumber};
#[doc(hidden)]
pub use motion::{Driver, Quantity};
pub use motion::{Key, Motion, Path};
#[cfg(feature = "picture")]
pub(crate) use pair::sealed::Viewpoint;
pub use pair::{IntoPair, Pair};
pub use shape::{Bounds3, HeightImage, SampledField, Shape, UserField};
pub(crate) use shape::{Copies, UserSamples, WaveDomain, halton};
#[doc(hidden)]
pub use shape::{Exactness, Node, Properties};
pub use sources_and_listeners::{Listener, Source};
pub use surface::{Nearest, Surface};
pub use transmission::Transmission;
pub use value_range::ValueRange;

use crate::bands::{BAND_COUNT, Bands};
use crate::scene::shape::{Asset, Room};
use std::collections::BTreeMap;
use std::path::{self, PathBuf};
use std::sync::Arc;

/// Bound of the rounding error of a distance: eight units in the last place, relative to the largest number in the
/// computation. The sums of three squares, the root and the product lose about half of this. Equal to the value in
/// `glsl/common/rounding.glsl`. A point on a surface may lie this deep inside the solid.
pub(crate) const ROUNDING: f32 = 8.0 * f32::EPSILON;

/// An acoustic scene: surfaces with materials, air, sources and listeners.
///
/// ```
/// use echomarch::glam::Vec3;
/// use echomarch::scene::shape::{Room, Sphere};
/// use echomarch::{Listener, Scene, Source, Surface};
///
/// let hall = Surface::new(Room { size: Vec3::new(20.0, 6.0, 12.0) });
/// let ball = Surface::new(Sphere { radius: 1.5 }).at(Vec3::new(3.0, 0.0, -2.0));
/// let source = Source::at(Vec3::new(6.0, 0.0, 0.0));
/// let listener = Listener::at(Vec3::ZERO, 0.5);
/// let scene = Scene::new("hall", vec![hall, ball], source, listener);
/// scene.check()?;
/// let nearest = scene.surface_distance(Vec3::new(3.0, 0.0, -4.0));
/// assert_eq!((nearest.object, nearest.distance), (2, 0.5));
/// # Ok::<(), echomarch::Error>(())
/// ```
///
/// Positions and directions are accepted as any type that converts to three numbers: `[f32; 3]`, or the vectors of
/// `glam` and other crates, in any version.
///
/// A scene is serialised in the format of a scene file (`docs/scene-format.md`), and deserialised from that format.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Scene {
    /// Name in reports.
    pub name: String,
    /// The surfaces. The status of a wave refers to a surface by its number in this order, counted from 1.
    pub surfaces: Vec<Surface>,
    /// The scene's own materials by name. The [built-in materials](Material::BUILTIN) need no entry here.
    pub materials: BTreeMap<String, Material>,
    /// The named values that set numbers of these materials.
    pub material_drivers: Vec<MaterialDriver>,
    /// The ranges of named values, by name. Values without an entry have a range that follows from their quantity.
    pub value_ranges: BTreeMap<String, ValueRange>,
    /// Scattering coefficient (0 to 1) of the [built-in materials](Material::BUILTIN), by octave band; 0 by default.
    /// In a scene file also the materials of the scene that state no scattering have this coefficient. Surfaces without
    /// a material do not scatter.
    pub scattering: Bands,
    /// The air. Without air (`None`) the speed of sound is 343 m/s and there is no attenuation.
    pub air: Option<Air>,
    /// The sources; a scene file has at least one. Functions that need exactly one source take a [`Pair`].
    pub sources: Vec<Source>,
    /// The listeners; a scene file has at least one.
    pub listeners: Vec<Listener>,
}

impl Scene {
    /// Creates a scene of these surfaces (numbered from 1 in this order), one source and one listener.
    pub fn new(
        name: impl Into<String>,
        surfaces: Vec<Surface>,
        source: Source,
        listener: Listener,
    ) -> Scene {
        Scene {
            name: name.into(),
            surfaces,
            materials: BTreeMap::new(),
            material_drivers: Vec::new(),
            value_ranges: BTreeMap::new(),
            scattering: [0.0; BAND_COUNT],
            air: None,
            sources: vec![source],
            listeners: vec![listener],
        }
    }

    /// Creates an empty rectangular room of `size` metres, centred on the origin. Its walls at −x, +x, −y, +y, −z, +z
    /// have the materials `wall 0` to `wall 5`, with the given absorption by band.
    ///
    /// ```
    /// use echomarch::{Listener, Scene, Source};
    ///
    /// let source = Source::at([-2.0, 0.0, 1.0]);
    /// let listener = Listener::at([2.0, 0.0, 1.0], 0.3);
    /// let scene = Scene::shoebox([8.0, 3.0, 5.0], &[[0.2; 8]; 6], source, listener);
    /// assert_eq!(scene.materials["wall 5"].absorption, [0.2; 8]);
    /// ```
    pub fn shoebox(
        size: impl Into<[f32; 3]>,
        absorption: &[Bands; Room::WALL_COUNT],
        source: Source,
        listener: Listener,
    ) -> Scene {
        let size = size.into().into();
        let mut room = Surface::new(Room { size });
        let mut materials = BTreeMap::new();
        for (wall, absorption) in absorption.iter().enumerate() {
            let name = format!("wall {wall}");
            room.walls[wall] = Some(name.clone());
            let material = Material {
                absorption: *absorption,
                ..Material::MIRROR
            };
            materials.insert(name, material);
        }
        let mut scene = Scene::new("shoebox", vec![room], source, listener);
        scene.materials = materials;
        scene
    }

    /// The state of the scene at `seconds`, with all key-framed positions, angles and numbers at this time.
    #[must_use]
    pub fn at(&self, seconds: f64) -> Scene {
        let mut posed = self.clone();
        for source in &mut posed.sources {
            if let Some(key) = source.path.at(seconds) {
                source.position = key.position;
                (source.yaw, source.pitch) = (key.yaw, key.pitch);
            }
        }
        for listener in &mut posed.listeners {
            if let Some(key) = listener.path.at(seconds) {
                listener.position = key.position;
                (listener.yaw, listener.pitch) = (key.yaw, key.pitch);
            }
        }
        posed.drive_to(seconds);
        posed
    }

    /// Duration of the longest key-framed motion in seconds; 0 if nothing moves.
    pub fn duration(&self) -> f64 {
        let drivers = self.surfaces.iter().flat_map(|s| &s.drivers);
        let driven = drivers.map(|driver| driver.motion.duration());
        let sources = self.sources.iter().map(|source| source.path.duration());
        let listeners = self
            .listeners
            .iter()
            .map(|listener| listener.path.duration());
        driven.chain(sources).chain(listeners).fold(0.0, f64::max)
    }
}

impl Scene {
    /// Time in seconds of one evaluation of the slowest user's field, if measured; see `UserField::evaluation_seconds`.
    pub(crate) fn evaluation_seconds(&self) -> Option<f64> {
        self.user_fields()
            .filter_map(|field| field.evaluation_seconds())
            .reduce(f64::max)
    }

    /// The users' fields of all surfaces, in order.
    pub fn user_fields(&self) -> impl Iterator<Item = &Arc<UserField>> {
        self.field_nodes().filter_map(Node::user)
    }

    /// The users' fields of all surfaces in order, each with the part of the field that waves can reach.
    pub(crate) fn user_domains(&self) -> Vec<(&Arc<UserField>, WaveDomain)> {
        let mut all = Vec::new();
        for surface in &self.surfaces {
            surface.shape.add_users(WaveDomain::Air, &mut all);
        }
        all
    }

    /// The files that the scene file names: users' fields, height images, sampled fields, meshes and directivities.
    pub fn files(&self) -> Vec<PathBuf> {
        let file = |asset: Asset| match asset {
            Asset::User(field) => field.file.clone(),
            Asset::Image(image) => PathBuf::from(image.name()),
            Asset::Samples(field) => PathBuf::from(field.name()),
            Asset::Mesh(mesh) => PathBuf::from(mesh.name()),
        };
        let balloons = self.balloons().map(|balloon| balloon.name().into());
        self.assets().map(file).chain(balloons).collect()
    }

    /// The contents of the files of [`Scene::files`], in the same order. A user's field is its text. An image is its
    /// width, its height and its heights as little-endian `f32`; a sampled field is its numbers of samples, its cell and
    /// its values. A directivity is its directions and amplitudes as
    /// little-endian `f64`.
    #[doc(hidden)]
    pub fn file_contents(&self) -> Vec<Vec<u8>> {
        let content = |asset: Asset| match asset {
            Asset::User(field) => field.text.clone().into_bytes(),
            Asset::Image(image) => image.to_bytes(),
            Asset::Samples(field) => field.to_bytes(),
            Asset::Mesh(mesh) => mesh.to_bytes(),
        };
        let balloons = self.balloons().map(Balloon::to_bytes);
        self.assets().map(content).chain(balloons).collect()
    }

    /// The measured directivities of the sources, in order.
    fn balloons(&self) -> impl Iterator<Item = &Balloon> {
        self.sources
            .iter()
            .filter_map(|source| match &source.directivity {
                Directivity::Balloon(balloon) => Some(&**balloon),
                _ => None,
            })
    }

    /// The large objects that come from files. `Rooms` are part of the scene file itself.
    fn assets(&self) -> impl Iterator<Item = Asset<'_>> {
        let nodes = self.field_nodes();
        let of_files = nodes.filter(|node| !matches!(node, Node::Rooms(_)));
        of_files.filter_map(Node::asset)
    }

    fn field_nodes(&self) -> impl Iterator<Item = &Node> {
        let trees = self.surfaces.iter().map(|surface| &surface.shape);
        trees.flat_map(|tree| tree.nodes().into_iter().map(|f| &f.node))
    }
}

macro_rules! built_in {
    ($($name:literal),* $(,)?) => {
        &[$((
            $name,
            include_str!(concat!("../../examples/scenes/", $name, ".ron")),
        )),*]
    };
}

/// Names and texts of the built-in scenes.
const BUILTIN: &[(&str, &str)] = built_in![
    "corner",
    "obstacles",
    "open-field",
    "open-pillars",
    "shoebox",
    "whispering-gallery",
    "parabolic-mirrors",
    "colonnade",
    "cave",
    "morphing-room",
    "menger",
    "glasshouse",
];

/// The GLSL fields of the built-in scenes.
pub(super) const FIELDS: &[(&str, &str)] = &[(
    "menger.glsl",
    include_str!("../../examples/scenes/menger.glsl"),
)];

/// Whether the text of a field is built into the program.
pub(super) fn is_own_text(text: &str) -> bool {
    FIELDS.iter().any(|(_, own)| *own == text)
}

impl Scene {
    /// The names that [`Scene::builtin`] accepts.
    pub const BUILTIN_NAMES: [&str; BUILTIN.len()] = {
        let mut names = [""; BUILTIN.len()];
        let mut index = 0;
        while index < BUILTIN.len() {
            names[index] = BUILTIN[index].0;
            index += 1;
        }
        names
    };

    /// A built-in scene by its name (see [`Scene::BUILTIN_NAMES`]).
    ///
    /// ```
    /// let corner = echomarch::Scene::builtin("corner")?;
    /// assert_eq!(corner.surfaces.len(), 2);
    /// # Ok::<(), echomarch::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`SceneError::Unknown`] for any other name.
    pub fn builtin(name: &str) -> Result<Scene, SceneError> {
        match BUILTIN.iter().find(|(known, _)| *known == name) {
            Some((_, text)) => {
                Scene::from_embedded(text, &format!("built-in scene {name}"), FIELDS)
            }
            None => Err(unknown(name, None)),
        }
    }

    /// The RON text of a built-in scene.
    pub fn builtin_text(name: &str) -> Option<&'static str> {
        let known = BUILTIN.iter().find(|(known, _)| *known == name);
        known.map(|(_, text)| *text)
    }

    /// Loads the built-in scene of this name; if there is none, loads the scene file at this path.
    ///
    /// Built-in names take precedence; `./corner` always refers to a file.
    ///
    /// # Errors
    /// [`SceneError`] if the scene is unknown, unreadable, malformed or invalid.
    pub fn load(name_or_file: &str) -> Result<Scene, SceneError> {
        Scene::load_in(name_or_file, path::Path::new(""))
    }

    /// Like [`Scene::load`], with file names relative to `folder`.
    #[doc(hidden)]
    pub fn load_in(name_or_file: &str, folder: &path::Path) -> Result<Scene, SceneError> {
        match named(name_or_file, Some(folder)) {
            Named::BuiltIn(scene) => scene,
            Named::File(path) => Scene::from_file(&path),
            Named::Unknown(error) => Err(error),
        }
    }
}

/// The result of the lookup of a scene's name: a scene, a file or an error.
pub(super) enum Named {
    BuiltIn(Result<Scene, SceneError>),
    File(PathBuf),
    Unknown(SceneError),
}

/// Looks up the name of a built-in scene first, and then of a file in the folder. Without a folder, only built-in
/// scenes are looked up.
pub(super) fn named(name: &str, folder: Option<&path::Path>) -> Named {
    if Scene::BUILTIN_NAMES.contains(&name) {
        return Named::BuiltIn(Scene::builtin(name));
    }
    let Some(folder) = folder else {
        return Named::Unknown(unknown(name, None));
    };
    let (path, place) = (path::Path::new(name), folder.join(name));
    let looks_like_a_file = path.extension().is_some() || path.components().count() > 1;
    if looks_like_a_file || place.exists() {
        return Named::File(place);
    }
    Named::Unknown(unknown(name, Some(folder)))
}

fn unknown(name: &str, folder: Option<&path::Path>) -> SceneError {
    let file = || folder.and_then(|folder| file_of(name, folder));
    SceneError::Unknown {
        name: name.to_owned(),
        builtin: Scene::BUILTIN_NAMES.join(", "),
        nearest: nearest(name).map(str::to_owned).or_else(file),
    }
}

/// A scene file whose name without the extension is `name`, in the folder or among the examples of a repository
/// checkout.
fn file_of(name: &str, folder: &path::Path) -> Option<String> {
    let file = format!("{name}.ron");
    let example = format!("examples/scenes/{file}");
    let mut known = [file, example].into_iter();
    known.find(|file| folder.join(file).is_file())
}

/// The built-in scene whose name is most similar to `name`, or starts with it. Other parts of a name, such as `room`, are
/// kinds of scenes more than names.
fn nearest(name: &str) -> Option<&'static str> {
    /// A shorter beginning says too little.
    const SHORTEST_BEGINNING: usize = 3;
    let plain = name.to_lowercase().replace([' ', '_'], "-");
    let begins = |known: &&str| plain.len() >= SHORTEST_BEGINNING && known.starts_with(&plain);
    let mistyped = crate::text::nearest(name, Scene::BUILTIN_NAMES);
    mistyped.or_else(|| Scene::BUILTIN_NAMES.into_iter().find(begins))
}

/// A clause that suggests the built-in scene with the name of a missing file; empty if there is no such scene.
pub(super) fn built_in_of(path: &path::Path) -> String {
    let is_alone = path.components().count() == 1;
    let stem = path.file_stem().and_then(|stem| stem.to_str());
    let known = stem.and_then(|stem| {
        Scene::BUILTIN_NAMES
            .into_iter()
            .find(|known| *known == stem)
    });
    match known.filter(|_| is_alone) {
        Some(name) => format!("; the built-in scene is called {name}"),
        None => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects files from editors that write a byte-order mark before the text.
    #[test]
    fn a_byte_order_mark_is_no_part_of_the_scene() {
        let marked = format!("\u{feff}{}", BUILTIN[0].1);
        let scene = Scene::from_ron(&marked, "marked").unwrap();
        assert_eq!(scene, Scene::builtin(BUILTIN[0].0).unwrap());
    }

    /// Protects the suggestion for a mistyped name: the most similar name, if any is similar.
    #[test]
    fn a_name_that_is_nearly_right_is_suggested() {
        for (typed, meant) in [
            ("cornr", Some("corner")),
            ("Corner", Some("corner")),
            ("conrer", Some("corner")),
            ("obstacle", Some("obstacles")),
            ("open_field", Some("open-field")),
            ("openfield", Some("open-field")),
            ("whispering", Some("whispering-gallery")),
            ("parabolic", Some("parabolic-mirrors")),
            ("mirrors", None),
            ("room", None),
            ("trumpet", None),
            ("x", None),
        ] {
            assert_eq!(nearest(typed), meant, "{typed}");
            let told = Scene::load(typed).unwrap_err().to_string();
            let is_asked = told.contains("did you mean");
            assert_eq!(is_asked, meant.is_some(), "{told}");
            assert!(meant.is_none_or(|meant| told.contains(meant)), "{told}");
        }
    }

    /// Protects the built-in scenes, which are files in `examples/scenes/`: all load without a warning.
    #[test]
    fn built_in_scenes_load_without_a_warning() {
        for name in Scene::BUILTIN_NAMES {
            let scene = Scene::builtin(name).unwrap();
            assert_eq!(scene.name, name);
            assert_eq!(scene.warnings(), vec![], "{name}");
        }
    }
}
