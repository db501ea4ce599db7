//! Sources and listeners of a scene, and the lookup of its materials and air.

use super::{Air, Directivity, Material, Path, Scene, SceneError};
use crate::bands::{self, BAND_COUNT, Bands};
use crate::text::nearest_or_all;
use glam::{DQuat, DVec3, DVec4, Vec3};

/// Maximum tilt of a head that counts as level, in radians. It exceeds the rounding error of a quaternion composed of
/// thousands of `f32` rotations. It raises an ear of a listener by a thousandth of half the head's width.
const MOST_TILT: f64 = 1e-3;

/// A point that emits waves, with an orientation and a directivity.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Source {
    /// Name in reports, unique among the sources.
    pub name: Option<String>,
    /// Level relative to the other sources, in decibels.
    pub level_db: f32,
    /// World position in metres.
    pub position: Vec3,
    /// Rotation about the vertical axis in radians, positive to the right; 0 is the direction −z.
    pub yaw: f32,
    /// Elevation of the source's axis in radians, positive upwards.
    pub pitch: f32,
    /// Rotation about the source's axis in radians, positive clockwise as seen from behind. Only a simulator sets it;
    /// scene files have no roll.
    pub(crate) roll: f32,
    /// Power in each direction. It affects responses, and not the balance of a frame.
    pub directivity: Directivity,
    /// Key-framed positions and angles; empty for a static source.
    pub path: Path,
}

/// A sphere that receives waves, with a viewing direction.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Listener {
    /// Name in reports, unique among the listeners.
    pub name: Option<String>,
    /// World position of the centre in metres.
    pub position: Vec3,
    /// Rotation about the vertical axis in radians, positive to the right; 0 is the direction −z.
    pub yaw: f32,
    /// Elevation of the viewing direction in radians, positive upwards.
    pub pitch: f32,
    /// Radius of the sphere in metres.
    pub radius: f32,
    /// Key-framed positions and angles; empty for a static listener.
    pub path: Path,
}

impl Source {
    /// Creates a static, omnidirectional source at `position` (metres), whose axis is −z.
    pub fn at(position: impl Into<[f32; 3]>) -> Source {
        Source {
            name: None,
            level_db: 0.0,
            position: position.into().into(),
            yaw: 0.0,
            pitch: 0.0,
            roll: 0.0,
            directivity: Directivity::Omnidirectional,
            path: Path::default(),
        }
    }

    /// Returns the source with a name.
    #[must_use]
    pub fn named(mut self, name: impl Into<String>) -> Source {
        self.name = Some(name.into());
        self
    }

    /// Returns the source with a level relative to the other sources, in decibels.
    #[must_use]
    pub fn with_level_db(mut self, level_db: f32) -> Source {
        self.level_db = level_db;
        self
    }

    /// Returns the source with a directivity. The total power remains the same.
    ///
    /// ```
    /// use echomarch::Source;
    /// use echomarch::scene::Directivity;
    ///
    /// let talker = Source::at([0.0, 1.5, 0.0])
    ///     .with_directivity(Directivity::CARDIOID)
    ///     .pointing_along([1.0, 0.0, 0.0])?;
    /// assert!((talker.factor([1.0, 0.0, 0.0].into())[4] - 3.0).abs() < 1e-6);
    /// # Ok::<(), echomarch::scene::SceneError>(())
    /// ```
    #[must_use]
    pub fn with_directivity(mut self, directivity: Directivity) -> Source {
        self.directivity = directivity;
        self
    }

    /// Returns the source with its axis along a direction in world axes, of any length except 0. A direction straight
    /// up or down leaves the yaw unchanged.
    ///
    /// # Errors
    /// [`SceneError::NoOrientation`] for a direction that is 0 or not finite.
    pub fn pointing_along(mut self, axis: impl Into<[f32; 3]>) -> Result<Source, SceneError> {
        let (yaw, pitch) = angles_along(axis.into().into(), "source's direction")?;
        self.yaw = yaw.unwrap_or(self.yaw);
        self.pitch = pitch;
        Ok(self)
    }

    /// The energy that the source radiates in a direction of the world, by band, relative to an omnidirectional source
    /// with the same power. The direction has any length; for a zero vector the factor is 1.
    pub fn factor(&self, direction: DVec3) -> Bands {
        if self.directivity.is_omnidirectional() {
            return bands::ALL;
        }
        let axes = [self.forward(), -self.right(), self.up()];
        let [ahead, left, up] = axes.map(|axis| axis.as_dvec3().dot(direction));
        self.directivity.factor(DVec3::new(ahead, left, up))
    }

