//! Trees written in Rust.

use super::{Field, Node};
use glam::Vec3;

/// ```
/// use echomarch::scene::{Field, Node};
/// use glam::Vec3;
/// let ball = Field::from(Node::Sphere { radius: 2.0 });
/// let slab = Field::from(Node::Box { size: Vec3::new(9.0, 1.0, 9.0) });
/// let bowl = ball.shell(0.2).minus([slab.translate(Vec3::Y * 2.0)]);
/// assert!(bowl.value(glam::DVec3::ZERO) > 0.0);
/// ```
impl From<Node> for Field {
    fn from(node: Node) -> Field {
        Field {
            node,
            of: Vec::new(),
        }
    }
}

impl Field {
    fn under(self, node: Node) -> Field {
        Field {
            node,
            of: vec![self],
        }
    }

    /// An operator over several fields.
    pub fn over(node: Node, of: impl IntoIterator<Item = Field>) -> Field {
        Field {
            node,
            of: of.into_iter().collect(),
        }
    }

    /// Solid where any of them is.
    pub fn union(of: impl IntoIterator<Item = Field>) -> Field {
        Field::over(Node::Union, of)
    }

    /// Solid where all of them are.
    pub fn intersection(of: impl IntoIterator<Item = Field>) -> Field {
        Field::over(Node::Intersection, of)
    }

    /// The union, blended below a difference of distances of `radius` metres.
    pub fn smooth_union(radius: f32, of: impl IntoIterator<Item = Field>) -> Field {
        Field::over(Node::SmoothUnion { radius }, of)
    }

    /// This field, less all the others.
    pub fn minus(self, cut: impl IntoIterator<Item = Field>) -> Field {
        let mut of = vec![self];
        of.extend(cut);
        Field::over(Node::Difference, of)
    }

    /// Between this field (0) and another (1).
    pub fn morph(self, to: Field, amount: f32) -> Field {
        Field::over(Node::Morph { amount }, [self, to])
    }

    /// Air and solid exchanged.
    pub fn complement(self) -> Field {
        self.under(Node::Complement)
    }

    /// Its surface as a wall of `thickness` metres.
    pub fn shell(self, thickness: f32) -> Field {
        self.under(Node::Shell { thickness })
    }

    /// Grown by a length in metres, or shrunk by a negative one.
    pub fn offset(self, by: f32) -> Field {
        self.under(Node::Offset { by })
    }

    /// Moved by so many metres.
    pub fn translate(self, by: Vec3) -> Field {
        self.under(Node::Translate { by })
    }

    /// Turned about x, then y, then z of the outer axes, in radians.
    pub fn rotate(self, by: Vec3) -> Field {
        self.under(Node::Rotate { by })
    }

    /// Made larger by a factor.
    pub fn scale(self, by: f32) -> Field {
        self.under(Node::Scale { by })
    }

    /// What lies on the positive side of the chosen axes, on both sides.
    pub fn mirror(self, axes: [bool; 3]) -> Field {
        self.under(Node::Mirror { axes })
    }

    /// Repeated every `period` metres (0: not along that axis), `count` times (0: endless).
    pub fn repeat(self, period: Vec3, count: [u32; 3]) -> Field {
        self.under(Node::Repeat { period, count })
    }

    /// Cut at the origin and pulled apart by so many metres to either side.
    pub fn elongate(self, by: Vec3) -> Field {
        self.under(Node::Elongate { by })
    }

    /// Turned about y by `rate` radians a metre of y.
    pub fn twist(self, rate: f32) -> Field {
        let lipschitz = 0.0;
        self.under(Node::Twist { rate, lipschitz })
    }

    /// Turned about z by `rate` radians a metre of x.
    pub fn bend(self, rate: f32) -> Field {
        let lipschitz = 0.0;
        self.under(Node::Bend { rate, lipschitz })
    }
}
