//! All cells of a scene, as the passes of a profile read them.
//!
//! Where lines are intersected in closed form each kind has cells of its own: a loop over them
//! tests one shape alone, and they are as fine as the kind is dense. All else lies together.

use super::{Cells, Lists};
use crate::kernel::layout::Layout;
use crate::kernel::text::is_marched;
use crate::scene::Scene;

/// The cells of a scene.
#[derive(Clone, Debug)]
pub struct SceneCells {
    layout: Layout,
    which: Lists,
    /// The kinds that have cells of their own, in their order.
    kinds: Vec<(usize, Cells)>,
    /// Those of the surfaces of all other kinds, if there are any.
    lists: Option<Cells>,
}

impl SceneCells {
    /// The cells of a scene with the lists requested, or `None` for one without.
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

    /// Follows the scene, if its layout is unchanged; otherwise reports that it is not.
    pub fn update(&mut self, scene: &Scene, layout: &Layout, which: Lists) -> bool {
        if *layout != self.layout || which != self.which {
            return false;
        }
        let own = self.kinds.iter_mut().map(|(_, cells)| cells);
        own.chain(&mut self.lists)
            .for_each(|cells| cells.update(scene));
        true
    }

    /// The kinds that have cells of their own, with these.
    pub fn kinds(&self) -> &[(usize, Cells)] {
        &self.kinds
    }

    /// Those of the surfaces of all other kinds, if there are any.
    pub fn lists(&self) -> Option<&Cells> {
        self.lists.as_ref()
    }

    /// Which lists these have.
    pub fn which(&self) -> Lists {
        self.which
    }
}

/// Whether a kind has cells of its own.
fn has_own_cells(scene: &Scene, layout: &Layout, which: Lists, kind: usize) -> bool {
    which == Lists::Lines && !is_marched(&scene.surfaces[layout.instanced[kind]])
}
