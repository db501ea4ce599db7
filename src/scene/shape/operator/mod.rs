//! Operators that join several fields, and the methods of [`Shape`] that apply operators.

mod repeat;
mod single;
mod turning;

pub(crate) use repeat::Copies;
pub use repeat::Repeat;
pub use single::{Complement, Elongate, Mirror, Offset, Rotate, Scale, Shell, Translate};
pub use turning::{Bend, Twist};

use super::part::{half, part, slowest, surface_kind};
use super::properties::{hull, merged};
use super::{Bounds3, Exactness, Node, Part, Properties, Shape, ShapeFile};
use glam::DVec3;

part! {
    /// Solid where any child is solid.
    Union over (of: Vec<ShapeFile>)
}

impl Part for Union {
    surface_kind!(FLAT);

    fn keeps_apart(&self, children: &[Shape]) -> bool {
        let bounds: Vec<Bounds3> = children.iter().map(|c| c.properties().bounds).collect();
        let mut others = bounds.iter().enumerate();
        others.all(|(index, one)| {
            bounds[..index]
                .iter()
                .all(|other| one.is_apart_from(*other))
        })
    }

    /// Exact in the air if all children are exact in the air (Hart 1996, section 3.3).
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

part! {
    /// Solid where all children are solid.
    Intersection over (of: Vec<ShapeFile>)
}

impl Part for Intersection {
    surface_kind!(FLAT);

    /// Exact in the solid if all children are exact in the solid.
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

part! {
    /// The first child minus all others.
    Difference over (from: Box<ShapeFile>, cut: Vec<ShapeFile>)
}

impl Part for Difference {
    surface_kind!(FLAT);

    fn properties(&self, children: &[Shape]) -> Properties {
        let of: Vec<Properties> = children.iter().map(Shape::properties).collect();
        merged(&of, of[0].bounds)
    }

    /// The air of a difference includes the solids that are cut out.
    fn keeps_air(&self, child: usize) -> bool {
        child == 0
    }

    fn value(&self, children: &[Shape], p: DVec3) -> f64 {
        let cut = children[1..].iter().map(|child| -child.value(p));
        cut.fold(children[0].value(p), f64::max)
    }
}

part! {
    /// A union with blended seams.
    SmoothUnion over (of: Vec<ShapeFile>) {
        /// Difference of distances in metres below which two fields are blended.
        radius: f32 as Radius,
    }
}

impl Part for SmoothUnion {
    surface_kind!(SMOOTH);

    /// A blend mixes the gradients of two fields, so the larger Lipschitz constant remains valid. For each blended
    /// field, the solid extends by a quarter of the radius beyond the plain union.
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
}

/// The polynomial smooth minimum (Quilez): `radius` / 4 below the minimum where both are equal.
fn smooth_min(a: f64, b: f64, radius: f64) -> f64 {
    let blend = (radius - (a - b).abs()).max(0.0);
    a.min(b) - 0.25 * blend * blend / radius
}

part! {
    /// A blend between two fields: the first for an amount of 0, the second for 1.
    Morph over (from: Box<ShapeFile>, to: Box<ShapeFile>) {
        /// Amount of the second field, 0 to 1.
        amount: f32 as Share,
    }
}

impl Part for Morph {
    fn properties(&self, children: &[Shape]) -> Properties {
        let of: Vec<Properties> = children.iter().map(Shape::properties).collect();
        merged(&of, hull(&of))
    }

    /// Air of a blend can lie in the solid of a child.
    fn keeps_air(&self, _: usize) -> bool {
        false
    }

    fn value(&self, children: &[Shape], p: DVec3) -> f64 {
        let (from, to) = (children[0].value(p), children[1].value(p));
        from + (to - from) * f64::from(self.amount)
    }
}

impl Shape {
    fn under(self, node: impl Into<Node>) -> Shape {
        Shape::over(node, [self])
    }

    /// The union: solid where any child is solid.
    pub fn union(children: impl IntoIterator<Item = Shape>) -> Shape {
        Shape::over(Union, children)
    }

    /// The intersection: solid where all children are solid.
    pub fn intersection(children: impl IntoIterator<Item = Shape>) -> Shape {
        Shape::over(Intersection, children)
    }

    /// The union, blended where the distances differ by less than `radius` metres.
    pub fn smooth_union(radius: f32, children: impl IntoIterator<Item = Shape>) -> Shape {
        Shape::over(SmoothUnion { radius }, children)
    }

    /// This shape minus all shapes in `cut`.
    #[must_use]
    pub fn minus(self, cut: impl IntoIterator<Item = Shape>) -> Shape {
        let mut children = vec![self];
        children.extend(cut);
        Shape::over(Difference, children)
    }

