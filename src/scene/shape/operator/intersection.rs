//! The intersection.

use super::part::no_numbers;
use super::{Bounds3, Exactness, Part, Properties, Shape, ShapeFile, SurfaceKind, merged};
use glam::DVec3;

no_numbers! {
    /// Solid where all of its children are.
    Intersection over Vec<ShapeFile>
}

impl Part for Intersection {
    fn surface_kind(&self) -> SurfaceKind {
        SurfaceKind::FLAT
    }

    /// Exact in the solid if all children are.
    fn properties(&self, children: &[Shape]) -> Properties {
        let of: Vec<Properties> = children.iter().map(Shape::properties).collect();
        let common = of.iter().map(|p| p.bounds).reduce(Bounds3::common);
        let merged = merged(&of, common.unwrap_or(Bounds3::EVERYWHERE));
        Properties {
            in_solid: Exactness::worst(of.iter().map(|p| p.in_solid), merged.lipschitz),
            convex: of.iter().all(|p| p.convex),
            ..merged
        }
    }

    fn value(&self, children: &[Shape], p: DVec3) -> f64 {
        let values = children.iter().map(|child| child.value(p));
        values.fold(f64::NEG_INFINITY, f64::max)
    }
}
