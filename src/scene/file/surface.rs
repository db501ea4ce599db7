//! One surface of a scene file.

use super::material::Walls;
use crate::scene::notation::{Angle, Attached, Metres, Name, ReadNumbers, Reader, Vector};
use crate::scene::shape::ShapeFile;
use crate::scene::{SceneError, Surface};
use glam::{EulerRot, Quat, Vec3};
use serde::Deserialize;

#[derive(Deserialize)]
#[serde(rename = "Surface", deny_unknown_fields)]
pub(super) struct SurfaceFile {
    #[serde(default)]
    name: Option<Name>,
    shape: ShapeFile,
    #[serde(default)]
    position: Vector<Metres>,
    /// Right-handed turns about x, then y, then z, of the world's axes.
    #[serde(default)]
    rotation: Vector<Angle>,
    #[serde(default)]
    turns: bool,
    #[serde(default)]
    material: Option<Name>,
    #[serde(default)]
    walls: Option<Walls<Name>>,
}

impl SurfaceFile {
    /// Converts the file's surface.
    ///
    /// # Errors
    /// Errors of the files that it names.
    pub fn read(self, files: &Attached) -> Result<Surface, SceneError> {
        let mut reader = Reader::new(files);
        let position = Vec3::read(self.position, "position", &mut reader);
        let angles = Vec3::read(self.rotation, "rotation", &mut reader);
        let turning = reader.moves("rotation.");
        let shape = self.shape.read(&mut reader)?;
        Ok(Surface {
            name: self.name.map(|name| name.0),
            shape,
            position,
            rotation: Quat::from_euler(EulerRot::XYZEx, angles.x, angles.y, angles.z),
            dynamic_rotation: self.turns || turning,
            angles: if turning { angles } else { Vec3::ZERO },
            drivers: reader.into_drivers(),
            material: self.material.map(|name| name.0),
            walls: self.walls.map(Walls::names).unwrap_or_default(),
        })
    }
}
