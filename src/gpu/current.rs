//! Which context is current on this thread.
//!
//! EGL and OSMesa each remember the context that they made current last, but share Mesa's slot for the one that
//! calls go to. So a context is always released by its own library before the other's is made current; otherwise
//! EGL would take its context for current still, and its calls would silently go to OSMesa's.
//!
//! A program may have contexts of its own, which echomarch does not know: so the library is queried each time whether
//! the context is still the current one, and [`Entered`] restores what was current before.

use std::cell::RefCell;
use std::rc::{Rc, Weak};

use super::backend::{Backend, Owner};
use super::native::Foreign;

thread_local! {
    static CURRENT: RefCell<Option<Weak<dyn Backend>>> = const { RefCell::new(None) };
}

/// Makes the context current on this thread, unless it is.
///
/// # Errors
/// What the library answered; then no context is current, and GL calls do nothing.
pub(super) fn make(context: &Rc<dyn Backend>) -> Result<(), String> {
    CURRENT
        .try_with(|current| {
            let last = last_made(current);
            let is_last = last
                .as_ref()
                .is_some_and(|last| std::ptr::addr_eq(Rc::as_ptr(last), Rc::as_ptr(context)));
            // What the caller has made current needs no switch, which would flush it.
            let is_callers = last.is_none() && context.owner() == Owner::Caller;
            let is_kept = context.owner() == Owner::KeptCurrentByCaller;
            if is_kept || ((is_last || is_callers) && context.is_current()) {
                *current.borrow_mut() = Some(Rc::downgrade(context));
                return Ok(());
            }
            drop(last);
            release_in(current);
            // Its library still takes it for current where another library's context took its place.
            if context.owner() == Owner::Caller && context.is_current() {
                context.release();
            }
            // Of others': OSMesa cannot replace one of EGL's.
            if let Some(foreign) = Foreign::of_system() {
                foreign.release();
            }
            context.make_current()?;
            *current.borrow_mut() = Some(Rc::downgrade(context));
            Ok(())
        })
        // The thread is ending and its slot is gone.
        .unwrap_or_else(|_| context.make_current())
}

/// Makes no context current on this thread. To be called before one is destroyed, too: the driver may itself switch to
/// the one it destroys and back again, and OSMesa cannot switch back to one of EGL's.
pub(super) fn release() {
    // Where the slot is gone the thread is ending, and takes the current context along.
    let _ = CURRENT.try_with(release_in);
}

fn release_in(current: &RefCell<Option<Weak<dyn Backend>>>) {
    let last = last_made(current);
    current.replace(None);
    if let Some(last) = last {
        last.release();
    }
}

/// The context that was made current last, while it lives.
fn last_made(current: &RefCell<Option<Weak<dyn Backend>>>) -> Option<Rc<dyn Backend>> {
    current.borrow().as_ref().and_then(Weak::upgrade)
}

/// While it lives a context is current; then what the caller had made current is again.
#[must_use]
pub(super) struct Entered {
    foreign: Option<Foreign>,
    then: Then,
}

/// What becomes of a context that was entered.
enum Then {
    /// It stays current, as the one made current last.
    Stays,
    /// One of the caller's stays current, and is the caller's alone again.
    StaysCallers,
    /// One of the caller's is made not current, as it was; one of echomarch's that was current is so again.
    Goes {
        entered: Rc<dyn Backend>,
        before: Option<Rc<dyn Backend>>,
    },
}

/// Makes the context current, and restores the previously current context when the result is dropped. Where nothing
/// was current a context of echomarch's stays so, and one of the caller's does not.
///
/// # Errors
/// Those of [`make`].
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
    // Dropped if the context cannot be made current, which puts back what was so before.
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
                // It is not where it could not be made so.
                if entered.is_current() {
                    entered.release();
                }
                // Where that fails the next use of it tells.
                let _ = before.as_ref().map(make);
            }
        }
        if let Some(foreign) = &self.foreign {
            foreign.make_current();
        }
    }
}

/// No context is the one made current last any more, whichever is current.
fn forget() {
    let _ = CURRENT.try_with(|current| current.replace(None));
}
