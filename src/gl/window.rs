//! The context of a window: through EGL on X11 and Wayland, WGL on Windows, CGL on macOS.
//!
//! It supports everything that a [`Context`] without a window does: the tracer and the window's drawing share the
//! context.

use std::any::Any;
use std::ffi::{CStr, c_void};
use std::num::NonZeroU32;
use std::rc::Rc;
use std::sync::Arc;

use glow::HasContext;
use glutin::config::{Config, ConfigSurfaceTypes};
use glutin::context::PossiblyCurrentContext;
use glutin::display::{Display, DisplayApiPreference};
use glutin::prelude::*;
use glutin::surface::{Surface, SurfaceAttributesBuilder, SwapInterval, WindowSurface};
use raw_window_handle::{HasDisplayHandle, HasWindowHandle, RawDisplayHandle, RawWindowHandle};

use super::backend::{Backend, attributes, new_context, template};
use super::driver::load;
use super::render_target::read_rgba8;
use super::{Api, Context, GpuError, native};

/// A display opened for OpenGL, and the configuration of its windows. Field order matters: the connection to the
/// display is dropped last.
#[derive(Debug)]
pub struct WindowDisplay {
    /// `None` on Windows, where opening the display requires a window.
    opened: Option<(Display, Config)>,
    handle: RawDisplayHandle,
    connection: Box<dyn Any>,
}

/// A window's context and surface.
#[derive(Debug)]
pub struct WindowContext {
    context: Context,
    drawing: Rc<Drawing>,
}

/// A context and a surface that are current together. Field order matters: fields are dropped in this order.
#[derive(Debug)]
struct Drawing {
    surface: Surface<WindowSurface>,
    context: PossiblyCurrentContext,
    display: Display,
    _window: Box<dyn Any>,
    _connection: Box<dyn Any>,
}

/// The [`Backend`] of a window's context.
struct WindowBackend(Rc<Drawing>);

impl WindowDisplay {
    /// Opens OpenGL on the display that a windowing library is connected to. The connection is kept as long as anything
    /// made from it: pass a counted reference, such as winit's `OwnedDisplayHandle`.
    ///
    /// # Errors
    /// [`GpuError::NoContext`] with EGL's error, and for displays of an unsupported kind; the library's error if EGL's
    /// library is missing.
    pub fn of(connection: impl HasDisplayHandle + 'static) -> Result<WindowDisplay, GpuError> {
        // Boxed, so that the connection is neither moved nor changed from now on.
        let connection = Box::new(connection);
        let handle = connection.display_handle().map_err(refused)?.as_raw();
        native::prepare()?;
        let opened = match cfg!(windows) {
            true => None,
            // SAFETY: the handle is valid as long as the connection, which is kept along with everything made from the
            // handle and dropped after it.
            false => Some(unsafe { open(handle, None) }.map_err(refused)?),
        };
        Ok(WindowDisplay {
            opened,
            handle,
            connection,
        })
    }

    /// The X11 visual that the window must use, on X11.
    #[cfg(all(unix, not(target_os = "macos")))]
    pub fn x11_visual(&self) -> Option<u64> {
        use glutin::platform::x11::X11GlConfigExt;
        let (_, config) = self.opened.as_ref()?;
        config.x11_visual().map(|visual| visual.visual_id())
    }

    /// Creates a context of OpenGL 3.3 core on a window of this display, with the given size in pixels, and leaves it
    /// current. The window is kept as long as the context: pass a counted reference, such as
    /// `Arc<winit::window::Window>`.
    ///
    /// # Errors
    /// [`GpuError::NoContext`], with EGL's error or because the window belongs to another windowing system.
    pub fn context(
        self,
        window: impl HasWindowHandle + 'static,
        width: u32,
        height: u32,
    ) -> Result<WindowContext, GpuError> {
        // Boxed for the same reason as the connection.
        let window = Box::new(window);
        let handle = window.window_handle().map_err(refused)?.as_raw();
        let (display, config) = match self.opened {
            Some(opened) => opened,
            // SAFETY: the conditions are those of opening the display without a window; the window is also kept along
            // with everything made from it.
            None => unsafe { open(self.handle, Some(handle)) }.map_err(refused)?,
        };
        let (width, height) = (at_least_one(width), at_least_one(height));
        let surface = SurfaceAttributesBuilder::<WindowSurface>::new().build(handle, width, height);
        // SAFETY: the window's handle is valid as long as the window, which is kept along with the surface and dropped
        // after it; the handle is a number that the display server looks up, so a window of another connection only
        // causes an EGL error.
        let surface = unsafe { display.create_window_surface(&config, &surface) };
        let surface = surface.map_err(refused)?;
        let context = new_context(&display, &config, attributes(Api::Gl)).map_err(refused)?;
        let drawing = Rc::new(Drawing {
            surface,
            context: context.treat_as_possibly_current(),
            display,
            _window: window,
            _connection: self.connection,
        });
        let backend = Rc::new(WindowBackend(drawing.clone()));
        let context = Context::from_backend(backend, Api::Gl)?;
        Ok(WindowContext { context, drawing })
    }
}

