//! A surface moved along its normals.

use super::part::{numbers, slowest};
use super::{Exactness, Part, Properties, Shape, ShapeFile};
use glam::DVec3;

numbers! {
    /// Its child grown (or shrunk) by a length.
    Offset over (of: Box<ShapeFile>) {
        /// Metres outwards.
        by: f32 as Metres,
    }
}

impl Part for Offset {
    /// The surface moves towards one side; on that side exact distances stay exact. With exact
    /// distances a convex solid stays convex; the levels of a bound need not be convex.
    fn properties(&self, children: &[Shape]) -> Properties {
        let of = children[0].properties();
        let by = f64::from(self.by);
        let (in_air, in_solid) = match by >= 0.0 {
            true => (of.in_air, of.in_solid.or_bound()),
            false => (of.in_air.or_bound(), of.in_solid),
        };
        let stays_convex = match by {
            by if by > 0.0 => of.in_air == Exactness::Exact,
            by if by < 0.0 => of.in_solid == Exactness::Exact,
            _ => true,
        };
        let reach = slowest(children) * by.max(0.0);
        Properties {
            in_air,
            in_solid,
            bounds: of.bounds.grown(DVec3::splat(reach)),
            convex: of.convex && stays_convex,
            ..of
        }
    }

    fn own_length(&self) -> f64 {
        self.by.abs().into()
    }

    fn value(&self, children: &[Shape], p: DVec3) -> f64 {
        children[0].value(p) - f64::from(self.by)
    }

    fn shader_numbers(&self, _: &[Shape]) -> Vec<f64> {
        vec![self.by.into()]
    }
}
