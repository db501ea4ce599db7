//! The division of a scene's surfaces into unrolled surfaces and surfaces in cells.
//!
//! A few surfaces are unrolled: each has its own lines of text. If there are many surfaces of a *kind* (a shape,
//! rotated or not), only the kind is in the text, and its surfaces are data. Each cell lists the surfaces that can be
//! hit in it. An infinite surface is not put into cells, unless most surfaces are infinite along the same axis (a hall
//! of infinite pillars). Then the cells are infinite along that axis too.
//!
//! Each kind is unrolled or put into cells by cost. An unrolled surface costs the same in every evaluation. A kind in
//! cells costs about as much as a certain number of unrolled surfaces, regardless of the number of its surfaces
//! ([`Layout::of`], docs/benchmarks/surfaces-llvmpipe.md).

use super::cells::Lists;
use crate::scene::mesh::TriangleMesh;
use crate::scene::shape::{Asset, Hyperboloid, MOST_NODES, Mirror, Repeat, User};
use crate::scene::{Copies, HeightImage, Node, SampledField, Scene, Shape, Surface, UserField};
use std::hash::{Hash, Hasher};
use std::sync::Arc;

/// Least number of surfaces of a kind for which the intersection with lines is faster in cells than unrolled.
const LINES_FROM: usize = 10;

/// Least number of surfaces of a kind for which the evaluation of distances is faster in cells than unrolled.
const DISTANCES_FROM: usize = 24;

/// Number of vectors that describe to the shader the grid of a kind with separate cells.
pub const GRID_VECTORS: usize = 5;

/// Maximum unrolled surfaces among those that could be in cells. More surfaces would take long to compile, even if each
/// kind has few of them.
const UNROLLED_AT_MOST: usize = 23;

/// Maximum total number of unrolled surfaces, kinds, and nodes of their fields. The limit bounds the time of
/// compilation, which grows faster than this number. llvmpipe took 8 s and 0.5 GB for 500 planes, more than 30 s and
/// 1.7 GB for 1,000, and more than 7 GB for a field of 4,000 nodes.
pub const MOST_UNROLLED: usize = MOST_NODES;

#[cfg(test)]
thread_local! {
    static DERIVED: std::cell::Cell<usize> = const { std::cell::Cell::new(0) };
}

/// Number of layouts that this thread has derived.
#[cfg(test)]
pub(super) fn layouts_derived() -> usize {
    DERIVED.get()
}

/// The division of a scene's surfaces.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layout {
    /// Indices of the unrolled surfaces.
    pub unrolled: Vec<usize>,
    /// The index of the first surface of each kind.
    pub instanced: Vec<usize>,
    /// The kind of each surface; `None` for an unrolled surface.
    pub kind_of: Vec<Option<u32>>,
    /// Axes along which cells are infinite.
    pub unbounded_axes: [bool; 3],
}

/// A kind with the surfaces that could be in cells, in their order.
struct Kind {
    structure: SurfaceStructure,
    surfaces: Vec<usize>,
}

impl Layout {
    /// The layout of surfaces for shaders that read these lists. The layout depends on the same properties of the
    /// surfaces as their text, and on no position.
    pub fn of(surfaces: &[Surface], lists: Lists) -> Layout {
        #[cfg(test)]
        DERIVED.set(DERIVED.get() + 1);
        let all = surfaces.len();
        let unrolled = Layout {
            unrolled: (0..all).collect(),
            instanced: Vec::new(),
            kind_of: vec![None; all],
            unbounded_axes: [false; 3],
        };
        let from = match lists {
            Lists::Lines | Lists::Overlapping => LINES_FROM,
            Lists::NearestCandidates => DISTANCES_FROM,
        };
        if all < from {
            return unrolled;
        }
        let endless: Vec<[bool; 3]> = surfaces.iter().map(endless_axes).collect();
        let unbounded_axes = mostly_endless(&endless);
        let fits = |axes: &[bool; 3]| {
            *axes != [true; 3] && (0..3).all(|axis| !axes[axis] || unbounded_axes[axis])
        };
        // A mesh has a grid of its own.
        let is_mesh = |index: usize| surfaces[index].shape.mesh().is_some();
        let fitting = (0..all).filter(|&index| fits(&endless[index]) && !is_mesh(index));
        let in_cells = in_cells(kinds(surfaces, fitting), from);
        let mut layout = Layout {
            instanced: in_cells.iter().map(|kind| kind.surfaces[0]).collect(),
            unbounded_axes,
            ..unrolled
        };
        for (number, kind) in in_cells.iter().enumerate() {
            for &index in &kind.surfaces {
                layout.kind_of[index] = Some(number as u32);
            }
        }
        let kind_of = &layout.kind_of;
        layout.unrolled.retain(|&index| kind_of[index].is_none());
        layout
    }

