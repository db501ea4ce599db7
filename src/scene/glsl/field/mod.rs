//! A field as shader text: its value, its gradient, and where a line meets it.
//!
//! Each tree becomes straight-line code, one statement a node, in functions that are named
//! after the surface's number: `field3(p)`, `gradient3(p)` (the gradient, and in its last
//! component the value), where there is a closed form `hit3(p, d, slack)`, of copies
//! `hit3(p, d, slack, limit)`, and for the march `free3(p, d, slack)`. Value and gradient are the same text over two types: `float`, and `vec4` for a value with its
//! gradient, which the operators take along (forward differentiation).
//!
//! Numbers are literals. Those of a node that something moves are uniforms instead, all of
//! them at once, because several follow from one parameter (a rotation's nine).

mod along;
mod copies;
mod hit;
mod numbers;
mod signature;
mod text;
mod user;

pub(super) use along::{free_text, is_bounded, leaps};
pub(super) use copies::{cells_crossed, has_step_limit};
pub(super) use hit::{has_closed_form, hit_text, takes_limit};
pub(super) use numbers::moving_values;
pub(super) use signature::{Signature, signature};
pub(super) use text::{gradient_text, has_differences, normal_text, value_text};
pub(super) use user::{user_parts, user_text};

use crate::scene::layout::Layout;
use crate::scene::shape::{HeightField, User};
use crate::scene::{HeightImage, Node, Scene, Shape};
use numbers::Numbers;
use std::sync::Arc;

/// Writes a function of a field.
pub(super) type Write = fn(&Shape, &Place, &Assets) -> String;

/// What the text of a field is about: a surface, or a kind of surfaces.
pub(super) struct Place<'a> {
    /// What its functions are called after.
    pub tag: &'a str,
    /// What its functions take beside the point, with a comma before it.
    pub parameter: &'a str,
    /// What they are given for that.
    pub argument: &'a str,
    /// Nodes whose numbers move, in the order of [`Shape::nodes`].
    pub moving: &'a [bool],
    /// The n-th vector of the numbers that move.
    pub value: &'a dyn Fn(usize) -> String,
}

/// What the text of one field is written with.
pub(super) struct Writer<'a> {
    numbers: Numbers<'a>,
    place: &'a Place<'a>,
    /// Where each height image and user's field of the scene lies.
    assets: &'a Assets,
    next_name: usize,
    /// Functions that the one being written calls.
    functions: String,
    body: String,
}

/// Things of a scene that its text refers to by number, each once.
#[derive(Clone, Debug, Default)]
pub(super) struct Assets {
    /// Index of the first height of each image in the scene's data.
    pub images: Vec<(Arc<HeightImage>, usize)>,
    /// Users' fields of different texts, numbered by their place.
    pub users: Vec<Arc<crate::scene::UserField>>,
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
            match &node.node {
                Node::HeightField(HeightField { image, .. }) if self.image(image).is_none() => {
                    let first = self.data_length();
                    self.images.push((Arc::clone(image), first));
                }
                Node::User(User { field }) if self.user(field).is_none() => {
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
        let surfaces = layout.loose.iter().chain(&layout.kinds);
        let fields = surfaces.map(|&index| &scene.surfaces[index].shape);
        let images = fields.flat_map(Shape::nodes).filter_map(|f| match &f.node {
            Node::HeightField(HeightField { image, .. }) => self.image(image),
            _ => None,
        });
        images.collect()
    }

    fn image(&self, image: &Arc<HeightImage>) -> Option<usize> {
        let same = |known: &Arc<HeightImage>| Arc::ptr_eq(known, image) || **known == **image;
        let known = self.images.iter().find(|(known, _)| same(known));
        known.map(|(_, first)| *first)
    }

    fn user(&self, field: &crate::scene::UserField) -> Option<usize> {
        // Size and growth are arguments of its functions.
        let same =
            |known: &crate::scene::UserField| known.file == field.file && known.text == field.text;
        self.users.iter().position(|known| same(known))
    }
}
