//! What the text of a surface and of its field depends on.

use crate::scene::shape::{Asset, Hyperboloid, Mirror, Repeat};
use crate::scene::{Copies, HeightImage, Node, Shape, Surface, UserField};
use std::hash::{Hash, Hasher};
use std::sync::Arc;

/// What the text of one surface, or of one kind, depends on.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct SurfaceStructure {
    name: &'static str,
    has_rotation: bool,
    /// Whether a wave that leaves it passes it over: a driven number may change that.
    convex: bool,
    /// Whether a reflection looks for further sheets: the same.
    hollow_edges: bool,
    field: Option<Signature>,
}

impl SurfaceStructure {
    pub fn unrolled(surface: &Surface) -> SurfaceStructure {
        let moving = |field: &Shape| surface.moving_nodes(field);
        SurfaceStructure::new(surface, moving)
    }

    /// Of a surface whose numbers are all data.
    pub fn as_data(surface: &Surface) -> SurfaceStructure {
        SurfaceStructure::new(surface, |field| vec![true; field.nodes().len()])
    }

    fn new(surface: &Surface, moving: impl Fn(&Shape) -> Vec<bool>) -> SurfaceStructure {
        let field = surface.shape.field();
        SurfaceStructure {
            name: surface.shape.name(),
            has_rotation: surface.has_rotation(),
            convex: surface.shape.is_convex(),
            hollow_edges: surface.shape.may_have_hollow_edges(),
            field: field.map(|field| signature(field, &moving(field))),
        }
    }
}

/// Two fields with the same signature have the same text: the tree, its literals, and which
/// nodes move.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct Signature {
    nodes: Vec<NodeSignature>,
}

#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct NodeSignature {
    name: &'static str,
    operands: usize,
    choices: [u32; 3],
    /// Bits of the literals; `None` for a node that moves.
    literals: Option<Vec<u32>>,
    asset: Option<OwnAsset>,
}

/// A large thing that the text depends on.
#[derive(Clone, Debug)]
enum OwnAsset {
    Image(Arc<HeightImage>),
    User(Arc<UserField>),
}

impl From<Asset<'_>> for OwnAsset {
    fn from(asset: Asset) -> OwnAsset {
        match asset {
            Asset::Image(image) => OwnAsset::Image(Arc::clone(image)),
            Asset::User(field) => OwnAsset::User(Arc::clone(field)),
        }
    }
}

/// See [`Signature`].
fn signature(field: &Shape, moving: &[bool]) -> Signature {
    let nodes = field.nodes().into_iter().zip(moving);
    Signature {
        nodes: nodes.map(|(node, moves)| of_node(node, *moves)).collect(),
    }
}

fn of_node(field: &Shape, moves: bool) -> NodeSignature {
    let bits = |numbers: Vec<f64>| {
        let literals = numbers.into_iter().map(|number| (number as f32).to_bits());
        literals.collect()
    };
    NodeSignature {
        name: field.node.name(),
        operands: field.children.len(),
        choices: choices(field),
        literals: (!moves).then(|| bits(field.shader_numbers())),
        asset: field.node.asset().map(OwnAsset::from),
    }
}

/// What is no number, and yet in the text.
fn choices(field: &Shape) -> [u32; 3] {
    match &field.node {
        Node::Mirror(Mirror { axes }) => axes.map(u32::from),
        Node::Hyperboloid(Hyperboloid { two_sheets, .. }) => [u32::from(*two_sheets), 0, 0],
        Node::Repeat(Repeat { count, .. }) => {
            let copies = field.copies().unwrap_or([Copies::None; 3]);
            // Counts are below 2^24, copies at most 64.
            let capped = u32::from(field.cap().is_some()) << 7;
            let evaluated = |axis: usize| match copies[axis] {
                Copies::None => 0,
                copies => copies.count(),
            };
            [0, 1, 2].map(|axis| (count[axis] << 8) | capped | evaluated(axis))
        }
        _ => [0; 3],
    }
}

impl PartialEq for OwnAsset {
    fn eq(&self, other: &OwnAsset) -> bool {
        match (self, other) {
            (OwnAsset::Image(a), OwnAsset::Image(b)) => Arc::ptr_eq(a, b) || a == b,
            (OwnAsset::User(a), OwnAsset::User(b)) => Arc::ptr_eq(a, b) || a == b,
            _ => false,
        }
    }
}

impl Eq for OwnAsset {}

impl Hash for OwnAsset {
    fn hash<H: Hasher>(&self, state: &mut H) {
        match self {
            OwnAsset::Image(image) => image.size().hash(state),
            OwnAsset::User(user) => user.text.hash(state),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Scene, SceneError};

    /// Protects results from what was traced before: where numbers that move close an edge between two boxes, the shader
    /// is another one, and it is the same as long as none closes.
    #[test]
    fn boxes_that_come_to_touch_have_another_structure() -> Result<(), SceneError> {
        let scene = Scene::from_ron(
            r#"Scene(
                name: "closing",
                surfaces: [Surface(name: "boxes", shape: Union(of: [
                    Box(size: (1, 1, 1)),
                    Translate(of: Box(size: (1, 1, 1)), by: (Keys([(0, 3), (1, 2), (2, 0.9)]), 0.5, 0)),
                ]))],
                source: Source(position: (0, 0, 5)),
                listener: Listener(position: (0, 0, -5), radius: 1),
            )"#,
            "closing.ron",
        )?;
        let at = |seconds| SurfaceStructure::unrolled(&scene.at(seconds).surfaces[0]);
        assert_eq!(at(0.0), at(1.0));
        assert_ne!(at(1.0), at(2.0));
        Ok(())
    }
}