    /// Unit vector of the source's axis.
    pub fn forward(&self) -> Vec3 {
        forward(self.yaw, self.pitch)
    }

    /// Unit vector to the right of the source's axis; horizontal, unless a simulator has rolled the source.
    pub fn right(&self) -> Vec3 {
        let (sin, cos) = self.roll.sin_cos();
        right(self.yaw) * cos - up(self.yaw, self.pitch) * sin
    }

    /// Unit vector that points upwards from the source, perpendicular to its axis.
    pub fn up(&self) -> Vec3 {
        let (sin, cos) = self.roll.sin_cos();
        up(self.yaw, self.pitch) * cos + right(self.yaw) * sin
    }

    /// Turns the source's own axes (−z ahead, y up) by a unit quaternion, with its roll.
    #[cfg(any(test, feature = "simulator"))]
    pub(crate) fn orient(&mut self, turn: DQuat) {
        let [ahead, up_axis] = [turn * DVec3::NEG_Z, turn * DVec3::Y];
        let is_vertical = ahead.x.hypot(ahead.z) < f64::from(f32::EPSILON);
        self.yaw = match is_vertical {
            true => 0.0,
            false => ahead.x.atan2(-ahead.z) as f32,
        };
        self.pitch = ahead.y.clamp(-1.0, 1.0).asin() as f32;
        let [level_right, level_up] =
            [right(self.yaw), up(self.yaw, self.pitch)].map(|axis| axis.as_dvec3());
        self.roll = up_axis.dot(level_right).atan2(up_axis.dot(level_up)) as f32;
    }
}

impl Listener {
    /// Creates a static listener at `position` (metres) that looks along −z.
    pub fn at(position: impl Into<[f32; 3]>, radius: f32) -> Listener {
        Listener {
            name: None,
            position: position.into().into(),
            yaw: 0.0,
            pitch: 0.0,
            radius,
            path: Path::default(),
        }
    }

    /// Returns the listener with a name.
    #[must_use]
    pub fn named(mut self, name: impl Into<String>) -> Listener {
        self.name = Some(name.into());
        self
    }

    /// Returns the listener with the rotation of a quaternion (x, y, z, w) of any length except 0. The identity looks
    /// along −z with +y up, like a camera in a right-handed world with y up.
    ///
    /// ```
    /// use echomarch::Listener;
    /// use echomarch::glam::{Quat, Vec3};
    ///
    /// let left = Quat::from_rotation_y(std::f32::consts::FRAC_PI_2);
    /// let listener = Listener::at([0.0, 1.7, 0.0], 0.2).with_orientation(left)?;
    /// assert!(listener.forward().distance(Vec3::NEG_X) < 1e-6);
    /// # Ok::<(), echomarch::scene::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// [`SceneError::RolledListener`] if the head is tilted to one side or upside down: the axis through a listener's
    /// ears is horizontal. [`Listener::looking_along`] ignores such a tilt. [`SceneError::NoOrientation`] for a
    /// quaternion that is 0 or not finite.
    pub fn with_orientation(
        mut self,
        orientation: impl Into<[f32; 4]>,
    ) -> Result<Listener, SceneError> {
        let [x, y, z, w] = orientation.into().map(f64::from);
        let length = DVec4::new(x, y, z, w).length();
        if !(length.is_finite() && length > 0.0) {
            return Err(SceneError::NoOrientation {
                of: "listener's quaternion",
                value: format!("({x}, {y}, {z}, {w})"),
            });
        }
        let turn = DQuat::from_xyzw(x, y, z, w).normalize();
        let [right, up] = [turn * DVec3::X, turn * DVec3::Y];
        // If the listener looks straight up or down, a rotation about the viewing direction is a yaw.
        if right.y.hypot(up.y) > MOST_TILT {
            let roll = -right.y.atan2(up.y);
            if roll.abs() > MOST_TILT {
                let roll_deg = roll.to_degrees() as f32;
                return Err(SceneError::RolledListener { roll_deg });
            }
        }
        let ahead = turn * DVec3::NEG_Z;
        self.yaw = right.z.atan2(right.x) as f32;
        self.pitch = ahead.y.clamp(-1.0, 1.0).asin() as f32;
        Ok(self)
    }

