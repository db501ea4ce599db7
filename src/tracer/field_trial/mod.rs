//! Tries users' fields in a child process, so that they cannot harm the calling process.
//!
//! A field's text is a program, and the driver, which compiles it, runs within the calling process:
//! a division that the compiler folds, a sum of twenty thousand terms or a loop of a billion
//! iterations can end or block that process. So the texts of a scene are compiled and tried first
//! in a child process, with limits on time, memory and stack; a text that crashes the child or
//! takes too long is rejected here. Accepted texts are remembered as long as the process lives.
//!
//! A library cannot start itself as a process. The user of this crate chooses with
//! [`FieldTrial::set`]; until then users' fields are refused. The command line starts a child process.

// A page in a browser cannot start processes: fields can only be tried in this process.
#[cfg(not(target_arch = "wasm32"))]
mod child;
mod parent;
#[cfg_attr(target_arch = "wasm32", expect(dead_code))]
mod protocol;

#[cfg(not(target_arch = "wasm32"))]
pub use child::answer_field_trial;
pub(crate) use parent::{Trial, has_passed};

use crate::error::Error;
use crate::scene::Scene;
use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::{PoisonError, RwLock};
use std::time::Duration;

/// Time limit of a trial: many times longer than the slowest acceptable fields take, and short
/// enough that a text that compiles just within the limit can be compiled twice within 20 s.
const LONGEST: Duration = Duration::from_secs(9);

/// Time limit on a busy machine, where the child gets less than half of one core.
const LONGEST_BESIDE_OTHERS: Duration = Duration::from_secs(18);

/// Maximum bytes that a trial may allocate in addition to what the renderer has allocated before it.
const MOST_MEMORY: u64 = 1 << 30;

/// Bytes of a trial's stack: half of the usual stack of a main thread, so that accepted texts have
/// a margin.
#[cfg(not(target_arch = "wasm32"))]
const STACK: usize = 4 << 20;

/// The way to try users' fields before this process compiles them.
///
/// A program that takes fields chooses one before it traces or draws a scene:
///
/// ```
/// use echomarch::gl::{Context, ContextOptions};
/// use echomarch::scene::{UserField, shape::User};
/// use echomarch::tracer::{FieldTrial, TraceError};
/// use echomarch::{Error, Scene, Settings, Shape, Tracer};
/// use glam::Vec3;
///
/// let ball = "float field(vec3 p) { return length(p) - 1.0; }";
/// let field = UserField::new("ball.glsl", ball.to_owned(), Vec3::splat(4.0), 1.0);
/// let mut scene = Scene::builtin("corner")?;
/// scene.surfaces[0].shape = Shape::from(User { field: field.into() });
/// let settings = Settings::default().with_waves(64);
/// let mut tracer = Tracer::new(&Context::headless(&ContextOptions::default())?)?;
///
/// let refused = tracer.frame(&scene, &settings);
/// assert!(matches!(refused, Err(Error::Trace(TraceError::FieldRefused { .. }))));
///
/// FieldTrial::InThisProcess.set(); // This text is trusted.
/// tracer.frame(&scene, &settings)?;
/// # Ok::<(), Error>(())
/// ```
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub enum FieldTrial {
    /// They are refused: [`TraceError::FieldRefused`](super::TraceError::FieldRefused). For programs that have made no
    /// choice.
    #[default]
    Refused,
    /// Not at all: this process compiles and samples them at once. A text that the driver cannot
    /// handle ends this process by a signal, takes gigabytes of memory, or never returns. For
    /// trusted texts.
    InThisProcess,
    /// In a child process started by this command, once for each text. For untrusted texts.
    InChild(TrialCommand),
}

/// A command whose process calls [`answer_field_trial`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TrialCommand {
    /// The program: usually the running program, see [`TrialCommand::this_program`].
    pub program: PathBuf,
    /// The arguments. The program must call [`answer_field_trial`] with them, and select the
    /// renderer.
    pub arguments: Vec<OsString>,
}

impl TrialCommand {
    /// The running program, with other arguments.
    ///
    /// # Errors
    /// If the system does not report the running program.
    pub fn this_program(
        arguments: impl IntoIterator<Item = impl Into<OsString>>,
    ) -> std::io::Result<TrialCommand> {
        // This path remains the running program even if the program's file is replaced by a newer
        // one.
        let own = PathBuf::from("/proc/self/exe");
        let program = if own.exists() {
            own
        } else {
            std::env::current_exe()?
        };
        Ok(TrialCommand {
            program,
            arguments: arguments.into_iter().map(Into::into).collect(),
        })
    }
}

static CHOSEN: RwLock<FieldTrial> = RwLock::new(FieldTrial::Refused);

impl FieldTrial {
    /// Sets the choice for the whole process from now on, since a text can end the process as a
    /// whole. A tracer keeps fields that it has accepted before.
    pub fn set(self) {
        *CHOSEN.write().unwrap_or_else(PoisonError::into_inner) = self;
    }

    fn chosen() -> FieldTrial {
        let chosen = CHOSEN.read().unwrap_or_else(PoisonError::into_inner);
        chosen.clone()
    }
}

/// Tries the scene's fields, and programs that contain them, as set by [`FieldTrial::set`], and
/// waits for the result. Fields that were tried before are not tried again.
///
/// # Errors
/// [`Error::Trace`] for a field that cannot be used.
pub(crate) fn ensure(scene: &Scene, programs: &[&str]) -> Result<(), Error> {
    match Trial::begin(scene, programs)? {
        Some(trial) => trial.wait(),
        None => Ok(()),
    }
}
