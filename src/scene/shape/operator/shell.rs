//! A wall along a surface.

use super::part::{numbers, slowest};
use super::{Exactness, Part, Properties, Shape, ShapeFile};
use glam::DVec3;

numbers! {
    /// A wall along the surface of its child.
    Shell over (of: Box<ShapeFile>) {
        /// Full thickness in metres.
        thickness: f32 as Length,
    }
}

impl Part for Shell {
    fn properties(&self, children: &[Shape]) -> Properties {
        let of = children[0].properties();
        let reach = slowest(children) * self.half();
        Properties {
            in_air: Exactness::worst([of.in_air, of.in_solid].into_iter(), of.lipschitz),
            in_solid: Exactness::bound(of.lipschitz),
            bounds: of.bounds.grown(DVec3::splat(reach)),
            convex: false,
            ..of
        }
    }

    fn own_length(&self) -> f64 {
        self.thickness.into()
    }

    fn value(&self, children: &[Shape], p: DVec3) -> f64 {
        children[0].value(p).abs() - self.half()
    }

    fn shader_numbers(&self, _: &[Shape]) -> Vec<f64> {
        vec![self.half()]
    }
}

impl Shell {
    fn half(&self) -> f64 {
        0.5 * f64::from(self.thickness)
    }
}
