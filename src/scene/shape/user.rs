//! A user's field as a shape.

use super::asset::{Asset, UserField};
use super::cuboid::box_value;
use super::part::{LARGEST, Notation, Numbers, Parameter, arguments, parameters};
use super::{Bounds3, Part, Properties, Shape};
use crate::scene::notation::{Fields, Lipschitz, MostBend, Reader, Size, Written};
use crate::scene::{Quantity, SceneError};
use glam::DVec3;
use serde::Deserialize;
use std::sync::Arc;

/// A user's GLSL function `float field(vec3 p)` within a box centred on the origin: `Field` in scene files.
#[derive(Clone, Debug, PartialEq)]
pub struct User {
    /// The text with its stated properties.
    pub field: Arc<UserField>,
}

/// The notation in a scene file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct File {
    file: String,
    lipschitz: Lipschitz,
    #[serde(default)]
    bend: Option<MostBend>,
    size: Size,
}

impl Notation for User {
    type File = File;

    fn read(file: File, reader: &mut Reader) -> Result<Shape, SceneError> {
        let (size, lipschitz) = (file.size.0, file.lipschitz.0);
        let bend = file.bend.map(|bend| bend.0);
        let field = reader.files().field(&file.file, size, lipschitz, bend)?;
        Ok(Shape::from(User { field }))
    }
}

parameters!(User {});

impl Part for User {
    fn asset(&self) -> Option<Asset<'_>> {
        Some(Asset::User(&self.field))
    }

    fn words(&self) -> Fields {
        let UserField {
            file,
            size,
            lipschitz,
            bend,
            ..
        } = &*self.field;
        let size = size.to_array().map(Written::Number);
        let mut words = vec![
            ("file", Written::Text(file.display().to_string())),
            ("lipschitz", Written::Number(*lipschitz)),
        ];
        words.extend(bend.map(|bend| ("bend", Written::Number(bend))));
        words.push(("size", Written::Tuple(size.to_vec())));
        words
    }

    fn check(&self) -> Result<(), String> {
        let mut size = self.field.size;
        let mut sides = Vec::new();
        size.add_to("size", Quantity::Length, &mut sides);
        sides.iter().try_for_each(Parameter::check)?;
        let UserField {
            lipschitz, bend, ..
        } = &*self.field;
        if !(1e-3..=1e6).contains(lipschitz) {
            let why = format!("its lipschitz must be 0.001 to 1e6, not {lipschitz}");
            return Err(why);
        }
        match bend.filter(|bend| !(0.0..=LARGEST).contains(bend)) {
            Some(bend) => Err(format!("its bend must be 0 to 1e9 per metre, not {bend}")),
            None => Ok(()),
        }
    }

    fn properties(&self, _: &[Shape]) -> Properties {
        Properties {
            symmetric: [false; 3],
            ..Properties::bound(Bounds3::centred(self.half_size()))
        }
    }

    fn value(&self, _: &[Shape], p: DVec3) -> f64 {
        let value = self.field.value(p) / f64::from(self.field.lipschitz);
        value.max(box_value(p, self.half_size()))
    }

    fn shader_numbers(&self, _: &[Shape]) -> Vec<f64> {
        let half = self.half_size();
        let inverse_lipschitz = 1.0 / f64::from(self.field.lipschitz);
        vec![half.x, half.y, half.z, inverse_lipschitz]
    }

    arguments!(3, 1);
}

impl User {
    /// A constant K in 1/m: along any straight line in the box, the second derivative of [`Shape::value`] is at least
    /// −K wherever waves can be (in all air of the field, and in the solid near its surface). It is the stated bend
    /// divided by the Lipschitz constant. The cut at the box does not increase it, because the value of a box is
    /// convex. It is not valid across a face of the box, where the value becomes constant, and not outside the box.
    pub fn bend(&self) -> Option<f64> {
        let bend = self.field.bend?;
        Some(f64::from(bend) / f64::from(self.field.lipschitz))
    }

    fn half_size(&self) -> DVec3 {
        0.5 * self.field.size.as_dvec3()
    }
}
