//! A child scaled.

use super::part::numbers;
use super::{Part, Properties, Shape, ShapeFile, SurfaceKind};
use glam::DVec3;

numbers! {
    /// Its child scaled about the origin.
    Scale over (of: Box<ShapeFile>) {
        /// Factor, greater than 0.
        by: f32 as Factor,
    }
}

impl Part for Scale {
    fn surface_kind(&self) -> SurfaceKind {
        SurfaceKind::MOVED
    }

    fn properties(&self, children: &[Shape]) -> Properties {
        let of = children[0].properties();
        Properties {
            bounds: of.bounds.scaled(self.by.into()),
            ..of
        }
    }

    fn value(&self, children: &[Shape], p: DVec3) -> f64 {
        let by = f64::from(self.by);
        children[0].value(p / by) * by
    }

    fn shader_numbers(&self, _: &[Shape]) -> Vec<f64> {
        vec![self.by.into()]
    }
}
