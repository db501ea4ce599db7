//! An infinite cylinder, and a cylinder with plane ends. Both are called `Cylinder` in scene files.

use super::part::{Notation, half, parameters, surface_kind};
use super::{Part, Properties, Rotate, Shape};
use crate::scene::SceneError;
use crate::scene::notation::{Length, Number, Radius, Reader, checked};
use glam::{DVec2, DVec3, Vec3};
use serde::Deserialize;

/// A solid infinite cylinder about the y axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Cylinder {
    /// Radius in metres.
    pub radius: f32,
}

/// The notation in a scene file. The cylinder is finite if it has a height, and rotated if it has an axis.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct File {
    radius: Number<Radius>,
    #[serde(default)]
    height: Option<Number<Length>>,
    #[serde(default)]
    axis: Axis,
}

checked! {
    /// Unit vector along a cylinder.
    Axis(Vec3) from AxisSaid: unit_vector;
}

#[derive(Deserialize)]
#[serde(
    untagged,
    expecting = "an axis must be X, Y, Z or a vector (x, y, z) of plain numbers"
)]
enum AxisSaid {
    Letter(Letter),
    Vector(f32, f32, f32),
}

#[derive(Deserialize)]
enum Letter {
    X,
    Y,
    Z,
}

impl Default for Axis {
    fn default() -> Axis {
        Axis(Vec3::Y)
    }
}

fn unit_vector(said: AxisSaid) -> Result<Vec3, String> {
    let vector = match said {
        AxisSaid::Letter(Letter::X) => Vec3::X,
        AxisSaid::Letter(Letter::Y) => Vec3::Y,
        AxisSaid::Letter(Letter::Z) => Vec3::Z,
        AxisSaid::Vector(x, y, z) => Vec3::new(x, y, z),
    };
    let axis = vector.try_normalize();
    axis.ok_or_else(|| format!("an axis must be finite and not of length 0, as {vector} is"))
}

impl Notation for Cylinder {
    type File = File;

    fn read(file: File, reader: &mut Reader) -> Result<Shape, SceneError> {
        let Axis(axis) = file.axis;
        if axis == Vec3::Y {
            return Ok(upright(file.radius, file.height, reader));
        }
        let shape = reader.within(0, |reader| Ok(upright(file.radius, file.height, reader)))?;
        let by = turn_from_y(axis);
        Ok(Shape::over(Rotate { by }, [shape]))
    }
}

fn upright(radius: Number<Radius>, height: Option<Number<Length>>, reader: &mut Reader) -> Shape {
    let radius = reader.number("radius", radius);
    match height {
        None => Shape::from(Cylinder { radius }),
        Some(height) => {
            let height = reader.number("height", height);
            Shape::from(CappedCylinder { radius, height })
        }
    }
}

/// The rotation angles about x, then y, that rotate the y axis to a unit vector.
fn turn_from_y(axis: Vec3) -> Vec3 {
    let about_x = axis.x.hypot(axis.z).atan2(axis.y);
    let about_y = axis.x.atan2(axis.z);
    Vec3::new(about_x, about_y, 0.0)
}

parameters!(Cylinder {
    radius: Quantity::Length
});

impl Part for Cylinder {
    surface_kind!(SMOOTH);

    fn properties(&self, _: &[Shape]) -> Properties {
        Properties::round(self.radius, f64::INFINITY)
    }

    fn own_length(&self) -> f64 {
        self.radius.into()
    }

    fn value(&self, _: &[Shape], p: DVec3) -> f64 {
        DVec2::new(p.x, p.z).length() - f64::from(self.radius)
    }
}

/// A finite cylinder about the y axis.
#[derive(Clone, Debug, PartialEq)]
pub struct CappedCylinder {
    /// Radius in metres.
    pub radius: f32,
    /// Full height in metres.
    pub height: f32,
}

parameters!(CappedCylinder {
    radius: Quantity::Length,
    height: Quantity::Length
});

impl Part for CappedCylinder {
    fn properties(&self, _: &[Shape]) -> Properties {
        Properties::round(self.radius, half(self.height))
    }

    fn value(&self, _: &[Shape], p: DVec3) -> f64 {
        let ring = DVec2::new(p.x, p.z).length() - f64::from(self.radius);
        corner_value(DVec2::new(ring, p.y.abs() - half(self.height)))
    }

    fn shader_numbers(&self, _: &[Shape]) -> Vec<f64> {
        vec![self.radius.into(), half(self.height)]
    }
}

/// The signed distance to a quarter plane. `beyond` contains the signed distances to the lines of its two edges.
pub(super) fn corner_value(beyond: DVec2) -> f64 {
    beyond.max(DVec2::ZERO).length() + beyond.max_element().min(0.0)
}
