//! The scene's data: everything that is too large for uniforms.
//!
//! The data are an array of vectors in this order:
//! - The heights of images, the samples of fields (`glsl/shape/grid.glsl`), and the meshes (`mesh_data.rs`), at indices that the text contains.
//! - For surfaces in cells, a directory with one vector for each surface of the scene (its number, its kind, the index
//!   of its values, its material), and then the values.
//! - For lines, the cells of each kind, with records of its surfaces.
//! - For all other lists, the cells (one vector each: index and length of the list) and the lists, whose entries are
//!   copies of directory entries.
//! - For distances, the groups (two vectors each: the least coordinates of a box and the index of the list; the
//!   greatest coordinates and the length of the list) and their lists.
//!
//! # Records
//! For lines, a cell of a kind has one *record*: all vectors that are needed to test a surface. One component of its
//! first vector is the *tag*:
//!
//! | tag | record |
//! | --- | --- |
//! | the number of a surface | that surface is the last of its list; the line continues with the next cell |
//! | the number times −1 | that surface; the next record of the list follows |
//! | 0, and the first component is not 0 | the index of the cell's list of several surfaces |
//! | 0 | an empty cell, or no cell |
//!
//! The values of a surface are in its record in the usual layout, after a vector for the tag and, in the first
//! component, for the index of a list. This vector is omitted if the first vector of the values has an unused
//! component. A box has one, and so has an infinite pillar, whose height has no meaning.
//!
//! The record of a marched surface begins with the box around it, in its own axes. The first vector has the centre of
//! the box in the shader's coordinates, and the tag. The second vector has half the size of the box along the axes of the
//! scene that contains this box, and the rounding error of the distance to the surface. The third vector has half the
//! size of the box itself. The centre of an infinite box is the surface's position.

use super::cells::{Cells, ENDLESS, Group, Lists, SceneCells};
use super::layout::{GRID_VECTORS, Layout};
use super::mesh_data::mesh_vectors;
use super::origin_rebasing::{BOX_VECTORS, RebasedScene, rounding_of, value_count};
use super::structure::Assets;
use super::text::is_marched;
use crate::scene::{Node, SampledField, Surface};
use glam::{DVec3, IVec3, UVec3, Vec3, Vec4};

/// Vectors in a row of the texture `uSceneData`.
pub const DATA_WIDTH: usize = 1024;

/// The heights of the scene's images, one per vector, in its first component, the samples of its fields, and its meshes.
pub(super) fn assets(assets: &Assets) -> Vec<Vec4> {
    let mut data = vec![Vec4::ZERO; assets.data_length];
    for (image, first) in &assets.images {
        for (place, height) in data[*first..].iter_mut().zip(image.heights()) {
            place.x = *height;
        }
    }
    for (field, first) in &assets.samples {
        for (place, vector) in data[*first..].iter_mut().zip(sample_vectors(field)) {
            *place = vector;
        }
    }
    for (mesh, first) in &assets.meshes {
        let vectors = mesh_vectors(mesh);
        data[*first..first + vectors.len()].copy_from_slice(&vectors);
    }
    data
}

/// A vector for each sample, x fastest: the values at (x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1).
fn sample_vectors(field: &SampledField) -> impl Iterator<Item = Vec4> {
    let size = field.size().as_ivec3();
    let rows = (0..size.z).flat_map(move |z| (0..size.y).map(move |y| (y, z)));
    let places = rows.flat_map(move |(y, z)| (0..size.x).map(move |x| IVec3::new(x, y, z)));
    places.map(|at| {
        let value = |x, y| field.sample(at + IVec3::new(x, y, 0));
        Vec4::new(value(0, 0), value(1, 0), value(0, 1), value(1, 1))
    })
}

