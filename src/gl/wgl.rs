//! Contexts without a visible window on Windows: WGL requires a window, so each context has a hidden one.

use std::num::{NonZeroIsize, NonZeroU32};
use std::ptr;
use std::rc::Rc;

use glutin::api::wgl::context::PossiblyCurrentContext;
use glutin::api::wgl::display::Display;
use glutin::api::wgl::surface::Surface;
use glutin::config::ConfigSurfaceTypes;
use glutin::error::ErrorKind;
use glutin::prelude::*;
use glutin::surface::{SurfaceAttributesBuilder, WindowSurface};
use raw_window_handle::{
    RawDisplayHandle, RawWindowHandle, Win32WindowHandle, WindowsDisplayHandle,
};
use windows_sys::Win32::Foundation::HWND;
use windows_sys::Win32::Graphics::Gdi::HDC;
use windows_sys::Win32::Graphics::OpenGL::{
    HGLRC, wglGetCurrentContext, wglGetCurrentDC, wglMakeCurrent,
};
use windows_sys::Win32::System::LibraryLoader::GetModuleHandleW;
use windows_sys::Win32::UI::WindowsAndMessaging::{
    CreateWindowExW, DestroyWindow, HWND_MESSAGE, WS_CLIPCHILDREN, WS_CLIPSIBLINGS, WS_POPUP,
};
use windows_sys::w;

#[cfg(feature = "window")]
pub(super) use super::backend::prepare;
use super::backend::{Backend, GlutinContext, attributes, new_context, template};
pub(super) use super::backend::{Place, places};
use super::{Api, GpuError};

/// Side of the hidden, unused window in pixels.
const SIDE: i32 = 1;

/// Makes a context, which is not yet current.
///
/// # Errors
/// [`GpuError::NoContext`] with the error of Windows.
pub(super) fn open(_: &Place, api: Api) -> Result<Rc<dyn Backend>, GpuError> {
    match create(api) {
        Ok(context) => Ok(Rc::new(context)),
        Err(error) => Err(GpuError::no_context(api, error)),
    }
}

/// A window that is never shown.
struct HiddenWindow(HWND);

impl HiddenWindow {
    fn new() -> Result<HiddenWindow, glutin::error::Error> {
        // SAFETY: the class is one of Windows' own, and the texts end in zero. The window's messages are never read: a
        // message-only window gets no broadcasts, so no other program waits for it.
        let window = unsafe {
            CreateWindowExW(
                0,
                w!("STATIC"),
                w!("Echomarch"),
                WS_POPUP | WS_CLIPCHILDREN | WS_CLIPSIBLINGS,
                0,
                0,
                SIDE,
                SIDE,
                HWND_MESSAGE,
                ptr::null_mut(),
                GetModuleHandleW(ptr::null()),
                ptr::null(),
            )
        };
        match window.is_null() {
            true => Err(ErrorKind::NotSupported("Windows cannot create a hidden window").into()),
            false => Ok(HiddenWindow(window)),
        }
    }

    fn handle(&self) -> Result<RawWindowHandle, glutin::error::Error> {
        let number = NonZeroIsize::new(self.0 as isize).ok_or(ErrorKind::BadNativeWindow)?;
        let mut handle = Win32WindowHandle::new(number);
        // SAFETY: null requests the program's own module.
        handle.hinstance = NonZeroIsize::new(unsafe { GetModuleHandleW(ptr::null()) } as isize);
        Ok(RawWindowHandle::Win32(handle))
    }
}

impl Drop for HiddenWindow {
    fn drop(&mut self) {
        // SAFETY: this value owns the window; the window belongs to this thread and is not used again.
        unsafe { DestroyWindow(self.0) };
    }
}

/// The drawing target of a WGL context. Field order matters: the window is dropped last.
struct Hidden {
    surface: Surface<WindowSurface>,
    _window: HiddenWindow,
}

/// Creates a context on a hidden window.
fn create(api: Api) -> Result<impl Backend + use<>, glutin::error::Error> {
    let window = HiddenWindow::new()?;
    let handle = window.handle()?;
    let on = RawDisplayHandle::Windows(WindowsDisplayHandle::new());
    // SAFETY: the window exists, and has its module.
    let display = unsafe { Display::new(on, Some(handle)) }?;
    let template = template(api, ConfigSurfaceTypes::WINDOW)
        .compatible_with_native_window(handle)
        .build();
    // SAFETY: the template names the window, which exists.
    let config = unsafe { display.find_configs(template) }?.next();
    let config = config.ok_or(ErrorKind::BadConfig)?;
    let side = NonZeroU32::MIN;
    let of_window = SurfaceAttributesBuilder::<WindowSurface>::new().build(handle, side, side);
    // SAFETY: the window exists, and is destroyed after the surface.
    let surface = unsafe { display.create_window_surface(&config, &of_window) }?;
    let context = new_context(&display, &config, attributes(api))?.treat_as_possibly_current();
    let hidden = Hidden {
        surface,
        _window: window,
    };
    Ok(GlutinContext {
        context,
        make_current: move |context: &PossiblyCurrentContext| {
            // Makes the closure capture the whole struct, including the window.
            let hidden = &hidden;
            context.make_current(&hidden.surface)
        },
        display,
    })
}

/// A current WGL context that echomarch did not make.
pub(super) struct Foreign {
    device: HDC,
    context: HGLRC,
}

impl Foreign {
    /// The WGL context that is current on this thread, if any.
    pub fn of_system() -> Option<Foreign> {
        // SAFETY: only a query.
        let (device, context) = unsafe { (wglGetCurrentDC(), wglGetCurrentContext()) };
        (!context.is_null()).then_some(Foreign { device, context })
    }

    /// Leaves this thread without a current context.
    pub fn release(&self) {
        // SAFETY: null means none.
        unsafe { wglMakeCurrent(ptr::null_mut(), ptr::null_mut()) };
    }

    /// Makes the context current again. If its owner has destroyed it in the meantime, Windows refuses and no context
    /// is current.
    pub fn make_current(&self) {
        // SAFETY: Windows rejects handles that it does not know.
        unsafe { wglMakeCurrent(self.device, self.context) };
    }
}
