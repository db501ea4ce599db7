//! The shader programs of a frame, each compiled once for the key of its text, and the settings that determine texts
//! and loops. An error in a user's text is reported for the user's file.

use super::{Algorithm, Directions, Settings, TraceError, field_trial};
use crate::error::Error;
use crate::gl::{Context, GpuError, Program, ProgramCache, log_errors};
use crate::scene::{Scene, UserField};
use crate::shader::{
    self, AlgorithmText, ArrivalsText, Budget, CompiledScene, LoopsAsked, MarchText, Materials,
    OriginRebasing, StartOrderText, Structure, StructureKey,
};
#[cfg(feature = "simulator")]
use std::hash::{DefaultHasher, Hash, Hasher};
use std::num::NonZeroUsize;
use std::rc::Rc;
use std::sync::Arc;

/// Maximum number of programs in the cache. This number holds the programs of all three profiles in three scenes, and
/// the passes without a scene. Mesa's llvmpipe uses about 2 MiB for each program.
const PROGRAMS_KEPT: NonZeroUsize = NonZeroUsize::new(12).unwrap();

/// The parameters that determine the text of a pass. Passes with equal keys share their programs.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum Key {
    Waves(WavePass),
    Scene(Rc<StructureKey>, ScenePass),
}

/// A pass over the waves whose text contains no scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum WavePass {
    Initialise(Directions, StartOrderText),
    Pan(StartOrderText),
    /// Rearranges contributions into the order of the waves.
    InOrder,
    /// The first pass of the summation on the GPU.
    FirstSum,
    /// The further passes of the summation.
    FurtherSum,
}

/// A pass whose text contains the surfaces of a scene.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) enum ScenePass {
    March(MarchText),
    /// All passes of a frame in one.
    WholeFrame(MarchText, (Directions, StartOrderText)),
    /// Traces waves through a chunk of iterations, past a transparent listener.
    Arrivals(ArrivalsText),
}

impl ScenePass {
    fn label_and_text(&self, scene: &Scene, structure: &Structure) -> (String, String) {
        let (name, algorithm, text) = match self {
            ScenePass::March(of) => {
                let text = shader::march_text(scene, structure, *of);
                ("march", of.algorithm, text)
            }
            ScenePass::WholeFrame(of, starts) => {
                let text = shader::whole_frame_text(scene, structure, *of, *starts);
                ("frame", of.algorithm, text)
            }
            ScenePass::Arrivals(of) => {
                let text = shader::arrivals_text(scene, structure, of);
                ("arrivals", of.algorithm, text)
            }
        };
        (
            format!("{name} ({}) of {}", algorithm.name(), scene.name),
            text,
        )
    }
}

/// Programs by the keys of their texts.
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
    /// Number of programs compiled.
    pub fn compiled(&self) -> usize {
        self.cache.compiled()
    }

    /// The program of a pass over a scene with this structure. The scene is checked before the first program of its
    /// structure is compiled.
    pub fn of_scene(
        &mut self,
        context: &Context,
        (scene, structure): (&Scene, &Structure),
        pass: ScenePass,
    ) -> Result<Rc<Program>, Error> {
        let key = Key::Scene(Rc::clone(&structure.key), pass.clone());
        self.cache.get_or_compile(key, || {
            structure.check(scene)?;
            let (label, text) = pass.label_and_text(scene, structure);
            field_trial::ensure(scene, &[&text])?;
            compile_with_scene(context, scene, &label, &text)
        })
    }

    /// The program of a pass without a scene.
    pub fn of_waves(&mut self, context: &Context, pass: WavePass) -> Result<Rc<Program>, Error> {
        self.cache.get_or_compile(Key::Waves(pass), || {
            let (label, text) = match pass {
                WavePass::Initialise(of, order) => {
                    ("initialise", shader::initialise_text(of, order))
                }
                WavePass::Pan(order) => ("pan", shader::pan_text(order)),
                WavePass::InOrder => ("in order", shader::in_order_text()),
                WavePass::FirstSum => ("first sum", shader::first_sum_text()),
                WavePass::FurtherSum => ("further sum", shader::further_sum_text()),
            };
            Ok(Program::fragment(context, label, &text)?)
        })
    }
}

/// The settings that determine the text of a march.
pub(super) fn march_options(settings: &Settings) -> MarchText {
    MarchText {
        algorithm: match &settings.algorithm {
            Algorithm::Hybrid => AlgorithmText::Hybrid,
            Algorithm::March => AlgorithmText::March,
            Algorithm::Thesis(_) => AlgorithmText::Thesis,
        },
        count_evaluations: settings.count_evaluations,
    }
}

/// The wave that starts at a texel, in a scene with these settings.
pub(super) fn start_order(scene: &Scene, settings: &Settings) -> StartOrderText {
    StartOrderText::of(march_options(settings).algorithm, scene)
}

