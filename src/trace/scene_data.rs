//! A scene's data on the GPU: heights, and the surfaces in cells with their lists.
//!
//! Kept from frame to frame: cells follow what moved, and only what changed is sent again.

use crate::error::Error;
use crate::gpu::{Context, DataList, Program};
use crate::kernel::{
    self, CellData, Layout, Lists, Materials, OriginRebasing, RebasedScene, SceneCells,
};
use crate::scene::Scene;

/// What the shaders of a scene read by index.
pub struct SceneData {
    list: DataList,
    cells: Option<SceneCells>,
    cell_data: Option<CellData>,
    /// The index of the table of materials, if there is one.
    material_table: Option<usize>,
}

impl SceneData {
    pub fn new(context: &Context) -> Result<SceneData, Error> {
        Ok(SceneData {
            list: DataList::new(context, kernel::DATA_WIDTH)?,
            cells: None,
            cell_data: None,
            material_table: None,
        })
    }

    /// Makes the data those of the scene as it stands, with the numbers of its surfaces' materials for shaders that
    /// read them; none for those that do not.
    pub fn set(
        &mut self,
        scene: &Scene,
        rebasing: &OriginRebasing,
        rebased: &RebasedScene,
        lists: Lists,
        materials: &Materials,
    ) -> Result<(), Error> {
        let layout = Layout::of(&scene.surfaces, lists);
        let known = self.cells.as_mut();
        if !known.is_some_and(|cells| cells.update(scene, &layout, lists)) {
            self.cells = SceneCells::new(scene, &layout, lists);
        }
        let mut data = kernel::scene_data(scene);
        let cells = self.cells.as_ref();
        self.cell_data = cells.map(|cells| {
            let numbers = materials.of_surfaces();
            CellData::append(&mut data, &layout, (rebasing, rebased), cells, numbers)
        });
        let rooms = materials.rooms().len();
        let has_table =
            !materials.is_empty() && !Materials::fit_uniforms(layout.unrolled.len(), rooms);
        self.material_table = has_table.then_some(data.len());
        if let Some(first) = self.material_table {
            data.extend(materials.table(first));
        }
        self.list.set(&data)?;
        Ok(())
    }

    /// The cells of the scene that was set last, if it has any.
    pub fn cells(&self) -> Option<&SceneCells> {
        self.cells.as_ref()
    }

    /// Sets the uniforms of a program that reads the data, but for the data themselves.
    pub fn set_uniforms(&self, program: &Program) {
        if let Some(first) = self.material_table {
            program.set_i32("uMaterialTable", first as i32);
        }
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
        program.set_vec4_array("uGrids", &cells.grids);
    }

    /// Binds the data to a unit.
    pub fn bind(&self, program: &Program, unit: u32) {
        self.list.bind(program, "uSceneData", unit);
    }
}
