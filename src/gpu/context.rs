//! A GL context without a window.

#[cfg(not(target_arch = "wasm32"))]
use std::ffi::CString;
use std::fmt;
#[cfg(not(target_arch = "wasm32"))]
use std::ptr;
use std::rc::Rc;
use std::sync::{Arc, OnceLock};

use glow::HasContext;

use super::backend::Backend;
use super::caller_context::{CallerPart, Entered};
use super::caller_state::set_scissor_test;
use super::error::code_name;
#[cfg(not(target_arch = "wasm32"))]
use super::native;
#[cfg(not(target_arch = "wasm32"))]
use super::osmesa::OsMesa;
use super::software::is_software;
use super::{Api, GpuError, current};

/// The extension by which OpenGL ES draws into textures of floats.
const FLOAT_TARGETS: &str = "GL_EXT_color_buffer_float";

/// Errors drained from one context at most: a lost one may answer for ever.
pub(super) const ERRORS_AT_MOST: usize = 32;

/// Which context to make.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct ContextOptions {
    /// The way to reach OpenGL.
    pub api: Api,
    /// Index of the device, from 0, in the order of [`list_gpus`](super::list_gpus); `None` takes the first on
    /// which a context of the API can be made. OSMesa has the device 0 alone.
    pub gpu: Option<usize>,
}

impl ContextOptions {
    /// The first device on which a context of the API can be made.
    pub fn new(api: Api) -> ContextOptions {
        ContextOptions { api, gpu: None }
    }

    /// The same on one device, by its index from 0.
    pub fn with_gpu(mut self, gpu: usize) -> ContextOptions {
        self.gpu = Some(gpu);
        self
    }
}

/// What the driver allows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Limits {
    /// Longest side of a texture, in texels.
    pub max_texture_size: u32,
    /// Uniforms of a fragment shader, counted in vectors of four.
    pub max_fragment_uniform_vectors: u32,
    /// Outputs of a fragment shader that can be drawn at once.
    pub max_draw_buffers: u32,
    /// Textures that a framebuffer can hold.
    pub max_color_attachments: u32,
}

impl Limits {
    /// Textures that one pass can write to: four at least.
    pub fn most_outputs(&self) -> u32 {
        self.max_draw_buffers.min(self.max_color_attachments)
    }
}

/// A GL context without a window, and the thread's access to it. The [module](super) has an example.
///
/// Clones are references to the same context, which is destroyed with the last of them. It stays on the thread that
/// made it.
#[derive(Clone)]
pub struct Context {
    inner: Rc<Inner>,
    passed_over: Rc<[String]>,
}

/// What the clones of a context share.
pub(super) struct Inner {
    backend: Rc<dyn Backend>,
    gl: Arc<glow::Context>,
    vertex_array: glow::VertexArray,
    api: Api,
    renderer: String,
    vendor: String,
    version: String,
    shading_language: String,
    limits: Limits,
    reset_status: Option<ResetStatus>,
    /// Of a context that the caller made.
    caller: Option<CallerPart>,
}

/// glGetGraphicsResetStatus, under whatever name the driver has it.
type ResetStatus = unsafe extern "system" fn() -> u32;

impl Drop for Inner {
    fn drop(&mut self) {
        if self.caller.is_none() {
            // The vertex array goes with the context.
            current::release();
            return;
        }
        // Where the context cannot be made current it is gone, and the vertex array with it.
        let Ok(_entered) = current::enter(&self.backend) else {
            return;
        };
        // SAFETY: the context is current, and the vertex array its own and not bound outside of calls.
        unsafe { self.gl.delete_vertex_array(self.vertex_array) };
    }
}

