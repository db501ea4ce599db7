//! A child turned.

use super::part::{numbers, slowest};
use super::{Exactness, Part, Properties, Shape, ShapeFile, SurfaceKind};
use glam::{DMat3, DVec3, EulerRot, Vec3};

numbers! {
    /// Its child turned about the origin.
    Rotate over (of: Box<ShapeFile>) {
        /// Right-handed turns in radians about x, then y, then z of the outer axes.
        by: Vec3 as Angle,
    }
}

impl Part for Rotate {
    fn surface_kind(&self) -> SurfaceKind {
        SurfaceKind::MOVED
    }

    fn properties(&self, children: &[Shape]) -> Properties {
        let of = children[0].properties();
        Properties {
            bounds: of.bounds.turned(self.matrix()),
            symmetric: [false; 3],
            ..of
        }
    }

    /// When a box grows along its axes, a corner moves by √3 of that.
    fn slowness(&self, children: &[Shape]) -> f64 {
        match children[0].properties().in_air {
            Exactness::Exact => slowest(children),
            _ => 3f64.sqrt() * slowest(children),
        }
    }

    fn value(&self, children: &[Shape], p: DVec3) -> f64 {
        children[0].value(self.matrix().transpose() * p)
    }

    /// The matrix to the inner axes from the outer ones, column by column.
    fn shader_numbers(&self, _: &[Shape]) -> Vec<f64> {
        self.matrix().transpose().to_cols_array().to_vec()
    }
}

impl Rotate {
    /// The matrix to the outer axes from the inner ones.
    pub(crate) fn matrix(&self) -> DMat3 {
        let by = self.by.as_dvec3();
        DMat3::from_euler(EulerRot::XYZEx, by.x, by.y, by.z)
    }
}
