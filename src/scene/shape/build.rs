//! Builds trees in Rust.

use super::operator::{
    Bend, Complement, Difference, Elongate, Intersection, Mirror, Morph, Offset, Repeat, Rotate,
    Scale, Shell, SmoothUnion, Translate, Twist, Union,
};
use super::{Node, Shape};
use glam::Vec3;

/// ```
/// use echomarch::scene::Shape;
/// use echomarch::scene::shape::{Cuboid, Sphere};
/// use glam::Vec3;
/// let ball = Shape::from(Sphere { radius: 2.0 });
/// let slab = Shape::from(Cuboid { size: Vec3::new(9.0, 1.0, 9.0) });
/// let bowl = ball.shell(0.2).minus([slab.translate(Vec3::Y * 2.0)]);
/// assert!(bowl.value(glam::DVec3::ZERO) > 0.0);
/// ```
impl From<Node> for Shape {
    fn from(node: Node) -> Shape {
        Shape {
            node,
            children: Vec::new(),
        }
    }
}

impl Shape {
    fn under(self, node: impl Into<Node>) -> Shape {
        Shape::over(node, [self])
    }

    /// An operator over several fields.
    pub fn over(node: impl Into<Node>, children: impl IntoIterator<Item = Shape>) -> Shape {
        Shape {
            node: node.into(),
            children: children.into_iter().collect(),
        }
    }

    /// The union: solid where any of the children is.
    pub fn union(children: impl IntoIterator<Item = Shape>) -> Shape {
        Shape::over(Union, children)
    }

    /// The intersection: solid where all of the children are.
    pub fn intersection(children: impl IntoIterator<Item = Shape>) -> Shape {
        Shape::over(Intersection, children)
    }

    /// The union, blended where distances differ by less than `radius` metres.
    pub fn smooth_union(radius: f32, children: impl IntoIterator<Item = Shape>) -> Shape {
        Shape::over(SmoothUnion { radius }, children)
    }

    /// This field minus all the others.
    pub fn minus(self, cut: impl IntoIterator<Item = Shape>) -> Shape {
        let mut children = vec![self];
        children.extend(cut);
        Shape::over(Difference, children)
    }

    /// A blend between this field (0) and another (1).
    pub fn morph(self, to: Shape, amount: f32) -> Shape {
        Shape::over(Morph { amount }, [self, to])
    }

    /// The complement: air and solid exchanged.
    pub fn complement(self) -> Shape {
        self.under(Complement)
    }

    /// A wall of `thickness` metres along its surface.
    pub fn shell(self, thickness: f32) -> Shape {
        self.under(Shell { thickness })
    }

    /// Grown by a length in metres, or shrunk by a negative one.
    pub fn offset(self, by: f32) -> Shape {
        self.under(Offset { by })
    }

    /// Moved by a vector in metres.
    pub fn translate(self, by: Vec3) -> Shape {
        self.under(Translate { by })
    }

    /// Turned about x, then y, then z of the outer axes, in radians.
    pub fn rotate(self, by: Vec3) -> Shape {
        self.under(Rotate { by })
    }

    /// Scaled by a factor.
    pub fn scale(self, by: f32) -> Shape {
        self.under(Scale { by })
    }

    /// The part on the positive side of the chosen axes, mirrored to the other side.
    pub fn mirror(self, axes: [bool; 3]) -> Shape {
        self.under(Mirror { axes })
    }

    /// Repeated every `period` metres (0: not along that axis), `count` times (0: without end).
    pub fn repeat(self, period: Vec3, count: [u32; 3]) -> Shape {
        self.under(Repeat { period, count })
    }

    /// Cut at the origin, with each half moved outwards by `by` metres.
    pub fn elongate(self, by: Vec3) -> Shape {
        self.under(Elongate { by })
    }

    /// Turned about y by `rate` radians per metre of y.
    pub fn twist(self, rate: f32) -> Shape {
        let lipschitz = 0.0;
        self.under(Twist { rate, lipschitz })
    }

    /// Turned about z by `rate` radians per metre of x.
    pub fn bend(self, rate: f32) -> Shape {
        let lipschitz = 0.0;
        self.under(Bend { rate, lipschitz })
    }
}
