//! Contexts made by a caller, such as the context of a game's window or of another library.

use std::cell::Cell;
use std::ffi::{CStr, c_void};
use std::fmt;
use std::rc::Rc;
use std::sync::Arc;

use glow::HasContext;

use super::backend::{Backend, Owner};
use super::caller_state::{CallerPart, Traits};
#[cfg(not(target_arch = "wasm32"))]
use super::driver::load;
use super::{Api, Context, GpuError, current};

/// Lowest supported versions of OpenGL and of OpenGL ES: major and minor.
const LEAST_GL: (u32, u32) = (3, 3);
const LEAST_ES: (u32, u32) = (3, 0);

/// How a caller's context is made current.
#[non_exhaustive]
pub enum MakeCurrent {
    /// By the caller alone: the caller makes the context current on this thread before each call of this crate that
    /// works with the context, and before a [`Tracer`](crate::Tracer) on it or the last reference to the [`Context`] is
    /// dropped.
    ByCaller,
    /// By these functions of the caller, unless the context is already current. Each call restores what was current
    /// before the call: this context, or no context. A previously current EGL context that is not this one is restored
    /// only if this crate has made a context through EGL.
    With(Box<dyn SwitchContext>),
}

/// Makes one context current, or no longer current, on this thread. The caller implements this trait for the library
/// that made the context.
pub trait SwitchContext {
    /// Makes the context current on this thread.
    ///
    /// # Errors
    /// The reason why it cannot be made current; reported as [`GpuError::ContextLost`].
    fn make_current(&self) -> Result<(), String>;

    /// Whether the library reports that the context is current on this thread.
    fn is_current(&self) -> bool;

    /// Leaves this thread without a current context. Called only while this context is current.
    fn release(&self);
}

impl fmt::Debug for MakeCurrent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            MakeCurrent::ByCaller => "ByCaller",
            MakeCurrent::With(_) => "With(..)",
        })
    }
}

/// Looks up a GL function by name: returns its address, or null if it is missing.
type Loader = Box<dyn Fn(&CStr) -> *const c_void>;

/// The [`Backend`] of a caller's context.
struct CallerBackend {
    make_current: MakeCurrent,
    loader: Option<Loader>,
}

impl Context {
    /// A context that the caller made: waves are traced alongside the caller's own drawing, and results can stay in
    /// [textures](crate::Tracer::frame_to_texture) that the caller draws with. Requires OpenGL 3.3 or later, core or
    /// compatibility profile, or OpenGL ES 3.0 with `EXT_color_buffer_float`.
    ///
    /// `loader` returns the address of a GL function: `get_proc_address` of glutin, SDL, GLFW or eframe. `current`
    /// states who makes the context current.
    ///
    /// # State
    /// Each call of this crate that works with the context saves the state that the call changes or depends on, sets
    /// its own values, and restores the saved state before it returns, also after an error. The saved state is: the
    /// program, the vertex array, both framebuffers, the renderbuffer; viewport, scissor, blending, colour masks,
    /// culling, tests, polygon mode, rasterizer discard, multisampling, clip distances and the like; the bindings of
    /// texture units 0 to 4 and 31, samplers included; buffers for pixels, texels and queries; pixel storage; transform
    /// feedback, which is paused. The caller need not set anything before or after a call, within these limits:
    ///
    /// - A call clears the GL errors that the caller has not queried.
    /// - An object that is bound must not be deleted before a call: GL could not bind it again afterwards.
    /// - Counting queries (samples, primitives, time) and conditional rendering must end before a call: the queries
    ///   would count this crate's drawing too, and conditional rendering might skip it. Transform feedback must also
    ///   end first in OpenGL 3.3, which cannot pause it.
    /// - In the compatibility profile `glPixelTransfer` and pixel maps must have their initial values.
    ///
    /// Saving and restoring takes about 90 driver queries per call. If the driver runs on its own thread, each query
    /// waits for that thread. Indexed state that only extensions provide (`ARB_viewport_array` below OpenGL 4.1,
    /// `EXT_draw_buffers_indexed` below OpenGL ES 3.2) is restored for all indices from index 0. With EGL, a call may
    /// change the API that is bound while no context is current.
    ///
    /// ```no_run
    /// use echomarch::gl::{Context, MakeCurrent};
    /// use echomarch::{Scene, Settings, Tracer};
    /// use std::ffi::{CStr, c_void};
    ///
    /// fn trace(get_proc_address: fn(&CStr) -> *const c_void) -> Result<(), echomarch::Error> {
    ///     // SAFETY: the game's context is current here, and whenever tracer and context are used or dropped.
    ///     let context = unsafe { Context::from_loader(get_proc_address, MakeCurrent::ByCaller) }?;
    ///     let mut tracer = Tracer::new(&context)?;
    ///     let frame = tracer.frame(&Scene::builtin("corner")?, &Settings::default())?;
    ///     println!("{}: pan {:.3}", context.renderer(), frame.panning.pan());
    ///     Ok(())
    /// }
    /// ```
    ///
    /// # Errors
    /// [`GpuError::NoFunctions`] if no context is current although `current` states that one is, or if `loader` returns
    /// no functions; [`GpuError::TooOld`], [`GpuError::MissingExtension`]; [`GpuError::ContextLost`] if the context
    /// cannot be made current.
    ///
    /// # Safety
    /// - `loader` returns the GL functions of the context, which stay valid as long as the context lives.
    /// - With [`MakeCurrent::ByCaller`] the context is current on this thread during this call, during every call that
    ///   works with the returned context or anything made from it, and when these are dropped; so the GL context
    ///   outlives the returned context.
    /// - With [`MakeCurrent::With`] the three functions act on the context that the GL functions belong to. If that
    ///   context no longer exists, they return an error and do not crash.
    #[cfg(not(target_arch = "wasm32"))]
    pub unsafe fn from_loader(
        loader: impl Fn(&CStr) -> *const c_void + 'static,
        current: MakeCurrent,
    ) -> Result<Context, GpuError> {
        let backend = Rc::new(CallerBackend {
            make_current: current,
            loader: Some(Box::new(loader)),
        });
        of_caller(backend.clone(), || load(&*backend).map(Arc::new))
    }