/// The indices and grids of the cells, as passed to the shader.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CellData {
    /// Index of the directory.
    pub directory: i32,
    /// The corner with the least coordinates of the grid whose cells have lists, in metres in the shader's coordinates.
    pub origin: Vec3,
    /// Width, height and depth of a cell in metres.
    pub cell: Vec3,
    /// Cells along each axis.
    pub count: Vec3,
    /// Index of the first cell in the scene's data, for cells with lists.
    pub cells: i32,
    /// Index of the first group; only lists of nearest candidates have groups.
    pub groups: i32,
    /// Number of groups.
    pub group_count: i32,
    /// The grids of the kinds with separate cells, [`GRID_VECTORS`] vectors each: origin and index of the first record;
    /// size of a cell and number of the last cell; the two corners of the box around all surfaces; the step of the cell
    /// number along each axis, and the maximum number of records on a line.
    pub grids: Vec<Vec4>,
}

/// Writes the scene's data.
struct Writer<'a> {
    data: &'a mut Vec<Vec4>,
    origin: DVec3,
    rebased: &'a RebasedScene,
    directory: usize,
}

impl CellData {
    /// Appends the data of the surfaces in cells to the scene's data. If the scene has materials, the data include the
    /// material numbers (`materials.rs`).
    pub fn append(
        data: &mut Vec<Vec4>,
        layout: &Layout,
        rebased: &RebasedScene,
        cells: &SceneCells,
        materials: &[f32],
    ) -> CellData {
        let mut writer = Writer {
            directory: data.len(),
            data,
            origin: rebased.rebasing().origin.as_dvec3(),
            rebased,
        };
        let mut told = CellData {
            directory: writer.directory as i32,
            ..CellData::default()
        };
        writer.directory(layout, materials);
        for (kind, cells) in cells.kinds() {
            let record = Record::of(rebased.surface(layout.instanced[*kind]));
            told.grids.extend(writer.records(record, cells));
        }
        if let Some(lists) = cells.lists() {
            writer.lists(lists, cells.which(), &mut told);
        }
        if cells.which() == Lists::NearestCandidates {
            writer.groups(cells.lists().map_or(&[], Cells::groups), &mut told);
        }
        told
    }
}

impl Writer<'_> {
    fn local(&self, place: DVec3) -> Vec3 {
        (place - self.origin).as_vec3()
    }

    /// Appends the directory, followed by the values.
    fn directory(&mut self, layout: &Layout, materials: &[f32]) {
        let mut values = Vec::new();
        let first = self.directory + layout.kind_of.len();
        for (index, kind) in layout.kind_of.iter().enumerate() {
            let (kind, place) = match kind {
                Some(kind) => (*kind as f32, (first + values.len()) as f32),
                None => (-1.0, 0.0),
            };
            let material = materials.get(index).copied().unwrap_or(0.0);
            self.data
                .push(Vec4::new(number(index), kind, place, material));
            if kind >= 0.0 {
                self.rebased.push_data(index, &mut values);
            }
        }
        self.data.append(&mut values);
    }

    /// Appends the records of a kind's cells, and returns its grid.
    fn records(&mut self, record: Record, cells: &Cells) -> [Vec4; GRID_VECTORS] {
        let grid = cells.grid();
        let first = self.data.len();
        self.data
            .resize(first + record.vectors * grid.cells(), Vec4::ZERO);
        let mut values = Vec::new();
        let mut records = Vec::new();
        cells.for_each_list(Lists::Lines, |cell, list| {
            let own = first + record.vectors * cell;
            records.clear();
            for (place, &index) in list.iter().enumerate() {
                let is_last = place + 1 == list.len();
                let number = number(index as usize);
                values.clear();
                self.rebased.push_data(index as usize, &mut values);
                let tag = if is_last { number } else { -number };
                if record.has_box {
                    values.splice(0..0, self.rebased.box_around(index as usize));
                }
                record.push(tag, &values, &mut records);
            }
            match list.len() {
                0 => (),
                1 => self.data[own..own + record.vectors].copy_from_slice(&records),
                _ => {
                    self.data[own].x = self.data.len() as f32;
                    self.data.extend_from_slice(&records);
                }
            }
        });
        // The box around all surfaces. Lists extend further, because their margin is wider.
        let inner = grid.inner.grown(0.01 * grid.cell);
        let (low, high) = (self.local(inner.min), self.local(inner.max));
        let spare = spare(low, high);
        let strides = UVec3::new(1, grid.count.x, grid.count.x * grid.count.y);
        [
            self.local(grid.origin).extend(first as f32),
            grid.cell.as_vec3().extend((grid.cells() - 1) as f32),
            (low - spare).extend(0.0),
            (high + spare).extend(0.0),
            strides
                .as_vec3()
                .extend(cells.records_on_line(Lists::Lines) as f32),
        ]
    }

    /// Appends cells whose lists consist of directory entries.
    fn lists(&mut self, cells: &Cells, which: Lists, told: &mut CellData) {
        let grid = cells.grid();
        let first_cell = self.data.len();
        self.data.resize(first_cell + grid.cells(), Vec4::ZERO);
        cells.for_each_list(which, |cell, list| {
            let place = self.data.len() as f32;
            self.data[first_cell + cell] = Vec4::new(place, list.len() as f32, 0.0, 0.0);
            self.entries(list);
        });
        told.origin = self.local(grid.origin);
        told.cell = grid.cell.as_vec3();
        told.count = grid.count.as_vec3();
        told.cells = first_cell as i32;
    }

    fn groups(&mut self, groups: &[Group], told: &mut CellData) {
        let first_group = self.data.len();
        self.data.resize(first_group + 2 * groups.len(), Vec4::ZERO);
        for (group, place) in groups.iter().zip((first_group..).step_by(2)) {
            let (low, high) = (self.local(group.bounds.min), self.local(group.bounds.max));
            let spare = spare(low, high);
            self.data[place] = (low - spare).extend(self.data.len() as f32);
            self.data[place + 1] = (high + spare).extend(group.surfaces.len() as f32);
            self.entries(&group.surfaces);
        }
        told.groups = first_group as i32;
        told.group_count = groups.len() as i32;
    }

    /// Appends the directory entries of the surfaces with these indices.
    fn entries(&mut self, list: &[u32]) {
        let directory = self.directory;
        for &index in list {
            self.data.push(self.data[directory + index as usize]);
        }
    }
}