/// The settings that determine the loops of a pass.
pub(super) fn loops_asked(settings: &Settings) -> LoopsAsked {
    LoopsAsked {
        algorithm: march_options(settings).algorithm,
        thesis_steps: match &settings.algorithm {
            Algorithm::Thesis(thesis) => thesis.step_limit(settings.max_distance),
            Algorithm::March | Algorithm::Hybrid => 0,
        },
        iterations_per_pass: settings.iterations_per_pass,
        detectors: 0,
    }
}

/// The structure of a scene for frames with these settings.
pub(super) fn structure(scene: &Scene, settings: &Settings) -> Structure {
    march_options(settings).algorithm.structure(scene)
}

/// A number that is equal for scenes whose arrivals are traced by the same programs with these settings. Different
/// scenes have different numbers, except by a chance of 2⁻⁶⁴.
#[cfg(feature = "simulator")]
pub(crate) fn arrivals_key(
    scene: &Scene,
    settings: &Settings,
    early_order: u32,
    transmits: bool,
) -> u64 {
    /// The records and outputs do not depend on the scene.
    const SOME: u32 = 4;
    let structure = structure(scene, settings);
    let march = (
        march_options(settings).algorithm,
        settings.directions,
        start_order(scene, settings),
    );
    let mut hasher = DefaultHasher::new();
    structure.key.hash(&mut hasher);
    for bands in super::early_band_groups(scene, early_order) {
        ArrivalsText::new(march, &Materials::of(scene, bands), SOME, 2 * SOME).hash(&mut hasher);
    }
    for bands in super::resampled_band_groups(scene) {
        let passing = transmits.then(|| Materials::with_transmission(scene, bands.clone()));
        for materials in passing.into_iter().chain([Materials::of(scene, bands)]) {
            ArrivalsText::new(march, &materials, SOME, 2 * SOME).hash(&mut hasher);
        }
    }
    hasher.finish()
}

impl Budget {
    /// The budget of a scene in its current state.
    pub fn of(scene: &Scene, settings: &Settings) -> Budget {
        Budget::of_structure(scene, structure(scene, settings), settings)
    }

    /// The budget of a scene whose structure is known.
    pub(super) fn of_structure(scene: &Scene, of: Structure, settings: &Settings) -> Budget {
        let asked = loops_asked(settings);
        let none = Materials::default();
        let mut compiled = CompiledScene::default();
        // The number of loop turns does not depend on the origin.
        compiled.update(scene, OriginRebasing::world(), of, &none);
        compiled.budget(&asked)
    }
}

/// A pass over the waves that has a separate program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Pass {
    /// Puts the waves at the source.
    Initialise,
    /// Marches the waves through the scene.
    March,
    /// Computes the contribution of each wave to either side.
    Pan,
}

/// The fragment shader of a pass, as a [`Tracer`](super::Tracer) compiles it after the version header. This function
/// needs no context. The scene should have been [checked](Scene::check).
pub fn shader_text(scene: &Scene, settings: &Settings, pass: Pass) -> String {
    match pass {
        Pass::Initialise => {
            shader::initialise_text(settings.directions, start_order(scene, settings))
        }
        Pass::March => march_text(scene, &structure(scene, settings), settings),
        Pass::Pan => shader::pan_text(start_order(scene, settings)),
    }
}

/// The text of the march of a scene whose structure is known.
pub(super) fn march_text(scene: &Scene, structure: &Structure, settings: &Settings) -> String {
    shader::march_text(scene, structure, march_options(settings))
}

/// Compiles a program that contains the surfaces of a scene.
///
/// # Errors
/// [`TraceError::FieldDoesNotCompile`] if the program does not compile and contains a user's text that compiled alone;
/// otherwise the driver's error.
pub(crate) fn compile_with_scene(
    context: &Context,
    scene: &Scene,
    label: &str,
    text: &str,
) -> Result<Program, Error> {
    match Program::fragment(context, label, text) {
        Err(GpuError::Compile { stage, label, log }) => match of_field(scene, text, &log) {
            Some(error) => Err(error.into()),
            None => Err(GpuError::Compile { stage, label, log }.into()),
        },
        Err(GpuError::Link { label, log }) => match of_field(scene, text, &log) {
            Some(error) => Err(error.into()),
            None => Err(GpuError::Link { label, log }.into()),
        },
        other => Ok(other?),
    }
}

