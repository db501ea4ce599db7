//! A compiled scene on the GPU: its data are a list that shaders read by index, and its values are uniforms.
//!
//! Each tracer, and each view in a window, has a separate `GpuScene`, which is kept from frame to frame. The compiled
//! scene is updated in place, and its data are uploaded again only after a change.

use super::TraceError;
#[cfg(feature = "picture")]
use super::programs::compile_with_scene;
#[cfg(feature = "picture")]
use super::user_fields::UserFields;
use crate::error::Error;
use crate::gl::{Context, DataList, Program};
use crate::scene::Scene;
#[cfg(feature = "picture")]
use crate::shader::AlgorithmText;
use crate::shader::{CompiledScene, DATA_WIDTH, Materials, OriginRebasing, Structure};

/// Maximum uniform vectors of any shader in addition to those of the surfaces.
pub(super) const OWN_UNIFORM_VECTORS: usize = 16;

/// The algorithm for which the scenes of pictures are compiled. Its texts compute the distance to all objects, in world
/// coordinates.
#[cfg(feature = "picture")]
const OF_PICTURES: AlgorithmText = AlgorithmText::Thesis;

/// A compiled scene on the GPU.
pub(crate) struct GpuScene {
    list: DataList,
    /// The scene that was set last, in compiled form.
    pub(super) compiled: CompiledScene,
}

impl GpuScene {
    /// A `GpuScene` without a scene.
    ///
    /// # Errors
    /// [`Error::Gpu`] when the renderer fails.
    pub fn new(context: &Context) -> Result<GpuScene, Error> {
        Ok(GpuScene {
            list: DataList::new(context, DATA_WIDTH)?,
            compiled: CompiledScene::default(),
        })
    }

    /// Compiles the scene in its current state, and uploads its data. The arguments are those of
    /// [`CompiledScene::update`].
    ///
    /// # Errors
    /// [`Error::Gpu`] when the renderer fails.
    pub fn set(
        &mut self,
        scene: &Scene,
        rebasing: OriginRebasing,
        structure: Structure,
        materials: &Materials,
    ) -> Result<(), Error> {
        self.compiled.update(scene, rebasing, structure, materials);
        Ok(self.list.set(&self.compiled.data)?)
    }

    /// Sets the scene's uniforms in a program, except the data.
    pub fn set_uniforms(&self, program: &Program) {
        program.set_vec4_array("uSurfaces", &self.compiled.values);
        if let Some(first) = self.compiled.material_table {
            program.set_i32("uMaterialTable", first as i32);
        }
        let Some(cells) = &self.compiled.cell_data else {
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

    /// Binds the data to a texture unit for a program.
    pub fn bind(&self, program: &Program, unit: u32) {
        self.list.bind(program, "uSceneData", unit);
    }
}

/// Pictures of scenes.
#[cfg(feature = "picture")]
impl GpuScene {
    /// The structure of a scene for pictures.
    pub fn picture_structure(scene: &Scene) -> Structure {
        OF_PICTURES.structure(scene)
    }

    /// Compiles the program of a picture of a scene, after checking the scene and its users' fields. The text is
    /// written only if the scene fits in the uniforms.
    ///
    /// # Errors
    /// [`Error::Scene`] and [`Error::Trace`] for a scene that cannot be drawn; [`Error::Gpu`] when the renderer fails.
    pub fn picture_program(
        context: &Context,
        scene: &Scene,
        structure: &Structure,
        label: &str,
        text: impl Fn() -> String,
    ) -> Result<Program, Error> {
        structure.check(scene)?;
        check_uniforms(context, scene, structure, OWN_UNIFORM_VECTORS)?;
        UserFields::default().check(context, scene, structure, &text)?;
        compile_with_scene(context, scene, label, &text())
    }

    /// Sets the scene, and the scene's uniforms in the program of a picture.
    ///
    /// # Errors
    /// [`Error::Gpu`] when the renderer fails.
    pub fn set_picture(
        &mut self,
        scene: &Scene,
        structure: Structure,
        program: &Program,
    ) -> Result<(), Error> {
        let world = OriginRebasing::world();
        self.set(scene, world, structure, &Materials::default())?;
        self.set_uniforms(program);
        self.bind(program, 0);
        Ok(())
    }
}

/// Rejects surfaces that do not fit in the uniforms, before anything is compiled. `own` is the number of uniform
/// vectors that the shader needs in addition to those of the surfaces.
pub(super) fn check_uniforms(
    context: &Context,
    scene: &Scene,
    structure: &Structure,
    own: usize,
) -> Result<(), TraceError> {
    let needed = structure.uniform_count(scene) + own;
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