    /// Returns the listener looking along a direction in world axes, of any length except 0. A direction straight up or
    /// down leaves the yaw unchanged.
    ///
    /// # Errors
    /// [`SceneError::NoOrientation`] for a direction that is 0 or not finite.
    pub fn looking_along(mut self, forward: impl Into<[f32; 3]>) -> Result<Listener, SceneError> {
        let (yaw, pitch) = angles_along(forward.into().into(), "listener's direction")?;
        self.yaw = yaw.unwrap_or(self.yaw);
        self.pitch = pitch;
        Ok(self)
    }

    /// Unit vector of the viewing direction.
    pub fn forward(&self) -> Vec3 {
        forward(self.yaw, self.pitch)
    }

    /// Unit vector that points out of the right ear.
    pub fn right(&self) -> Vec3 {
        right(self.yaw)
    }

    /// Unit vector that points out of the top of the head.
    pub fn up(&self) -> Vec3 {
        up(self.yaw, self.pitch)
    }
}

/// Unit vector of a direction with this yaw and pitch, in radians.
fn forward(yaw: f32, pitch: f32) -> Vec3 {
    let (sin_yaw, cos_yaw) = yaw.sin_cos();
    let (sin_pitch, cos_pitch) = pitch.sin_cos();
    Vec3::new(sin_yaw * cos_pitch, sin_pitch, -cos_yaw * cos_pitch)
}

/// Unit vector upwards, perpendicular to a direction with this yaw and pitch, in radians.
fn up(yaw: f32, pitch: f32) -> Vec3 {
    right(yaw).cross(forward(yaw, pitch))
}

/// Horizontal unit vector to the right of a direction with this yaw, in radians.
fn right(yaw: f32) -> Vec3 {
    let (sin_yaw, cos_yaw) = yaw.sin_cos();
    Vec3::new(cos_yaw, 0.0, sin_yaw)
}

/// Yaw and pitch in radians of a direction of any length except 0. The yaw is `None` for a direction straight up or
/// down. `of` names the direction in the error.
fn angles_along(direction: Vec3, of: &'static str) -> Result<(Option<f32>, f32), SceneError> {
    let unit = direction.as_dvec3().try_normalize();
    let Some(unit) = unit.filter(|_| direction.is_finite()) else {
        return Err(SceneError::NoOrientation {
            of,
            value: direction.to_string(),
        });
    };
    let is_vertical = unit.x == 0.0 && unit.z == 0.0;
    let yaw = (!is_vertical).then(|| unit.x.atan2(-unit.z) as f32);
    let pitch = unit.y.atan2(unit.x.hypot(unit.z)) as f32;
    Ok((yaw, pitch))
}

impl Scene {
    /// The names of the sources in reports, in order. A source without a name is labelled by its number from 1.
    pub fn source_labels(&self) -> Vec<String> {
        labels(self.sources.iter().map(|source| source.name.as_deref()))
    }

    /// The names of the listeners in reports, in order. A listener without a name is labelled by its number from 1.
    pub fn listener_labels(&self) -> Vec<String> {
        labels(
            self.listeners
                .iter()
                .map(|listener| listener.name.as_deref()),
        )
    }

    /// The name of the source with this index (from 0) in messages.
    pub(super) fn source_label(&self, index: usize) -> String {
        let name = self.sources.get(index).and_then(|s| s.name.as_deref());
        label("source", index, self.sources.len(), name)
    }

    /// The name of the listener with this index (from 0) in messages.
    pub(super) fn listener_label(&self, index: usize) -> String {
        let name = self.listeners.get(index).and_then(|l| l.name.as_deref());
        label("listener", index, self.listeners.len(), name)
    }

    /// The material of a surface (counted from 0), or of one of its walls in the order of
    /// [`Room::WALL_NAMES`](super::shape::Room::WALL_NAMES), or of one of the groups of a mesh. A wall without its own material has the material of the
    /// surface. `None` if neither has a material: all energy is reflected.
    pub fn material(&self, surface: usize, wall: Option<usize>) -> Option<Material> {
        let surface = self.surfaces.get(surface)?;
        // A group of faces has the material of its own name, if no other is stated.
        let group = wall.and_then(|group| surface.group_name(group));
        let own = group.filter(|group| !surface.faces.contains_key(*group));
        let own = own.and_then(|group| self.material_named(group));
        own.or_else(|| self.material_named(surface.material_name(wall)?))
    }

