//! Terrain with heights from an image.

use super::asset::Asset;
use super::cuboid::box_value;
use super::part::{Notation, arguments, parameters};
use super::{Bounds3, HeightImage, Part, Properties, Shape};
use crate::scene::SceneError;
use crate::scene::notation::{Fields, ReadNumbers, Reader, Side, Vector, Written};
use glam::{DVec2, DVec3, Vec3};
use serde::Deserialize;
use std::sync::Arc;

/// Terrain with heights from an image. It is solid below the surface, and fills a box centred on the origin. Black is
/// at the floor of the box, white at its ceiling.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightField {
    /// The heights.
    pub image: Arc<HeightImage>,
    /// Full width, height and depth of the box in metres. The image spans width and depth.
    pub size: Vec3,
}

/// The notation in a scene file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct File {
    image: String,
    size: Vector<Side>,
}

impl Notation for HeightField {
    type File = File;

    fn read(file: File, reader: &mut Reader) -> Result<Shape, SceneError> {
        let image = reader.files().heights(&file.image)?;
        let size = Vec3::read(file.size, "size", reader);
        Ok(Shape::from(HeightField { image, size }))
    }
}

parameters!(HeightField {
    size: Quantity::Length
});

impl Part for HeightField {
    fn asset(&self) -> Option<Asset<'_>> {
        Some(Asset::Image(&self.image))
    }

    fn words(&self) -> Fields {
        vec![("image", Written::Text(self.image.name().to_owned()))]
    }

    fn properties(&self, _: &[Shape]) -> Properties {
        Properties {
            symmetric: [false; 3],
            ..Properties::bound(Bounds3::centred(0.5 * self.size.as_dvec3()))
        }
    }

    fn value(&self, _: &[Shape], p: DVec3) -> f64 {
        let size = self.size.as_dvec3();
        let held = p.clamp(-0.5 * size, 0.5 * size);
        let at = DVec2::new(held.x / size.x + 0.5, held.z / size.z + 0.5);
        let ground = size.y * (self.image.at(at) - 0.5);
        let above = (held.y - ground) * self.slowest();
        above.max(box_value(p, 0.5 * size))
    }

    /// Half the size, and the factor that scales the height above the terrain.
    fn shader_numbers(&self, _: &[Shape]) -> Vec<f64> {
        let half = 0.5 * self.size.as_dvec3();
        vec![half.x, half.y, half.z, self.slowest()]
    }

    arguments!(3, 1);
}

impl HeightField {
    /// The factor that converts the height above the terrain to a lower bound of the distance: the cosine of the
    /// steepest slope.
    fn slowest(&self) -> f64 {
        let flat = DVec2::new(self.size.x.into(), self.size.z.into());
        let slope = f64::from(self.size.y) * self.image.steepest(flat);
        1.0 / 1f64.hypot(slope)
    }
}
