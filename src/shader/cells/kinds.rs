//! All cells of a scene, in the form that a profile's passes read.
//!
//! If lines are intersected in closed form, each kind has separate cells: a loop over them tests
//! only one shape, and the size of the cells suits the density of that kind. All other surfaces
//! share cells.

use super::{Cells, Lists};
use crate::scene::Scene;
use crate::shader::layout::Layout;
use crate::shader::text::is_marched;

/// The cells of a scene.
#[derive(Clone, Debug)]
pub struct SceneCells {
    layout: Layout,
    which: Lists,
    /// The kinds with separate cells, in their order.
    kinds: Vec<(usize, Cells)>,
    /// The cells of all other kinds, if there are any.
    lists: Option<Cells>,
}

impl SceneCells {
    /// The cells of a scene with the requested lists, or `None` for a scene without cells.
    pub fn new(scene: &Scene, layout: &Layout, which: Lists) -> Option<SceneCells> {
        if !layout.has_cells() {
            return None;
        }
        let is_own = |kind: usize| has_own_cells(scene, layout, which, kind);
        let axes = layout.unbounded_axes;
        let own = (0..layout.instanced.len()).filter(|&kind| is_own(kind));
        let cells = |kind| Cells::new(scene, &layout.surfaces_of(|k| k == kind), axes);
        let others = layout.surfaces_of(|kind| !is_own(kind));
        let mut lists = (!others.is_empty()).then(|| Cells::new(scene, &others, axes));
        if let Some(lists) = &mut lists {
            lists.prepare(which);
        }
        Some(SceneCells {
            layout: layout.clone(),
            which,
            kinds: own.map(|kind| (kind, cells(kind))).collect(),
            lists,
        })
    }

    /// Updates the cells to the scene and returns true if its layout is unchanged; otherwise
    /// returns false.
    pub fn update(&mut self, scene: &Scene, layout: &Layout, which: Lists) -> bool {
        if *layout != self.layout || which != self.which {
            return false;
        }
        let own = self.kinds.iter_mut().map(|(_, cells)| cells);
        own.chain(&mut self.lists)
            .for_each(|cells| cells.update(scene));
        true
    }

    /// The kinds with separate cells, and these cells.
    pub fn kinds(&self) -> &[(usize, Cells)] {
        &self.kinds
    }

    /// The cells of all other kinds, if there are any.
    pub fn lists(&self) -> Option<&Cells> {
        self.lists.as_ref()
    }

    /// The kind of lists.
    pub fn which(&self) -> Lists {
        self.which
    }
}

/// Whether a kind has separate cells.
fn has_own_cells(scene: &Scene, layout: &Layout, which: Lists, kind: usize) -> bool {
    which == Lists::Lines && !is_marched(&scene.surfaces[layout.instanced[kind]])
}
