//! The shader programs of a frame, each compiled once for what its text depends on.

use super::{Directions, Profile, Settings, trial};
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
    March(Structure, Options),
    Pan,
    SumContributions,
    Sum,
}

/// Settings that are in the text of a march.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Options {
    profile: Profile,
    exact_normals: bool,
    landing: bool,
    count_evaluations: bool,
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
        let options = Options::of(settings);
        let key = Key::March(glsl::structure(scene), options);
        self.cache.get_or_compile(key, || {
            // What is checked once for a structure.
            scene.check()?;
            let label = format!("march ({}) of {}", settings.profile, scene.name);
            let text = glsl::join(&march_sources(scene, options));
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

impl Options {
    /// Of the thesis' and the closed-form text nothing depends on normals and landing.
    fn of(settings: &Settings) -> Options {
        let is_march = settings.profile == Profile::March;
        Options {
            profile: settings.profile,
            exact_normals: is_march && settings.exact_normals,
            landing: is_march && settings.landing,
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
        Pass::March => march_sources(scene, Options::of(settings)),
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
fn march_sources(scene: &Scene, options: Options) -> Vec<Source> {
    let counters = match options.count_evaluations {
        true => source!("counters_evaluations.glsl"),
        false => source!("counters.glsl"),
    };
    let mut roots = vec![source!("wave.glsl"), counters];
    let parts = match options.profile {
        Profile::Thesis => {
            roots.push(source!("iterate_thesis.glsl"));
            glsl::distance_parts(scene)
        }
        Profile::March => {
            roots.push(Source::new("options", defines(options, scene)));
            roots.push(source!("iterate_march.glsl"));
            glsl::ahead_parts(scene, !options.exact_normals)
        }
        Profile::Hybrid => {
            let marches = u8::from(glsl::marches_fields(scene, false));
            let options = format!("#define MARCHES_FIELDS {marches}\n");
            roots.push(Source::new("options", options));
            roots.push(source!("iterate_hybrid.glsl"));
            glsl::closed_form_parts(scene)
        }
    };
    roots.push(source!("iterate.frag"));
    glsl::link(roots, parts)
}

fn defines(options: Options, scene: &Scene) -> String {
    format!(
        "#define EXACT_NORMALS {}\n#define LANDING {}\n#define MARCHES_FIELDS {}\n",
        u8::from(options.exact_normals),
        u8::from(options.landing),
        u8::from(glsl::marches_fields(scene, true))
    )
}
