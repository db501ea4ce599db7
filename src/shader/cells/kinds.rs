//! All cells of a scene, in the form that the passes of a profile read.
//!
//! If lines are intersected with one surface after another, each kind has separate cells: the loop over these cells
//! tests only one shape, and the size of the cells suits the density of the kind. The cells of a marched kind list the
//! boxes around its surfaces, because a line enters the box before it can hit the surface. If a pass evaluates all
//! surfaces together, all kinds share cells.

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
        let is_own = |_: usize| which == Lists::Lines;
        let axes = layout.unbounded_axes;
        let own = (0..layout.instanced.len()).filter(|&kind| is_own(kind));
        let cells = |kind: usize| {
            let surfaces = layout.surfaces_of(|k| k == kind);
            match is_marched(&scene.surfaces[layout.instanced[kind]]) {
                true => Cells::of_boxes(scene, &surfaces, axes),
                false => Cells::new(scene, &surfaces, axes),
            }
        };
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
