//! A GL context without a window, and the guard that keeps it current during a call into this crate.

use super::backend::Backend;
use super::caller_state::{CallerPart, CallerState, set_scissor_test};
#[cfg(not(target_arch = "wasm32"))]
use super::driver::load;
use super::driver::{Driver, Limits, is_software};
use super::error::{ERRORS_AT_MOST, code_name};
#[cfg(not(target_arch = "wasm32"))]
use super::native;
#[cfg(not(target_arch = "wasm32"))]
use super::osmesa::OsMesa;
use super::{Api, GpuError, current};
use crate::platform;
use glow::HasContext;
use std::fmt;
use std::rc::Rc;
use std::sync::{Arc, OnceLock};

/// Selects the context to make.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct ContextOptions {
    /// The OpenGL interface to use.
    pub api: Api,
    /// Index of the device, from 0, in the order of [`list_gpus`](super::list_gpus); `None` selects the first device
    /// that can make a context of the API. OSMesa has only device 0.
    pub gpu: Option<usize>,
}

impl ContextOptions {
    /// Options for the first device that can make a context of the API.
    pub fn new(api: Api) -> ContextOptions {
        ContextOptions { api, gpu: None }
    }

    /// Selects one device, by its index from 0.
    #[must_use]
    pub fn with_gpu(mut self, gpu: usize) -> ContextOptions {
        self.gpu = Some(gpu);
        self
    }
}

/// A GL context without a window, made current as needed. The [module](super) has an example.
///
/// Clones are references to the same context, which is destroyed with the last reference. A context stays on the thread
/// that made it.
#[derive(Clone)]
pub struct Context {
    inner: Rc<Inner>,
    passed_over: Rc<[String]>,
}

/// Data shared by the clones of a context.
struct Inner {
    backend: Rc<dyn Backend>,
    gl: Arc<glow::Context>,
    vertex_array: glow::VertexArray,
    api: Api,
    driver: Driver,
    /// Present if the caller made the context.
    caller: Option<CallerPart>,
}

impl Drop for Inner {
    fn drop(&mut self) {
        if self.caller.is_none() {
            // The vertex array is destroyed with the context.
            current::release();
            return;
        }
        // A context that cannot be made current no longer exists, and neither does its vertex array.
        let Ok(_entered) = current::enter(&self.backend) else {
            return;
        };
        // SAFETY: the context is current; the vertex array belongs to it and is not bound outside of calls.
        unsafe { self.gl.delete_vertex_array(self.vertex_array) };
    }
}