    /// The material of this name: the scene's own material, otherwise the built-in material with the scattering of the
    /// scene.
    ///
    /// ```
    /// let mut corner = echomarch::Scene::builtin("corner")?;
    /// corner.scattering = [0.1; 8];
    /// let brick = corner.material_named("brick");
    /// assert!(brick.is_some_and(|brick| brick.scattering == [0.1; 8]));
    /// # Ok::<(), echomarch::Error>(())
    /// ```
    pub fn material_named(&self, name: &str) -> Option<Material> {
        let own = self.materials.get(name).copied();
        own.or_else(|| Some(Material::builtin(name)?.scattering_by(self.scattering)))
    }

    /// The material of this name, or an error message that suggests similar names.
    pub(super) fn find_material(&self, name: &str) -> Result<Material, String> {
        self.material_named(name).ok_or_else(|| {
            let mut all: Vec<&str> = self.materials.keys().map(String::as_str).collect();
            let built_in = Material::BUILTIN.iter().map(|known| known.name);
            all.extend(built_in.filter(|name| !self.materials.contains_key(*name)));
            nearest_or_all(&format!("there is no material {name:?}"), name, &all)
        })
    }

    /// Whether any surface absorbs or scatters. Otherwise every reflection is specular and keeps all energy.
    pub fn has_materials(&self) -> bool {
        self.used_materials().any(|material| !material.is_mirror())
    }

    /// Whether any surface scatters.
    pub(crate) fn scatters(&self) -> bool {
        let mut materials = self.used_materials();
        materials.any(|material| material.scatters(0..BAND_COUNT))
    }

    /// Whether a material, a solid that transmits sound, the air or a directivity changes the timbre. Otherwise all octave
    /// bands are equal, except for sound that bends around obstacles.
    pub fn has_bands(&self) -> bool {
        let changes = |material: Material| !material.is_grey() || material.transmission.is_some();
        let mut sources = self.sources.iter();
        self.air.is_some()
            || self.used_materials().any(changes)
            || sources.any(|source| !source.directivity.is_grey())
    }

    /// The materials of all surfaces and walls, with repetitions.
    fn used_materials(&self) -> impl Iterator<Item = Material> {
        let names = self.surfaces.iter().flat_map(|s| s.material_names());
        let named = names.filter_map(|name| self.material_named(name));
        let surfaces = self.surfaces.iter().enumerate();
        let meshes = surfaces.filter(|(_, surface)| surface.shape.mesh().is_some());
        let groups = meshes.flat_map(move |(index, surface)| {
            (0..surface.part_count()).filter_map(move |group| self.material(index, Some(group)))
        });
        named.chain(groups)
    }

    /// Speed of sound in metres per second: of the scene's air, or 343 without air.
    pub fn speed_of_sound(&self) -> f64 {
        self.air
            .map_or(Air::USUAL_SPEED_OF_SOUND, |air| air.speed_of_sound())
    }

    /// Attenuation coefficient of the air by octave band, in 1/m (see [`Air::attenuation`](super::Air::attenuation)); 0
    /// without air.
    pub fn air_attenuation(&self) -> Bands {
        self.air.map_or([0.0; BAND_COUNT], |air| air.attenuation())
    }
}

fn label(what: &str, index: usize, count: usize, name: Option<&str>) -> String {
    match (name, count) {
        (None, 1) => format!("the {what}"),
        (None, _) => format!("{what} {}", index + 1),
        (Some(name), 1) => format!("the {what} ({name})"),
        (Some(name), _) => format!("{what} {} ({name})", index + 1),
    }
}

