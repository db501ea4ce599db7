//! Mirror images across planes through the origin.

use super::part::parameters;
use super::{Part, Properties, Shape, ShapeFile, SurfaceKind};
use crate::scene::SceneError;
use crate::scene::notation::{Fields, MirrorAxes, Reader, Written};
use crate::scene::shape::{FromFile, Operands};
use glam::DVec3;
use serde::Deserialize;

/// The part on the positive side of some axes, mirrored to the other side.
#[derive(Clone, Debug, PartialEq)]
pub struct Mirror {
    /// Whether it is mirrored across x, y and z.
    pub axes: [bool; 3],
}

/// Its form in a scene file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct File {
    of: Box<ShapeFile>,
    axes: MirrorAxes,
}

impl FromFile for File {
    fn read(self, reader: &mut Reader) -> Result<Shape, SceneError> {
        let axes = self.axes.0;
        Ok(Shape::over(Mirror { axes }, self.of.read(reader)?))
    }
}

parameters!(Mirror over (1, 1) {});

impl Part for Mirror {
    fn surface_kind(&self) -> SurfaceKind {
        SurfaceKind::FLAT
    }

    fn copies(&self) -> bool {
        true
    }

    fn keeps_apart(&self, children: &[Shape]) -> bool {
        let of = children[0].properties();
        let apart = |axis: usize| of.symmetric[axis] || of.bounds.min[axis] > 0.0;
        (0..3).all(|axis| !self.axes[axis] || apart(axis))
    }

    fn words(&self) -> Fields {
        let letters = "xyz".chars().zip(self.axes);
        let letters = letters.filter_map(|(letter, is)| is.then_some(letter));
        vec![("axes", Written::Text(letters.collect()))]
    }

    fn properties(&self, children: &[Shape]) -> Properties {
        let of = children[0].properties();
        let mut result = of;
        result.convex = of.convex && self.axes == [false; 3];
        for axis in (0..3).filter(|&axis| self.axes[axis]) {
            result.symmetric[axis] = true;
            let far = of.bounds.max[axis];
            (result.bounds.min[axis], result.bounds.max[axis]) = (-far, far);
            if of.symmetric[axis] {
                continue;
            }
            // A solid that crosses the mirror is cut off there, but its distance is not.
            if of.bounds.min[axis] < 0.0 {
                result.in_air = result.in_air.or_bound();
            }
            // A solid that touches the mirror merges with its image: its face there vanishes.
            if of.bounds.min[axis] <= 0.0 {
                result.in_solid = result.in_solid.or_bound();
            }
        }
        result
    }

    fn value(&self, children: &[Shape], p: DVec3) -> f64 {
        let fold = |axis: usize| match self.axes[axis] {
            true => p[axis].abs(),
            false => p[axis],
        };
        children[0].value(DVec3::new(fold(0), fold(1), fold(2)))
    }
}
