//! Tries users' fields in a child process, where they can do no harm.
//!
//! A field's text is a program, and what compiles it, the driver, runs within the calling
//! process: a division that the compiler folds, a sum of twenty thousand terms or a loop of a
//! billion iterations can end or block that process. So the texts of a scene are compiled and
//! tried first in a child process, with limits on time, memory and stack; what dies or takes
//! too long there is rejected here. What has passed is remembered as long as the process lives.
//!
//! A library cannot start itself as a process. The user of this crate chooses with
//! [`FieldTrial::set`]; the command line starts a child process.

// A page in a browser has no other processes: there nothing can be chosen but to try in this one.
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

/// What a trial may take by the clock: many times what the slowest fields take that one would
/// wait for, and little enough that a compiler which has just stayed below does so twice
/// within 20 s.
const LONGEST: Duration = Duration::from_secs(9);

/// The same on a machine that does much else, so that the child gets less than half of one core.
const LONGEST_BESIDE_OTHERS: Duration = Duration::from_secs(18);

/// Bytes that a trial may take beyond what the renderer has taken before it.
const MOST_MEMORY: u64 = 1 << 30;

/// Bytes of the stack that a trial runs on: half of what a main thread usually has, so that
/// what has passed has room to spare.
#[cfg(not(target_arch = "wasm32"))]
const STACK: usize = 4 << 20;

/// How users' fields are tried before this process compiles them.
#[derive(Clone, Debug, Default)]
pub enum FieldTrial {
    /// They are not: this process compiles and samples them at once. A text that the driver
    /// cannot handle ends this process by a signal, takes gigabytes of memory, or never
    /// returns. For texts that one trusts.
    #[default]
    InThisProcess,
    /// In a child process that this command starts, once for each text. For untrusted
    /// texts.
    InChild(TrialCommand),
}

/// A command whose process answers by [`answer_field_trial`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TrialCommand {
    /// The program: usually this one, see [`TrialCommand::this_program`].
    pub program: PathBuf,
    /// Its arguments. They must lead to [`answer_field_trial`] and set the renderer.
    pub arguments: Vec<OsString>,
}

impl TrialCommand {
    /// The running program, with other arguments.
    ///
    /// # Errors
    /// Where the system does not report which program is running.
    pub fn this_program(
        arguments: impl IntoIterator<Item = impl Into<OsString>>,
    ) -> std::io::Result<TrialCommand> {
        // Stays the same program when its file is replaced by a newer one.
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

static CHOSEN: RwLock<FieldTrial> = RwLock::new(FieldTrial::InThisProcess);

impl FieldTrial {
    /// Chooses for this process, from now on: it is the process as a whole that a text can
    /// end.
    pub fn set(self) {
        *CHOSEN.write().unwrap_or_else(PoisonError::into_inner) = self;
    }

    fn chosen() -> FieldTrial {
        let chosen = CHOSEN.read().unwrap_or_else(PoisonError::into_inner);
        chosen.clone()
    }
}

/// Has the scene's fields, and programs that they are part of, tried as chosen; returns when
/// they are. What was tried before is not tried again.
///
/// # Errors
/// [`Error::Trace`] for a field that cannot be used.
pub(crate) fn ensure(scene: &Scene, programs: &[&str]) -> Result<(), Error> {
    match Trial::begin(scene, programs)? {
        Some(trial) => trial.wait(),
        None => Ok(()),
    }
}