fn labels<'a>(names: impl Iterator<Item = Option<&'a str>>) -> Vec<String> {
    let label = |(index, name): (usize, Option<&str>)| match name {
        Some(name) => name.to_owned(),
        None => (index + 1).to_string(),
    };
    names.enumerate().map(label).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::lattice;
    use crate::scene::shape::{Room, Sphere};
    use crate::scene::{Air, Key, Surface, Transmission};
    use glam::{EulerRot, Quat};
    use std::f32::consts::FRAC_PI_2;

    /// Protects the signs of yaw and pitch: right and up are positive.
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

    /// Protects the directivity of a source that a simulator turns: its axes are those of the quaternion, also with a
    /// roll and straight up.
    #[test]
    fn a_quaternion_turns_all_axes_of_a_source() {
        for [yaw, pitch, roll] in [
            [0.0, 0.0, 0.7],
            [0.7, -0.4, -2.5],
            [-2.9, 1.2, 3.0],
            [1.0, FRAC_PI_2, 0.4],
            [0.3, -FRAC_PI_2, -1.4],
        ] {
            let turn = Quat::from_euler(EulerRot::YXZ, yaw, pitch, roll);
            let mut source = Source::at(Vec3::ZERO);
            source.orient(turn.as_dquat());
            for (found, own) in [
                (source.forward(), Vec3::NEG_Z),
                (source.right(), Vec3::X),
                (source.up(), Vec3::Y),
            ] {
                let off = found.distance(turn * own);
                assert!(off < 1e-3, "{yaw} {pitch} {roll}, {own}: {off}");
            }
        }
    }

    /// Protects the import of orientations from other programs. A quaternion of yaw and pitch gives the same viewing
    /// direction and ears as the two angles, also straight up and at any length. A tilted head is rejected.
    #[test]
    fn a_quaternion_turns_a_listener_unless_it_tilts_the_head() {
        let of = |turn: Quat| Listener::at([0.0; 3], 0.2).with_orientation(turn);
        for (yaw, pitch) in [
            (0.0, 0.0),
            (0.7, -0.4),
            (-2.9, 1.2),
            (3.1, 0.1),
            (1.0, FRAC_PI_2),
            (-2.0, -FRAC_PI_2),
        ] {
            let mut expected = Listener::at(Vec3::ZERO, 0.2);
            (expected.yaw, expected.pitch) = (yaw, pitch);
            // The yaw of a listener is positive to the right, a rotation about +y is positive to the left.
            let turn = Quat::from_euler(EulerRot::YXZ, -yaw, pitch, 0.0);
            for turn in [turn, -turn, turn * 40.0] {
                let turned = of(turn).unwrap();
                let off = turned.forward().distance(expected.forward());
                assert!(off < 1e-3, "{yaw}, {pitch}: {turned:?}");
                let off = turned.right().distance(expected.right());
                assert!(off < 1e-3, "{yaw}, {pitch}: {turned:?}");
            }
            for roll in [0.01, -0.5, 3.1] {
                let turn = Quat::from_euler(EulerRot::YXZ, -yaw, pitch, roll);
                let is_vertical = pitch.abs() == FRAC_PI_2;
                match of(turn) {
                    Err(SceneError::RolledListener { roll_deg }) => {
                        let sign = roll_deg.to_radians() + roll;
                        assert!(!is_vertical && sign.abs() < 1e-3, "{roll_deg}, {roll}");
                    }
                    other => assert!(is_vertical && other.is_ok(), "{other:?}"),
                }
            }
        }
        for bad in [[0.0; 4], [f32::NAN, 0.0, 0.0, 1.0]] {
            let refused = Listener::at([0.0; 3], 0.2).with_orientation(bad);
            assert!(matches!(refused, Err(SceneError::NoOrientation { .. })));
        }
    }

    /// Protects orientations: turning the source equals turning the direction, and without a turn the source points
    /// along −z.
    #[test]
    fn a_source_points_where_it_is_turned() {
        let mut source = Source::at([1.0, 2.0, 3.0]);
        source.directivity = Directivity::CARDIOID;
        assert!((source.factor(DVec3::NEG_Z)[0] - 3.0).abs() < 1e-12);
        (source.yaw, source.pitch) = (0.7, -0.4);
        let turn = DQuat::from_rotation_y(-0.7) * DQuat::from_rotation_x(-0.4);
        for direction in lattice(200) {
            let mut plain = source.clone();
            (plain.yaw, plain.pitch) = (0.0, 0.0);
            let (turned, plain) = (source.factor(turn * direction), plain.factor(direction));
            assert!((turned[5] - plain[5]).abs() < 1e-5, "{direction}");
        }
        assert_eq!(source.factor(DVec3::ZERO), bands::ALL);
    }

    /// Protects viewing directions given by a vector: any length is accepted, and a direction straight up keeps the
    /// yaw.
    #[test]
    fn a_listener_looks_along_a_direction() {
        let mut listener = Listener::at([1.0, 2.0, 3.0], 0.2);
        listener.yaw = 0.5;
        for way in [Vec3::X, Vec3::NEG_Z, Vec3::new(-3.0, 4.0, 1e-3), Vec3::Y] {
            let looking = listener.clone().looking_along(20.0 * way).unwrap();
            assert!(looking.forward().distance(way.normalize()) < 1e-6, "{way}");
        }
        let up = listener.clone().looking_along(Vec3::NEG_Y).unwrap();
        assert_eq!((up.yaw, up.pitch), (0.5, -FRAC_PI_2));
        for bad in [Vec3::ZERO, Vec3::NAN, Vec3::new(f32::INFINITY, 0.0, 0.0)] {
            let refused = listener.clone().looking_along(bad);
            assert!(matches!(refused, Err(SceneError::NoOrientation { .. })));
        }
    }

    fn hall() -> Scene {
        let room = Surface::new(Room {
            size: Vec3::splat(9.0),
        });
        let room = room.with_material("brick").with_wall_material(2, "carpet");
        let room = room.unwrap();
        let ball = Surface::new(Sphere { radius: 1.0 });
        let source = Source::at(Vec3::X * 3.0);
        Scene::new(
            "hall",
            vec![room, ball],
            source,
            Listener::at(Vec3::Y * 3.0, 0.3),
        )
    }

    /// Protects the order of the material lookup: the wall before the surface, the scene's own material before the
    /// built-in material.
    #[test]
    fn a_wall_comes_before_its_surface_and_a_scene_before_the_list() {
        let mut scene = hall();
        let known = |name| Material::builtin(name).copied();
        assert_eq!(scene.material(0, None), known("brick"));
        assert_eq!(scene.material(0, Some(2)), known("carpet"));
        assert_eq!(scene.material(0, Some(3)), known("brick"));
        assert_eq!(scene.material(1, None), None);
        assert_eq!(scene.material(2, None), None);
        let own = Material::absorbing(0.9);
        scene.materials.insert("brick".into(), own);
        assert_eq!(scene.material(0, Some(3)), Some(own));
        assert!(scene.has_materials() && scene.has_bands());
        scene.surfaces.remove(0);
        assert!(!scene.has_materials() && !scene.has_bands());
        scene.surfaces[0].material = Some("mirror".into());
        scene.materials.insert("mirror".into(), Material::MIRROR);
        assert!(!scene.has_materials());
        scene.materials.insert("mirror".into(), own);
        assert!(scene.has_materials() && !scene.has_bands());
        // A wall passes low bands better than high ones, even if it absorbs all bands equally.
        let wall = own.transmitting(Transmission::of_density(20.0));
        scene.materials.insert("mirror".into(), wall);
        assert!(scene.has_bands());
    }

    /// Protects motion: every source or listener with a path moves, and the longest path is the scene's duration.
    #[test]
    fn all_sources_and_listeners_follow_their_paths() {
        let mut scene = hall();
        let key = |time, x| Key {
            time,
            position: Vec3::X * x,
            yaw: x,
            pitch: 0.0,
        };
        let path = |seconds| Path::new(vec![key(0.0, 0.0), key(seconds, 4.0)]).unwrap();
        let mut source = Source::at(Vec3::ZERO);
        source.path = path(2.0);
        let mut listener = Listener::at(Vec3::ZERO, 0.2);
        listener.path = path(8.0);
        scene.sources.push(source);
        scene.listeners.push(listener);
        assert_eq!(scene.duration(), 8.0);
        let posed = scene.at(1.0);
        assert_eq!(posed.sources[1].position.x, 2.0);
        let listener = &posed.listeners[1];
        assert_eq!((listener.position.x, listener.yaw), (0.5, 0.5));
    }

    /// Protects scenes without air: the speed of sound is 343 m/s, and there is no attenuation.
    #[test]
    fn without_air_nothing_is_lost() {
        let mut scene = hall();
        assert_eq!(scene.speed_of_sound(), 343.0);
        assert_eq!(scene.air_attenuation(), [0.0; 8]);
        let air = Air {
            temperature: 30.0,
            ..Air::default()
        };
        scene.air = Some(air);
        assert_eq!(scene.speed_of_sound(), air.speed_of_sound());
        assert_eq!(scene.air_attenuation(), air.attenuation());
    }

    /// Protects callers from a wall index out of range.
    #[test]
    fn numbers_that_nobody_has_are_refused() {
        let room = Surface::new(Room { size: Vec3::ONE });
        for wall in [6, 9, usize::MAX] {
            let refused = room.clone().with_wall_material(wall, "brick");
            assert!(matches!(refused, Err(SceneError::NoSuchWall { .. })));
        }
    }
}