    /// Whether any surface is in cells.
    pub fn has_cells(&self) -> bool {
        !self.instanced.is_empty()
    }

    /// Number of unrolled surfaces, kinds, and nodes of their fields.
    pub(super) fn pieces(&self, scene: &Scene) -> usize {
        let with_text = self.unrolled.iter().chain(&self.instanced);
        let nodes = |&index: &usize| scene.surfaces[index].shape.nodes().len();
        with_text.map(nodes).sum()
    }

    /// The surfaces in cells whose kind satisfies `wanted`, in their order.
    pub fn surfaces_of(&self, wanted: impl Fn(usize) -> bool) -> Vec<usize> {
        let of = |index: &usize| self.kind_of[*index].is_some_and(|kind| wanted(kind as usize));
        (0..self.kind_of.len()).filter(of).collect()
    }
}

/// The axes along which most surfaces are infinite. Surfaces that are infinite along all axes are not counted.
fn mostly_endless(endless: &[[bool; 3]]) -> [bool; 3] {
    let candidates = endless.iter().filter(|axes| **axes != [true; 3]);
    let count = candidates.clone().count();
    [0, 1, 2].map(|axis| 2 * candidates.clone().filter(|axes| axes[axis]).count() > count)
}

/// The kinds of these surfaces, in the order of their first surfaces.
fn kinds(surfaces: &[Surface], wanted: impl Iterator<Item = usize>) -> Vec<Kind> {
    let mut kinds: Vec<Kind> = Vec::new();
    for index in wanted {
        let structure = SurfaceStructure::as_data(&surfaces[index]);
        // A scene with more kinds than the limit is rejected, so the kinds beyond the limit need not be distinguished.
        let known = match kinds.len() {
            ..=MOST_UNROLLED => kinds.iter().position(|kind| kind.structure == structure),
            _ => None,
        };
        match known {
            Some(kind) => kinds[kind].surfaces.push(index),
            None => kinds.push(Kind {
                structure,
                surfaces: vec![index],
            }),
        }
    }
    kinds
}

/// The kinds of at least `from` surfaces. If more than [`UNROLLED_AT_MOST`] surfaces are left, the largest other kinds
/// are added until the rest is within this limit.
fn in_cells(kinds: Vec<Kind>, from: usize) -> Vec<Kind> {
    let mut sizes: Vec<usize> = kinds.iter().map(|kind| kind.surfaces.len()).collect();
    sizes.sort_unstable_by(|a, b| b.cmp(a));
    let mut left: usize = sizes.iter().sum();
    let mut least = from;
    for size in sizes {
        if size < from && left <= UNROLLED_AT_MOST {
            break;
        }
        least = least.min(size);
        left -= size;
    }
    let is_in = |kind: &Kind| kind.surfaces.len() >= least;
    kinds.into_iter().filter(is_in).collect()
}

/// The axes along which a surface is infinite on at least one side.
fn endless_axes(surface: &Surface) -> [bool; 3] {
    let bounds = surface.bounds();
    [0, 1, 2].map(|axis| !(bounds.min[axis].is_finite() && bounds.max[axis].is_finite()))
}

