//! The structure of a scene: the layout and assets that determine its shader text, and the key of its programs.
//!
//! A [`Structure`] is derived once per frame and passed to everything that needs it: the checks of the renderer's
//! limits, the texts, their keys and the [compiled scene](super::CompiledScene). The structure contains no position:
//! two scenes with equal [keys](StructureKey) have the same text.

use super::cells::Lists;
use super::layout::{GRID_VECTORS, Layout, MOST_UNROLLED, SurfaceStructure};
use super::mesh_data::mesh_length;
use super::origin_rebasing::value_count;
use crate::scene::mesh::TriangleMesh;
use crate::scene::shape::Asset;
use crate::scene::{HeightImage, SampledField, Scene, SceneError, Shape, UserField};
use std::rc::Rc;
use std::sync::Arc;

/// The structure of a scene for shaders that read certain lists of cells.
#[derive(Clone, Debug, Default)]
pub struct Structure {
    /// The lists of cells that the text reads.
    pub lists: Lists,
    /// The division of the surfaces into unrolled surfaces and surfaces in cells.
    pub layout: Layout,
    /// Height images and users' fields.
    pub(super) assets: Assets,
    /// The key of the programs: scenes with equal keys share programs.
    pub key: Rc<StructureKey>,
}

/// The parameters that determine the shader text of a scene. Each unrolled surface contributes its shape, whether it
/// has a rotation, and the fixed part of its field. Surfaces in cells contribute only their kinds, and the axes along
/// which cells are infinite. Two scenes with equal keys share their programs.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) struct StructureKey {
    /// Unrolled surfaces with their indices.
    unrolled: Vec<(usize, SurfaceStructure)>,
    instanced: Vec<SurfaceStructure>,
    unbounded_axes: [bool; 3],
    /// Index in the scene's data of each image and of each mesh, in the order of the text.
    places: Vec<usize>,
}

impl Structure {
    /// The structure of a scene for shaders that read these lists.
    pub fn of(scene: &Scene, lists: Lists) -> Structure {
        let layout = Layout::of(&scene.surfaces, lists);
        let assets = Assets::of(scene);
        let unrolled = |&index: &usize| (index, SurfaceStructure::unrolled(&scene.surfaces[index]));
        let as_data = |&index: &usize| SurfaceStructure::as_data(&scene.surfaces[index]);
        let key = StructureKey {
            unrolled: layout.unrolled.iter().map(unrolled).collect(),
            instanced: layout.instanced.iter().map(as_data).collect(),
            unbounded_axes: layout.unbounded_axes,
            places: assets.places(&layout, scene),
        };
        Structure {
            lists,
            layout,
            assets,
            key: Rc::new(key),
        }
    }

    /// Maximum uniform vectors of the scene's surfaces and grids.
    pub fn uniform_count(&self, scene: &Scene) -> usize {
        let unrolled = self.layout.unrolled.iter();
        let values = unrolled.map(|&index| value_count(&scene.surfaces[index], false));
        values.sum::<usize>() + GRID_VECTORS * self.layout.instanced.len()
    }

    /// Checks the scene once before its text is compiled: its fields must be valid, and the text must be small enough
    /// to compile within seconds.
    ///
    /// # Errors
    /// The errors of [`Scene::check`]; [`SceneError::BadNumber`] for more than [`MOST_UNROLLED`] unrolled surfaces,
    /// kinds and nodes of their fields.
    pub fn check(&self, scene: &Scene) -> Result<(), SceneError> {
        scene.check()?;
        if self.layout.pieces(scene) <= MOST_UNROLLED {
            return Ok(());
        }
        // The limit applies to the layout for lines, which has the fewest pieces, so that every profile accepts the
        // same scenes.
        let pieces = Layout::of(&scene.surfaces, Lists::Lines).pieces(scene);
        if pieces <= MOST_UNROLLED {
            return Ok(());
        }
        Err(SceneError::BadNumber {
            scene: scene.name.clone(),
            what: "the number of unrolled surfaces, kinds, shapes and operators in its shader"
                .to_owned(),
            must: "at most 512",
            value: pieces.to_string(),
        })
    }
}

