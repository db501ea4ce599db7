//! Rejects scenes whose text would compile for minutes.

use super::cells::Lists;
use super::layout::{Layout, MOST_UNROLLED};
use crate::scene::{Scene, SceneError};

/// What is unrolled in a scene's shader must compile in seconds.
///
/// # Errors
/// Those of [`Scene::check`], and [`SceneError::BadNumber`] for more surfaces, kinds of them,
/// and nodes of their fields than that.
pub(crate) fn check(scene: &Scene) -> Result<(), SceneError> {
    scene.check()?;
    let layout = Layout::of(&scene.surfaces, Lists::Lines);
    let unrolled = layout.unrolled.iter().chain(&layout.instanced);
    let nodes = |&index: &usize| scene.surfaces[index].shape.nodes().len();
    let pieces: usize = unrolled.map(nodes).sum();
    if pieces <= MOST_UNROLLED {
        return Ok(());
    }
    Err(SceneError::BadNumber {
        scene: scene.name.clone(),
        what: "what its shader holds one by one (surfaces, and shapes and operators within them)"
            .to_owned(),
        must: "at most 512",
        value: pieces.to_string(),
    })
}