/// The properties of a surface, or of a kind, that determine its text.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct SurfaceStructure {
    name: &'static str,
    has_rotation: bool,
    /// Whether a wave that leaves the surface cannot hit it again. A driven number may change this property.
    convex: bool,
    /// Whether a reflection looks for further sheets. A driven number may change this property too.
    hollow_edges: bool,
    field: Option<Signature>,
}

impl SurfaceStructure {
    pub fn unrolled(surface: &Surface) -> SurfaceStructure {
        let moving = |field: &Shape| surface.moving_nodes(field);
        SurfaceStructure::new(surface, moving)
    }

    /// The structure of a surface whose numbers are all in the scene's data.
    pub fn as_data(surface: &Surface) -> SurfaceStructure {
        SurfaceStructure::new(surface, |field| vec![true; field.nodes().len()])
    }

    /// Whether two surfaces have the same text, apart from rotations, if all their numbers are values.
    pub fn have_one_text(a: &Surface, b: &Surface) -> bool {
        let unturned = |surface| SurfaceStructure {
            has_rotation: false,
            ..SurfaceStructure::as_data(surface)
        };
        unturned(a) == unturned(b)
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

/// The properties of a field that determine its text: the tree, its literals, and the nodes that move. Fields with
/// equal signatures have the same text.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct Signature {
    nodes: Vec<NodeSignature>,
}

#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct NodeSignature {
    name: &'static str,
    operands: usize,
    choices: [u32; 3],
    /// Bits of the literals; `None` for a node whose numbers move.
    literals: Option<Vec<u32>>,
    asset: Option<OwnAsset>,
}

/// A large asset that the text depends on.
#[derive(Clone, Debug)]
enum OwnAsset {
    Image(Arc<HeightImage>),
    Samples(Arc<SampledField>),
    User(Arc<UserField>),
    Mesh(Arc<TriangleMesh>),
}

impl From<Asset<'_>> for OwnAsset {
    fn from(asset: Asset) -> OwnAsset {
        match asset {
            Asset::Image(image) => OwnAsset::Image(Arc::clone(image)),
            Asset::Samples(field) => OwnAsset::Samples(Arc::clone(field)),
            Asset::User(field) => OwnAsset::User(Arc::clone(field)),
            Asset::Mesh(mesh) => OwnAsset::Mesh(Arc::clone(mesh)),
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

/// Parameters of a node that change the text and are not numbers of the shape.
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
        Node::User(User { field }) => [u32::from(field.is_differentiated()), 0, 0],
        _ => [0; 3],
    }
}

impl PartialEq for OwnAsset {
    fn eq(&self, other: &OwnAsset) -> bool {
        match (self, other) {
            (OwnAsset::Image(a), OwnAsset::Image(b)) => Arc::ptr_eq(a, b) || a == b,
            (OwnAsset::Samples(a), OwnAsset::Samples(b)) => Arc::ptr_eq(a, b) || a == b,
            (OwnAsset::User(a), OwnAsset::User(b)) => Arc::ptr_eq(a, b) || a == b,
            (OwnAsset::Mesh(a), OwnAsset::Mesh(b)) => Arc::ptr_eq(a, b) || a == b,
            _ => false,
        }
    }
}

impl Eq for OwnAsset {}

impl Hash for OwnAsset {
    fn hash<H: Hasher>(&self, state: &mut H) {
        match self {
            OwnAsset::Image(image) => image.size().hash(state),
            OwnAsset::Samples(field) => field.size().hash(state),
            OwnAsset::User(user) => user.text.hash(state),
            OwnAsset::Mesh(mesh) => mesh.triangle_count().hash(state),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::SceneError;

    /// Protects results from dependence on earlier frames: if moving numbers close an edge between two boxes, the
    /// shader differs; while none closes an edge, the shader stays the same.
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
