//! Distances sampled on a grid as a shape.

use super::asset::Asset;
use super::cuboid::box_value;
use super::part::{LARGEST, Notation, arguments, parameters};
use super::sampled_field::SampledField;
use super::{Bounds3, Part, Properties, Shape};
use crate::scene::SceneError;
use crate::scene::notation::{Fields, Reader, Written};
use glam::DVec3;
use serde::Deserialize;
use std::sync::Arc;

/// Distances sampled on a grid, within the box of the samples, which is centred on the origin. The solid ends at the
/// box.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// The samples.
    pub field: Arc<SampledField>,
}

/// The notation in a scene file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct File {
    file: String,
    cell: f32,
}

impl Notation for Grid {
    type File = File;

    fn read(file: File, reader: &mut Reader) -> Result<Shape, SceneError> {
        let field = reader.files().samples(&file.file, file.cell)?;
        Ok(Shape::from(Grid { field }))
    }
}

parameters!(Grid {});

impl Part for Grid {
    fn asset(&self) -> Option<Asset<'_>> {
        Some(Asset::Samples(&self.field))
    }

    fn words(&self) -> Fields {
        vec![
            ("file", Written::Text(self.field.name().to_owned())),
            ("cell", Written::Number(self.field.cell())),
        ]
    }

    fn check(&self) -> Result<(), String> {
        let longest = 2.0 * self.field.half_size().max_element();
        match longest <= f64::from(LARGEST) {
            true => Ok(()),
            false => Err(format!(
                "its longest side must be at most 1e9 m, not {longest:e} m"
            )),
        }
    }

    fn properties(&self, _: &[Shape]) -> Properties {
        Properties {
            symmetric: [false; 3],
            ..Properties::bound(Bounds3::centred(self.field.half_size()))
                .growing(self.field.lipschitz())
        }
    }

    fn value(&self, _: &[Shape], p: DVec3) -> f64 {
        self.field.at(p).max(box_value(p, self.field.half_size()))
    }

    /// Half the size.
    fn shader_numbers(&self, _: &[Shape]) -> Vec<f64> {
        self.field.half_size().to_array().to_vec()
    }

    arguments!(3);
}
