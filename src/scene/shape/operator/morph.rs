//! A blend between two fields.

use super::part::parameters;
use super::{Part, Properties, Shape, ShapeFile, hull, merged};
use crate::scene::notation::{Fields, Number, Reader, Share, Written};
use crate::scene::shape::{FromFile, Operands};
use crate::scene::{Quantity, SceneError};
use glam::DVec3;
use serde::Deserialize;

/// A blend between two fields: the first at 0, the second at 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Morph {
    /// 0 to 1.
    pub amount: f32,
}

/// Its form in a scene file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct File {
    from: Box<ShapeFile>,
    to: Box<ShapeFile>,
    amount: Number<Share>,
}

impl FromFile for File {
    fn read(self, reader: &mut Reader) -> Result<Shape, SceneError> {
        let amount = reader.number("amount", self.amount);
        let both = vec![*self.from, *self.to];
        Ok(Shape::over(Morph { amount }, both.read(reader)?))
    }
}

parameters!(Morph over (2, 2) {
    amount: Quantity::Share
});

impl Part for Morph {
    fn written_children(&self, children: Vec<Written>) -> Fields {
        ["from", "to"].into_iter().zip(children).collect()
    }

    fn properties(&self, children: &[Shape]) -> Properties {
        let of: Vec<Properties> = children.iter().map(Shape::properties).collect();
        merged(&of, hull(&of))
    }

    fn value(&self, children: &[Shape], p: DVec3) -> f64 {
        let (from, to) = (children[0].value(p), children[1].value(p));
        from + (to - from) * f64::from(self.amount)
    }

    fn shader_numbers(&self, _: &[Shape]) -> Vec<f64> {
        vec![self.amount.into()]
    }
}