/// Maximum rounding error of the sides of a box.
fn spare(low: Vec3, high: Vec3) -> Vec3 {
    // A coordinate that represents an infinite extent is not used in any computation.
    let places = low.abs().max(high.abs());
    let ends = places.cmplt(Vec3::splat(0.5 * ENDLESS as f32));
    Vec3::splat(rounding_of(Vec3::select(ends, places, Vec3::ZERO)))
}

/// The number of a surface in the shader.
fn number(index: usize) -> f32 {
    (index + 1) as f32
}

/// The layout of a record: the positions of the tag and of the values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Record {
    /// Whether the surface's box precedes the values.
    pub has_box: bool,
    /// Whether a separate vector for the tag comes first.
    pub has_head: bool,
    /// The component of the first vector that holds the tag.
    pub tag: usize,
    /// Number of vectors in a record.
    pub vectors: usize,
}

impl Record {
    /// The record layout of a surface's kind.
    pub fn of(surface: &Surface) -> Record {
        let has_box = is_marched(surface);
        let free = match surface.shape.node {
            _ if has_box => Some(3),
            Node::Cuboid(_) => Some(3),
            Node::Cylinder(_) if !surface.has_rotation() => Some(1),
            _ => None,
        };
        let values = value_count(surface, true) + if has_box { BOX_VECTORS } else { 0 };
        Record {
            has_box,
            has_head: free.is_none(),
            tag: free.unwrap_or(1),
            vectors: values + usize::from(free.is_none()),
        }
    }

    /// The tag's name in GLSL.
    pub fn component(&self) -> &'static str {
        ["x", "y", "z", "w"][self.tag]
    }

    /// Appends the record of a surface with these values.
    pub fn push(&self, tag: f32, values: &[Vec4], records: &mut Vec<Vec4>) {
        let first = records.len();
        if self.has_head {
            records.push(Vec4::ZERO);
        }
        records.extend_from_slice(values);
        records[first][self.tag] = tag;
    }
}
