//! How many surfaces of a scene lie in cells, and how many are marched.

use crate::kernel::{Layout, Lists, is_marched};
use crate::scene::Scene;
use serde::Serialize;

/// How the surfaces of a scene are met.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct SurfaceCounts {
    /// All of them.
    pub all: usize,
    /// Those that lie in cells.
    pub in_cells: usize,
    /// Those that `hybrid` too has to march to: fields without a closed form.
    pub marched: usize,
}

impl SurfaceCounts {
    /// Counts them.
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