impl Context {
    /// Makes a context without a window and leaves it current on this thread. With `gpu: None`, print the
    /// [`renderer`](Context::renderer): it may be a software renderer.
    ///
    /// # Errors
    /// A missing library, device, context or extension.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn headless(options: &ContextOptions) -> Result<Context, GpuError> {
        if options.api == Api::OsMesa {
            return match options.gpu {
                None | Some(0) => Context::from_backend(Rc::new(OsMesa::new()?), Api::OsMesa),
                Some(asked) => Err(GpuError::NoSuchGpu { asked, found: 1 }),
            };
        }
        let places = native::places()?;
        if let Some(asked) = options.gpu {
            let place = places.get(asked).ok_or(GpuError::NoSuchGpu {
                asked,
                found: places.len(),
            })?;
            return Context::from_backend(native::open(place, options.api)?, options.api);
        }
        let mut reasons = Vec::new();
        for (index, place) in places.iter().enumerate() {
            let context = native::open(place, options.api)
                .and_then(|backend| Context::from_backend(backend, options.api));
            match context {
                Ok(context) => {
                    return Ok(Context {
                        passed_over: reasons.into(),
                        ..context
                    });
                }
                Err(GpuError::NoContext { reason, .. }) => {
                    reasons.push(format!("GPU {index}: {reason}"))
                }
                Err(error) => reasons.push(format!("GPU {index}: {error}")),
            }
        }
        Err(GpuError::no_context(options.api, reasons.join("; ")))
    }

    /// The devices that were tried before the device of this context, each with the reason why it was not used. Empty
    /// if a device was selected by its index. Report them to the user, who may have wanted one of them.
    pub fn passed_over(&self) -> &[String] {
        &self.passed_over
    }

    /// Wraps a context made by a library, and leaves it current.
    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn from_backend(backend: Rc<dyn Backend>, api: Api) -> Result<Context, GpuError> {
        Context::from_backend_with(backend, api, load)
    }

    /// Like [`from_backend`](Context::from_backend), with another lookup of GL functions, called while the context is
    /// current.
    pub(super) fn from_backend_with(
        backend: Rc<dyn Backend>,
        api: Api,
        load: impl FnOnce(&dyn Backend) -> Result<glow::Context, GpuError>,
    ) -> Result<Context, GpuError> {
        current::release();
        backend
            .make_current()
            .map_err(|reason| GpuError::no_context(api, reason))?;
        let gl = load(&*backend).inspect_err(|_| backend.release())?;
        let gl = Arc::new(gl);
        let context = Context::described(backend.clone(), gl, api, None)
            .inspect_err(|_| backend.release())?;
        current::make(&backend).map_err(|reason| GpuError::no_context(api, reason))?;
        Ok(context)
    }

    /// Creates the first reference to the current context.
    pub(super) fn described(
        backend: Rc<dyn Backend>,
        gl: Arc<glow::Context>,
        api: Api,
        caller: Option<CallerPart>,
    ) -> Result<Context, GpuError> {
        let driver = Driver::ask(&*backend, &gl, api)?;
        // SAFETY: the context is current.
        let vertex_array = unsafe { gl.create_vertex_array() }
            .map_err(|reason| GpuError::no_context(api, reason))?;
        Ok(Context {
            inner: Rc::new(Inner {
                backend,
                gl,
                vertex_array,
                api,
                driver,
                caller,
            }),
            passed_over: Rc::default(),
        })
    }

    /// Extra data of a context that the caller made.
    pub(super) fn caller_part(&self) -> Option<&CallerPart> {
        self.inner.caller.as_ref()
    }

    /// Turns the scissor on or off.
    pub(super) fn set_scissor_test(&self, is_on: bool) {
        let gl = self.gl();
        match (self.caller_part(), is_on) {
            (Some(part), is_on) => set_scissor_test(gl, &part.traits, is_on),
            // SAFETY: the context is current.
            (None, true) => unsafe { gl.enable(glow::SCISSOR_TEST) },
            // SAFETY: the context is current.
            (None, false) => unsafe { gl.disable(glow::SCISSOR_TEST) },
        }
    }

    /// Sets the size of the viewport, which begins at (0, 0). Other viewports of a caller stay unchanged.
    pub(super) fn set_viewport(&self, width: u32, height: u32) {
        let gl = self.gl();
        // SAFETY: the context is current and has the function if there are several viewports. Mesa 22 writes to the
        // numbers, so they are not constants.
        unsafe {
            match self.has_viewport_arrays() {
                true => gl.viewport_f32_slice(0, 1, &[[0.0, 0.0, width as f32, height as f32]]),
                false => gl.viewport(0, 0, width as i32, height as i32),
            }
        }
    }

    /// Sets the scissor rectangle. Other scissors of a caller stay unchanged.
    pub(super) fn set_scissor(&self, x: u32, y: u32, width: u32, height: u32) {
        let gl = self.gl();
        let [x, y, width, height] = [x, y, width, height].map(|number| number as i32);
        // SAFETY: the context is current and has the function if there are several scissors.
        unsafe {
            match self.has_viewport_arrays() {
                true => gl.scissor_slice(0, 1, &[[x, y, width, height]]),
                false => gl.scissor(x, y, width, height),
            }
        }
    }

    fn has_viewport_arrays(&self) -> bool {
        self.caller_part()
            .is_some_and(|part| part.traits.has_viewport_arrays)
    }

    /// The requested OpenGL interface.
    pub fn api(&self) -> Api {
        self.inner.api
    }

    /// GL_RENDERER: the driver's name for the device.
    pub fn renderer(&self) -> &str {
        &self.inner.driver.renderer
    }

    /// GL_VENDOR.
    pub fn vendor(&self) -> &str {
        &self.inner.driver.vendor
    }

    /// GL_VERSION, which includes the driver's version.
    pub fn version(&self) -> &str {
        &self.inner.driver.version
    }

    /// GL_SHADING_LANGUAGE_VERSION.
    pub fn shading_language(&self) -> &str {
        &self.inner.driver.shading_language
    }

    /// Whether the renderer runs on the processor instead of a graphics card.
    pub fn is_software(&self) -> bool {
        is_software(self.renderer())
    }

    /// The driver's limits.
    pub(crate) fn limits(&self) -> Limits {
        self.inner.driver.limits
    }

    /// The GL functions, with this context current on this thread. Use the reference at once: any use of another
    /// context makes that other context current.
    ///
    /// If this context cannot be made current, GL calls do nothing, and [`check`](Context::check) reports the failure.
    #[doc(hidden)]
    pub fn gl(&self) -> &glow::Context {
        debug_assert!(
            self.caller_part().is_none_or(|part| part.entered.get() > 0),
            "a caller's context is used without saving its state"
        );
        let _ = current::make(&self.inner.backend);
        &self.inner.gl
    }

    /// Queries the GL errors since the last call and clears them. In a browser it only finds a lost context, and leaves the
    /// errors to the next read-back.
    ///
    /// # Errors
    /// The first error, with the operation that caused it: [`GpuError::OutOfMemory`], [`GpuError::ContextLost`] or
    /// [`GpuError::Gl`].
    pub fn check(&self, what: &str) -> Result<(), GpuError> {
        match platform::HAS_QUICK_ERRORS {
            true => self.first_error(what),
            false => self.check_not_lost(),
        }
    }

    /// After a read-back: queries the GL errors since the last call and clears them. This may wait for the renderer.
    ///
    /// # Errors
    /// As for [`check`](Context::check). The message states that an earlier call may be the cause, because most calls in a
    /// browser are not checked themselves.
    pub(super) fn check_and_wait(&self, what: &str) -> Result<(), GpuError> {
        self.first_error(what).map_err(GpuError::or_earlier)
    }

    /// The first GL error since the last call.
    fn first_error(&self, what: &str) -> Result<(), GpuError> {
        current::make(&self.inner.backend).map_err(GpuError::lost)?;
        // SAFETY: the context is current.
        let next = || unsafe { self.inner.gl.get_error() };
        let first = next();
        let mut last = first;
        for _ in 0..ERRORS_AT_MOST {
            if last == glow::NO_ERROR {
                break;
            }
            last = next();
        }
        match first {
            // After a reset GL calls do nothing, and most report no error.
            glow::NO_ERROR => self.check_not_lost(),
            glow::OUT_OF_MEMORY => Err(GpuError::OutOfMemory { what: what.into() }),
            glow::CONTEXT_LOST => Err(GpuError::lost(format!("GL_CONTEXT_LOST in {what}"))),
            code => {
                // A browser has its own code for a loss.
                self.check_not_lost()?;
                Err(GpuError::Gl {
                    what: what.into(),
                    code: code_name(code),
                })
            }
        }
    }

    /// Makes the context current until the result is dropped, and leaves its state unchanged.
    ///
    /// # Errors
    /// [`GpuError::ContextLost`] if it cannot be made current.
    pub(super) fn make_current(&self) -> Result<current::Entered, GpuError> {
        current::enter(&self.inner.backend).map_err(GpuError::lost)
    }

    /// Checks whether the driver has lost the context. Only contexts made with reset notification (`egl::new_context`)
    /// and contexts in a browser can report a loss.
    ///
    /// # Errors
    /// [`GpuError::ContextLost`] if the context is lost.
    pub(super) fn check_not_lost(&self) -> Result<(), GpuError> {
        current::make(&self.inner.backend).map_err(GpuError::lost)?;
        if self.inner.backend.is_lost() {
            return Err(GpuError::lost("the browser reports the loss"));
        }
        // SAFETY: the context is current and has the extension of this function.
        let status = self.inner.driver.reset_status.map(|ask| unsafe { ask() });
        match status {
            None | Some(glow::NO_ERROR) => Ok(()),
            Some(status) => Err(GpuError::lost(format!(
                "the driver reports a reset, {status:#x}"
            ))),
        }
    }

    /// Calls [`check`](Context::check) in debug builds, or if the environment has `ECHOMARCH_GL_CHECK=1`; otherwise
    /// does nothing, because a query can stall a driver that works on another thread.
    ///
    /// # Errors
    /// The errors of [`check`](Context::check).
    pub(crate) fn debug_check(&self, what: &str) -> Result<(), GpuError> {
        static ASKED: OnceLock<bool> = OnceLock::new();
        let asked = || std::env::var_os("ECHOMARCH_GL_CHECK").is_some_and(|value| value == "1");
        if cfg!(debug_assertions) || *ASKED.get_or_init(asked) {
            self.check(what)
        } else {
            Ok(())
        }
    }

    /// The vertex array without attributes used to draw the full-screen triangle.
    pub(super) fn vertex_array(&self) -> glow::VertexArray {
        self.inner.vertex_array
    }

    /// Whether both are references to the same context.
    pub(super) fn is_same(&self, other: &Context) -> bool {
        Rc::ptr_eq(&self.inner, &other.inner)
    }
}

