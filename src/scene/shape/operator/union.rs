//! The union.

use super::part::no_numbers;
use super::{Bounds3, Exactness, Part, Properties, Shape, ShapeFile, SurfaceKind, hull, merged};
use glam::DVec3;

no_numbers! {
    /// Solid where any of its children is.
    Union over Vec<ShapeFile>
}

impl Part for Union {
    fn surface_kind(&self) -> SurfaceKind {
        SurfaceKind::FLAT
    }

    fn keeps_apart(&self, children: &[Shape]) -> bool {
        let bounds: Vec<Bounds3> = children.iter().map(|c| c.properties().bounds).collect();
        let mut others = bounds.iter().enumerate();
        others.all(|(index, one)| {
            bounds[..index]
                .iter()
                .all(|other| one.is_apart_from(*other))
        })
    }

    /// Exact in the air if all children are (Hart 1996, section 3.3).
    fn properties(&self, children: &[Shape]) -> Properties {
        let of: Vec<Properties> = children.iter().map(Shape::properties).collect();
        let merged = merged(&of, hull(&of));
        Properties {
            in_air: Exactness::worst(of.iter().map(|p| p.in_air), merged.lipschitz),
            convex: of.len() == 1 && of[0].convex,
            ..merged
        }
    }

    fn value(&self, children: &[Shape], p: DVec3) -> f64 {
        let values = children.iter().map(|child| child.value(p));
        values.fold(f64::INFINITY, f64::min)
    }
}