    /// A blend between this shape (amount 0) and another shape (amount 1).
    #[must_use]
    pub fn morph(self, to: Shape, amount: f32) -> Shape {
        Shape::over(Morph { amount }, [self, to])
    }

    /// The complement: exchanges air and solid.
    #[must_use]
    pub fn complement(self) -> Shape {
        self.under(Complement)
    }

    /// A wall of `thickness` metres along the surface of the shape.
    #[must_use]
    pub fn shell(self, thickness: f32) -> Shape {
        self.under(Shell { thickness })
    }

    /// The shape grown by `by` metres, or shrunk if `by` is negative.
    #[must_use]
    pub fn offset(self, by: f32) -> Shape {
        self.under(Offset { by })
    }

    /// The shape moved by a vector in metres.
    #[must_use]
    pub fn translate(self, by: impl Into<[f32; 3]>) -> Shape {
        let by = by.into().into();
        self.under(Translate { by })
    }

    /// The shape rotated about x, then y, then z of the outer axes, by angles in radians.
    #[must_use]
    pub fn rotate(self, by: impl Into<[f32; 3]>) -> Shape {
        let by = by.into().into();
        self.under(Rotate { by })
    }

    /// The shape scaled by a factor.
    #[must_use]
    pub fn scale(self, by: f32) -> Shape {
        self.under(Scale { by })
    }

    /// The part of the shape on the positive side of the chosen axes, mirrored to the other side.
    #[must_use]
    pub fn mirror(self, axes: [bool; 3]) -> Shape {
        self.under(Mirror { axes })
    }

    /// The shape repeated every `period` metres (0 for an axis without repetition), `count` times (0 for an infinite
    /// repetition).
    #[must_use]
    pub fn repeat(self, period: impl Into<[f32; 3]>, count: [u32; 3]) -> Shape {
        let period = period.into().into();
        self.under(Repeat { period, count })
    }

    /// The shape cut at the coordinate planes, with each half moved outwards by `by` metres.
    #[must_use]
    pub fn elongate(self, by: impl Into<[f32; 3]>) -> Shape {
        let by = by.into().into();
        self.under(Elongate { by })
    }

    /// The shape twisted about y by `rate` radians per metre of y.
    #[must_use]
    pub fn twist(self, rate: f32) -> Shape {
        let lipschitz = 0.0;
        self.under(Twist { rate, lipschitz })
    }

    /// The shape bent about z by `rate` radians per metre of x.
    #[must_use]
    pub fn bend(self, rate: f32) -> Shape {
        let lipschitz = 0.0;
        self.under(Bend { rate, lipschitz })
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Cuboid, Cylinder, Plane, Room, Sphere};
    use super::*;
    use glam::Vec3;

    fn cube() -> Shape {
        Shape::from(Cuboid { size: Vec3::ONE })
    }

    /// Protects waves that start in an edge. If less than half of the space around an edge may be air, the shader
    /// evaluates each sheet.
    #[test]
    fn edges_of_hollows_and_between_solids_that_touch_are_hollow() {
        let room = Shape::from(Room { size: Vec3::ONE });
        let turned = cube().rotate(Vec3::new(0.0, 0.785, 0.0));
        let diagonal = 2f32.sqrt();
        let hollow = [
            room,
            cube().complement(),
            cube().complement().translate(Vec3::X),
            Shape::union([cube(), cube().translate(Vec3::new(1.0, 0.5, 0.0))]),
            Shape::union([Shape::from(Plane), Shape::from(Sphere { radius: 1.0 })]),
            turned.clone().repeat(Vec3::X * diagonal, [3, 1, 1]),
            turned.translate(Vec3::X * 0.5).mirror([true, false, false]),
            cube().complement().repeat(Vec3::X * 4.0, [0, 1, 1]),
            cube().shell(0.1),
        ];
        for shape in hollow {
            assert!(shape.may_have_hollow_edges(), "{shape:?}");
        }
    }

    /// Protects the speed of fields with separate solids: none of their edges is hollow.
    #[test]
    fn edges_of_convex_solids_apart_are_not_hollow() {
        let pillar = Shape::from(Cylinder { radius: 0.5 });
        let two = Shape::union([cube(), cube().translate(Vec3::X * 1.001)]);
        let none = [
            cube(),
            two.clone(),
            two.scale(2.0).rotate(Vec3::Y),
            pillar.repeat(Vec3::new(4.0, 0.0, 4.0), [100, 1, 100]),
            cube().repeat(Vec3::splat(1.001), [0; 3]),
            cube().translate(Vec3::X).mirror([true, true, false]),
            Shape::from(Sphere { radius: 1.0 }).complement(),
        ];
        for shape in none {
            assert!(!shape.may_have_hollow_edges(), "{shape:?}");
        }
    }
}