    /// [`from_loader`](Context::from_loader) for a program that already has the GL functions from the crate
    /// [`glow`](super::glow), in the version that this module re-exports.
    ///
    /// State that glow cannot query is set to its initial value instead of restored: `glClampColor`, and colour masks
    /// that differ between the draw buffers of one framebuffer (all get the mask of the first). Resets are not
    /// reported.
    ///
    /// # Errors
    /// The errors of [`from_loader`](Context::from_loader).
    ///
    /// # Safety
    /// Same as [`from_loader`](Context::from_loader), with the functions of `gl` in place of `loader`.
    pub unsafe fn from_glow(
        gl: Arc<glow::Context>,
        current: MakeCurrent,
    ) -> Result<Context, GpuError> {
        let backend = Rc::new(CallerBackend {
            make_current: current,
            loader: None,
        });
        of_caller(backend, || Ok(gl))
    }
}

/// Creates the [`Context`] of a caller's context without changing its state.
fn of_caller(
    backend: Rc<CallerBackend>,
    functions: impl FnOnce() -> Result<Arc<glow::Context>, GpuError>,
) -> Result<Context, GpuError> {
    let backend: Rc<dyn Backend> = backend;
    let _entered = current::enter(&backend).map_err(GpuError::lost)?;
    let gl = functions()?;
    let version = gl.version();
    let api = if version.is_embedded {
        Api::Gles
    } else {
        Api::Gl
    };
    let least = if version.is_embedded {
        LEAST_ES
    } else {
        LEAST_GL
    };
    if (version.major, version.minor) < least {
        // SAFETY: the context is current, and has a version.
        let version = unsafe { gl.get_parameter_string(glow::VERSION) };
        return Err(GpuError::TooOld { version });
    }
    let part = CallerPart {
        traits: Traits::of(&gl, &*backend),
        entered: Cell::new(0),
    };
    Context::described(backend, gl, api, Some(part))
}

impl Backend for CallerBackend {
    fn make_current(&self) -> Result<(), String> {
        match &self.make_current {
            MakeCurrent::ByCaller => Ok(()),
            MakeCurrent::With(switch) => switch.make_current(),
        }
    }

    fn is_current(&self) -> bool {
        match &self.make_current {
            MakeCurrent::ByCaller => true,
            MakeCurrent::With(switch) => switch.is_current(),
        }
    }

    fn release(&self) {
        if let MakeCurrent::With(switch) = &self.make_current {
            switch.release();
        }
    }

    fn proc_address(&self, name: &CStr) -> *const c_void {
        match &self.loader {
            Some(loader) => loader(name),
            None => std::ptr::null(),
        }
    }

    fn owner(&self) -> Owner {
        match self.make_current {
            MakeCurrent::ByCaller => Owner::KeptCurrentByCaller,
            MakeCurrent::With(_) => Owner::Caller,
        }
    }
}
