//! Calls into this crate: a context is current in them, and what was before is so again after them.

use super::caller_state::CallerState;
use super::{Context, GpuError, current};

/// While it lives a [`Context`] is current, in the state that passes need. Then what was current before is so again, and a
/// context of the caller's has the state that it had.
#[must_use]
pub(crate) struct Entered {
    _callers: Option<CallersEntered>,
    // After the state: the context is current as long as that is put back.
    _current: current::Entered,
}

/// A context of the caller's, and what is to be put back there.
struct CallersEntered {
    context: Context,
    /// None within another call, and where no state is touched.
    state: Option<CallerState>,
}

impl Entered {
    /// Counts the call where the context is the caller's; the state of such a one is kept if it is to be put back, and
    /// this is no call within another.
    fn new(context: &Context, current: current::Entered, keeps_state: bool) -> Entered {
        let callers = context.caller_part().map(|part| {
            let before = part.entered.replace(part.entered.get() + 1);
            let state =
                (keeps_state && before == 0).then(|| CallerState::keep(context.gl(), &part.traits));
            CallersEntered {
                context: context.clone(),
                state,
            }
        });
        Entered {
            _callers: callers,
            _current: current,
        }
    }
}

impl Drop for CallersEntered {
    fn drop(&mut self) {
        let Some(part) = self.context.caller_part() else {
            return;
        };
        if let Some(state) = self.state.take() {
            state.put_back(self.context.gl(), &part.traits);
        }
        part.entered.set(part.entered.get() - 1);
    }
}

impl Context {
    /// Makes the context current until the result is dropped, and then the EGL context that was current on this
    /// thread before. Where nothing was current the context stays so, unless it is the caller's. The state of a
    /// caller's context is saved and restored.
    ///
    /// # Errors
    /// [`GpuError::ContextLost`] if it cannot be made current.
    pub(crate) fn enter(&self) -> Result<Entered, GpuError> {
        Ok(Entered::new(self, self.make_current()?, true))
    }

    /// Frees objects with the context current; they are bound nowhere outside calls, so that no state is touched. Where
    /// the context cannot be made current it is gone, and its objects with it.
    pub(super) fn free(&self, delete: impl FnOnce(&glow::Context)) {
        if let Ok(current) = self.make_current() {
            let _entered = Entered::new(self, current, false);
            delete(self.gl());
        }
    }
}
