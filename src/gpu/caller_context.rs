//! Contexts that a caller made: of a game's window, of another library.

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

/// The least version of OpenGL, and of OpenGL ES: major and minor.
const LEAST_GL: (u32, u32) = (3, 3);
const LEAST_ES: (u32, u32) = (3, 0);

/// How a context that the caller made is made current.
#[non_exhaustive]
pub enum MakeCurrent {
    /// By the caller alone: it is current on this thread whenever a function of this crate is called that works with
    /// it, and whenever a [`Tracer`](crate::Tracer) on it or the last reference to the [`Context`] is dropped.
    ByCaller,
    /// By these functions of the caller's, where it is not current already. After each call what was current before is
    /// so again: this context, or none, or another one of EGL's if this crate has made a context through EGL.
    With(Box<dyn SwitchContext>),
}

/// Makes one context current on this thread, and not current, by whatever library made it.
pub trait SwitchContext {
    /// Makes the context current on this thread.
    ///
    /// # Errors
    /// Why it cannot be; afterwards [`GpuError::ContextLost`].
    fn make_current(&self) -> Result<(), String>;

    /// Whether the library reports that the context is current on this thread.
    fn is_current(&self) -> bool;

    /// Makes no context current on this thread. The context is the current one.
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

/// Where a library has the functions of GL: the address of the one of a name, null where there is none.
type Loader = Box<dyn Fn(&CStr) -> *const c_void>;

/// The caller's share in a [`Context`].
struct CallerBackend {
    make_current: MakeCurrent,
    loader: Option<Loader>,
}

impl Context {
    /// A context that the caller made: waves are traced beside his own drawing, and results can stay in
    /// [textures](crate::Tracer::frame_to_texture) that he draws with. OpenGL 3.3 or later, of the core or the
    /// compatibility profile, or OpenGL ES 3.0 with `EXT_color_buffer_float`.
    ///
    /// `loader` returns the address of a GL function: `get_proc_address` of glutin, SDL, GLFW or eframe. `current`
    /// states who makes the context current.
    ///
    /// # State
    /// Each call of this crate that works with the context keeps the state that it changes or depends on, sets what it
    /// needs, and puts all back before it returns, on errors too: the program, the vertex array, both framebuffers, the
    /// renderbuffer; viewport, scissor, blending, colour masks, culling, tests, polygon mode, rasterizer discard,
    /// multisampling, clip distances and the like; of the texture units 0 to 3 and 31 what is bound, samplers included;
    /// buffers for pixels, texels and queries; how pixels are stored; transform feedback, which is paused. The caller need
    /// not set anything before a call, nor after it. Four things the caller has to see to:
    ///
    /// - GL errors that were not queried are cleared by a call.
    /// - What is bound is not deleted before a call: GL cannot bind it again after it.
    /// - Queries that count (samples, primitives, time) count this crate's drawing too, and conditional rendering
    ///   may skip it: both are to be ended first. So is transform feedback of OpenGL 3.3, which cannot be paused.
    /// - In the compatibility profile `glPixelTransfer` and pixel maps are to be as they are at first.
    ///
    /// Keeping and putting back takes some 90 questions to the driver a call, for which a driver that works on a thread of
    /// its own has to be waited for. State by index that only extensions have (`ARB_viewport_array` below OpenGL 4.1,
    /// `EXT_draw_buffers_indexed` below OpenGL ES 3.2) becomes that of index 0. With EGL the API that is bound where no
    /// context is current may be another one after a call.
    ///
    /// ```no_run
    /// use echomarch::gpu::{Context, MakeCurrent};
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
    /// [`GpuError::NoFunctions`] where no context is current although `current` states that, or `loader` gives no
    /// functions; [`GpuError::TooOld`], [`GpuError::MissingExtension`], [`GpuError::ContextLost`] where the context
    /// cannot be made current.
    ///
    /// # Safety
    /// - `loader` gives functions of GL that are those of the context, and stay so as long as the context lives.
    /// - With [`MakeCurrent::ByCaller`] the context is current on this thread in this call, in every call that works with
    ///   the answer or what is made of it, and when these are dropped; so it lives longer than they do.
    /// - With [`MakeCurrent::With`] the three functions do what they are to do for the very context that the functions of
    ///   GL belong to. They answer with an error, and do not crash, when it is gone.
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

    /// [`from_loader`](Context::from_loader) for a program that has the functions of GL from the crate
    /// [`glow`](super::glow) already, in the version that this module names.
    ///
    /// State that glow cannot query is not restored, but set to its initial value: colour masks that differ between the
    /// draw buffers of one framebuffer (all become that of the first), and `glClampColor`. The driver does not report
    /// resets either.
    ///
    /// # Errors
    /// As [`from_loader`](Context::from_loader).
    ///
    /// # Safety
    /// As [`from_loader`](Context::from_loader); `gl` stands for its functions.
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

/// Describes a context of the caller's, and leaves it as it was.
fn of_caller(
    backend: Rc<CallerBackend>,
    functions: impl FnOnce() -> Result<Arc<glow::Context>, GpuError>,
) -> Result<Context, GpuError> {
    let backend: Rc<dyn Backend> = backend;
    let _entered = current::enter(&backend).map_err(|reason| GpuError::ContextLost { reason })?;
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
