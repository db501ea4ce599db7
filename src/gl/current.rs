//! The context that is current on this thread.
//!
//! EGL and OSMesa each remember the context that they made current last, but share Mesa's slot for the context that
//! receives calls. The library of a context therefore always releases the context before the other library makes a
//! context current. Otherwise EGL would still assume that its context is current, and its calls would silently go to
//! OSMesa's context.
//!
//! A program may have contexts unknown to echomarch, so before each use echomarch checks with the library that its
//! context is still current. [`Entered`] restores the previously current context.

use std::cell::RefCell;
use std::rc::{Rc, Weak};

use super::backend::{Backend, Owner};
use super::native::Foreign;

thread_local! {
    static CURRENT: RefCell<Option<Weak<dyn Backend>>> = const { RefCell::new(None) };
}

/// Makes the context current on this thread, unless it already is.
///
/// # Errors
/// The library's error; then no context is current, and GL calls do nothing.
pub(super) fn make(context: &Rc<dyn Backend>) -> Result<(), String> {
    CURRENT
        .try_with(|current| {
            let last = last_made(current);
            let is_last = last
                .as_ref()
                .is_some_and(|last| std::ptr::addr_eq(Rc::as_ptr(last), Rc::as_ptr(context)));
            // A context that the caller has made current needs no switch: a switch would flush the context.
            let is_callers = last.is_none() && context.owner() == Owner::Caller;
            let is_kept = context.owner() == Owner::KeptCurrentByCaller;
            if is_kept || ((is_last || is_callers) && context.is_current()) {
                *current.borrow_mut() = Some(Rc::downgrade(context));
                return Ok(());
            }
            drop(last);
            release_in(current);
            // The context's library still considers it current although another library's context replaced it.
            if context.owner() == Owner::Caller && context.is_current() {
                context.release();
            }
            // OSMesa cannot replace an EGL context made by other code.
            if let Some(foreign) = Foreign::of_system() {
                foreign.release();
            }
            context.make_current()?;
            *current.borrow_mut() = Some(Rc::downgrade(context));
            Ok(())
        })
        // The thread is ending and its thread-local slot no longer exists.
        .unwrap_or_else(|_| context.make_current())
}

/// Leaves this thread without a current context. This function must also be called before a context is destroyed,
/// because the driver may switch to the destroyed context and back again, and OSMesa cannot switch back to an EGL
/// context.
pub(super) fn release() {
    // If there is no slot, the thread is ending, and its current context ends too.
    let _ = CURRENT.try_with(release_in);
}

fn release_in(current: &RefCell<Option<Weak<dyn Backend>>>) {
    let last = last_made(current);
    current.replace(None);
    if let Some(last) = last {
        last.release();
    }
}

/// The context made current last, if it still exists.
fn last_made(current: &RefCell<Option<Weak<dyn Backend>>>) -> Option<Rc<dyn Backend>> {
    current.borrow().as_ref().and_then(Weak::upgrade)
}

/// Keeps a context current; dropping it restores the context that the caller had made current.
#[must_use]
pub(super) struct Entered {
    foreign: Option<Foreign>,
    then: Then,
}

/// The action when an [`Entered`] is dropped.
enum Then {
    /// The context stays current, and is recorded as the one made current last.
    Stays,
    /// A caller's context stays current; echomarch no longer manages it.
    StaysCallers,
    /// The caller's context is released, because it was not current before. Echomarch's previously current context
    /// becomes current again.
    Goes {
        entered: Rc<dyn Backend>,
        before: Option<Rc<dyn Backend>>,
    },
}

/// Makes the context current, and restores the previously current context when the result is dropped. Without
/// a previous context, echomarch's own context stays current, and a caller's does not.
///
/// # Errors
/// The errors of [`make`].
pub(super) fn enter(context: &Rc<dyn Backend>) -> Result<Entered, String> {
    let known = CURRENT.try_with(last_made).ok().flatten();
    let known = known.filter(|known| known.owner() == Owner::Echomarch && known.is_current());
    let foreign = || match known {
        Some(_) => None,
        None => Foreign::of_system(),
    };
    let (foreign, then) = match context.owner() {
        Owner::Echomarch => (foreign(), Then::Stays),
        Owner::Caller if !context.is_current() => {
            let (foreign, entered) = (foreign(), context.clone());
            let before = known;
            (foreign, Then::Goes { entered, before })
        }
        Owner::Caller | Owner::KeptCurrentByCaller => (None, Then::StaysCallers),
    };
    // If the context cannot be made current, dropping `entered` restores the previous context.
    let entered = Entered { foreign, then };
    make(context)?;
    Ok(entered)
}

impl Drop for Entered {
    fn drop(&mut self) {
        match &self.then {
            Then::Stays if self.foreign.is_none() => (),
            Then::Stays => release(),
            Then::StaysCallers => forget(),
            Then::Goes { entered, before } => {
                forget();
                // The context is not current if making it current failed.
                if entered.is_current() {
                    entered.release();
                }
                // If making it current fails, the next use of the context reports the failure.
                let _ = before.as_ref().map(make);
            }
        }
        if let Some(foreign) = &self.foreign {
            foreign.make_current();
        }
    }
}

/// Clears the record of the context made current last, whichever context is current.
fn forget() {
    let _ = CURRENT.try_with(|current| current.replace(None));
}