/// Opens a display and chooses a configuration for windows on it; on Windows, for the given window.
///
/// # Safety
/// Both handles stay valid as long as everything made from them.
unsafe fn open(
    handle: RawDisplayHandle,
    window: Option<RawWindowHandle>,
) -> Result<(Display, Config), glutin::error::Error> {
    #[cfg(windows)]
    let preference = DisplayApiPreference::Wgl(window);
    #[cfg(target_os = "macos")]
    let preference = DisplayApiPreference::Cgl;
    #[cfg(all(unix, not(target_os = "macos")))]
    let preference = DisplayApiPreference::Egl;
    // SAFETY: guaranteed by the caller.
    let display = unsafe { Display::new(handle, preference) }?;
    let mut template = template(Api::Gl, ConfigSurfaceTypes::WINDOW);
    if let Some(window) = window {
        template = template.compatible_with_native_window(window);
    }
    // SAFETY: the template names no native pixmap, and a window that the caller keeps.
    let config = unsafe { display.find_configs(template.build()) }?.next();
    Ok((display, config.ok_or(glutin::error::ErrorKind::BadConfig)?))
}

impl WindowContext {
    /// The context, for all other drawing and computing.
    pub fn context(&self) -> &Context {
        &self.context
    }

    /// Returns the GL functions in an `Arc`, for libraries that need one. They are valid while this context is current.
    ///
    /// # Errors
    /// [`GpuError::NoFunctions`].
    pub fn functions(&self) -> Result<Arc<glow::Context>, GpuError> {
        // `gl` makes the context current.
        self.context.gl();
        load(&WindowBackend(self.drawing.clone())).map(Arc::new)
    }

    /// Turns off waiting for the screen's refresh: the caller paces the frames. Some drivers wait nevertheless.
    pub fn do_not_wait_for_refresh(&self) {
        self.context.gl();
        let drawing = &self.drawing;
        // If the driver refuses, the screen paces the frames, which is slower but not wrong.
        let _ = drawing
            .surface
            .set_swap_interval(&drawing.context, SwapInterval::DontWait);
    }

    /// Sets the surface's size to the window's new size in pixels.
    pub fn resize(&self, width: u32, height: u32) {
        self.context.gl();
        let (width, height) = (at_least_one(width), at_least_one(height));
        self.drawing
            .surface
            .resize(&self.drawing.context, width, height);
    }

    /// Directs all further drawing to the window.
    pub fn aim(&self) {
        let gl = self.context.gl();
        // SAFETY: the context is current, and the window's framebuffer always exists.
        unsafe { gl.bind_framebuffer(glow::FRAMEBUFFER, None) };
    }

    /// Reads the pixels that the window shows after the next swap: four bytes each, the top row first. Waits for the
    /// drawing.
    ///
    /// # Errors
    /// GL errors.
    pub fn read_rgba8(&self, width: u32, height: u32) -> Result<Vec<u8>, GpuError> {
        read_rgba8(&self.context, None, width, height, "a window")
    }

    /// Shows the drawing on the screen.
    ///
    /// # Errors
    /// [`GpuError::ContextLost`] with EGL's error.
    pub fn swap(&self) -> Result<(), GpuError> {
        self.context.gl();
        self.drawing
            .surface
            .swap_buffers(&self.drawing.context)
            .map_err(|error| GpuError::lost(error.to_string()))
    }
}

impl Backend for WindowBackend {
    fn make_current(&self) -> Result<(), String> {
        self.0
            .context
            .make_current(&self.0.surface)
            .map_err(|error| error.to_string())
    }

    fn is_current(&self) -> bool {
        self.0.context.is_current() && self.0.surface.is_current(&self.0.context)
    }

    fn release(&self) {
        // If this fails, the context stays current until the next make_current replaces it.
        let _ = self.0.context.make_not_current_in_place();
    }

    fn proc_address(&self, name: &CStr) -> *const c_void {
        self.0.display.get_proc_address(name)
    }
}

fn at_least_one(side: u32) -> NonZeroU32 {
    NonZeroU32::new(side).unwrap_or(NonZeroU32::MIN)
}

fn refused(reason: impl ToString) -> GpuError {
    GpuError::no_context(Api::Gl, reason)
}
