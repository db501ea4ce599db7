//! The compiled form of a scene for the GPU.
//!
//! Frames, pictures and the arrivals of a response pass their scene to [`CompiledScene::update`], and take everything
//! that depends on the scene from the result:
//!
//! | part | derived from | derived again |
//! | --- | --- | --- |
//! | [`Structure`]: layout, assets, key of the programs | the surfaces, without their positions | once a frame; the only derivation of a layout |
//! | turns of the loops ([`StructureTurns`]) | the structure | when the key changes |
//! | heights of images and meshes, the first part of the data | the structure | when the key changes |
//! | origin, and the surfaces relative to it ([`RebasedScene`]) | positions, sizes, the listener | once a frame |
//! | values of `uSurfaces` | the surfaces relative to the origin | once a frame |
//! | cells ([`SceneCells`]) | positions, sizes | for the surfaces that moved |
//! | the rest of the data: directory, records, lists, materials | all of the above | once a frame |
//!
//! The shader text is written from the same structure, and only if no program has the key (`pass_texts.rs`,
//! `arrivals_shader.rs`). The structure is derived first, because users' fields are checked with the text, and their
//! distances are unknown before this check.

use super::cells::SceneCells;
use super::materials::Materials;
use super::origin_rebasing::{OriginRebasing, RebasedScene};
use super::pass_texts::AlgorithmText;
use super::scene_data::{self, CellData};
use super::structure::Structure;
use super::text::Text;
use super::turn_budget::{Budget, LoopsAsked, StructureTurns};
use crate::scene::{Listener, Scene};
use glam::{Vec3, Vec4};

/// A scene in the form that the shaders of one algorithm read. See the table of this module.
#[derive(Clone, Debug, Default)]
pub(crate) struct CompiledScene {
    pub structure: Structure,
    turns: StructureTurns,
    surfaces: RebasedScene,
    /// The values of `uSurfaces`.
    pub values: Vec<Vec4>,
    cells: Option<SceneCells>,
    /// The vectors that `sceneData(index)` reads.
    pub data: Vec<Vec4>,
    /// Number of vectors of the data that hold heights of images, and meshes.
    heights: usize,
    /// The positions of the cells in the data, if the scene has cells.
    pub cell_data: Option<CellData>,
    /// Index of the table of materials in the data, if there is one.
    pub material_table: Option<usize>,
}

impl AlgorithmText {
    /// The structure of a scene for the shaders of this algorithm.
    pub fn structure(self, scene: &Scene) -> Structure {
        Structure::of(scene, self.lists())
    }

    /// The coordinates for this algorithm. The profile `thesis` uses world coordinates.
    pub fn rebasing(self, listener: &Listener) -> OriginRebasing {
        match self {
            AlgorithmText::Thesis => OriginRebasing::world(),
            AlgorithmText::March | AlgorithmText::Hybrid => OriginRebasing::at(listener),
        }
    }
}

impl CompiledScene {
    /// Replaces the content by a scene in its current state, in these coordinates. The material numbers are included
    /// for shaders that read them. `structure` is the [structure](AlgorithmText::structure) of the scene for the
    /// algorithm of the shaders. If its key is unchanged, the turns of the loops, the heights and the cells of surfaces
    /// that did not move are kept.
    pub fn update(
        &mut self,
        scene: &Scene,
        rebasing: OriginRebasing,
        structure: Structure,
        materials: &Materials,
    ) {
        let known = &self.structure;
        let is_same = structure.lists == known.lists && structure.key == known.key;
        self.structure = structure;
        if !is_same {
            self.turns = StructureTurns::of(&Text::new(scene, &self.structure));
            self.data = scene_data::assets(&self.structure.assets);
            self.heights = self.data.len();
        }
        self.place(scene, rebasing, materials);
    }

    /// Derives the parts that depend on positions, sizes and materials.
    fn place(&mut self, scene: &Scene, rebasing: OriginRebasing, materials: &Materials) {
        let Structure { lists, layout, .. } = &self.structure;
        self.surfaces = rebasing.apply(scene);
        self.values = self.surfaces.uniform_values(layout);
        let known = self.cells.as_mut();
        if !known.is_some_and(|cells| cells.update(scene, layout, *lists)) {
            self.cells = SceneCells::new(scene, layout, *lists);
        }
        self.data.truncate(self.heights);
        let (data, numbers) = (&mut self.data, materials.of_surfaces());
        let cells = self.cells.as_ref();
        self.cell_data =
            cells.map(|cells| CellData::append(data, layout, &self.surfaces, cells, numbers));
        let fit = materials.fit(layout.unrolled.len());
        self.material_table = (!materials.is_empty() && !fit).then_some(self.data.len());
        if let Some(first) = self.material_table {
            self.data.extend(materials.table(first));
        }
    }

    /// World position of the shaders' origin in metres.
    pub fn origin(&self) -> Vec3 {
        self.surfaces.rebasing().origin
    }

    /// A world point in the shaders' coordinates.
    pub fn local(&self, point: Vec3) -> Vec3 {
        self.surfaces.rebasing().place(point)
    }

    /// Maximum rounding error of the distance to a surface (numbered from 1), in metres.
    pub fn error_bound(&self, object: u32) -> f32 {
        self.surfaces.error_bound(object)
    }

