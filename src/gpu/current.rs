//! Which context is current on this thread.
//!
//! EGL and OSMesa each remember the context that they made current last, but share Mesa's slot for the one that
//! calls go to. So a context is always released by its own library before the other's is made current; otherwise
//! EGL would take its context for current still, and its calls would go to OSMesa's in silence.

use std::cell::RefCell;
use std::rc::{Rc, Weak};

use super::context::Inner;

thread_local! {
    static CURRENT: RefCell<Weak<Inner>> = const { RefCell::new(Weak::new()) };
}

/// Makes the context current on this thread, unless it is.
///
/// # Errors
/// What the library answered; then no context is current, and GL calls do nothing.
pub(super) fn make(context: &Rc<Inner>) -> Result<(), String> {
    CURRENT
        .try_with(|current| {
            if current.borrow().as_ptr() == Rc::as_ptr(context) {
                return Ok(());
            }
            release_in(current);
            context.backend.make_current()?;
            *current.borrow_mut() = Rc::downgrade(context);
            Ok(())
        })
        // The thread is ending and its slot is gone.
        .unwrap_or_else(|_| context.backend.make_current())
}

/// Makes no context current on this thread.
pub(super) fn release() {
    // Where the slot is gone the thread is ending, and takes the current context along.
    let _ = CURRENT.try_with(release_in);
}

/// Makes no context current, before this one is destroyed: the driver may itself switch to the one it destroys and
/// back again, and OSMesa cannot switch back to one of EGL's.
pub(super) fn release_before_drop(dropped: &Inner) {
    let _ = CURRENT.try_with(|current| {
        // Its last reference is gone, so the weak one no longer leads to it.
        if std::ptr::eq(current.borrow().as_ptr(), dropped) {
            dropped.backend.release();
        }
        release_in(current);
    });
}

fn release_in(current: &RefCell<Weak<Inner>>) {
    let previous = current.replace(Weak::new());
    if let Some(previous) = previous.upgrade() {
        previous.backend.release();
    }
}
