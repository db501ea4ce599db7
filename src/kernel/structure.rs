//! What the shader text of a scene depends on: the key of its programs.

use super::assets::Assets;
use super::cells::Lists;
use super::layout::Layout;
use super::signature::SurfaceStructure;
use crate::scene::Scene;

/// What the shader text of a scene depends on: each surface's shape, whether it has a
/// rotation, and of a field what does not move; of surfaces in cells only which kinds there
/// are, and along which axes cells have no end. Two scenes of one structure share their programs.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Structure {
    /// Unrolled surfaces by their index.
    unrolled: Vec<(usize, SurfaceStructure)>,
    instanced: Vec<SurfaceStructure>,
    unbounded_axes: [bool; 3],
    /// Where the heights of the images lie, in the order of the text.
    images: Vec<usize>,
}

/// The structure of the text that reads these lists of cells; see [`Structure`].
pub fn structure(scene: &Scene, lists: Lists) -> Structure {
    let layout = Layout::of(&scene.surfaces, lists);
    let unrolled = |&index: &usize| (index, SurfaceStructure::unrolled(&scene.surfaces[index]));
    let as_data = |&index: &usize| SurfaceStructure::as_data(&scene.surfaces[index]);
    Structure {
        unrolled: layout.unrolled.iter().map(unrolled).collect(),
        instanced: layout.instanced.iter().map(as_data).collect(),
        unbounded_axes: layout.unbounded_axes,
        images: Assets::of(scene).places(&layout, scene),
    }
}
