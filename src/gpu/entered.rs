//! Guard of a call into this crate: a context is current during the call, and the previous one is restored after it.

use super::caller_state::CallerState;
use super::{Context, GpuError, current};

/// Keeps a [`Context`] current, in the state that passes need. When dropped, restores what was current before, and the
/// state of a caller's context.
#[must_use]
pub(crate) struct Entered {
    _callers: Option<CallersEntered>,
    // Dropped after the state, whose restoration needs the context to be current.
    _current: current::Entered,
}

/// A caller's context, and the state to restore in it.
struct CallersEntered {
    context: Context,
    /// `None` within another call, and if no state is changed.
    state: Option<CallerState>,
}

impl Entered {
    /// Counts the call if the context is the caller's; saves its state if `keeps_state` is set and this call is not
    /// within another.
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
    /// Makes the context current until the result is dropped, which restores the EGL context that was current on this
    /// thread before. If none was current the context stays current, unless it is the caller's. The state of a caller's
    /// context is saved and restored.
    ///
    /// # Errors
    /// [`GpuError::ContextLost`] if it cannot be made current.
    pub(crate) fn enter(&self) -> Result<Entered, GpuError> {
        Ok(Entered::new(self, self.make_current()?, true))
    }

    /// Frees objects with the context current; they are not bound outside calls, so no state changes. A context that
    /// cannot be made current is gone, and its objects with it.
    pub(super) fn free(&self, delete: impl FnOnce(&glow::Context)) {
        if let Ok(current) = self.make_current() {
            let _entered = Entered::new(self, current, false);
            delete(self.gl());
        }
    }
}
