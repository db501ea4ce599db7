//! The scene's data: what is too much for uniforms.
//!
//! A list of vectors: the heights of images first, at places that the text knows; then, for
//! surfaces in cells, a directory (a vector for each surface of the scene: its number, its
//! kind, where its values lie), the values, the cells (a vector each: where its list begins,
//! how long it is) and the lists, whose entries are those of the directory.

use super::field::Assets;
use super::{Placed, Placement};
use crate::scene::Scene;
use crate::scene::cells::{Cells, Lists};
use crate::scene::layout::Layout;
use glam::{DVec3, Vec3, Vec4};

/// Vectors in a row of the texture `uSceneData`.
pub const DATA_WIDTH: usize = 1024;

/// The vectors that `sceneData(index)` reads in a scene without cells: the heights of its
/// images, one a vector, in its first component.
pub fn scene_data(scene: &Scene) -> Vec<Vec4> {
    let assets = Assets::of(scene);
    let mut data = Vec::with_capacity(assets.data_length());
    for (image, _) in &assets.images {
        data.extend(image.heights().iter().map(|h| Vec4::new(*h, 0.0, 0.0, 0.0)));
    }
    data
}

/// Where the surfaces in cells lie, as the shader is told.
#[derive(Clone, Debug, PartialEq)]
pub struct CellData {
    /// Corner of the grid with the least coordinates, in the shader's coordinates (metres).
    pub origin: Vec3,
    /// Width, height and depth of a cell in metres.
    pub cell: Vec3,
    /// Cells along each axis.
    pub count: Vec3,
    /// The least and greatest coordinates of all surfaces in cells (metres).
    pub inner: [Vec3; 2],
    /// Index of the first cell in the scene's data.
    pub cells: i32,
    /// Index of the directory.
    pub directory: i32,
}

impl CellData {
    /// Appends what the surfaces in cells need to the scene's data.
    pub fn append(
        data: &mut Vec<Vec4>,
        layout: &Layout,
        placement: &Placement,
        placed: &Placed,
        cells: &Cells,
        lists: Lists,
    ) -> CellData {
        let directory = data.len();
        let mut values = Vec::new();
        let first = directory + layout.kind_of.len();
        for (index, kind) in layout.kind_of.iter().enumerate() {
            let (kind, place) = match kind {
                Some(kind) => (*kind as f32, (first + values.len()) as f32),
                None => (-1.0, 0.0),
            };
            data.push(Vec4::new((index + 1) as f32, kind, place, 0.0));
            if kind >= 0.0 {
                placed.push_data(index, &mut values);
            }
        }
        data.append(&mut values);
        let first_cell = data.len();
        let count = cells.grid().count.element_product() as usize;
        data.resize(first_cell + count, Vec4::ZERO);
        cells.for_each_list(lists, |cell, list| {
            let place = data.len() as f32;
            data[first_cell + cell] = Vec4::new(place, list.len() as f32, 0.0, 0.0);
            for &index in list {
                data.push(data[directory + index as usize]);
            }
        });
        let grid = cells.grid();
        let anchor = placement.anchor.as_dvec3();
        let local = |place: DVec3| (place - anchor).as_vec3();
        CellData {
            origin: local(grid.origin),
            cell: grid.cell.as_vec3(),
            count: grid.count.as_vec3(),
            inner: [local(grid.inner.min), local(grid.inner.max)],
            cells: first_cell as i32,
            directory: directory as i32,
        }
    }
}
