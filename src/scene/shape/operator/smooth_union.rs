//! The union with blended seams.

use super::part::{numbers, slowest};
use super::{Part, Properties, Shape, ShapeFile, SurfaceKind, hull, merged};
use glam::DVec3;

numbers! {
    /// The union, with its seams blended.
    SmoothUnion over (of: Vec<ShapeFile>) {
        /// Difference of distances in metres below which two fields are blended.
        radius: f32 as Radius,
    }
}

impl Part for SmoothUnion {
    fn surface_kind(&self) -> SurfaceKind {
        SurfaceKind::SMOOTH
    }

    /// Blending mixes the gradients of two fields, so the greater Lipschitz constant still holds.
    /// The solid reaches beyond the plain union by a quarter of the radius for each field that is
    /// blended in.
    fn properties(&self, children: &[Shape]) -> Properties {
        let of: Vec<Properties> = children.iter().map(Shape::properties).collect();
        let blended = children.len().saturating_sub(1) as f64;
        let reach = slowest(children) * 0.25 * f64::from(self.radius) * blended;
        merged(&of, hull(&of).grown(DVec3::splat(reach)))
    }

    fn own_length(&self) -> f64 {
        self.radius.into()
    }

    fn value(&self, children: &[Shape], p: DVec3) -> f64 {
        let values = children[1..].iter().map(|child| child.value(p));
        values.fold(children[0].value(p), |a, b| {
            smooth_min(a, b, self.radius.into())
        })
    }

    fn shader_numbers(&self, _: &[Shape]) -> Vec<f64> {
        vec![self.radius.into()]
    }
}

/// The polynomial smooth minimum (Quilez): a quarter of `radius` lower where both are equal.
fn smooth_min(a: f64, b: f64, radius: f64) -> f64 {
    let blend = (radius - (a - b).abs()).max(0.0);
    a.min(b) - 0.25 * blend * blend / radius
}