/// The first error of a log, as an error of a user's field. `None` if the program contains no field, or the error is in
/// the program's own text.
fn of_field(scene: &Scene, text: &str, log: &str) -> Option<TraceError> {
    let fields: Vec<&Arc<UserField>> = scene.user_fields().filter(|f| !f.is_own()).collect();
    let errors = log_errors(log);
    let refused = |field: &UserField, line, message| TraceError::FieldDoesNotCompile {
        file: field.file.display().to_string(),
        line,
        message,
    };
    for error in &errors {
        let name = shader::file_name(text, error.file);
        let is_in = |field: &&&Arc<UserField>| name == Some(shader::shown_name(field).as_str());
        if let Some(field) = fields.iter().find(is_in) {
            let message = without_prefixes(&error.message);
            return Some(refused(field, Some(error.line), message));
        }
    }
    let message = match errors.first() {
        Some(error) => without_prefixes(&error.message),
        None => first_line(log),
    };
    let field = fields.first()?;
    let why = format!("compiles alone, but not in the scene's shader: {message}");
    Some(refused(field, None, why))
}

/// The first line of a log that is not empty.
pub(super) fn first_line(log: &str) -> String {
    let line = log.lines().find(|line| !line.trim().is_empty());
    without_prefixes(line.unwrap_or("the driver gives no reason").trim())
}

/// A driver's message with the original names of the user's text: without the prefixes that the program has added.
pub(super) fn without_prefixes(message: &str) -> String {
    let mut plain = String::with_capacity(message.len());
    let mut rest = message;
    while let Some(start) = rest.find("user") {
        let (before, from) = rest.split_at(start);
        plain.push_str(before);
        let is_word = before.ends_with(|c: char| c.is_ascii_alphanumeric() || c == '_');
        match prefix_length(from).filter(|_| !is_word) {
            Some(length) => {
                let name = &from[length..];
                let is_of_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
                let end = name.find(|c| !is_of_name(c)).unwrap_or(name.len());
                plain.push_str(&name[..end]);
                rest = &name[end..];
            }
            None => {
                plain.push_str("user");
                rest = &from["user".len()..];
            }
        }
    }
    plain + rest
}

/// Length in bytes of the prefix `user<number>_` at the start of a text. The prefix `users<number>_` precedes names
/// that begin with `_`. Its length does not include the underscore, which belongs to the name.
fn prefix_length(text: &str) -> Option<usize> {
    let after = text.strip_prefix("user")?;
    let number = after.strip_prefix('s').unwrap_or(after);
    let name = number.trim_start_matches(|c: char| c.is_ascii_digit());
    if name.len() == number.len() || !name.starts_with('_') {
        return None;
    }
    let of_name = if number.len() == after.len() { 1 } else { 0 };
    Some(text.len() - name.len() + of_name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Surface;
    use crate::scene::shape::User;
    use glam::Vec3;

    fn scene_with(text: &str) -> Scene {
        let field = UserField::new("my.glsl", text.to_owned(), Vec3::ONE, 1.0);
        let shape = User {
            field: Arc::new(field),
        };
        let mut scene = Scene::load("corner").unwrap();
        scene.surfaces.push(Surface::new(shape));
        scene
    }

    /// Protects users from raw driver logs: an error that a text causes in the whole shader is reported in one sentence
    /// with the user's file, line and names.
    #[test]
    fn an_error_in_the_whole_shader_is_that_of_the_field() {
        let text = "float _a;\nfloat field(vec3 p) { return p.x + _a; }\n";
        let scene = scene_with(text);
        let shader = shader_text(&scene, &crate::Settings::default(), Pass::March);
        let number = (1..999).find(|n| shader::file_name(&shader, *n) == Some("my.glsl"));
        let number = number.unwrap();
        for (log, expected) in [
            (
                format!(
                    "1:5(2): warning: odd\n{number}:2(9): error: `user0_field' and `users0_a' differ\nmore"
                ),
                "my.glsl:2: 'field' and '_a' differ",
            ),
            (
                format!("ERROR: {number}:1: 'user0_b' : redefinition\n"),
                "my.glsl:1: 'b' : redefinition",
            ),
            (
                "1:7(3): error: no function with name 'min'\nmore\n".to_owned(),
                "my.glsl: compiles alone, but not in the scene's shader: no function with name 'min'",
            ),
            (
                "\nout of registers\nmore\n".to_owned(),
                "my.glsl: compiles alone, but not in the scene's shader: out of registers",
            ),
        ] {
            let error = of_field(&scene, &shader, &log).unwrap();
            assert_eq!(error.to_string(), expected);
        }
        let own = Scene::load("menger").unwrap();
        assert!(of_field(&own, &shader, "1:1(1): error: bad").is_none());
    }

    /// Protects the names in messages: only the prefixes that the program has added are removed.
    #[test]
    fn only_prefixes_are_taken_off() {
        for (message, expected) in [
            ("'user0_a', user12_b users3_c", "'a', b _c"),
            (
                "user_a users user0 my_user0_a",
                "user_a users user0 my_user0_a",
            ),
            ("user0_user0_a", "user0_a"),
        ] {
            assert_eq!(without_prefixes(message), expected);
        }
    }
}
