//! The shader programs of a frame, each compiled once for what its text depends on.

use super::{Algorithm, Directions, Settings, trial};
use crate::error::Error;
use crate::gpu::{Context, Program, ProgramCache};
use crate::scene::Scene;
use crate::scene::glsl::{self, Source, Structure, source};
use std::num::NonZeroUsize;
use std::rc::Rc;

/// Programs that are kept at the most: all three profiles of three scenes, and the passes that
/// know no scene. Mesa's llvmpipe holds some 2 MiB for each.
const PROGRAMS_KEPT: NonZeroUsize = NonZeroUsize::new(12).unwrap();

/// What the text of a program depends on.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum Key {
    Initialise(Directions),
    March(Structure, MarchText),
    Pan,
    SumContributions,
    Sum,
}

/// Settings that are in the text of a march.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct MarchText {
    algorithm: AlgorithmText,
    count_evaluations: bool,
}

/// The algorithm, with those of its options that are in its text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum AlgorithmText {
    Hybrid,
    March { exact_normals: bool, landing: bool },
    Thesis,
}

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
        let sources = || initialise_sources(of);
        self.get(context, Key::Initialise(of), "initialise", sources)
    }

    /// The march pass of a scene's structure.
    pub fn march(
        &mut self,
        context: &Context,
        scene: &Scene,
        settings: &Settings,
    ) -> Result<Rc<Program>, Error> {
        let text = MarchText::of(settings);
        let key = Key::March(glsl::structure(scene), text);
        self.cache.get_or_compile(key, || {
            // What is checked once for a structure.
            scene.check()?;
            let label = format!("march ({}) of {}", settings.profile(), scene.name);
            let text = glsl::join(&march_sources(scene, text));
            trial::ensure(scene, &[&text])?;
            Ok(Program::fragment(context, &label, &text)?)
        })
    }

    /// The panning pass.
    pub fn pan(&mut self, context: &Context) -> Result<Rc<Program>, Error> {
        self.get(context, Key::Pan, "pan", pan_sources)
    }

    /// The first pass of the sum on the GPU.
    pub fn sum_contributions(&mut self, context: &Context) -> Result<Rc<Program>, Error> {
        let sources = || vec![source!("wave.glsl"), source!("sum_contributions.frag")];
        self.get(
            context,
            Key::SumContributions,
            "sum of contributions",
            sources,
        )
    }

    /// Its further passes.
    pub fn sum(&mut self, context: &Context) -> Result<Rc<Program>, Error> {
        self.get(context, Key::Sum, "sum", || vec![source!("sum.frag")])
    }

    fn get(
        &mut self,
        context: &Context,
        key: Key,
        label: &str,
        sources: impl FnOnce() -> Vec<Source>,
    ) -> Result<Rc<Program>, Error> {
        self.cache.get_or_compile(key, || {
            let text = glsl::join(&sources());
            Ok(Program::fragment(context, label, &text)?)
        })
    }
}

impl MarchText {
    fn of(settings: &Settings) -> MarchText {
        MarchText {
            algorithm: match &settings.algorithm {
                Algorithm::Hybrid(_) => AlgorithmText::Hybrid,
                Algorithm::March(march) => AlgorithmText::March {
                    exact_normals: march.variant.difference_normals.is_none(),
                    landing: march.variant.landing,
                },
                Algorithm::Thesis(_) => AlgorithmText::Thesis,
            },
            count_evaluations: settings.count_evaluations,
        }
    }
}

/// A pass over the waves that is drawn with a program of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Pass {
    /// The waves at the source.
    Initialise,
    /// The waves through the scene.
    March,
    /// What each wave gives to either side.
    Pan,
}

/// The fragment shader of a pass, as a [`Tracer`](super::Tracer) compiles it after the
/// driver's own [`header`](crate::gpu::header). Needs no context; the scene should have been
/// [checked](Scene::check).
pub fn shader_text(scene: &Scene, settings: &Settings, pass: Pass) -> String {
    glsl::join(&match pass {
        Pass::Initialise => initialise_sources(settings.directions),
        Pass::March => march_sources(scene, MarchText::of(settings)),
        Pass::Pan => pan_sources(),
    })
}

fn initialise_sources(of: Directions) -> Vec<Source> {
    let mut sources = vec![source!("wave.glsl")];
    sources.extend(match of {
        Directions::Random => vec![source!("direction/random.glsl")],
        Directions::Fibonacci => vec![
            source!("common/turn.glsl"),
            source!("direction/fibonacci.glsl"),
        ],
    });
    sources.push(source!("initialise.frag"));
    sources
}

fn pan_sources() -> Vec<Source> {
    vec![source!("wave.glsl"), source!("pan.frag")]
}

/// The fragment shader of a march pass, `#version` apart.
fn march_sources(scene: &Scene, text: MarchText) -> Vec<Source> {
    let counters = match text.count_evaluations {
        true => source!("counters_evaluations.glsl"),
        false => source!("counters.glsl"),
    };
    let mut roots = vec![source!("wave.glsl"), counters];
    let parts = match text.algorithm {
        AlgorithmText::Hybrid => {
            let marches_fields = glsl::marches_fields(scene, false);
            roots.push(defines(&[("MARCHES_FIELDS", marches_fields)]));
            roots.push(source!("iterate_hybrid.glsl"));
            glsl::closed_form_parts(scene)
        }
        AlgorithmText::March {
            exact_normals,
            landing,
        } => {
            roots.push(defines(&[
                ("EXACT_NORMALS", exact_normals),
                ("LANDING", landing),
                ("MARCHES_FIELDS", glsl::marches_fields(scene, true)),
            ]));
            roots.push(source!("iterate_march.glsl"));
            glsl::ahead_parts(scene, !exact_normals)
        }
        AlgorithmText::Thesis => {
            roots.push(source!("iterate_thesis.glsl"));
            glsl::distance_parts(scene)
        }
    };
    roots.push(source!("iterate.frag"));
    glsl::link(roots, parts)
}

/// What the preprocessor is told: each name as 1 or 0.
fn defines(options: &[(&str, bool)]) -> Source {
    let line = |(name, is_set): &(&str, bool)| format!("#define {name} {}\n", u8::from(*is_set));
    Source::new("options", options.iter().map(line).collect::<String>())
}
