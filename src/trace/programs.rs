//! The shader programs of a frame, each compiled once for what its text depends on.

use super::{Algorithm, Directions, Settings, field_trial, scene_program};
use crate::error::Error;
use crate::gpu::{Context, Program, ProgramCache};
use crate::kernel::{self, AlgorithmText, ArrivalsText, Key, MarchText};
use crate::scene::Scene;
use std::num::NonZeroUsize;
use std::rc::Rc;

/// Programs that are kept at most: all three profiles of three scenes, and the passes that
/// know no scene. Mesa's llvmpipe holds some 2 MiB for each.
const PROGRAMS_KEPT: NonZeroUsize = NonZeroUsize::new(12).unwrap();

/// Programs by what their text depends on.
pub(super) struct Programs {
    cache: ProgramCache<Key>,
}

impl Default for Programs {
    fn default() -> Programs {
        Programs {
            cache: ProgramCache::new(PROGRAMS_KEPT),
        }
    }
}

impl Programs {
    /// Programs compiled so far.
    pub fn compiled(&self) -> usize {
        self.cache.compiled()
    }

    /// The initialise pass for a choice of directions.
    pub fn initialise(&mut self, context: &Context, of: Directions) -> Result<Rc<Program>, Error> {
        let text = || kernel::initialise_text(of);
        self.get(context, Key::Initialise(of), "initialise", text)
    }

    /// The march pass of a scene's structure.
    pub fn march(
        &mut self,
        context: &Context,
        scene: &Scene,
        settings: &Settings,
    ) -> Result<Rc<Program>, Error> {
        let options = march_options(settings);
        let key = Key::march(scene, options);
        let text = || kernel::march_text(scene, options);
        self.get_of_scene(context, key, "march", (scene, settings), text)
    }

    /// A whole frame of a scene's structure in one pass.
    pub fn whole_frame(
        &mut self,
        context: &Context,
        scene: &Scene,
        settings: &Settings,
    ) -> Result<Rc<Program>, Error> {
        let (options, directions) = (march_options(settings), settings.directions);
        let key = Key::whole_frame(scene, options, directions);
        let text = || kernel::whole_frame_text(scene, options, directions);
        self.get_of_scene(context, key, "frame", (scene, settings), text)
    }

    /// The pass that records arrivals in a scene's structure.
    pub fn arrivals(
        &mut self,
        context: &Context,
        scene: &Scene,
        options: &ArrivalsText,
    ) -> Result<Rc<Program>, Error> {
        let key = Key::arrivals(scene, options.clone());
        self.cache.get_or_compile(key, || {
            kernel::check(scene)?;
            let text = kernel::arrivals_text(scene, options);
            field_trial::ensure(scene, &[&text])?;
            let label = format!("arrivals of {}", scene.name);
            scene_program::compile(context, scene, &label, &text)
        })
    }

    /// The panning pass.
    pub fn pan(&mut self, context: &Context) -> Result<Rc<Program>, Error> {
        self.get(context, Key::Pan, "pan", kernel::pan_text)
    }

    /// The first pass of the sum on the GPU.
    pub fn first_sum(&mut self, context: &Context) -> Result<Rc<Program>, Error> {
        self.get(context, Key::FirstSum, "first sum", kernel::first_sum_text)
    }

    /// Its further passes.
    pub fn further_sum(&mut self, context: &Context) -> Result<Rc<Program>, Error> {
        self.get(
            context,
            Key::FurtherSum,
            "further sum",
            kernel::further_sum_text,
        )
    }

    /// A program whose text has the surfaces of a scene: these are checked before the first of
    /// their structure is compiled.
    fn get_of_scene(
        &mut self,
        context: &Context,
        key: Key,
        pass: &str,
        (scene, settings): (&Scene, &Settings),
        text: impl FnOnce() -> String,
    ) -> Result<Rc<Program>, Error> {
        self.cache.get_or_compile(key, || {
            kernel::check(scene)?;
            let label = format!("{pass} ({}) of {}", settings.profile(), scene.name);
            let text = text();
            field_trial::ensure(scene, &[&text])?;
            scene_program::compile(context, scene, &label, &text)
        })
    }

    fn get(
        &mut self,
        context: &Context,
        key: Key,
        label: &str,
        text: impl FnOnce() -> String,
    ) -> Result<Rc<Program>, Error> {
        let compile = || Ok(Program::fragment(context, label, &text())?);
        self.cache.get_or_compile(key, compile)
    }
}

/// What of the settings is in the text of a march.
pub(super) fn march_options(settings: &Settings) -> MarchText {
    MarchText {
        algorithm: match &settings.algorithm {
            Algorithm::Hybrid(_) => AlgorithmText::Hybrid,
            Algorithm::March(march) => AlgorithmText::March {
                exact_normals: march.variant.difference_normals.is_none(),
                projection: march.variant.projection,
            },
            Algorithm::Thesis(_) => AlgorithmText::Thesis,
        },
        count_evaluations: settings.count_evaluations,
    }
}

/// A pass over the waves that is drawn with a program of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Pass {
    /// The waves at the source.
    Initialise,
    /// The waves through the scene.
    March,
    /// What each wave gives to either side.
    Pan,
}

/// The fragment shader of a pass, as a [`Tracer`](super::Tracer) compiles it after the
/// driver's own header. Needs no context; the scene should have been
/// [checked](Scene::check).
pub fn shader_text(scene: &Scene, settings: &Settings, pass: Pass) -> String {
    match pass {
        Pass::Initialise => kernel::initialise_text(settings.directions),
        Pass::March => kernel::march_text(scene, march_options(settings)),
        Pass::Pan => kernel::pan_text(),
    }
}
