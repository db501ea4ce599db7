//! The complement.

use super::part::no_numbers;
use super::{Bounds3, Part, Properties, Shape, ShapeFile, SurfaceKind};
use glam::DVec3;

no_numbers! {
    /// Air and solid exchanged.
    Complement over Box<ShapeFile>
}

impl Part for Complement {
    fn surface_kind(&self) -> SurfaceKind {
        SurfaceKind::TURNED_INSIDE_OUT
    }

    fn properties(&self, children: &[Shape]) -> Properties {
        let of = children[0].properties();
        Properties {
            in_air: of.in_solid,
            in_solid: of.in_air,
            bounds: Bounds3::EVERYWHERE,
            convex: false,
            ..of
        }
    }

    /// The complement of all space does not move.
    fn slowness(&self, _: &[Shape]) -> f64 {
        1.0
    }

    fn value(&self, children: &[Shape], p: DVec3) -> f64 {
        -children[0].value(p)
    }
}
