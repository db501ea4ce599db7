//! A child moved.

use super::part::numbers;
use super::{Part, Properties, Shape, ShapeFile, SurfaceKind};
use glam::{DVec3, Vec3};

numbers! {
    /// Its child moved.
    Translate over (of: Box<ShapeFile>) {
        /// Metres along x, y and z.
        by: Vec3 as Metres,
    }
}

impl Part for Translate {
    fn surface_kind(&self) -> SurfaceKind {
        SurfaceKind::MOVED
    }

    fn properties(&self, children: &[Shape]) -> Properties {
        let of = children[0].properties();
        Properties {
            bounds: of.bounds.moved(self.by.as_dvec3()),
            symmetric: [0, 1, 2].map(|axis| of.symmetric[axis] && self.by[axis] == 0.0),
            ..of
        }
    }

    fn own_length(&self) -> f64 {
        self.by.as_dvec3().abs().max_element()
    }

    fn value(&self, children: &[Shape], p: DVec3) -> f64 {
        children[0].value(p - self.by.as_dvec3())
    }

    fn shader_numbers(&self, _: &[Shape]) -> Vec<f64> {
        self.by.as_dvec3().to_array().to_vec()
    }
}
