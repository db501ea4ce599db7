//! Scenes: surfaces and their materials, air, sources, listeners.
//!
//! A [`Scene`] is plain data. It is read from a RON file ([`Scene::load`]), taken from the built-in
//! ones ([`Scene::builtin`]) or written in Rust, and does not depend on OpenGL: the module `kernel`
//! turns it into shader text and numbers, [`Scene::distance`] is the same signed distance function
//! on the CPU.
//!
//! World axes: x to the right, y up, z towards the viewer (right-handed).
//! World units are metres, angles are radians in code and degrees in files.

mod air;
mod builtin;
mod check;
mod distance;
mod driven_numbers;
mod error;
mod file;
mod file_watch;
mod material;
mod motion;
mod named_values;
mod notation;
mod path;
mod quantity;
pub mod shape;
mod source_listener_pairs;
mod surface;

pub use air::{Air, USUAL_SPEED_OF_SOUND};
pub use builtin::BUILTIN_NAMES;
pub use check::Warning;
pub use distance::Nearest;
pub use error::SceneError;
#[doc(hidden)]
pub use file::BasedScene;
#[doc(hidden)]
pub use file::bases_of;
pub(crate) use file_watch::SceneWatch;
pub use material::{BUILTIN_MATERIALS, BuiltinMaterial, Material, WALL_COUNT, WALL_NAMES};
pub use motion::{Driver, Motion};
pub use named_values::NamedValue;
pub use path::{Key, Path};
pub use quantity::Quantity;
pub use shape::{Bounds3, Exactness, HeightImage, Node, Properties, Shape, UserField};
pub(crate) use shape::{Copies, UserSamples, halton};
pub use surface::Surface;

use crate::bands::Bands;
use crate::scene::shape::{Asset, Room};
use glam::Vec3;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

/// Eight units in the last place, as a share of the largest number in the computation of a
/// distance: sums of three squares, a root and a product lose about half of that. Equal to the
/// value in `glsl/common/rounding.glsl`. A point on a surface may lie this deep in its solid.
pub(crate) const ROUNDING: f32 = 8.0 * f32::EPSILON;

/// An acoustic world: surfaces with materials, air, sources and listeners.
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
/// A scene serialises to the content of its file (`docs/scene-format.md`), and deserialises from
/// that.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Scene {
    /// Name in reports.
    pub name: String,
    /// The surfaces, numbered from 1 in this order in every wave's status.
    pub surfaces: Vec<Surface>,
    /// The scene's own materials by their names; the [built-in ones](BUILTIN_MATERIALS) are
    /// available without being listed here.
    pub materials: BTreeMap<String, Material>,
    /// The air; without it the speed of sound is 343 m/s, and it does not absorb.
    pub air: Option<Air>,
    /// The first source.
    pub source: Source,
    /// The first listener.
    pub listener: Listener,
    /// Sources after the first one. Callers that need one source use the first.
    pub further_sources: Vec<Source>,
    /// Listeners after the first one.
    pub further_listeners: Vec<Listener>,
}

/// A point that sends waves in all directions.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Source {
    /// Name in reports, unique among the sources.
    pub name: Option<String>,
    /// Level relative to other sources in decibels.
    pub level_db: f32,
    /// World position in metres.
    pub position: Vec3,
    /// Positions in time; empty when it stands still.
    pub path: Path,
}

/// A sphere that receives waves, and the direction it looks in.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Listener {
    /// Name in reports, unique among the listeners.
    pub name: Option<String>,
    /// World position of the centre in metres.
    pub position: Vec3,
    /// Turn about the vertical in radians, positive to the right; 0 looks along −z.
    pub yaw: f32,
    /// Elevation of the gaze in radians, positive upwards.
    pub pitch: f32,
    /// Radius of the sphere in metres.
    pub radius: f32,
    /// Positions and turns in time; empty when it stands still.
    pub path: Path,
}

impl Scene {
    /// A scene of these surfaces, numbered from 1 in this order.
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
            air: None,
            source,
            listener,
            further_sources: Vec::new(),
            further_listeners: Vec::new(),
        }
    }

    /// An empty rectangular room about the origin, of `size` metres. The absorption of its walls at −x, +x, −y, +y, −z,
    /// +z, by band, is that of the materials `wall 0` to `wall 5`.
    ///
    /// ```
    /// use echomarch::glam::Vec3;
    /// use echomarch::{Listener, Scene, Source};
    ///
    /// let source = Source::at(Vec3::new(-2.0, 0.0, 1.0));
    /// let listener = Listener::at(Vec3::new(2.0, 0.0, 1.0), 0.3);
    /// let scene = Scene::shoebox(Vec3::new(8.0, 3.0, 5.0), &[[0.2; 8]; 6], source, listener);
    /// assert_eq!(scene.materials["wall 5"].absorption, [0.2; 8]);
    /// ```
    pub fn shoebox(
        size: Vec3,
        absorption: &[Bands; WALL_COUNT],
        source: Source,
        listener: Listener,
    ) -> Scene {
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

    /// The scene at `seconds` on its key-framed paths.
    pub fn at(&self, seconds: f64) -> Scene {
        let mut posed = self.clone();
        for source in posed.sources_mut() {
            if let Some(key) = source.path.at(seconds) {
                source.position = key.position;
            }
        }
        for listener in posed.listeners_mut() {
            if let Some(key) = listener.path.at(seconds) {
                listener.position = key.position;
                (listener.yaw, listener.pitch) = (key.yaw, key.pitch);
            }
        }
        posed.drive_to(seconds);
        posed
    }

    /// Length of the longest path in seconds; 0 when nothing moves.
    pub fn duration(&self) -> f64 {
        let drivers = self.surfaces.iter().flat_map(|s| &s.drivers);
        let driven = drivers.map(|driver| driver.motion.duration());
        let sources = self.sources().map(|source| source.path.duration());
        let listeners = self.listeners().map(|listener| listener.path.duration());
        driven.chain(sources).chain(listeners).fold(0.0, f64::max)
    }
}