    /// The limits of the passes' loops.
    pub fn budget(&self, asked: &LoopsAsked) -> Budget {
        let loops = self.turns.loops(self.cells.as_ref(), self.structure.lists);
        Budget::new(asked, &loops)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bands::BAND_COUNT;
    use crate::gl::{Context, ContextOptions};
    use crate::scene::shape::{Cuboid, Sphere, Torus};
    use crate::scene::{Material, Surface};
    use crate::shader::layout::layouts_derived;
    use crate::tracer::{ArrivalSettings, Profile, Settings, Tracer};
    use glam::Quat;

    /// Number of layouts that a call derives.
    fn derivations<T, E: std::fmt::Debug>(call: impl FnOnce() -> Result<T, E>) -> usize {
        let before = layouts_derived();
        call().unwrap();
        layouts_derived() - before
    }

    /// A room with two materials, and with enough boxes and fields for cells.
    fn crowd() -> Scene {
        let mut scene = Scene::builtin("shoebox").unwrap();
        let (ring, tube) = (0.2, 0.05);
        for index in 0..60 {
            let grid = Vec3::new(
                (index % 4) as f32,
                (index / 4 % 4) as f32,
                (index / 16) as f32,
            );
            let surface = match index % 2 {
                0 => Surface::new(Cuboid {
                    size: Vec3::splat(0.2),
                }),
                _ => Surface::new(Torus { ring, tube }),
            };
            let material = if index < 40 { "hard" } else { "soft" };
            let at = scene.listeners[0].position + 0.5 * (grid - 1.4);
            scene.surfaces.push(surface.at(at).with_material(material));
        }
        for (name, absorption) in [("hard", 0.1), ("soft", 0.6)] {
            let material = Material::absorbing(absorption);
            scene.materials.insert(name.to_owned(), material);
        }
        scene
    }

    /// Protects frames from deriving the layout of their scene more than once. This holds for the first frame, which
    /// compiles, and for every later frame with a surface that moves.
    #[test]
    fn a_frame_derives_one_layout() {
        let context = Context::headless(&ContextOptions::default()).unwrap();
        let scenes = [Scene::builtin("open-pillars").unwrap(), crowd()];
        for (mut scene, profile) in scenes
            .iter()
            .flat_map(|s| Profile::ALL.map(|p| (s.clone(), p)))
        {
            let mut tracer = Tracer::new(&context).unwrap();
            let settings = Settings::new(profile).with_waves(16);
            let first = derivations(|| tracer.frame(&scene, &settings));
            scene.surfaces[1].position.y += 0.01;
            let warm = derivations(|| tracer.frame(&scene, &settings));
            let waves = derivations(|| tracer.frame_with_waves(&scene, &settings));
            assert_eq!((first, warm, waves), (1, 1, 1), "{} {profile}", scene.name);
        }
    }

    /// Protects the arrivals of responses, and pictures, from deriving the layout more than once.
    #[test]
    fn arrivals_and_pictures_derive_one_layout() {
        let context = Context::headless(&ContextOptions::default()).unwrap();
        let mut tracer = Tracer::new(&context).unwrap();
        let mut scene = crowd();
        let (settings, how) = (
            Settings::default().with_waves(16),
            ArrivalSettings::new(0.01),
        );
        let mut arrivals =
            |scene: &Scene| derivations(|| tracer.arrivals(scene, &settings, &how, &mut |_| ()));
        assert_eq!(arrivals(&scene), 1);
        scene.surfaces[1].position.y += 0.01;
        assert_eq!(arrivals(&scene), 1);
        #[cfg(feature = "picture")]
        {
            let mut options = crate::picture::ViewOptions::default();
            (options.width, options.height) = (8, 8);
            let picture = || crate::picture::first_person(&context, &scene, &options);
            assert_eq!(derivations(picture), 1);
        }
    }

    /// Protects frames from remains of an earlier scene. After surfaces moved, turned or were added, and materials
    /// changed, an updated compiled scene equals a newly compiled one.
    #[test]
    fn an_updated_scene_is_the_same_as_a_new_one() {
        let mut scene = crowd();
        let mut scenes = vec![scene.clone()];
        scene.surfaces[2].position.x += 0.3;
        scene.listeners[0].position.z += 0.1;
        scenes.push(scene.clone());
        scene.surfaces[3].rotation = Quat::from_rotation_x(0.4);
        scenes.push(scene.clone());
        scene.surfaces.push(Surface::new(Sphere { radius: 0.1 }));
        scenes.push(scene.clone());
        scene.surfaces[4].material = None;
        scenes.extend([scene, Scene::builtin("cave").unwrap(), crowd()]);
        for algorithm in [
            AlgorithmText::Hybrid,
            AlgorithmText::March,
            AlgorithmText::Thesis,
        ] {
            let compile = |scene: &Scene| {
                let materials = Materials::of(scene, 0..BAND_COUNT);
                let structure = algorithm.structure(scene);
                let mut compiled = CompiledScene::default();
                let rebasing = algorithm.rebasing(&scene.listeners[0]);
                compiled.update(scene, rebasing, structure, &materials);
                compiled
            };
            let mut updated = compile(&scenes[0]);
            for scene in &scenes {
                let materials = Materials::of(scene, 0..BAND_COUNT);
                let rebasing = algorithm.rebasing(&scene.listeners[0]);
                updated.update(scene, rebasing, algorithm.structure(scene), &materials);
                let new = compile(scene);
                assert_eq!(updated.structure.key, new.structure.key);
                assert_eq!(updated.values, new.values);
                assert_eq!(updated.origin(), new.origin());
                assert_eq!(updated.turns, new.turns);
                assert_eq!(updated.material_table, new.material_table);
                let heights = |compiled: &CompiledScene| compiled.data[..compiled.heights].to_vec();
                assert_eq!(heights(&updated), heights(&new));
            }
        }
    }
}
