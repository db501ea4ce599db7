//! An infinite cylinder, and the form of all cylinders in a scene file.

use super::part::parameters;
use super::{CappedCylinder, Part, Properties, Rotate, Shape, SurfaceKind};
use crate::scene::notation::{Axis, Length, Number, Radius, Reader};
use crate::scene::shape::FromFile;
use crate::scene::{Quantity, SceneError};
use glam::{DVec2, DVec3, Vec3};
use serde::Deserialize;

/// A solid infinite cylinder about y.
#[derive(Clone, Debug, PartialEq)]
pub struct Cylinder {
    /// Radius in metres.
    pub radius: f32,
}

/// Its form in a scene file: with a height it is finite, with an axis it is turned.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct File {
    radius: Number<Radius>,
    #[serde(default)]
    height: Option<Number<Length>>,
    #[serde(default)]
    axis: Axis,
}

impl FromFile for File {
    fn read(self, reader: &mut Reader) -> Result<Shape, SceneError> {
        let Axis(axis) = self.axis;
        if axis == Vec3::Y {
            return Ok(upright(self.radius, self.height, reader));
        }
        let shape = reader.within(0, |reader| Ok(upright(self.radius, self.height, reader)))?;
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

/// The angles about x, then y, that turn the y axis into a unit vector.
fn turn_from_y(axis: Vec3) -> Vec3 {
    let about_x = axis.x.hypot(axis.z).atan2(axis.y);
    let about_y = axis.x.atan2(axis.z);
    Vec3::new(about_x, about_y, 0.0)
}

parameters!(Cylinder {
    radius: Quantity::Length
});

impl Part for Cylinder {
    fn is_basic(&self) -> bool {
        true
    }

    fn surface_kind(&self) -> SurfaceKind {
        SurfaceKind::SMOOTH
    }

    fn properties(&self, _: &[Shape]) -> Properties {
        Properties::round(self.radius, f64::INFINITY)
    }

    fn own_length(&self) -> f64 {
        self.radius.into()
    }

    fn value(&self, _: &[Shape], p: DVec3) -> f64 {
        DVec2::new(p.x, p.z).length() - f64::from(self.radius)
    }

    fn shader_numbers(&self, _: &[Shape]) -> Vec<f64> {
        vec![self.radius.into()]
    }
}
