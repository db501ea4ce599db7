//! Tries users' fields in a child process, so that they cannot harm the calling process.
//!
//! A field's text is a program, and the driver that compiles it runs within the calling process. A division that the
//! compiler folds, a sum of twenty thousand terms or a loop of a billion iterations can end or block that process. The
//! texts of a scene are therefore first compiled and tried in a child process, with limits on time, memory and stack. A
//! text that crashes the child or takes too long is rejected. Accepted texts are remembered as long as the calling
//! process lives.
//!
//! A library cannot start itself as a process. The user of this crate therefore chooses with [`FieldTrial::set`]. Until
//! then users' fields are refused. The command line starts a child process.

// A page in a browser cannot start processes, so fields can only be tried in this process.
#[cfg(not(target_arch = "wasm32"))]
mod child;
mod parent;
#[cfg_attr(target_arch = "wasm32", expect(dead_code))]
mod protocol;

pub(crate) use parent::{Trial, has_passed};

use crate::error::Error;
use crate::scene::Scene;
use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::{PoisonError, RwLock};
use std::time::Duration;

/// Time limit of a trial. The limit is many times the time of the slowest acceptable fields. A text that compiles just
/// within the limit can be compiled twice within 20 s.
const LONGEST: Duration = Duration::from_secs(9);

/// Time limit on a busy machine, on which the child gets less than half of one core.
const LONGEST_BESIDE_OTHERS: Duration = Duration::from_secs(18);

/// Maximum bytes that a trial may allocate in addition to what the renderer has allocated before the trial.
const MOST_MEMORY: u64 = 1 << 30;

/// Bytes of a trial's stack: half the usual stack of a main thread, so that accepted texts have a margin.
#[cfg(not(target_arch = "wasm32"))]
const STACK: usize = 4 << 20;

/// The way to try users' fields before this process compiles them.
///
/// A program that accepts fields makes its choice before it traces or draws a scene:
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
    /// Fields are refused: [`TraceError::FieldRefused`](super::TraceError::FieldRefused). This is the value for
    /// programs that have made no choice.
    #[default]
    Refused,
    /// Fields are not tried before use: this process compiles and samples them directly. A text that the driver cannot
    /// handle may end this process by a signal, take gigabytes of memory, or never return. For trusted texts.
    InThisProcess,
    /// Fields are tried in a child process that this command starts, once for each text. For untrusted texts.
    InChild(TrialCommand),
}

/// A command whose process calls [`FieldTrial::answer`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TrialCommand {
    /// The program: usually the running program, see [`TrialCommand::this_program`].
    pub program: PathBuf,
    /// The arguments. With these arguments, the program must call [`FieldTrial::answer`] and select the renderer.
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
        // This path refers to the running program even if a newer version replaces the program's file.
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
    /// Sets the choice for the whole process, because a text can end the whole process. The choice applies from now on.
    /// A tracer keeps the fields that it has accepted before.
    pub fn set(self) {
        *CHOSEN.write().unwrap_or_else(PoisonError::into_inner) = self;
    }

    fn chosen() -> FieldTrial {
        let chosen = CHOSEN.read().unwrap_or_else(PoisonError::into_inner);
        chosen.clone()
    }
}

/// Tries the scene's fields, and programs that contain them, as [`FieldTrial::set`] has chosen, and waits for the
/// result. Fields that were tried before are not tried again.
///
/// # Errors
/// [`Error::Trace`] for a field that cannot be used.
pub(crate) fn ensure(scene: &Scene, programs: &[&str]) -> Result<(), Error> {
    match Trial::begin(scene, programs)? {
        Some(trial) => trial.wait(),
        None => Ok(()),
    }
}