impl Context {
    /// Makes a context without a window, and leaves it current on this thread. With `gpu: None` print the
    /// [`renderer`](Context::renderer): it may be a software one.
    ///
    /// # Errors
    /// A library, a device, a context or an extension that is not there.
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
        Err(GpuError::NoContext {
            api: options.api,
            reason: reasons.join("; "),
        })
    }

    /// Devices tried before this one, for a context that was asked for without a number, and why each was not
    /// taken: to be told to the user, who may have meant one of them.
    pub fn passed_over(&self) -> &[String] {
        &self.passed_over
    }

    /// Takes over a context that a library made, and leaves it current.
    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn from_backend(backend: Rc<dyn Backend>, api: Api) -> Result<Context, GpuError> {
        Context::from_backend_with(backend, api, load)
    }

    /// The same with another way to GL's functions, which is called with the context current.
    pub(super) fn from_backend_with(
        backend: Rc<dyn Backend>,
        api: Api,
        load: impl FnOnce(&dyn Backend) -> glow::Context,
    ) -> Result<Context, GpuError> {
        current::release();
        backend
            .make_current()
            .map_err(|reason| GpuError::NoContext { api, reason })?;
        let gl = Arc::new(load(&*backend));
        let inner = describe(backend.clone(), gl, api, None).inspect_err(|_| backend.release())?;
        let context = Context::from_inner(inner);
        current::make(&backend).map_err(|reason| GpuError::NoContext { api, reason })?;
        Ok(context)
    }

    /// A first reference.
    pub(super) fn from_inner(inner: Inner) -> Context {
        Context {
            inner: Rc::new(inner),
            passed_over: Rc::default(),
        }
    }

    /// What there is besides of a context that the caller made.
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

    /// Sets the size of the viewport, which begins at (0, 0). A caller's further viewports stay as they are.
    pub(super) fn set_viewport(&self, width: u32, height: u32) {
        let gl = self.gl();
        // SAFETY: the context is current, and has the function where there are several viewports. Mesa 22 writes to the
        // numbers: they are no constants.
        unsafe {
            match self.has_viewport_arrays() {
                true => gl.viewport_f32_slice(0, 1, &[[0.0, 0.0, width as f32, height as f32]]),
                false => gl.viewport(0, 0, width as i32, height as i32),
            }
        }
    }

    /// Sets the rectangle of the scissor. A caller's further scissors stay as they are.
    pub(super) fn set_scissor(&self, x: u32, y: u32, width: u32, height: u32) {
        let gl = self.gl();
        let [x, y, width, height] = [x, y, width, height].map(|number| number as i32);
        // SAFETY: the context is current, and has the function where there are several scissors.
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

    /// The way to reach OpenGL that was asked for.
    pub fn api(&self) -> Api {
        self.inner.api
    }

    /// GL_RENDERER: the driver's name for the device.
    pub fn renderer(&self) -> &str {
        &self.inner.renderer
    }

    /// GL_VENDOR.
    pub fn vendor(&self) -> &str {
        &self.inner.vendor
    }

    /// GL_VERSION, the driver's version included.
    pub fn version(&self) -> &str {
        &self.inner.version
    }

    /// GL_SHADING_LANGUAGE_VERSION.
    pub fn shading_language(&self) -> &str {
        &self.inner.shading_language
    }

    /// Whether the processor draws, rather than a graphics card.
    pub fn is_software(&self) -> bool {
        is_software(self.renderer())
    }

    /// What the driver allows.
    pub(crate) fn limits(&self) -> Limits {
        self.inner.limits
    }

    /// GL itself, with this context current on this thread. For use at once: whatever touches another context makes
    /// that one current.
    ///
    /// Where the context cannot be made current none is; then GL calls do nothing, and [`check`](Context::check)
    /// reports it.
    pub(crate) fn gl(&self) -> &glow::Context {
        debug_assert!(
            self.caller_part().is_none_or(|part| part.entered.get() > 0),
            "a context of the caller's is used without keeping its state"
        );
        let _ = current::make(&self.inner.backend);
        &self.inner.gl
    }

    /// Asks GL for the errors since the last time, and forgets them.
    ///
    /// # Errors
    /// The first of them, named after what was being done: [`GpuError::OutOfMemory`], [`GpuError::ContextLost`] or
    /// [`GpuError::Gl`].
    pub(crate) fn check(&self, what: &str) -> Result<(), GpuError> {
        current::make(&self.inner.backend).map_err(|reason| GpuError::ContextLost { reason })?;
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
            // After a reset calls do nothing, and most of them report no error.
            glow::NO_ERROR => self.check_not_lost(),
            glow::OUT_OF_MEMORY => Err(GpuError::OutOfMemory { what: what.into() }),
            glow::CONTEXT_LOST => Err(GpuError::ContextLost {
                reason: format!("GL_CONTEXT_LOST in {what}"),
            }),
            code => Err(GpuError::Gl {
                what: what.into(),
                code: code_name(code),
            }),
        }
    }

    /// Makes the context current until the answer is dropped, and then what somebody else had made current on this
    /// thread by way of EGL. Where nothing was current the context stays so, unless it is the caller's. The state of a
    /// caller's context is kept, and put back.
    ///
    /// # Errors
    /// [`GpuError::ContextLost`] if it cannot be made current.
    pub(crate) fn enter(&self) -> Result<Entered, GpuError> {
        Ok(Entered::with_state(self, self.make_current()?))
    }

    /// The same for the freeing of objects.
    ///
    /// # Errors
    /// As [`enter`](Context::enter).
    pub(super) fn enter_to_free(&self) -> Result<Entered, GpuError> {
        Ok(Entered::without_state(self, self.make_current()?))
    }

    fn make_current(&self) -> Result<current::Entered, GpuError> {
        current::enter(&self.inner.backend).map_err(|reason| GpuError::ContextLost { reason })
    }

    /// Asks the driver whether it has lost the context, where it can tell: of contexts that were made to be told
    /// (`egl::new_context`).
    ///
    /// # Errors
    /// [`GpuError::ContextLost`] if it has.
    pub(super) fn check_not_lost(&self) -> Result<(), GpuError> {
        current::make(&self.inner.backend).map_err(|reason| GpuError::ContextLost { reason })?;
        // SAFETY: the context is current, and has the extension that the function is of.
        let status = self.inner.reset_status.map(|ask| unsafe { ask() });
        match status {
            None | Some(glow::NO_ERROR) => Ok(()),
            Some(status) => Err(GpuError::ContextLost {
                reason: format!("the driver tells of a reset, {status:#x}"),
            }),
        }
    }

    /// [`check`](Context::check) in debug builds, or where the environment has `ECHOMARCH_GL_CHECK=1`; else nothing,
    /// since asking can stall a driver that works on another thread.
    ///
    /// # Errors
    /// Those of [`check`](Context::check).
    pub(crate) fn debug_check(&self, what: &str) -> Result<(), GpuError> {
        static ASKED: OnceLock<bool> = OnceLock::new();
        let asked = || std::env::var_os("ECHOMARCH_GL_CHECK").is_some_and(|value| value == "1");
        if cfg!(debug_assertions) || *ASKED.get_or_init(asked) {
            self.check(what)
        } else {
            Ok(())
        }
    }

    /// The vertex array without attributes that the full-screen triangle is drawn with.
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

