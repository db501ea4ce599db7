//! Which context is current on this thread.
//!
//! EGL and OSMesa each remember the context that they made current last, but share Mesa's slot for the one that
//! calls go to. So a context is always released by its own library before the other's is made current; otherwise
//! EGL would take its context for current still, and its calls would go to OSMesa's in silence.

//!
//! A program may have contexts of its own, which echomarch does not know: so the library is asked each time whether the
//! context is still the current one, and [`Entered`] puts back what was current before.

use std::cell::RefCell;
use std::ffi::c_void;
use std::rc::{Rc, Weak};
use std::sync::OnceLock;

use glutin::api::egl::Egl;
use glutin::api::egl::display::Display;

use super::context::Inner;

/// EGL's functions, once there was a context by way of it.
static EGL: OnceLock<&'static Egl> = OnceLock::new();

// Values of EGL/egl.h.
const EGL_DRAW: i32 = 0x3059;
const EGL_READ: i32 = 0x305A;

/// Keeps EGL's functions, by which contexts of others are found and put back.
pub(super) fn knows_egl(display: &Display) {
    let _ = EGL.set(display.egl());
}

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
            if current.borrow().as_ptr() == Rc::as_ptr(context) && context.backend.is_current() {
                return Ok(());
            }
            release_in(current);
            // Of others': OSMesa cannot replace one of EGL's.
            if let Some(foreign) = Foreign::of_egl() {
                foreign.release();
            }
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

/// A context of EGL's that echomarch did not make, as it was current.
struct Foreign {
    egl: &'static Egl,
    api: u32,
    display: *const c_void,
    draw: *const c_void,
    read: *const c_void,
    context: *const c_void,
}

impl Foreign {
    /// What EGL says is current on this thread, if anything.
    fn of_egl() -> Option<Foreign> {
        let egl = *EGL.get()?;
        // SAFETY: asks only.
        unsafe {
            let context = egl.GetCurrentContext();
            if context.is_null() {
                return None;
            }
            Some(Foreign {
                egl,
                api: egl.QueryAPI(),
                display: egl.GetCurrentDisplay(),
                draw: egl.GetCurrentSurface(EGL_DRAW),
                read: egl.GetCurrentSurface(EGL_READ),
                context,
            })
        }
    }

    fn release(&self) {
        let none = std::ptr::null();
        // SAFETY: the display is the current one; null surfaces and no context mean that none is current.
        unsafe { self.egl.MakeCurrent(self.display, none, none, none) };
    }

    /// Makes it current again. If its owner has destroyed it in the meantime EGL refuses, and none is current.
    fn make_current(&self) {
        // SAFETY: EGL checks handles against those that there are.
        unsafe {
            self.egl.BindAPI(self.api);
            self.egl
                .MakeCurrent(self.display, self.draw, self.read, self.context);
        }
    }
}

/// While it lives a context of echomarch's is current; then what the caller had made current is again.
#[must_use]
pub(crate) struct Entered {
    foreign: Option<Foreign>,
}

/// Makes the context current, and keeps what somebody else had made current until the answer is dropped. Where nothing
/// was current the context stays so.
///
/// # Errors
/// Those of [`make`].
pub(super) fn enter(context: &Rc<Inner>) -> Result<Entered, String> {
    let known = CURRENT.try_with(|current| current.borrow().upgrade());
    let is_known = known.ok().flatten().is_some_and(|c| c.backend.is_current());
    let foreign = if is_known { None } else { Foreign::of_egl() };
    // Dropped if the context cannot be made current, which puts it back too.
    let entered = Entered { foreign };
    make(context)?;
    Ok(entered)
}

impl Drop for Entered {
    fn drop(&mut self) {
        if let Some(foreign) = &self.foreign {
            release();
            foreign.make_current();
        }
    }
}
