//! A triangle mesh as a shape.

use super::asset::Asset;
use super::part::{Notation, parameters, surface_kind};
use super::{Bounds3, Part, Properties, Shape};
use crate::scene::SceneError;
use crate::scene::mesh::{Inside, MeshOptions, TriangleMesh};
use crate::scene::notation::{Fields, Reader, Written};
use glam::DVec3;
use serde::Deserialize;
use std::sync::Arc;

/// A triangle mesh: solid or hollow, as its faces are oriented. It is a whole surface, and no operand of an operator.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// The faces.
    pub mesh: Arc<TriangleMesh>,
}

/// The notation in a scene file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct File {
    file: String,
    #[serde(default)]
    inside: Option<Inside>,
    #[serde(default)]
    scale: Option<f32>,
}

impl Notation for Mesh {
    type File = File;

    fn read(file: File, reader: &mut Reader) -> Result<Shape, SceneError> {
        let options = MeshOptions {
            inside: file.inside,
            scale: file.scale.unwrap_or(1.0),
        };
        let mesh = reader.files().mesh(&file.file, options)?;
        Ok(Shape::from(Mesh { mesh }))
    }
}

parameters!(Mesh {});

impl Part for Mesh {
    surface_kind!(FLAT);

    fn asset(&self) -> Option<Asset<'_>> {
        Some(Asset::Mesh(&self.mesh))
    }

    fn words(&self) -> Fields {
        let MeshOptions { inside, scale } = self.mesh.options();
        let mut words = vec![("file", Written::Text(self.mesh.name().to_owned()))];
        if let Some(inside) = inside {
            words.push(("inside", Written::Inside(inside)));
        }
        if scale != 1.0 {
            words.push(("scale", Written::Number(scale)));
        }
        words
    }

    /// The value is the distance. The solid around a room is unbounded.
    fn properties(&self, _: &[Shape]) -> Properties {
        let bounds = match self.mesh.report().is_hollow {
            true => Bounds3::EVERYWHERE,
            false => self.mesh.bounds(),
        };
        Properties {
            convex: false,
            symmetric: [false; 3],
            bounds,
            ..Properties::exact(DVec3::ZERO)
        }
    }

    fn own_length(&self) -> f64 {
        self.mesh.extent()
    }

    fn value(&self, _: &[Shape], p: DVec3) -> f64 {
        self.mesh.distance(p)
    }

    fn shader_numbers(&self, _: &[Shape]) -> Vec<f64> {
        Vec::new()
    }
}
