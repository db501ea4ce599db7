//! A scene's data on the GPU: heights, and the surfaces in cells with their lists.
//!
//! Kept from frame to frame: cells follow what moved, and only what changed is sent again.

use crate::error::Error;
use crate::gpu::{Context, DataTexture, Program};
use crate::kernel::{self, CellData, Cells, Layout, Lists, OriginRebasing, RebasedScene};
use crate::scene::Scene;

/// What the shaders of a scene read by index.
pub(crate) struct SceneData {
    texture: DataTexture,
    cells: Option<Cells>,
    cell_data: Option<CellData>,
}

impl SceneData {
    pub fn new(context: &Context) -> Result<SceneData, Error> {
        Ok(SceneData {
            texture: DataTexture::new(context, kernel::DATA_WIDTH)?,
            cells: None,
            cell_data: None,
        })
    }

    /// Makes the data those of the scene as it stands.
    pub fn set(
        &mut self,
        scene: &Scene,
        rebasing: &OriginRebasing,
        rebased: &RebasedScene,
        lists: Lists,
    ) -> Result<(), Error> {
        let layout = Layout::of(scene);
        match &mut self.cells {
            Some(cells) if layout.has_cells() => {
                cells.update(scene, &layout);
            }
            cells => *cells = Cells::new(scene, &layout),
        }
        let mut data = kernel::scene_data(scene);
        self.cell_data = self.cells.as_mut().map(|cells| {
            cells.prepare(lists);
            CellData::append(&mut data, &layout, rebasing, rebased, cells, lists)
        });
        self.texture.set(&data)?;
        Ok(())
    }

    /// The cells of the scene that was set last, if it has any.
    pub fn cells(&self) -> Option<&Cells> {
        self.cells.as_ref()
    }

    /// Sets the uniforms of a program that reads the data, but for the texture.
    pub fn set_uniforms(&self, program: &Program) {
        let Some(cells) = &self.cell_data else {
            return;
        };
        program.set_vec3("uCellOrigin", cells.origin);
        program.set_vec3("uCellSize", cells.cell);
        program.set_vec3("uCellCount", cells.count);
        program.set_i32("uCells", cells.cells);
        program.set_i32("uGroups", cells.groups);
        program.set_i32("uGroupCount", cells.group_count);
        program.set_i32("uDirectory", cells.directory);
    }

    /// Binds the texture to a unit.
    pub fn bind(&self, program: &Program, unit: u32) {
        program.set_texture("uSceneData", unit, self.texture.texture());
    }
}
