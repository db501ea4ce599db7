//! The scene's data: what is too much for uniforms.

use super::field::Assets;
use crate::scene::Scene;
use glam::Vec4;

/// Vectors in a row of the texture `uSceneData`.
pub const DATA_WIDTH: usize = 1024;

/// The vectors that `sceneData(index)` reads; empty when the scene needs none. Height images
/// have a vector a pixel, its first component the height.
pub fn scene_data(scene: &Scene) -> Vec<Vec4> {
    let mut assets = Assets::default();
    for field in scene.surfaces.iter().filter_map(|s| s.shape.field()) {
        assets.add(field);
    }
    let mut data = Vec::with_capacity(assets.data_length());
    for (image, _) in &assets.images {
        data.extend(image.heights().iter().map(|h| Vec4::new(*h, 0.0, 0.0, 0.0)));
    }
    data
}
