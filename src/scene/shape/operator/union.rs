//! The union.

use super::part::no_numbers;
use super::{Exactness, Part, Properties, Shape, ShapeFile, hull, merged};
use glam::DVec3;

no_numbers! {
    /// Solid where any of its children is.
    Union over Vec<ShapeFile>
}

impl Part for Union {
    fn name(&self) -> &'static str {
        "Union"
    }

    fn is_flat(&self) -> bool {
        true
    }

    fn operands(&self) -> (usize, usize) {
        (1, usize::MAX)
    }

    /// Exact in the air if all are (Hart 1996, section 3.3).
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