impl fmt::Debug for Context {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Context")
            .field("api", &self.api())
            .field("renderer", &self.renderer())
            .finish_non_exhaustive()
    }
}

/// Keeps a [`Context`] current, in the state that passes need. Dropping it restores the previously current context, and
/// the state of a caller's context.
#[must_use]
pub(crate) struct Entered {
    _callers: Option<CallersEntered>,
    // This field is dropped after the state, which can only be restored while the context is current.
    _current: current::Entered,
}

/// A caller's context, and the state to restore in it.
struct CallersEntered {
    context: Context,
    /// `None` in a nested call, or if the call does not change the state.
    state: Option<CallerState>,
}

impl Entered {
    /// Counts the call if the context is the caller's. Saves the context's state if `keeps_state` is set and the call
    /// is not nested in another.
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
    /// thread before. Without such a context this one stays current, unless it is the caller's. The state of a caller's
    /// context is saved and restored.
    ///
    /// # Errors
    /// [`GpuError::ContextLost`] if it cannot be made current.
    pub(crate) fn enter(&self) -> Result<Entered, GpuError> {
        Ok(Entered::new(self, self.make_current()?, true))
    }

    /// Frees objects with the context current. The objects are not bound outside calls, so no state changes. If the
    /// context cannot be made current, its objects no longer exist.
    pub(super) fn free(&self, delete: impl FnOnce(&glow::Context)) {
        if let Ok(current) = self.make_current() {
            let _entered = Entered::new(self, current, false);
            delete(self.gl());
        }
    }
}