impl Scene {
    /// Seconds for one evaluation of the slowest user's field, if that was measured; see
    /// `UserField::evaluation_seconds`.
    pub fn evaluation_seconds(&self) -> Option<f64> {
        self.user_fields()
            .filter_map(|field| field.evaluation_seconds())
            .reduce(f64::max)
    }

    /// The users' fields of all surfaces, in order.
    pub fn user_fields(&self) -> impl Iterator<Item = &Arc<UserField>> {
        self.field_nodes().filter_map(Node::user)
    }

    /// The files, besides its own, that the scene was made from: users' fields and images.
    pub fn files(&self) -> Vec<PathBuf> {
        let file = |asset: Asset| match asset {
            Asset::User(field) => field.file.clone(),
            Asset::Image(image) => PathBuf::from(image.name()),
        };
        self.assets().map(file).collect()
    }

    /// The contents of these files, in the order of [`Scene::files`]: texts, and the heights of
    /// images as little-endian `f32` after their width and height.
    pub fn file_contents(&self) -> Vec<Vec<u8>> {
        let content = |asset: Asset| match asset {
            Asset::User(field) => field.text.clone().into_bytes(),
            Asset::Image(image) => image.to_bytes(),
        };
        self.assets().map(content).collect()
    }

    fn assets(&self) -> impl Iterator<Item = Asset<'_>> {
        self.field_nodes().filter_map(Node::asset)
    }

    fn field_nodes(&self) -> impl Iterator<Item = &Node> {
        let trees = self.surfaces.iter().map(|surface| &surface.shape);
        trees.flat_map(|tree| tree.nodes().into_iter().map(|f| &f.node))
    }
}

impl Source {
    /// A source that stands still at `position` (metres).
    pub fn at(position: Vec3) -> Source {
        Source {
            name: None,
            level_db: 0.0,
            position,
            path: Path::default(),
        }
    }

    /// The same source with a name.
    pub fn named(mut self, name: impl Into<String>) -> Source {
        self.name = Some(name.into());
        self
    }
}

impl Listener {
    /// A listener that stands still at `position` (metres) and looks along −z.
    pub fn at(position: Vec3, radius: f32) -> Listener {
        Listener {
            name: None,
            position,
            yaw: 0.0,
            pitch: 0.0,
            radius,
            path: Path::default(),
        }
    }

    /// The same listener with a name.
    pub fn named(mut self, name: impl Into<String>) -> Listener {
        self.name = Some(name.into());
        self
    }

    /// Unit vector of the viewing direction.
    pub fn forward(&self) -> Vec3 {
        let (sin_yaw, cos_yaw) = self.yaw.sin_cos();
        let (sin_pitch, cos_pitch) = self.pitch.sin_cos();
        Vec3::new(sin_yaw * cos_pitch, sin_pitch, -cos_yaw * cos_pitch)
    }

    /// Unit vector out of the right ear.
    pub fn right(&self) -> Vec3 {
        let (sin_yaw, cos_yaw) = self.yaw.sin_cos();
        Vec3::new(cos_yaw, 0.0, sin_yaw)
    }

    /// Unit vector out of the top of the head.
    pub fn up(&self) -> Vec3 {
        self.right().cross(self.forward())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::FRAC_PI_2;

    /// Protects the sign of yaw and pitch: right and up are positive.
    #[test]
    fn a_listener_turns_right_and_looks_up_with_positive_angles() {
        let mut listener = Listener::at(Vec3::ZERO, 1.0);
        assert!((listener.forward() - Vec3::NEG_Z).length() < 1e-6);
        listener.yaw = FRAC_PI_2;
        assert!((listener.forward() - Vec3::X).length() < 1e-6);
        assert!((listener.right() - Vec3::Z).length() < 1e-6);
        listener.pitch = FRAC_PI_2;
        assert!((listener.forward() - Vec3::Y).length() < 1e-6);
        assert!((listener.up() - Vec3::NEG_X).length() < 1e-6);
    }
}
