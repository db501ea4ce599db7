//! Large things of a scene that its text refers to by number: height images and users' fields.

use super::layout::Layout;
use crate::scene::shape::Asset;
use crate::scene::{HeightImage, Scene, Shape, UserField};
use std::sync::Arc;

/// Things of a scene that its text refers to by number, each once.
#[derive(Clone, Debug, Default)]
pub(super) struct Assets {
    /// Index of the first height of each image in the scene's data.
    pub images: Vec<(Arc<HeightImage>, usize)>,
    /// Users' fields of different texts, numbered by their place.
    pub users: Vec<Arc<UserField>>,
}

impl Assets {
    /// Those of a scene.
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
                    let first = self.data_length();
                    self.images.push((Arc::clone(image), first));
                }
                Some(Asset::User(field)) if self.user(field).is_none() => {
                    self.users.push(Arc::clone(field));
                }
                _ => (),
            }
        }
    }

    /// Vectors of scene data that the images take.
    pub fn data_length(&self) -> usize {
        self.images
            .last()
            .map_or(0, |(image, first)| first + image.heights().len())
    }

    /// Where the images of the surfaces that the text names lie, in its order.
    pub fn places(&self, layout: &Layout, scene: &Scene) -> Vec<usize> {
        if self.images.is_empty() {
            return Vec::new();
        }
        let surfaces = layout.unrolled.iter().chain(&layout.instanced);
        let fields = surfaces.map(|&index| &scene.surfaces[index].shape);
        let images = fields
            .flat_map(Shape::nodes)
            .filter_map(|f| match f.node.asset() {
                Some(Asset::Image(image)) => self.image(image),
                _ => None,
            });
        images.collect()
    }

    pub fn image(&self, image: &Arc<HeightImage>) -> Option<usize> {
        let same = |known: &Arc<HeightImage>| Arc::ptr_eq(known, image) || **known == **image;
        let known = self.images.iter().find(|(known, _)| same(known));
        known.map(|(_, first)| *first)
    }

    pub fn user(&self, field: &UserField) -> Option<usize> {
        // Size and growth are arguments of its functions.
        let same = |known: &UserField| known.file == field.file && known.text == field.text;
        self.users.iter().position(|known| same(known))
    }
}