/// The index of an asset among the known ones, in the scene's data.
fn first_of<T: PartialEq>(known: &[(Arc<T>, usize)], asset: &Arc<T>) -> Option<usize> {
    let is_it = |known: &Arc<T>| Arc::ptr_eq(known, asset) || **known == **asset;
    let found = known.iter().find(|(known, _)| is_it(known));
    found.map(|(_, first)| *first)
}

/// The assets that the text of a scene refers to by number, without duplicates.
#[derive(Clone, Debug, Default)]
pub(super) struct Assets {
    /// Each image, with the index of its first height in the scene's data.
    pub images: Vec<(Arc<HeightImage>, usize)>,
    /// Each sampled field, with the index of its first vector in the scene's data.
    pub samples: Vec<(Arc<SampledField>, usize)>,
    /// Each mesh, with the index of its first vector in the scene's data.
    pub meshes: Vec<(Arc<TriangleMesh>, usize)>,
    /// Number of vectors in the scene's data that images, sampled fields and meshes take.
    pub data_length: usize,
    /// Users' fields with different texts. The number of a field is its index here.
    pub users: Vec<Arc<UserField>>,
}

impl Assets {
    /// The assets of a scene.
    pub fn of(scene: &Scene) -> Assets {
        let mut assets = Assets::default();
        for surface in &scene.surfaces {
            assets.add(&surface.shape);
        }
        assets
    }

    fn add(&mut self, field: &Shape) {
        for node in field.nodes() {
            match node.node.asset() {
                Some(Asset::Image(image)) if self.image(image).is_none() => {
                    self.images.push((Arc::clone(image), self.data_length));
                    self.data_length += image.heights().len();
                }
                Some(Asset::Samples(field)) if self.samples(field).is_none() => {
                    self.samples.push((Arc::clone(field), self.data_length));
                    self.data_length += field.values().len();
                }
                Some(Asset::Mesh(mesh)) if self.mesh(mesh).is_none() => {
                    self.meshes.push((Arc::clone(mesh), self.data_length));
                    self.data_length += mesh_length(mesh);
                }
                Some(Asset::User(field)) if self.user(field).is_none() => {
                    self.users.push(Arc::clone(field));
                }
                _ => (),
            }
        }
    }

    /// The indices of the images, sampled fields and meshes that the text uses, in the order of the text.
    pub fn places(&self, layout: &Layout, scene: &Scene) -> Vec<usize> {
        if self.data_length == 0 {
            return Vec::new();
        }
        let surfaces = layout.unrolled.iter().chain(&layout.instanced);
        let fields = surfaces.map(|&index| &scene.surfaces[index].shape);
        let places = fields
            .flat_map(Shape::nodes)
            .filter_map(|f| match f.node.asset() {
                Some(Asset::Image(image)) => self.image(image),
                Some(Asset::Samples(field)) => self.samples(field),
                Some(Asset::Mesh(mesh)) => self.mesh(mesh),
                _ => None,
            });
        places.collect()
    }

    /// The index of an image in the scene's data.
    pub fn image(&self, image: &Arc<HeightImage>) -> Option<usize> {
        first_of(&self.images, image)
    }

    /// The index of a sampled field in the scene's data.
    pub fn samples(&self, field: &Arc<SampledField>) -> Option<usize> {
        first_of(&self.samples, field)
    }

    /// The index of a mesh in the scene's data.
    pub fn mesh(&self, mesh: &Arc<TriangleMesh>) -> Option<usize> {
        first_of(&self.meshes, mesh)
    }

    pub fn user(&self, field: &UserField) -> Option<usize> {
        // Size and Lipschitz constant are arguments of the field's functions, so they need not be equal. The check of a
        // derivative may have different results in two boxes, so its result must be equal.
        let same = |known: &UserField| {
            known.file == field.file
                && known.text == field.text
                && known.is_differentiated() == field.is_differentiated()
        };
        self.users.iter().position(|known| same(known))
    }
}
