//! Limits of a renderer, checked before anything is made.

use super::{Grid, TraceError};
use crate::gpu::Context;
use crate::kernel;
use crate::scene::Scene;

/// Uniform vectors that any of the shaders needs at most beside those of the surfaces.
const OWN_UNIFORM_VECTORS: usize = 16;

/// Waves that do not fit in a texture are reported before anything is allocated.
pub(super) fn check_waves(context: &Context, grid: Grid) -> Result<(), TraceError> {
    let limit = context.limits().max_texture_size;
    if grid.width <= limit {
        return Ok(());
    }
    Err(TraceError::TooManyWaves {
        waves: grid.waves,
        side: grid.width,
        limit,
        most: u64::from(limit) * u64::from(limit),
        renderer: context.renderer().to_owned(),
    })
}

/// Surfaces that do not fit in the uniforms are reported before anything is compiled.
pub fn check_surfaces(context: &Context, scene: &Scene) -> Result<(), TraceError> {
    check_uniforms(context, scene, OWN_UNIFORM_VECTORS)
}

/// The same for a shader that needs so many vectors beside those of the surfaces.
pub(super) fn check_uniforms(
    context: &Context,
    scene: &Scene,
    own: usize,
) -> Result<(), TraceError> {
    let needed = kernel::uniform_count(scene) + own;
    let limit = context.limits().max_fragment_uniform_vectors as usize;
    if needed <= limit {
        return Ok(());
    }
    Err(TraceError::TooManySurfaces {
        surfaces: scene.surfaces.len(),
        needed,
        limit,
        renderer: context.renderer().to_owned(),
    })
}
