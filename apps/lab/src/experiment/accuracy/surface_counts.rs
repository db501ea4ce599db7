//! Counts the surfaces of a scene, those in cells, and those that are marched.

use echomarch::internals::shader::{Layout, Lists, is_marched};
use echomarch::scene::Scene;
use serde::Serialize;

/// The numbers of a scene's surfaces by kind of intersection.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct SurfaceCounts {
    /// Number of all surfaces.
    pub all: usize,
    /// Number of surfaces in cells.
    pub in_cells: usize,
    /// Number of surfaces without a closed form, which are marched even in `hybrid`.
    pub marched: usize,
}

impl SurfaceCounts {
    /// Counts the surfaces of a scene.
    pub fn of(scene: &Scene) -> SurfaceCounts {
        let in_cells = Layout::of(&scene.surfaces, Lists::Lines)
            .kind_of
            .iter()
            .flatten()
            .count();
        SurfaceCounts {
            all: scene.surfaces.len(),
            in_cells,
            marched: scene.surfaces.iter().filter(|s| is_marched(s)).count(),
        }
    }
}
