//! The scene's data: what is too much for uniforms.
//!
//! A list of vectors: the heights of images first, at places that the text knows; then, for
//! surfaces in cells, a directory (a vector for each surface of the scene: its number, its
//! kind, where its values lie), the values, the cells (a vector each: where its list begins,
//! how long it is) and the lists, whose entries are those of the directory; then, for
//! distances, the groups (two vectors each: the least coordinates of a box and where its list
//! begins, the greatest ones and how long the list is) and their lists.

use super::assets::Assets;
use super::cells::{Cells, ENDLESS, Group, Lists};
use super::layout::Layout;
use super::rebasing::{OriginRebasing, RebasedScene, rounding_of};
use crate::scene::Scene;
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
    /// Index of the first cell in the scene's data.
    pub cells: i32,
    /// Index of the first group; groups come with lists of nearest candidates alone.
    pub groups: i32,
    /// How many groups there are.
    pub group_count: i32,
    /// Index of the directory.
    pub directory: i32,
}

impl CellData {
    /// Appends what the surfaces in cells need to the scene's data.
    pub fn append(
        data: &mut Vec<Vec4>,
        layout: &Layout,
        rebasing: &OriginRebasing,
        rebased: &RebasedScene,
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
                rebased.push_data(index, &mut values);
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
        let origin = rebasing.origin.as_dvec3();
        let local = |place: DVec3| (place - origin).as_vec3();
        let groups: &[Group] = match lists {
            Lists::NearestCandidates => cells.groups(),
            Lists::Overlapping => &[],
        };
        let first_group = data.len();
        data.resize(first_group + 2 * groups.len(), Vec4::ZERO);
        for (group, place) in groups.iter().zip((first_group..).step_by(2)) {
            let (low, high) = (local(group.bounds.min), local(group.bounds.max));
            // What stands for no end is no place that anything is computed with.
            let places = low.abs().max(high.abs());
            let ends = places.cmplt(Vec3::splat(0.5 * ENDLESS as f32));
            let spare = Vec3::splat(rounding_of(Vec3::select(ends, places, Vec3::ZERO)));
            data[place] = (low - spare).extend(data.len() as f32);
            data[place + 1] = (high + spare).extend(group.surfaces.len() as f32);
            for &index in &group.surfaces {
                data.push(data[directory + index as usize]);
            }
        }
        CellData {
            origin: local(grid.origin),
            cell: grid.cell.as_vec3(),
            count: grid.count.as_vec3(),
            cells: first_cell as i32,
            groups: first_group as i32,
            group_count: groups.len() as i32,
            directory: directory as i32,
        }
    }
}
