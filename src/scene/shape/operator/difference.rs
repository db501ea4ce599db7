//! The difference.

use super::part::parameters;
use super::{Part, Properties, Shape, ShapeFile, SurfaceKind, merged};
use crate::scene::SceneError;
use crate::scene::notation::{Fields, Reader, Written};
use crate::scene::shape::{FromFile, Operands};
use glam::DVec3;
use serde::Deserialize;

/// The first of its children minus all the others.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference;

/// Its form in a scene file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct File {
    from: Box<ShapeFile>,
    cut: Vec<ShapeFile>,
}

impl FromFile for File {
    fn read(self, reader: &mut Reader) -> Result<Shape, SceneError> {
        let mut all = vec![*self.from];
        all.extend(self.cut);
        Ok(Shape::over(Difference, all.read(reader)?))
    }
}

parameters!(Difference over (2, usize::MAX) {});

impl Part for Difference {
    fn surface_kind(&self) -> SurfaceKind {
        SurfaceKind::FLAT
    }

    fn written_children(&self, mut children: Vec<Written>) -> Fields {
        let cut = children.split_off(children.len().min(1));
        let from = children.pop().map(|from| ("from", from));
        from.into_iter()
            .chain([("cut", Written::List(cut))])
            .collect()
    }

    fn properties(&self, children: &[Shape]) -> Properties {
        let of: Vec<Properties> = children.iter().map(Shape::properties).collect();
        merged(&of, of[0].bounds)
    }

    fn value(&self, children: &[Shape], p: DVec3) -> f64 {
        let cut = children[1..].iter().map(|child| -child.value(p));
        cut.fold(children[0].value(p), f64::max)
    }
}