/// Asks for all that is known of a context that is current.
pub(super) fn describe(
    backend: Rc<dyn Backend>,
    gl: Arc<glow::Context>,
    api: Api,
    caller: Option<CallerPart>,
) -> Result<Inner, GpuError> {
    // SAFETY: the context is current, and the strings and numbers asked for exist in every version.
    let (renderer, vendor, version, shading_language) = unsafe {
        (
            gl.get_parameter_string(backend.renderer_parameter(&gl)),
            gl.get_parameter_string(glow::VENDOR),
            gl.get_parameter_string(glow::VERSION),
            gl.get_parameter_string(glow::SHADING_LANGUAGE_VERSION),
        )
    };
    if api == Api::Gles && !has_float_targets(&gl) {
        return Err(GpuError::MissingExtension {
            extension: FLOAT_TARGETS,
            renderer,
        });
    }
    // SAFETY: the context is current.
    let vertex_array = unsafe { gl.create_vertex_array() }
        .map_err(|reason| GpuError::NoContext { api, reason })?;
    let limits = limits(&gl, api);
    let reset_status = reset_status(&*backend, &gl, api);
    Ok(Inner {
        backend,
        gl,
        vertex_array,
        api,
        renderer,
        vendor,
        version,
        shading_language,
        limits,
        reset_status,
        caller,
    })
}

/// Whether OpenGL ES draws into textures of floats; WebGL's names have no `GL_` before them.
fn has_float_targets(gl: &glow::Context) -> bool {
    let names = [FLOAT_TARGETS, FLOAT_TARGETS.trim_start_matches("GL_")];
    let known = gl.supported_extensions();
    names.iter().any(|name| known.contains(*name))
}

/// The function that tells of resets, of an extension that the context has.
fn reset_status(backend: &dyn Backend, gl: &glow::Context, api: Api) -> Option<ResetStatus> {
    let of_khr = match api {
        Api::Gles => c"glGetGraphicsResetStatusKHR",
        Api::Gl | Api::OsMesa => c"glGetGraphicsResetStatus",
    };
    let names = [
        ("GL_KHR_robustness", of_khr),
        ("GL_ARB_robustness", c"glGetGraphicsResetStatusARB"),
        ("GL_EXT_robustness", c"glGetGraphicsResetStatusEXT"),
    ];
    let has = |extension: &str| gl.supported_extensions().contains(extension);
    let (_, name) = names.into_iter().find(|(extension, _)| has(extension))?;
    let address = backend.proc_address(name);
    // SAFETY: the address is that of the function of this name, which takes nothing and answers with a GLenum, or null.
    (!address.is_null()).then(|| unsafe { std::mem::transmute(address) })
}

/// The functions of GL, with the context current.
#[cfg(not(target_arch = "wasm32"))]
pub(super) fn load(backend: &dyn Backend) -> glow::Context {
    let find = |name: &str| match CString::new(name) {
        Ok(name) => backend.proc_address(&name),
        Err(_) => ptr::null(),
    };
    let find_or_core = |name: &str| {
        let address = find(name);
        // glow reads a timer query by the extension's function on drivers without glGetQueryBufferObjectiv; the
        // core's is the same function.
        if address.is_null() && name == "glGetQueryObjectui64vEXT" {
            find("glGetQueryObjectui64v")
        } else {
            address
        }
    };
    // SAFETY: the context is current, and the addresses are those of its library.
    unsafe { glow::Context::from_loader_function(find_or_core) }
}

fn limits(gl: &glow::Context, api: Api) -> Limits {
    // SAFETY: the context is current; a limit that is unknown leaves 0.
    let limit = |name: u32| u32::try_from(unsafe { gl.get_parameter_i32(name) }).unwrap_or(0);
    Limits {
        max_texture_size: limit(glow::MAX_TEXTURE_SIZE),
        max_fragment_uniform_vectors: match api {
            Api::Gles => limit(glow::MAX_FRAGMENT_UNIFORM_VECTORS),
            Api::Gl | Api::OsMesa => limit(glow::MAX_FRAGMENT_UNIFORM_COMPONENTS) / 4,
        },
        max_draw_buffers: limit(glow::MAX_DRAW_BUFFERS),
        max_color_attachments: limit(glow::MAX_COLOR_ATTACHMENTS),
    }
}
