//! Operators on shapes.

pub(super) mod bend;
pub(super) mod complement;
pub(super) mod difference;
pub(super) mod elongate;
pub(super) mod intersection;
pub(super) mod mirror;
pub(super) mod morph;
pub(super) mod offset;
pub(super) mod repeat;
pub(super) mod rotate;
pub(super) mod scale;
pub(super) mod shell;
pub(super) mod smooth_union;
pub(super) mod translate;
mod turning;
pub(super) mod twist;
pub(super) mod union;

pub use bend::Bend;
pub use complement::Complement;
pub use difference::Difference;
pub use elongate::Elongate;
pub use intersection::Intersection;
pub use mirror::Mirror;
pub use morph::Morph;
pub use offset::Offset;
pub(crate) use repeat::Copies;
pub use repeat::Repeat;
pub use rotate::Rotate;
pub use scale::Scale;
pub use shell::Shell;
pub use smooth_union::SmoothUnion;
pub use translate::Translate;
pub use twist::Twist;
pub use union::Union;

// Items shared by the operators.
use super::part;
use super::properties::{hull, merged};
use super::{Bounds3, Exactness, Node, Part, Properties, Shape, ShapeFile, SurfaceKind};
